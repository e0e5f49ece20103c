// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/accel.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <unordered_set>

#include "math/error.h"
#include "math/random.h"
#include "world/embree.h"

namespace wardmis {
namespace {

using embree::Query;

void setRay(RTCRay& out, const Ray& r) {
  out.org_x = r.origin.x, out.org_y = r.origin.y, out.org_z = r.origin.z;
  out.dir_x = r.direction.x, out.dir_y = r.direction.y, out.dir_z = r.direction.z;
  // what lies where a ray begins it meets if it leaves a triangle of several in one place
  const bool fromThere = r.left.valid() && r.tMin < 1e-14f;
  out.tnear = fromThere ? 0 : r.tMin, out.tfar = r.tMax;
  out.time = r.path.time, out.mask = ~0u, out.id = 0, out.flags = r.kind;
}

void setTransform(RTCGeometry g, const Placement& placement) {
  if (placement.motion == nullptr) {
    rtcSetGeometryTransform(g, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, &placement.toWorld);
    return;
  }
  const std::span<const Decomposed> steps = placement.motion->steps();
  rtcSetGeometryTimeStepCount(g, static_cast<unsigned>(steps.size()));
  for (size_t i = 0; i < steps.size(); ++i) {
    const Decomposed& d = steps[i];
    RTCQuaternionDecomposition q;
    rtcInitQuaternionDecomposition(&q);
    rtcQuaternionDecompositionSetQuaternion(&q, d.quaternion[3], d.quaternion[0], d.quaternion[1], d.quaternion[2]);
    rtcQuaternionDecompositionSetScale(&q, d.xx, d.yy, d.zz);
    rtcQuaternionDecompositionSetSkew(&q, d.xy, d.xz, d.yz);
    rtcQuaternionDecompositionSetTranslation(&q, d.translation.x, d.translation.y, d.translation.z);
    rtcSetGeometryTransformQuaternion(g, static_cast<unsigned>(i), &q);
  }
}

}  // namespace

struct Accel::Impl {
  struct HashOfId {
    size_t operator()(const PrimitiveId& id) const { return combine(combine(id.placement, id.shape), id.index); }
  };
  // A geometry of the top level: a shape of a flat placement, or an instance of a shared mesh.
  struct Top {
    uint32_t placement, shape;
  };
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<RTCScene> shared;
  std::vector<Top> tops;
  const Geometry* geometry = nullptr;
  // Placements that some kind of ray does not see; empty if all see all.
  std::vector<uint8_t> visibility;
  std::unordered_set<PrimitiveId, HashOfId> doubled;  // triangles in whose place there are others

  ~Impl() {
    if (scene != nullptr) rtcReleaseScene(scene);
    for (RTCScene s : shared)
      if (s != nullptr) rtcReleaseScene(s);
    if (device != nullptr) rtcReleaseDevice(device);
  }

  // Rejects hits on what the ray's kind does not see. Set only on geometries that need it.
  static void filter(const RTCFilterFunctionNArguments* args) {
    const auto* impl = static_cast<const Impl*>(args->geometryUserPtr);
    for (unsigned i = 0; i < args->N; ++i) {
      if (args->valid[i] == 0) continue;
      const unsigned instance = RTCHitN_instID(args->hit, args->N, i, 0);
      const unsigned top = instance != RTC_INVALID_GEOMETRY_ID ? instance : RTCHitN_geomID(args->hit, args->N, i);
      const uint8_t seenBy = impl->visibility[impl->tops[top].placement];
      if ((seenBy & RTCRayN_flags(args->ray, args->N, i)) == 0) args->valid[i] = 0;
    }
  }

  // Rejects, besides, what the ray leaves, and the inside of curves and spheres where it is not seen.
  static void filterStrands(const RTCFilterFunctionNArguments* args) {
    const auto* impl = static_cast<const Impl*>(args->geometryUserPtr);
    const Ray& ray = *static_cast<const Query*>(args->context)->ray;
    for (unsigned i = 0; i < args->N; ++i) {
      if (args->valid[i] == 0) continue;
      const unsigned instance = RTCHitN_instID(args->hit, args->N, i, 0), id = RTCHitN_geomID(args->hit, args->N, i);
      const bool instanced = instance != RTC_INVALID_GEOMETRY_ID;
      const Top& top = impl->tops[instanced ? instance : id];
      const uint32_t shape = top.shape + (instanced ? id : 0);
      const Strands& strands = *impl->geometry->shapes[shape].strands;
      const PrimitiveId met{top.placement, shape, strands.strandOf(RTCHitN_primID(args->hit, args->N, i))};
      const float away = RTCHitN_Ng_x(args->hit, args->N, i) * RTCRayN_dir_x(args->ray, args->N, i) +
                         RTCHitN_Ng_y(args->hit, args->N, i) * RTCRayN_dir_y(args->ray, args->N, i) +
                         RTCHitN_Ng_z(args->hit, args->N, i) * RTCRayN_dir_z(args->ray, args->N, i);
      const bool seen = impl->visibility.empty() || (impl->visibility[top.placement] & ray.kind) != 0;
      const bool solid = strands.form != Form::kRibbons && !strands.inside;
      if (!seen || met == ray.left || (solid && away > 0)) args->valid[i] = 0;
    }
  }

