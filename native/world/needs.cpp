// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/needs.h"

#include <fmt/format.h>

#include <algorithm>

#include "math/error.h"
#include "math/memory.h"

namespace wardmis {

uint32_t needs(const Material& m) {
  uint32_t n = 0;
  if (maxComponent(m.diffuse.value) > 0) n |= kNeedsDiffuse;
  if (maxComponent(m.specular.value) > 0) {
    n |= kNeedsSpecular;
    const bool anisotropic = m.alphaX.value != m.alphaY.value || m.alphaX.texture.texture != m.alphaY.texture.texture ||
                             m.alphaX.texture.channel != m.alphaY.texture.channel || m.alphaX.result != m.alphaY.result;
    if (anisotropic) n |= kNeedsTangents;
  }
  for (const Closure& c : m.closures) {
    n |= kNeedsLobes;
    if (mayBeDiffuse(c)) n |= kNeedsDiffuse;
    if (total(mostLobes(c)) > 0) n |= kNeedsSpecular;
    if (mayBeTransparent(c)) n |= kNeedsTransparency;
  }
  if (m.hasTextures() || (m.program && !m.program->textures.empty())) n |= kNeedsTextures;
  if (m.program) n |= kNeedsPrograms;
  return n;
}

uint32_t needs(const Light&) { return kNeedsLightSampling; }

uint32_t needs(const Camera& c) { return c.lensRadius > 0 ? kNeedsLens : 0u; }

uint32_t needs(const World& w) { return !isBlack(w.radiance) ? kNeedsEnvironment : 0u; }

uint32_t needs(const Scene& scene, const Geometry& geometry, const Emitters& emitters, bool joint) {
  uint32_t n = 0;
  for (const World& w : scene.worlds) n |= needs(w);
  if (scene.camera) n |= needs(*scene.camera);
  for (const Shape& s : geometry.shapes) n |= needs(scene.materials[static_cast<size_t>(s.material)]);
  if (emitters.any()) n |= kNeedsLightSampling;
  constexpr uint32_t kBoth = kNeedsDiffuse | kNeedsSpecular;
  if (emitters.anyShared() && (n & kBoth) != 0) n |= kNeedsAllocation;
  if (joint && emitters.anySky() && (n & kBoth) == kBoth) n |= kNeedsAllocation;
  return n;
}

std::vector<std::string> leftOut(const Scene& scene, uint32_t n, const Emitters& emitters) {
  std::vector<std::string> out = scene.leftOut;
  const auto add = [&](uint32_t bit, const char* what) {
    if ((n & bit) == 0) out.emplace_back(what);
  };
  add(kNeedsDiffuse, "no diffuse colour: no cosine samples");
  add(kNeedsSpecular, "no specular colour: no lobe samples, and no pilot for them");
  add(kNeedsTextures, "no textures: no UVs read, none interpolated");
  add(kNeedsPrograms, "no programs: nothing is computed at hits but the surfaces' own inputs");
  add(kNeedsTangents, "no anisotropic material: no tangents");
  add(kNeedsLens, "no depth of field: no lens samples");
  add(kNeedsBounces, "direct light only: no paths, no Russian roulette");
  if ((n & kNeedsEnvironment) == 0)
    out.emplace_back("no environment: none sampled");
  else if (std::ranges::all_of(scene.worlds, [](const World& w) { return w.texture < 0 && !w.program; }))
    out.emplace_back("constant environment: not aimed at, the surface's own techniques cover it evenly");
  if ((n & kNeedsLightSampling) == 0)
    out.emplace_back("no lights to aim at: no light samples, nothing to allocate, no pilot");
  else if ((n & kNeedsAllocation) == 0)
    out.emplace_back(emitters.anyShared()
                         ? "nothing reflects: nothing to allocate, no pilot"
                         : "only lights without area: only light samples reach them, nothing to allocate, no pilot");
  if (emitters.anyStrands())
    out.emplace_back("curves or spheres that shine: not aimed at, the surfaces' own samples find them");
  if (emitters.emissiveTriangles() == 0) out.emplace_back("no emissive mesh: no emissive triangles listed");
  return out;
}

void requireMemoryFor(const Scene& scene) {
  // measured, with Embree's and what building takes for a moment
  constexpr uint64_t kPerObject = 600, kPerEmitter = 128;
  std::vector<uint64_t> emissive(scene.meshes.size(), 0);  // triangles, by mesh
  for (size_t m = 0; m < scene.meshes.size(); ++m)
    for (const MeshPart& part : scene.meshes[m].parts)
      for (const Primitive& p : part.primitives)
        if (p.form == Form::kTriangles && !isBlack(scene.materials[static_cast<size_t>(p.material)].emission.value))
          emissive[m] += p.indices.size() / 3;
  uint64_t emitters = 0;  // at most 5 * 10^7 * 2^31
  for (const Instance& i : scene.instances) emitters += emissive[static_cast<size_t>(i.mesh)];
  requireMemory(kPerObject * scene.instances.size() + kPerEmitter * emitters,
                fmt::format("{}: {} objects with {} emissive triangles, instances counted,", scene.path,
                            scene.instances.size(), emitters),
                emitters > 0 ? "place emissive meshes fewer times, give them fewer triangles, or use lights instead"
                             : "place fewer objects");
  // they are numbered in 32 bits
  if (emitters > uint64_t{1} << 31)
    throw Error(ExitCode::kMemory,
                fmt::format("{}: {} emissive triangles, instances counted, are more than 2^31", scene.path, emitters),
                "place emissive meshes fewer times, give them fewer triangles, or use lights instead");
}

std::string describe(uint32_t n) {
  constexpr std::pair<uint32_t, const char*> kNames[] = {{kNeedsDiffuse, "diffuse"},
                                                         {kNeedsSpecular, "specular"},
                                                         {kNeedsTextures, "textures"},
                                                         {kNeedsPrograms, "programs"},
                                                         {kNeedsBounces, "bounces"},
                                                         {kNeedsLightSampling, "lights"},
                                                         {kNeedsAllocation, "allocation"},
                                                         {kNeedsEnvironment, "environment"},
                                                         {kNeedsLens, "lens"},
                                                         {kNeedsTangents, "tangents"},
                                                         {kNeedsLobes, "lobes"},
                                                         {kNeedsTransparency, "transparency"},
                                                         {kNeedsConnections, "paths from lights"}};
  std::string s;
  for (const auto& [bit, text] : kNames)
    if ((n & bit) != 0) s += (s.empty() ? "" : ", ") + std::string(text);
  return s.empty() ? "nothing" : s;
}

}  // namespace wardmis
