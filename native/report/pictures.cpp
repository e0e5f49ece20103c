// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/pictures.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace wardmis {
namespace {

constexpr int kBias = 136;  // of the exponent: value = mantissa * 2^(e - 136), mantissa of 8 bits
constexpr int kScalarSteps = 65534;

std::string png(const std::vector<uint8_t>& rgb, int width, int height) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width), image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  if (png_image_write_to_memory(&image, nullptr, &size, 0, rgb.data(), 0, nullptr) == 0)
    throw std::runtime_error(std::string("a picture cannot be encoded: ") + image.message);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, rgb.data(), 0, nullptr) == 0)
    throw std::runtime_error(std::string("a picture cannot be encoded: ") + image.message);
  bytes.resize(size);
  return bytes;
}

int reduction(int width) { return (width + kLargestPicture - 1) / kLargestPicture; }

// Means over n x n pixels, of those that have a value.
std::vector<float> reduced(const std::vector<float>& values, int width, int height, int channels, int n, int& w,
                           int& h) {
  w = (width + n - 1) / n, h = (height + n - 1) / n;
  if (n == 1) return values;
  std::vector<float> out(static_cast<size_t>(w) * static_cast<size_t>(h) * static_cast<size_t>(channels));
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      for (int c = 0; c < channels; ++c) {
        double sum = 0;
        int count = 0;
        for (int v = y * n; v < std::min(height, (y + 1) * n); ++v)
          for (int u = x * n; u < std::min(width, (x + 1) * n); ++u) {
            const float value = values[(static_cast<size_t>(v) * static_cast<size_t>(width) + static_cast<size_t>(u)) *
                                           static_cast<size_t>(channels) +
                                       static_cast<size_t>(c)];
            if (std::isfinite(value)) sum += double(value), ++count;
          }
        out[(static_cast<size_t>(y) * static_cast<size_t>(w) + static_cast<size_t>(x)) * static_cast<size_t>(channels) +
            static_cast<size_t>(c)] = count > 0 ? static_cast<float>(sum / count) : std::nanf("");
      }
  return out;
}

Picture picture(const PictureInfo& info, const char* kind, int width, int height, int n, const std::string& bytes) {
  std::string text = info.text;
  if (n > 1) text += fmt::format(" Shown as means of {0} × {0} pixels.", n);
  return {{{"key", info.key},
           {"label", info.label},
           {"group", info.group},
           {"configuration", info.configuration.empty() ? nlohmann::json() : nlohmann::json(info.configuration)},
           {"kind", kind},
           {"width", width},
           {"height", height},
           {"text", text}},
          base64(bytes)};
}

}  // namespace

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t three = 0;
    for (size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : kDigits[three >> (18 - 6 * k) & 63];
  }
  return out;
}

Picture radiancePicture(const PictureInfo& info, const RgbImage& image) {
  const int n = reduction(image.width);
  int w = 0, h = 0;
  const std::vector<float> rgb = reduced(image.rgb, image.width, image.height, 3, n, w, h);
  const size_t pixels = rgb.size() / 3;
  std::vector<uint8_t> out(2 * rgb.size());
  for (size_t i = 0; i < pixels; ++i) {
    const float most = std::max({rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2], 0.0f});
    int e = 0;
    std::frexp(most, &e);  // most < 2^e
    const int stored = std::clamp(e + kBias - 8, 0, 255);
    if (most > 0) out[3 * (pixels + i)] = static_cast<uint8_t>(stored);
    for (size_t c = 0; c < 3; ++c)
      out[3 * i + c] = static_cast<uint8_t>(
          std::clamp(std::lround(std::ldexp(std::max(0.0f, rgb[3 * i + c]), kBias - stored)), 0l, 255l));
  }
  return picture(info, "radiance", w, h, n, png(out, w, 2 * h));
}

Picture scalarPicture(const PictureInfo& info, const std::vector<float>& values, int width, int height, double low,
                      double high, bool log) {
  const int n = reduction(width);
  int w = 0, h = 0;
  const std::vector<float> v = reduced(values, width, height, 1, n, w, h);
  if (!(high > low)) high = low + 1;
  std::vector<uint8_t> out(3 * v.size());
  for (size_t i = 0; i < v.size(); ++i) {
    const double x = log ? std::log10(double(v[i])) : double(v[i]);
    if (!std::isfinite(v[i]) || (log && !(v[i] > 0))) {
      out[3 * i + 2] = 255;
      continue;
    }
    const auto q = static_cast<int>(std::lround(std::clamp((x - low) / (high - low), 0.0, 1.0) * kScalarSteps));
    out[3 * i] = static_cast<uint8_t>(q >> 8), out[3 * i + 1] = static_cast<uint8_t>(q & 255);
  }
  Picture p = picture(info, "scalar", w, h, n, png(out, w, h));
  p.description.update({{"low", low}, {"high", high}, {"log", log}});
  return p;
}

Picture sharesPicture(const PictureInfo& info, const std::vector<float>& rgb, int width, int height) {
  const int n = reduction(width);
  int w = 0, h = 0;
  const std::vector<float> v = reduced(rgb, width, height, 3, n, w, h);
  std::vector<uint8_t> out(v.size());
  for (size_t i = 0; i < v.size(); ++i)
    out[i] = static_cast<uint8_t>(std::lround(255 * std::clamp(std::isfinite(v[i]) ? v[i] : 0.0f, 0.0f, 1.0f)));
  return picture(info, "rgb", w, h, n, png(out, w, h));
}

Picture classesPicture(const PictureInfo& info, const std::vector<uint8_t>& classes, int width, int height,
                       const std::vector<std::pair<std::string, std::string>>& names) {
  const int n = reduction(width), w = (width + n - 1) / n, h = (height + n - 1) / n;
  std::vector<uint8_t> out(3 * static_cast<size_t>(w) * static_cast<size_t>(h));
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      out[3 * (static_cast<size_t>(y) * static_cast<size_t>(w) + static_cast<size_t>(x))] =
          classes[static_cast<size_t>(y * n) * static_cast<size_t>(width) + static_cast<size_t>(x * n)];
  Picture p = picture(info, "classes", w, h, 1, png(out, w, h));
  for (const auto& [name, colour] : names) p.description["classes"].push_back({{"name", name}, {"colour", colour}});
  return p;
}

}  // namespace wardmis
