# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the sheen of fibres of Cycles and writes native/bsdf/fibre_table.cpp: run by Blender 4.0 or later.

usage: blender --background --factory-startup --python tools/fibre_table.py, about five minutes
Zeltner, Burley and Chiang 2022 give the sheen as a cosine lobe under a matrix of two numbers, times an albedo. All three
are measured: strips of a plane with a Sheen node each, of rising roughness, under worlds that are 1 (the albedo) and
z, y, z^2, y^2, yz of the direction (moments of the lobe), seen along (0, -sin, cos) by an orthographic camera, one
picture a cosine. The two numbers are fitted to each cell's five moments by least squares; the moments of a fitted lobe
are integrals over the disk of the cosine lobe. Cosines are the squares of even steps: the albedo is steep at grazing views.
Between the nodes the table is then compared with measurements of their own; what is left stands in the file's head.
"""

import math
import tempfile
from pathlib import Path

import bpy
import numpy as np

OUT = Path(__file__).parent.parent / "native/bsdf/fibre_table.cpp"
N = 32
STEPS = np.arange(N) / (N - 1)
ROUGHNESS = np.maximum(STEPS, 1e-3)  # Cycles' least
SIZE, SAMPLES = 4, 512  # pixels of a strip each way, paths of each
# what is measured, three channels at a time: the mean over the lobe of products of these coordinates
PRODUCTS: tuple[list[tuple[str, ...]], ...] = ([(), ("Z",), ("Y",)], [("Z", "Z"), ("Y", "Y"), ("Y", "Z")])
LEAST = 1e-5  # Cycles makes no lobe of less albedo

Moments = np.ndarray  # (..., 6): albedo, and of the lobe z, x, z^2, x^2, xz; x is the view's side


class Scene:
    """Strips of sheen under a world with a formula for each channel."""

    def __init__(self, roughness: np.ndarray) -> None:
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.scene = bpy.context.scene
        self.strips = len(roughness)
        for k, rough in enumerate(roughness):
            x = k - self.strips / 2
            mesh = bpy.data.meshes.new("strip")
            mesh.from_pydata([(x, -3000, 0), (x + 1, -3000, 0), (x + 1, 3000, 0), (x, 3000, 0)], [], [(0, 1, 2, 3)])
            surface = bpy.data.materials.new("surface")
            surface.use_nodes = True
            tree = surface.node_tree
            tree.nodes.clear()
            sheen, output = tree.nodes.new("ShaderNodeBsdfSheen"), tree.nodes.new("ShaderNodeOutputMaterial")
            sheen.distribution = "MICROFIBER"
            sheen.inputs["Color"].default_value = (1, 1, 1, 1)
            sheen.inputs["Roughness"].default_value = rough
            tree.links.new(sheen.outputs[0], output.inputs["Surface"])
            mesh.materials.append(surface)
            self.scene.collection.objects.link(bpy.data.objects.new("strip", mesh))
        self.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        data = self.camera.data
        data.sensor_fit, data.type, data.ortho_scale, data.clip_end = "HORIZONTAL", "ORTHO", self.strips, 1e5
        self.scene.collection.objects.link(self.camera)
        self.scene.camera = self.camera
        world = self.scene.world = bpy.data.worlds.new("world")
        world.use_nodes = True
        self.tree = world.node_tree
        render, cycles = self.scene.render, self.scene.cycles
        render.engine = "CYCLES"
        render.resolution_x, render.resolution_y, render.resolution_percentage = SIZE * self.strips, SIZE, 100
        render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
        cycles.device, cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = "CPU", SAMPLES, False, False
        cycles.max_bounces, cycles.light_sampling_threshold = 1, 0
        world.cycles.sampling_method = "NONE"
        cycles.pixel_filter_type, cycles.filter_width = "BOX", 0.01

    def light(self, products: list[tuple[str, ...]]) -> None:
        """Each channel of the world: (1 + product)/2 of the direction's coordinates; the empty product is 1."""
        nodes, links = self.tree.nodes, self.tree.links
        nodes.clear()
        where, parts, color = (nodes.new(f"ShaderNode{n}") for n in ("TexCoord", "SeparateXYZ", "CombineXYZ"))
        background, output = nodes.new("ShaderNodeBackground"), nodes.new("ShaderNodeOutputWorld")
        links.new(where.outputs["Generated"], parts.inputs[0])
        links.new(color.outputs[0], background.inputs["Color"])
        links.new(background.outputs[0], output.inputs["Surface"])
        for channel, product in enumerate(products):
            value = None
            for factor in product:
                node = nodes.new("ShaderNodeMath")
                node.operation, node.inputs[0].default_value = "MULTIPLY", 1
                if value:
                    links.new(value, node.inputs[0])
                links.new(parts.outputs[factor], node.inputs[1])
                value = node.outputs[0]
            half = nodes.new("ShaderNodeMath")
            half.operation = "MULTIPLY_ADD"
            for i in range(3):
                half.inputs[i].default_value = 0.5
            half.inputs[0].default_value = 1
            if value:
                links.new(value, half.inputs[0])
            links.new(half.outputs[0], color.inputs[channel])

    def picture(self, mu: float, path: str) -> np.ndarray:
        """Mean colours of the strips, seen at this cosine."""
        angle, away = math.acos(mu), 10 + 2 / mu
        self.camera.location = (0, -away * math.sin(angle), away * mu)
        self.camera.rotation_euler = (angle, 0, 0)
        self.scene.render.filepath = path
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(path)
        pixels = np.array(image.pixels[:], dtype=float).reshape(SIZE, self.strips, SIZE, 4)
        bpy.data.images.remove(image)
        return pixels.mean(axis=(0, 2))[:, :3]

    def measure(self, cosines: np.ndarray) -> Moments:
        """Of each strip (rows: cosines)."""
        with tempfile.TemporaryDirectory() as folder:
            sums: list[list[np.ndarray]] = []
            for products in PRODUCTS:
                self.light(products)
                sums.append([self.picture(float(mu), f"{folder}/{len(sums)}_{i}.exr") for i, mu in enumerate(cosines)])
        out = np.concatenate(sums, axis=2)
        albedo = out[..., :1]
        moments = 2 * np.divide(out[..., 1:], albedo, out=np.full(out[..., 1:].shape, 0.5), where=albedo > LEAST) - 1
        return np.concatenate([albedo, moments * [1, -1, 1, 1, -1]], axis=2)


