// SPDX-License-Identifier: GPL-3.0-or-later
// The independent reference values in tests/golden (docs/theory.md tells where they come from).
#pragma once

#include <fstream>
#include <nlohmann/json.hpp>

#include "math/vec.h"

namespace wardmis::test {

inline const nlohmann::json& golden() {
  static const nlohmann::json values = nlohmann::json::parse(std::ifstream(WARDMIS_TEST_DATA "/golden/golden.json"));
  return values;
}

template <class T>
Vec3<T> vec3(const nlohmann::json& j) {
  return {j[0].get<T>(), j[1].get<T>(), j[2].get<T>()};
}

}  // namespace wardmis::test
