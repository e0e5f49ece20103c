// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces of many lobes in whole renders: what is known of their light, and that no choice of techniques changes it.
#include <gtest/gtest.h>

#include "integrate/lobe_surface.h"
#include "integrate/setup.h"
#include "scenes.h"

namespace wardmis {
namespace {

using namespace test;

constexpr Rgb kWhite{1, 1, 1};

// A sphere, seen so that it fills half of the image.
Scene ball(std::vector<Closure> closures, int resolution = 16) {
  Scene scene;
  scene.materials = {material(std::move(closures)), ward({0.5f, 0.5f, 0.5f}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd)};
  addSphere(scene, 24, 0);
  lookFrom(scene, 0.7f, 1.25f, resolution);
  return scene;
}

RenderSettings settings(Allocation allocation = Allocation::kEqual) {
  RenderSettings s;
  s.allocation = allocation;
  s.spp = 64, s.threads = 2, s.maxDepth = 64;
  return s;
}

double meanOf(const Scene& scene, const RenderSettings& s) {
  Statistics statistics;
  const FilmBuffer film = render(scene, s, statistics);
  double sum = 0;
  for (const Pixel& p : film.pixels) {
    const Rgb c = film.mean(p);
    EXPECT_TRUE(std::isfinite(c.x + c.y + c.z));
    sum += double(luminance(c));
  }
  return sum / double(film.pixels.size());
}

// White surfaces that lose nothing look like the sky around them; .5 % are the noise and, of many facets' reflections,
// the tables.
TEST(Closures, WhiteOnesVanishInAWhiteSky) {
  const std::vector<std::pair<const char*, std::vector<Closure>>> all = {
      {"diffuse", {closure(ClosureType::kDiffuse)}},
      {"rough diffuse", {with(closure(ClosureType::kDiffuse), 0, 0.5f)}},
      {"translucent", {closure(ClosureType::kTranslucent)}},
      {"transparent", {closure(ClosureType::kTransparent)}},
      {"half transparent",
       {closure(ClosureType::kTransparent, kWhite, 0.5f), closure(ClosureType::kDiffuse, kWhite, 0.5f)}},
      {"mirror", {rough(closure(ClosureType::kGlossy), 0)}},
      {"ggx", {rough(closure(ClosureType::kGlossy), 0.25f)}},
      {"glass", {rough(closure(ClosureType::kGlass), 0)}},
      {"mirror and diffuse",
       {rough(closure(ClosureType::kGlossy, kWhite, 0.3f), 0), closure(ClosureType::kDiffuse, kWhite, 0.7f)}},
      {"many",
       {rough(closure(ClosureType::kGlossy, kWhite, 0.2f), 0), rough(closure(ClosureType::kGlossy, kWhite, 0.2f), 0.2f),
        rough(closure(ClosureType::kGlass, kWhite, 0.2f), 0), closure(ClosureType::kDiffuse, kWhite, 0.2f),
        closure(ClosureType::kTransparent, kWhite, 0.1f), closure(ClosureType::kTranslucent, kWhite, 0.1f)}}};
  for (const auto& [name, closures] : all) {
    Scene scene = ball(closures);
    worldOf(scene).radiance = kWhite;
    for (Allocation a : {Allocation::kEqual, Allocation::kAuto})
      EXPECT_NEAR(meanOf(scene, settings(a)), 1, 0.005) << name;
  }
}

// Lobes of which Cycles has nothing but f cos are asked a shorter way: it tells the same.
TEST(LobeSurface, TheShortWayTellsTheSame) {
  const auto lobe = [](LobeKind kind, Rgb weight) {
    Lobe l;
    l.kind = kind, l.weight = weight, l.ax = 0.3f, l.ay = 0.2f, l.eta = 1.5f, l.fresnel = Fresnel::kBlended;
    l.f0 = {0.04f, 0.1f, 0.2f};
    return l;
  };
  const Vec3f wo = normalize(Vec3f{0.3f, -0.5f, 0.6f});
  LobeSurface<5> s;
  s.begin(Framef::around({0, 0, 1}), wo);
  for (const LobeKind kind : {LobeKind::kLambert, LobeKind::kGgx, LobeKind::kBurley, LobeKind::kTranslucent,
                              LobeKind::kGgxGlass, LobeKind::kMirror, LobeKind::kFibres})
    s.add(lobe(kind, {0.2f, 0.1f, 0.15f}));
  s.finish({});
  for (int k = 0; k < 200; ++k) {
    const float z = 1 - 0.01f * static_cast<float>(k), phi = 2.4f * static_cast<float>(k);
    const Vec3f wi = Vec3f{std::cos(phi), std::sin(phi), 0} * std::sqrt(std::max(0.0f, 1 - z * z)) + Vec3f{0, 0, z};
    std::array<Rgb, 4> f[2]{};
    Fractions<5> p[2]{};
    LitOtherwise<5> lit[2];
    FByComponent<5> byComponent;
    byComponent.clear();
    s.evaluate(wi, wo, z > 0, f[0], p[0], lit[0]);
    s.evaluate(wi, wo, z > 0, f[1], p[1], lit[1], &byComponent);
    EXPECT_EQ(f[0], f[1]) << z;
    EXPECT_EQ(p[0], p[1]) << z;
    EXPECT_EQ(lit[0].same, lit[1].same) << z;
    EXPECT_EQ(lit[0].other, lit[1].other) << z;
    EXPECT_EQ(lit[0].density, lit[1].density) << z;
    EXPECT_EQ(lit[0].any, lit[1].any) << z;
  }
}

// A material whose inputs are looked up nowhere is resolved a shorter way, too.
TEST(Closures, ConstantMaterialsLookTheSame) {
  for (const ClosureType type : {ClosureType::kPrincipled3, ClosureType::kPrincipled, ClosureType::kGlass}) {
    Scene scene = ball({closure(type, {0.8f, 0.3f, 0.1f})});
    worldOf(scene).radiance = kWhite;
    ASSERT_TRUE(scene.materials[0].isConstant());
    RenderSettings s = settings();
    s.spp = 4;
    const double slow = meanOf(scene, s);
    scene.materials[0].constant = true;
    EXPECT_EQ(meanOf(scene, s), slow);
  }
}

// Allocations, weights and the kind of integrand share samples; the image is the same. 1 % is five of its errors.
TEST(Closures, NoChoiceOfTechniquesChangesTheImage) {
  std::vector<Closure> all = {closure(ClosureType::kPrincipled, {0.8f, 0.3f, 0.1f}, 0.6f),
                              rough(closure(ClosureType::kGlass, kWhite, 0.2f), 0.2f),
                              rough(closure(ClosureType::kGlossy, kWhite, 0.1f), 0),
                              closure(ClosureType::kTransparent, kWhite, 0.1f)};
  for (const auto& [scalar, value] : {std::pair{principled::kCoatWeight, 0.5f}, {principled::kSheenWeight, 0.3f}})
    all[0].scalars[scalar].value = value;
  Scene scene = ball(all);
  addPlane(scene, 4, 1, -1.001f);
  worldOf(scene).radiance = {0.2f, 0.2f, 0.2f};
  Light area;
  area.type = LightType::kArea;
  area.emitted = {8, 8, 8};
  area.sizeX = area.sizeY = 2;
  area.toWorld.t = {1, 0, 3};
  scene.lights = {area};
  EXPECT_EQ(BuiltScene(scene, 2).techniqueNames().size(), 8u);
  RenderSettings reference = settings();
  reference.spp = 512, reference.maxDepth = 16;
  const double expected = meanOf(scene, reference);
  const auto check = [&](Allocation a, Integrand integrand, std::optional<Weights> weights) {
    RenderSettings s = settings(a);
    s.spp = 256, s.maxDepth = 16, s.integrand = integrand, s.weights = weights, s.seed = 1;
    EXPECT_NEAR(meanOf(scene, s) / expected, 1, 0.01) << name(a) << ' ' << name(integrand);
  };
  for (Allocation a :
       {Allocation::kEqual, Allocation::kSecondMoment, Allocation::kVariance, Allocation::kAlbedo, Allocation::kAuto})
    for (Integrand i : {Integrand::kSplit, Integrand::kJoint}) check(a, i, {});
  for (Weights w : {Weights::kNonbalance, Weights::kPower, Weights::kMaximum})
    check(Allocation::kEqual, Integrand::kJoint, w);
}

// The same surface by closures and in the short form: the same expectation. 1 % is five of its errors.
TEST(Closures, WardsLobeIsThatOfTheShortForm) {
  Scene scene = ball({with(with(closure(ClosureType::kWard, {0.5f, 0.4f, 0.3f}), 0, 0.2f), 1, 0.2f),
                      closure(ClosureType::kDiffuse, {0.2f, 0.3f, 0.4f})});
  addCosineSky(scene, 64);
  RenderSettings s = settings();
  const double closures = meanOf(scene, s);
  scene.materials[0] = ward({0.2f, 0.3f, 0.4f}, {0.5f, 0.4f, 0.3f}, 0.2f, WardVariant::kWardGmd);
  EXPECT_NEAR(closures / meanOf(scene, s), 1, 0.01);
}

// Light through sheets: a shadow ray passes so many, and colours multiply.
TEST(Closures, SheetsLetLightThrough) {
  for (int sheets : {1, 2, 8, 9}) {
    Scene scene = diffusePlane(4);
    scene.materials.push_back(material({closure(ClosureType::kTransparent, {0.5f, 0.5f, 0.5f})}));
    for (int i = 1; i <= sheets; ++i) {
      addPlane(scene, 1000, 1, 0.5f * static_cast<float>(i));
      scene.instances.back().visibility &= static_cast<uint8_t>(~kSeenByCamera);  // which would pass at random
    }
    Light sun;
    sun.type = LightType::kSun;
    sun.emitted = {1, 1, 1};
    scene.lights = {sun};
    RenderSettings s = settings();
    s.spp = 4, s.integrator = Integrator::kDirect;
    for (int most : {8, 2, 9, 0}) {
      s.maxTransparent = most;
      const double through = sheets > most ? 0 : std::pow(0.5, sheets);
      EXPECT_NEAR(meanOf(scene, s), through / kPi<double>, 1e-6 + 1e-5 * through) << sheets;
    }
  }
}

// A ray that is no shadow ray passes one sheet more, or since version 5 as many as they, but one at least. Behind these
// it sees the sky and what emits, and no surface.
class Sheets : public testing::TestWithParam<uint8_t> {};
TEST_P(Sheets, BehindTheLastThereIsTheSky) {
  const auto sheets = [](Scene& scene, int count) {
    Closure half = closure(ClosureType::kTransparent, {0.5f, 0.5f, 0.5f});
    half.version = GetParam();
    scene.materials.push_back(material({half}));
    const int sheet = static_cast<int>(scene.materials.size()) - 1;
    for (int i = 1; i <= count; ++i) addPlane(scene, 1000, sheet, 0.5f * static_cast<float>(i));
  };
  for (int count : {1, 2, 3})
    for (int most : {0, 1, 2}) {
      RenderSettings s = settings();
      s.spp = 64, s.maxTransparent = most;
      const int last = GetParam() >= 5 ? std::max(most, 1) : most + 1;
      const double passed = count <= last ? std::pow(0.5, count) : 0;
      Scene seen = diffusePlane(4);
      seen.instances.clear();
      sheets(seen, count);
      seen.worlds = {World{}};
      worldOf(seen).radiance = kWhite;
      EXPECT_NEAR(meanOf(seen, s), passed, 1e-5) << count << ' ' << most;
      // the sheets hidden from the camera, before which a white plane reflects what comes through them
      Scene lit = diffusePlane(4);
      lit.materials[0] = material({closure(ClosureType::kDiffuse, kWhite)});
      sheets(lit, count);
      for (size_t i = 1; i < lit.instances.size(); ++i)
        lit.instances[i].visibility &= static_cast<uint8_t>(~kSeenByCamera);
      lit.worlds = {World{}};
      worldOf(lit).radiance = kWhite;
      for (auto integrator : {Integrator::kDirect, Integrator::kPath}) {
        s.integrator = integrator;
        EXPECT_NEAR(meanOf(lit, s), passed, 0.02 * passed) << count << ' ' << most;
      }
      // behind them a surface
      addPlane(seen, 1000, 0, 0);
      seen.materials[0] = material({closure(ClosureType::kDiffuse, kWhite)});
      if (2 * count <= most) {
        EXPECT_GT(meanOf(seen, s), 0) << count;
      }
      if (count >= last) {
        EXPECT_EQ(meanOf(seen, s), 0) << count;
      }
      seen.materials[0].emission.value = {3, 3, 3};
      if (count >= last) {
        EXPECT_NEAR(meanOf(seen, s), 3 * passed, 1e-4) << count;
      }
    }
}
INSTANTIATE_TEST_SUITE_P(Closures, Sheets, testing::Values(4, 5));

// Panes whose shading normals all look to the other side than their faces, below a lamp: what a translucent one lets
// through by its normal is what it sends back from its face.
TEST(Closures, LightSamplesGoByTheNormalAlone) {
  const auto lit = [](ClosureType type, bool backwards, bool above) {
    Scene scene = diffusePlane(4);
    scene.materials[0] = material({closure(type)});
    if (backwards)
      for (MeshPart& p : scene.meshes[0].parts)
        p.normals = Array<Vec3f>::of(std::vector<Vec3f>(p.positions.size(), Vec3f{0, 0, -1}));
    Light lamp;
    lamp.emitted = {100, 100, 100};
    lamp.toWorld.t = {0, 0, above ? 5.0f : -5.0f};
    scene.lights.push_back(lamp);
    RenderSettings s = settings();
    s.integrator = Integrator::kDirect;
    return meanOf(scene, s);
  };
  for (ClosureType type : {ClosureType::kDiffuse, ClosureType::kTranslucent}) {
    const bool through = type == ClosureType::kTranslucent;
    const double all = lit(type, false, !through);
    EXPECT_GT(all, 0.1);
    EXPECT_EQ(lit(type, false, through), 0);
    EXPECT_NEAR(lit(type, true, through) / all, 1, 0.01);
    EXPECT_EQ(lit(type, true, !through), 0);
  }
}

// A plain whose shading normals are so far from its face's that by the rules of version 3 they are turned: a sky, which
// light samples do not aim at, adds to a lamp, though the diffuse lobe's normal is then no longer the plane's own.
TEST(Closures, DiffuseLobesWithNormalsOfTheirOwnSeeTheSkyBesideALamp) {
  const auto lit = [](bool lamp, bool sky) {
    Scene scene = diffusePlane(4);
    Closure diffuse = closure(ClosureType::kDiffuse);
    diffuse.version = 3;
    scene.materials[0] = material({diffuse});
    for (MeshPart& p : scene.meshes[0].parts)
      p.normals = Array<Vec3f>::of(std::vector<Vec3f>(p.positions.size(), normalize(Vec3f{3, 0, 1})));
    if (lamp) {
      Light above;
      above.emitted = {100, 100, 100};
      above.toWorld.t = {3, 0, 5};
      scene.lights.push_back(above);
    }
    if (sky) {
      scene.worlds = {World{}};
      worldOf(scene).radiance = kWhite;
    }
    RenderSettings s = settings();
    s.integrator = Integrator::kDirect;
    return meanOf(scene, s);
  };
  EXPECT_NEAR(lit(true, true) / (lit(true, false) + lit(false, true)), 1, 0.02);
}

// A sheet that lets all light through and sends some of its own besides, under a white sky: 1 + a + e, the same with
// few paths as with many.
TEST(Closures, WhatIsAddedToATransparentSurfaceIsSeen) {
  for (const float a : {0.0f, 0.02f, 0.3f})
    for (const float e : {0.0f, 0.05f, 20.0f}) {
      Scene scene = diffusePlane(8);
      scene.worlds = {World{}};
      worldOf(scene).radiance = kWhite;
      scene.materials[0] = material({closure(ClosureType::kTransparent), closure(ClosureType::kDiffuse, {a, a, a})});
      scene.materials[0].emission.value = {e, e, e};
      RenderSettings s = settings();
      s.spp = 256;
      EXPECT_NEAR(meanOf(scene, s) / (1 + double(a + e)), 1, 0.02) << a << ' ' << e;
    }
}

// Sheets without an index of refraction before a glowing one: each is a transmission bounce, and B of them are
// followed.
TEST(Closures, TransmissionHasALimitOfItsOwn) {
  for (const ClosureType type : {ClosureType::kRefraction, ClosureType::kGlass})
    for (int sheets = 1; sheets <= 4; ++sheets)
      for (int bounces : {0, 1, 2}) {
        Scene scene = diffusePlane(4);
        scene.materials[0].emission.value = kWhite, scene.materials[0].diffuse.value = {0, 0, 0};
        scene.materials.push_back(material({with(closure(type), 1, 1)}));
        for (int i = 1; i <= sheets; ++i) addPlane(scene, 1000, 1, 0.5f * static_cast<float>(i));
        RenderSettings s = settings();
        s.spp = 4, s.maxDiffuse = s.maxGlossy = 0, s.maxTransmission = bounces;
        EXPECT_NEAR(meanOf(scene, s), sheets <= bounces + 1 ? 1 : 0, 1e-5) << sheets << ' ' << bounces;
      }
}

// A plane that scatters light to below, seen from there, under what some rays do not see: what glass lets pass is for
// rays of transmission alone; translucent light counts as diffuse where lamps and skies are seen, as in Cycles.
TEST(Closures, WhatTransmissionSeesIsItsOwn) {
  const auto through = [](const Closure& c, int kind, int hidden) {
    Scene scene;
    scene.materials = {material({c})};
    addPlane(scene, 1000, 0);
    lookFrom(scene, kPi<float> - 0.5f, 0.005f, 4);
    const auto visibility = static_cast<uint8_t>(kSeenByAll & ~hidden & ~kSeenByCamera);
    Light light;
    light.emitted = {1, 1, 1}, light.visibility = visibility, light.toWorld.t = {0, 0, 2};
    if (kind == 0) {
      worldOf(scene).radiance = kWhite, worldOf(scene).visibility = visibility;
    } else if (kind == 1) {
      light.type = LightType::kArea, light.sizeX = light.sizeY = 4;
      scene.lights = {light};
    } else {
      scene.materials.push_back(ward({0, 0, 0}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd));
      scene.materials[1].emission.value = kWhite;
      addPlane(scene, 2, 1, 2);
      scene.instances.back().visibility = visibility;
    }
    return meanOf(scene, settings());
  };
  for (const Closure& c : {closure(ClosureType::kTranslucent), rough(closure(ClosureType::kRefraction), 0.3f)})
    for (int kind : {0, 1, 2}) {
      const double all = through(c, kind, 0);
      EXPECT_GT(all, 0.1) << kind;
      const bool diffuse = c.type == ClosureType::kTranslucent && kind < 2;
      const int own = diffuse ? kSeenByDiffuse : kSeenByTransmission;
      const int others = kSeenByGlossy | (diffuse ? kSeenByTransmission : kSeenByDiffuse);
      EXPECT_NEAR(through(c, kind, others) / all, 1, 0.02) << kind;
      EXPECT_EQ(through(c, kind, own), 0) << kind;
    }
  // what reflects sees the same by its own rays
  Scene scene = ball({rough(closure(ClosureType::kGlossy), 0.3f)});
  worldOf(scene).radiance = kWhite;
  const double all = meanOf(scene, settings());
  worldOf(scene).visibility = kSeenByAll & ~kSeenByTransmission;
  EXPECT_EQ(meanOf(scene, settings()), all);
}

// A sun that shines along rough refraction from behind, where no facet refracts so: Cycles' value, unseen(); of a small
// lamp in that direction nearly all of it.
TEST(Closures, LampsThatGrazeRoughGlassAreSeen) {
  const Vec3f away = normalize(Vec3f{-0.9f, 0.3f, -0.15f}), across = normalize(Vec3f{0.3f, 0.9f, 0});
  Scene scene;
  scene.materials = {material({with(rough(closure(ClosureType::kRefraction), 0.4f, Glossy::kGgx), 1, 1.45f)})};
  addPlane(scene, 1000, 0);
  lookFrom(scene, 0.5f, 0.005f, 4);
  Light light;
  light.type = LightType::kSun;
  light.emitted = {1, 1, 1};
  light.toWorld = {across, cross(away, across), away, {0, 0, 0}};
  scene.lights = {light};
  const Lobe lobe = refractionLobe(4, LobeKind::kGgxRefraction, kWhite, 0.4f, 1.45f);
  const Vec3<double> wo{std::sin(0.5), 0, std::cos(0.5)}, wi{away.x, away.y, away.z};
  const double expected = unseen(lobe, wi, wo).fCos.y;
  EXPECT_GT(expected, 0.005);
  EXPECT_EQ(evaluate(lobe, wi, wo).fCos.y, 0);
  EXPECT_NEAR(meanOf(scene, settings()) / expected, 1, 2e-3);

  scene.lights[0].type = LightType::kArea, scene.lights[0].emitted = {2500, 2500, 2500};
  scene.lights[0].sizeX = scene.lights[0].sizeY = 0.02f, scene.lights[0].toWorld.t = away;
  const double lamp = meanOf(scene, settings(Allocation::kEqual));
  EXPECT_NEAR(lamp / expected, 1, 0.02);
  for (Allocation a : {Allocation::kSecondMoment, Allocation::kVariance, Allocation::kAuto})
    EXPECT_NEAR(meanOf(scene, settings(a)) / lamp, 1, 0.01) << name(a);
}

// Samples of Cycles leave by other densities than it counts, or by half vectors turned over, or refract upwards: under
// a constant sky a surface shows what they bring.
TEST(Closures, ShowWhatSamplesOfCyclesBring) {
  const auto old = [](Closure c) {
    c.version = 3;
    return c;
  };
  struct Case {
    Closure closure;
    float angle;
    double least;  // by how much it is another light than that of f
  };
  Closure stretched = old(rough(closure(ClosureType::kGlossy), 0.5f, Glossy::kBeckmann));
  stretched.scalars[1].value = 0.1f;
  const Case cases[] = {
      {rough(closure(ClosureType::kGlossy), 0.0625f, Glossy::kAshikhminShirley), 1.5533f, 0.3},
      {rough(closure(ClosureType::kGlossy), 0.6f, Glossy::kAshikhminShirley), 1.4f, 0.1},
      {stretched, 0.8f, 0.03},
      {old(with(rough(closure(ClosureType::kRefraction), 0.36f, Glossy::kGgx), 1, 0.9f)), 1.4835f, 0.3}};
  for (const Case& c : cases) {
    const Closure& k = c.closure;
    Scene scene;
    scene.materials = {material({k})};
    addPlane(scene, 1000, 0);
    lookFrom(scene, c.angle, 0.0005f, 4);
    worldOf(scene).radiance = kWhite;
    std::vector<Lobe> lobes;
    const auto add = [&](const Lobe& l) { lobes.push_back(l); };
    const Vec3<double> wo{std::sin(c.angle), 0, std::cos(c.angle)};
    if (k.type == ClosureType::kRefraction)
      addRefraction(k.version, k.distribution, kWhite, k.scalars[0].value, k.scalars[1].value, add);
    else
      addGlossy(k.version, k.distribution, kWhite, kWhite, k.scalars[0].value, k.scalars[1].value, float(wo.z), add);
    ASSERT_EQ(lobes.size(), 1u);
    constexpr int kSteps = 300;
    double brought = 0, own = 0;
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; j < kSteps; ++j) {
        const Vec3<double> wi = sample(lobes[0], wo, Vec2<double>{(i + 0.5) / kSteps, (j + 0.5) / kSteps}, 0.0);
        const LobeValue<double> v = evaluate(lobes[0], wi, wo);
        brought += weight(lobes[0], wi, wo).y / (kSteps * kSteps);
        if (v.pdf > 0) own += v.fCos.y / v.pdf / (kSteps * kSteps);
      }
    RenderSettings s = settings();
    s.spp = 1024;
    EXPECT_NEAR(meanOf(scene, s) / brought, 1, 0.013) << int(k.distribution);
    EXPECT_GT(std::abs(brought / own - 1), c.least) << int(k.distribution);
  }
}

// A technique that is called by a class of lobes is that class's on every surface, whatever other lobes are there.
TEST(Closures, TechniquesAreThoseOfTheirClass) {
  Scene scene = ball({rough(closure(ClosureType::kGlass), 0.2f)});
  scene.materials[1] =
      material({rough(closure(ClosureType::kGlossy), 0.2f), rough(closure(ClosureType::kGlass), 0.1f)});
  addPlane(scene, 1, 1, 100);
  worldOf(scene).radiance = kWhite;
  ASSERT_EQ(BuiltScene(scene, 2).techniqueNames()[1], "glass");
  for (int kind = 0; kind < 2; ++kind) {
    const FilmBuffer film = renderScene(scene, settings());
    std::array<uint64_t, 5> samples{};
    for (size_t i = 0; i < film.sampleCounts.size(); ++i) samples[i % 5] += film.sampleCounts[i];
    EXPECT_GT(samples[1], 0u) << kind;
    EXPECT_EQ(samples[0] > 0, kind == 1) << kind;
    EXPECT_EQ(samples[2] + samples[3], 0u) << kind;
    scene.instances[0].visibility = 0, scene.instances[1].toWorld.t = {0, 0, -100};  // the plane in its place
  }
}

// As many techniques as there may be lobes, and no more.
TEST(Closures, HaveTheTechniquesThatTheyNeed) {
  const auto names = [](std::vector<Closure> closures) {
    return BuiltScene(ball(std::move(closures)), 2).techniqueNames();
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(names({closure(ClosureType::kDiffuse)}), (Names{"lobe", "cosine", "light"}));
  EXPECT_EQ(names({closure(ClosureType::kPrincipled)}), (Names{"lobe", "cosine", "light"}));
  EXPECT_EQ(names({rough(closure(ClosureType::kGlass), 0.2f)}), (Names{"lobe", "cosine", "light"}));
  EXPECT_EQ(names({rough(closure(ClosureType::kGlass), 0)}),
            (Names{"glossy", "refraction", "lobe 3", "cosine", "light"}));
  EXPECT_EQ(names({rough(closure(ClosureType::kGlass), 0.2f), closure(ClosureType::kGlossy)}),
            (Names{"glossy", "glass", "lobe 3", "cosine", "light"}));
  EXPECT_EQ(
      names({closure(ClosureType::kGlossy), closure(ClosureType::kGlossy), rough(closure(ClosureType::kGlass), 0.2f)}),
      (Names{"glossy 1", "glossy 2", "glass", "cosine", "light"}));
  // more than there are techniques: by number, and the last are shared
  EXPECT_EQ(names(std::vector<Closure>(7, closure(ClosureType::kGlossy)))[5], "lobe 6");
}

// Passes of data show the first surface that is opaque enough, of all samples alike; what is behind it where it is not.
TEST(DataPasses, AreOfTheFirstThatIsOpaqueEnough) {
  Scene scene;
  const auto pane =
      material({closure(ClosureType::kTransparent, kWhite, 0.4f), closure(ClosureType::kDiffuse, kWhite, 0.6f)});
  scene.materials = {pane, material({closure(ClosureType::kDiffuse)})};
  scene.materials[0].index = 5, scene.materials[1].index = 6;
  addPlane(scene, 4, 0, 1);
  addPlane(scene, 4, 1, 0);
  worldOf(scene).radiance = {1, 1, 1};
  lookFrom(scene, 0, 1, 8);
  RenderSettings s = settings();
  s.data = true;
  scene.film.alphaThreshold = 0.5f;
  for (const FilmBuffer film = renderScene(scene, s); size_t i : {0, 20, 63}) {
    EXPECT_EQ(film.pixels[i].depth, 49);
    EXPECT_EQ(film.data[i].materialIndex, 5);
    EXPECT_NEAR(film.pixels[i].normal[2], film.samples, 1e-4);
    EXPECT_EQ(film.data[i].position.z, 1);
    EXPECT_EQ(film.data[i].uv[2], 0) << "there are none";
  }
  scene.film.alphaThreshold = 0.7f;
  const FilmBuffer film = renderScene(scene, s);
  int behind = 0;
  for (size_t i = 0; i < film.pixels.size(); ++i) {
    behind += film.data[i].materialIndex == 6 ? 1 : 0;
    EXPECT_EQ(film.pixels[i].depth, film.data[i].materialIndex == 6 ? 50 : 49);
  }
  EXPECT_NEAR(behind, 0.4 * 64,
              5 * std::sqrt(0.24 * 64));  // of one sample, the pass being of the last that it comes to
}

// To the colour passes of Cycles 3.4 the facets of a Principled node reflect all; later they reflect as its table says.
TEST(LightPasses, ColorOfPrincipledIsThatOfItsCycles) {
  for (const ClosureType type : {ClosureType::kPrincipled3, ClosureType::kPrincipled}) {
    Scene scene = diffusePlane(4);
    scene.materials = {material({closure(type)})};
    worldOf(scene).radiance = {1, 1, 1};
    RenderSettings s = settings();
    s.light = true;
    const FilmBuffer film = renderScene(scene, s);
    const double found = film.light[5].color[size_t(Component::kGlossy)][1] / film.samples;
    if (type == ClosureType::kPrincipled3)
      EXPECT_NEAR(found, 1, 1e-5);
    else
      EXPECT_NEAR(found, 0.04, 0.01);
  }
}

}  // namespace
}  // namespace wardmis
