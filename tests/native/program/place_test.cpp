// SPDX-License-Identifier: GPL-3.0-or-later
// Operations that depend on the place: exact cases.
#include <gtest/gtest.h>

#include <cmath>

#include "bsdf/dielectric.h"
#include "math/number.h"
#include "programs.h"

namespace wardmis {
namespace {

using namespace test;

constexpr double kPid = kPi<double>;

void expectNear(const json& operations, const std::vector<double>& expected, const ShadingContext& context = {},
                TextureAccess textures = {}, double tolerance = 2e-6) {
  const std::vector<float> found = values(operations, context, textures);
  ASSERT_EQ(found.size(), expected.size()) << operations;
  for (size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i], expected[i], tolerance * std::max(1.0, std::abs(expected[i])))
        << operations << " [" << i << "]";
}
json op(const std::string& name, json in = json::array(), json parameters = json::object()) {
  parameters["op"] = name;
  parameters["in"] = std::move(in);
  return json::array({parameters});
}

// On an object that is turned by 90 degrees about z, scaled by (1, 2, 4) and moved; seen by a camera at (0, 0, 10) that
// looks down.
ShadingContext place() {
  ShadingContext c;
  c.position = {{1, 2, 3}, {0.5f, 0, 0}, {0, 0.25f, 0}};
  c.normal = {0, 0.6f, 0.8f};
  c.trueNormal = {0, 0, 1};
  c.incoming = {0, 0, 1};
  c.parametric = {{0.25f, 0.5f, 0}, {1, 0, 0}, {0, 1, 0}};
  c.interpolatedNormal = {0, 0, 1};
  c.materialIndex = 7;
  c.generated = {{0.75f, 0.5f, 0.25f}, {1, 0, 0}, {0, 1, 0}};
  c.toWorld = {{0, 1, 0}, {-2, 0, 0}, {0, 0, 4}, {10, 20, 30}};
  c.color[0] = 0.1f, c.color[1] = 0.2f, c.color[2] = 0.3f, c.color[3] = 0.4f;
  c.index = 5, c.random = 0.125f;
  c.camera = {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 10}};
  c.path = {kGlossyRay | kReflectionRay, 4, 1, 2, 5, 3};
  c.rayLength = 2.5f;
  return c;
}

TEST(Place, IsRead) {
  const ShadingContext c = place();
  const auto reads = [&](const char* name, const std::vector<double>& expected, const json& p = json::object()) {
    expectNear(op(name, json::array(), p), expected, c);
  };
  reads("position", {1, 2, 3});
  reads("position", {2, 2, 3}, {{"shift", "x"}, {"width", 2}});
  reads("position", {1, 2.25, 3}, {{"shift", "y"}});
  reads("normal", {0, 0.6, 0.8});
  reads("true-normal", {0, 0, 1});
  // transposed matrix: columns (0, 1, 0), (-2, 0, 0), (0, 0, 4)
  reads("object-normal", {0.6 / std::hypot(0.6, 3.2), 0, 3.2 / std::hypot(0.6, 3.2)});
  reads("incoming", {0, 0, 1});
  reads("direction", {0, 0, -1});
  reads("reflection", {0, 2 * 0.8 * 0.6, 2 * 0.8 * 0.8 - 1});
  reads("generated", {0.75, 0.5, 0.25});
  reads("generated", {1.75, 0.5, 0.25}, {{"shift", "x"}});
  reads("object", {-18, 9 / 2.0, -27 / 4.0});
  reads("camera", {1, 2, 7});
  reads("window", {0.5 * (1 / 7.0 + 1), 0.5 * (2 / 7.0 + 1), 0});
  reads("parametric", {0.25, 0.5, 0});
  reads("backfacing", {0});
  reads("object-location", {10, 20, 30});
  reads("object-color", {0.1, 0.2, 0.3});
  reads("object-alpha", {0.4});
  reads("object-index", {5});
  reads("object-random", {0.125});
  reads("material-index", {7});
  reads("view-vector", {1 / std::sqrt(54.0), 2 / std::sqrt(54.0), 7 / std::sqrt(54.0)});
  reads("view-depth", {7});
  reads("view-distance", {std::sqrt(54.0)});
  reads("is-camera-ray", {0});
  reads("is-shadow-ray", {0});
  reads("is-diffuse-ray", {0});
  reads("is-glossy-ray", {1});
  reads("is-singular-ray", {0});
  reads("is-reflection-ray", {1});
  reads("is-transmission-ray", {0});
  reads("ray-length", {2.5});
  reads("ray-depth", {4});
  reads("diffuse-depth", {1});
  reads("glossy-depth", {2});
  reads("transparent-depth", {3});
  reads("transmission-depth", {5});
}

