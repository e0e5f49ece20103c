// SPDX-License-Identifier: GPL-3.0-or-later
// What stands between a scene and its pixels: what is built once for any number of renders, and what each render's
// settings make of it.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "integrate/kernel.h"
#include "integrate/render.h"
#include "mis/ways.h"
#include "world/environment.h"

namespace wardmis {

// A scene with its geometry, lights and acceleration structure. `scene` must outlive it, and must have a camera.
struct BuiltScene {
  BuiltScene(const Scene& scene, int threads);  // threads: 0 for all; throws Error

  double seconds = 0;  // that the building took
  const Scene& scene;
  Geometry geometry;
  std::vector<Environment> environments;
  Emitters emitters;
  Accel accel;
  // What shadow catchers are where nothing else is, which their shadows are measured by.
  struct Catchers {
    Catchers(const Scene& scene, const std::vector<Environment>& environments, int threads);

    Geometry geometry;
    Emitters emitters;
    Accel accel;
  };
  std::unique_ptr<Catchers> catchers;  // null: there are none

  size_t lobes() const { return geometry.lobes.most; }  // of a surface, as far as each has a technique of its own
  std::vector<std::string> techniqueNames() const;      // in what is written
};

// What a render with these settings needs, and the mask of the kernel that it runs.
uint32_t needs(const BuiltScene& built, const RenderSettings& settings);
uint32_t kernelNeeds(const BuiltScene& built, const RenderSettings& settings);

// What it leaves out, and why.
std::vector<std::string> leftOut(const BuiltScene& built, const RenderSettings& settings);

// The kernel for these settings, and its input. Fractions are those of equal counts until they are set.
template <size_t K>
struct RenderSetup {
  RenderSetup(const BuiltScene& built, const RenderSettings& settings);
  RenderSetup(const RenderSetup&) = delete;
  RenderSetup& operator=(const RenderSetup&) = delete;

  FilmBuffer film(int side = 1) const;  // an empty one, of the border's size; side: of its pixels, in the image's
  // Instead of the settings' own points.
  void drawFrom(const Sampler& sampler) { sampler_ = sampler; }
  // Paths from the lights, where the integrator wants them and the scene allows; with these none while `on` is false.
  void connectLights(bool on) { input.light = on && light_ ? &*light_ : nullptr; }
  // Notes of a film with pixels of `side` of the image's, with these numbers for each of them.
  void beginWayNotes(WayTally& tally, int side, const WayCounts& counts, const WayMap* map);
  void endWayNotes();
  void useWays(const WayCounts& counts, const WayMap* map);  // map: of the pixels, or null
  int samplesAtHit(const WayCounts& counts) const;
  // Those of a camera sample, unless they are there.
  void traceLightOf(uint32_t sample, const std::function<Counts&()>& counts);
  // Light samples tell `learning` whether they are seen, and are drawn by what `lights` knows of that; null: neither.
  void drawLights(const LightVisibility* lights, LightVisibility* learning) {
    world_.lights = lights, world_.learning = learning;
  }

  uint32_t needs = 0, kernelNeeds = 0;
  TechniqueMask techniques = 0;  // that the scene has

 private:
  RenderScene world_;
  std::optional<RenderScene> catchers_;
  CameraRays camera_;
  Shutter shutter_;
  PixelFilter filter_;
  Sampler sampler_;
  CandidateLists<K> candidates_;
  std::optional<LightEmission> emission_;
  std::optional<LightPaths> light_;
  std::optional<uint32_t> tracedLight_;  // the camera sample whose paths are there
  int samplesPerHit_ = 0;                // that are asked for

  void setPaths(double perPixel, int side);

 public:
  KernelInput<K> input;
  TileKernel<K> kernel;
};

// Adds the `samples` camera samples that follow those of the film, in mean over its pixels, in tiles, by all threads;
// film.samples and .partial are the caller's to raise. counts: gives the calling thread's; tilesDone is raised by each
// tile that is ready; as soon as `discard` (may be empty) says true, the rest is left.
template <size_t K>
void renderTiles(const RenderSetup<K>& setup, FilmBuffer& film, double samples, Pilot<K>* pilot,
                 const std::function<Counts&()>& counts, std::atomic<int>& tilesDone,
                 const std::function<bool()>& discard);
int tilesOf(const FilmBuffer& film);
// Of a film whose pixels are squares of `side` pixels of the image, along an edge of so many of these.
constexpr int pixelsAcross(int pixels, int side) { return (pixels + side - 1) / side; }

// Limits the threads of what runs in it.
void withThreads(int threads, const std::function<void()>& work);
int threadsOf(int setting);  // 0: all

double wallSeconds();
double cpuSeconds();  // of all threads of the process

}  // namespace wardmis
