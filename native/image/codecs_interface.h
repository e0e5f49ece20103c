// SPDX-License-Identifier: GPL-3.0-or-later
// What the module wardmis_codecs gives to the command: plain C, as in oiio_interface.h. A function returns null, or
// else what is wrong; that text lives until the thread's next call. A pointer is null where the module was built
// without the library.
#pragma once

#include <cstddef>
#include <cstdint>

extern "C" {

struct DracoMesh;

enum MeshoptMode { kMeshoptAttributes, kMeshoptTriangles, kMeshoptIndices };
enum MeshoptFilter { kMeshoptNone, kMeshoptOctahedral, kMeshoptQuaternion, kMeshoptExponential };

struct CodecsInterface {
  int version;
  // Draco: a mesh, decoded whole.
  const char* (*dracoOpen)(const void* data, size_t size, DracoMesh** mesh, uint32_t* vertices, uint32_t* triangles);
  // The attribute of this number: `components` floats a vertex.
  const char* (*dracoAttribute)(const DracoMesh* mesh, uint32_t number, int components, float* values);
  void (*dracoTriangles)(const DracoMesh* mesh, uint32_t* indices);
  void (*dracoClose)(DracoMesh* mesh);
  // meshoptimizer: `count` elements of `stride` bytes.
  const char* (*meshopt)(MeshoptMode mode, MeshoptFilter filter, const void* data, size_t size, size_t count,
                         size_t stride, void* elements);
  // WebP: 3 or 4 channels of 8 bits, rows from the top.
  const char* (*webpOpen)(const void* file, size_t size, int* width, int* height, int* channels);
  const char* (*webpRead)(const void* file, size_t size, int width, int height, int channels, uint8_t* pixels);
};

constexpr int kCodecsVersion = 1;
// The module exports it by this name.
const CodecsInterface* wardmisCodecs();
}
