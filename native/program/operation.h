// SPDX-License-Identifier: GPL-3.0-or-later
// The operations of node programs: one table, from which the enumeration, the reader's checks and the interpreter's
// layout come. docs/scene-format.md, "Programs", says what each of them computes.
#pragma once

#include <array>
#include <cfloat>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace wardmis {

enum class ValueKind : uint8_t { kNumber, kVector };  // 1 float; 3 floats: a vector or a colour
constexpr int floatsOf(ValueKind kind) { return kind == ValueKind::kNumber ? 1 : 3; }

// How a parameter stands in an instruction's words:
enum class ParameterKind : uint8_t {
  kBoolean,  // 0 or 1
  kInteger,  // in low .. high
  kNumber,   // float in low .. high
  kChoice,   // index among `choices`
  kName,     // index into Program::attributes
  kTexture,  // two words: index into Program::textures, 0; or the first tile in Program::tiles, and how many
  kTable,    // two words: offset into Program::tables, rows of `columns` numbers
  kMatrix    // 12 numbers, row-major: offset into Program::tables
};
struct Parameter {
  std::string_view name;
  ParameterKind kind;
  float fallback = 0;  // a choice's index; kName: none is the empty name
  float low = -FLT_MAX, high = FLT_MAX;
  bool required = false;
  int columns = 0;
  std::array<std::string_view, 8> choices{};
};

// What of the place a program asks for beyond position, normals and the direction of view, for the integrator to fill.
enum Reads : uint32_t {
  kReadsNothing = 0,
  kReadsShift = 1 << 0,       // how quantities change over a pixel: where a `shift` is given, and by bump
  kReadsAttributes = 1 << 1,  // Program::attributes
  kReadsGenerated = 1 << 2,
  kReadsObject = 1 << 3,  // its matrix, colour, index ...
  kReadsCamera = 1 << 4,
  kReadsRay = 1 << 5  // kind, length, depths
};

