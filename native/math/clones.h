// SPDX-License-Identifier: GPL-3.0-or-later
// WARDMIS_CLONES before a function: compiled for SSE2, AVX2 and AVX-512, everything that it calls within it, and chosen
// by the processor when the program starts. For plain loops over arrays that the compiler vectorises. The clones give
// the same bits, as long as nothing is contracted to fused operations (CMakeLists.txt: -ffp-contract=off) and no
// function of the standard library is called.
//
// GCC with glibc on x86-64 alone: clang does not take it together with flatten, and others have no ifunc. Under the
// sanitizers a resolver would run before they are set up. There it is the plain function, for the build's instructions.
#pragma once

#include <string_view>

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__GLIBC__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define WARDMIS_HAS_CLONES 1
#define WARDMIS_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"), flatten))
#else
#define WARDMIS_HAS_CLONES 0
#define WARDMIS_CLONES
#endif

namespace wardmis {

// The instructions that the clones take on this processor.
inline std::string_view clonedFor() {
#if WARDMIS_HAS_CLONES
  if (__builtin_cpu_supports("x86-64-v4")) return "x86-64-v4";
  if (__builtin_cpu_supports("x86-64-v3")) return "x86-64-v3";
#endif
#ifdef __x86_64__
  return "x86-64";
#else
  return "baseline";
#endif
}

}  // namespace wardmis
