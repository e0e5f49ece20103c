// SPDX-License-Identifier: GPL-3.0-or-later
// The third table of `./dev bench`: what a node program costs a hit.
#pragma once

#include <fmt/format.h>

#include "integrate/scenes.h"
#include "integrate/setup.h"
#include "program/programs.h"

namespace wardmis::test {

// A diffuse and glossy sphere under one lamp. Its colours and roughness are constants, or the same made by a program of
// 20 operations.
inline Scene programmedSphere(bool programmed) {
  Scene scene;
  scene.materials = {ward({0.5f, 0.4f, 0.3f}, {0.2f, 0.2f, 0.2f}, 0.3f, WardVariant::kWardGmd)};
  addSphere(scene, 64, 0);
  Light lamp;
  lamp.name = "lamp";
  lamp.type = LightType::kArea;
  lamp.sizeX = lamp.sizeY = 2;
  lamp.toWorld = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 4}};
  scene.lights = {lamp};
  lookFrom(scene, 0.5f, 0.7f, 64);
  if (!programmed) return scene;
  const auto of = [](int i) { return json{{"result", i}}; };
  json ops = {{{"op", "object"}},
              {{"op", "x"}, {"in", {of(0)}}},
              {{"op", "y"}, {"in", {of(0)}}},
              {{"op", "z"}, {"in", {of(0)}}},
              {{"op", "multiply"}, {"in", {of(1), of(2)}}},
              {{"op", "add"}, {"in", {of(4), of(3)}}},
              {{"op", "absolute"}, {"in", {of(5)}}},
              {{"op", "minimum"}, {"in", {of(6), 1}}},
              {{"op", "vector"}, {"in", {of(7)}}},
              {{"op", "vector-multiply"}, {"in", {of(0), of(8)}}},
              {{"op", "vector-add"}, {"in", {of(9), {1, 2, 3}}}},
              {{"op", "vector-dot"}, {"in", {of(10), of(9)}}},
              {{"op", "greater-than"}, {"in", {of(11), 1000}}},
              {{"op", "mix"}, {"in", {of(12), {0.5, 0.4, 0.3}, {1, 1, 1}}}},
              {{"op", "mix"}, {"in", {of(12), {0.2, 0.2, 0.2}, of(13)}}},
              {{"op", "maximum"}, {"in", {of(12), 0.3}}},
              {{"op", "multiply"}, {"in", {of(15), 2}}},
              {{"op", "multiply"}, {"in", {of(16), 0.5}}},
              {{"op", "subtract"}, {"in", {of(17), of(12)}}},
              {{"op", "add"}, {"in", {of(18), of(12)}}}};
  Material& m = scene.materials[0];
  setProgram(m, ops, {13, 14, 19});
  m.diffuse = {{1, 1, 1}, {}, 0};
  m.specular = {{1, 1, 1}, {}, 1};
  m.alphaX = m.alphaY = {1, {}, 2};
  return scene;
}

inline void benchProgram() {
  const Scene plain = programmedSphere(false), programmed = programmedSphere(true);
  const BuiltScene first(plain, 1), second(programmed, 1);
  RenderSettings settings;
  settings.integrator = Integrator::kDirect;
  settings.allocation = Allocation::kEqual;
  settings.spp = 16;
  settings.threads = 1;
  Statistics statistics;
  const auto shade = [&](const BuiltScene& built) { return render(built, settings, statistics); };
  const FilmBuffer a = shade(first), b = shade(second);
  const auto hits = static_cast<double>(a.pixels.size()) * settings.spp;
  bool same = true;
  for (size_t i = 0; i < a.pixels.size(); ++i) same = same && a.mean(a.pixels[i]) == b.mean(b.pixels[i]);
  const auto rays = static_cast<double>(statistics.counts.allRays());
  // as many rays as that, all of which hit
  const auto trace = [&] {
    int met = 0;
    for (int i = 0; i < static_cast<int>(rays); ++i) {
      Ray ray;
      const auto u = static_cast<float>(i % 1009) / 1009, v = static_cast<float>(i % 1013) / 1013;
      ray.origin = {u - 0.5f, v - 0.5f, 50}, ray.direction = {0, 0, -1};
      met += first.accel.intersect(ray).valid() ? 1 : 0;
    }
    return met;
  };
  volatile int met = 0;
  const auto [constants, program, tracing] = bestSeconds(
      40, [&] { shade(first); }, [&] { shade(second); }, [&] { met = met + trace(); });
  fmt::print("\n| {}, ns | constants | a program of 20 operations | ratio |\n|---|---:|---:|---:|\n",
             same ? "a hit, of the same image" : "a hit, OF ANOTHER IMAGE");
  const auto row = [&](const char* what, double without, double with) {
    fmt::print("| {} | {:.0f} | {:.0f} | {:.2f} |\n", what, without / hits * 1e9, with / hits * 1e9, with / without);
  };
  row("all", constants, program);
  row("less its rays", constants - tracing, program - tracing);
}

}  // namespace wardmis::test
