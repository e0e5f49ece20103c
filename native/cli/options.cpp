// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/options.h"

#include <fmt/format.h>

#include <charconv>

namespace wardmis {

CLI::Validator between(double low, double high) {
  const auto check = [=](const std::string& text) {
    double value = 0;
    const bool right = CLI::detail::lexical_cast(text, value) && value >= low && value <= high;  // NaN is neither
    return right ? "" : fmt::format("'{}' is not a number from {} to {}", text, low, high);
  };
  return {check, fmt::format("FLOAT in [{} - {}]", low, high)};
}

CLI::Validator wholeNumber() {
  const auto check = [](const std::string& text) {
    uint64_t value = 0;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    return error == std::errc() && stop == end
               ? ""
               : fmt::format("'{}' is not a whole number from 0 to {}", text, UINT64_MAX);
  };
  return {check, ""};
}

CLI::Validator notEmpty() {
  const auto check = [](const std::string& text) {
    return text.empty() ? std::string("is empty; give a value, or leave the option out") : std::string();
  };
  return {check, ""};
}

CLI::Validator notLonger(size_t longest) {
  const auto check = [=](const std::string& text) {
    return text.size() <= longest ? "" : fmt::format("has {} bytes; at most {} can be used", text.size(), longest);
  };
  return {check, ""};
}

}  // namespace wardmis
