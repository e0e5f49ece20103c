# SPDX-License-Identifier: GPL-3.0-or-later
"""Golden values of the procedural textures, from Cycles itself: renders the texture nodes of the Blender that runs this at
known points, and puts the values into patterns.json beside it, in place of those of the same version. Once per version:

    blender --background --factory-startup --python tests/golden/make_patterns.py

The picture has a column for each point and a row for each case. A column is an object, a strip of squares of a pixel each,
that has the point as custom properties: the node reads exactly these floats, wherever in the pixel the ray hits (attributes
of vertices and, in Blender 5, of faces are interpolated, with rounding). Each square has a material, which emits up to
three of the node's outputs as red, green and blue, or a colour."""

import itertools
import json
import random
import sys
import tempfile
from pathlib import Path
from typing import Any

import bpy
import numpy as np

FILE = Path(__file__).resolve().parent / "patterns.json"
VERSION = 5 if bpy.app.version >= (5, 0) else 4 if bpy.app.version >= (4, 2) else 3
FRACTALS = ("FBM", "MULTIFRACTAL", "HYBRID_MULTIFRACTAL", "RIDGED_MULTIFRACTAL", "HETERO_TERRAIN")
DIMENSIONS = ("1D", "2D", "3D", "4D")

Case = dict[str, Any]


def points() -> list[list[float]]:
    """x, y, z, w as floats: some at random, where lattices have their walls, far away, and where floats are coarse."""
    rng = random.Random(17)
    near: list[list[float]] = [[rng.uniform(-4, 4) for _ in range(4)] for _ in range(10)]
    special: list[list[float]] = [[1, -2, 3, -4], [0, 1, 2, -1], [0.5, 0.25, -0.75, 1.5], [0.3, 0.4, 0.1, -0.2]]
    far: list[list[float]] = [
        [1234.567, -987.654, 321.5, -77.25],
        [2.5e6, -140000.5, 12.25, -6.5e5],
        [1e30, -2e30, 5e29, 3e30],
    ]
    return [[float(np.float32(x)) for x in p] for p in near + special + far]


def case(node: str, output: str | list[str], properties: Case | None = None, inputs: Case | None = None) -> Case:
    return {"node": node, "output": output, "properties": properties or {}, "inputs": inputs or {}}


def noise() -> list[Case]:
    plain: list[Case] = [
        {"Scale": 1},
        {"Scale": 2.3, "Detail": 3.6, "Roughness": 0.7, "Distortion": 1.5},
        {"Detail": 0, "Roughness": 0.9},
    ]
    fractal: list[Case] = [
        {"Scale": 1, "Gain": 1.5, "Offset": 0.4},
        plain[1] | {"Lacunarity": 2.3, "Offset": 0.8, "Gain": 2},
    ]
    if VERSION == 3:
        return [case("Noise", "Color", {"noise_dimensions": d}, i) for d in DIMENSIONS for i in plain]
    rows = []
    for d, kind in itertools.product(DIMENSIONS, FRACTALS):
        for normalize in (True, False) if kind == "FBM" else (True,):
            properties = {"noise_dimensions": d, "noise_type": kind, "normalize": normalize}
            rows += [case("Noise", "Color", properties, i) for i in fractal]
    return rows


def musgrave() -> list[Case]:
    inputs: list[Case] = [
        {"Scale": 1, "Dimension": 0.8, "Offset": 0.4, "Gain": 1.5},
        {"Scale": 1.7, "Detail": 4.4, "Dimension": 0.6, "Lacunarity": 2.3, "Offset": 0.8, "Gain": 2},
        {"Scale": 1.7, "Detail": 0.4, "Dimension": 0.6, "Offset": 0.8, "Gain": 2},
    ]
    kinds = [{"musgrave_dimensions": d, "musgrave_type": k} for d in DIMENSIONS for k in FRACTALS]
    return [case("Musgrave", ["Fac"], k, i) for k in kinds for i in inputs]


