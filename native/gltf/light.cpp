// SPDX-License-Identifier: GPL-3.0-or-later
#include "gltf/light.h"

#include <cmath>

#include "math/number.h"

namespace wardmis {
namespace {

// Whether it emits anything at all.
std::optional<Light> emitting(const Json& json, const Light& light) {
  if (!isFinite(light.emitted)) json.fail("its power is not a number of single precision");
  if (isBlack(light.emitted)) return std::nullopt;
  return light;
}

}  // namespace

std::optional<Light> readLight(const Json& json, const Affine& toWorld, Materials& materials) {
  constexpr std::pair<std::string_view, LightType> kTypes[] = {
      {"area", LightType::kArea}, {"point", LightType::kPoint}, {"spot", LightType::kSpot}, {"sun", LightType::kSun}};
  constexpr std::pair<std::string_view, bool> kIsEllipse[] = {{"rectangle", false}, {"ellipse", true}};
  Light light;
  light.name = json.name();
  light.type = json.at("type").choice(kTypes);
  light.maxBounces = static_cast<int>(json.integerOr("maxBounces", light.maxBounces, 0, 1 << 20));
  light.toWorld = toWorld;
  light.shadow = json.booleanOr("shadow", true);
  light.met = json.booleanOr("met", true);
  light.onCatchers = json.booleanOr("onCatchers", true);
  const Rgb color = json.lightOr("color", {1, 1, 1});
  switch (light.type) {
    case LightType::kArea: {
      light.emitted = color * json.at("radiance").number();
      if (const auto shape = json.find("shape")) light.ellipse = shape->choice(kIsEllipse);
      if (const auto size = json.find("size")) {
        const auto xy = size->numbers<2>();
        light.sizeX = xy[0];
        light.sizeY = xy[1];
      }
      const float area = light.sizeX * light.sizeY * length(cross(toWorld.x, toWorld.y));
      if (area > FLT_MAX) json.fail("its area is beyond what is counted with", "make the light or its object smaller");
      if (!(light.sizeX > 0 && light.sizeY > 0 && area > 0))
        json.fail("its area is not positive", "give the light and its object a size and a scale above 0");
      light.spread = json.numberOr("spread", kPi<float>, 0, 3.1416f);
      if (light.spread == 0) json.at("spread").failExpected("an angle above 0");
      break;
    }
    case LightType::kSpot:
      light.angle = json.numberOr("angle", kPi<float> / 4, 0, 3.1416f);
      if (light.angle == 0) json.at("angle").failExpected("an angle above 0");
      light.blend = json.numberOr("blend", 0, 0, 1);
      light.cosine = json.booleanOr("cosine", false);
      [[fallthrough]];
    case LightType::kPoint:
      light.emitted = color * json.at("intensity").number();
      light.radius = json.numberOr("radius", 0, 0);
      light.facing = json.booleanOr("facing", true);
      break;
    case LightType::kSun:
      light.emitted = color * json.at("irradiance").number();
      light.angle = json.numberOr("angle", 0, 0, 3.1416f);
      light.flat = json.booleanOr("flat", false);
      break;
  }
  light.program = materials.program(json, "light " + json.described(), light.result);
  return emitting(json, light);
}

std::optional<Light> readPunctualLight(const Json& json, const Affine& toWorld) {
  constexpr std::pair<std::string_view, LightType> kTypes[] = {
      {"directional", LightType::kSun}, {"point", LightType::kPoint}, {"spot", LightType::kSpot}};
  Light light;
  light.name = json.name();
  light.type = json.at("type").choice(kTypes);
  light.toWorld = toWorld;
  light.emitted = json.colorOr("color", {1, 1, 1}) * json.numberOr("intensity", 1, 0);
  if (light.type == LightType::kSpot) {
    float inner = 0, outer = kPi<float> / 4;  // half angles
    if (const auto spot = json.find("spot")) {
      inner = spot->numberOr("innerConeAngle", inner, 0, kPi<float> / 2);
      outer = spot->numberOr("outerConeAngle", outer, 0, kPi<float> / 2);
    }
    if (!(inner < outer)) json.fail("expected innerConeAngle below outerConeAngle");
    light.angle = 2 * outer;
    light.blend = (std::cos(inner) - std::cos(outer)) / (1 - std::cos(outer));  // full strength at the inner angle
  }
  return emitting(json, light);
}

Camera readCamera(const Json& json, const Json& node, const Affine& toWorld, const Film& film) {
  Camera camera;
  camera.name = node.name();
  camera.toWorld = {normalize(toWorld.x), normalize(toWorld.y), normalize(toWorld.z), toWorld.t};
  if (!isFinite(camera.toWorld.x) || !isFinite(camera.toWorld.y) || !isFinite(camera.toWorld.z) ||
      camera.toWorld.determinant() == 0)
    node.fail("carries a camera, but its scale is 0", "give the camera a scale of 1");

  const auto setClip = [&](const Json& place, float near, float far) {
    if (!(near < far)) place.fail("expected the near clip distance below the far one");
    camera.clipNear = near;
    camera.clipFar = far;
  };
  if (const auto extension = json.extension("WARDMIS_scene")) {
    constexpr std::pair<std::string_view, Projection> kProjections[] = {
        {"perspective", Projection::kPerspective},
        {"orthographic", Projection::kOrthographic},
        {"equirectangular", Projection::kEquirectangular},
        {"central-cylindrical", Projection::kCentralCylindrical},
        {"fisheye-equidistant", Projection::kFisheyeEquidistant},
        {"fisheye-equisolid", Projection::kFisheyeEquisolid},
        {"fisheye-polynomial", Projection::kFisheyePolynomial},
        {"mirror-ball", Projection::kMirrorBall},
        {"equiangular-cube-face", Projection::kEquiangularCubeFace}};
    if (const auto projection = extension->find("projection")) camera.projection = projection->choice(kProjections);
    camera.fov = extension->numberOr("fov", camera.fov, 0);
    if (camera.projection == Projection::kFisheyePolynomial) extension->at("polynomial").numbers(camera.polynomial);
    const Json plane = extension->at("viewPlane");
    const auto [left, right, bottom, top] = plane.numbers<4>();
    if (camera.panoramic() ? left == right || bottom == top : !(left < right && bottom < top))
      plane.failExpected("[left, right, bottom, top] with left < right and bottom < top");
    camera.left = left, camera.right = right, camera.bottom = bottom, camera.top = top;
    if (const auto planes = extension->find("viewPlanes")) {
      const JsonArray steps = planes->array();
      if (camera.projection != Projection::kPerspective || steps.size() < 2 || steps.size() > 129)
        planes->failExpected("2 to 129 view planes, of a perspective camera");
      for (size_t i = 0; i < steps.size(); i++) {
        const auto p = steps[i].numbers<4>();
        if (!(p[0] < p[1] && p[2] < p[3]))
          steps[i].failExpected("[left, right, bottom, top] with left < right and bottom < top");
        camera.viewPlanes.push_back(p);
      }
    }
    if (const auto clip = extension->find("clip")) {
      const auto [near, far] = clip->numbers<2>();
      setClip(*clip, near, far);
    }
    camera.lensRadius = extension->numberOr("lensRadius", 0, 0);
    camera.focusDistance = extension->numberOr("focusDistance", 1, 0);
    if (camera.lensRadius > 0 && camera.focusDistance == 0)
      extension->fail("focusDistance is 0, but lensRadius is not");
    camera.blades = static_cast<int>(extension->integerOr("blades", 0, 0, 1000));
    camera.bladeRotation = extension->numberOr("bladeRotation", 0);
    camera.bladeRatio = extension->numberOr("bladeRatio", 1, 1e-3f, 1e3f);
    return camera;
  }

  constexpr std::pair<std::string_view, bool> kIsOrthographic[] = {{"perspective", false}, {"orthographic", true}};
  const bool orthographic = json.at("type").choice(kIsOrthographic);
  if (orthographic) camera.projection = Projection::kOrthographic;
  const Json lens = json.at(orthographic ? "orthographic" : "perspective");
  const float top =
      orthographic ? lens.at("ymag").number(1e-9f, 1e9f) : std::tan(lens.at("yfov").number(1e-4f, 3.14f) / 2);
  const float right = top * static_cast<float>(film.width) / static_cast<float>(film.height);
  camera.left = -right, camera.right = right, camera.bottom = -top, camera.top = top;
  setClip(lens, lens.at("znear").number(0), lens.numberOr("zfar", camera.clipFar, 0));
  return camera;
}

}  // namespace wardmis