  // Of a triangle that a filter is told of; of a strand, none.
  PrimitiveId idOf(const RTCFilterFunctionNArguments* args, unsigned i) const {
    const unsigned instance = RTCHitN_instID(args->hit, args->N, i, 0), id = RTCHitN_geomID(args->hit, args->N, i);
    const bool instanced = instance != RTC_INVALID_GEOMETRY_ID;
    const Top& top = tops[instanced ? instance : id];
    const uint32_t shape = top.shape + (instanced ? id : 0);
    if (geometry->shapes[shape].strands != nullptr) return {};
    return {top.placement, shape, RTCHitN_primID(args->hit, args->N, i)};
  }
  // Rejects the triangle that the ray leaves and the one that it is aimed at.
  static void filterOwn(const RTCFilterFunctionNArguments* args) {
    const Query& query = *static_cast<const Query*>(args->context);
    for (unsigned i = 0; i < args->N; ++i) {
      if (args->valid[i] == 0) continue;
      const PrimitiveId met = static_cast<const Impl*>(query.user)->idOf(args, i);
      if (met.valid() && (met == query.ray->left || met == query.ray->aimed)) args->valid[i] = 0;
    }
  }
  RTCFilterFunctionN filterFor(const Ray& ray) const {
    return !doubled.empty() && (ray.left.valid() || ray.aimed.valid()) ? filterOwn : nullptr;
  }

  // What is found of triangles in the place of one.
  struct Search {
    const Impl& impl;
    PrimitiveId own;
    Vec3f normal;  // unit, world space
    std::vector<PrimitiveId> found;
  };
  static void filterSearch(const RTCFilterFunctionNArguments* args) {
    Search& search = *static_cast<Search*>(static_cast<const Query*>(args->context)->user);
    for (unsigned i = 0; i < args->N; ++i) {
      if (args->valid[i] == 0) continue;
      args->valid[i] = 0;
      const PrimitiveId met = search.impl.idOf(args, i);
      if (!met.valid() || met == search.own) continue;
      const Placement& p = search.impl.geometry->placements[met.placement];
      Vec3f n{RTCHitN_Ng_x(args->hit, args->N, i), RTCHitN_Ng_y(args->hit, args->N, i),
              RTCHitN_Ng_z(args->hit, args->N, i)};
      if (!p.flat) n = p.at(kMiddle).toWorld.normal(n);
      if (std::abs(dot(n, search.normal)) > 0.999f * length(n)) search.found.push_back(met);
    }
  }
  // Looks from a few points of each triangle as far as rounding may take them. What lies in its place only between
  // these points is not seen.
  void findShared() {
    constexpr uint64_t kMost = 1 << 22;  // triangles that are looked at, evenly
    constexpr float kRoundings = 0x1p-21f;
    constexpr float kPoints[][2] = {{1 / 3.f, 1 / 3.f}, {0.1f, 0.1f}, {0.8f, 0.1f}, {0.1f, 0.8f}};
    const uint64_t step = 1 + geometry->triangles / kMost;
    tbb::enumerable_thread_specific<std::vector<PrimitiveId>> all;
    const auto look = [&](uint32_t placement, uint32_t shape, uint32_t triangle) {
      const Corners c = Geometry::corners(geometry->placements[placement], geometry->shapes[shape], triangle);
      const Vec3f ab = c[1] - c[0], ac = c[2] - c[0], normal = cross(ab, ac);
      const float size = length(normal);
      if (!(size > 0)) return;
      const Vec3f n = normal / size;
      const auto most = [](float x, float y, float z) { return std::max({std::abs(x), std::abs(y), std::abs(z)}); };
      const float reach = std::abs(n.x) * most(c[0].x, c[1].x, c[2].x) + std::abs(n.y) * most(c[0].y, c[1].y, c[2].y) +
                          std::abs(n.z) * most(c[0].z, c[1].z, c[2].z) + 0.5f * std::sqrt(size);
      Search search{*this, {placement, shape, triangle}, n, {}};
      for (const auto& q : kPoints) {
        Ray ray;
        ray.origin = c[0] + ab * q[0] + ac * q[1] - n * (kRoundings * reach);
        ray.direction = n;
        ray.tMin = 0, ray.tMax = 2 * kRoundings * reach;
        ray.path.time = kMiddle;
        RTCRayHit rh;
        setRay(rh.ray, ray);
        rh.hit.geomID = rh.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        embree::trace(scene, rh, ray, filterSearch, &search);
      }
      if (search.found.empty()) return;
      std::vector<PrimitiveId>& to = all.local();
      to.push_back(search.own);
      to.insert(to.end(), search.found.begin(), search.found.end());
    };
    for (uint32_t p = 0; p < geometry->placements.size(); ++p)
      for (uint32_t k = 0; k < geometry->placements[p].shapes; ++k) {
        const uint32_t s = geometry->placements[p].firstShape + k;
        if (geometry->shapes[s].strands != nullptr) continue;
        const uint64_t count = (geometry->shapes[s].triangles + step - 1) / step;
        tbb::parallel_for(tbb::blocked_range<uint64_t>(0, count, 4096), [&](const tbb::blocked_range<uint64_t>& range) {
          for (uint64_t i = range.begin(); i < range.end(); ++i) look(p, s, static_cast<uint32_t>(i * step));
        });
      }
    for (const std::vector<PrimitiveId>& some : all) doubled.insert(some.begin(), some.end());
  }

