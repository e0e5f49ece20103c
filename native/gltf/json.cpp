// SPDX-License-Identifier: GPL-3.0-or-later
#include "gltf/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

namespace wardmis {
namespace {

constexpr size_t kMaxDepth = 128;  // nesting of the JSON text
constexpr const char* kExportAgain = "export the scene again, or mend the file";

// The value as it stands in a message.
std::string shown(simdjson::dom::element element) {
  switch (element.type()) {
    case simdjson::dom::element_type::OBJECT:
      return "an object";
    case simdjson::dom::element_type::ARRAY: {
      simdjson::dom::array array = element.get_array();
      if (array.size() > 4) return fmt::format("an array of {}", array.size());
      std::string text;
      for (simdjson::dom::element e : array) {
        const bool nested = e.is_array() || e.is_object();
        text += (text.empty() ? "" : ", ") + (nested ? std::string("...") : shown(e));
      }
      return "[" + text + "]";
    }
    case simdjson::dom::element_type::STRING:
      return '"' + cleaned(std::string_view(element)) + '"';
    default:
      return simdjson::minify(element);
  }
}

// simdjson does not say where a text is wrong. A second, slower parser does, which is asked only then.
class Locator : public nlohmann::json_sax<nlohmann::json> {
 public:
  // An input iterator that counts what has been read.
  struct Reader {
    using difference_type = std::ptrdiff_t;
    using value_type = char;
    using pointer = const char*;
    using reference = const char&;
    using iterator_category = std::input_iterator_tag;
    const char* at;
    size_t* read;
    reference operator*() const { return *at; }
    Reader& operator++() {
      ++*read, ++at;
      return *this;
    }
    bool operator==(const Reader& b) const { return at == b.at; }
    bool operator!=(const Reader& b) const { return at != b.at; }
  };

  // The number of bytes up to where it is wrong and, where this parser knows better, what is; 0: it finds nothing.
  size_t find(std::string_view text) {
    size_t read = 0;
    const Reader begin{text.data(), &read}, end{text.data() + text.size(), &read};
    return nlohmann::json::sax_parse(begin, end, this) ? 0 : std::clamp<size_t>(read, 1, text.size());
  }
  const std::string& what() const { return what_; }

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t& text) override {
    // what simdjson takes for whole, and does not hold
    return text.find_first_of(".eE") != text.npos;
  }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_object(size_t) override { return ++depth_ <= kMaxDepth; }
  bool key(string_t&) override { return true; }
  bool end_object() override { return --depth_, true; }
  bool start_array(size_t) override { return ++depth_ <= kMaxDepth; }
  bool end_array() override { return --depth_, true; }
  bool parse_error(size_t, const std::string&, const nlohmann::detail::exception& e) override {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error while ..."
    what_ = e.what();
    const size_t from = what_.find("error while ");
    what_.erase(0, from != what_.npos ? from : what_.find("] ") + 2);
    return false;
  }

 private:
  size_t depth_ = 0;
  std::string what_;
};

// ", line 3, byte 45: what is wrong"
std::string located(std::string_view text, const char* message) {
  Locator locator;
  const size_t bytes = locator.find(text);
  if (bytes == 0) return fmt::format(": {}", message);
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(bytes - 1), '\n');
  return fmt::format(", line {}, byte {}: {}", line, bytes, locator.what().empty() ? message : cleaned(locator.what()));
}

}  // namespace

std::string cleaned(std::string_view text) {
  constexpr size_t kLongest = 120;
  std::string out(text.substr(0, kLongest));
  if (text.size() > kLongest) {
    while (!out.empty() && (out.back() & 0xC0) == 0x80) out.pop_back();  // not within a UTF-8 sequence
    if (!out.empty() && (out.back() & 0x80)) out.pop_back();
    out += "...";
  }
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  return out;
}

JsonDocument::JsonDocument(std::string file_, std::string_view text) : file(std::move(file_)) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  auto error = parser.allocate(text.size(), kMaxDepth);
  if (!error) error = parser.parse(text.data(), text.size()).get(root);
  if (error)
    throw Error(ExitCode::kScene, fmt::format("{}: JSON{}", file, located(text, simdjson::error_message(error))),
                kExportAgain);
  if (!root.is_object()) Json(*this).failExpected("an object");
}

simdjson::dom::object Json::object() const {
  simdjson::dom::object object;
  if (element_.get(object)) failExpected("an object");
  return object;
}

Json Json::child(std::string_view key, simdjson::dom::element element) const {
  Json json = *this;
  json.element_ = element;
  if (json.depth_ < kMaxSteps) json.steps_[json.depth_++] = {key.data() ? key : "", 0};
  return json;
}

Json Json::child(size_t index, simdjson::dom::element element) const {
  Json json = *this;
  json.element_ = element;
  if (json.depth_ < kMaxSteps) json.steps_[json.depth_++] = {{}, index};
  return json;
}

std::optional<Json> Json::find(std::string_view key) const {
  simdjson::dom::element element;
  if (object().at_key(key).get(element)) return std::nullopt;
  return child(key, element);
}

