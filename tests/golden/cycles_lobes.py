# SPDX-License-Identifier: GPL-3.0-or-later
"""What Cycles makes of single shaders: run by Blender, writes cycles_lobes_VERSION.json beside this file.

usage: blender --background --factory-startup --python tests/golden/cycles_lobes.py
Strips of a plane, one for each shader, under a world whose three channels are 1, max(z, 0) and (1 + y)/2 of the direction,
seen by an orthographic camera at several angles in the plane of y and z, wo = (0, -sin, cos): three integrals of
f cos(theta_i), reflection and transmission, for each shader and angle. Errors are from the pixels of a strip, which are alike.
The world is met by sampling of the shader alone: where it is sampled itself, Cycles evaluates rough refraction also at
directions that no facet refracts to, which is 10 % more light at grazing views.
"""

import json
import math
import tempfile
from pathlib import Path

import bpy

VERSION = {3: 3, 4: 4, 5: 5}[bpy.app.version[0]]
ANGLES = [8, 35, 65, 84]  # not 0, where Cycles 3.4 has no multiple scattering and no anisotropy
SIZE, SAMPLES = 8, 1024  # pixels of a strip each way, paths of each


def shaders() -> list[dict]:
    out: list[dict] = [{"node": "diffuse", "roughness": r} for r in (0, 0.5, 1)] + [{"node": "translucent"}]
    rough = [(d, r) for d in ("GGX", "BECKMANN", "MULTI_GGX", "ASHIKHMIN_SHIRLEY") for r in (0.2, 0.5, 1)]
    out += [{"node": "glossy", "distribution": d, "roughness": r, "anisotropy": 0} for d, r in rough]
    out += [
        {"node": "glossy", "distribution": d, "roughness": 0.6, "anisotropy": 0.5}
        for d in ("GGX", "BECKMANN", "ASHIKHMIN_SHIRLEY")
    ]
    for ior in (0.9, 1.5, 3):
        out += [
            {"node": "glass", "distribution": d, "roughness": r, "ior": ior}
            for d in ("GGX", "BECKMANN", "MULTI_GGX")
            for r in (0.4, 0.8)
        ]
    out += [{"node": "glass", "distribution": "GGX", "roughness": 0, "ior": 1.5}]
    out += [{"node": "refraction", "distribution": d, "roughness": 0.5, "ior": 1.5} for d in ("GGX", "BECKMANN")]
    out += [{"node": "velvet", "roughness": r} for r in (0.3, 0.9)]
    gray, tinted = [0.6, 0.6, 0.6], [0.9, 0.5, 0.1]
    if VERSION == 3:
        each: list[dict] = [{}, {"metallic": 1}, {"metallic": 1, "distribution": "MULTI_GGX", "roughness": 0.8}, {"specular": 1, "specularTint": 1},
                {"transmission": 1}, {"transmission": 1, "specularTint": 0.5, "distribution": "MULTI_GGX"}, {"clearcoat": 1},
                {"clearcoat": 1, "clearcoatRoughness": 0.4}, {"sheen": 1}, {"anisotropic": 0.8, "metallic": 1},
                {"roughness": 0.2}, {"roughness": 1}, {"metallic": 0.4, "transmission": 0.5, "clearcoat": 0.5, "sheen": 0.6}]  # fmt: skip
    else:
        out += [{"node": "sheen", "roughness": r} for r in (0.3, 0.6, 0.9)]
        each = [{}, {"metallic": 1}, {"metallic": 1, "specularTint": [0.3, 0.6, 0.9], "roughness": 0.8}, {"specularIorLevel": 1, "specularTint": tinted},
                {"transmissionWeight": 1}, {"transmissionWeight": 1, "specularTint": tinted, "roughness": 0.8},
                {"coatWeight": 1}, {"coatWeight": 1, "coatRoughness": 0.5, "coatIor": 2, "coatTint": [0.5, 0.8, 1]},
                {"sheenWeight": 1}, {"sheenWeight": 0.5, "sheenRoughness": 0.9, "sheenTint": tinted}, {"anisotropic": 0.8, "metallic": 1},
                {"diffuseRoughness": 1}, {"ior": 2.5, "roughness": 0.1}, {"alpha": 0.4}, {"multiscatter": False, "metallic": 0.5, "roughness": 1},
                {"metallic": 0.3, "transmissionWeight": 0.5, "coatWeight": 0.5, "sheenWeight": 0.6}]  # fmt: skip
        if VERSION == 5:
            each += [
                {"thinWall": True, "transmissionWeight": 1},
                {"thinWall": True, "subsurfaceWeight": 1, "subsurfaceAnisotropy": 0.3},
            ]
    out += [
        {"node": "principled", "inputs": {"baseColor": color, **inputs}}
        for inputs in each
        for color in (gray, tinted)[: 1 + (len(inputs) == 1)]
    ]
    return out


def field(name: str) -> str:
    """coatIor -> Coat IOR"""
    words = "".join(" " + c if c.isupper() else c for c in name).title()
    return words.replace("Ior", "IOR")


