// SPDX-License-Identifier: GPL-3.0-or-later
#include "gltf/mesh.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

#include "gltf/draco.h"

namespace wardmis {
namespace {

constexpr const char* kExportAgain = "export the scene again";
constexpr size_t kGrain = 1 << 15;
constexpr uint64_t kMostTriangles = uint64_t(1) << 31;

enum Mode { kPoints = 0, kLines = 1, kTriangles = 4, kStrip = 5, kFan = 6 };

// 0, 1, 2, ...: what a primitive without indices means.
Array<uint32_t> consecutive(size_t n) {
  std::vector<uint32_t> out(n);
  tbb::parallel_for(tbb::blocked_range<size_t>(0, n, kGrain), [&](const auto& range) {
    std::iota(out.begin() + range.begin(), out.begin() + range.end(), static_cast<uint32_t>(range.begin()));
  });
  return Array<uint32_t>::of(std::move(out));
}

// What points and lines are to be rendered as; none where the file does not say.
std::optional<Form> formOf(const Json& primitive, uint64_t mode) {
  const auto extension = primitive.extension("WARDMIS_scene");
  const auto shape = extension ? extension->find("shape") : std::nullopt;
  if (!shape) return std::nullopt;
  constexpr std::pair<std::string_view, Form> kOfLines[] = {
      {"ribbons", Form::kRibbons}, {"tubes", Form::kTubes}, {"cones", Form::kCones}};
  constexpr std::pair<std::string_view, Form> kOfPoints[] = {{"spheres", Form::kSpheres}};
  if (mode != kLines && mode != kPoints)
    primitive.fail("has a shape, which is for lines (mode 1) and points (mode 0)", kExportAgain);
  return mode == kLines ? shape->choice(kOfLines) : shape->choice(kOfPoints);
}

// The triangles of a strip or a fan; every second one of a strip is turned so that all face the same way.
Array<uint32_t> unrolled(const Array<uint32_t>& in, Mode mode) {
  std::vector<uint32_t> out;
  out.reserve(3 * (in.size() - 2));
  for (size_t i = 0; i + 2 < in.size(); i++) {
    const bool odd = mode == kStrip && i % 2 == 1;
    const size_t first = mode == kFan ? 0 : i;
    out.insert(out.end(), {in[first], in[i + (odd ? 2 : 1)], in[i + (odd ? 1 : 2)]});
  }
  return Array<uint32_t>::of(std::move(out));
}

// The file's attributes that a program reads, in its order.
ProgramVertices programVertices(const Json& primitive, const Json& attributes, const Program& program) {
  const auto extension = primitive.extension("WARDMIS_scene");
  const JsonArray sets = extension ? extension->array("uvSets") : JsonArray(primitive);
  const auto uvs = [&](const std::string& name) {
    if (name.empty()) return std::string("TEXCOORD_0");
    for (size_t i = 0; i < sets.size(); i++)
      if (sets[i].string() == name) return fmt::format("TEXCOORD_{}", i);
    return name.starts_with("TEXCOORD_") ? name : std::string();
  };
  const auto exists = [&](const std::string& key) { return !key.empty() && attributes.find(key).has_value(); };
  ProgramVertices out;
  for (const ProgramAttribute& a : program.attributes) {
    std::string key;
    if (a.kind == ProgramAttribute::Kind::kUvs) {
      key = uvs(a.name);
    } else if (a.kind == ProgramAttribute::Kind::kNamed) {
      key = a.name.starts_with("COLOR_") ? a.name : "_" + a.name;
    } else {
      key = "_TANGENT_" + a.name;
      if (a.name.empty() || (!exists(key) && uvs(a.name) == "TEXCOORD_0")) key = "TANGENT";
      if (!exists(key)) key = uvs(a.name);  // the triangles' own are computed from these
    }
    out.names.push_back(exists(key) ? key : std::string());
  }
  if ((program.reads & kReadsGenerated) != 0 && exists("_GENERATED")) out.generated = "_GENERATED";
  return out;
}

// Not negative, and not so large that the renderer would drop a curve or a sphere.
Array<float> readRadii(Accessors& accessors, const Json& use, const Array<Vec3f>& positions) {
  constexpr float kLargest = 1e18f;  // Embree ignores what reaches further
  const FloatArray radii = accessors.readFloats(use, nullptr);
  if (radii.components != 1) use.failExpected("elements of one number");
  for (size_t i = 0; i < radii.data.size(); i++) {
    const float r = radii.data[i];
    if (r < 0) use.fail(fmt::format("radius {} is {}, less than 0", i, r), kExportAgain);
    const Vec3f p = positions[i];
    if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) + r > kLargest)
      use.fail(fmt::format("point {} reaches further than 10^18 metres", i), "scale it down");
  }
  return radii.data;
}

