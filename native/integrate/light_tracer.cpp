// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/light_tracer.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "program/operation.h"

namespace wardmis {
namespace {

constexpr uint32_t kChunk = 256;  // paths that one list is of
constexpr int kBand = 16;         // rows of the film that one thread sums

}  // namespace

std::string noLightPaths(const Scene& scene, const Geometry& geometry, const Emitters& emitters,
                         const RenderSettings& s) {
  const std::string none = "no paths from lights: ";
  if (!(s.fromLights.paths > 0)) return none + "none are asked for";
  if (s.fromLights.connections == 0 && s.fromLights.laterConnections == 0 && !s.fromLights.film)
    return none + "they are neither connected nor traced to the film";
  if (geometry.moves() || CameraRays(*scene.camera, scene.film).moves()) return none + "the scene moves";
  if (s.light) return none + "passes of light are wanted";
  for (const Placement& p : geometry.placements) {
    const std::string name = p.name != nullptr ? *p.name : "an object";
    if (p.shadowCatcher) return none + name + " is a shadow catcher";
    if (p.shapes > 0 && (p.visibility & kSeenByAll) != kSeenByAll)
      return none + name + " is hidden from some kinds of rays";
  }
  for (const Shape& shape : geometry.shapes) {
    const Material& m = scene.materials[static_cast<size_t>(shape.material)];
    if (!m.transparent) continue;
    if (m.opaqueShadow) return none + m.name + " lets light through that its shadow does not";
    if (m.program && (m.program->reads & (kReadsRay | kReadsShift)) != 0)
      return none + m.name + " lets light through by what kind of ray asks";
    if (std::ranges::any_of(m.closures,
                            [](const Closure& c) { return c.version == 3 && c.type != ClosureType::kTransparent; }))
      return none + m.name + " mixes transparency with what reflects, which Blender 3 counts otherwise for shadows";
  }
  if (!LightEmission(emitters, geometry).any()) return none + "no light has a power that they could share";
  return {};
}

template <size_t K>
double verticesPerPath(const KernelInput<K>& in) {
  constexpr uint32_t kTrial = 1 << 12;
  LightList list;
  Counts counts;
  traceLightPaths<K>(in, ~uint32_t{0} - kTrial, ~uint32_t{0}, list, counts);
  return std::max(double(list.vertices.size()), 1.0) / kTrial;
}

namespace {

// Adds what some paths have brought to the film.
template <size_t K>
void addToFilm(const KernelInput<K>& in, const std::vector<LightList>& lists, std::vector<Rgb>& film) {
  const Film& f = in.scene.scene.film;
  const int width = pixelsAcross(f.x1 - f.x0, in.side), height = pixelsAcross(f.y1 - f.y0, in.side);
  // of a coarse pilot, whose pixels are squares of the image's, and its filter a square of theirs
  const auto side = static_cast<float>(in.side);
  const float radius = in.filter.radius();
  tbb::parallel_for(0, (height + kBand - 1) / kBand, [&](int band) {
    const int y0 = band * kBand, y1 = std::min(height, y0 + kBand);
    for (const LightList& list : lists)
      for (const Splat& s : list.splats) {
        const float fx = (s.px - static_cast<float>(f.x0)) / side, fy = (s.py - static_cast<float>(f.y0)) / side;
        const int top = std::min(y1 - 1, static_cast<int>(std::floor(fy - 0.5f + radius)));
        for (int y = std::max(y0, static_cast<int>(std::ceil(fy - 0.5f - radius))); y <= top; ++y) {
          const int right = std::min(width - 1, static_cast<int>(std::floor(fx - 0.5f + radius)));
          for (int x = std::max(0, static_cast<int>(std::ceil(fx - 0.5f - radius))); x <= right; ++x) {
            const float share =
                in.filter.density({fx - 0.5f - static_cast<float>(x), fy - 0.5f - static_cast<float>(y)});
            if (!(share > 0)) continue;
            const size_t pixel = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
            const PixelWays numbers = in.waysAt(x, y);
            const Ways ways = s.ways * numbers.factors(in.samplesPerHit, in.light->power);
            const auto weight = static_cast<float>(numbers.weight(kAtFilm, ways.of[kAtFilm], ways));
            const Rgb value = s.value * (weight * share / (side * side));
            film[pixel] += value;
            if (in.wayPilot != nullptr) in.wayPilot->note(pixel, value, ways, double(weight), 0, s.surfaces);
          }
        }
      }
  });
}

}  // namespace

template <size_t K>
void traceLight(const KernelInput<K>& in, uint32_t sample, LightPaths& light, const std::function<Counts&()>& counts) {
  const Film& f = in.scene.scene.film;
  const auto pixels =
      static_cast<size_t>(pixelsAcross(f.x1 - f.x0, in.side)) * static_cast<size_t>(pixelsAcross(f.y1 - f.y0, in.side));
  light.film.assign(light.toFilm ? pixels : 0, Rgb{0, 0, 0});
  light.vertices.clear(), light.sketches.clear();
  std::vector<LightList> lists;
  // in lots, each of which is on the film before the next is there
  for (uint32_t done = 0; done < light.paths; done += std::min(light.paths - done, kMostKeptPaths)) {
    const uint32_t lot = std::min(light.paths - done, kMostKeptPaths), first = sample * light.paths + done;
    lists.resize((lot + kChunk - 1) / kChunk);
    tbb::parallel_for(size_t{0}, lists.size(), [&](size_t c) {
      const auto begin = static_cast<uint32_t>(c) * kChunk;
      lists[c].clear();
      traceLightPaths<K>(in, first + begin, first + std::min(lot, begin + kChunk), lists[c], counts());
    });
    if (done == 0 && light.connects())
      for (const LightList& list : lists) {
        light.vertices.insert(light.vertices.end(), list.vertices.begin(), list.vertices.end());
        light.sketches.insert(light.sketches.end(), list.sketches.begin(), list.sketches.end());
      }
    if (light.toFilm) addToFilm(in, lists, light.film);
    if (in.wayPilot != nullptr && in.wayPilot->images)
      for (const LightList& list : lists)
        for (int k = 1; k <= WayImages::kMostSurfaces; ++k)
          in.wayPilot->images->tried(0, k, 0, list.tried[static_cast<size_t>(k)]);
  }
}

#define WARDMIS_INSTANTIATE(K)                               \
  template double verticesPerPath<K>(const KernelInput<K>&); \
  template void traceLight<K>(const KernelInput<K>&, uint32_t, LightPaths&, const std::function<Counts&()>&);
WARDMIS_TECHNIQUE_COUNTS(WARDMIS_INSTANTIATE)

}  // namespace wardmis
