// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/glb_mesh.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

namespace wardmis {
namespace {

constexpr const char* kExportAgain = "export the scene again";
constexpr size_t kGrain = 1 << 15;
constexpr uint64_t kMostTriangles = uint64_t(1) << 31;

enum Mode { kTriangles = 4, kStrip = 5, kFan = 6 };

// 0, 1, 2, ...: what a primitive without indices means.
Array<uint32_t> consecutive(size_t n) {
  std::vector<uint32_t> out(n);
  tbb::parallel_for(tbb::blocked_range<size_t>(0, n, kGrain), [&](const auto& range) {
    std::iota(out.begin() + range.begin(), out.begin() + range.end(), static_cast<uint32_t>(range.begin()));
  });
  return Array<uint32_t>::of(std::move(out));
}

// The triangles of a strip or a fan; every second one of a strip is turned so that all face the same way.
Array<uint32_t> unrolled(const Array<uint32_t>& in, Mode mode) {
  std::vector<uint32_t> out;
  out.reserve(3 * (in.size() - 2));
  for (size_t i = 0; i + 2 < in.size(); i++) {
    const bool odd = mode == kStrip && i % 2 == 1;
    const size_t first = mode == kFan ? 0 : i;
    out.insert(out.end(), {in[first], in[i + (odd ? 2 : 1)], in[i + (odd ? 1 : 2)]});
  }
  return Array<uint32_t>::of(std::move(out));
}

}  // namespace

Meshes::Meshes(const Json& root, Accessors& accessors, Buffers& buffers, Materials& materials, LeftOut& leftOut)
    : meshes_(root.array("meshes")),
      accessors_(accessors),
      buffers_(buffers),
      materials_(materials),
      leftOut_(leftOut) {}

int Meshes::use(const Json& use) {
  const size_t i = use.index(meshes_.size(), "meshes");
  const auto [entry, isNew] = meshOf_.try_emplace(i, -1);
  if (isNew) {
    Mesh mesh = read(meshes_[i]);
    if (!mesh.parts.empty()) {
      read_.push_back(std::move(mesh));
      entry->second = static_cast<int>(read_.size() - 1);
    }
  }
  return entry->second;
}

Mesh Meshes::read(const Json& json) {
  Mesh mesh;
  mesh.name = json.name();
  const JsonArray primitives = json.at("primitives").array();
  if (primitives.size() == 0) json.at("primitives").failExpected("at least one primitive");

  // Primitives with the same vertex arrays become one part.
  std::map<std::tuple<size_t, size_t, size_t>, size_t> partOf;
  for (size_t i = 0; i < primitives.size(); i++) {
    const Json primitive = primitives[i];
    const auto mode = primitive.integerOr("mode", kTriangles, 0, 6);
    if (mode < kTriangles) {
      leftOut_.add("points and lines of mesh " + json.described(), "only triangles are rendered");
      continue;
    }
    if (primitive.find("targets"))
      leftOut_.add("morph targets of mesh " + json.described(), "the base shape is rendered");
    const Json attributes = primitive.at("attributes");
    attributes.forEachMember([&](std::string_view key, const Json&) {
      if (key != "POSITION" && key != "NORMAL" && key != "TEXCOORD_0")
        leftOut_.add("vertex attribute " + cleaned(key), "the renderer does not use it");
    });

    const int material = materials_.use(primitive);
    const Json position = attributes.at("POSITION");
    const auto normal = attributes.find("NORMAL"), uv = attributes.find("TEXCOORD_0");
    const bool needsUvs = materials_.needsUvs(material);
    if (needsUvs && !uv)
      leftOut_.add("textures and direction of anisotropy on mesh " + json.described(),
                   "it has no TEXCOORD_0: textures are looked up at (0, 0)");
    if (uv && !needsUvs) leftOut_.add("vertex attribute TEXCOORD_0", "no texture and no anisotropy needs it there");

    constexpr size_t kNone = SIZE_MAX, kAny = SIZE_MAX;
    const auto key =
        std::make_tuple(position.index(kAny, "accessors"), normal ? normal->index(kAny, "accessors") : kNone,
                        uv && needsUvs ? uv->index(kAny, "accessors") : kNone);
    const auto [entry, isNewPart] = partOf.try_emplace(key, mesh.parts.size());
    if (isNewPart) {
      MeshPart part;
      part.positions = accessors_.read<Vec3f>(position);
      const auto checkCount = [&](const Json& attribute, size_t count) {
        if (count != part.positions.size())
          attribute.fail(fmt::format("has {} elements, but POSITION has {}", count, part.positions.size()),
                         kExportAgain);
      };
      if (normal) {
        part.normals = accessors_.read<Vec3f>(*normal);
        checkCount(*normal, part.normals.size());
      }
      if (uv && needsUvs) {
        const Array<Vec2f> file = accessors_.read<Vec2f>(*uv);
        checkCount(*uv, file.size());
        buffers_.budget.charge(file.size() * sizeof(Vec2f), *uv);
        std::vector<Vec2f> turned(file.size());
        tbb::parallel_for(tbb::blocked_range<size_t>(0, file.size(), kGrain), [&](const auto& range) {
          for (size_t k = range.begin(); k < range.end(); k++) turned[k] = {file[k].x, 1 - file[k].y};
        });
        part.uvs = Array<Vec2f>::of(std::move(turned));
      }
      mesh.parts.push_back(std::move(part));
    }
    MeshPart& part = mesh.parts[entry->second];
    Array<uint32_t> indices = triangles(primitive, part.positions, position);
    if (!indices.empty()) part.primitives.push_back({material, std::move(indices)});
  }
  std::erase_if(mesh.parts, [](const MeshPart& part) { return part.primitives.empty(); });
  return mesh;
}

Array<uint32_t> Meshes::triangles(const Json& primitive, const Array<Vec3f>& positions, const Json& position) {
  const auto json = primitive.find("indices");
  const Json place = json.value_or(position);
  const Mode mode = static_cast<Mode>(primitive.integerOr("mode", kTriangles, 0, 6));
  Array<uint32_t> indices;
  if (json) indices = accessors_.read<uint32_t>(*json);
  const size_t count = json ? indices.size() : positions.size();
  if (count < 3 || (mode == kTriangles && count % 3 != 0))
    place.fail(fmt::format("{} vertices do not make triangles", count), kExportAgain);
  const size_t triangles = mode == kTriangles ? count / 3 : count - 2;
  triangles_ += triangles;
  if (triangles_ > kMostTriangles) place.fail("the scene has more than 2^31 triangles", "split the scene");
  buffers_.budget.charge(triangles * 3 * sizeof(uint32_t), place);

  if (!json) indices = consecutive(count);
  if (mode != kTriangles) indices = unrolled(indices, mode);
  return withoutDegenerate(place, std::move(indices), positions.data);
}

Array<uint32_t> Meshes::withoutDegenerate(const Json& place, Array<uint32_t> indices,
                                          std::span<const Vec3f> positions) {
  using Range = tbb::blocked_range<size_t>;
  const uint32_t largest = tbb::parallel_reduce(
      Range(0, indices.size(), kGrain), uint32_t(0),
      [&](const Range& range, uint32_t most) {
        for (size_t i = range.begin(); i < range.end(); i++) most = std::max(most, indices[i]);
        return most;
      },
      [](uint32_t a, uint32_t b) { return std::max(a, b); });
  if (largest >= positions.size())
    place.fail(fmt::format("refers to vertex {}, but there are {}", largest, positions.size()), kExportAgain);

  // A triangle is kept if its normal can be computed in single precision, as the renderer does.
  const auto squaredArea = [&](size_t t) {
    const Vec3f a = positions[indices[3 * t]], b = positions[indices[3 * t + 1]], c = positions[indices[3 * t + 2]];
    const Vec3f n = cross(b - a, c - a);
    return dot(n, n);
  };
  const auto isGood = [](float area2) { return (area2 > 0) & (area2 <= FLT_MAX); };
  const std::vector<uint32_t> bad = tbb::parallel_reduce(
      Range(0, indices.size() / 3, kGrain), std::vector<uint32_t>(),
      [&](const Range& range, std::vector<uint32_t> list) {
        for (size_t t = range.begin(); t < range.end(); t++)
          if (!isGood(squaredArea(t))) list.push_back(static_cast<uint32_t>(t));
        return list;
      },
      [](std::vector<uint32_t> a, const std::vector<uint32_t>& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
      });
  if (bad.empty()) return indices;
  std::vector<uint32_t> kept;
  kept.reserve(indices.size() - 3 * bad.size());
  size_t from = 0;
  for (const size_t t : bad) {
    if (!(squaredArea(t) <= FLT_MAX))
      place.fail(fmt::format("triangle {} is too large for single precision", t),
                 "scale it down: at most 9 * 10^18 square metres can be used");
    kept.insert(kept.end(), indices.data.begin() + from, indices.data.begin() + 3 * t);
    from = 3 * t + 3;
  }
  kept.insert(kept.end(), indices.data.begin() + from, indices.data.end());
  degenerate_ += bad.size();
  return Array<uint32_t>::of(std::move(kept));
}

void Meshes::finish(Scene& scene) {
  scene.meshes = std::move(read_);
  scene.degenerateTriangles = degenerate_;
  const size_t unused = meshes_.size() - meshOf_.size();
  if (unused > 0) leftOut_.add(std::to_string(unused) + " meshes", "no object of the scene uses them");
}

}  // namespace wardmis
