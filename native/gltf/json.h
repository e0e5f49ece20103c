// SPDX-License-Identifier: GPL-3.0-or-later
// A cursor into a parsed JSON text that knows its own path, so that whatever is wrong is reported with its place:
// "scene.glb: materials[2] 'Wood' .alphaX.value: expected a number from 0 to 10, found -1".
#pragma once

#include <simdjson.h>

#include <array>
#include <cfloat>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "math/error.h"
#include "math/vec.h"

namespace wardmis {

// The parsed text; must outlive every Json into it. Throws Error(kScene) on invalid JSON or too deep nesting.
struct JsonDocument {
  JsonDocument(std::string file, std::string_view text);

  std::string file;  // its name, for messages
  simdjson::dom::parser parser;
  simdjson::dom::element root;
};

// Text from a file made fit for a message or a log: no control characters, not too long.
std::string cleaned(std::string_view text);

class JsonArray;

class Json {
 public:
  explicit Json(const JsonDocument& document) : document_(&document), element_(document.root) {}

  // Objects. find: nullopt if the key is missing; at: an error if it is.
  std::optional<Json> find(std::string_view key) const;
  Json at(std::string_view key) const;
  std::optional<Json> extension(std::string_view name) const;
  template <class F>
  void forEachMember(F f) const {
    for (auto [key, value] : object()) f(key, child(key, value));
  }

  // Arrays. array(key) is empty if the key is missing.
  JsonArray array() const;
  JsonArray array(std::string_view key) const;
  void numbers(std::span<float> out) const;
  template <size_t N>
  std::array<float, N> numbers() const {
    std::array<float, N> out;
    numbers(out);
    return out;
  }
  Vec3f vec3() const;
  Rgb color() const;  // three numbers >= 0

  // Values. Numbers are finite in single precision.
  bool isNull() const { return element_.is_null(); }
  bool isObject() const { return element_.is_object(); }
  bool isArray() const { return element_.is_array(); }
  bool isNumber() const { return element_.is_number(); }
  std::string_view string() const;
  bool boolean() const;
  float number(float low = -FLT_MAX, float high = FLT_MAX) const;
  uint64_t integer(uint64_t low, uint64_t high) const;
  size_t index(size_t size, std::string_view array) const;  // < size, the length of the file's `array`

  // The same for a member that may be missing.
  std::string_view stringOr(std::string_view key, std::string_view fallback) const;
  bool booleanOr(std::string_view key, bool fallback) const;
  float numberOr(std::string_view key, float fallback, float low = -FLT_MAX, float high = FLT_MAX) const;
  uint64_t integerOr(std::string_view key, uint64_t fallback, uint64_t low, uint64_t high) const;
  Rgb colorOr(std::string_view key, Rgb fallback) const;
  Rgb lightOr(std::string_view key, Rgb fallback) const;  // of which there may be less than none

  // One of a closed set of strings.
  template <class E, size_t N>
  E choice(const std::pair<std::string_view, E> (&options)[N]) const {
    const std::string_view found = string();
    std::string expected;
    for (const auto& [text, value] : options) {
      if (text == found) return value;
      expected += (expected.empty() ? "\"" : ", \"") + std::string(text) + '"';
    }
    failExpected((N > 1 ? "one of " : "") + expected);
  }

  std::string name() const;       // its "name", cleaned, or empty
  std::string described() const;  // for messages about it: 'name', or its path if it has none

  std::string path() const;
  [[noreturn]] void fail(const std::string& what, std::string hint = {}) const;
  [[noreturn]] void failExpected(const std::string& what) const;  // "expected WHAT, found ..."

 private:
  friend class JsonArray;
  struct Step {
    std::string_view key;  // data() is null for an index
    size_t index;
  };
  static constexpr int kMaxSteps = 12;  // the format's longest path has 8

  simdjson::dom::object object() const;
  Json child(std::string_view key, simdjson::dom::element element) const;
  Json child(size_t index, simdjson::dom::element element) const;

  const JsonDocument* document_;
  simdjson::dom::element element_;
  std::array<Step, kMaxSteps> steps_;
  int depth_ = 0;
};

// An array with random access (simdjson's own has none).
class JsonArray {
 public:
  explicit JsonArray(const Json& self, std::vector<simdjson::dom::element> elements = {})
      : self_(self), elements_(std::move(elements)) {}
  size_t size() const { return elements_.size(); }
  Json operator[](size_t i) const { return self_.child(i, elements_[i]); }

 private:
  Json self_;
  std::vector<simdjson::dom::element> elements_;
};

}  // namespace wardmis
