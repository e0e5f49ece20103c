// SPDX-License-Identifier: GPL-3.0-or-later
// A scene as plain data: what docs/scene-format.md says, after reading and checking, before anything is built from it.
// World space is the file's (glTF: Y up). Radiometric units; colours linear Rec. 709.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bsdf/ward.h"
#include "film/filter.h"
#include "image/image.h"
#include "math/vec.h"
#include "program/program.h"
#include "scene/closure.h"

namespace wardmis {

// A read-only array: either a view into the mapped file (kept alive by `owner`) or owned.
template <class T>
struct Array {
  std::span<const T> data;
  std::shared_ptr<const void> owner;

  static Array of(std::vector<T> v) {
    auto p = std::make_shared<const std::vector<T>>(std::move(v));
    return {std::span<const T>(*p), p};
  }
  size_t size() const { return data.size(); }
  bool empty() const { return data.empty(); }
  const T& operator[](size_t i) const { return data[i]; }
};

struct Material {
  std::string name;
  WardVariant variant = WardVariant::kWardGmd;
  ColorInput diffuse, specular, emission;  // emission: W m^-2 sr^-1, both sides
  ScalarInput alphaX{0.1f, {}}, alphaY{0.1f, {}};
  float rotation = 0;  // of the anisotropy, radians, counter-clockwise about the normal
  int normal = -1;     // index into Program::results: the shading normal in world space; -1: the mesh's
  float index = 0;     // for programs
  std::shared_ptr<const Program> program;
  bool unlit = false;             // its emission stands for a colour that needs no light, and is none
  bool transparent = false;       // light may go straight through
  bool opaqueShadow = false;      // but no shadow ray
  bool constant = false;          // no closure's input is looked up or from the program
  std::vector<Closure> closures;  // in place of diffuse, specular, alphas, rotation and normal; of these, then, nothing

