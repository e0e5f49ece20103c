// SPDX-License-Identifier: GPL-3.0-or-later
// The batch: the same bits for every instruction set, and the speed that it is there for.
#include "bsdf/batch.h"

#include <gtest/gtest.h>

#include "loops.h"
#include "reference.h"

namespace wardmis {
namespace {

using namespace test;

bool sameBits(const std::vector<float>& a, const std::vector<float>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](float u, float v) { return std::bit_cast<uint32_t>(u) == std::bit_cast<uint32_t>(v); });
}

// So an image does not depend on the processor, nor on how many samples a hit has: each size has another remainder.
TEST(Batch, EveryInstructionSetGivesTheSameBits) {
  for (int n : {1, 2, 3, 5, 8, 13, 21, 31, 1000})
    for (const Variant& v : kVariants) {
      Directions one(n), all(n);
      for (int j = 0; j < n; ++j) {
        const size_t k = static_cast<size_t>(j);
        const WardValue<float> w =
            wardEvaluate(v.type, Vec3f{one.x[k], one.y[k], one.z[k]}, one.wo, 1 / one.kAx, 1 / one.kAy);
        one.fCos[k] = w.fCos, one.pdf[k] = w.pdf;
      }
      all.evaluate(wardBatch, v.type);
      EXPECT_TRUE(sameBits(one.fCos, all.fCos) && sameBits(one.pdf, all.pdf)) << "the batch, " << n;
      for (const Loops& l : loops()) {
        if (l.evaluate == evaluateLibm || !l.here) continue;
        Directions other(n);
        other.evaluate(l.evaluate, v.type);
        EXPECT_TRUE(sameBits(one.fCos, other.fCos) && sameBits(one.pdf, other.pdf)) << l.name << ", " << n;
      }
    }
}

// What it is compared with in the next test does the same work.
TEST(Batch, ScalarLoopGivesTheSameValues) {
  for (const Variant& v : kVariants) {
    Directions a(1000), b(1000);
    a.evaluate(wardBatch, v.type);
    b.evaluate(evaluateLibm, v.type);
    for (size_t j = 0; j < a.x.size(); ++j) {
      EXPECT_NEAR(a.fCos[j], b.fCos[j], 2e-5 * b.fCos[j] + 1e-30);
      EXPECT_NEAR(a.pdf[j], b.pdf[j], 2e-5 * b.pdf[j] + 1e-30);
    }
  }
}

// One instruction that has no vector form would lose all of the gain, silently.
TEST(Batch, IsThreeTimesAsFastAsScalarCode) {
#ifndef __OPTIMIZE__
  GTEST_SKIP() << "built without optimisation";
#endif
  if (clonedFor() != "x86-64-v4" && clonedFor() != "x86-64-v3") GTEST_SKIP() << "no AVX2 in this build or processor";
  Directions d(1024);
  for (const Variant& v : kVariants) {
    const auto [scalar, batch] = bestSeconds(
        2000, [&] { d.evaluate(evaluateLibm, v.type); }, [&] { d.evaluate(wardBatch, v.type); });
    EXPECT_GE(scalar / batch, 3) << v.point << ": " << 1024e-6 / scalar << " and " << 1024e-6 / batch
                                 << " million evaluations/s";
  }
}

}  // namespace
}  // namespace wardmis
