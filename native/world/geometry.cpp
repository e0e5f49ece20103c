// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/geometry.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "math/error.h"

namespace wardmis {
namespace {

bool deforms(const Mesh& mesh) {
  return std::any_of(mesh.parts.begin(), mesh.parts.end(), [](const MeshPart& p) { return !p.movedPositions.empty(); });
}

LobeNumbers numberLobes(const Scene& scene, const std::vector<Shape>& shapes) {
  LobeNumbers n;
  for (const Shape& s : shapes) {
    LobeCounts own{};
    const Material& m = scene.materials[static_cast<size_t>(s.material)];
    if (m.closures.empty() && maxComponent(m.specular.value) > 0) own[static_cast<size_t>(LobeClass::kGlossy)] = 1;
    for (const Closure& c : m.closures) {
      const LobeCounts more = mostLobes(c);
      for (size_t k = 0; k < kLobeClasses; ++k) own[k] = static_cast<uint8_t>(own[k] + more[k]);
    }
    for (size_t k = 0; k < kLobeClasses; ++k) n.count[k] = std::max(n.count[k], own[k]);
    n.most = std::max(n.most, total(own));
  }
  n.most = std::min(n.most, size_t{kMaxTechniques - 2});
  const size_t room = withTechniques(n.most, [](auto k) { return Techniques<k()>::kLobes; });
  n.byClass = room > 1 && total(n.count) <= room;
  for (size_t k = 1; k < kLobeClasses; ++k) n.first[k] = static_cast<uint8_t>(n.first[k - 1] + n.count[k - 1]);
  return n;
}

}  // namespace

Corners movedCorners(const Shape& s, const uint32_t* i, float time) {
  const auto [first, t] = stepAt(s.motion->size(), time);
  const Vec3f *a = (*s.motion)[first], *b = (*s.motion)[first + 1];
  const auto mix = [&, t = t](uint32_t v) { return a[v] * (1 - t) + b[v] * t; };
  return {mix(i[0]), mix(i[1]), mix(i[2])};
}

namespace {

// Whether curves and spheres keep their shapes: it turns, mirrors and scales all alike.
bool keepsRound(const Affine& m) {
  constexpr float kRounding = 1e-5f;
  const float x = dot(m.x, m.x), y = dot(m.y, m.y), z = dot(m.z, m.z), most = kRounding * std::max({x, y, z});
  return std::max({std::abs(x - y), std::abs(x - z), std::abs(dot(m.x, m.y)), std::abs(dot(m.x, m.z)),
                   std::abs(dot(m.y, m.z))}) <= most;
}
bool hasStrands(const Mesh& mesh) {
  return std::ranges::any_of(mesh.parts, [](const MeshPart& p) { return !p.radii.empty(); });
}

}  // namespace

Geometry::Geometry(const Scene& scene, bool catchersAlone) {
  std::vector<uint32_t> uses(scene.meshes.size(), 0);
  for (const Instance& i : scene.instances) ++uses[static_cast<size_t>(i.mesh)];

  const auto addShapes = [&](const Mesh& mesh, const Affine* transform) {
    for (const MeshPart& part : mesh.parts) {
      if (!part.radii.empty()) {
        for (const Primitive& p : part.primitives) {
          strands.push_back(std::make_unique<const Strands>(part, p, transform));
          Shape shape{&part};
          shape.material = p.material, shape.strands = strands.back().get(), shape.primitive = &p;
          shapes.push_back(shape);
        }
        continue;
      }
      // A copy even where nothing moves: Embree reads 16 bytes at each vertex, also at the last one.
      std::vector<Vec3f>& placed = positions.emplace_back(part.positions.size() + 1);
      const Vec3f* own = placed.data();
      tbb::parallel_for(tbb::blocked_range<size_t>(0, part.positions.size(), 1 << 15), [&](const auto& range) {
        for (size_t v = range.begin(); v != range.end(); ++v)
          placed[v] = transform != nullptr ? transform->point(part.positions[v]) : part.positions[v];
      });
      const std::vector<const Vec3f*>* motion = nullptr;
      if (!part.movedPositions.empty()) {
        std::vector<const Vec3f*>& list = this->moved.emplace_back();
        for (const Array<Vec3f>& step : part.movedPositions) {
          positions.emplace_back(step.data.begin(), step.data.end()).emplace_back();
          list.push_back(positions.back().data());
        }
        motion = &list;
      }
      for (const Primitive& p : part.primitives)
        if (!p.indices.empty())
          shapes.push_back({&part, own, part.positions.size(), p.indices.data.data(),
                            static_cast<uint32_t>(p.indices.size() / 3), p.material, 0, motion});
    }
  };

  constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();
  std::vector<std::pair<uint32_t, uint32_t>> sharedShapes(scene.meshes.size(), {kNone, 0});
  placements.reserve(scene.instances.size());
  for (const Instance& instance : scene.instances) {
    const auto m = static_cast<size_t>(instance.mesh);
    if (catchersAlone && !instance.shadowCatcher) {
      placements.emplace_back().flat = true;
      continue;
    }
    const bool flat = uses[m] == 1 && !instance.motion && !deforms(scene.meshes[m]) &&
                      (!hasStrands(scene.meshes[m]) || keepsRound(instance.toWorld));
    auto& [first, count] = sharedShapes[m];
    if (flat || first == kNone) {
      first = static_cast<uint32_t>(shapes.size());
      addShapes(scene.meshes[m], flat ? &instance.toWorld : nullptr);
      count = static_cast<uint32_t>(shapes.size()) - first;
    }
    if (count == 0) continue;
    placements.push_back({instance.toWorld, instance.mesh, first, count, instance.holdout, instance.shadowCatcher, flat,
                          instance.terminator, translucence(instance.visibility, kSeenByTransmission), 0,
                          &instance.name, instance.object.get(),
                          instance.motion ? &frames.emplace_back(*instance.motion) : nullptr});
    for (uint32_t s = first; s < first + count; ++s) {
      triangles += shapes[s].triangles;
      if (const Strands* const own = shapes[s].strands)
        (own->form == Form::kSpheres ? spheres : segments) += own->segments();
    }
  }

  lobes = numberLobes(scene, shapes);

  // Bounds: of the vertices in use as placed (corners of the mesh's box for shared meshes).
  const float inf = std::numeric_limits<float>::infinity();
  lower = {inf, inf, inf}, upper = {-inf, -inf, -inf};
  const auto grow = [](Vec3f& lo, Vec3f& hi, Vec3f p) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
  };
  std::vector<std::pair<Vec3f, Vec3f>> boxes(shapes.size(), {lower, upper});
  tbb::parallel_for(size_t{0}, shapes.size(), [&](size_t s) {
    auto& [lo, hi] = boxes[s];
    const Shape& shape = shapes[s];
    if (shape.strands != nullptr) return shape.strands->growBox(lo, hi);
    for (size_t i = 0; i < size_t{shape.triangles} * 3; ++i) grow(lo, hi, shape.positions[shape.indices[i]]);
    if (shape.motion == nullptr) return;
    for (const Vec3f* step : *shape.motion)
      for (size_t i = 0; i < size_t{shape.triangles} * 3; ++i) grow(lo, hi, step[shape.indices[i]]);
  });
  for (const Placement& p : placements)
    for (uint32_t s = p.firstShape; s < p.firstShape + p.shapes; ++s)
      for (int k = 0; k < 8; ++k) {
        const auto& [lo, hi] = boxes[s];
        const Vec3f c{(k & 1) != 0 ? hi.x : lo.x, (k & 2) != 0 ? hi.y : lo.y, (k & 4) != 0 ? hi.z : lo.z};
        grow(lower, upper, p.flat ? c : p.toWorld.point(c));
        if (p.motion == nullptr) continue;
        const size_t steps = p.motion->steps().size();
        for (size_t i = 0; i < steps; ++i)
          grow(lower, upper, p.motion->at(static_cast<float>(i) / static_cast<float>(steps - 1)).point(c));
      }
  if (placements.empty()) lower = upper = {0, 0, 0};
  if (!isFinite(lower) || !isFinite(upper))
    throw Error(ExitCode::kScene, scene.path + ": an object's transform moves vertices beyond the range of numbers",
                "look for objects with extreme scales or positions");
}

}  // namespace wardmis
