// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/needs.h"

#include <gtest/gtest.h>

#include "math/error.h"
#include "math/memory.h"

namespace wardmis {
namespace {

// `objects` that share one mesh of `triangles`.
Scene instances(size_t objects, size_t triangles, float emission) {
  std::vector<uint32_t> indices(3 * triangles);
  for (size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<uint32_t>(i % 3);
  Scene scene;
  scene.path = "many.glb";
  scene.materials.resize(1);
  scene.materials[0].emission.value = {emission, 0, 0};
  MeshPart part;
  part.positions = Array<Vec3f>::of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  part.primitives.push_back({0, Array<uint32_t>::of(std::move(indices))});
  scene.meshes.push_back({"Spark", {part}});
  scene.instances.assign(objects, Instance{});
  return scene;
}

std::string refusal(const Scene& scene) {
  try {
    requireMemoryFor(scene);
  } catch (const Error& e) {
    EXPECT_EQ(e.code, ExitCode::kMemory);
    return std::string(e.what()) + "; " + e.hint;
  }
  return "";
}

TEST(Needs, EmissiveInstancesMustFitIntoMemory) {
  // a file of a few MB: 10^5 objects of 10^6 emissive triangles would take 6 TB
  const std::string said = refusal(instances(100'000, 1'000'000, 1));
  EXPECT_TRUE(
      said.starts_with("many.glb: 100000 objects with 100000000000 emissive triangles, instances counted, "
                       "would need 12800.1 GB of memory, and "))
      << said;
  EXPECT_NE(said.find("place emissive meshes fewer times"), std::string::npos) << said;
  EXPECT_EQ(refusal(instances(100'000, 1'000'000, 0)), "");  // without emission nothing is listed
  EXPECT_EQ(refusal(instances(1000, 1000, 1)), "");
}

TEST(Needs, MemoryIsThatOfThisMachine) {
  const uint64_t there = availableMemory();
  EXPECT_GT(there, uint64_t{100} << 20);
  EXPECT_LT(there, uint64_t{1} << 48);
  EXPECT_NO_THROW(requireMemory(1 << 20, "a megabyte", ""));
  EXPECT_THROW(requireMemory(uint64_t{1} << 62, "all", ""), Error);
}

}  // namespace
}  // namespace wardmis
