// SPDX-License-Identifier: GPL-3.0-or-later
#include "gltf/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>

#include "image/codecs.h"

namespace wardmis {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF's buffers are little-endian and used as they are");

constexpr const char* kExportAgain = "export the scene again";

uint32_t word(const Bytes& bytes, size_t offset) {
  uint32_t value;
  std::memcpy(&value, bytes.data.data() + offset, sizeof value);
  return value;
}

// "%20" -> " "; nullopt on a wrong escape.
std::optional<std::string> percentDecoded(std::string_view text) {
  const auto digit = [](char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
  };
  std::string out;
  out.reserve(text.size());
  for (size_t i = 0; i < text.size(); i++) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    if (i + 2 >= text.size() || digit(text[i + 1]) < 0 || digit(text[i + 2]) < 0) return std::nullopt;
    out += static_cast<char>(digit(text[i + 1]) * 16 + digit(text[i + 2]));
    i += 2;
  }
  return out;
}

// RFC 4648; nullopt if anything else than base64 is found.
std::optional<std::vector<std::byte>> base64Decoded(std::string_view text) {
  for (int i = 0; i < 2 && text.ends_with('='); i++) text.remove_suffix(1);
  std::vector<std::byte> out;
  out.reserve(text.size() / 4 * 3 + 2);
  uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    int value = -1;
    if (c >= 'A' && c <= 'Z') value = c - 'A';
    if (c >= 'a' && c <= 'z') value = c - 'a' + 26;
    if (c >= '0' && c <= '9') value = c - '0' + 52;
    if (c == '+') value = 62;
    if (c == '/') value = 63;
    if (value < 0) return std::nullopt;
    bits = bits << 6 | static_cast<uint32_t>(value);
    count += 6;
    if (count >= 8) {
      count -= 8;
      out.push_back(static_cast<std::byte>(bits >> count & 0xFF));
    }
  }
  return count < 6 ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace

Bytes mapFile(const std::filesystem::path& path) {
  const auto fail = [&](const std::string& why) {
    throw Error(ExitCode::kFile, fmt::format("{}: cannot be opened: {}", path.string(), why), "check the path");
  };
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // non-blocking: a FIFO must not hang us
  if (file < 0) fail(std::strerror(errno));
  struct Closer {
    int file;
    ~Closer() { close(file); }
  } closer{file};
  struct stat status;
  if (fstat(file, &status) != 0) fail(std::strerror(errno));
  if (!S_ISREG(status.st_mode)) fail("it is not a regular file");
  const size_t size = static_cast<size_t>(status.st_size);
  if (size == 0) return {};
  void* memory = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
  if (memory == MAP_FAILED) fail(std::strerror(errno));
  madvise(memory, size, MADV_WILLNEED);
  return {{static_cast<const std::byte*>(memory), size},
          std::shared_ptr<const void>(memory, [size](const void* p) { munmap(const_cast<void*>(p), size); }),
          true};
}

void Bytes::drop() const {
  if (!mapped) return;
  const auto page = static_cast<uintptr_t>(sysconf(_SC_PAGESIZE)), begin = reinterpret_cast<uintptr_t>(data.data());
  const uintptr_t first = (begin + page - 1) / page * page, end = (begin + data.size()) / page * page;
  if (end > first) madvise(reinterpret_cast<void*>(first), end - first, MADV_DONTNEED);
}