namespace parameters {

using enum ParameterKind;
inline constexpr Parameter kShift{"shift", kChoice, 0, 0, 0, false, 0, {"none", "x", "y"}};
inline constexpr Parameter kWidth{"width", kNumber, 1, 0, 1000};
inline constexpr Parameter kVersionParameter{"version", kInteger, 5, 3, 5};
inline constexpr Parameter kAxis{"axis", kChoice, 2, 0, 0, false, 0, {"x", "y", "z"}};
inline constexpr Parameter kSet{"set", kName};
inline constexpr Parameter kAttributeName{"name", kName, 0, 0, 0, true};
inline constexpr Parameter kUnassociate{"unassociate", kBoolean};
inline constexpr Parameter kImageTexture{"texture", kTexture, 0, 0, 0, true};
inline constexpr std::array<std::string_view, 8> kSpaces{"world", "object", "camera"};

inline constexpr std::array<Parameter, 0> none{};
inline constexpr std::array shifted{kShift, kWidth};
inline constexpr std::array uv{kSet, kShift, kWidth};
inline constexpr std::array attribute{kAttributeName, kShift, kWidth};
inline constexpr std::array axis{kAxis};
inline constexpr std::array set{kSet};
inline constexpr std::array version{kVersionParameter};
inline constexpr std::array mix{Parameter{"clampFactor", kBoolean, 1}, Parameter{"clampResult", kBoolean, 0}};
inline constexpr std::array mixPlain{Parameter{"clampFactor", kBoolean, 1}};
inline constexpr std::array ramp{Parameter{"table", kTable, 0, 0, 0, true, 4}, Parameter{"interpolate", kBoolean, 1}};
inline constexpr std::array curves{Parameter{"table", kTable, 0, 0, 0, true, 3}, Parameter{"from", kNumber, 0},
                                   Parameter{"to", kNumber, 1}, Parameter{"extrapolate", kBoolean, 1}};
inline constexpr std::array curve{Parameter{"table", kTable, 0, 0, 0, true, 1}, Parameter{"from", kNumber, 0},
                                  Parameter{"to", kNumber, 1}, Parameter{"extrapolate", kBoolean, 1}};
inline constexpr std::array clamp{Parameter{"clamp", kBoolean, 0}};
inline constexpr std::array invert{Parameter{"invert", kBoolean, 0}};
inline constexpr std::array transform{
    Parameter{"type", kChoice, 0, 0, 0, true, 0, {"point", "vector", "normal"}},
    Parameter{"from", kChoice, 0, 0, 0, true, 0, kSpaces},
    Parameter{"to", kChoice, 0, 0, 0, true, 0, kSpaces},
    kVersionParameter,
};
inline constexpr std::array mapping{Parameter{"matrix", kMatrix, 0, 0, 0, true}};
inline constexpr std::array normalMapTangent{kSet, Parameter{"invertGreen", kBoolean}, kVersionParameter};
inline constexpr std::array normalMap{Parameter{"invertGreen", kBoolean}, Parameter{"flip", kBoolean},
                                      kVersionParameter};
inline constexpr std::array bump{kWidth, kVersionParameter};
inline constexpr std::array image{kImageTexture, kUnassociate,
                                  Parameter{"projection", kChoice, 0, 0, 0, false, 0, {"flat", "sphere", "tube"}}};
inline constexpr std::array imageBox{kImageTexture, kUnassociate, Parameter{"blend", kNumber, 0, 0, 1}};
inline constexpr std::array environment{
    kImageTexture, kUnassociate,
    Parameter{"projection", kChoice, 0, 0, 0, false, 0, {"equirectangular", "mirror-ball"}}};

// Of patterns: in the order of the settings' enumerators in native/pattern.
inline constexpr Parameter kDimensions{"dimensions", kInteger, 3, 1, 4};
inline constexpr Parameter kFractalType{
    "type", kChoice, 0, 0,
    0,      false,   0, {"fbm", "multifractal", "hybrid-multifractal", "ridged-multifractal", "hetero-terrain"}};
inline constexpr std::array noise{kDimensions, kFractalType, Parameter{"normalize", kBoolean, 1}, kVersionParameter};
inline constexpr std::array musgrave{kDimensions, kFractalType};
inline constexpr std::array voronoi{
    kDimensions,
    Parameter{"feature", kChoice, 0, 0, 0, false, 0, {"f1", "f2", "smooth-f1", "distance-to-edge", "n-sphere-radius"}},
    Parameter{"metric", kChoice, 0, 0, 0, false, 0, {"euclidean", "manhattan", "chebychev", "minkowski"}},
    Parameter{"normalize", kBoolean, 0},
    kVersionParameter,
};
inline constexpr std::array gabor{Parameter{"dimensions", kInteger, 2, 2, 3}};
inline constexpr std::array wave{
    Parameter{"shape", kChoice, 0, 0, 0, false, 0, {"bands", "rings"}},
    Parameter{"axis", kChoice, 0, 0, 0, false, 0, {"x", "y", "z", "all"}},
    Parameter{"profile", kChoice, 0, 0, 0, false, 0, {"sine", "saw", "triangle"}},
    kVersionParameter,
};
inline constexpr std::array magic{Parameter{"depth", kInteger, 2, 0, 10}, kVersionParameter};
inline constexpr std::array gradient{
    Parameter{"type",
              kChoice,
              0,
              0,
              0,
              false,
              0,
              {"linear", "quadratic", "easing", "diagonal", "spherical", "quadratic-sphere", "radial"}}};
inline constexpr std::array dimensions{kDimensions};
inline constexpr std::array brick{
    Parameter{"offset", kNumber, 0.5f},
    Parameter{"offsetFrequency", kInteger, 2, 0, 99},
    Parameter{"squash", kNumber, 1},
    Parameter{"squashFrequency", kInteger, 2, 0, 99},
    kVersionParameter,
};

}  // namespace parameters

