# SPDX-License-Identifier: GPL-3.0-or-later
"""The direct light of a small scene file, by a program that shares nothing with the renderer: numpy, double precision, every
ray against every triangle, and no weights. The surface is sampled, one direction for each lobe, and what those rays meet is added
up; only lights too small to be met are aimed at, as points."""

import json
import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np

POINT_LIKE = 2e-5  # of the scene's extent: area lights below this size are aimed at


@dataclass
class Lamp:
    matrix: np.ndarray
    radiance: float
    size: float  # half the side of an area light, radius of a disk that faces the receiver


class Scene:
    """Triangles in world space, what they are made of, lamps, camera, sky. Grey: colours by their luminance."""

    def __init__(self, path: Path):
        data = path.read_bytes()
        length = struct.unpack_from("<I", data, 12)[0]
        self.json, self.binary = json.loads(data[20 : 20 + length]), data[28 + length :]
        root = self.json["extensions"]["WARDMIS_scene"]
        self.sky = grey(root.get("world", {"radiance": (0, 0, 0)})["radiance"])
        self.materials = [self.material(m) for m in self.json["materials"]]
        corners, normals, materials = [], [], []
        self.lamps = []
        for node, matrix in self.nodes(self.json["scenes"][self.json["scene"]]["nodes"], np.eye(4)):
            extension = node.get("extensions", {})
            if "mesh" in node:
                for m in self.instances(extension, matrix):
                    for primitive in self.json["meshes"][node["mesh"]]["primitives"]:
                        index = self.array(primitive["indices"]).reshape(-1, 3)
                        points = self.array(primitive["attributes"]["POSITION"]) @ m[:3, :3].T + m[:3, 3]
                        corners.append(points[index])
                        if "NORMAL" in primitive["attributes"]:
                            turned = self.array(primitive["attributes"]["NORMAL"]) @ np.linalg.inv(m[:3, :3])
                            normals.append(turned[index])
                        else:
                            p = corners[-1]
                            flat = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
                            normals.append(np.repeat(flat[:, None], 3, axis=1))
                        materials += [primitive["material"]] * len(index)
            if "light" in extension.get("WARDMIS_scene", {}):
                self.lamps.append(lamp(root["lights"][extension["WARDMIS_scene"]["light"]], matrix))
            if "camera" in node:
                self.eye = matrix
                camera = self.json["cameras"][node["camera"]]["extensions"]["WARDMIS_scene"]
                self.plane = camera["viewPlane"]
        self.corners, self.normals = np.concatenate(corners), np.concatenate(normals)
        self.of = np.array(materials)
        self.extent = np.ptp(self.corners.reshape(-1, 3), axis=0).max()

    def nodes(self, indices, parent):
        for i in indices:
            node = self.json["nodes"][i]
            matrix = parent @ np.reshape(node.get("matrix", np.eye(4)), (4, 4)).T
            yield node, matrix
            yield from self.nodes(node.get("children", []), matrix)

    def instances(self, extension, matrix):
        if "EXT_mesh_gpu_instancing" not in extension:
            return [matrix]
        parts = extension["EXT_mesh_gpu_instancing"]["attributes"]
        placed = []
        for t, (x, y, z, w), s in zip(*(self.array(parts[k]) for k in ("TRANSLATION", "ROTATION", "SCALE"))):
            local = np.eye(4)
            turn = [
                [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
            ]
            local[:3, :3], local[:3, 3] = np.array(turn) * s, t
            placed.append(matrix @ local)
        return placed

    def array(self, accessor):
        a = self.json["accessors"][accessor]
        view = self.json["bufferViews"][a["bufferView"]]
        kind = {5126: np.float32, 5125: np.uint32, 5123: np.uint16, 5121: np.uint8}[a["componentType"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[a["type"]]
        start = view.get("byteOffset", 0) + a.get("byteOffset", 0)
        flat = np.frombuffer(self.binary, kind, a["count"] * width, start)
        return flat.astype(np.int64 if width == 1 else np.float64).reshape(-1, width)

    def material(self, material):
        ward = material["extensions"]["WARDMIS_scene"]
        value = [grey(ward.get(k, {}).get("value", (0, 0, 0))) for k in ("diffuse", "specular", "emission")]
        return (*value, ward.get("alphaX", {"value": 1})["value"], ward.get("variant", "ward-gmd"))

    def is_point(self, a):
        return isinstance(a, Area) and a.size < POINT_LIKE * self.extent

    # ---- rays ---------------------------------------------------------------------------------------------------

    def nearest(self, origin, direction):
        """Distance (infinite: none), triangle and barycentric weights of the first triangle that each ray meets."""
        best = np.full(len(origin), np.inf)
        which = np.zeros(len(origin), int)
        weights = np.zeros((len(origin), 2))
        for i, (a, b, c) in enumerate(self.corners):
            p = np.cross(direction, c - a)
            with np.errstate(divide="ignore", invalid="ignore"):  # without area, or seen edge-on: met nowhere
                inverse = 1 / (p @ (b - a))
                to = origin - a
                u = (to * p).sum(axis=1) * inverse
                q = np.cross(to, b - a)
                v = (direction * q).sum(axis=1) * inverse
                t = (q @ (c - a)) * inverse
                met = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 1e-9 * self.extent) & (t < best) & np.isfinite(inverse)
            best[met], which[met] = t[met], i
            weights[met] = np.stack([u, v], axis=1)[met]
        return best, which, weights

    def seen(self, origin, direction):
        """Radiance that arrives along rays: lamps in front of the first triangle, its emission, or the sky."""
        t, which, _ = self.nearest(origin, direction)
        emission = np.array([m[2] for m in self.materials])[self.of[which]]
        radiance = np.where(np.isfinite(t), emission, self.sky)
        for a in self.lamps:
            if not self.is_point(a):
                radiance += a.radiance * a.met(origin, direction, t)
        return radiance

    def render(self, width, height, samples, random):
        """Luminance of `samples` camera samples of each pixel: (samples, height, width)."""
        y, x = np.indices((height, width))
        left, right, bottom, top = self.plane
        n = samples * height * width
        px = (x.ravel()[None] + random.random((samples, height * width))).ravel()
        py = (height - 1 - y.ravel()[None] + random.random((samples, height * width))).ravel()
        film = [left + px / width * (right - left), bottom + py / height * (top - bottom), np.full(n, -1.0)]
        d = unit(np.stack(film, axis=1) @ self.eye[:3, :3].T)
        o = np.broadcast_to(self.eye[:3, 3], d.shape)
        total = self.seen(o, d)
        t, which, weights = self.nearest(o, d)
        hit = np.isfinite(t)
        total[hit] += self.reflected(o[hit] + d[hit] * t[hit, None], -d[hit], which[hit], weights[hit], random)
        return total.reshape(samples, height, width)

    def reflected(self, point, wo, which, weights, random):
        corners = self.corners[which]
        ng = unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
        u, v = weights[:, :1], weights[:, 1:]
        n = self.normals[which]
        ns = unit(n[:, 0] * (1 - u - v) + n[:, 1] * u + n[:, 2] * v)
        ns *= np.where(dot(ns, ng) < 0, -1, 1)[:, None]
        side = np.where(dot(ng, wo) < 0, -1, 1)[:, None]
        ng, ns = ng * side, ns * side
        # normals that are interpolated and look away are bent towards the viewer, as the renderer does
        bent = np.maximum(1e-3 - dot(ns, wo), 0) * (np.abs(dot(ns, ng)) < 1 - 1e-12)
        ns = unit(ns + wo * bent[:, None])
        helper = np.where(np.abs(ns[:, :1]) < 0.5, [[1.0, 0, 0]], [[0, 1.0, 0]])
        tx = unit(np.cross(helper, ns))
        frame = np.stack([tx, np.cross(ns, tx), ns], axis=1)
        lo = np.einsum("nij,nj->ni", frame, wo)
        total = np.zeros(len(point))
        for number, (diffuse, specular, _, alpha, variant) in enumerate(self.materials):
            mine = self.of[which] == number
            p, o, f, g = point[mine], lo[mine], frame[mine], ng[mine]
            world = lambda d: np.einsum("nji,nj->ni", f, d)  # noqa: E731, B023
            reflected = np.zeros(len(p))
            if diffuse > 0:
                r, phi = np.sqrt(random.random(len(p))), 2 * np.pi * random.random(len(p))
                d = world(np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - r * r)], axis=1))
                reflected += diffuse * np.where(dot(d, g) > 0, self.seen(p, d), 0)
            if specular > 0:
                r, phi = alpha * np.sqrt(-np.log1p(-random.random(len(p)))), 2 * np.pi * random.random(len(p))
                h = unit(np.stack([r * np.cos(phi), r * np.sin(phi), np.ones(len(p))], axis=1))
                i = 2 * dot(h, o)[:, None] * h - o
                d = world(i)
                up = (i[:, 2] > 0) & (dot(d, g) > 0)
                reflected[up] += specular * lobe_weight(variant, i[up], o[up], h[up]) * self.seen(p[up], d[up])
            for a in self.lamps:
                if self.is_point(a):
                    to = a.matrix[:3, 3] - p
                    d2 = dot(to, to)
                    d = to / np.sqrt(d2)[:, None]
                    i = np.einsum("nij,nj->ni", f, d)
                    lit = (i[:, 2] > 0) & (dot(d, g) > 0) & (self.nearest(p, d)[0] > np.sqrt(d2))
                    irradiance = a.radiance * 4 * a.size**2 * np.maximum(d @ a.matrix[:3, 2], 0) / d2 * i[:, 2]
                    value = diffuse / np.pi + specular * brdf(variant, alpha, i, o)
                    reflected += np.where(lit, value * irradiance, 0)
            total[mine] = reflected
        return total


