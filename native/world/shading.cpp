// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/shading.h"

#include <algorithm>
#include <cmath>

#include "program/vectors.h"
#include "world/panorama.h"

namespace wardmis {
namespace {

constexpr float kEndless = 3.4e38f;  // length of a ray that meets nothing

// From the file's axes of the world to those that the scene is told in. Object space is the mesh's own in both.
struct FrameOf {
  bool zUp;
  Vec3f operator()(Vec3f v) const { return zUp ? Vec3f{v.x, -v.z, v.y} : v; }
  Affine operator()(const Affine& m) const {
    const auto& f = *this;
    return {f(m.x), f(m.y), f(m.z), f(m.t)};
  }
};

// A quantity that is linear over a triangle, and its steps.
struct Linear {
  float u, v, dux, dvx, duy, dvy;

  template <class T>
  T value(T a, T b, T c) const {
    return a + (b - a) * u + (c - a) * v;
  }
  template <class T>
  T dx(T a, T b, T c) const {
    return (b - a) * dux + (c - a) * dvx;
  }
  template <class T>
  T dy(T a, T b, T c) const {
    return (b - a) * duy + (c - a) * dvy;
  }
  Varying of(Vec3f a, Vec3f b, Vec3f c) const { return {value(a, b, c), dx(a, b, c), dy(a, b, c)}; }
};

// The size of a pixel of the image where a path of this length meets something.
float pixelSize(const Scene& scene, const ShadedPoint& p) {
  if (!scene.camera) return 1e-3f * p.rayLength;
  const Camera& c = *scene.camera;
  if (c.panoramic()) {
    const Vec3f view{-dot(p.wo, c.toWorld.x), -dot(p.wo, c.toWorld.y), -dot(p.wo, c.toWorld.z)};
    const Vec2f at = panoramaPoint(c, p.path.depth == 0 ? view : Vec3f{0, 0, -1});
    return panoramaPixel(c, scene.film, at) * (p.path.before + p.rayLength);
  }
  const float w = (c.right - c.left) / static_cast<float>(scene.film.width),
              h = (c.top - c.bottom) / static_cast<float>(scene.film.height);
  if (c.orthographic()) return 0.5f * (w + h);
  float spread = 0.5f * (w + h);
  if (p.path.depth == 0) {  // as directions turn from one pixel to the next
    const float x = dot(p.wo, c.toWorld.x), y = dot(p.wo, c.toWorld.y), z = std::abs(dot(p.wo, c.toWorld.z));
    const auto turn = [](float step, float along) { return step * std::sqrt(std::max(0.0f, 1 - along * along)); };
    spread = 0.5f * z * (turn(w, x) + turn(h, y));
  }
  return spread * (p.path.before + p.rayLength);
}

// Two directions orthogonal to each other and to n: Cycles' choice, in the scene's frame.
void orthonormals(Vec3f n, Vec3f& a, Vec3f& b) {
  a = n.x != n.y || n.x != n.z ? Vec3f{n.z - n.y, n.x - n.z, n.y - n.x} : Vec3f{n.z - n.y, n.x + n.z, -n.y - n.x};
  a = normalize(a);
  b = cross(n, a);
}

// Barycentric steps of a step d in the plane of the edges.
void barycentric(Vec3f e1, Vec3f e2, Vec3f d, float& du, float& dv) {
  const float g11 = dot(e1, e1), g12 = dot(e1, e2), g22 = dot(e2, e2), b1 = dot(e1, d), b2 = dot(e2, d);
  const float det = g11 * g22 - g12 * g12;
  if (g22 == 0) {  // along a curve
    du = g11 > 0 ? b1 / g11 : 0, dv = 0;
    return;
  }
  du = det > 0 ? (g22 * b1 - g12 * b2) / det : 0;
  dv = det > 0 ? (g11 * b2 - g12 * b1) / det : 0;
}

// The tangent and its sign along increasing u of the UVs of one triangle, in object space.
AttributeValue ownTangent(const float* uv0, const float* uv1, const float* uv2, Vec3f e1, Vec3f e2) {
  const float du1 = uv1[0] - uv0[0], dv1 = uv1[1] - uv0[1], du2 = uv2[0] - uv0[0], dv2 = uv2[1] - uv0[1];
  const float area = du1 * dv2 - du2 * dv1;
  AttributeValue out;
  const Vec3f t = (e1 * dv2 - e2 * dv1) * std::copysign(1.0f, area);
  const float l = length(t);
  if (!(l > 0)) return out;
  out.xyz = {t / l, {}, {}};
  out.w[0] = area < 0 ? -1.0f : 1.0f;
  out.components = 4;
  return out;
}

void fillAttributes(const ShadedPoint& p, const Program& program, const uint32_t* i, const Linear& at, Vec3f e1,
                    Vec3f e2, ShadingContext& c) {
  const MeshPart& part = *p.shape.part;
  for (size_t k = 0; k < program.attributes.size(); ++k) {
    AttributeValue& out = c.attributes[k];
    const ProgramAttribute& wanted = program.attributes[k];
    const bool tangents = wanted.kind == ProgramAttribute::Kind::kTangents;
    out.components = 0;
    const VertexAttribute* a = k < part.attributes.size() ? &part.attributes[k] : nullptr;
    if (a != nullptr && a->components > 0) {
      const auto n = static_cast<size_t>(a->components);
      const float *v0 = &a->data.data[n * i[0]], *v1 = &a->data.data[n * i[1]], *v2 = &a->data.data[n * i[2]];
      if (tangents && n == 2) {
        out = ownTangent(v0, v1, v2, e1, e2);
        continue;
      }
      float value[4] = {0, 0, 0, 0}, dx[4] = {0, 0, 0, 0}, dy[4] = {0, 0, 0, 0};
      for (size_t j = 0; j < n; ++j) {
        value[j] = at.value(v0[j], v1[j], v2[j]);
        dx[j] = at.dx(v0[j], v1[j], v2[j]);
        dy[j] = at.dy(v0[j], v1[j], v2[j]);
      }
      out.xyz = {{value[0], value[1], value[2]}, {dx[0], dx[1], dx[2]}, {dy[0], dy[1], dy[2]}};
      out.w[0] = value[3], out.w[1] = dx[3], out.w[2] = dy[3];
      out.components = static_cast<uint8_t>(n);
    } else if (wanted.kind == ProgramAttribute::Kind::kNamed && p.placement.object != nullptr) {
      const auto& list = p.placement.object->attributes;
      const auto found =
          std::ranges::lower_bound(list, wanted.name, {}, [](const auto& e) -> const std::string& { return e.first; });
      if (found == list.end() || found->first != wanted.name) continue;
      const float* v = found->second.numbers;
      out.xyz = {{v[0], v[1], v[2]}, {}, {}};
      out.w[0] = v[3], out.w[1] = out.w[2] = 0;
      out.components = static_cast<uint8_t>(found->second.components);
    }
  }
}

void fillCamera(const Scene& scene, const Program& program, ShadingContext& c) {
  if ((program.reads & kReadsCamera) == 0 || !scene.camera) return;
  const FrameOf frame{scene.zUp};
  const Camera& camera = *scene.camera;
  const Affine& m = camera.toWorld;
  c.camera = {frame(m.x), frame(m.y), -frame(m.z), frame(m.t)};
  c.orthographic = camera.orthographic();
  // of the whole frame, whatever part of it is rendered: a border changes no picture
  c.window[0] = camera.left, c.window[1] = camera.right, c.window[2] = camera.bottom, c.window[3] = camera.top;
  if (camera.panoramic()) {
    // steps of a pixel, not of a derivative: that is what a shift asks for
    const auto seen = [&](Vec3f at) {
      const Vec3f q = vectors::inversePoint(c.camera, c.isObject ? at : at + c.camera.t);
      const Vec2f v = panoramaPoint(camera, safeNormalize(Vec3f{q.x, q.y, -q.z}));
      return Vec3f{(v.x - c.window[0]) / (c.window[1] - c.window[0]), (v.y - c.window[2]) / (c.window[3] - c.window[2]),
                   0};
    };
    c.panoramic = true;
    c.panorama.value = seen(c.position.value);
    c.panorama.dx = seen(c.position.value + c.position.dx) - c.panorama.value;
    c.panorama.dy = seen(c.position.value + c.position.dy) - c.panorama.value;
  }
}

void fill(const Scene& scene, const ShadedPoint& p, const Program& program, ShadingContext& c) {
  const FrameOf frame{scene.zUp};
  const MeshPart& part = *p.shape.part;
  const bool strand = p.shape.strands != nullptr;
  uint32_t ends[3];
  if (strand) endsOf(*p.shape.primitive, p.triangle, ends);
  const uint32_t* i = strand ? ends : p.shape.indices + 3 * size_t{p.triangle};
  c.position = {frame(p.position), {}, {}};
  c.normal = frame(p.normal);
  c.trueNormal = frame(p.geometric);
  c.incoming = frame(p.wo);
  c.backfacing = p.turned;
  c.onCurve = isCurve(p.shape);
  c.materialIndex = scene.materials[static_cast<size_t>(p.shape.material)].index;

  Linear at{p.u, strand ? 0 : p.v, 0, 0, 0, 0};  // along a curve from one end of its segment to the other
  if ((program.reads & kReadsShift) != 0) {
    const float size = pixelSize(scene, p);
    orthonormals(c.trueNormal, c.position.dx, c.position.dy);
    c.position.dx *= size;
    c.position.dy *= size;
    const Corners corner = strand ? Corners{part.positions[i[0]], part.positions[i[1]], part.positions[i[2]]}
                                  : cornersOf(p.shape, p.triangle, p.path.time);
    const auto edge = [&](size_t k) {
      const Vec3f e = corner[k] - corner[0];
      if (strand) return frame(p.placement.toWorld.vector(e));
      return frame(p.placement.flat ? e : p.placement.toWorld.vector(e));
    };
    const Vec3f e1 = edge(1), e2 = edge(2);
    barycentric(e1, e2, c.position.dx, at.dux, at.dvx);
    barycentric(e1, e2, c.position.dy, at.duy, at.dvy);
    if (p.turned)  // seen from behind, Cycles turns the edges round, too: what is told by vertices is shifted backwards
      at.dux = -at.dux, at.dvx = -at.dvx, at.duy = -at.duy, at.dvy = -at.dvy;
  }
  c.parametric = at.of({1, 0, 0}, {0, 1, 0}, {0, 0, 0});
  if (strand) c.parametric = {{p.u, p.v, 0}, {at.dux, 0, 0}, {at.duy, 0, 0}};
  // the mesh's own positions, whether the placement is flat or not
  const auto [o0, o1, o2] = p.shape.motion != nullptr
                                ? cornersOf(p.shape, p.triangle, p.path.time)
                                : Corners{part.positions[i[0]], part.positions[i[1]], part.positions[i[2]]};
  if ((program.reads & kReadsAttributes) != 0) {
    c.interpolatedNormal = part.normals.empty() ? safeNormalize(cross(o1 - o0, o2 - o0))
                                                : at.value(part.normals[i[0]], part.normals[i[1]], part.normals[i[2]]);
    fillAttributes(p, program, i, at, o1 - o0, o2 - o0, c);
  }
  if ((program.reads & kReadsGenerated) != 0) {
    if (!part.generated.empty()) {
      const Array<Vec3f>& g = part.generated;
      c.generated = at.of(g[i[0]], g[i[1]], g[i[2]]);
    } else {
      c.generated = at.of(o0, o1, o2);
      if (const ObjectData* data = p.placement.object; data != nullptr && data->hasGenerated) {
        const float* g = data->generated;
        const auto turned = [g](Vec3f v) {
          return Vec3f{g[0] * v.x + g[1] * v.y + g[2] * v.z, g[4] * v.x + g[5] * v.y + g[6] * v.z,
                       g[8] * v.x + g[9] * v.y + g[10] * v.z};
        };
        c.generated = {turned(c.generated.value) + Vec3f{g[3], g[7], g[11]}, turned(c.generated.dx),
                       turned(c.generated.dy)};
      }
    }
  }
  if ((program.reads & kReadsObject) != 0) {
    c.toWorld = frame(p.placement.toWorld);
    const ObjectData* data = p.placement.object;
    if (!part.radii.empty() && part.generated.empty() && (data == nullptr || !data->hasGenerated))
      c.generated = {vectors::inversePoint(c.toWorld, c.position.value), c.toWorld.inverseVector(c.position.dx),
                     c.toWorld.inverseVector(c.position.dy)};  // on the curve or sphere itself
    if (data != nullptr) {
      std::copy_n(data->color, 4, c.color);
      c.index = data->index;
      c.random = data->random;
    }
  }
  fillCamera(scene, program, c);
  c.path = p.path;
  c.rayLength = p.rayLength;
  if (p.path.depth == 0 && scene.camera) {  // rays of the camera begin at its near plane, as Cycles' do
    const float depth = scene.camera->panoramic() ? 1 : std::abs(dot(p.wo, scene.camera->toWorld.z));
    c.rayLength -= depth > 0 ? scene.camera->clipNear / depth : 0;
  }
}

}  // namespace

Vec3f runProgram(const Scene& scene, const ShadedPoint& point, Slots& slots) {
  const Program& program = *scene.materials[static_cast<size_t>(point.shape.material)].program;
  ShadingContext context;
  fill(scene, point, program, context);
  run(program, context, {scene.textures.data(), scene.images.data()}, slots);
  const Vec3f n = context.normal;
  return scene.zUp ? Vec3f{n.x, n.z, -n.y} : n;
}

Rgb skyRadiance(const Scene& scene, const World& world, Vec3f direction, const SkyRay& ray) {
  const FrameOf frame{scene.zUp};
  const Program& program = *world.program;
  ShadingContext c;
  c.isObject = false;
  const Vec3f d = frame(direction);
  c.position = c.generated = {d, {}, {}};
  c.normal = c.trueNormal = c.incoming = -d;
  std::fill_n(c.color, 4, 0.0f);
  fillCamera(scene, program, c);
  c.rayOrigin = frame(ray.origin);
  c.path.kinds = ray.camera ? kCameraRay : 0;
  c.path.depth = static_cast<uint8_t>(ray.camera ? 0 : std::min(ray.bounces + 1, 255));
  c.rayLength = kEndless;
  Slots slots;
  run(program, c, {scene.textures.data(), scene.images.data()}, slots);
  return world.radiance * vectorOf(program, slots, world.result);
}

Rgb lightFactor(const Scene& scene, const Light& light, const LitPoint& point) {
  const FrameOf frame{scene.zUp};
  const Program& program = *light.program;
  ShadingContext c;
  c.position = {frame(point.position), {}, {}};
  c.normal = c.trueNormal = frame(point.normal);
  c.incoming = frame(point.direction);
  c.toWorld = frame(light.toWorld);
  c.generated = {vectors::inversePoint(c.toWorld, c.position.value), {}, {}};
  std::fill_n(c.color, 4, 0.0f);
  fillCamera(scene, program, c);
  c.path.kinds = 0;  // as of all that shines: it is looked at for rays of any kind
  c.path.depth = static_cast<uint8_t>(std::min(point.bounces + 1, 255));
  c.rayLength = point.distance;
  Slots slots;
  run(program, c, {scene.textures.data(), scene.images.data()}, slots);
  return vectorOf(program, slots, light.result);
}

Rgb emissionAt(const Scene& scene, const Placement& placement, const Shape& shape, uint32_t triangle, float u, float v,
               Vec3f from, int bounces, float time) {
  const Material& m = scene.materials[static_cast<size_t>(shape.material)];
  const MeshPart& part = *shape.part;
  const uint32_t* i = shape.indices + 3 * size_t{triangle};
  const Corners corner = Geometry::corners(placement, shape, triangle, time);
  const Vec3f a = corner[0], ab = corner[1] - a, ac = corner[2] - a;
  const Vec3f position = a + (ab * u + ac * v);
  Vec3f geometric = normalize(cross(ab, ac)), normal = geometric;
  if (!part.normals.empty()) {
    const Linear at{u, v, 0, 0, 0, 0};
    const Vec3f n = placement.toWorld.normal(at.value(part.normals[i[0]], part.normals[i[1]], part.normals[i[2]]));
    if (dot(n, n) > 0) normal = normalize(n);
  }
  const Vec3f to = from - position;
  const float distance = length(to);
  const Vec3f wo = distance > 0 ? to / distance : geometric;
  const bool away = dot(geometric, wo) < 0, turned = away != placement.mirrors();
  if (away) geometric = -geometric, normal = -normal;
  PathState path;
  path.time = time;
  path.kinds = 0;  // it is looked at by a light sample, which is a ray of no kind
  path.depth = static_cast<uint8_t>(std::min(bounces + 1, 255));
  Slots slots;
  runProgram(scene, {placement, shape, triangle, u, v, position, geometric, normal, wo, turned, path, distance}, slots);
  return m.emission.value * vectorOf(*m.program, slots, m.emission.result);
}

}  // namespace wardmis
