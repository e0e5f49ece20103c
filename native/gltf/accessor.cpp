// SPDX-License-Identifier: GPL-3.0-or-later
#include "gltf/accessor.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace wardmis {
namespace {

constexpr const char* kExportAgain = "export the scene again";
constexpr size_t kGrain = 1 << 16;

enum ComponentType { kI8 = 5120, kU8 = 5121, kI16 = 5122, kU16 = 5123, kU32 = 5125, kF32 = 5126 };

size_t sizeOf(int type) { return type == kI8 || type == kU8 ? 1 : type == kI16 || type == kU16 ? 2 : 4; }

// How an element type appears in the file.
template <class T>
constexpr int kComponents = 0;
template <>
constexpr int kComponents<uint32_t> = 1;
template <>
constexpr int kComponents<Scalar> = 1;
template <>
constexpr int kComponents<Vec2f> = 2;
template <>
constexpr int kComponents<Vec3f> = 3;
template <>
constexpr int kComponents<Quaternion> = 4;
template <class T>
constexpr bool kIsIndex = std::is_same_v<T, uint32_t>;

const char* typeName(int components) {
  constexpr const char* kNames[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
  return kNames[components];
}

// f(C{}) with C the component's type.
template <class F>
void dispatch(int type, F f) {
  switch (type) {
    case kI8:
      return f(int8_t{});
    case kU8:
      return f(uint8_t{});
    case kI16:
      return f(int16_t{});
    case kU16:
      return f(uint16_t{});
    case kU32:
      return f(uint32_t{});
    default:
      return f(float{});
  }
}

// One element, from components of type C at `from`, which need not be aligned.
template <class T, class C>
T element(const std::byte* from, float scale) {
  std::array<C, kComponents<T>> in;
  std::memcpy(&in, from, sizeof in);
  if constexpr (kIsIndex<T>) {
    return static_cast<uint32_t>(in[0]);
  } else {
    std::array<float, kComponents<T>> out;
    for (size_t k = 0; k < out.size(); k++)
      out[k] = scale == 1 ? static_cast<float>(in[k]) : std::max(static_cast<float>(in[k]) * scale, -1.0f);
    return std::bit_cast<T>(out);
  }
}

template <class T>
bool hasNotFinite(const T& element) {
  const auto bits = std::bit_cast<std::array<uint32_t, kComponents<T>>>(element);
  bool any = false;
  for (const uint32_t b : bits) any |= (b & 0x7F800000u) == 0x7F800000u;
  return any;
}

// Index of the first element that is not finite, or the number of elements.
template <class T>
size_t firstNotFinite(std::span<const T> data) {
  const auto bad = [&](size_t i) { return hasNotFinite(data[i]); };
  return tbb::parallel_reduce(
      tbb::blocked_range<size_t>(0, data.size(), kGrain), data.size(),
      [&](const tbb::blocked_range<size_t>& range, size_t first) {
        bool any = false;  // without an early exit, so that the loop vectorises
        for (size_t i = range.begin(); i < range.end(); i++) any |= bad(i);
        if (!any) return first;
        size_t i = range.begin();
        while (!bad(i)) i++;
        return std::min(first, i);
      },
      [](size_t a, size_t b) { return std::min(a, b); });
}

}  // namespace

// A checked accessor: every element it claims lies within the buffer view.
struct Accessors::View {
  size_t index;
  size_t count;
  int type;  // ComponentType
  int components;
  bool normalized;
  Bytes bytes;  // from the first element on; empty if the elements are zero
  size_t stride;
  std::optional<Json> sparse;

