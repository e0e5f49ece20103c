// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/page.h"

#include <fmt/format.h>

#include "film/exr.h"
#include "film/write_file.h"
#include "math/error.h"
#include "report/web.h"

namespace wardmis {
namespace {

using nlohmann::json;

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text)
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  return out;
}

// The template with its {{names}} replaced; each part is taken as it is, and appears once.
std::string filled(std::string_view page, const std::vector<std::pair<std::string_view, std::string_view>>& parts) {
  std::string out;
  while (!page.empty()) {
    const size_t open = page.find("{{"), close = page.find("}}", open);
    if (open == page.npos || close == page.npos) break;
    out += page.substr(0, open);
    const std::string_view name = page.substr(open + 2, close - open - 2);
    for (const auto& [key, value] : parts)
      if (key == name) out += value;
    page.remove_prefix(close + 2);
  }
  return out += page;
}

std::string html(const json& report, const std::vector<Picture>& pictures, const std::string& text) {
  std::string data = "<script type=\"application/json\" id=\"report\">";
  for (const char c : text)  // nothing in it may end the element
    if (c == '<')
      data += "\\u003c";
    else
      data += c;
  data += "</script>\n";
  for (size_t i = 0; i < pictures.size(); ++i)
    data += fmt::format("<script type=\"text/plain\" id=\"image-{}\">{}</script>\n", i, pictures[i].base64);
  const std::string title = escaped(report["title"].get<std::string>());
  return filled(
      web::kPage,
      {{"title", title}, {"style", web::kStyle}, {"plotly", web::kPlotly}, {"script", web::kScript}, {"data", data}});
}

std::string quoted(const std::string& s) {
  if (s.find_first_of(",\"\n") == s.npos) return s;
  std::string out = "\"";
  for (const char c : s) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + '"';
}

std::string cell(const json& j) {
  if (j.is_null()) return "";
  return j.is_string() ? quoted(j.get<std::string>()) : j.dump();
}

// mean, low, high of an interval that may be null.
std::string cells(const json& interval) {
  if (!interval.is_object()) return ",,";
  return cell(interval["mean"]) + ',' + cell(interval["low"]) + ',' + cell(interval["high"]);
}

std::string header(const std::string& name) { return fmt::format("{0},{0}_low,{0}_high", name); }

std::string curvesCsv(const json& report) {
  std::string csv = "configuration,spp," + header("wall_seconds") + ',' + header("cpu_seconds") + ",rays";
  for (const json& m : report["metrics"]) csv += ',' + header(m["name"]);
  csv += ",near_floor\n";
  for (const json& c : report["configurations"])
    for (const json& at : c["curve"]) {
      csv += cell(c["name"]) + ',' + cell(at["spp"]) + ',' + cells(at["wall"]) + ',' + cells(at["cpu"]) + ',' +
             cell(at["rays"]);
      for (const json& m : report["metrics"]) {
        const std::string name = m["name"];
        csv += ',' + cells(at.contains(name) ? at[name] : json());
      }
      csv += at["near_floor"] == true ? ",1\n" : ",0\n";
    }
  return csv;
}

std::string configurationsCsv(const json& report) {
  const auto part = [](const json& c, const char* object, const char* key) {
    return c[object].is_object() ? c[object][key] : json();
  };
  std::string csv =
      "configuration,renderer,runs,metric,clock,target," + header("seconds_to_target") + ',' + header("time_ratio") +
      ",verdict," + header("equal_time_ratio") + ',' + header("equal_samples_ratio") + ',' +
      header("variance_x_seconds") + ',' + header("variance_x_seconds_ratio") +
      ",slope,slope_low,slope_high,slope_cause,bias,bias_image_z,kurtosis,better,worse,undecided" +
      ",all_pixels_target," + header("all_pixels_seconds_to_target") + ',' + header("all_pixels_time_ratio") + ',' +
      header("all_pixels_equal_time_ratio") + ',' + header("all_pixels_equal_samples_ratio") + '\n';
  for (const json& c : report["configurations"]) {
    csv += cell(c["name"]) + ',' + cell(c["renderer"]) + ',' + cell(c["runs"]) + ',' + cell(report["metric"]) + ',' +
           cell(report["clock"]) + ',' + cell(part(c, "time_to_target", "target")) + ',' +
           cells(part(c, "time_to_target", "seconds")) + ',' + cells(part(c, "time_to_target", "ratio")) + ',' +
           cell(part(c, "time_to_target", "verdict")) + ',' + cells(part(c, "equal_time", "ratio")) + ',' +
           cells(part(c, "equal_samples", "ratio")) + ',' + cells(part(c, "efficiency", "variance_x_seconds")) + ',' +
           cells(part(c, "efficiency", "ratio")) + ',';
    for (const char* key : {"value", "low", "high", "cause"}) csv += cell(part(c, "slope", key)) + ',';
    csv += cell(part(c, "bias", "verdict")) + ',' + cell(part(c, "bias", "image_z")) + ',' +
           cell(part(c, "tail", "kurtosis"));
    for (const char* key : {"better", "worse", "undecided"}) csv += ',' + cell(part(c, "wins", key));
    const json all = c["all_pixels"].is_object()
                         ? c["all_pixels"]
                         : json{{"time_to_target", nullptr}, {"equal_time", nullptr}, {"equal_samples", nullptr}};
    csv += ',' + cell(part(all, "time_to_target", "target")) + ',' + cells(part(all, "time_to_target", "seconds")) +
           ',' + cells(part(all, "time_to_target", "ratio")) + ',' + cells(part(all, "equal_time", "ratio")) + ',' +
           cells(part(all, "equal_samples", "ratio"));
    csv += '\n';
  }
  return csv;
}

std::string groupsCsv(const json& report) {
  std::string csv = "configuration,kind,name,pixels";
  for (const MetricInfo& metric : allMetrics()) csv += ',' + header(metric.name);
  csv += ',' + header("error_ratio") + ',' + header("error_x_time_ratio") + '\n';
  for (const json& c : report["configurations"])
    for (const json& g : c["groups"]) {
      csv += cell(c["name"]) + ',' + cell(g["kind"]) + ',' + cell(g["name"]) + ',' + cell(g["pixels"]);
      for (const MetricInfo& metric : allMetrics()) csv += ',' + cells(g[metric.name]);
      csv += ',' + cells(g["error_ratio"]) + ',' + cells(g["ratio"]) + '\n';
    }
  return csv;
}

}  // namespace

void writeReport(const std::filesystem::path& folder, const Analysis& analysis) {
  const json& report = analysis.report;
  const auto replace = json::error_handler_t::replace;
  writeFile(folder / "report.json", report.dump(1, ' ', false, replace) + '\n');
  writeFile(folder / "curves.csv", curvesCsv(report));
  writeFile(folder / "configurations.csv", configurationsCsv(report));
  writeFile(folder / "groups.csv", groupsCsv(report));
  const std::filesystem::path images = folder / "images";
  std::error_code error;
  std::filesystem::create_directories(images, error);
  if (error)
    throw Error(ExitCode::kFile, fmt::format("{}: the folder cannot be made: {}", images.string(), error.message()),
                "choose another");
  for (const auto& [name, image] : analysis.images) writeExr(images / name, image, true);
  writeFile(folder / "report.html", html(report, analysis.pictures, report.dump(-1, ' ', false, replace)));
}

}  // namespace wardmis
