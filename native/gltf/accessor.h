// SPDX-License-Identifier: GPL-3.0-or-later
// `accessors`: typed arrays over the buffers, checked; a view into the mapped file where the layout allows.
#pragma once

#include <array>
#include <tuple>
#include <unordered_map>

#include "gltf/file.h"
#include "scene/scene.h"

namespace wardmis {

using Quaternion = std::array<float, 4>;  // x, y, z, w
using Scalar = std::array<float, 1>;

// Elements of one to four numbers, one after the other.
struct FloatArray {
  Array<float> data;
  int components = 0;
};

class Accessors {
 public:
  Accessors(const Json& root, Buffers& buffers, size_t fileBytes);

  // The accessor whose index stands at `use`. T: Scalar, Vec2f, Vec3f, Quaternion (all are finite) or uint32_t.
  // With `mended`, elements that are not finite become 0, and are counted.
  template <class T>
  Array<T> read(const Json& use, size_t* mended = nullptr);
  // The same with elements of any number of components up to four; none of more: what has them is of no use here.
  FloatArray readFloats(const Json& use, size_t* mended);

  // Whether it may be an attribute of this name of a mesh of so many vertices, also if nobody reads it: what an
  // exporter got wrong there it may have got wrong in the rest.
  void checkAttribute(const Json& use, std::string_view name, size_t vertices) const;
  size_t count(const Json& use) const;  // its number of elements
  bool hasData(const Json& use) const;  // of its own, not only zeros

 private:
  struct View;
  View view(const Json& use, size_t i);
  template <class T>
  Array<T> convert(const View& view);

  JsonArray accessors_;
  Buffers& buffers_;
  uint64_t maxUnbacked_;  // elements that an accessor without a buffer view may have
  // What has been read already, by index.
  template <class T>
  using Cache = std::unordered_map<size_t, Array<T>>;
  std::tuple<Cache<Scalar>, Cache<Vec2f>, Cache<Vec3f>, Cache<Quaternion>, Cache<uint32_t>> cache_;
};

}  // namespace wardmis