// Names the accessors of all that is wanted.
std::vector<size_t> keyOf(const ProgramVertices& wanted, const Json& attributes) {
  std::vector<size_t> key{wanted.names.size()};
  for (const std::string& name : wanted.names)
    key.push_back(name.empty() ? SIZE_MAX : attributes.at(name).index(SIZE_MAX, "accessors"));
  if (!wanted.generated.empty()) key.push_back(attributes.at(wanted.generated).index(SIZE_MAX, "accessors"));
  return key;
}

}  // namespace

Meshes::Meshes(const Json& root, Accessors& accessors, Buffers& buffers, Materials& materials, LeftOut& leftOut)
    : meshes_(root.array("meshes")),
      accessors_(accessors),
      buffers_(buffers),
      materials_(materials),
      leftOut_(leftOut) {}

int Meshes::use(const Json& use) {
  const size_t i = use.index(meshes_.size(), "meshes");
  const auto [entry, isNew] = meshOf_.try_emplace(i, -1);
  if (isNew) {
    Mesh mesh = read(meshes_[i]);
    if (!mesh.parts.empty()) {
      read_.push_back(std::move(mesh));
      entry->second = static_cast<int>(read_.size() - 1);
    }
  }
  return entry->second;
}

Mesh Meshes::read(const Json& json) {
  Mesh mesh;
  mesh.name = json.name();
  const JsonArray primitives = json.at("primitives").array();
  if (primitives.size() == 0) json.at("primitives").failExpected("at least one primitive");

  // Primitives with the same vertex arrays become one part.
  std::map<std::tuple<size_t, size_t, size_t, size_t, std::vector<size_t>>, size_t> partOf;
  for (size_t i = 0; i < primitives.size(); i++) {
    const Json primitive = primitives[i];
    const auto mode = primitive.integerOr("mode", kTriangles, 0, 6);
    const std::optional<Form> form = formOf(primitive, mode);
    if (mode < kTriangles && !form) {
      leftOut_.add("points and lines of mesh " + json.described(), "they have no shape, and so no thickness");
      continue;
    }
    const auto attributes = primitive.find("attributes");
    const auto position = attributes ? attributes->find("POSITION") : std::nullopt;
    if (!position) {
      leftOut_.add("a primitive of mesh " + json.described(), "it has no POSITION");
      continue;
    }
    if (primitive.find("targets"))
      leftOut_.add("morph targets of mesh " + json.described(), "the base shape is rendered");

    const int material = materials_.use(primitive), looked = materials_.uvSet(material);
    const int set = looked < 0 && keepUvs_ && attributes->find("TEXCOORD_0") ? 0 : looked;
    const std::string uvName = set < 0 ? "" : fmt::format("TEXCOORD_{}", set);
    const auto normal = form ? std::nullopt : attributes->find("NORMAL"),
               uv = set < 0 ? std::nullopt : attributes->find(uvName);
    const auto lacks = [&](const std::string& name) {
      leftOut_.add(fmt::format("textures and direction of anisotropy of {} on primitive {} of mesh {}",
                               materials_.described(material), i, json.described()),
                   fmt::format("it has no {}: textures are looked up at (0, 0)", name));
    };
    if (set >= 0 && !uv) lacks(uvName);
    const auto radius = form ? attributes->find("_RADIUS") : std::nullopt;
    if (form && !radius) attributes->fail("has no _RADIUS, which curves and spheres need", kExportAgain);
    const auto draco = form ? std::nullopt : primitive.extension("KHR_draco_mesh_compression");
    const Program* program = materials_.program(material);
    const ProgramVertices wanted =
        program && !draco ? programVertices(primitive, *attributes, *program) : ProgramVertices{};
    if (program && !draco && !primitive.extension("WARDMIS_scene"))  // whose exporter names what a mesh lacks
      for (const ProgramAttribute& a : program->attributes)
        if (const std::string name = a.name.empty() ? "TEXCOORD_0" : a.name;
            a.kind == ProgramAttribute::Kind::kUvs && !attributes->find(name))
          lacks(name);
    const size_t vertices = draco ? 0 : accessors_.count(*position);
    attributes->forEachMember([&](std::string_view key, const Json& use) {
      if (!draco && key != "POSITION") accessors_.checkAttribute(use, key, vertices);
      if (form && key == "_RADIUS") return;
      if (key == wanted.generated || std::ranges::find(wanted.names, key) != wanted.names.end()) return;
      if (key == "COLOR_0")
        leftOut_.add("vertex colours of mesh " + json.described() + " with " + materials_.described(material),
                     "the renderer does not use them");
      else if (key.starts_with("TEXCOORD_") && set < 0)
        leftOut_.addUnneeded("vertex attribute " + cleaned(key), "no texture and no anisotropy needs it there");
      else if (key != "POSITION" && key != "NORMAL" && key != uvName)
        leftOut_.addUnneeded("vertex attribute " + cleaned(key), "the renderer does not use it");
    });

    const auto mended = [&](size_t count) {
      if (count > 0)
        leftOut_.add(fmt::format("{} normals or texture coordinates of mesh {}", count, json.described()),
                     "they are not finite: 0 is used, and the face's own normal where all are so");
    };
    if (draco && (hasDraco() || !accessors_.hasData(*position))) {
      DracoPrimitive decoded = readDraco(*draco, uvName, buffers_);
      mended(decoded.mended);
      MeshPart part{decoded.positions, decoded.normals, turned(decoded.uvs, *position), {}, {}, {}, {}, {}, {}};
      Array<uint32_t> indices = triangles(primitive, part.positions, *position, &decoded.indices);
      if (indices.empty()) continue;
      part.primitives.push_back({material, std::move(indices)});
      mesh.parts.push_back(std::move(part));
      continue;
    }

    constexpr size_t kNone = SIZE_MAX, kAny = SIZE_MAX;
    const auto key =
        std::make_tuple(position->index(kAny, "accessors"), normal ? normal->index(kAny, "accessors") : kNone,
                        radius ? radius->index(kAny, "accessors") : kNone, uv ? uv->index(kAny, "accessors") : kNone,
                        keyOf(wanted, *attributes));
    const auto [entry, isNewPart] = partOf.try_emplace(key, mesh.parts.size());
    if (isNewPart) {
      MeshPart part;
      part.positions = accessors_.read<Vec3f>(*position);
      size_t bad = 0;
      if (normal) part.normals = accessors_.read<Vec3f>(*normal, &bad);
      if (radius) part.radii = readRadii(accessors_, *radius, part.positions);
      if (uv) part.uvs = turned(accessors_.read<Vec2f>(*uv, &bad), *uv);
      readProgramVertices(wanted, *attributes, part, bad);
      mended(bad);
      mesh.parts.push_back(std::move(part));
    }
    MeshPart& part = mesh.parts[entry->second];
    if (form) {
      if (const auto own = primitive.extension("WARDMIS_scene"); own && own->find("motion"))
        leftOut_.add("motion of curves and spheres of mesh " + json.described(), "they keep their shapes");
      part.primitives.push_back(strands(primitive, *form, *position, part));
      part.primitives.back().material = material;
      continue;
    }
    if (const auto own = primitive.extension("WARDMIS_scene"); isNewPart && own)
      if (const auto motion = own->find("motion")) readMotion(*motion, part);
    Array<uint32_t> indices = triangles(primitive, part.positions, *position, nullptr);
    if (!indices.empty()) part.primitives.push_back({material, std::move(indices)});
  }
  std::erase_if(mesh.parts, [](const MeshPart& part) { return part.primitives.empty(); });
  return mesh;
}