  RTCGeometry surfaceOf(const Shape& s) { return s.strands != nullptr ? strands(*s.strands) : triangles(s); }
  RTCGeometry strands(const Strands& s) {
    const RTCGeometryType type = s.form == Form::kRibbons ? RTC_GEOMETRY_TYPE_FLAT_CATMULL_ROM_CURVE
                                 : s.form == Form::kTubes ? RTC_GEOMETRY_TYPE_ROUND_CATMULL_ROM_CURVE
                                 : s.form == Form::kCones ? RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE
                                                          : RTC_GEOMETRY_TYPE_SPHERE_POINT;
    RTCGeometry g = rtcNewGeometry(device, type);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, s.points.data(), 0,
                               sizeof(ControlPoint), s.points.size());
    if (s.form != Form::kSpheres)
      rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, s.first.data(), 0, sizeof(uint32_t),
                                 s.first.size());
    if (s.form == Form::kRibbons) rtcSetGeometryTessellationRate(g, static_cast<float>(s.pieces));
    rtcSetGeometryUserData(g, this);
    rtcSetGeometryIntersectFilterFunction(g, filterStrands);
    rtcSetGeometryOccludedFilterFunction(g, filterStrands);
    return g;
  }
  RTCGeometry triangles(const Shape& s) {
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    const size_t steps = s.motion != nullptr ? s.motion->size() : 1;
    rtcSetGeometryTimeStepCount(g, static_cast<unsigned>(steps));
    for (size_t i = 0; i < steps; ++i)
      rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, static_cast<unsigned>(i), RTC_FORMAT_FLOAT3,
                                 s.motion != nullptr ? (*s.motion)[i] : s.positions, 0, sizeof(Vec3f), s.vertices);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, s.indices, 0, 3 * sizeof(uint32_t),
                               s.triangles);
    return g;
  }
  void finish(RTCGeometry g, const Shape& s, bool filtered) {
    if (filtered && s.strands == nullptr) {
      rtcSetGeometryUserData(g, this);
      rtcSetGeometryIntersectFilterFunction(g, filter);
      rtcSetGeometryOccludedFilterFunction(g, filter);
    }
    rtcSetGeometryBuildQuality(g, RTC_BUILD_QUALITY_HIGH);
    rtcCommitGeometry(g);
  }
  RTCScene newScene() {
    RTCScene s = rtcNewScene(device);
    rtcSetSceneFlags(s, static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST
#if RTC_VERSION_MAJOR < 4
                                                   | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION
#endif
                                                   ));
    rtcSetSceneBuildQuality(s, RTC_BUILD_QUALITY_HIGH);
    return s;
  }
  void check(const char* doing) {
    const RTCError e = rtcGetDeviceError(device);
    if (e == RTC_ERROR_NONE) return;
    if (e == RTC_ERROR_OUT_OF_MEMORY)
      throw Error(ExitCode::kMemory, fmt::format("not enough memory while {}", doing),
                  "close other programs, or simplify the scene");
    throw Error(ExitCode::kScene, fmt::format("Embree failed while {} (code {})", doing, static_cast<int>(e)));
  }
};