def moments_of(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """z, x, z^2, x^2, xz of the lobe with these numbers, shape (cells, 5)."""
    nodes, weights = np.polynomial.legendre.leggauss(48)
    v, steps = (nodes + 1) / 2, 48
    cosine = 1 - v**3  # graded towards the pole, which a narrow lobe draws out to the horizon
    density = weights / 2 * 3 * v**2 * 2 * cosine / steps  # of the angle's other half, too
    phi = np.pi * (np.arange(steps) + 0.5) / steps
    sine = np.sqrt(1 - cosine**2)
    x = sine[:, None] * np.cos(phi) - cosine[:, None] * b[:, None, None]
    y, z = sine[:, None] * np.sin(phi), cosine[:, None] * a[:, None, None]
    length = np.sqrt(x * x + y * y + z * z)
    x, z = x / length, z / length
    return np.stack([(m * density[:, None]).sum(axis=(1, 2)) for m in (z, x, z * z, x * x, x * z)], axis=1)


def fit(moments: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The two numbers of each cell: Levenberg's steps, all cells at once, in ln a and b."""
    p = np.stack([np.full(len(moments), -1.5), np.full(len(moments), -0.05)], axis=1)

    def error(p: np.ndarray) -> np.ndarray:
        return moments_of(np.exp(p[:, 0]), p[:, 1]) - moments

    r, damping = error(p), np.full(len(p), 1e-3)
    for _ in range(40):
        h = 1e-5
        j = np.stack([(error(p + d) - error(p - d)) / (2 * h) for d in (np.array([h, 0]), np.array([0, h]))], axis=2)
        normal = np.einsum("nij,nik->njk", j, j) + damping[:, None, None] * np.eye(2) * 1e-3
        step = np.linalg.solve(normal, np.einsum("nij,ni->nj", j, r)[..., None])[..., 0]
        moved = p - np.clip(step, -0.5, 0.5)
        moved[:, 1] = np.clip(moved[:, 1], -0.99, 0.99)
        tried = error(moved)
        better = (tried**2).sum(axis=1) < (r**2).sum(axis=1)
        p[better], r[better] = moved[better], tried[better]
        damping = np.where(better, damping / 4, damping * 8)
    return np.exp(p[:, 0]), p[:, 1]


def interpolated(table: np.ndarray, mu: np.ndarray, roughness: np.ndarray) -> np.ndarray:
    """table[roughness, cosine] at the grid of both, as the renderer reads it; rows: cosines."""
    out = np.empty((len(mu), len(roughness)))
    for i, c in enumerate(np.sqrt(mu)):
        for k, r in enumerate(roughness):
            x, y = c * (N - 1), r * (N - 1)
            i0, k0 = min(int(x), N - 2), min(int(y), N - 2)
            u, v = x - i0, y - k0
            corner = table[k0 : k0 + 2, i0 : i0 + 2]
            out[i, k] = np.array([1 - v, v]) @ corner @ np.array([1 - u, u])
    return out


def extrapolated(values: np.ndarray) -> np.ndarray:
    """values[roughness, cosine] without the cosine 0, which no camera sees, with that in front: a line through the next two."""
    first = values[:, 0] - (values[:, 1] - values[:, 0]) / 3  # at 1 and 4 of the squared steps
    return np.concatenate([first[:, None], values], axis=1)


def main() -> None:
    measured = Scene(ROUGHNESS).measure(STEPS[1:] ** 2).transpose(1, 0, 2)  # roughness, cosine
    there = measured[..., 0] > LEAST
    a, b = np.zeros(there.shape), np.zeros(there.shape)
    a[there], b[there] = fit(measured[there][:, 1:])
    left = np.abs(moments_of(a[there], b[there]) - measured[there][:, 1:])
    for i in range(N - 2):  # where there is no lobe, that of the next more grazing view, with albedo 0
        a[:, i + 1] = np.where(there[:, i + 1], a[:, i + 1], a[:, i])
        b[:, i + 1] = np.where(there[:, i + 1], b[:, i + 1], b[:, i])
    albedo = np.where(there, measured[..., 0], 0)
    tables = {
        "kScale": (np.clip(extrapolated(a), 1e-3, 1), 65535),
        "kSkew": (np.clip(extrapolated(b), -1, 1), 32767),
        "kAlbedo": (np.clip(extrapolated(albedo), 0, 1), 65535),
    }

    between = np.array([0.005, 0.02, 0.06, 0.13, 0.24, 0.37, 0.53, 0.71, 0.97])
    roughness = (np.arange(5, N - 1) + 0.5) / (N - 1)
    theirs = Scene(roughness).measure(between)
    ours = {name: interpolated(table, between, roughness) for name, (table, _) in tables.items()}
    lobes = moments_of(ours["kScale"].ravel(), ours["kSkew"].ravel()).reshape(*theirs.shape[:2], 5)
    off = np.abs(ours["kAlbedo"] - theirs[..., 0])
    seen = theirs[..., :1] * np.abs(lobes - theirs[..., 1:])  # as light: the albedo times a moment
    version = ".".join(str(v) for v in bpy.app.version[:2])
    lines = [
        "// SPDX-License-Identifier: GPL-3.0-or-later",
        f"// Made by tools/fibre_table.py, which measures Cycles' Sheen node (here Blender {version}).",
        f"// Moments of the fitted lobes at the nodes: off by {left.mean():.1e} in mean, at most {left.max():.1e}.",
        f"// Between them ({off.size} views and roughnesses): albedo off by {off.mean():.1e} in mean, at most {off.max():.1e};",
        f"// albedo times a moment by {seen.mean():.1e}, at most {seen.max():.1e}.",
        '#include "bsdf/fibre_table.h"',
        "",
        "namespace wardmis::fibre {",
        "",
        "// clang-format off",
    ]
    for name, (values, unit) in tables.items():
        numbers = [str(round(float(v) * unit)) for v in values.ravel()]
        lines.append(f"const {'u' if unit == 65535 else ''}int16_t {name}[{N * N}] = {{")
        lines += ["  " + ",".join(numbers[i : i + 20]) + "," for i in range(0, N * N, 20)]
        lines.append("};")
    lines += ["// clang-format on", "", "}  // namespace wardmis::fibre", ""]
    OUT.write_text("\n".join(lines))
    print("\n".join(lines[1:5]))


main()
