// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/interaction.h"

#include "program/surface.h"

namespace wardmis::detail {

void resolve(const Scene& scene, const Material& m, const ShadedPoint& point, Vec2f uv, Surface& surface, Rgb& emission,
             Vec3f& normal) {
  Slots slots;
  const Vec3f own = runProgram(scene, point, slots);
  const Program& program = *m.program;
  const auto color = [&](const ColorInput& c) {
    return c.result >= 0 ? c.value * vectorOf(program, slots, c.result) : evaluate(scene, c, uv);
  };
  const auto reflectance = [&](const ColorInput& c) { return notNegative(color(c)); };
  const auto alpha = [&](const ScalarInput& c) {
    return c.result >= 0 ? clampedAlpha(c.value * numberOf(program, slots, c.result)) : evaluateAlpha(scene, c, uv);
  };
  surface.diffuse = reflectance(m.diffuse);
  surface.specular = reflectance(m.specular);
  surface.ax = alpha(m.alphaX);
  surface.ay = alpha(m.alphaY);
  emission = color(m.emission);
  if (m.normal < 0 && own == point.normal) return;
  const Vec3f n = m.normal < 0 ? own : directionOf(scene, program, slots, m.normal);
  const float l = length(n);
  if (l > 0) normal = bent(n / l, point.geometric, point.wo);
}

template <size_t K>
Framef resolveLobes(const Scene& scene, const Material& m, const ShadedPoint& point, Vec2f uv, Vec3f tangent,
                    const LobeNumbers& numbers, LobeSurface<K>& surface, Rgb& emission) {
  Slots slots;
  const Vec3f own = m.program ? runProgram(scene, point, slots) : point.normal;
  const auto color = [&](const ColorInput& c) {
    if (c.result >= 0) return c.value * vectorOf(*m.program, slots, c.result);
    return c.texture.texture >= 0 ? evaluate(scene, c, uv) : c.value;
  };
  const auto scalar = [&](const ScalarInput& c) {
    if (c.result >= 0) return c.value * numberOf(*m.program, slots, c.result);
    return c.texture.texture >= 0 ? c.value * sampleScalar(scene, c.texture, uv) : c.value;
  };
  const auto unit = [](Vec3f n, Vec3f otherwise) {
    const float l = length(n);
    return l > 0 ? n / l : otherwise;
  };
  const auto normalOf = [&](int result, Vec3f otherwise) {
    return result < 0 ? otherwise : unit(directionOf(scene, *m.program, slots, result), otherwise);
  };
  const auto frameAround = [&](Vec3f n, bool anisotropic, float rotation, int along = -1) {
    if (!anisotropic) return Framef::around(n);
    return turned(Framef::around(n, along >= 0 ? directionOf(scene, *m.program, slots, along) : tangent), rotation);
  };
  emission = isBlack(m.emission.value) ? Rgb{0, 0, 0} : color(m.emission);

  if (m.closures.empty()) {
    Lobe diffuse, ward;
    diffuse.weight = notNegative(color(m.diffuse));
    ward.weight = notNegative(color(m.specular));
    ward.kind = wardKind(m.variant);
    ward.ax = clampedAlpha(scalar(m.alphaX)), ward.ay = clampedAlpha(scalar(m.alphaY));
    const Vec3f normal = bent(normalOf(m.normal, own), point.geometric, point.wo);
    const Framef frame = frameAround(normal, ward.ax != ward.ay, m.rotation);
    surface.begin(frame, point.wo);
    if (maxComponent(diffuse.weight) > 0) surface.add(diffuse);
    if (maxComponent(ward.weight) > 0) surface.add(ward);
    surface.finish(numbers);
    return frame;
  }

  const Framef frame = Framef::around(own);
  // Cycles 3.4 alone draws none of a camera ray's closures less often than once in nine times
  const bool old = m.closures.front().version == 3;
  surface.begin(frame, point.wo, old, old && point.path.depth == 0 && point.path.transparent == 0);
  for (const Closure& c : m.closures) {
    ClosureValues v;
    v.weight = m.constant ? c.weight.value : color(c.weight);
    if (!(maxComponent(v.weight) > 0)) continue;
    if (c.type == ClosureType::kHoldout) {
      surface.holdout += (v.weight.x + v.weight.y + v.weight.z) / 3;
      continue;
    }
    if (m.constant) {
      for (size_t i = 0; i < c.colors.size(); ++i) v.colors[i] = c.colors[i].value;
      for (size_t i = 0; i < c.scalars.size(); ++i) v.scalars[i] = c.scalars[i].value;
    } else {
      for (size_t i = 0; i < c.colors.size(); ++i) v.colors[i] = color(c.colors[i]);
      for (size_t i = 0; i < c.scalars.size(); ++i) v.scalars[i] = scalar(c.scalars[i]);
    }
    const bool twoAlphas = c.type == ClosureType::kWard || c.type == ClosureType::kGlossy;
    const bool anisotropic = twoAlphas                             ? v.scalars[0] != v.scalars[1]
                             : c.type == ClosureType::kPrincipled3 ? v.scalars[principled3::kAnisotropic] != 0
                             : c.type == ClosureType::kPrincipled  ? v.scalars[principled::kAnisotropic] > 0
                                                                   : false;
    const auto frameOf = [&](Vec3f normal) {
      return normal == own ? uint8_t{0} : surface.addFrame(Framef::around(normal), c.version);
    };
    // What would reflect into the surface is turned until it does not, as in Cycles; since 4.x not what is diffuse, but
    // what is translucent is, since 5.x not sheen; and never on curves, of which a ribbon's own normal is not that of
    // what is shown.
    const auto reflecting = [&](Vec3f normal) {
      if (isCurve(point.shape) || (c.version >= 4 && c.type == ClosureType::kSheen)) return normal;
      return surface::visiblyReflecting(c.version, point.geometric, point.wo, normal);
    };
    const Vec3f told = normalOf(c.normal, own);
    // 3.4 asks a normal of the length that it has
    const Vec3f n = c.version > 3 || c.normal < 0
                        ? reflecting(told)
                        : unit(reflecting(directionOf(scene, *m.program, slots, c.normal)), own);
    std::array<uint8_t, 3> at{};
    at[kBaseFrame] =
        anisotropic ? surface.addFrame(frameAround(n, true, scalar(c.rotation), c.tangent), n == own ? 0 : c.version)
                    : frameOf(n);
    const Vec3f dull = c.version >= 4 && c.type != ClosureType::kTranslucent ? told : n;
    const uint8_t atDiffuse = dull == own ? uint8_t{0} : dull == n ? at[kBaseFrame] : frameOf(dull);
    at[kSheenFrame] = atDiffuse;
    if (c.type == ClosureType::kPrincipled3 || c.type == ClosureType::kPrincipled) {  // whose coat has its own normal
      const Vec3f coat = normalOf(c.coatNormal, own);
      at[kCoatFrame] = frameOf(coat == told && (c.version > 3 || c.normal < 0) ? n : reflecting(coat));
      if (c.type == ClosureType::kPrincipled && told != coat) {
        const float share = std::clamp(v.scalars[principled::kCoatWeight], 0.0f, 1.0f);
        at[kSheenFrame] = frameOf(normalize(told * (1 - share) + coat * share));
      }
    }
    const ViewCosines cosines{surface.cosine(at[kBaseFrame]), surface.cosine(at[kCoatFrame]),
                              surface.cosine(at[kSheenFrame]), surface.cosine(atDiffuse)};
    expand(c, v, cosines, point.turned, [&](Lobe& lobe) {
      lobe.frame = lobe.frame == kBaseFrame && isDiffuse(lobe.kind) ? atDiffuse : at[lobe.frame];
      surface.add(lobe);
    });
  }
  surface.finish(numbers);
  return frame;
}

#define WARDMIS_INSTANTIATE(K)                                                                                         \
  template Framef resolveLobes<K>(const Scene&, const Material&, const ShadedPoint&, Vec2f, Vec3f, const LobeNumbers&, \
                                  LobeSurface<K>&, Rgb&);
WARDMIS_TECHNIQUE_COUNTS(WARDMIS_INSTANTIATE)

}  // namespace wardmis::detail