def lamp(light, matrix):
    axis = np.linalg.norm(matrix[:3, :3], axis=0)
    factor = grey(light.get("color", (1, 1, 1)))
    if light["type"] == "area":
        size = light["size"][0] * axis[0] / 2
        matrix[:3, :3] /= axis
        return Area(matrix, light["radiance"] * factor, size)
    return Disk(matrix, light["intensity"] * factor / (np.pi * light["radius"] ** 2), light["radius"])


class Area(Lamp):
    """A square that emits to one side."""

    def met(self, origin, direction, limit):
        x, y, z = self.matrix[:3, :3].T
        to = self.matrix[:3, 3] - origin
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (to @ z) / (direction @ z)
            at = direction * t[:, None] - to
            inside = np.maximum(np.abs(at @ x), np.abs(at @ y)) <= self.size
        return inside & (direction @ z > 0) & (t > 0) & (t < limit)


class Disk(Lamp):
    """A point light with a radius: a disk that faces the receiver."""

    def met(self, origin, direction, limit):
        to = self.matrix[:3, 3] - origin
        along = dot(direction, to)
        t = dot(to, to) / np.where(along > 0, along, np.nan)
        with np.errstate(invalid="ignore"):
            return (np.linalg.norm(direction * t[:, None] - to, axis=1) <= self.size) & (t < limit)


def lobe_weight(variant, i, o, h):
    """f cos / p of a direction that reflects o at the half vector h, drawn by Walter's sampling; the specular colour 1."""
    ci, co, ch, ho = i[:, 2], o[:, 2], h[:, 2], dot(h, o)
    if variant == "ward-gmd":
        return ci / (ho * ch)
    return ho * ch**3 * (np.sqrt(ci / co) if variant == "ward" else 1 / co)


def brdf(variant, alpha, i, o):
    h = i + o
    ci, co = i[:, 2], o[:, 2]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        e = np.exp(-(h[:, 0] ** 2 + h[:, 1] ** 2) / (h[:, 2] * alpha) ** 2) / (np.pi * alpha**2)
        return (
            e
            * {
                "ward": 1 / (4 * np.sqrt(ci * co)),
                "ward-dur": 1 / (4 * ci * co),
                "ward-gmd": dot(h, h) / h[:, 2] ** 4,
            }[variant]
        )


def grey(color):
    return float(np.dot(color, (0.2126, 0.7152, 0.0722)))


def dot(a, b):
    return (a * b).sum(axis=1)


def unit(v):
    return v / np.linalg.norm(v, axis=1, keepdims=True)
