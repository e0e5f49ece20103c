// SPDX-License-Identifier: GPL-3.0-or-later
#include "gltf/draco.h"

#include <fmt/format.h>

#include <cmath>

#include "image/codecs.h"

namespace wardmis {

bool hasDraco() { return codecs().dracoOpen != nullptr; }

DracoPrimitive readDraco(const Json& extension, const std::string& uvs, Buffers& buffers) {
  const CodecsInterface& codec = codecs();
  if (!codec.dracoOpen)
    extension.fail("the mesh is compressed by Draco, and " + codecMissing("Draco"),
                   "build the command where it is installed (libdraco-dev), or export without compression");
  constexpr const char* kExportAgain = "export the scene again";
  const auto check = [&](const char* wrong) {
    if (wrong) extension.fail(fmt::format("what Draco has compressed is damaged: {}", cleaned(wrong)), kExportAgain);
  };
  const Bytes packed = buffers.view(extension.at("bufferView"));
  DracoMesh* opened = nullptr;
  uint32_t vertices = 0, triangles = 0;
  check(codec.dracoOpen(packed.data.data(), packed.size(), &opened, &vertices, &triangles));
  const std::unique_ptr<DracoMesh, void (*)(DracoMesh*)> mesh(opened, codec.dracoClose);
  if (vertices == 0 || triangles == 0) return {};
  buffers.budget.grow(3 * packed.size());  // it packs further than anything else
  buffers.budget.charge(uint64_t{vertices} * 2 * sizeof(Vec3f) + uint64_t{triangles} * 3 * sizeof(uint32_t), extension);

  const Json attributes = extension.at("attributes");
  DracoPrimitive out;
  const auto read = [&]<class T>(const Json& number, Array<T>&, bool mend) {
    constexpr int kComponents = sizeof(T) / sizeof(float);
    std::vector<T> values(vertices);
    float* numbers = &values[0].x;
    check(codec.dracoAttribute(mesh.get(), static_cast<uint32_t>(number.integer(0, UINT32_MAX)), kComponents, numbers));
    for (size_t i = 0; i < size_t{vertices} * kComponents; ++i) {
      if (std::isfinite(numbers[i])) continue;
      if (!mend) number.fail(fmt::format("element {} is not finite", i / kComponents), kExportAgain);
      numbers[i] = 0;
      ++out.mended;
    }
    return Array<T>::of(std::move(values));
  };
  out.positions = read(attributes.at("POSITION"), out.positions, false);
  if (const auto normal = attributes.find("NORMAL")) out.normals = read(*normal, out.normals, true);
  if (const auto uv = uvs.empty() ? std::nullopt : attributes.find(uvs)) out.uvs = read(*uv, out.uvs, true);
  std::vector<uint32_t> indices(3 * size_t{triangles});
  codec.dracoTriangles(mesh.get(), indices.data());
  out.indices = Array<uint32_t>::of(std::move(indices));
  return out;
}

}  // namespace wardmis
