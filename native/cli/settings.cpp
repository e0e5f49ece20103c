// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/options.h"
#include "gltf/reader.h"

namespace wardmis {
namespace {

constexpr std::array kAllocations{Allocation::kEqual,
                                  Allocation::kVariance,
                                  Allocation::kStandardDeviation,
                                  Allocation::kSecondMoment,
                                  Allocation::kInverseVariance,
                                  Allocation::kEqualised,
                                  Allocation::kRepresentativity,
                                  Allocation::kAlbedo,
                                  Allocation::kAuto};
constexpr std::array kPixelSamples{PixelSamples::kEven, PixelSamples::kByError, PixelSamples::kAuto};
constexpr std::array kWeights{Weights::kBalance, Weights::kNonbalance, Weights::kPower,
                              Weights::kCutoff,  Weights::kMaximum,    Weights::kVarianceAware};
constexpr std::array kIntegrands{Integrand::kSplit, Integrand::kJoint};
constexpr std::array kIntegrators{Integrator::kDirect, Integrator::kPath, Integrator::kBidirectional};
constexpr std::array kSamplers{SamplerType::kIndependent, SamplerType::kStratified, SamplerType::kSobol};

GivenCost costOf(const std::string& text) {
  GivenCost cost;
  float* const each[] = {&cost.lobe, &cost.cosine, &cost.light};
  const std::vector<std::string> parts = CLI::detail::split(text, ',');
  bool good = parts.size() == std::size(each);
  for (size_t i = 0; good && i < parts.size(); ++i)
    good = CLI::detail::lexical_cast(parts[i], *each[i]) && *each[i] >= 1e-3f && *each[i] <= 1e6f;
  if (!good)
    throw Error(ExitCode::kUsage, fmt::format("--cost '{}'", text),
                "give three numbers from 0.001 to 1e6, as in --cost 1,1,2, or 'rays' or 'measured'");
  return cost;
}

}  // namespace

void SettingOptions::add(CLI::App& app) {
  app.add_option("--allocation", allocation_, "how the samples of a hit are shared")
      ->check(among(kAllocations))
      ->default_str(std::string(name(RenderSettings{}.allocation)));
  app.add_option(
         "--pixels", pixels_,
         "how camera samples are shared between pixels: as many for each; by-error: more where they take more "
         "from the image's relative error, in the time of as many for each; auto: the latter with --allocation auto")
      ->check(among(kPixelSamples))
      ->capture_default_str();
  app.add_option("--weights", weights_, "MIS weights; auto: what the paper pairs with the allocation")
      ->check(among(kWeights, {"auto"}))
      ->capture_default_str();
  app.add_option("--integrand", integrand_, "specular and diffuse as separate integrals or as one")
      ->check(among(kIntegrands))
      ->capture_default_str();
  app.add_option(
         "--integrator", integrator_,
         "direct light only; all of it, by paths from the camera; or bidirectional: by paths from the lights, too")
      ->check(among(kIntegrators))
      ->capture_default_str();
  app.add_option("--light-paths", numbers_.fromLights.paths,
                 "of a bidirectional render: paths from the lights for each camera sample of a pixel")
      ->check(between(0, 64))
      ->capture_default_str();
  app.add_option("--connections", numbers_.fromLights.connections,
                 "with their vertices, of the first vertex of a path from the camera; 0: none")
      ->check(CLI::Range(0, 64))
      ->capture_default_str();
  app.add_option("--later-connections", numbers_.fromLights.laterConnections, "of each later vertex")
      ->check(CLI::Range(0, 64))
      ->capture_default_str();
  app.add_option("--light-tracing", numbers_.fromLights.film, "whether they are traced to the film, too")
      ->capture_default_str();
  app.add_option("--sampler", sampler_, "where the random numbers come from")
      ->check(among(kSamplers))
      ->capture_default_str();
  app.add_option("--samples-per-hit", numbers_.samplesPerHit, "samples shared at the first hit")
      ->check(CLI::Range(1, kMaxSamplesPerHit))
      ->capture_default_str();
  app.add_option(
         "--pilot-spp", numbers_.pilotSpp,
         "camera samples per pixel that estimate the moments; of auto per 2 x 2 pixels, beside the image's: more "
         "beyond 64 samples, at most a 16th of them, so that below 16 its counts are equal")
      ->check(CLI::Range(0u, 1u << 20))
      ->capture_default_str();
  app.add_option("--min-fraction", numbers_.minFraction, "no technique gets less than this share; not for auto")
      ->check(between(0.001, 0.5))
      ->capture_default_str();
  app.add_option("--cost", cost_,
                 "of a lobe, cosine and light sample, for --allocation auto: 'rays', as counted in the pilot; three "
                 "numbers; or 'measured' (the image then depends on the machine)")
      ->capture_default_str();
  app.add_option("--max-depth", numbers_.maxDepth, "surface hits of a path; 1 is direct light")
      ->check(CLI::Range(1, kLongestPath))
      ->capture_default_str();
  app.add_option("--max-diffuse", numbers_.maxDiffuse, "diffuse bounces of a path, as Cycles counts them")
      ->check(CLI::Range(0, kLongestPath))
      ->capture_default_str();
  app.add_option("--max-glossy", numbers_.maxGlossy, "glossy bounces of a path: those from samples of the lobe")
      ->check(CLI::Range(0, kLongestPath))
      ->capture_default_str();
  app.add_option("--max-transmission", numbers_.maxTransmission,
                 "transmission bounces of a path: those through glass and other surfaces that scatter light to behind")
      ->check(CLI::Range(0, kLongestPath))
      ->capture_default_str();
  app.add_option("--max-transparent", numbers_.maxTransparent,
                 "surfaces that a path passes straight, as transparent ones let it")
      ->check(CLI::Range(0, kLongestPath))
      ->capture_default_str();
  app.add_option("--kernel", kernel_, "general: with everything compiled in; the image is the same")
      ->check(CLI::IsMember({"auto", "general"}))
      ->capture_default_str();
}

RenderSettings SettingOptions::chosen() const {
  RenderSettings s = numbers_;
  if (!allocation_.empty())
    s.allocation = pick(allocation_, kAllocations);
  else if (!yielding().empty())
    s.allocation = Allocation::kEqual;
  if (weights_ != "auto") s.weights = pick(weights_, kWeights);
  s.pixels = pick(pixels_, kPixelSamples);
  s.integrand = pick(integrand_, kIntegrands);
  s.integrator = pick(integrator_, kIntegrators);
  s.sampler = pick(sampler_, kSamplers);
  s.generalKernel = kernel_ == "general";
  s.costFrom = cost_ == "rays" ? CostFrom::kRays : cost_ == "measured" ? CostFrom::kMeasured : CostFrom::kGiven;
  if (s.costFrom == CostFrom::kGiven) s.cost = costOf(cost_);
  if (s.allocation == Allocation::kAuto && s.weightRule() == Weights::kNonbalance)
    throw Error(ExitCode::kUsage,
                "--allocation auto with --weights nonbalance: auto predicts the variance for balance weights, and "
                "would do harm with these",
                "leave one of them out, or take --allocation standard-deviation, the best for nonbalance weights");
  if (!s.bidirectional() && s.weights == Weights::kVarianceAware)
    throw Error(
        ExitCode::kUsage,
        "--weights variance-aware: their factors are of ways to make a path, of which there is one without paths "
        "from the lights",
        "take --integrator bidirectional, or other weights");
  if (s.bidirectional() && s.weights && *s.weights != Weights::kBalance && *s.weights != Weights::kPower &&
      *s.weights != Weights::kVarianceAware)
    throw Error(
        ExitCode::kUsage,
        fmt::format("--integrator bidirectional with --weights {}: its weights are over all ways to make a path, "
                    "for which there are balance, power and variance-aware",
                    weights_),
        "take one of these, or leave --weights out for balance");
  return s;
}

std::string SettingOptions::yielding() const {
  if (!allocation_.empty() || weights_ == "auto" || weights_ == name(Weights::kBalance)) return {};
  return fmt::format("samples are shared equally: the default allocation, auto, is for balance weights, not for {}",
                     weights_);
}

SettingOptions SettingOptions::with(const std::string& changes) const {
  SettingOptions changed = *this;
  CLI::App app;
  changed.add(app);
  std::vector<std::string> arguments;
  for (const std::string& part : CLI::detail::split(changes, ',')) {
    // a part without '=' goes on with a list: cost=1,1,2
    if (part.find('=') == part.npos && !arguments.empty())
      arguments.back() += "," + part;
    else if (!part.empty())
      arguments.push_back("--" + part);
  }
  std::reverse(arguments.begin(), arguments.end());  // as the parser wants them
  try {
    app.parse(arguments);
  } catch (const CLI::ParseError& e) {
    std::string keys;
    for (const CLI::Option* option : app.get_options([](const CLI::Option* x) { return x->get_name() != "--help"; }))
      keys += (keys.empty() ? "" : ", ") + option->get_name().substr(2);
    throw Error(ExitCode::kUsage, fmt::format("'{}': {}", changes, e.what()), "give key=value with keys of: " + keys);
  }
  return changed;
}

nlohmann::json toJson(const RenderSettings& s) {
  return {{"allocation", name(s.allocation)},
          {"pixels", name(s.sharesPixels() ? PixelSamples::kByError : PixelSamples::kEven)},
          {"weights", name(s.weightRule())},
          {"integrand", name(s.integrand)},
          {"integrator", name(s.integrator)},
          {"sampler", name(s.sampler)},
          {"samples_per_hit", s.samplesPerHit},
          {"light_paths", s.fromLights.paths},
          {"connections", s.fromLights.connections},
          {"later_connections", s.fromLights.laterConnections},
          {"light_tracing", s.fromLights.film},
          {"pilot_spp", s.pilotSpp},
          {"min_fraction", s.minFraction},
          {"cost", s.costFrom == CostFrom::kRays       ? nlohmann::json("rays")
                   : s.costFrom == CostFrom::kMeasured ? nlohmann::json("measured")
                                                       : nlohmann::json{s.cost.lobe, s.cost.cosine, s.cost.light}},
          {"max_depth", s.maxDepth},
          {"max_diffuse", s.maxDiffuse},
          {"max_glossy", s.maxGlossy},
          {"max_transmission", s.maxTransmission},
          {"max_transparent", s.maxTransparent},
          {"kernel", s.generalKernel ? "general" : "auto"}};
}

void useResolution(Scene& scene, const std::string& text) {
  int w = 0, h = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &w, &h, &rest) != 2 || w < 1 || h < 1)
    throw Error(ExitCode::kUsage, fmt::format("--resolution '{}'", text), "give WIDTHxHEIGHT, for example 1920x1080");
  if (std::max(w, h) > kLargestSide)
    throw Error(ExitCode::kUsage, fmt::format("--resolution '{}' is too large", text),
                fmt::format("give at most {} pixels a side", kLargestSide));
  Film& f = scene.film;
  // panoramas but those with a sensor show all of their angles in any frame
  const bool fitted =
      scene.camera && (!scene.camera->panoramic() || scene.camera->projection == Projection::kFisheyeEquisolid ||
                       scene.camera->projection == Projection::kFisheyePolynomial);
  if (fitted) {
    // keep the larger side of the view plane, as another aspect would in Blender
    Camera& c = *scene.camera;
    const float aspect = static_cast<float>(w) / static_cast<float>(h), old = (c.right - c.left) / (c.top - c.bottom);
    const float cx = 0.5f * (c.left + c.right), cy = 0.5f * (c.bottom + c.top);
    if (aspect >= 1) {
      const float half = 0.5f * (old >= 1 ? c.right - c.left : c.top - c.bottom);
      c.left = cx - half, c.right = cx + half, c.bottom = cy - half / aspect, c.top = cy + half / aspect;
    } else {
      const float half = 0.5f * (old >= 1 ? c.right - c.left : c.top - c.bottom);
      c.bottom = cy - half, c.top = cy + half, c.left = cx - half * aspect, c.right = cx + half * aspect;
    }
  }
  const double sx = double(w) / f.width, sy = double(h) / f.height;
  f.x0 = static_cast<int>(f.x0 * sx), f.x1 = std::max(f.x0 + 1, static_cast<int>(f.x1 * sx));
  f.y0 = static_cast<int>(f.y0 * sy), f.y1 = std::max(f.y0 + 1, static_cast<int>(f.y1 * sy));
  f.width = w, f.height = h;
}

}  // namespace wardmis