def voronoi() -> list[Case]:
    rows = []
    for d, feature in itertools.product(DIMENSIONS, ("F1", "F2", "SMOOTH_F1")):
        for metric in ("EUCLIDEAN", "MANHATTAN", "CHEBYCHEV", "MINKOWSKI")[: 1 if d == "1D" else 4]:
            properties = {"voronoi_dimensions": d, "feature": feature, "distance": metric}
            scales = ["Distance", "W"] if d in ("1D", "4D") else ["Distance"]
            inputs = {"Scale": 1.3, "Randomness": 0.9, "Exponent": 1.7, "Smoothness": 0.6}
            outputs: tuple[str | list[str], ...] = (scales, "Color") if d == "1D" else (scales, "Color", "Position")
            rows += [case("Voronoi", o, properties, inputs) for o in outputs]
            if VERSION > 3 and metric in ("EUCLIDEAN", "MINKOWSKI"):
                more = inputs | {"Detail": 1.6, "Roughness": 0.7, "Lacunarity": 2.3}
                rows += [case("Voronoi", o, properties | {"normalize": True}, more) for o in outputs]
    for d in DIMENSIONS:
        edge = {"voronoi_dimensions": d, "feature": "DISTANCE_TO_EDGE"}
        rows.append(case("Voronoi", ["Distance"], edge, {"Scale": 1.3, "Randomness": 0.9}))
        if VERSION > 3:
            more = {"Scale": 1.3, "Randomness": 0.9, "Detail": 1.6, "Roughness": 0.7, "Lacunarity": 2.3}
            rows += [case("Voronoi", ["Distance"], edge | {"normalize": n}, more) for n in (False, True)]
        sphere = {"voronoi_dimensions": d, "feature": "N_SPHERE_RADIUS"}
        rows.append(case("Voronoi", ["Radius"], sphere, {"Scale": 1.3, "Randomness": 0.9}))
    # The ends of the ranges: powers that leave the floats, no smoothness, points on a lattice.
    plane = {"voronoi_dimensions": "2D"}
    smooth = plane | {"feature": "SMOOTH_F1"}
    far = {"voronoi_dimensions": "4D", "feature": "F1", "distance": "MINKOWSKI"}
    rows.append(case("Voronoi", ["Distance"], plane | {"feature": "F1"}, {"Scale": 1.3, "Randomness": 0}))
    rows.append(case("Voronoi", ["Distance"], smooth, {"Scale": 1.3, "Smoothness": 0}))
    rows.append(case("Voronoi", ["Distance", "W"], far, {"Scale": 1.3, "Exponent": 0.4}))
    rows.append(case("Voronoi", ["Distance", "W"], far, {"Scale": 1.3, "Exponent": 32}))
    return rows


def wave() -> list[Case]:
    rows = []
    plain = {"Scale": 0.7, "Phase Offset": 0.3}
    distorted = {"Scale": 0.7, "Distortion": 3.2, "Detail": 2.6, "Detail Scale": 1.4, "Detail Roughness": 0.6}
    for shape, axis in (
        ("BANDS", "X"),
        ("BANDS", "Y"),
        ("BANDS", "Z"),
        ("BANDS", "DIAGONAL"),
        ("RINGS", "X"),
        ("RINGS", "Y"),
        ("RINGS", "Z"),
        ("RINGS", "SPHERICAL"),
    ):
        for profile in ("SIN", "SAW", "TRI"):
            properties = {"wave_type": shape, f"{shape.lower()}_direction": axis, "wave_profile": profile}
            rows.append(case("Wave", ["Fac"], properties, distorted if profile == "TRI" else plain))
    return rows