  // Calls f(ColorInput&) or f(ScalarInput&) for each input; of a const material with const ones.
  template <class Self, class F>
  static void forEachInput(Self& m, F&& f) {
    f(m.diffuse), f(m.specular), f(m.emission), f(m.alphaX), f(m.alphaY);
    for (auto& c : m.closures) {
      f(c.weight), f(c.rotation);
      for (auto& input : c.colors) f(input);
      for (auto& input : c.scalars) f(input);
    }
  }
  bool isConstant() const {
    bool all = true;
    forEachInput(*this, [&](const auto& input) { all = all && input.texture.texture < 0 && input.result < 0; });
    return all;
  }
  bool hasTextures() const {
    bool any = false;
    forEachInput(*this, [&](const auto& input) { any = any || input.texture.texture >= 0; });
    return any;
  }
};

// What a primitive is made of: triangles, or what has a radius at each of its points. Curves are Catmull-Rom splines
// through their points: flat ones that always face the ray, or tubes; or chains of cones.
enum class Form : uint8_t { kTriangles, kRibbons, kTubes, kCones, kSpheres };

// A run of triangles, of segments of curves, or of spheres of one mesh with one material.
struct Primitive {
  int material = 0;
  // All < positions.size(). 3 per triangle, none degenerate; of each segment the first of two points, the next one
  // being the other (those that follow on one another are of one curve); of each sphere its centre.
  Array<uint32_t> indices;
  Form form = Form::kTriangles;
  int pieces = 5;       // ribbons: flat ones that make a segment
  bool inside = false;  // what is round: rays see it from inside, too
};

// What programs read of the vertices: `components` numbers each; 0: there is nothing of the name. UVs: v = 0 at the
// bottom. Tangents: three and the sign.
struct VertexAttribute {
  Array<float> data;
  int components = 0;
};

// Vertex arrays shared by its primitives. normals and uvs are empty or as long as positions.
struct MeshPart {
  Array<Vec3f> positions;
  Array<Vec3f> normals;                     // shading normals, unit length not guaranteed
  Array<Vec2f> uvs;                         // v = 0 at the bottom
  std::vector<VertexAttribute> attributes;  // in the order of the program's; those of all its materials are the same
  Array<Vec3f> generated;                   // Generated coordinates
  // Where it deforms: at equal steps of the shutter's time, the frame's own among them. Normals where it has any.
  std::vector<Array<Vec3f>> movedPositions, movedNormals;
  Array<float> radii;  // of curves and spheres, as many as positions, not negative
  std::vector<Primitive> primitives;
};
struct Mesh {
  std::string name;
  std::vector<MeshPart> parts;
};

// Kinds of ray that see an object or a light. Bits.
enum Visibility : uint8_t {
  kSeenByCamera = 1,
  kSeenByDiffuse = 2,
  kSeenByGlossy = 4,
  kCastsShadow = 8,
  kSeenByTransmission = 16,  // whatever transmits: diffuse and glossy are reflections
  kSeenByTranslucence = 32,  // what matte surfaces transmit: as translucence() has it
  kSeenBySurfaces = kSeenByDiffuse | kSeenByGlossy | kSeenByTransmission,
  kSeenByAll = 63
};
// Cycles counts matte transmission as transmission where objects are concerned, and as diffuse where lamps and skies
// are.
constexpr uint8_t translucence(uint8_t visibility, Visibility counted) {
  return static_cast<uint8_t>((visibility & counted) != 0 ? visibility | kSeenByTranslucence
                                                          : visibility & ~kSeenByTranslucence);
}

// What programs read of an object.
struct ObjectData {
  bool hasGenerated = false;
  float generated[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};  // row by row, from object space
  float color[4] = {1, 1, 1, 1};
  float index = 0, random = 0;
  struct Value {
    float numbers[4] = {0, 0, 0, 0};
    int components = 0;
  };
  std::vector<std::pair<std::string, Value>> attributes;  // sorted by name
};

// What smooths the edge of a smooth surface's own shadow.
struct ShadowTerminator {
  float geometry = 0;  // cosine of light and face below which light samples are moved: integrate/terminator.h
  float shading = 0;   // the light's angle to the normal is greater by a factor of 1/(1 - shading/2)
};

struct Instance {
  std::string name;
  int mesh = 0;
  Affine toWorld;
  uint8_t visibility = kSeenByAll;
  bool holdout = false;        // the camera sees a hole there
  bool shadowCatcher = false;  // the camera sees its shadows alone: CatcherPixel in film.h
  ShadowTerminator terminator;
  std::shared_ptr<const ObjectData> object;           // null: as it is by default
  std::shared_ptr<const std::vector<Affine>> motion;  // toWorld at equal steps of the shutter's time; null: it stands
};

enum class LightType : uint8_t { kArea, kPoint, kSpot, kSun };

struct Light {
  std::string name;
  LightType type = LightType::kPoint;
  Affine toWorld;        // -z is where it looks
  Rgb emitted{1, 1, 1};  // color times: area W m^-2 sr^-1, point and spot W sr^-1, sun W m^-2
  // area
  bool ellipse = false;
  float sizeX = 1, sizeY = 1;  // local units; the axes' lengths scale them
  float spread = 3.14159265f;  // full angle
  // point, spot
  float radius = 0;
  bool facing = true;  // radius > 0: a disk that faces the shading point, else a true sphere
  float angle = 0;     // spot: full cone; sun: full angular diameter
  bool flat = false;   // sun: a flat disk at distance 1, its radiance times 1/cos^3 of the angle to its axis
  float blend = 0;
  bool cosine = false;
  uint8_t visibility = kSeenByAll;
  bool shadow = true;
  bool met = true;         // by other rays than the camera's, else by light samples alone
  bool onCatchers = true;  // shadow catchers have its light also where they are alone
  int maxBounces = 1024;   // it lights surfaces that a path has reached by at most so many
  std::shared_ptr<const Program> program;
  int result = -1;  // index into Program::results: what `emitted` is multiplied by where the light is looked at
};

// How a camera takes directions to its plane: docs/scene-format.md. The panoramic ones come last.
enum class Projection : uint8_t {
  kPerspective,
  kOrthographic,
  kEquirectangular,
  kCentralCylindrical,
  kFisheyeEquidistant,
  kFisheyeEquisolid,
  kFisheyePolynomial,
  kMirrorBall,
  kEquiangularCubeFace
};

struct Camera {
  std::string name;
  Affine toWorld;  // unit axes, orthogonal unless its node is sheared; looks along -z
  Projection projection = Projection::kPerspective;
  float left = -0.36f, right = 0.36f, bottom = -0.24f, top = 0.24f;  // full frame, in what the projection measures in
  float clipNear = 0, clipFar = 1e30f;                               // planar depths; of panoramas distances
  float fov = 6.2831853f;                 // fisheyes: full angle, beyond which there is nothing
  float polynomial[5] = {0, 0, 0, 0, 0};  // fisheye: angle from the axis, of powers of the distance from the centre
  float lensRadius = 0, focusDistance = 1;
  int blades = 0;  // < 3: round
  float bladeRotation = 0, bladeRatio = 1;
  std::vector<Affine> motion;                    // toWorld at equal steps of the shutter's time; empty: it stands
  std::vector<std::array<float, 4>> viewPlanes;  // left, right, bottom, top likewise

