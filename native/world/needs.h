// SPDX-License-Identifier: GPL-3.0-or-later
// What a scene needs of the renderer, as a mask that every object answers for; and what is left out, in words.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "world/emitters.h"

namespace wardmis {

// Bits that select the kernel (compiled in or not) ...
enum Needs : uint32_t {
  kNeedsDiffuse = 1,
  kNeedsSpecular = 2,
  kNeedsBounces = 4,  // more than direct light
  kNeedsLobes = 8,    // other surfaces than Lambert's and one of Ward's
  kKernelNeeds = 15,
  kNeedsTextures = 16,  // a branch that is always taken alike costs nothing: no kernel of its own
  // ... and bits that decide what is set up, sampled and written
  kNeedsLightSampling = 32,  // something emits that is worth aiming at
  kNeedsAllocation = 64,     // techniques that share an integral: there is something to allocate
  kNeedsEnvironment = 128,
  kNeedsLens = 256,
  kNeedsTangents = 512,
  kNeedsTransparency = 1024,  // surfaces that let light straight through
  kNeedsPrograms = 2048,      // a branch, too
  kNeedsConnections = 4096,   // paths from the lights, in kernels of their own
};

uint32_t needs(const Material& material);
uint32_t needs(const Light& light);
uint32_t needs(const Camera& camera);
uint32_t needs(const World& world);

// All of the scene's needs: of the materials that are placed, of the emitters, the camera and the world.
// joint: diffuse and specular are one integral, so that their techniques share it even without lights to aim at.
uint32_t needs(const Scene& scene, const Geometry& geometry, const Emitters& emitters, bool joint);

// What a render with these needs leaves out, and why.
std::vector<std::string> leftOut(const Scene& scene, uint32_t needs, const Emitters& emitters);

// Objects and their emissive triangles are listed one by one, so that instances multiply what a small file holds:
// throws Error(kMemory) where the list would not fit. Before anything is built.
void requireMemoryFor(const Scene& scene);

// "diffuse, specular, bounces": for the log.
std::string describe(uint32_t needs);

}  // namespace wardmis
