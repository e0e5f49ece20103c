// SPDX-License-Identifier: GPL-3.0-or-later
#include "math/hash.h"

#include <gtest/gtest.h>

#include <string_view>

namespace wardmis {
namespace {

uint64_t of(std::string_view text) {
  Fnv1a hash;
  for (const char c : text) hash.add(static_cast<uint8_t>(c));
  return hash.value();
}

// Values of the authors' test suite (RFC 9923, Appendix C).
TEST(Fnv1aTest, OfItsAuthors) {
  EXPECT_EQ(of(""), 0xcbf29ce484222325ULL);
  EXPECT_EQ(of("a"), 0xaf63dc4c8601ec8cULL);
  EXPECT_EQ(of("foobar"), 0x85944171f73967e8ULL);
}

}  // namespace
}  // namespace wardmis
