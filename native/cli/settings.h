// SPDX-License-Identifier: GPL-3.0-or-later
// The options that describe how a scene is rendered, apart from how long: shared by `render` and `converge`.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "integrate/settings.h"
#include "math/error.h"
#include "scene/scene.h"

namespace wardmis {

// The value of that name; the parser has checked that it is among these.
template <class E, size_t N>
E pick(const std::string& value, const std::array<E, N>& all) {
  for (E e : all)
    if (name(e) == value) return e;
  throw Error(ExitCode::kUsage, "unknown value " + value);
}

template <class E, size_t N>
CLI::IsMember among(const std::array<E, N>& all, std::vector<std::string> more = {}) {
  for (E e : all) more.emplace_back(name(e));
  return CLI::IsMember(more);
}

class SettingOptions {
 public:
  // pixels: the default.
  explicit SettingOptions(PixelSamples pixels = PixelSamples::kAuto) : pixels_(name(pixels)) {}
  void add(CLI::App& app);        // the options write to this object, which must not move from then on
  RenderSettings chosen() const;  // once parsed. Throws Error(kUsage)
  // Why chosen() shares samples equally although auto is the default; empty: it does not.
  std::string yielding() const;
  // The same with "key=value,key=value" (the options' names without dashes) on top. Throws Error(kUsage).
  SettingOptions with(const std::string& changes) const;

 private:
  RenderSettings numbers_;
  std::string allocation_,  // empty: not given
      pixels_, weights_ = "auto", integrand_ = "split", integrator_ = "path", sampler_ = "sobol", kernel_ = "auto",
               cost_ = "rays";
};

// Without what ends a render.
nlohmann::json toJson(const RenderSettings& s);

// WIDTHxHEIGHT instead of the scene's; the border keeps its share. Throws Error(kUsage).
void useResolution(Scene& scene, const std::string& text);

}  // namespace wardmis