TEST(Place, TangentsLieInTheSurface) {
  ShadingContext c;
  c.normal = {0, 0, 1};
  c.generated = {{0.75f, 0.5f, 0.5f}, {}, {}};
  expectNear(op("tangent"), {0, 1, 0}, c);  // around z, at x = 0.25 from the axis
  c.generated = {{0.5f, 0.5f, 0.75f}, {}, {}};
  expectNear(op("tangent", json::array(), {{"axis", "y"}}), {-1, 0, 0}, c);
  c.attributes[0].xyz = {{3, 0, 4}, {}, {}};
  c.attributes[0].components = 4;
  expectNear(op("tangent-uv"), {1, 0, 0}, c);
  c.attributes[0].components = 0;
  expectNear(op("tangent-uv"), {0, 0, 0}, c);
}

TEST(Place, AttributesByTheirComponents) {
  ShadingContext c;
  AttributeValue& a = c.attributes[0];
  a.xyz = {{1, 2, 6}, {1, 1, 1}, {0, 0, 3}};
  a.w[0] = 0.5f, a.w[1] = 0.25f, a.w[2] = 0;
  const auto expect = [&](int components, const std::vector<double>& v, double number, double alpha) {
    a.components = static_cast<uint8_t>(components);
    const json name{{"name", "Col"}};
    expectNear(op("attribute", json::array(), name), v, c);
    expectNear(op("attribute-number", json::array(), name), {number}, c);
    expectNear(op("attribute-alpha", json::array(), name), {alpha}, c);
  };
  expect(4, {1, 2, 6}, 3, 0.5);
  expect(3, {1, 2, 6}, 3, 1);
  expect(2, {1, 2, 0}, 1, 1);
  expect(1, {1, 1, 1}, 1, 1);
  expect(0, {0, 0, 0}, 0, 1);
  a.components = 4;
  const json shifted{{"name", "Col"}, {"shift", "x"}, {"width", 2}};
  expectNear(op("attribute", json::array(), shifted), {3, 4, 8}, c);
  expectNear(op("attribute-alpha", json::array(), shifted), {1}, c);
  a.components = 2;
  expectNear(op("uv"), {1, 2, 0}, c);
}

TEST(Place, ChangesOfSpace) {
  const ShadingContext c = place();
  const auto transforms = [&](const char* type, const char* from, const char* to, json v, std::vector<double> expected,
                              int version = 5) {
    expectNear(op("vector-transform", {v}, {{"type", type}, {"from", from}, {"to", to}, {"version", version}}),
               expected, c);
  };
  transforms("point", "object", "world", {1, 1, 1}, {8, 21, 34});
  transforms("point", "world", "object", {8, 21, 34}, {1, 1, 1});
  transforms("vector", "object", "world", {1, 1, 1}, {-2, 1, 4});
  transforms("point", "world", "camera", {1, 2, 3}, {1, 2, 7});
  transforms("point", "camera", "world", {1, 2, 7}, {1, 2, 3});
  transforms("vector", "camera", "world", {0, 0, 1}, {0, 0, -1});
  transforms("point", "object", "camera", {1, 1, 1}, {8, 21, -24});
  // a plane x + 4 z = 0 of the object has the normal (1, 0, 4) there; its tangents (4, 0, -1), (0, 1, 0) become
  // (0, 4, -4), (-2, 0, 0), so that the normal in the world is (0, 1, 1)
  transforms("normal", "object", "world", {1, 0, 4}, {0, std::sqrt(0.5), std::sqrt(0.5)});
  transforms("normal", "object", "world", {1, 0, 4}, {0, 1 / std::sqrt(257.0), 16 / std::sqrt(257.0)}, 3);
  transforms("vector", "world", "world", {1, 2, 3}, {1, 2, 3});
  ShadingContext world = c;
  world.isObject = false;
  expectNear(op("vector-transform", {{1, 2, 3}}, {{"type", "point"}, {"from", "world"}, {"to", "object"}}), {1, 2, 3},
             world);
}

