// SPDX-License-Identifier: GPL-3.0-or-later
// libFuzzer: readGlb either reads its input or throws Error, and programs that it read run; nothing else may happen.
//   cmake -B build-fuzz -DCMAKE_CXX_COMPILER=clang++ -DWARDMIS_FUZZ=ON -DWARDMIS_SANITIZE=ON -DWARDMIS_OIIO=OFF
//   -DWARDMIS_TESTS=OFF cmake --build build-fuzz --target fuzz_glb build-fuzz/fuzz_glb
//   -dict=tests/native/gltf/glb.dict -max_total_time=60 /tmp/corpus tests/native/gltf/corpus
// New seeds: WARDMIS_WRITE_CORPUS=tests/native/gltf/corpus test_gltf --gtest_filter=Glb.ReadsTheCorpus
#include <cstdint>
#include <cstring>

#include "glb_builder.h"
#include "gltf/reader.h"
#include "math/error.h"
#include "program/run.h"
#include "scene/defaults.h"
#include "world/strands.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {  // NOLINT(readability-identifier-naming)
  using namespace wardmis;
  // A file as it is; or else its JSON, a zero byte and its binary chunk, so that the fuzzer need not learn the lengths.
  test::Bytes file;
  if (size >= 4 && std::memcmp(data, "glTF", 4) == 0) {
    file = test::bytesOf(data, size);
  } else {
    const void* zero = size ? std::memchr(data, 0, size) : nullptr;
    const size_t length = zero ? static_cast<const uint8_t*>(zero) - data : size;
    const size_t rest = zero ? length + 1 : size;
    file = test::GlbBuilder::glb(std::string(reinterpret_cast<const char*>(data), length),
                                 test::bytesOf(data + rest, size - rest));
  }
  try {
    Scene scene = readGlb(file, {}, "fuzz.glb");
    addDefaults(scene);
    for (const Mesh& mesh : scene.meshes)
      for (const MeshPart& part : mesh.parts)
        for (const Primitive& p : part.primitives)
          if (p.form != Form::kTriangles) {
            Vec3f lower, upper;
            Strands(part, p, nullptr).growBox(lower, upper);
          }
    // what is read must run, wherever it is
    for (const Material& m : scene.materials) {
      if (!m.program) continue;
      Slots slots;
      ShadingContext context;
      run(*m.program, context, {scene.textures.data(), scene.images.data()}, slots);
    }
  } catch (const Error&) {
  }
  return 0;
}