def others() -> list[Case]:
    rows = [case("Magic", "Color", {"turbulence_depth": n}, {"Scale": 1.3, "Distortion": 1.2}) for n in range(11)]
    rows += [case("Magic", "Color", {"turbulence_depth": 2}, {"Scale": 1.3, "Distortion": 0}), case("Magic", ["Fac"])]
    colors = {"Color1": (0.8, 0.1, 0.3, 1), "Color2": (0.2, 0.9, 0.5, 1), "Mortar": (0.05, 0.02, 0.01, 1)}
    bricks: list[Case] = [
        {},
        {"Scale": 1.7, "Mortar Size": 0.1, "Mortar Smooth": 0.6, "Bias": -0.2, "Brick Width": 0.9, "Row Height": 0.4},
        {"Scale": 1.7, "Mortar Size": 0.1, "Mortar Smooth": 0, "Bias": 0.3},
    ]
    row = {"offset": 0.3, "offset_frequency": 3, "squash": 0.7, "squash_frequency": 2}
    for inputs in bricks:
        rows += [case("Brick", o, row, colors | inputs) for o in ("Color", ["Fac"])]
    rows += [case("Checker", ["Fac"], {}, {"Scale": s}) for s in (1, 2.7)]
    gradients = ("LINEAR", "QUADRATIC", "EASING", "DIAGONAL", "SPHERICAL", "QUADRATIC_SPHERE", "RADIAL")
    rows += [case("Gradient", ["Fac"], {"gradient_type": g}) for g in gradients]
    for d in DIMENSIONS:
        rows += [case("WhiteNoise", o, {"noise_dimensions": d}) for o in (["Value"], "Color")]
    return rows


def gabor() -> list[Case]:
    rows = []
    for kind, orientation in (("2D", 0.6), ("3D", (0.3, -0.8, 0.5))):
        for anisotropy in (1, 0.4, 0):
            inputs = {"Scale": 1.3, "Frequency": 1.7, "Anisotropy": anisotropy, f"Orientation {kind}": orientation}
            rows.append(case("Gabor", ["Value", "Phase", "Intensity"], {"gabor_type": kind}, inputs))
    return rows


def beyond() -> list[Case]:
    """Inputs beyond their ranges, as links may give."""
    more: Case = {"Lacunarity": 1.1} if VERSION > 3 else {}
    deep = {"Detail": 40, "Roughness": 1.4, "Distortion": -0.7} | more
    rows = [
        case("Noise", "Color", {"noise_dimensions": "2D"}, i)
        for i in (deep, {"Detail": -2.5, "Scale": -1.3}, {"Scale": 0})
    ]
    plane = {"voronoi_dimensions": "2D"}
    for feature in ("F1", "F2", "SMOOTH_F1", "DISTANCE_TO_EDGE"):
        inputs: Case = {"Scale": -1.3, "Randomness": 1.8, "Smoothness": 3}
        deeper: Case = {"Detail": 20, "Roughness": 2} | more if VERSION > 3 else {}
        outputs: tuple[str | list[str], ...] = ("Color", "Position", ["Distance"])
        for o in outputs[2:] if feature == "DISTANCE_TO_EDGE" else outputs:
            rows.append(case("Voronoi", o, plane | {"feature": feature}, inputs | deeper))
    rows += [case("Voronoi", o, plane, {"Scale": 0, "Randomness": -1}) for o in outputs]
    for exponent in (0, -1, 1e-3):
        rows.append(
            case("Voronoi", ["Distance"], plane | {"distance": "MINKOWSKI"}, {"Scale": 1.3, "Exponent": exponent})
        )
    for detail, roughness in ((18.5, 0.9), (-0.4, 0.5), (-3.0, 0.5), (2.5, 1.6)):
        rows.append(
            case("Wave", ["Fac"], {}, {"Scale": 0.7, "Distortion": 2, "Detail": detail, "Detail Roughness": roughness})
        )
    rows.append(case("Magic", "Color", {"turbulence_depth": 4}, {"Scale": -0.4, "Distortion": -2}))
    walls: Case = {"Scale": 1.7, "Mortar Size": 0.1}
    for inputs in (
        {"Mortar Smooth": -0.5},
        {"Mortar Smooth": 3},
        {"Row Height": -0.3, "Bias": 4},
        {"Mortar Size": -1},
    ):
        rows.append(case("Brick", "Color", {}, walls | inputs))
    rows.append(case("Checker", ["Fac"], {}, {"Scale": -0.7}))
    if VERSION > 3:
        for inputs in ({"Anisotropy": 2, "Frequency": -3}, {"Anisotropy": -1, "Frequency": 9, "Scale": -2}):
            rows.append(case("Gabor", ["Value", "Phase", "Intensity"], {"gabor_type": "2D"}, inputs))
    return rows