// What is computed afterwards has another normal, and what was before has its own.
TEST(Place, NormalsAreBent) {
  const ShadingContext c = place();
  const json both = {{{"op", "normal"}},
                     {{"op", "bend"}, {"in", {{0, 3, 0}}}},
                     {{"op", "normal"}},
                     {{"op", "vector-multiply-add"}, {"in", {{{"result", 0}}, {10, 10, 10}, {{"result", 2}}}}}};
  expectNear(both, {0, 7, 8}, c);
  const json none = {{{"op", "bend"}, {"in", {{0, 0, 0}}}}, {{"op", "normal"}}};
  expectNear(none, {0, 0.6, 0.8}, c);
}

TEST(Place, VectorsAreDisplacedAlongTangents) {
  ShadingContext c = place();
  c.normal = {0, 0, 1};
  const json moved = op("vector-displacement", {{1, 2, 3}});
  expectNear(moved, {0, 0, 8}, c);  // without tangents along the normal alone, which the object makes 4 times as long
  c.attributes[0].xyz = {{1, 0, 0}, {}, {}};
  c.attributes[0].components = 4;
  c.attributes[0].w[0] = 1;
  expectNear(moved, {-6, 1, 8}, c);
  c.attributes[0].w[0] = -1;
  expectNear(moved, {6, 1, 8}, c);
}

