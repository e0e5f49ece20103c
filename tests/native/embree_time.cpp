// SPDX-License-Identifier: GPL-3.0-or-later
// Stands before Embree's two queries (LD_PRELOAD) and tells at the end, in a line of JSON on standard error, how many
// there were and how many seconds Embree alone takes for them: some are kept, and made once more with nothing between
// them, on warm caches. For one thread. Run by ./dev bench paths.
#include <dlfcn.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <vector>

#include "world/embree.h"

namespace {

using wardmis::Ray;
using wardmis::embree::Query;

// Runs of one after the other, out of many times as many: they are to be those of all of an image, and with what they
// meet small enough for the caches.
constexpr unsigned long long kRun = 256, kOutOf = 16 * kRun;
constexpr size_t kKept = 80 * kRun;
constexpr int kRounds = 10;

double seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

#if RTC_VERSION_MAJOR >= 4
using IntersectArguments = RTCIntersectArguments;
using OccludedArguments = RTCOccludedArguments;
#else
struct IntersectArguments {};
using OccludedArguments = IntersectArguments;
#endif

struct Kept {
  RTCScene scene;
  bool shadow;
  Query query;
  Ray ray;
  IntersectArguments intersect;
  OccludedArguments occluded;
  RTCRayHit hit;
};

// Calls Embree's own function of that name.
template <class F>
F* own(const char* name) {
  return reinterpret_cast<F*>(dlsym(RTLD_NEXT, name));
}

class Queries {
 public:
  ~Queries() { std::fprintf(stderr, "{\"queries\": %llu, \"seconds\": %.9g}\n", all_, perQuery_ * double(all_)); }

  // Those that note what they meet on the stack are not made again: the place is gone.
  template <class Call>
  void add(const Kept& k, const Call& call) {
    if (all_++ % kOutOf >= kRun || perQuery_ > 0) return;
    constexpr ptrdiff_t kStack = 8 << 20;
    const ptrdiff_t apart = static_cast<const char*>(k.query.user) - reinterpret_cast<const char*>(&k);
    if (std::abs(apart) < kStack) return;
    kept_.push_back(k);
    if (kept_.size() < kKept) return;
    double best = 1e30;
    for (int round = 0; round < kRounds; ++round) {
      std::vector<Kept> again = kept_;
      const double start = seconds();
      for (Kept& each : again) {
        each.query.ray = &each.ray;
        call(each);
      }
      best = std::min(best, seconds() - start);
    }
    perQuery_ = best / double(kKept);
    kept_ = {};
  }

 private:
  unsigned long long all_ = 0;
  double perQuery_ = 0;
  std::vector<Kept> kept_;
};
Queries queries;

#if RTC_VERSION_MAJOR >= 4
void again(Kept& k) {
  static auto* const intersect = own<decltype(rtcIntersect1)>("rtcIntersect1");
  static auto* const occluded = own<decltype(rtcOccluded1)>("rtcOccluded1");
  k.intersect.context = k.occluded.context = &k.query;
  if (k.shadow)
    occluded(k.scene, &k.hit.ray, &k.occluded);
  else
    intersect(k.scene, &k.hit, &k.intersect);
}
#else
void again(Kept& k) {
  static auto* const intersect = own<decltype(rtcIntersect1)>("rtcIntersect1");
  static auto* const occluded = own<decltype(rtcOccluded1)>("rtcOccluded1");
  if (k.shadow)
    occluded(k.scene, &k.query, &k.hit.ray);
  else
    intersect(k.scene, &k.query, &k.hit);
}
#endif

}  // namespace

extern "C" {

#if RTC_VERSION_MAJOR >= 4
void rtcIntersect1(RTCScene scene, RTCRayHit* hit, RTCIntersectArguments* arguments) {
  static auto* const call = own<decltype(rtcIntersect1)>("rtcIntersect1");
  const auto& query = *static_cast<const Query*>(arguments->context);
  queries.add({scene, false, query, *query.ray, *arguments, {}, *hit}, again);
  call(scene, hit, arguments);
}
void rtcOccluded1(RTCScene scene, RTCRay* ray, RTCOccludedArguments* arguments) {
  static auto* const call = own<decltype(rtcOccluded1)>("rtcOccluded1");
  const auto& query = *static_cast<const Query*>(arguments->context);
  queries.add({scene, true, query, *query.ray, {}, *arguments, {*ray, {}}}, again);
  call(scene, ray, arguments);
}
#else
void rtcIntersect1(RTCScene scene, RTCIntersectContext* context, RTCRayHit* hit) {
  static auto* const call = own<decltype(rtcIntersect1)>("rtcIntersect1");
  const auto& query = *static_cast<const Query*>(context);
  queries.add({scene, false, query, *query.ray, {}, {}, *hit}, again);
  call(scene, context, hit);
}
void rtcOccluded1(RTCScene scene, RTCIntersectContext* context, RTCRay* ray) {
  static auto* const call = own<decltype(rtcOccluded1)>("rtcOccluded1");
  const auto& query = *static_cast<const Query*>(context);
  queries.add({scene, true, query, *query.ray, {}, {}, {*ray, {}}}, again);
  call(scene, context, ray);
}
#endif
}
