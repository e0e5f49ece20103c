// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/run.h"

#include "math/rec709.h"
#include "program/layers.h"
#include "program/operands.h"
#include "program/patterns.h"
#include "program/place.h"
#include "program/spectrum.h"
#include "program/surface.h"

namespace wardmis {

void run(const Program& program, ShadingContext& c, const TextureAccess& textures, Slots& slots) {
  using namespace arithmetic;
  using enum Operation;
  for (const Instruction& i : program.instructions) {
    const Operands o{{slots.data(), program.literals.data()},
                     program.arguments.data() + i.arguments,
                     program.parameters.data() + i.parameters,
                     slots.data() + i.result,
                     program};
    switch (i.operation) {
      case kVectorOf:
        o.set(Vec3f{o.n(0), o.n(0), o.n(0)});
        break;
      case kLuminance:
        o.set(rec709::luminance(o.v(0), o.word(0)));
        break;
      case kMean:
        o.set((o.v(0).x + o.v(0).y + o.v(0).z) * (1 / 3.0f));
        break;
      case kX:
        o.set(o.v(0).x);
        break;
      case kY:
        o.set(o.v(0).y);
        break;
      case kZ:
        o.set(o.v(0).z);
        break;
      case kCombine:
        o.set(Vec3f{o.n(0), o.n(1), o.n(2)});
        break;
      case kAdd:
        o.set(o.n(0) + o.n(1));
        break;
      case kSubtract:
        o.set(o.n(0) - o.n(1));
        break;
      case kMultiply:
        o.set(o.n(0) * o.n(1));
        break;
      case kDivide:
        o.set(divide(o.n(0), o.n(1)));
        break;
      case kMultiplyAdd:
        o.set(o.n(0) * o.n(1) + o.n(2));
        break;
      case kPower:
        o.set(power(o.n(0), o.n(1)));
        break;
      case kLogarithm:
        o.set(logarithm(o.n(0), o.n(1)));
        break;
      case kSqrt:
        o.set(squareRoot(o.n(0)));
        break;
      case kInverseSqrt:
        o.set(inverseSquareRoot(o.n(0)));
        break;
      case kAbsolute:
        o.set(std::abs(o.n(0)));
        break;
      case kExponent:
        o.set(std::exp(o.n(0)));
        break;
      case kMinimum:
        o.set(std::fmin(o.n(0), o.n(1)));
        break;
      case kMaximum:
        o.set(std::fmax(o.n(0), o.n(1)));
        break;
      case kLessThan:
        o.set(o.n(0) < o.n(1) ? 1.0f : 0.0f);
        break;
      case kGreaterThan:
        o.set(o.n(0) > o.n(1) ? 1.0f : 0.0f);
        break;
      case kSign:
        o.set(sign(o.n(0)));
        break;
      case kCompare:
        o.set(compare(o.n(0), o.n(1), o.n(2)));
        break;
      case kSmoothMinimum:
        o.set(smoothMinimum(o.n(0), o.n(1), o.n(2)));
        break;
      case kSmoothMaximum:
        o.set(-smoothMinimum(-o.n(0), -o.n(1), o.n(2)));
        break;
      case kRound:
        o.set(std::floor(o.n(0) + 0.5f));
        break;
      case kFloor:
        o.set(std::floor(o.n(0)));
        break;
      case kCeil:
        o.set(std::ceil(o.n(0)));
        break;
      case kTruncate:
        o.set(truncate(o.n(0)));
        break;
      case kFraction:
        o.set(fraction(o.n(0)));
        break;
      case kModulo:
        o.set(modulo(o.n(0), o.n(1)));
        break;
      case kFlooredModulo:
        o.set(flooredModulo(o.n(0), o.n(1)));
        break;
      case kWrap:
        o.set(wrap(o.n(0), o.n(1), o.n(2)));
        break;
      case kSnap:
        o.set(snap(o.n(0), o.n(1)));
        break;
      case kPingPong:
        o.set(pingPong(o.n(0), o.n(1)));
        break;
      case kSin:
        o.set(std::sin(o.n(0)));
        break;
      case kCos:
        o.set(std::cos(o.n(0)));
        break;
      case kTan:
        o.set(std::tan(o.n(0)));
        break;
      case kAtan:
        o.set(std::atan(o.n(0)));
        break;
      case kSinh:
        o.set(std::sinh(o.n(0)));
        break;
      case kCosh:
        o.set(std::cosh(o.n(0)));
        break;
      case kTanh:
        o.set(std::tanh(o.n(0)));
        break;
      case kAsin:
        o.set(arcSine(o.n(0)));
        break;
      case kAcos:
        o.set(arcCosine(o.n(0)));
        break;
      case kAtan2:
        o.set(arcTangent2(o.n(0), o.n(1)));
        break;
      case kRadians:
        o.set(o.n(0) * (kPi<float> / 180));
        break;
      case kDegrees:
        o.set(o.n(0) * (180 / kPi<float>));
        break;
      case kClamp:
        o.set(clamp(o.n(0), o.n(1), o.n(2)));
        break;
      case kClampRange:
        o.set(clampRange(o.n(0), o.n(1), o.n(2)));
        break;
      case kMapRange:
        o.set(o.mapRange<Steps::kLinear>(0));
        break;
      case kMapRangeStepped:
        o.set(o.mapRange<Steps::kStepped>(o.n(5)));
        break;
      case kMapRangeSmoothstep:
        o.set(o.mapRange<Steps::kSmooth>(0));
        break;
      case kMapRangeSmootherstep:
        o.set(o.mapRange<Steps::kSmoother>(0));
        break;
      case kMixNumber:
        o.set(o.n(1) * (1 - o.factor(o.flag(0))) + o.n(2) * o.factor(o.flag(0)));
        break;
      case kCurve:
        o.set(o.curve(o.n(1), 0, 1));
        break;
      case kVectorAdd:
        o.set(o.v(0) + o.v(1));
        break;
      case kVectorSubtract:
        o.set(o.v(0) - o.v(1));
        break;
      case kVectorMultiply:
        o.set(o.v(0) * o.v(1));
        break;
      case kVectorDivide:
        o.set(each(divide, o.v(0), o.v(1)));
        break;
      case kVectorMultiplyAdd:
        o.set(o.v(0) * o.v(1) + o.v(2));
        break;
      case kVectorCross:
        o.set(cross(o.v(0), o.v(1)));
        break;
      case kVectorProject:
        o.set(vectors::project(o.v(0), o.v(1)));
        break;
      case kVectorReflect:
        o.set(vectors::reflect(o.v(0), o.v(1)));
        break;
      case kVectorRefract:
        o.set(vectors::refract(o.v(0), o.v(1), o.n(2)));
        break;
      case kVectorFaceforward:
        o.set(dot(o.v(2), o.v(1)) < 0 ? o.v(0) : -o.v(0));
        break;
      case kVectorDot:
        o.set(dot(o.v(0), o.v(1)));
        break;
      case kVectorDistance:
        o.set(length(o.v(0) - o.v(1)));
        break;
      case kVectorLength:
        o.set(length(o.v(0)));
        break;
      case kVectorScale:
        o.set(o.v(0) * o.n(1));
        break;
      case kVectorNormalize:
        o.set(safeNormalize(o.v(0)));
        break;
      case kVectorSnap:
        o.set(each(snap, o.v(0), o.v(1)));
        break;
      case kVectorRound:
        o.set(each([](float v) { return std::floor(v + 0.5f); }, o.v(0)));
        break;
      case kVectorFloor:
        o.set(each([](float v) { return std::floor(v); }, o.v(0)));
        break;
      case kVectorCeil:
        o.set(each([](float v) { return std::ceil(v); }, o.v(0)));
        break;
      case kVectorFraction:
        o.set(each(fraction, o.v(0)));
        break;
      case kVectorAbsolute:
        o.set(each([](float v) { return std::abs(v); }, o.v(0)));
        break;
      case kVectorSign:
        o.set(each(sign, o.v(0)));
        break;
      case kVectorSin:
        o.set(each([](float v) { return std::sin(v); }, o.v(0)));
        break;
      case kVectorCos:
        o.set(each([](float v) { return std::cos(v); }, o.v(0)));
        break;
      case kVectorTan:
        o.set(each([](float v) { return std::tan(v); }, o.v(0)));
        break;
      case kVectorModulo:
        o.set(each(modulo, o.v(0), o.v(1)));
        break;
      case kVectorWrap:
        o.set(each(wrap, o.v(0), o.v(1), o.v(2)));
        break;
      case kVectorPower:
        o.set(each(power, o.v(0), o.v(1)));
        break;
      case kVectorMinimum:
        o.set(each([](float a, float b) { return std::min(a, b); }, o.v(0), o.v(1)));
        break;
      case kVectorMaximum:
        o.set(each([](float a, float b) { return std::max(a, b); }, o.v(0), o.v(1)));
        break;
      case kVectorMapRange:
        o.set(o.mapRangeOfVector<Steps::kLinear>({}));
        break;
      case kVectorMapRangeStepped:
        o.set(o.mapRangeOfVector<Steps::kStepped>(o.v(5)));
        break;
      case kVectorMapRangeSmoothstep:
        o.set(o.mapRangeOfVector<Steps::kSmooth>({}));
        break;
      case kVectorMapRangeSmootherstep:
        o.set(o.mapRangeOfVector<Steps::kSmoother>({}));
        break;
      case kMixVector:
        o.set(o.v(1) * (1 - o.factor(o.flag(0))) + o.v(2) * o.factor(o.flag(0)));
        break;
      case kMixVectorEach:
        o.set(o.mixEach());
        break;
      case kVectorRotateAxis:
        o.set(vectors::rotate(o.v(0), o.v(1), o.v(2), o.flag(0) ? -o.n(3) : o.n(3)));
        break;
      case kVectorRotateEuler:
        o.set(vectors::rotateEuler(o.v(0), o.v(1), o.v(2), o.flag(0)));
        break;
      case kVectorTransform:
        o.set(surface::transform(c, static_cast<surface::VectorType>(o.word(0)), static_cast<surface::Space>(o.word(1)),
                                 static_cast<surface::Space>(o.word(2)), o.v(0), o.word(3)));
        break;
      case kMapping:
        o.set(vectors::map(o.table(0), o.v(0)));
        break;
      case kMappingPoint:
        o.set(vectors::euler(o.v(2)).vector(o.v(0) * o.v(3)) + o.v(1));
        break;
      case kMappingTexture:
        o.set(vectors::mapTexture(o.v(0), o.v(1), o.v(2), o.v(3)));
        break;
      case kMappingVector:
        o.set(vectors::euler(o.v(1)).vector(o.v(0) * o.v(2)));
        break;
      case kMappingNormal:
        o.set(safeNormalize(vectors::euler(o.v(1)).vector(each(divide, o.v(0), o.v(2)))));
        break;
      case kNormalMapTangent:
        o.set(surface::normalMapTangent(c, c.attributes[o.word(0)], o.v(0), o.n(1), o.flag(1), o.word(2)));
        break;
      case kNormalMapObject:
        o.set(surface::normalMapFixed(c, true, o.v(0), o.n(1), o.flag(0), o.flag(1)));
        break;
      case kNormalMapWorld:
        o.set(surface::normalMapFixed(c, false, o.v(0), o.n(1), o.flag(0), o.flag(1)));
        break;
      case kBump:
        o.set(surface::bump(c, o.n(0), o.n(1), o.n(2), o.n(3), o.n(4), o.v(5), o.number(0), o.word(1)));
        break;
      case kVectorDisplacement:
        o.set(surface::vectorDisplacement(c, c.attributes[o.word(0)], o.v(0)));
        break;
      case kBend:
        c.normal = surface::bent(c, o.v(0));
        o.set(c.normal);
        break;
      case kBelowLayers: {
        Principled p;
        p.version = static_cast<int>(o.word(0));
        p.coatWeight = o.n(0), p.coatRoughness = o.n(1), p.coatIor = o.n(2), p.coatTint = o.v(3);
        p.sheenWeight = o.n(4), p.sheenRoughness = o.n(5), p.sheenTint = o.v(6);
        o.set(belowLayers(c, p, o.v(7), o.v(8)));
        break;
      }
      case kMix:
        o.set(o.blendEach([](float t, float a, float b) { return a + t * (b - a); }));
        break;
      case kMixAdd:
        o.set(o.blendEach([](float t, float a, float b) { return a + t * ((a + b) - a); }));
        break;
      case kMixMultiply:
        o.set(o.blendEach([](float t, float a, float b) { return a + t * (a * b - a); }));
        break;
      case kMixScreen:
        o.set(o.blendEach([](float t, float a, float b) { return 1 - (1 - t + t * (1 - b)) * (1 - a); }));
        break;
      case kMixOverlay:
        o.set(o.blendEach(color::overlay));
        break;
      case kMixSubtract:
        o.set(o.blendEach([](float t, float a, float b) { return a + t * ((a - b) - a); }));
        break;
      case kMixDivide:
        o.set(o.blendEach([](float t, float a, float b) { return b != 0 ? (1 - t) * a + t * a / b : a; }));
        break;
      case kMixDifference:
        o.set(o.blendEach([](float t, float a, float b) { return a + t * (std::abs(a - b) - a); }));
        break;
      case kMixExclusion:
        o.set(o.blendEach([](float t, float a, float b) { return std::max(a + t * (b - 2 * a * b), 0.0f); }));
        break;
      case kMixDarken:
        o.set(o.blendEach([](float t, float a, float b) { return a + t * (std::min(a, b) - a); }));
        break;
      case kMixLighten:
        o.set(o.blendEach([](float t, float a, float b) { return a + t * (std::max(a, b) - a); }));
        break;
      case kMixDodge:
        o.set(o.blendEach(color::dodge));
        break;
      case kMixBurn:
        o.set(o.blendEach(color::burn));
        break;
      case kMixHue:
        o.set(o.blend([](float t, Rgb a, Rgb b) { return color::withHue(t, a, b, false); }));
        break;
      case kMixSaturation:
        o.set(o.blend(color::withSaturation));
        break;
      case kMixValue:
        o.set(o.blend(color::withValue));
        break;
      case kMixColor:
        o.set(o.blend([](float t, Rgb a, Rgb b) { return color::withHue(t, a, b, true); }));
        break;
      case kMixSoftLight:
        o.set(o.blendEach(color::softLight));
        break;
      case kMixLinearLight:
        o.set(o.blendEach([](float t, float a, float b) { return a + t * (2 * b - 1); }));
        break;
      case kHueSaturation:
        o.set(color::hueSaturation(o.n(0), o.n(1), o.n(2), o.n(3), o.v(4), o.word(0)));
        break;
      case kBrightContrast:
        o.set(color::brightContrast(o.v(0), o.n(1), o.n(2)));
        break;
      case kGamma:
        o.set(color::gamma(o.v(0), o.n(1)));
        break;
      case kInvert:
        o.set(color::invert(o.n(0), o.v(1)));
        break;
      case kRgbToHsv:
        o.set(color::toHsv(o.v(0)));
        break;
      case kHsvToRgb:
        o.set(color::fromHsv(o.v(0)));
        break;
      case kRgbToHsl:
        o.set(color::toHsl(o.v(0)));
        break;
      case kHslToRgb:
        o.set(color::fromHsl(o.v(0)));
        break;
      case kRamp:
        o.set(Vec3f{o.ramp(0), o.ramp(1), o.ramp(2)});
        break;
      case kRampAlpha:
        o.set(o.ramp(3));
        break;
      case kCurves:
        o.set(Vec3f{o.curve(o.v(1).x, 0, 3), o.curve(o.v(1).y, 1, 3), o.curve(o.v(1).z, 2, 3)});
        break;
      case kBlackbody:
        o.set(spectrum::blackbody(o.n(0), o.word(0)));
        break;
      case kWavelength:
        o.set(spectrum::wavelength(o.n(0), o.word(0)));
        break;
      case kFresnel:
        o.set(surface::fresnelNode(c, o.n(0), o.v(1)));
        break;
      case kLayerWeightFresnel:
        o.set(surface::layerFresnel(c, o.n(0), o.v(1)));
        break;
      case kLayerWeightFacing:
        o.set(surface::layerFacing(c, o.n(0), o.v(1)));
        break;
      case kLightFalloffQuadratic:
        o.set(surface::lightFalloff(surface::Falloff::kQuadratic, o.n(0), o.n(1), c.rayLength, o.word(0)));
        break;
      case kLightFalloffLinear:
        o.set(surface::lightFalloff(surface::Falloff::kLinear, o.n(0), o.n(1), c.rayLength, o.word(0)));
        break;
      case kLightFalloffConstant:
        o.set(surface::lightFalloff(surface::Falloff::kConstant, o.n(0), o.n(1), c.rayLength, o.word(0)));
        break;
      case kImage:
        o.set(o.image().at(textures, images::projected(o.v(0), o.word(3))).color);
        break;
      case kImageAlpha:
        o.set(o.image().at(textures, images::projected(o.v(0), o.word(3))).alpha);
        break;
      case kImageBox:
        o.set(images::box(textures, o.image(), o.v(0), o.v(1), o.number(3)).color);
        break;
      case kImageBoxAlpha:
        o.set(images::box(textures, o.image(), o.v(0), o.v(1), o.number(3)).alpha);
        break;
      case kEnvironment:
        o.set(o.image().at(textures, images::environmentPoint(o.v(0), o.word(3))).color);
        break;
      case kEnvironmentAlpha:
        o.set(o.image().at(textures, images::environmentPoint(o.v(0), o.word(3))).alpha);
        break;
      default:
        if (i.operation < kNoise)
          place::read(i.operation, o, c);
        else
          patterns::run(i.operation, o);
    }
  }
}

}  // namespace wardmis