// X(enumerator, name, kind of the result, arguments: n(umber) or v(ector), parameters, reads)
// clang-format off
#define WARDMIS_OPERATIONS(X) \
  /* the place */ \
  X(kPosition, "position", kVector, "", shifted, kReadsNothing) \
  X(kNormal, "normal", kVector, "", none, kReadsNothing) \
  X(kTrueNormal, "true-normal", kVector, "", none, kReadsNothing) \
  X(kObjectNormal, "object-normal", kVector, "", none, kReadsObject) \
  X(kIncoming, "incoming", kVector, "", none, kReadsNothing) \
  X(kDirection, "direction", kVector, "", none, kReadsNothing) \
  X(kReflection, "reflection", kVector, "", none, kReadsNothing) \
  X(kTangentRadial, "tangent", kVector, "", axis, kReadsGenerated | kReadsObject) \
  X(kTangentUv, "tangent-uv", kVector, "", set, kReadsAttributes | kReadsObject) \
  X(kUv, "uv", kVector, "", uv, kReadsAttributes) \
  X(kGenerated, "generated", kVector, "", shifted, kReadsGenerated | kReadsObject) \
  X(kObject, "object", kVector, "", shifted, kReadsObject) \
  X(kCamera, "camera", kVector, "", shifted, kReadsCamera) \
  X(kWindow, "window", kVector, "", shifted, kReadsCamera) \
  X(kParametric, "parametric", kVector, "", shifted, kReadsNothing) \
  X(kBackfacing, "backfacing", kNumber, "", none, kReadsNothing) \
  X(kAttribute, "attribute", kVector, "", attribute, kReadsAttributes) \
  X(kAttributeNumber, "attribute-number", kNumber, "", attribute, kReadsAttributes) \
  X(kAttributeAlpha, "attribute-alpha", kNumber, "", attribute, kReadsAttributes) \
  X(kObjectLocation, "object-location", kVector, "", none, kReadsObject) \
  X(kObjectColor, "object-color", kVector, "", none, kReadsObject) \
  X(kObjectAlpha, "object-alpha", kNumber, "", none, kReadsObject) \
  X(kObjectIndex, "object-index", kNumber, "", none, kReadsObject) \
  X(kObjectRandom, "object-random", kNumber, "", none, kReadsObject) \
  X(kMaterialIndex, "material-index", kNumber, "", none, kReadsNothing) \
  X(kViewVector, "view-vector", kVector, "", none, kReadsCamera) \
  X(kViewDepth, "view-depth", kNumber, "", none, kReadsCamera) \
  X(kViewDistance, "view-distance", kNumber, "", none, kReadsCamera) \
  X(kIsCameraRay, "is-camera-ray", kNumber, "", none, kReadsRay) \
  X(kIsShadowRay, "is-shadow-ray", kNumber, "", none, kReadsRay) \
  X(kIsDiffuseRay, "is-diffuse-ray", kNumber, "", none, kReadsRay) \
  X(kIsGlossyRay, "is-glossy-ray", kNumber, "", none, kReadsRay) \
  X(kIsSingularRay, "is-singular-ray", kNumber, "", none, kReadsRay) \
  X(kIsReflectionRay, "is-reflection-ray", kNumber, "", none, kReadsRay) \
  X(kIsTransmissionRay, "is-transmission-ray", kNumber, "", none, kReadsRay) \
  X(kRayLength, "ray-length", kNumber, "", none, kReadsRay) \
  X(kRayDepth, "ray-depth", kNumber, "", none, kReadsRay) \
  X(kDiffuseDepth, "diffuse-depth", kNumber, "", none, kReadsRay) \
  X(kGlossyDepth, "glossy-depth", kNumber, "", none, kReadsRay) \
  X(kTransparentDepth, "transparent-depth", kNumber, "", none, kReadsRay) \
  X(kTransmissionDepth, "transmission-depth", kNumber, "", none, kReadsRay) \
  /* conversions */ \
  X(kVectorOf, "vector", kVector, "n", none, kReadsNothing) \
  X(kLuminance, "luminance", kNumber, "v", version, kReadsNothing) \
  X(kMean, "mean", kNumber, "v", none, kReadsNothing) \
  X(kX, "x", kNumber, "v", none, kReadsNothing) \
  X(kY, "y", kNumber, "v", none, kReadsNothing) \
  X(kZ, "z", kNumber, "v", none, kReadsNothing) \
  X(kCombine, "combine", kVector, "nnn", none, kReadsNothing) \
  /* numbers */ \
  X(kAdd, "add", kNumber, "nn", none, kReadsNothing) \
  X(kSubtract, "subtract", kNumber, "nn", none, kReadsNothing) \
  X(kMultiply, "multiply", kNumber, "nn", none, kReadsNothing) \
  X(kDivide, "divide", kNumber, "nn", none, kReadsNothing) \
  X(kMultiplyAdd, "multiply-add", kNumber, "nnn", none, kReadsNothing) \
  X(kPower, "power", kNumber, "nn", none, kReadsNothing) \
  X(kLogarithm, "logarithm", kNumber, "nn", none, kReadsNothing) \
  X(kSqrt, "sqrt", kNumber, "n", none, kReadsNothing) \
  X(kInverseSqrt, "inverse-sqrt", kNumber, "n", none, kReadsNothing) \
  X(kAbsolute, "absolute", kNumber, "n", none, kReadsNothing) \
  X(kExponent, "exponent", kNumber, "n", none, kReadsNothing) \
  X(kMinimum, "minimum", kNumber, "nn", none, kReadsNothing) \
  X(kMaximum, "maximum", kNumber, "nn", none, kReadsNothing) \
  X(kLessThan, "less-than", kNumber, "nn", none, kReadsNothing) \
  X(kGreaterThan, "greater-than", kNumber, "nn", none, kReadsNothing) \
  X(kSign, "sign", kNumber, "n", none, kReadsNothing) \
  X(kCompare, "compare", kNumber, "nnn", none, kReadsNothing) \
  X(kSmoothMinimum, "smooth-minimum", kNumber, "nnn", none, kReadsNothing) \
  X(kSmoothMaximum, "smooth-maximum", kNumber, "nnn", none, kReadsNothing) \
  X(kRound, "round", kNumber, "n", none, kReadsNothing) \
  X(kFloor, "floor", kNumber, "n", none, kReadsNothing) \
  X(kCeil, "ceil", kNumber, "n", none, kReadsNothing) \
  X(kTruncate, "truncate", kNumber, "n", none, kReadsNothing) \
  X(kFraction, "fraction", kNumber, "n", none, kReadsNothing) \
  X(kModulo, "modulo", kNumber, "nn", none, kReadsNothing) \
  X(kFlooredModulo, "floored-modulo", kNumber, "nn", none, kReadsNothing) \
  X(kWrap, "wrap", kNumber, "nnn", none, kReadsNothing) \
  X(kSnap, "snap", kNumber, "nn", none, kReadsNothing) \
  X(kPingPong, "ping-pong", kNumber, "nn", none, kReadsNothing) \
  X(kSin, "sin", kNumber, "n", none, kReadsNothing) \
  X(kCos, "cos", kNumber, "n", none, kReadsNothing) \
  X(kTan, "tan", kNumber, "n", none, kReadsNothing) \
  X(kAsin, "asin", kNumber, "n", none, kReadsNothing) \
  X(kAcos, "acos", kNumber, "n", none, kReadsNothing) \
  X(kAtan, "atan", kNumber, "n", none, kReadsNothing) \
  X(kAtan2, "atan2", kNumber, "nn", none, kReadsNothing) \
  X(kSinh, "sinh", kNumber, "n", none, kReadsNothing) \
  X(kCosh, "cosh", kNumber, "n", none, kReadsNothing) \
  X(kTanh, "tanh", kNumber, "n", none, kReadsNothing) \
  X(kRadians, "radians", kNumber, "n", none, kReadsNothing) \
  X(kDegrees, "degrees", kNumber, "n", none, kReadsNothing) \
  X(kClamp, "clamp", kNumber, "nnn", none, kReadsNothing) \
  X(kClampRange, "clamp-range", kNumber, "nnn", none, kReadsNothing) \
  X(kMapRange, "map-range", kNumber, "nnnnn", clamp, kReadsNothing) \
  X(kMapRangeStepped, "map-range-stepped", kNumber, "nnnnnn", clamp, kReadsNothing) \
  X(kMapRangeSmoothstep, "map-range-smoothstep", kNumber, "nnnnn", clamp, kReadsNothing) \
  X(kMapRangeSmootherstep, "map-range-smootherstep", kNumber, "nnnnn", clamp, kReadsNothing) \
  X(kMixNumber, "mix-number", kNumber, "nnn", mixPlain, kReadsNothing) \
  X(kCurve, "curve", kNumber, "nn", curve, kReadsNothing) \
  /* vectors */ \
  X(kVectorAdd, "vector-add", kVector, "vv", none, kReadsNothing) \
  X(kVectorSubtract, "vector-subtract", kVector, "vv", none, kReadsNothing) \
  X(kVectorMultiply, "vector-multiply", kVector, "vv", none, kReadsNothing) \
  X(kVectorDivide, "vector-divide", kVector, "vv", none, kReadsNothing) \
  X(kVectorMultiplyAdd, "vector-multiply-add", kVector, "vvv", none, kReadsNothing) \
  X(kVectorCross, "vector-cross", kVector, "vv", none, kReadsNothing) \
  X(kVectorProject, "vector-project", kVector, "vv", none, kReadsNothing) \
  X(kVectorReflect, "vector-reflect", kVector, "vv", none, kReadsNothing) \
  X(kVectorRefract, "vector-refract", kVector, "vvn", none, kReadsNothing) \
  X(kVectorFaceforward, "vector-faceforward", kVector, "vvv", none, kReadsNothing) \
  X(kVectorDot, "vector-dot", kNumber, "vv", none, kReadsNothing) \
  X(kVectorDistance, "vector-distance", kNumber, "vv", none, kReadsNothing) \
  X(kVectorLength, "vector-length", kNumber, "v", none, kReadsNothing) \
  X(kVectorScale, "vector-scale", kVector, "vn", none, kReadsNothing) \
  X(kVectorNormalize, "vector-normalize", kVector, "v", none, kReadsNothing) \
  X(kVectorSnap, "vector-snap", kVector, "vv", none, kReadsNothing) \
  X(kVectorRound, "vector-round", kVector, "v", none, kReadsNothing) \
  X(kVectorFloor, "vector-floor", kVector, "v", none, kReadsNothing) \
  X(kVectorCeil, "vector-ceil", kVector, "v", none, kReadsNothing) \
  X(kVectorFraction, "vector-fraction", kVector, "v", none, kReadsNothing) \
  X(kVectorModulo, "vector-modulo", kVector, "vv", none, kReadsNothing) \
  X(kVectorWrap, "vector-wrap", kVector, "vvv", none, kReadsNothing) \
  X(kVectorAbsolute, "vector-absolute", kVector, "v", none, kReadsNothing) \
  X(kVectorPower, "vector-power", kVector, "vv", none, kReadsNothing) \
  X(kVectorSign, "vector-sign", kVector, "v", none, kReadsNothing) \
  X(kVectorMinimum, "vector-minimum", kVector, "vv", none, kReadsNothing) \
  X(kVectorMaximum, "vector-maximum", kVector, "vv", none, kReadsNothing) \
  X(kVectorSin, "vector-sin", kVector, "v", none, kReadsNothing) \
  X(kVectorCos, "vector-cos", kVector, "v", none, kReadsNothing) \
  X(kVectorTan, "vector-tan", kVector, "v", none, kReadsNothing) \
  X(kVectorMapRange, "vector-map-range", kVector, "vvvvv", clamp, kReadsNothing) \
  X(kVectorMapRangeStepped, "vector-map-range-stepped", kVector, "vvvvvv", clamp, kReadsNothing) \
  X(kVectorMapRangeSmoothstep, "vector-map-range-smoothstep", kVector, "vvvvv", clamp, kReadsNothing) \
  X(kVectorMapRangeSmootherstep, "vector-map-range-smootherstep", kVector, "vvvvv", clamp, kReadsNothing) \
  X(kMixVector, "mix-vector", kVector, "nvv", mixPlain, kReadsNothing) \
  X(kMixVectorEach, "mix-vector-each", kVector, "vvv", mixPlain, kReadsNothing) \
  X(kVectorRotateAxis, "vector-rotate-axis", kVector, "vvvn", invert, kReadsNothing) \
  X(kVectorRotateEuler, "vector-rotate-euler", kVector, "vvv", invert, kReadsNothing) \
  X(kVectorTransform, "vector-transform", kVector, "v", transform, kReadsObject | kReadsCamera) \
  X(kMapping, "mapping", kVector, "v", mapping, kReadsNothing) \
  X(kMappingPoint, "mapping-point", kVector, "vvvv", none, kReadsNothing) \
  X(kMappingTexture, "mapping-texture", kVector, "vvvv", none, kReadsNothing) \
  X(kMappingVector, "mapping-vector", kVector, "vvv", none, kReadsNothing) \
  X(kMappingNormal, "mapping-normal", kVector, "vvv", none, kReadsNothing) \
  X(kNormalMapTangent, "normal-map-tangent", kVector, "vn", normalMapTangent, kReadsAttributes | kReadsObject) \
  X(kNormalMapObject, "normal-map-object", kVector, "vn", normalMap, kReadsObject) \
  X(kNormalMapWorld, "normal-map-world", kVector, "vn", normalMap, kReadsNothing) \
  X(kBump, "bump", kVector, "nnnnnv", bump, kReadsShift) \
  X(kVectorDisplacement, "vector-displacement", kVector, "v", set, kReadsAttributes | kReadsObject) \
  X(kBend, "bend", kVector, "v", none, kReadsNothing) \
  X(kBelowLayers, "below-layers", kVector, "nnnvnnvvv", version, kReadsNothing) \
  /* colours */ \
  X(kMix, "mix", kVector, "nvv", mix, kReadsNothing) \
  X(kMixAdd, "mix-add", kVector, "nvv", mix, kReadsNothing) \
  X(kMixMultiply, "mix-multiply", kVector, "nvv", mix, kReadsNothing) \
  X(kMixScreen, "mix-screen", kVector, "nvv", mix, kReadsNothing) \
  X(kMixOverlay, "mix-overlay", kVector, "nvv", mix, kReadsNothing) \
  X(kMixSubtract, "mix-subtract", kVector, "nvv", mix, kReadsNothing) \
  X(kMixDivide, "mix-divide", kVector, "nvv", mix, kReadsNothing) \
  X(kMixDifference, "mix-difference", kVector, "nvv", mix, kReadsNothing) \
  X(kMixExclusion, "mix-exclusion", kVector, "nvv", mix, kReadsNothing) \
  X(kMixDarken, "mix-darken", kVector, "nvv", mix, kReadsNothing) \
  X(kMixLighten, "mix-lighten", kVector, "nvv", mix, kReadsNothing) \
  X(kMixDodge, "mix-dodge", kVector, "nvv", mix, kReadsNothing) \
  X(kMixBurn, "mix-burn", kVector, "nvv", mix, kReadsNothing) \
  X(kMixHue, "mix-hue", kVector, "nvv", mix, kReadsNothing) \
  X(kMixSaturation, "mix-saturation", kVector, "nvv", mix, kReadsNothing) \
  X(kMixValue, "mix-value", kVector, "nvv", mix, kReadsNothing) \
  X(kMixColor, "mix-color", kVector, "nvv", mix, kReadsNothing) \
  X(kMixSoftLight, "mix-soft-light", kVector, "nvv", mix, kReadsNothing) \
  X(kMixLinearLight, "mix-linear-light", kVector, "nvv", mix, kReadsNothing) \
  X(kHueSaturation, "hue-saturation", kVector, "nnnnv", version, kReadsNothing) \
  X(kBrightContrast, "bright-contrast", kVector, "vnn", none, kReadsNothing) \
  X(kGamma, "gamma", kVector, "vn", none, kReadsNothing) \
  X(kInvert, "invert", kVector, "nv", none, kReadsNothing) \
  X(kRgbToHsv, "rgb-to-hsv", kVector, "v", none, kReadsNothing) \
  X(kHsvToRgb, "hsv-to-rgb", kVector, "v", none, kReadsNothing) \
  X(kRgbToHsl, "rgb-to-hsl", kVector, "v", none, kReadsNothing) \
  X(kHslToRgb, "hsl-to-rgb", kVector, "v", none, kReadsNothing) \
  X(kRamp, "ramp", kVector, "n", ramp, kReadsNothing) \
  X(kRampAlpha, "ramp-alpha", kNumber, "n", ramp, kReadsNothing) \
  X(kCurves, "curves", kVector, "nv", curves, kReadsNothing) \
  X(kBlackbody, "blackbody", kVector, "n", version, kReadsNothing) \
  X(kWavelength, "wavelength", kVector, "n", version, kReadsNothing) \
  /* of the view and the light */ \
  X(kFresnel, "fresnel", kNumber, "nv", none, kReadsNothing) \
  X(kLayerWeightFresnel, "layer-weight-fresnel", kNumber, "nv", none, kReadsNothing) \
  X(kLayerWeightFacing, "layer-weight-facing", kNumber, "nv", none, kReadsNothing) \
  X(kLightFalloffQuadratic, "light-falloff-quadratic", kNumber, "nn", version, kReadsRay) \
  X(kLightFalloffLinear, "light-falloff-linear", kNumber, "nn", version, kReadsRay) \
  X(kLightFalloffConstant, "light-falloff-constant", kNumber, "nn", version, kReadsRay) \
  /* images */ \
  X(kImage, "image", kVector, "v", image, kReadsNothing) \
  X(kImageAlpha, "image-alpha", kNumber, "v", image, kReadsNothing) \
  X(kImageBox, "image-box", kVector, "vv", imageBox, kReadsNothing) \
  X(kImageBoxAlpha, "image-box-alpha", kNumber, "vv", imageBox, kReadsNothing) \
  X(kEnvironment, "environment", kVector, "v", environment, kReadsNothing) \
  X(kEnvironmentAlpha, "environment-alpha", kNumber, "v", environment, kReadsNothing) \
  /* patterns: kNoise is the first, and nothing else comes after it */ \
  X(kNoise, "noise", kNumber, "vnnnnnnnn", noise, kReadsNothing) \
  X(kNoiseColor, "noise-color", kVector, "vnnnnnnnn", noise, kReadsNothing) \
  X(kMusgrave, "musgrave", kNumber, "vnnnnnnn", musgrave, kReadsNothing) \
  X(kVoronoiDistance, "voronoi-distance", kNumber, "vnnnnnnnn", voronoi, kReadsNothing) \
  X(kVoronoiColor, "voronoi-color", kVector, "vnnnnnnnn", voronoi, kReadsNothing) \
  X(kVoronoiPosition, "voronoi-position", kVector, "vnnnnnnnn", voronoi, kReadsNothing) \
  X(kVoronoiW, "voronoi-w", kNumber, "vnnnnnnnn", voronoi, kReadsNothing) \
  X(kVoronoiRadius, "voronoi-radius", kNumber, "vnnnnnnnn", voronoi, kReadsNothing) \
  X(kGaborValue, "gabor-value", kNumber, "vnnnnv", gabor, kReadsNothing) \
  X(kGaborPhase, "gabor-phase", kNumber, "vnnnnv", gabor, kReadsNothing) \
  X(kGaborIntensity, "gabor-intensity", kNumber, "vnnnnv", gabor, kReadsNothing) \
  X(kWave, "wave", kNumber, "vnnnnnn", wave, kReadsNothing) \
  X(kMagic, "magic", kVector, "vnn", magic, kReadsNothing) \
  X(kChecker, "checker", kNumber, "vn", none, kReadsNothing) \
  X(kGradient, "gradient", kNumber, "v", gradient, kReadsNothing) \
  X(kWhiteNoise, "white-noise", kNumber, "vn", dimensions, kReadsNothing) \
  X(kWhiteNoiseColor, "white-noise-color", kVector, "vn", dimensions, kReadsNothing) \
  X(kBrick, "brick", kVector, "vvvvnnnnnn", brick, kReadsNothing) \
  X(kBrickFactor, "brick-factor", kNumber, "vnnnnnn", brick, kReadsNothing)
// clang-format on

enum class Operation : uint16_t {
#define WARDMIS_ENUMERATOR(id, name, result, arguments, parameters, reads) id,
  WARDMIS_OPERATIONS(WARDMIS_ENUMERATOR)
#undef WARDMIS_ENUMERATOR
};

struct OperationInfo {
  std::string_view name;
  ValueKind result;
  std::string_view arguments;  // one letter each: n, v
  std::span<const Parameter> parameters;
  uint32_t reads;
};

inline constexpr OperationInfo kOperations[] = {
#define WARDMIS_ROW(id, name, result, arguments, list, reads) \
  {name, ValueKind::result, arguments, parameters::list, reads},
    WARDMIS_OPERATIONS(WARDMIS_ROW)
#undef WARDMIS_ROW
};
inline constexpr size_t kOperationCount = std::size(kOperations);

constexpr const OperationInfo& info(Operation operation) { return kOperations[static_cast<size_t>(operation)]; }
constexpr ValueKind argumentKind(const OperationInfo& info, size_t i) {
  return info.arguments[i] == 'n' ? ValueKind::kNumber : ValueKind::kVector;
}

}  // namespace wardmis