TEST(Place, NormalMaps) {
  ShadingContext c;
  c.normal = c.trueNormal = c.interpolatedNormal = {0, 0, 1};
  c.attributes[0].xyz = {{1, 0, 0}, {}, {}};
  c.attributes[0].components = 4;
  c.attributes[0].w[0] = 1;
  const double r = std::sqrt(0.5);
  const auto map = [&](json color, double strength, std::vector<double> expected, json p = json::object()) {
    expectNear(op("normal-map-tangent", {color, strength}, p), expected, c);
  };
  map({0.5, 0.5, 1}, 1, {0, 0, 1});
  map({1, 0.5, 1}, 1, {r, 0, r});
  map({0.5, 1, 1}, 1, {0, r, r});
  map({0.5, 1, 1}, 1, {0, -r, r}, {{"invertGreen", true}});
  map({1, 0.5, 1}, 0.5, {0.5 / std::hypot(0.5, 1), 0, 1 / std::hypot(0.5, 1)});
  map({1, 0.5, 1}, 0.5, {r / 2 / std::hypot(r / 2, (1 + r) / 2), 0, (1 + r) / 2 / std::hypot(r / 2, (1 + r) / 2)},
      {{"version", 3}});
  map({0.5, 0.5, 0.5}, 1, {0, 0, 1});  // no direction: the surface's own
  c.interpolatedNormal = {0, 0, 0.5};
  map({1, 0.5, 1}, 1, {r, 0, r});
  map({1, 0.5, 1}, 1, {1 / std::hypot(1, 0.5), 0, 0.5 / std::hypot(1, 0.5)}, {{"version", 4}});
  c.interpolatedNormal = {0, 0, 1};
  c.attributes[0].w[0] = -1;
  map({0.5, 1, 1}, 1, {0, -r, r});
  c.attributes[0].components = 0;
  map({1, 0.5, 1}, 1, {0, 0, 1});  // no tangents: the surface's own
  expectNear(op("normal-map-world", {{1, 0.5, 0.5}, 1}), {1, 0, 0}, c);
  expectNear(op("normal-map-world", {{0.5, 0, 0.5}, 1}), {0, -1, 0}, c);
  expectNear(op("normal-map-world", {{0.5, 0, 0.5}, 1}, {{"flip", true}}), {0, 1, 0}, c);
  expectNear(op("normal-map-world", {{1, 0.5, 0.5}, 0.5}), {r, 0, r}, c);
  c.toWorld = {{0, 1, 0}, {-2, 0, 0}, {0, 0, 4}, {0, 0, 0}};
  expectNear(op("normal-map-object", {{1, 0.5, 0.5}, 1}), {0, 1, 0}, c);
  c.backfacing = true;
  expectNear(op("normal-map-object", {{1, 0.5, 0.5}, 1}), {0, -1, 0}, c);
  // A mirrored object's normals are not turned over.
  c.backfacing = false;
  c.toWorld = {{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
  expectNear(op("normal-map-object", {{0.5, 0.5, 1}, 1}), {0, 0, 1}, c);
}

TEST(Place, LayersTakeLightFromBelow) {
  ShadingContext c;
  c.trueNormal = c.normal = {0, 0, 1};
  c.incoming = {0, 0.6f, 0.8f};
  const json white = {1, 1, 1}, up = {0, 0, 1};
  const auto layers = [&](double coat, double ior, const json& tint, double sheen, int version = 4) {
    return op("below-layers", {coat, 0.1, ior, tint, sheen, 0.5, white, up, up}, {{"version", version}});
  };
  expectNear(layers(0, 1.5, white, 0), {1, 1, 1}, c);
  // 4.3: what Fresnel's formula leaves; the tint once more, as the way through the coat is longer
  const double f = fresnelDielectric(0.8, 1.5), longer = 1 / std::sqrt(1 - 0.36 / 2.25);
  expectNear(layers(1, 1.5, white, 0), {1 - f, 1 - f, 1 - f}, c);
  expectNear(layers(0.5, 1.5, white, 0), {1 - f / 2, 1 - f / 2, 1 - f / 2}, c);
  expectNear(layers(1, 1.5, {0.5, 1, 1}, 0), {(1 - f) * std::pow(0.5, longer), 1 - f, 1 - f}, c);
  // sheen reflects something, the more the flatter the view, and 5.2's coat also what its facets reflect again
  const auto of = [&](const json& o) { return double(values(o, c)[0]); };
  const double seen = of(layers(0, 1.5, white, 1));
  EXPECT_GT(seen, 0.5);
  EXPECT_LT(seen, 0.99);
  EXPECT_NEAR(of(layers(1, 1.5, white, 0, 5)), 1 - f, 0.02);
  c.incoming = {0, 0.98f, 0.199f};
  EXPECT_LT(of(layers(0, 1.5, white, 1)), seen);
}

TEST(Place, BumpIsTheNormalOfTheRaisedSurface) {
  ShadingContext c;
  c.trueNormal = c.normal = {0, 0, 1};
  c.incoming = {0, 0.6f, 0.8f};
  c.position.dx = {0, 0.01f, 0}, c.position.dy = {-0.01f, 0, 0};
  // raised by 0.5 y - 0.25 x, times a distance of 2: z = y - 0.5 x, normal (0.5, -1, 1)
  for (const double width : {1.0, 0.1}) {
    const double step = 0.01 * width;
    const json heights = {3, 3 + 0.5 * step, 3 + 0.25 * step, 2, 1, {0, 0, 1}};
    expectNear(op("bump", heights, {{"width", width}}), {0.5 / 1.5, -1 / 1.5, 1 / 1.5}, c, {}, 1e-3);
  }
  expectNear(op("bump", {0, 0, 0, 1, 1, {0, 0, 1}}), {0, 0, 1}, c);
  expectNear(op("bump", {0, 1, 0, 1, 0, {0, 0, 1}}), {0, 0, 1}, c);  // of no strength
  // Blender 3.4 bends it until the reflection leaves the surface at a height of at least 0.01.
  const std::vector<float> n = values(op("bump", {0, 0.05, 0, 1, 1, {0, 0, 1}}, {{"version", 3}}), c);
  const Vec3f normal{n[0], n[1], n[2]};
  const Vec3f reflected = normal * (2 * dot(normal, c.incoming)) - c.incoming;
  EXPECT_NEAR(reflected.z, 0.01, 1e-4);
  EXPECT_NEAR(length(normal), 1, 1e-5);
}

TEST(Place, FresnelAndFacing) {
  ShadingContext c;
  c.normal = {0, 0, 1};
  c.incoming = {0, 0, 1};
  expectNear(op("fresnel", {1.5, {0, 0, 1}}), {0.04}, c);
  expectNear(op("layer-weight-fresnel", {1 / 3.0, {0, 0, 1}}), {0.04}, c);
  expectNear(op("fresnel", {1, {0, 0, 1}}), {0}, c);
  // 60 degrees, eta 1.5: by the sines and tangents of Fresnel's own formulae
  const double i = kPid / 3, t = std::asin(std::sin(i) / 1.5);
  const double s = std::sin(i - t) / std::sin(i + t), p = std::tan(i - t) / std::tan(i + t);
  const double reflectance = 0.5 * (s * s + p * p);
  c.incoming = {0, static_cast<float>(std::sin(i)), 0.5f};
  expectNear(op("fresnel", {1.5, {0, 0, 1}}), {reflectance}, c);
  c.backfacing = true;
  expectNear(op("fresnel", {1.5, {0, 0, 1}}), {1}, c);  // total reflection from within
  expectNear(op("fresnel", {1 / 1.5, {0, 0, 1}}), {reflectance}, c);
  expectNear(op("layer-weight-facing", {0.5, {0, 0, 1}}), {0.5}, c);
  expectNear(op("layer-weight-facing", {0.25, {0, 0, 1}}), {1 - std::sqrt(0.5)}, c);
  expectNear(op("layer-weight-facing", {0.75, {0, 0, 1}}), {1 - 0.25}, c);
}

TEST(Place, LightFalloff) {
  ShadingContext c;
  c.rayLength = 2;
  expectNear(op("light-falloff-quadratic", {3, 0}), {3}, c);
  expectNear(op("light-falloff-linear", {3, 0}), {6}, c);
  expectNear(op("light-falloff-constant", {3, 0}), {12}, c);
  expectNear(op("light-falloff-constant", {3, 4}), {6}, c);
  c.rayLength = 3.4e38f;
  expectNear(op("light-falloff-constant", {3, 4}), {3}, c);
  expectNear(op("light-falloff-quadratic", {3, 4}, {{"version", 3}}), {3}, c);
}

TEST(Place, Spectra) {
  // Planck's law and the CIE's functions by numpy; no colour changes beyond 800 and 12000 K
  const json rounded{{"version", 4}};
  expectNear(op("blackbody", {500}, rounded), {5.41319, 0, 0}, {}, {}, 2e-5);
  expectNear(op("blackbody", {1000}, rounded), {4.60143, 0.0390083, 0}, {}, {}, 2e-5);
  expectNear(op("blackbody", {2700}, rounded), {1.93480, 0.803572, 0.191814}, {}, {}, 2e-5);
  expectNear(op("blackbody", {6500}, rounded), {1.04316, 0.983646, 1.03488}, {}, {}, 2e-5);
  expectNear(op("blackbody", {20000}, rounded), {0.826285, 0.994518, 1.56619}, {}, {}, 2e-5);
  expectNear(op("blackbody", {6500}), {1.04333, 0.983624, 1.03463}, {}, {}, 2e-5);
  const double x = 0.5121, y = 1, z = 0.0057;  // at 555 nm
  expectNear(op("wavelength", {555}), {(3.24096994 * x - 1.53738318 * y - 0.49861076 * z) / 2.52,
                                       (-0.96924364 * x + 1.8759675 * y + 0.04155506 * z) / 2.52, 0});
  expectNear(op("wavelength", {555}, rounded), {(3.2404542 * x - 1.5371385 * y - 0.4985314 * z) / 2.52,
                                                (-0.9692660 * x + 1.8760108 * y + 0.0415560 * z) / 2.52, 0});
  expectNear(op("wavelength", {300}), {0, 0, 0});
  expectNear(op("wavelength", {800}), {0, 0, 0});
}

// ---- images ---------------------------------------------------------------------------------------------------------

// 4 x 2 texels of red x, green y, blue 0.5, alpha.
Image texels() {
  Image image{"", 4, 2, 4, false, {}, {}, false};
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x)
      for (const float v : {static_cast<float>(x), static_cast<float>(y), 0.5f, x == 0 ? 0.5f : 1.0f})
        image.floats.push_back(v);
  return image;
}

TEST(Place, Images) {
  const std::vector<Image> images = {texels(), Image{"", 1, 1, 3, false, {}, {7, 8, 9}, false}};
  const Texture textures[] = {{0, Wrap::kRepeat, Wrap::kRepeat, Filter::kNearest},
                              {1, Wrap::kClip, Wrap::kClip, Filter::kNearest},
                              {0, Wrap::kRepeat, Wrap::kRepeat, Filter::kLinear}};
  const TextureAccess access{textures, images.data()};
  const auto at = [&](const char* name, json v, std::vector<double> expected, json p = json::object()) {
    if (!p.contains("texture")) p["texture"] = 0;
    json in = json::array({v});
    if (std::string(name).starts_with("image-box")) in = v;
    expectNear(op(name, in, p), expected, {}, access, 1e-5);
  };
  at("image", {0.1, 0.1, 0}, {0, 0, 0.5});
  at("image-alpha", {0.1, 0.1, 0}, {0.5});
  at("image", {0.1, 0.6, 9}, {0, 1, 0.5});
  at("image", {1.3, -0.3, 0}, {1, 1, 0.5});
  at("image", {0.1, 0.1, 0}, {0, 0, 1}, {{"unassociate", true}});
  at("image", {0.25, 0.25, 0}, {0.5, 0, 0.5}, {{"texture", 2}});
  at("image-alpha", {0.25, 0.25, 0}, {0.75}, {{"texture", 2}});
  at("image", {0.1, 0.1, 0}, {7, 8, 9}, {{"texture", 1}});
  at("image-alpha", {0.1, 0.1, 0}, {1}, {{"texture", 1}});
  at("image-alpha", {1.1, 0.1, 0}, {0}, {{"texture", 1}});
  // UDIM: the first image at (0, 0), the second one at column 1 of row 1
  const json tiles{{"texture", {{1012, 1}, {1001, 0}}}};
  at("image", {0.3, 0.6, 0}, {1, 1, 0.5}, tiles);
  at("image", {1.3, 1.6, 0}, {7, 8, 9}, tiles);
  at("image", {1.3, 0.6, 0}, {1, 0, 1}, tiles);
  at("image-alpha", {1.3, 0.6, 0}, {1}, tiles);
  at("image", {-0.3, 0.6, 0}, {2, 1, 0.5}, tiles);  // tile 1001 goes on, as in Cycles
  at("image", {-1.3, 0.6, 0}, {1, 0, 1}, tiles);
  // from the middle of the cube: towards +x, u = 1/4; v = 1/2 at the equator; up on the side of -y, u = 0 or 1
  at("image", {1, 0.5, 0.6}, {1, 1, 0.5}, {{"projection", "sphere"}});
  at("image", {0.5, 0.9, 0.4}, {2, 0, 0.5}, {{"projection", "sphere"}});
  at("image", {0, 0.5, 0.6}, {3, 1, 0.5}, {{"projection", "sphere"}});
  at("image", {0.9, 0.5, 0.9}, {1, 1, 0.5}, {{"projection", "tube"}});
  at("image", {0.1, 0.5, 0.1}, {3, 0, 0.5}, {{"projection", "tube"}});
  // box: each side by its own two axes, mirrored on one of a pair
  at("image-box", {{9, 0.3, 0.6}, {1, 0, 0}}, {1, 1, 0.5});
  at("image-box", {{9, 0.3, 0.6}, {-1, 0, 0}}, {2, 1, 0.5});
  at("image-box", {{0.3, 9, 0.6}, {0, 1, 0}}, {2, 1, 0.5});
  at("image-box", {{0.3, 9, 0.6}, {0, -1, 0}}, {1, 1, 0.5});
  at("image-box", {{0.6, 0.3, 9}, {0, 0, 1}}, {2, 1, 0.5});
  at("image-box", {{0.6, 0.3, 9}, {0, 0, -1}}, {1, 1, 0.5});
  // half way between x and y: half of both; alike in all three: a third
  at("image-box", {{0.3, 0.1, 0.1}, {1, 1, 0}}, {0.5 * 0 + 0.5 * 2, 0, 0.5}, {{"blend", 0.5}});
  at("image-box-alpha", {{0.3, 0.1, 0.1}, {1, 1, 0}}, {0.75}, {{"blend", 0.5}});
  at("image-box", {{0.1, 0.1, 0.1}, {-1, -1, -1}}, {1.0, 0, 0.5}, {{"blend", 1}});
  // the sky: u = 1/2 towards +x, growing clockwise as seen from above; v = 1 is up
  at("environment", {1, -0.01, 0.1}, {2, 1, 0.5});
  at("environment", {0, 5, -0.1}, {1, 0, 0.5});
  at("environment", {0, -5, -0.1}, {3, 0, 0.5}, {{"projection", "equirectangular"}});
  at("environment", {0.2, -1, 0.2}, {2, 1, 0.5}, {{"projection", "mirror-ball"}});
  at("environment", {-1, 0.9, -0.2}, {0, 0, 0.5}, {{"projection", "mirror-ball"}});
  at("environment-alpha", {-1, 0.9, -0.2}, {0.5}, {{"projection", "mirror-ball"}});
}

}  // namespace
}  // namespace wardmis