GlbChunks splitGlb(const Bytes& whole, const std::string& name, LeftOut& leftOut) {
  const auto fail = [&](const std::string& what) { throw Error(ExitCode::kScene, name + ": " + what, kExportAgain); };
  const std::string_view text(reinterpret_cast<const char*>(whole.data.data()), whole.size());
  if (text.empty()) fail("is empty");
  if (!text.starts_with("glTF")) {
    const size_t first = text.find_first_not_of("\xEF\xBB\xBF \t\r\n");
    if (first == text.npos || text[first] != '{')
      fail("is neither a GLB file (which starts with 'glTF') nor a glTF file (which starts with '{')");
    return {text, std::nullopt};
  }

  constexpr uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942;
  if (whole.size() < 12) fail(fmt::format("GLB header: expected 12 bytes, found {}", whole.size()));
  if (word(whole, 4) != 2) fail(fmt::format("GLB header: expected version 2, found {}", word(whole, 4)));
  const size_t claimed = word(whole, 8);
  if (claimed > whole.size() || claimed < 12)
    fail(fmt::format("GLB header: claims {} bytes, but the file has {}", claimed, whole.size()));
  if (claimed < whole.size())
    leftOut.addUnneeded(fmt::format("the last {} bytes of the file", whole.size() - claimed),
                        "they lie behind the end that its header gives");
  const Bytes file = whole.part(0, claimed);
  GlbChunks chunks;
  int number = 0;
  for (size_t at = 12; at < file.size(); number++) {
    if (number > 0 && file.size() - at < 8) {
      leftOut.addUnneeded(fmt::format("{} bytes at the end of the file", file.size() - at), "they are no chunk");
      break;
    }
    if (file.size() - at < 8) fail(fmt::format("GLB chunk {}: its header at byte {} is cut off", number, at));
    const uint32_t length = word(file, at), type = word(file, at + 4);
    at += 8;
    if (length > file.size() - at)
      fail(fmt::format("GLB chunk {}: claims {} bytes, but {} are left in the file", number, length, file.size() - at));
    if ((type == kJson) != (number == 0))
      fail(fmt::format("GLB chunk {}: the first chunk, and only it, must be JSON", number));
    if (type == kBinary && number != 1) fail(fmt::format("GLB chunk {}: only the second chunk may be BIN", number));
    if (type == kJson) chunks.json = text.substr(at, length);
    if (type == kBinary) chunks.binary = file.part(at, length);
    at += length;
    // Some writers pad a chunk without counting that, others count and do not pad: the next header tells.
    if (length % 4 != 0) {
      leftOut.addUnneeded(fmt::format("padding of GLB chunk {}", number),
                          fmt::format("its length {} is no multiple of 4; the file is read all the same", length));
      const size_t padded = at + 4 - length % 4;
      const auto isBinary = [&](size_t from) { return from + 8 <= file.size() && word(file, from + 4) == kBinary; };
      if (!isBinary(at) && (isBinary(padded) || padded >= file.size())) at = std::min(padded, file.size());
    }
  }
  if (number == 0) fail("GLB: has no JSON chunk");
  return chunks;
}

Buffers::Buffers(const Json& root, std::optional<Bytes> binary, std::filesystem::path folder, size_t fileBytes)
    : buffers_(root.array("buffers")),
      views_(root.array("bufferViews")),
      loaded_(buffers_.size()),
      unpacked_(views_.size()),
      binary_(std::move(binary)),
      folder_(std::move(folder)) {
  grow(fileBytes);
}

void Buffers::grow(uint64_t bytes) {
  fileBytes_ += bytes;
  budget.grow(bytes);
}

Bytes Buffers::buffer(const Json& use) {
  const size_t i = use.index(buffers_.size(), "buffers");
  if (!loaded_[i]) {
    const Json json = buffers_[i];
    const auto uri = json.find("uri");
    if (!uri && (i != 0 || !binary_))
      json.fail("has no uri, and the file has no binary chunk for it", "export the scene as one .glb file");
    const Bytes bytes = uri ? this->uri(*uri) : *binary_;
    const uint64_t length = json.at("byteLength").integer(1, UINT64_MAX);
    if (length > bytes.size())
      json.fail(fmt::format("claims {} bytes, but its data has {}", length, bytes.size()), kExportAgain);
    loaded_[i] = bytes.part(0, length);
  }
  return *loaded_[i];
}

Bytes Buffers::view(const Json& use, size_t* stride, uint64_t* offset) {
  const size_t i = use.index(views_.size(), "bufferViews");
  const Json json = views_[i];
  if (stride) *stride = json.integerOr("byteStride", 0, 4, 252);
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
    if (const auto extension = json.extension(name)) {
      if (offset) *offset = 0;
      return decompressed(use, *extension, i);
    }
  if (offset) *offset = json.integerOr("byteOffset", 0, 0, UINT64_MAX);
  return part(use, json, i);
}

// What `json`, a buffer view or the compressed form of one, names of its buffer.
Bytes Buffers::part(const Json& use, const Json& json, size_t view) {
  const Bytes bytes = buffer(json.at("buffer"));
  const uint64_t offset = json.integerOr("byteOffset", 0, 0, UINT64_MAX);
  const uint64_t length = json.at("byteLength").integer(1, UINT64_MAX);
  if (offset > bytes.size() || length > bytes.size() - offset)
    use.fail(fmt::format("bufferView {} has {} bytes from byte {} on, but its buffer has {} bytes", view, length,
                         offset, bytes.size()),
             kExportAgain);
  return bytes.part(offset, length);
}