def material(spec: dict) -> bpy.types.Material:
    surface = bpy.data.materials.new("surface")
    surface.use_nodes = True
    tree = surface.node_tree
    tree.nodes.clear()
    kind = spec["node"]
    names = {"diffuse": "Diffuse", "translucent": "Translucent", "glossy": "Glossy", "glass": "Glass", "refraction": "Refraction",
             "velvet": "Velvet" if VERSION == 3 else "Sheen", "sheen": "Sheen", "principled": "Principled"}  # fmt: skip
    if kind == "glossy" and VERSION == 3 and spec["anisotropy"]:
        names["glossy"] = "Anisotropic"
    node = tree.nodes.new("ShaderNodeBsdf" + names[kind])
    if kind == "principled":
        inputs = dict(spec["inputs"])
        distribution = inputs.pop("distribution", "GGX")
        if VERSION != 3:
            distribution = "MULTI_GGX" if inputs.pop("multiscatter", True) else "GGX"
        node.distribution = distribution
        for key, value in inputs.items():
            node.inputs[field(key)].default_value = [*value, 1] if isinstance(value, list) else value
        aniso = inputs.get("anisotropic", 0)
    else:
        node.inputs["Color"].default_value = (0.8, 0.8, 0.8, 1)
        if "distribution" in spec:
            node.distribution = spec["distribution"]
        elif kind == "velvet" and VERSION != 3:
            node.distribution = "ASHIKHMIN"
        elif kind == "sheen":
            node.distribution = "MICROFIBER"
        if "roughness" in spec:
            node.inputs["Sigma" if kind == "velvet" and VERSION == 3 else "Roughness"].default_value = spec["roughness"]
        if "ior" in spec:
            node.inputs["IOR"].default_value = spec["ior"]
        aniso = spec.get("anisotropy", 0)
        if aniso:
            node.inputs["Anisotropy"].default_value = aniso
    if aniso:
        tangent = tree.nodes.new("ShaderNodeTangent")
        tangent.direction_type = "UV_MAP"
        tree.links.new(tangent.outputs[0], node.inputs["Tangent"])
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return surface


def scene(specs: list[dict]) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    for k, spec in enumerate(specs):
        mesh = bpy.data.meshes.new("strip")
        x = k - len(specs) / 2
        mesh.from_pydata([(x, -100, 0), (x + 1, -100, 0), (x + 1, 100, 0), (x, 100, 0)], [], [(0, 1, 2, 3)])
        corners = mesh.uv_layers.new().data
        for i, uv in enumerate([(0, 0), (1, 0), (1, 1), (0, 1)]):
            corners[i].uv = uv
        mesh.materials.append(material(spec))
        scene.collection.objects.link(bpy.data.objects.new("strip", mesh))
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.sensor_fit = "HORIZONTAL"
    camera.data.type, camera.data.ortho_scale = "ORTHO", len(specs)
    scene.collection.objects.link(camera)
    scene.camera = camera
    world = scene.world = bpy.data.worlds.new("world")
    world.use_nodes = True
    tree = world.node_tree
    background = next(n for n in tree.nodes if n.type == "BACKGROUND")
    where, parts, color = (tree.nodes.new(f"ShaderNode{n}") for n in ("TexCoord", "SeparateXYZ", "CombineXYZ"))
    high, right = (tree.nodes.new("ShaderNodeMath") for _ in range(2))
    tree.links.new(where.outputs["Generated"], parts.inputs[0])
    high.operation, high.inputs[1].default_value = "MAXIMUM", 0
    tree.links.new(parts.outputs[2], high.inputs[0])
    right.operation, right.inputs[1].default_value, right.inputs[2].default_value = "MULTIPLY_ADD", 0.5, 0.5
    tree.links.new(parts.outputs[1], right.inputs[0])
    color.inputs[0].default_value = 1
    tree.links.new(high.outputs[0], color.inputs[1])
    tree.links.new(right.outputs[0], color.inputs[2])
    tree.links.new(color.outputs[0], background.inputs["Color"])
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = SIZE * len(specs), SIZE
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = "CPU", SAMPLES, False, False
    cycles.blur_glossy, cycles.sample_clamp_indirect, cycles.max_bounces = 0, 0, 8
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.light_sampling_threshold = 0
    world.cycles.sampling_method = "NONE"
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 0.01


def measure(degrees: float, path: Path) -> list[list[list[float]]]:
    """For each strip the three channels of its pixels."""
    camera, angle = bpy.context.scene.camera, math.radians(degrees)
    camera.location = (0, -10 * math.sin(angle), 10 * math.cos(angle))
    camera.rotation_euler = (angle, 0, 0)
    bpy.context.scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    values, width = list(image.pixels), image.size[0]
    bpy.data.images.remove(image)
    pixels = [values[4 * i : 4 * i + 3] for i in range(len(values) // 4)]
    strips = [[p for i, p in enumerate(pixels) if i % width // SIZE == k] for k in range(width // SIZE)]
    return [[[p[c] for p in strip] for c in range(3)] for strip in strips]


def main() -> None:
    specs, lines = shaders(), []
    scene(specs)
    with tempfile.TemporaryDirectory() as folder:
        for degrees in ANGLES:
            for spec, strip in zip(specs, measure(degrees, Path(folder) / f"image{degrees}.exr")):
                means = [sum(c) / len(c) for c in strip]
                errors = [math.sqrt(sum((v - m) ** 2 for v in c) / (len(c) - 1) / len(c)) for c, m in zip(strip, means)]
                entry = {
                    "shader": spec,
                    "degrees": degrees,
                    "mean": [round(m, 6) for m in means],
                    "error": [round(e, 6) for e in errors],
                }
                lines.append(json.dumps(entry))
    version = f"{bpy.app.version[0]}.{bpy.app.version[1]}"
    Path(__file__).with_name(f"cycles_lobes_{version}.json").write_text("[\n" + ",\n".join(lines) + "\n]\n")
    print(len(lines), "measured")


main()
