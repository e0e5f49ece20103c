// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/options.h"
#include "cli/paths.h"
#include "cli/session.h"
#include "cli/verbs.h"
#include "report/difference.h"
#include "report/metrics.h"

namespace wardmis {

Verb addCompare(CLI::App& app) {
  struct Options {
    std::string image, reference, layer, difference;
    double scale = 1, maxRelMse = -1;
    bool json = false;
  };
  auto o = std::make_shared<Options>();
  app.add_option("IMAGE", o->image,
                 "the image: OpenEXR, PNG, JPEG, or what OpenImageIO reads where the command comes with it; integers "
                 "are taken as sRGB and become linear")
      ->required();
  app.add_option("REFERENCE", o->reference, "what it is held against")->required();
  app.add_option("--layer", o->layer, "layer of multi-layer files (default: the first with a Combined pass)");
  app.add_option("--difference", o->difference,
                 "write the relative error |x - r| / (r + 0.01) as an image: the values as .exr, or false colours with "
                 "their scale as .png, .jpg ... (needs OpenImageIO)");
  app.add_option("--scale", o->scale, "relative error shown in the brightest colour")
      ->check(between(1e-9, 1e9))
      ->capture_default_str();
  app.add_option("--max-relmse", o->maxRelMse, "exit 1 if relMSE is above this")->check(between(0, 1e30));
  app.add_flag("--json", o->json, "machine output");

  return [o] {
    checkDistinct({{"IMAGE", o->image}, {"--difference", o->difference}});
    checkDistinct({{"REFERENCE", o->reference}, {"--difference", o->difference}});
    if (!o->difference.empty()) checkWritable(o->difference);
    const RgbImage image = readRgb(o->image, o->layer), reference = readRgb(o->reference, o->layer);
    const ImageError e = compareImages(image, reference);
    if (!o->difference.empty())
      if (const std::string note = writeDifference(o->difference, image, reference, o->scale); !note.empty())
        tell("wardmis: warning: " + note);
    const bool pass = o->maxRelMse < 0 || e.relMse <= o->maxRelMse;
    if (o->json) {
      fmt::print("{}\n", nlohmann::json{{"width", image.width},
                                        {"height", image.height},
                                        {"mse", e.mse},
                                        {"relmse", e.relMse},
                                        {"relmse_without_top_0.1_percent", e.relMseTrimmed},
                                        {"mape", e.mape},
                                        {"smape", e.smape},
                                        {"relmse_epsilon", kRelMseEpsilon},
                                        {"mape_epsilon", kMapeEpsilon},
                                        {"pass", pass}}
                             .dump(2));
    } else {
      fmt::print("MSE      {:.6g}   mean (x - r)^2\n", e.mse);
      fmt::print("relMSE   {:.6g}   mean (x - r)^2 / (r^2 + {})\n", e.relMse, kRelMseEpsilon);
      fmt::print("         {:.6g}   without the pixels of the largest 0.1 %\n", e.relMseTrimmed);
      fmt::print("MAPE     {:.6g}   mean |x - r| / (|r| + {})\n", e.mape, kMapeEpsilon);
      fmt::print("SMAPE    {:.6g}   mean 2 |x - r| / (|x| + |r| + {})\n", e.smape, kMapeEpsilon);
      if (!pass) fmt::print("relMSE is above {}\n", o->maxRelMse);
    }
    return pass ? 0 : 1;
  };
}

}  // namespace wardmis
