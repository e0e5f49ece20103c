// SPDX-License-Identifier: GPL-3.0-or-later
// Embree (3.13 and 4), and its two queries. Nothing else knows which one it is.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "world/accel.h"

namespace wardmis::embree {

// Embree reads rays through these; the visibility kind travels in ray.flags for the filter, the ray itself beside its
// context.
#if RTC_VERSION_MAJOR >= 4
struct Query : RTCRayQueryContext {
  const Ray* ray;
  void* user;
};
// filter: called for whatever is met, besides the geometries' own; user: for it.
inline void trace(RTCScene scene, RTCRayHit& rh, const Ray& ray, RTCFilterFunctionN filter = nullptr,
                  void* user = nullptr) {
  Query query;
  rtcInitRayQueryContext(&query);
  query.ray = &ray, query.user = user;
  RTCIntersectArguments args;
  rtcInitIntersectArguments(&args);
  args.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
  if (filter != nullptr)
    args.filter = filter,
    args.flags = static_cast<RTCRayQueryFlags>(args.flags | RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER);
  args.context = &query;
  rtcIntersect1(scene, &rh, &args);
}
inline void shadow(RTCScene scene, RTCRay& r, const Ray& ray, RTCFilterFunctionN filter = nullptr,
                   void* user = nullptr) {
  Query query;
  rtcInitRayQueryContext(&query);
  query.ray = &ray, query.user = user;
  RTCOccludedArguments args;
  rtcInitOccludedArguments(&args);
  args.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
  if (filter != nullptr)
    args.filter = filter,
    args.flags = static_cast<RTCRayQueryFlags>(args.flags | RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER);
  args.context = &query;
  rtcOccluded1(scene, &r, &args);
}
#else
struct Query : RTCIntersectContext {
  const Ray* ray;
  void* user;
};
inline Query queryOf(const Ray& ray, RTCFilterFunctionN filter, void* user) {
  Query query;
  rtcInitIntersectContext(&query);
  query.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  query.filter = filter;
  query.ray = &ray, query.user = user;
  return query;
}
// filter: called for whatever is met, besides the geometries' own; user: for it.
inline void trace(RTCScene scene, RTCRayHit& rh, const Ray& ray, RTCFilterFunctionN filter = nullptr,
                  void* user = nullptr) {
  Query query = queryOf(ray, filter, user);
  rtcIntersect1(scene, &query, &rh);
}
inline void shadow(RTCScene scene, RTCRay& r, const Ray& ray, RTCFilterFunctionN filter = nullptr,
                   void* user = nullptr) {
  Query query = queryOf(ray, filter, user);
  rtcOccluded1(scene, &query, &r);
}
#endif

}  // namespace wardmis::embree