Primitive Meshes::strands(const Json& primitive, Form form, const Json& position, const MeshPart& part) {
  const bool lines = form != Form::kSpheres;
  const auto json = primitive.find("indices");
  const Json place = json ? *json : position;
  const Array<uint32_t> file = json ? accessors_.read<uint32_t>(*json) : consecutive(part.positions.size());
  if (lines && file.size() % 2 != 0) place.fail(fmt::format("has {} ends of segments: they are no pairs", file.size()));
  const size_t count = lines ? file.size() / 2 : file.size(), vertices = part.positions.size();
  triangles_ += count;
  if (triangles_ > kMostTriangles) place.fail("the scene has more than 2^31 triangles and segments", "split the scene");
  // what is built of it: its number and its curve's, and up to four points
  buffers_.budget.charge(count * (2 * sizeof(uint32_t) + (lines ? 5 : 2) * 4 * sizeof(float)), place);
  Primitive out;
  out.form = form;
  if (const auto extension = primitive.extension("WARDMIS_scene")) {
    out.pieces = static_cast<int>(extension->integerOr("pieces", 5, 1, 16));
    out.inside = extension->booleanOr("inside", false);
  }
  std::vector<uint32_t> indices(count);
  for (size_t i = 0; i < count; i++) {
    const uint32_t k = file[lines ? 2 * i : i];
    if (k >= vertices - (lines ? 1 : 0))
      place.fail(
          fmt::format("{} {} begins at point {}, but there are {}", lines ? "segment" : "sphere", i, k, vertices),
          kExportAgain);
    if (lines && file[2 * i + 1] != k + 1)
      place.fail(fmt::format("segment {} goes from point {} to {}, and not to the next one", i, k, file[2 * i + 1]),
                 kExportAgain);
    indices[i] = k;
  }
  out.indices = Array<uint32_t>::of(std::move(indices));
  return out;
}