def socket(sockets: Any, name: str) -> Any:
    """By identifier where names are given twice (Gabor's Orientation)."""
    return next((s for s in sockets if s.identifier == name), None) or sockets[name]


def material(c: Case) -> Any:
    made = bpy.data.materials.new("case")
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    nodes.clear()
    texture = nodes.new("ShaderNodeTex" + c["node"])
    for name, value in c["properties"].items():
        setattr(texture, name, value)
    for name, value in c["inputs"].items():
        if isinstance(value, float | int):  # linked, as sockets limit their own value
            number = nodes.new("ShaderNodeValue")
            number.outputs[0].default_value = value
            links.new(number.outputs[0], socket(texture.inputs, name))
        else:
            socket(texture.inputs, name).default_value = value
    for name in ("Vector", "W"):
        if name in texture.inputs:
            attribute = nodes.new("ShaderNodeAttribute")
            attribute.attribute_type, attribute.attribute_name = "OBJECT", name
            output = attribute.outputs["Vector"]
            if name == "W":  # its first component: a number would be the mean of three, rounded
                separate = nodes.new("ShaderNodeSeparateXYZ")
                links.new(output, separate.inputs[0])
                output = separate.outputs[0]
            links.new(output, texture.inputs[name])
    emission = nodes.new("ShaderNodeEmission")
    if isinstance(c["output"], str):
        links.new(texture.outputs[c["output"]], emission.inputs["Color"])
    else:
        combine = nodes.new("ShaderNodeCombineXYZ")
        for i, name in enumerate(c["output"]):
            links.new(texture.outputs[name], combine.inputs[i])
        links.new(combine.outputs[0], emission.inputs["Color"])
    links.new(emission.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return made


def strip(cases: list[Case]) -> Any:
    mesh = bpy.data.meshes.new("strip")
    corners = [(x, y, 0.0) for y in range(len(cases) + 1) for x in (0, 1)]
    mesh.from_pydata(corners, [], [(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(len(cases))])
    for i, c in enumerate(cases):
        mesh.materials.append(material(c))
        mesh.polygons[i].material_index = i
    return mesh


def render(at: list[list[float]], cases: list[Case]) -> Any:
    """Array [case, point, 3]."""
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    scene, mesh = bpy.context.scene, strip(cases)
    for column, (x, y, z, w) in enumerate(at):
        thing = bpy.data.objects.new("column", mesh)
        thing.location.x = column
        thing["Vector"], thing["W"] = (x, y, z), (w, 0.0, 0.0)
        scene.collection.objects.link(thing)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", max(len(at), len(cases))
    camera.location = (len(at) / 2, len(cases) / 2, 10)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.world = None
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 1
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.sample_clamp_direct = scene.cycles.sample_clamp_indirect = 0
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = len(at), len(cases), 100
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth, settings.color_mode = "OPEN_EXR", "32", "RGB"
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = f"{folder}/patterns.exr"
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        pixels = np.empty(len(at) * len(cases) * 4, np.float32)
        image.pixels.foreach_get(pixels)
    return pixels.reshape(len(cases), len(at), 4)[..., :3]


def main() -> None:
    at = points()
    cases = noise() + voronoi() + wave() + others() + beyond() + (musgrave() if VERSION == 3 else gabor())
    pixels = render(at, cases)
    old = json.loads(FILE.read_text())["cases"] if FILE.exists() else []
    rows = [c for c in old if c["version"] != VERSION]
    for c, row in zip(cases, pixels, strict=True):
        channels = 3 if isinstance(c["output"], str) else len(c["output"])
        rows.append({"version": VERSION, **c, "values": [[float(f"{x:.7g}") for x in p[:channels]] for p in row]})
    rows.sort(key=lambda c: c["version"])
    lines = ",\n".join(json.dumps(c, separators=(",", ":")) for c in rows)
    FILE.write_text(f'{{"points":{json.dumps(at, separators=(",", ":"))},\n"cases":[\n{lines}]}}\n')
    print(f"{FILE}: {len(cases)} cases of version {VERSION}, {FILE.stat().st_size} bytes")


if __name__ == "__main__":
    try:
        main()
    except Exception as error:  # Blender would end with 0
        sys.exit(f"error: {error!r}")