  bool orthographic() const { return projection == Projection::kOrthographic; }
  bool panoramic() const { return projection > Projection::kOrthographic; }
};

// Where anything moves.
struct ShutterCurve {
  std::vector<float> open;  // how far, at equal steps of the time; empty: always alike
  float rolling = -1;       // see world/motion.h
};

struct Film {
  int width = 960, height = 540;           // full frame
  int x0 = 0, y0 = 0, x1 = 960, y1 = 540;  // border, from the bottom left, end exclusive
  FilterType filter = FilterType::kBlackmanHarris;
  float filterWidth = 1.5f;
  float exposure = 1;
  bool transparent = false;
  bool keepUvs = false;  // for the pass, also where nothing is looked up by them
  // Passes of data show what the camera meets first that is at least as opaque as that.
  float alphaThreshold = 0.5f;
  ShutterCurve shutter;
};

// How an image holds the directions of a sky: docs/scene-format.md.
enum class SkyMap : uint8_t { kEquirectangular, kMirrorBall };

// Light from infinitely far. Several are as many skies, one over the other, as a rule for other kinds of ray each.
struct World {
  Rgb radiance{0, 0, 0};  // times what the texture or the program has in a direction
  int texture = -1;
  std::shared_ptr<const Program> program;
  int result = -1;  // index into Program::results
  // Light from within a cone alone, as of a sun's disc: towards its axis, in the scene's frame; angle 0: from
  // everywhere.
  Vec3f coneAxis{0, 0, 1};
  float coneAngle = 0;  // full
  SkyMap map = SkyMap::kEquirectangular;
  float matrix[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  // row-major, Z-up direction -> the image's frame
  uint8_t visibility = kSeenByAll;
  int maxBounces = 1024;  // as a light's
};

struct Scene {
  std::string path;
  std::vector<std::filesystem::path> files;  // all that it was read from; the first is the scene itself
  std::vector<Image> images;
  std::vector<Texture> textures;
  std::vector<Material> materials;  // in order of first use; one stands in for "no material"
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<Light> lights;
  std::optional<Camera> camera;
  Film film;
  bool hasFilm = false;  // the file gave a resolution
  bool foreign = true;   // without WARDMIS_scene: what it does not say, it leaves open
  std::vector<World> worlds;
  bool zUp = false;                  // frame of the Normal pass and of the world
  std::vector<std::string> notes;    // from the exporter: what it could not translate
  std::vector<std::string> lacking;  // what the reader did not load, and why, though the image would show it
  std::vector<std::string> leftOut;  // these, and what makes no difference
  uint64_t degenerateTriangles = 0;  // dropped
};

}  // namespace wardmis