// Positions, and normals where the part has any, at equal steps of the shutter's time.
void Meshes::readMotion(const Json& json, MeshPart& part) {
  const auto read = [&](std::string_view key, std::vector<Array<Vec3f>>& out, size_t expected) {
    const Json list = json.at(key);
    const JsonArray steps = list.array();
    if (steps.size() < 2 || steps.size() > 129 || (expected != 0 && steps.size() != expected))
      list.failExpected(expected != 0 ? fmt::format("{} accessors, as many as positions", expected)
                                      : std::string("2 to 129 accessors"));
    for (size_t i = 0; i < steps.size(); i++) {
      out.push_back(accessors_.read<Vec3f>(steps[i]));
      if (out.back().size() != part.positions.size())
        steps[i].fail(
            fmt::format("has {} elements, but the primitive {} vertices", out.back().size(), part.positions.size()),
            kExportAgain);
    }
  };
  read("positions", part.movedPositions, 0);
  if (!part.normals.empty()) read("normals", part.movedNormals, part.movedPositions.size());
}

// v = 0 at the bottom, where the file has it at the top.
Array<Vec2f> Meshes::turned(const Array<Vec2f>& file, const Json& place) {
  if (file.empty()) return {};
  buffers_.budget.charge(file.size() * sizeof(Vec2f), place);
  std::vector<Vec2f> out(file.size());
  tbb::parallel_for(tbb::blocked_range<size_t>(0, file.size(), kGrain), [&](const auto& range) {
    for (size_t k = range.begin(); k < range.end(); k++) out[k] = {file[k].x, 1 - file[k].y};
  });
  return Array<Vec2f>::of(std::move(out));
}

void Meshes::readProgramVertices(const ProgramVertices& wanted, const Json& attributes, MeshPart& part, size_t& bad) {
  for (const std::string& name : wanted.names) {
    VertexAttribute& out = part.attributes.emplace_back();
    if (name.empty()) continue;
    const Json use = attributes.at(name);
    if (name.starts_with("TEXCOORD_")) {
      const Array<Vec2f> uvs = turned(accessors_.read<Vec2f>(use, &bad), use);
      out = {{{&uvs.data.data()->x, 2 * uvs.size()}, uvs.owner}, 2};
    } else {
      const FloatArray values = accessors_.readFloats(use, &bad);
      if (values.components == 0) use.failExpected("elements of one to four numbers");
      if (name.ends_with("TANGENT") && values.components != 4) use.failExpected("tangents of four numbers");
      out = {values.data, values.components};
    }
  }
  if (!wanted.generated.empty()) part.generated = accessors_.read<Vec3f>(attributes.at(wanted.generated), &bad);
}