  size_t elementSize() const { return sizeOf(type) * components; }
};

Accessors::Accessors(const Json& root, Buffers& buffers, size_t fileBytes)
    : accessors_(root.array("accessors")), buffers_(buffers), maxUnbacked_(std::max<size_t>(fileBytes, 1 << 16)) {}

Accessors::View Accessors::view(const Json& use, size_t i) {
  const Json json = accessors_[i];
  constexpr std::pair<std::string_view, int> kTypes[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                                                         {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
  View v;
  v.index = i;
  v.components = json.at("type").choice(kTypes);
  const Json type = json.at("componentType");
  v.type = static_cast<int>(type.integer(kI8, kF32));
  if (v.type == 5124) type.failExpected("5120, 5121, 5122, 5123, 5125 or 5126");
  v.normalized = json.booleanOr("normalized", false);
  v.count = json.at("count").integer(1, UINT32_MAX - 1);  // so that an index of 32 bits can name each
  v.sparse = json.find("sparse");
  v.stride = v.elementSize();
  const auto bufferView = json.find("bufferView");
  if (!bufferView) {
    if (v.count > maxUnbacked_)
      use.fail(fmt::format("accessor {} claims {} elements without data", i, v.count), kExportAgain);
    return v;
  }
  size_t stride = 0;
  uint64_t start = 0;
  const Bytes bytes = buffers_.view(*bufferView, &stride, &start);
  if (stride != 0 && stride < v.elementSize())
    use.fail(fmt::format("accessor {} has elements of {} bytes, but its byteStride is {}", i, v.elementSize(), stride),
             kExportAgain);
  if (stride != 0) v.stride = stride;
  const uint64_t offset = json.integerOr("byteOffset", 0, 0, uint64_t(1) << 48);
  if (const size_t size = sizeOf(v.type); (start + offset) % size != 0 || v.stride % size != 0)
    use.fail(
        fmt::format("accessor {} begins at byte {} of its buffer with one element every {} bytes: its components of "
                    "{} bytes are not aligned",
                    i, start + offset, v.stride, size),
        kExportAgain);
  const uint64_t end = offset + (v.count - 1) * v.stride + v.elementSize();  // < 2^48 + 2^32 2^8 + 2^6
  if (end > bytes.size())
    use.fail(fmt::format("accessor {} ends at byte {}, but its bufferView has {} bytes", i, end, bytes.size()),
             kExportAgain);
  v.bytes = bytes.part(offset, bytes.size() - offset);
  return v;
}

template <class T>
Array<T> Accessors::convert(const View& v) {
  static_assert(sizeof(T) == 4 * kComponents<T>);
  const std::byte* data = v.bytes.data.data();
  const bool asItIs = v.type == (kIsIndex<T> ? kU32 : kF32);
  if (asItIs && data && !v.sparse && v.stride == sizeof(T) && reinterpret_cast<uintptr_t>(data) % alignof(T) == 0)
    return {{reinterpret_cast<const T*>(data), v.count}, v.bytes.owner};

  const float scale = !v.normalized    ? 1.0f
                      : v.type == kI8  ? 1 / 127.0f
                      : v.type == kU8  ? 1 / 255.0f
                      : v.type == kI16 ? 1 / 32767.0f
                      : v.type == kU16 ? 1 / 65535.0f
                                       : 1.0f;
  std::vector<T> out(v.count);
  if (data)
    dispatch(v.type, [&]<class C>(C) {
      tbb::parallel_for(tbb::blocked_range<size_t>(0, v.count, kGrain), [&](const auto& range) {
        for (size_t i = range.begin(); i < range.end(); i++) out[i] = element<T, C>(data + i * v.stride, scale);
      });
    });
  if (v.sparse) {
    const size_t count = v.sparse->at("count").integer(1, v.count);
    const auto part = [&](const Json& json, size_t elementSize) {
      const Json bufferView = json.at("bufferView");
      const Bytes bytes = buffers_.view(bufferView);
      const uint64_t offset = json.integerOr("byteOffset", 0, 0, uint64_t(1) << 48);
      const uint64_t end = offset + count * elementSize;
      if (end > bytes.size())
        json.fail(fmt::format("ends at byte {}, but its bufferView has {} bytes", end, bytes.size()), kExportAgain);
      return bytes.part(offset, count * elementSize);
    };
    const Json indices = v.sparse->at("indices");
    const int type = static_cast<int>(indices.at("componentType").integer(kI8, kF32));
    if (type != kU8 && type != kU16 && type != kU32) indices.at("componentType").failExpected("5121, 5123 or 5125");
    const Bytes where = part(indices, sizeOf(type));
    const Bytes values = part(v.sparse->at("values"), v.elementSize());
    dispatch(v.type, [&]<class C>(C) {
      for (size_t k = 0; k < count; k++) {
        uint32_t i = 0;
        std::memcpy(&i, where.data.data() + k * sizeOf(type), sizeOf(type));
        if (i >= v.count) indices.fail(fmt::format("refers to element {}, but there are {}", i, v.count), kExportAgain);
        out[i] = element<T, C>(values.data.data() + k * v.elementSize(), scale);
      }
    });
  }
  return Array<T>::of(std::move(out));
}

size_t Accessors::count(const Json& use) const {
  return accessors_[use.index(accessors_.size(), "accessors")].at("count").integer(1, UINT32_MAX - 1);
}

bool Accessors::hasData(const Json& use) const {
  const Json json = accessors_[use.index(accessors_.size(), "accessors")];
  return json.find("bufferView") || json.find("sparse");
}

void Accessors::checkAttribute(const Json& use, std::string_view name, size_t vertices) const {
  const size_t i = use.index(accessors_.size(), "accessors");
  const Json json = accessors_[i];
  if (const size_t found = count(use); found != vertices)
    use.fail(fmt::format("has {} elements, but POSITION has {}", found, vertices), kExportAgain);
  const uint64_t type = json.at("componentType").integer(kI8, kF32);
  if (!name.starts_with('_') && (type == kU32 || (name.starts_with("JOINTS_") && type == kF32)))
    use.fail(fmt::format("accessor {} has componentType {}, which is not allowed here", i, type), kExportAgain);
}

template <class T>
Array<T> Accessors::read(const Json& use, size_t* mended) {
  const size_t i = use.index(accessors_.size(), "accessors");
  auto& cache = std::get<Cache<T>>(cache_);
  if (const auto found = cache.find(i); found != cache.end()) return found->second;

  const View v = view(use, i);
  if (v.components != kComponents<T>)
    use.fail(fmt::format("expected elements of type {}, but accessor {} has {} components", typeName(kComponents<T>), i,
                         v.components),
             kExportAgain);
  const bool isUnsigned = v.type == kU8 || v.type == kU16 || v.type == kU32;
  if (kIsIndex<T> ? !isUnsigned || v.normalized : v.type == kU32)
    use.fail(fmt::format("accessor {} has componentType {}{}, which is not allowed here", i, v.type,
                         v.normalized ? " (normalized)" : ""),
             kExportAgain);
  buffers_.budget.charge(v.count * sizeof(T), use);
  Array<T> out = convert<T>(v);
  if constexpr (!kIsIndex<T>) {
    const size_t bad = firstNotFinite(out.data);
    if (bad < out.size() && mended) {
      std::vector<T> copy(out.data.begin(), out.data.end());
      for (T& element : copy)
        if (hasNotFinite(element)) element = T{}, ++*mended;
      return Array<T>::of(std::move(copy));  // not for others, who may want to refuse it
    }
    if (bad < out.size())
      use.fail(fmt::format("element {} of accessor {} is not finite", bad, i),
               "mend the object in the program that wrote the scene (NaN or infinite coordinates), and export again");
  }
  cache.emplace(i, out);
  return out;
}

FloatArray Accessors::readFloats(const Json& use, size_t* mended) {
  const auto flat = [&]<class T>(const Array<T>& array) {
    constexpr int n = kComponents<T>;
    static_assert(sizeof(T) == n * sizeof(float));
    return FloatArray{{{reinterpret_cast<const float*>(array.data.data()), n * array.size()}, array.owner}, n};
  };
  switch (view(use, use.index(accessors_.size(), "accessors")).components) {
    case 1:
      return flat(read<Scalar>(use, mended));
    case 2:
      return flat(read<Vec2f>(use, mended));
    case 3:
      return flat(read<Vec3f>(use, mended));
    case 4:
      return flat(read<Quaternion>(use, mended));
    default:
      return {};
  }
}

template Array<Vec2f> Accessors::read(const Json&, size_t*);
template Array<Vec3f> Accessors::read(const Json&, size_t*);
template Array<Quaternion> Accessors::read(const Json&, size_t*);
template Array<uint32_t> Accessors::read(const Json&, size_t*);

}  // namespace wardmis
