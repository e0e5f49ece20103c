// SPDX-License-Identifier: GPL-3.0-or-later
// The bytes of a scene: the mapped file, its GLB chunks, and the buffers and images that it refers to.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gltf/json.h"
#include "gltf/left_out.h"

namespace wardmis {

// A read-only piece of memory, kept alive by `owner`.
struct Bytes {
  std::span<const std::byte> data;
  std::shared_ptr<const void> owner;
  bool mapped = false;  // from a file, whose pages come back when they are read

  size_t size() const { return data.size(); }
  // The caller has checked the range.
  Bytes part(size_t offset, size_t length) const { return {data.subspan(offset, length), owner, mapped}; }
  // Lets go of the memory of what has been read.
  void drop() const;
};

// Maps a regular file into memory. Throws Error(kFile).
Bytes mapFile(const std::filesystem::path& path);

struct GlbChunks {
  std::string_view json;
  std::optional<Bytes> binary;
};
// A .glb file's chunks, or the text of a .gltf file. What is wrong with the container, but does no harm, is left out.
GlbChunks splitGlb(const Bytes& file, const std::string& name, LeftOut& leftOut);

// A scene must not make the reader allocate or read out of proportion to its own size, whatever its counts claim.
class Budget {
 public:
  // Every way in which the format legitimately makes memory out of the file's bytes stays below 16 times its size.
  void grow(uint64_t fileBytes) { left_ += 16 * fileBytes; }
  void charge(uint64_t bytes, const Json& where) {
    if (bytes > left_) where.fail("asks for far more data than the file holds", "export the scene again");
    left_ -= bytes;
  }

 private:
  uint64_t left_ = uint64_t(1) << 28;  // room for small files that use the same data many times
};

// `buffers`, `bufferViews` and `uri`s of a file.
class Buffers {
 public:
  Buffers(const Json& root, std::optional<Bytes> binary, std::filesystem::path folder, size_t fileBytes);

  // The bytes of the buffer view whose index stands at `use`, decompressed; its stride (0: none), and its offset in the
  // buffer.
  Bytes view(const Json& use, size_t* stride = nullptr, uint64_t* offset = nullptr);
  // What a `uri` stands for: data, or a file in the scene's folder or below.
  Bytes uri(const Json& uri);

  // The files that `uri`s have led to so far, in order, each once; also those that could not be read.
  const std::vector<std::filesystem::path>& files() const { return files_; }

  Budget budget;
  // Of the scene and the files that it has made us read so far.
  uint64_t fileBytes() const { return fileBytes_; }

 private:
  void grow(uint64_t bytes);
  Bytes buffer(const Json& use);
  Bytes part(const Json& use, const Json& json, size_t view);
  Bytes decompressed(const Json& use, const Json& extension, size_t view);

  JsonArray buffers_, views_;
  std::vector<std::optional<Bytes>> loaded_;    // by buffer, when first used
  std::vector<std::optional<Bytes>> unpacked_;  // by buffer view, of those that are compressed
  std::optional<Bytes> binary_;
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> files_;
  uint64_t fileBytes_ = 0;
};

}  // namespace wardmis
