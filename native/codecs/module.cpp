// SPDX-License-Identifier: GPL-3.0-or-later
// The module wardmis_codecs: the one place that knows Draco, meshoptimizer and libwebp, each if it was there
// (WITH_...).
#if WITH_DRACO
#include <draco/compression/decode.h>
#include <draco/core/decoder_buffer.h>
#endif
#if WITH_MESHOPT
#include <meshoptimizer.h>
#endif
#if WITH_WEBP
#include <webp/decode.h>
#endif

#include <exception>
#include <memory>
#include <stdexcept>
#include <string>

#include "image/codecs_interface.h"

namespace {

[[noreturn]] [[maybe_unused]] void fail(const std::string& what) { throw std::runtime_error(what); }

// What `f` throws, as a text.
template <class F>
[[maybe_unused]] const char* told(F f) noexcept {
  thread_local std::string text;
  try {
    f();
    return nullptr;
  } catch (const std::exception& e) {
    text = e.what();
    return text.c_str();
  }
}

}  // namespace

extern "C" {

#if WITH_DRACO
struct DracoMesh {
  std::unique_ptr<draco::Mesh> mesh;
};

static const char* dracoOpen(const void* data, size_t size, DracoMesh** mesh, uint32_t* vertices, uint32_t* triangles) {
  return told([&] {
    draco::DecoderBuffer buffer;
    buffer.Init(static_cast<const char*>(data), size);
    const auto kind = draco::Decoder::GetEncodedGeometryType(&buffer);
    if (!kind.ok()) fail(kind.status().error_msg_string());
    if (kind.value() != draco::TRIANGULAR_MESH) fail("is a cloud of points");
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) fail(decoded.status().error_msg_string());
    auto out = std::make_unique<DracoMesh>(DracoMesh{std::move(decoded).value()});
    *vertices = out->mesh->num_points();
    *triangles = out->mesh->num_faces();
    *mesh = out.release();
  });
}

static const char* dracoAttribute(const DracoMesh* mesh, uint32_t number, int components, float* values) {
  return told([&] {
    const draco::PointAttribute* attribute = mesh->mesh->GetAttributeByUniqueId(number);
    if (!attribute) fail("has no attribute " + std::to_string(number));
    if (attribute->num_components() != components)
      fail("has " + std::to_string(attribute->num_components()) + " components in attribute " + std::to_string(number));
    for (draco::PointIndex i(0); i < mesh->mesh->num_points(); ++i, values += components)
      if (!attribute->ConvertValue<float>(attribute->mapped_index(i), static_cast<int8_t>(components), values))
        fail("has no numbers in attribute " + std::to_string(number));
  });
}

static void dracoTriangles(const DracoMesh* mesh, uint32_t* indices) {
  for (draco::FaceIndex i(0); i < mesh->mesh->num_faces(); ++i)
    for (const draco::PointIndex& corner : mesh->mesh->face(i)) *indices++ = corner.value();
}

static void dracoClose(DracoMesh* mesh) { delete mesh; }
#else
constexpr auto dracoOpen = nullptr, dracoAttribute = nullptr, dracoTriangles = nullptr, dracoClose = nullptr;
#endif

#if WITH_MESHOPT
static const char* meshopt(MeshoptMode mode, MeshoptFilter filter, const void* data, size_t size, size_t count,
                           size_t stride, void* out) {
  return told([&] {
    const auto* bytes = static_cast<const unsigned char*>(data);
    const bool isVertex = mode == kMeshoptAttributes;
    if (isVertex ? stride == 0 || stride > 256 || stride % 4 != 0 : stride != 2 && stride != 4)
      fail("cannot have elements of " + std::to_string(stride) + " bytes");
    if (mode == kMeshoptTriangles && count % 3 != 0) fail("holds no whole triangles");
    if (filter == kMeshoptOctahedral && stride != 4 && stride != 8) fail("cannot be filtered as directions");
    if (filter == kMeshoptQuaternion && stride != 8) fail("cannot be filtered as rotations");
    const int wrong = isVertex                    ? meshopt_decodeVertexBuffer(out, count, stride, bytes, size)
                      : mode == kMeshoptTriangles ? meshopt_decodeIndexBuffer(out, count, stride, bytes, size)
                                                  : meshopt_decodeIndexSequence(out, count, stride, bytes, size);
    if (wrong != 0) fail("is damaged, or of a newer kind than the library reads");
    if (filter == kMeshoptOctahedral) meshopt_decodeFilterOct(out, count, stride);
    if (filter == kMeshoptQuaternion) meshopt_decodeFilterQuat(out, count, stride);
    if (filter == kMeshoptExponential) meshopt_decodeFilterExp(out, count, stride);
  });
}
#else
constexpr auto meshopt = nullptr;
#endif

#if WITH_WEBP
static const char* webpOpen(const void* file, size_t size, int* width, int* height, int* channels) {
  return told([&] {
    WebPBitstreamFeatures features;
    if (WebPGetFeatures(static_cast<const uint8_t*>(file), size, &features) != VP8_STATUS_OK) fail("its head is wrong");
    if (features.has_animation) fail("it is an animation");
    *width = features.width, *height = features.height, *channels = features.has_alpha ? 4 : 3;
  });
}

static const char* webpRead(const void* file, size_t size, int width, int height, int channels, uint8_t* pixels) {
  return told([&] {
    const size_t row = static_cast<size_t>(width) * channels;
    const auto decode = channels == 4 ? WebPDecodeRGBAInto : WebPDecodeRGBInto;
    if (!decode(static_cast<const uint8_t*>(file), size, pixels, row * height, static_cast<int>(row)))
      fail("its pixels are wrong, or missing");
  });
}
#else
constexpr auto webpOpen = nullptr, webpRead = nullptr;
#endif

[[gnu::visibility("default")]] const CodecsInterface* wardmisCodecs() {
  static const CodecsInterface interface = {kCodecsVersion, dracoOpen, dracoAttribute, dracoTriangles,
                                            dracoClose,     meshopt,   webpOpen,       webpRead};
  return &interface;
}
}