Accel::Accel(const Geometry& geometry, int threads) : impl_(std::make_unique<Impl>()) {
  Impl& a = *impl_;
  a.geometry = &geometry;
  a.device = rtcNewDevice(threads > 0 ? fmt::format("threads={}", threads).c_str() : nullptr);
  if (a.device == nullptr) throw Error(ExitCode::kScene, "Embree could not be started");

  std::vector<uint8_t> filtered(geometry.placements.size(), 0);
  std::vector<uint8_t> filteredShape(geometry.shapes.size(), 0);
  bool any = false;
  for (size_t p = 0; p < geometry.placements.size(); ++p) {
    const Placement& placement = geometry.placements[p];
    if (placement.visibility == kSeenByAll) continue;
    any = true;
    filtered[p] = 1;
    for (uint32_t s = 0; s < placement.shapes; ++s) filteredShape[placement.firstShape + s] = 1;
  }
  if (any)
    for (const Placement& p : geometry.placements) a.visibility.push_back(p.visibility);

  a.scene = a.newScene();
  std::vector<RTCScene> sharedOfShape(geometry.shapes.size(), nullptr);  // by a placement's first shape
  for (uint32_t p = 0; p < geometry.placements.size(); ++p) {
    const Placement& placement = geometry.placements[p];
    if (placement.flat) {
      for (uint32_t s = placement.firstShape; s < placement.firstShape + placement.shapes; ++s) {
        RTCGeometry g = a.surfaceOf(geometry.shapes[s]);
        a.finish(g, geometry.shapes[s], filtered[p] != 0);
        rtcAttachGeometryByID(a.scene, g, static_cast<unsigned>(a.tops.size()));
        rtcReleaseGeometry(g);
        a.tops.push_back({p, s});
      }
      continue;
    }
    RTCScene& sharedScene = sharedOfShape[placement.firstShape];
    if (sharedScene == nullptr) {
      sharedScene = a.shared.emplace_back(a.newScene());
      for (uint32_t s = 0; s < placement.shapes; ++s) {
        const Shape& shape = geometry.shapes[placement.firstShape + s];
        RTCGeometry g = a.surfaceOf(shape);
        a.finish(g, shape, filteredShape[placement.firstShape + s] != 0);
        rtcAttachGeometryByID(sharedScene, g, s);
        rtcReleaseGeometry(g);
      }
      rtcCommitScene(sharedScene);
    }
    RTCGeometry g = rtcNewGeometry(a.device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(g, sharedScene);
    setTransform(g, placement);
    rtcCommitGeometry(g);
    rtcAttachGeometryByID(a.scene, g, static_cast<unsigned>(a.tops.size()));
    rtcReleaseGeometry(g);
    a.tops.push_back({p, placement.firstShape});
  }
  rtcCommitScene(a.scene);
  a.check("building the acceleration structure");
  a.findShared();
}

Accel::~Accel() = default;
Accel::Accel(Accel&&) noexcept = default;

Hit Accel::intersect(const Ray& ray) const {
  RTCRayHit rh;
  setRay(rh.ray, ray);
  rh.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rh.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  embree::trace(impl_->scene, rh, ray, impl_->filterFor(ray), impl_.get());
  Hit h;
  if (rh.hit.geomID == RTC_INVALID_GEOMETRY_ID) return h;
  h.t = rh.ray.tfar;
  h.u = rh.hit.u, h.v = rh.hit.v;
  h.normal = {rh.hit.Ng_x, rh.hit.Ng_y, rh.hit.Ng_z};
  h.triangle = rh.hit.primID;
  if (rh.hit.instID[0] == RTC_INVALID_GEOMETRY_ID) {
    const Impl::Top top = impl_->tops[rh.hit.geomID];
    h.placement = top.placement, h.shape = top.shape;
  } else {
    const Impl::Top top = impl_->tops[rh.hit.instID[0]];
    h.placement = top.placement, h.shape = top.shape + rh.hit.geomID;
  }
  if (!impl_->doubled.empty()) [[unlikely]]
    h.shared = shared({h.placement, h.shape, h.triangle});
  return h;
}

bool Accel::occluded(const Ray& ray) const {
  RTCRay r;
  setRay(r, ray);
  embree::shadow(impl_->scene, r, ray, impl_->filterFor(ray), impl_.get());
  return r.tfar < 0;
}

bool Accel::shared(PrimitiveId triangle) const { return !impl_->doubled.empty() && impl_->doubled.contains(triangle); }

const char* Accel::libraryVersion() { return "Embree " RTC_VERSION_STRING; }

}  // namespace wardmis
