// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/sphere_accel.h"

#include <algorithm>
#include <cmath>

#include "math/error.h"
#include "world/embree.h"

namespace wardmis {
namespace {

// Notes whatever box a ray comes through, and lets it go on.
void note(const RTCIntersectFunctionNArguments* args) {
  SphereAccel::Found& found = *static_cast<SphereAccel::Found*>(static_cast<embree::Query*>(args->context)->user);
  if (found.count < found.kMost)
    found.index[found.count++] = args->primID;
  else
    found.tooMany = true;
}

void bounds(const RTCBoundsFunctionArguments* args) {
  const SphereAccel::Sphere& s = static_cast<const SphereAccel::Sphere*>(args->geometryUserPtr)[args->primID];
  constexpr float kRoundings = 1e-5f;  // many more than there are
  const Vec3f c = s.center;
  const float r = s.radius * (1 + kRoundings) + kRoundings * std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)});
  RTCBounds& b = *args->bounds_o;
  b.lower_x = c.x - r, b.lower_y = c.y - r, b.lower_z = c.z - r;
  b.upper_x = c.x + r, b.upper_y = c.y + r, b.upper_z = c.z + r;
}

}  // namespace

struct SphereAccel::Impl {
  std::vector<Sphere> spheres;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  ~Impl() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

SphereAccel::SphereAccel() = default;
SphereAccel::~SphereAccel() = default;
SphereAccel& SphereAccel::operator=(SphereAccel&&) noexcept = default;

SphereAccel::SphereAccel(const std::vector<Sphere>& spheres) : impl_(std::make_unique<Impl>()) {
  Impl& a = *impl_;
  a.spheres = spheres;
  a.device = rtcNewDevice("threads=1");
  if (a.device == nullptr) throw Error(ExitCode::kScene, "Embree could not be started");
  a.scene = rtcNewScene(a.device);
  rtcSetSceneFlags(a.scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry g = rtcNewGeometry(a.device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(g, static_cast<unsigned>(a.spheres.size()));
  rtcSetGeometryUserData(g, a.spheres.data());
  rtcSetGeometryBoundsFunction(g, bounds, nullptr);
  rtcSetGeometryIntersectFunction(g, note);
  rtcCommitGeometry(g);
  rtcAttachGeometry(a.scene, g);
  rtcReleaseGeometry(g);
  rtcCommitScene(a.scene);
  const RTCError e = rtcGetDeviceError(a.device);
  if (e == RTC_ERROR_OUT_OF_MEMORY)
    throw Error(ExitCode::kMemory, "not enough memory for the scene's lamps", "close other programs, or remove lamps");
  if (e != RTC_ERROR_NONE) throw Error(ExitCode::kScene, "Embree failed on the scene's lamps");
}

void SphereAccel::find(Vec3f origin, Vec3f direction, float tMax, Found& found) const {
  RTCRayHit rh{};
  rh.ray.org_x = origin.x, rh.ray.org_y = origin.y, rh.ray.org_z = origin.z;
  rh.ray.dir_x = direction.x, rh.ray.dir_y = direction.y, rh.ray.dir_z = direction.z;
  rh.ray.tfar = tMax;
  rh.ray.mask = ~0u;
  rh.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  embree::trace(impl_->scene, rh, {}, nullptr, &found);
  // the same order, whatever instructions the processor has
  std::sort(found.index.begin(), found.index.begin() + static_cast<std::ptrdiff_t>(found.count));
}

}  // namespace wardmis