Array<uint32_t> Meshes::triangles(const Json& primitive, const Array<Vec3f>& positions, const Json& position,
                                  const Array<uint32_t>* decoded) {
  const auto json = primitive.find("indices");
  const Json place = json && !decoded ? *json : position;
  const Mode mode = decoded ? kTriangles : static_cast<Mode>(primitive.integerOr("mode", kTriangles, 0, 6));
  Array<uint32_t> indices;
  if (decoded)
    indices = *decoded;
  else if (json)
    indices = accessors_.read<uint32_t>(*json);
  size_t count = decoded || json ? indices.size() : positions.size();
  const size_t rest = count < 3 ? count : mode == kTriangles ? count % 3 : 0;
  if (rest > 0) {
    leftOut_.add(fmt::format("the last {} of {} vertices of {}", rest, count, primitive.path()),
                 "they make no whole triangle");
    count -= rest;
    if (count == 0) return {};
    if (!indices.empty()) indices.data = indices.data.first(count);
  }
  const size_t triangles = mode == kTriangles ? count / 3 : count - 2;
  triangles_ += triangles;
  if (triangles_ > kMostTriangles) place.fail("the scene has more than 2^31 triangles", "split the scene");
  buffers_.budget.charge(triangles * 3 * sizeof(uint32_t), place);

  if (indices.empty()) indices = consecutive(count);
  if (mode != kTriangles) indices = unrolled(indices, mode);
  return withoutDegenerate(place, std::move(indices), positions.data);
}

Array<uint32_t> Meshes::withoutDegenerate(const Json& place, Array<uint32_t> indices,
                                          std::span<const Vec3f> positions) {
  using Range = tbb::blocked_range<size_t>;
  const uint32_t largest = tbb::parallel_reduce(
      Range(0, indices.size(), kGrain), uint32_t(0),
      [&](const Range& range, uint32_t most) {
        for (size_t i = range.begin(); i < range.end(); i++) most = std::max(most, indices[i]);
        return most;
      },
      [](uint32_t a, uint32_t b) { return std::max(a, b); });
  if (largest >= positions.size())
    place.fail(fmt::format("refers to vertex {}, but there are {}", largest, positions.size()), kExportAgain);

  // A triangle is kept if its normal can be computed in single precision, as the renderer does.
  const auto squaredArea = [&](size_t t) {
    const Vec3f a = positions[indices[3 * t]], b = positions[indices[3 * t + 1]], c = positions[indices[3 * t + 2]];
    const Vec3f n = cross(b - a, c - a);
    return dot(n, n);
  };
  const auto isGood = [](float area2) { return (area2 > 0) & (area2 <= FLT_MAX); };
  const std::vector<uint32_t> bad = tbb::parallel_reduce(
      Range(0, indices.size() / 3, kGrain), std::vector<uint32_t>(),
      [&](const Range& range, std::vector<uint32_t> list) {
        for (size_t t = range.begin(); t < range.end(); t++)
          if (!isGood(squaredArea(t))) list.push_back(static_cast<uint32_t>(t));
        return list;
      },
      [](std::vector<uint32_t> a, const std::vector<uint32_t>& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
      });
  if (bad.empty()) return indices;
  std::vector<uint32_t> kept;
  kept.reserve(indices.size() - 3 * bad.size());
  size_t from = 0;
  for (const size_t t : bad) {
    if (!(squaredArea(t) <= FLT_MAX))
      place.fail(fmt::format("triangle {} is too large for single precision", t),
                 "scale it down: at most 9 * 10^18 square metres can be used");
    kept.insert(kept.end(), indices.data.begin() + from, indices.data.begin() + 3 * t);
    from = 3 * t + 3;
  }
  kept.insert(kept.end(), indices.data.begin() + from, indices.data.end());
  degenerate_ += bad.size();
  return Array<uint32_t>::of(std::move(kept));
}

void Meshes::finish(Scene& scene) {
  scene.meshes = std::move(read_);
  scene.degenerateTriangles = degenerate_;
  const size_t unused = meshes_.size() - meshOf_.size();
  if (unused > 0) leftOut_.addUnneeded(std::to_string(unused) + " meshes", "no object of the scene uses them");
}

}  // namespace wardmis