Json Json::at(std::string_view key) const {
  if (auto json = find(key)) return *json;
  fail(fmt::format("'{}' is missing", key), kExportAgain);
}

std::optional<Json> Json::extension(std::string_view name) const {
  const auto extensions = find("extensions");
  return extensions ? extensions->find(name) : std::nullopt;
}

JsonArray Json::array() const {
  simdjson::dom::array array;
  if (element_.get(array)) failExpected("an array");
  return JsonArray(*this, {array.begin(), array.end()});
}

JsonArray Json::array(std::string_view key) const {
  const auto json = find(key);
  return json ? json->array() : JsonArray(*this);
}

void Json::numbers(std::span<float> out) const {
  simdjson::dom::array array;
  if (element_.get(array) || array.size() != out.size()) failExpected(fmt::format("{} numbers", out.size()));
  size_t i = 0;
  for (simdjson::dom::element e : array) {
    out[i] = child(i, e).number();
    i++;
  }
}

Vec3f Json::vec3() const {
  const auto v = numbers<3>();
  return {v[0], v[1], v[2]};
}

Rgb Json::color() const {
  const Rgb c = vec3();
  if (c.x < 0 || c.y < 0 || c.z < 0) failExpected("three numbers >= 0");
  return c;
}

std::string_view Json::string() const {
  std::string_view text;
  if (element_.get(text)) failExpected("a string");
  return text;
}

bool Json::boolean() const {
  bool value;
  if (element_.get(value)) failExpected("true or false");
  return value;
}

float Json::number(float low, float high) const {
  double value;
  if (element_.get(value)) failExpected("a number");
  if (!(value >= low && value <= high)) {
    if (low == -FLT_MAX)
      failExpected(high == FLT_MAX ? "a number of single precision" : fmt::format("a number <= {}", high));
    failExpected(high == FLT_MAX ? fmt::format("a number >= {}", low)
                                 : fmt::format("a number from {} to {}", low, high));
  }
  return static_cast<float>(value);
}

uint64_t Json::integer(uint64_t low, uint64_t high) const {
  uint64_t value;
  // Some exporters write whole numbers as 1.0; glTF allows it.
  if (double d; element_.get(value) && !element_.get(d) && d >= 0 && d < 9007199254740992.0 && d == std::floor(d))
    value = static_cast<uint64_t>(d);
  else if (element_.get(value))
    failExpected("a whole number >= 0");
  if (value < low || value > high) failExpected(fmt::format("a whole number from {} to {}", low, high));
  return value;
}

size_t Json::index(size_t size, std::string_view array) const {
  const uint64_t i = integer(0, UINT64_MAX);
  if (i >= size) fail(fmt::format("refers to {}[{}], but the file has {} of them", array, i, size), kExportAgain);
  return i;
}

std::string_view Json::stringOr(std::string_view key, std::string_view fallback) const {
  const auto json = find(key);
  return json ? json->string() : fallback;
}
bool Json::booleanOr(std::string_view key, bool fallback) const {
  const auto json = find(key);
  return json ? json->boolean() : fallback;
}
float Json::numberOr(std::string_view key, float fallback, float low, float high) const {
  const auto json = find(key);
  return json ? json->number(low, high) : fallback;
}
uint64_t Json::integerOr(std::string_view key, uint64_t fallback, uint64_t low, uint64_t high) const {
  const auto json = find(key);
  return json ? json->integer(low, high) : fallback;
}
Rgb Json::colorOr(std::string_view key, Rgb fallback) const {
  const auto json = find(key);
  return json ? json->color() : fallback;
}
Rgb Json::lightOr(std::string_view key, Rgb fallback) const {
  const auto json = find(key);
  return json ? Rgb{json->vec3()} : fallback;
}

std::string Json::name() const {
  std::string_view text;
  return element_["name"].get(text) ? std::string() : cleaned(text);
}

std::string Json::described() const {
  const std::string text = name();
  return text.empty() ? path() : "'" + text + "'";
}

std::string Json::path() const {
  std::string out;
  simdjson::dom::element element = document_->root;
  bool known = true;  // element is the one at `out`
  for (int i = 0; i < depth_; i++) {
    const Step& step = steps_[i];
    if (step.key.data()) {
      out += (out.empty() ? "" : out.back() == '\'' ? " ." : ".") + cleaned(step.key);
      known = known && !element.at_key(step.key).get(element);
    } else {
      out += fmt::format("[{}]", step.index);
      simdjson::dom::array array;
      known = known && !element.get(array) && !array.at(step.index).get(element);
      std::string_view text;
      if (known && (!element["op"].get(text) || !element["name"].get(text))) out += " '" + cleaned(text) + "'";
    }
  }
  return out;
}

void Json::fail(const std::string& what, std::string hint) const {
  const std::string place = path();
  throw Error(ExitCode::kScene, document_->file + ": " + (place.empty() ? "" : place + ": ") + what, std::move(hint));
}

void Json::failExpected(const std::string& what) const {
  fail(fmt::format("expected {}, found {}", what, shown(element_)), kExportAgain);
}

}  // namespace wardmis
