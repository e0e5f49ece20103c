// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/input.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "math/error.h"
#include "mis/moments.h"

namespace wardmis {

void StudyInput::check() const {
  const auto usage = [](const std::string& what, const std::string& hint) {
    throw Error(ExitCode::kUsage, what, hint);
  };
  const auto within = [&](const char* what, double v, double lo, double hi) {
    if (!(v >= lo && v <= hi))
      usage(fmt::format("{} is {:g}", what, v), fmt::format("give a number from {:g} to {:g}", lo, hi));
  };
  within("theta-o", thetaO, 0, 89.9999);
  within("phi-o", phiO, -1e6, 1e6);
  within("rho-d", rhoD, 0, 1e6);
  within("rho-s", rhoS, 0, 1e6);
  within("R", R, 1e-30, 1e30);
  if (ward()) {
    within("alpha", alphaX, 1e-7, 100);
    within("alpha", alphaY, 1e-7, 100);
  } else {
    within("m", m, 0, 1e7);
  }
  if (!(rhoS > 0) && !(joint && rhoD > 0))
    usage("nothing is left to integrate: rho-s is 0" + std::string(joint ? " and so is rho-d" : ""),
          "give a rho-s above 0, or --integrand joint with a rho-d above 0");
  if (mode == StudyMode::kPlanar && alphaX != alphaY && ward())
    usage("the planar reduction knows one alpha only", "give --alpha, or --mode full");
  if (mode == StudyMode::kPlanar && !ward() && thetaO != 0)
    usage("the paper's planar Lafortune-Phong holds at normal incidence", "give --theta-o 0, or --mode full");
  if (techniques.size() < 2 || techniques.size() > kStudyTechniques)
    usage(fmt::format("{} techniques", techniques.size()), "give two or three of lobe, cosine, uniform");
  for (size_t i = 0; i < techniques.size(); ++i)
    for (size_t k = 0; k < i; ++k)
      if (techniques[i] == techniques[k])
        usage(fmt::format("technique {} is given twice", name(techniques[i])), "give each once");
}

std::string_view name(StudyBrdf b) {
  constexpr std::string_view names[] = {"lafortune-phong", "ward", "ward-dur", "ward-gmd"};
  return names[static_cast<int>(b)];
}
std::string_view name(StudyMode m) { return m == StudyMode::kFull ? "full" : "planar"; }
std::string_view name(StudyTechnique t) {
  constexpr std::string_view names[] = {"lobe", "cosine", "uniform"};
  return names[static_cast<int>(t)];
}

namespace {
constexpr std::string_view kLongNames[] = {"ward-lobe", "cosine", "uniform-hemisphere"};
}

nlohmann::json toJson(const StudyInput& in) {
  nlohmann::json j{{"model", name(in.brdf)}, {"mode", name(in.mode)}, {"theta_o_deg", in.thetaO},
                   {"rho_s", in.rhoS},       {"rho_d", in.rhoD},      {"R", in.R}};
  if (!in.ward()) {
    j["m"] = in.m;
  } else if (in.alphaX == in.alphaY && in.phiO == 0) {
    j["alpha"] = in.alphaX;
  } else {
    j["alpha_x"] = in.alphaX, j["alpha_y"] = in.alphaY, j["phi_o_deg"] = in.phiO;
  }
  if (in.joint) j["joint"] = true;
  if (in.techniques != StudyInput{}.techniques)
    for (StudyTechnique t : in.techniques) j["techniques"].push_back(kLongNames[static_cast<int>(t)]);
  return j;
}

StudyInput studyInputFromJson(const nlohmann::json& j) {
  StudyInput in;
  for (StudyBrdf b : {StudyBrdf::kLafortunePhong, StudyBrdf::kWard, StudyBrdf::kWardDur, StudyBrdf::kWardGmd})
    if (name(b) == j.at("model").get<std::string>()) in.brdf = b;
  in.mode = j.at("mode") == "planar" ? StudyMode::kPlanar : StudyMode::kFull;
  in.alphaX = j.contains("alpha_x") ? j["alpha_x"].get<double>() : j.value("alpha", in.alphaX);
  in.alphaY = j.contains("alpha_y") ? j["alpha_y"].get<double>() : in.alphaX;
  in.m = j.value("m", in.m);
  in.thetaO = j.at("theta_o_deg").get<double>();
  in.phiO = j.value("phi_o_deg", 0.0);
  in.rhoS = j.at("rho_s").get<double>(), in.rhoD = j.at("rho_d").get<double>(), in.R = j.at("R").get<double>();
  in.joint = j.value("joint", false);
  if (j.contains("techniques")) {
    in.techniques.clear();
    for (const auto& t : j["techniques"])
      for (int k = 0; k < 3; ++k)
        if (t == kLongNames[k]) in.techniques.push_back(static_cast<StudyTechnique>(k));
  }
  return in;
}

}  // namespace wardmis