// EXT_meshopt_compression; without the library what the file holds for such readers, if it does.
Bytes Buffers::decompressed(const Json& use, const Json& extension, size_t i) {
  if (unpacked_[i]) return *unpacked_[i];
  if (!codecs().meshopt) {
    const Json fallback = buffers_[views_[i].at("buffer").index(buffers_.size(), "buffers")];
    if (fallback.find("uri") || (binary_ && views_[i].at("buffer").integer(0, UINT64_MAX) == 0))
      return part(use, views_[i], i);
    use.fail(fmt::format("bufferView {} is compressed by meshoptimizer, and {}", i, codecMissing("meshoptimizer")),
             "build the command where it is installed (libmeshoptimizer-dev), or export without compression");
  }
  constexpr std::pair<std::string_view, MeshoptMode> kModes[] = {
      {"ATTRIBUTES", kMeshoptAttributes}, {"TRIANGLES", kMeshoptTriangles}, {"INDICES", kMeshoptIndices}};
  constexpr std::pair<std::string_view, MeshoptFilter> kFilters[] = {{"NONE", kMeshoptNone},
                                                                     {"OCTAHEDRAL", kMeshoptOctahedral},
                                                                     {"QUATERNION", kMeshoptQuaternion},
                                                                     {"EXPONENTIAL", kMeshoptExponential}};
  const Bytes packed = part(use, extension, i);
  const MeshoptMode mode = extension.at("mode").choice(kModes);
  const auto filter = extension.find("filter");
  const uint64_t count = extension.at("count").integer(1, UINT32_MAX),
                 stride = extension.at("byteStride").integer(1, 256);
  budget.grow(packed.size());  // it packs further than anything else
  budget.charge(count * stride, extension);
  auto out = std::make_shared<std::vector<std::byte>>(count * stride);
  if (const char* wrong = codecs().meshopt(mode, filter ? filter->choice(kFilters) : kMeshoptNone, packed.data.data(),
                                           packed.size(), count, stride, out->data()))
    extension.fail(fmt::format("what meshoptimizer has compressed {}", wrong), kExportAgain);
  unpacked_[i] = Bytes{*out, out};
  return *unpacked_[i];
}

Bytes Buffers::uri(const Json& json) {
  const std::string_view text = json.string();
  if (text.starts_with("data:")) {
    const size_t comma = text.find(',');
    if (comma == text.npos || !text.substr(0, comma).ends_with(";base64"))
      json.fail("expected 'data:TYPE;base64,...'", kExportAgain);
    auto bytes = base64Decoded(text.substr(comma + 1));
    if (!bytes) json.fail("its base64 data is wrong", kExportAgain);
    auto owner = std::make_shared<const std::vector<std::byte>>(std::move(*bytes));
    return {*owner, owner};
  }

  constexpr const char* kHint = "copy the file next to the scene and refer to it by its name, or export one .glb file";
  const auto relative = percentDecoded(text);
  if (!relative || relative->empty() || relative->find('\0') != std::string::npos)
    json.fail(fmt::format("'{}' is not a valid uri", cleaned(text)), kHint);
  const auto refuse = [&] {
    json.fail(fmt::format("'{}' is not a file in the scene's folder", cleaned(*relative)), kHint);
  };
  const std::filesystem::path path(*relative);
  if (folder_.empty() || path.is_absolute() || relative->find_first_of(":\\") != std::string::npos) refuse();
  for (const auto& part : path)
    if (part == "..") refuse();
  if (std::find(files_.begin(), files_.end(), folder_ / path) == files_.end()) files_.push_back(folder_ / path);
  // Symbolic links may not lead out of the folder either.
  std::error_code error;
  const auto folder = std::filesystem::canonical(folder_, error);
  const auto file = error ? path : std::filesystem::canonical(folder / path, error);
  if (error) json.fail(fmt::format("'{}' cannot be read: {}", cleaned(*relative), error.message()), kHint);
  if (std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first != folder.end()) refuse();
  try {
    Bytes bytes = mapFile(file);
    grow(bytes.size());
    return bytes;
  } catch (const Error& e) {
    json.fail(e.what(), kHint);
  }
}

}  // namespace wardmis
