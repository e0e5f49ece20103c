# SPDX-License-Identifier: GPL-3.0-or-later
"""Run by Blender: every output of every node over a grid of inputs, as light from a patch, in WardMIS and in Cycles, pixel by pixel.

blender --background --factory-startup --addons wardmis --python parity.py -- FOLDER [PATTERN]
writes FOLDER/parity-ENGINE.exr and FOLDER/parity.json: a list of {"node", "case", "within"}, for parity_rows.py."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "addon")]

import parity_cases  # noqa: E402
from parity_rows import COLUMNS, PIXELS  # noqa: E402
from patches import Nodes  # noqa: E402
from wardmis.export import camera as film  # noqa: E402
from wardmis.export import scene as exporter  # noqa: E402


def bowl() -> Any:
    """A patch of 1 x 1 with UVs, whose normals lean by up to 40 degrees.

    With an even number of faces along x and an odd one along y no pixel has an edge or a diagonal in its middle."""
    x, y = np.meshgrid(np.linspace(-0.5, 0.5, 11), np.linspace(-0.5, 0.5, 10))
    index = np.arange(x.size).reshape(x.shape)
    faces = np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]], axis=-1).reshape(-1, 4)
    mesh = bpy.data.meshes.new("Patch")
    mesh.from_pydata(
        np.stack([x, y, 0.5 * x * x + 0.3 * y * y + 0.2 * x * y], axis=-1).reshape(-1, 3).tolist(), [], faces.tolist()
    )
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    corners = np.stack([x, y], axis=-1).reshape(-1, 2)[faces.ravel()] + 0.5
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", corners.ravel())
    turned = np.stack([corners[:, 1], 1 - corners[:, 0]], axis=-1)
    mesh.uv_layers.new(name="Turned").data.foreach_set("uv", turned.ravel())
    points = np.stack([x, y], axis=-1).reshape(-1, 2)
    paint = mesh.attributes.new("Paint", "FLOAT_COLOR", "POINT")
    paint.data.foreach_set(
        "color", np.column_stack([points + 0.5, 0.3 + 0 * points[:, :1], 0.5 + points[:, 1:]]).ravel()
    )
    bytes_ = mesh.attributes.new("Bytes", "BYTE_COLOR", "CORNER")
    bytes_.data.foreach_set("color", np.column_stack([corners, corners]).ravel())
    heat = mesh.attributes.new("Heat", "FLOAT", "FACE")
    heat.data.foreach_set("value", np.linspace(0, 1, len(faces)))
    flow = mesh.attributes.new("Flow", "FLOAT_VECTOR", "POINT")
    flow.data.foreach_set("vector", np.column_stack([points, points[:, :1]]).ravel())
    return mesh


def build(cases: list[tuple[str, str, float, Callable[[Nodes], Any]]]) -> None:
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    scene = bpy.context.scene
    mesh = bowl()
    rows = math.ceil(len(cases) / COLUMNS)
    for i, (_, case, _, make) in enumerate(cases):
        material = bpy.data.materials.new(case)
        material.use_nodes, material.pass_index = True, 3
        material.node_tree.nodes.clear()
        nodes = Nodes(material.node_tree)
        emission = nodes("Emission", None, 1.0)
        nodes.feed(emission.inputs["Color"], make(nodes))
        nodes.feed(nodes("OutputMaterial").inputs["Surface"], emission.outputs[0])
        obj = bpy.data.objects.new(f"Patch {i}", mesh)
        scene.collection.objects.link(obj)
        obj.location = (
            i % COLUMNS - COLUMNS / 2 + 0.5,
            i // COLUMNS - rows / 2 + 0.5,
            0,
        )  # small numbers are rounded less
        if not mesh.materials:
            mesh.materials.append(None)
        obj.material_slots[0].link = "OBJECT"
        obj.material_slots[0].material = material
        obj.color, obj.pass_index, obj["Warmth"] = (0.2, 0.4, 0.6, 0.8), 7, (0.3, 0.6, 0.9)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    camera.location = (0, 0, 5)
    camera.data.type, camera.data.ortho_scale = "ORTHO", max(COLUMNS, rows)
    scene.camera = camera
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = COLUMNS * PIXELS, rows * PIXELS, 100
    render.use_compositing = render.use_sequencer = False
    scene.view_settings.view_transform = "Standard"
    settings = render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "IMAGE"
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGBA", "32"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = "CPU", 1, False, False
    cycles.pixel_filter_type, cycles.filter_width = (
        "GAUSSIAN",
        0.01,
    )  # and its first sample is in the middle of the pixel
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.max_bounces = 0
    scene.wardmis.samples, scene.wardmis.integrator = 1, "direct"


def narrow(scene: Any) -> Any:
    """Our samples, too, are in the middle of the pixel."""
    data = film.export_film(scene)
    data.filter_type, data.filter_width = "gaussian", 1e-6
    return data


def rendered(engine: str, path: Path) -> None:
    scene = bpy.context.scene
    scene.render.engine = engine
    scene.render.use_file_extension, scene.render.filepath = False, str(path)
    bpy.ops.render.render(write_still=True)
    if not path.exists():
        raise RuntimeError(f"{engine} rendered no image")


def main() -> None:
    folder, *pattern = sys.argv[sys.argv.index("--") + 1 :]
    exporter.export_film = narrow
    cases = [case for case in parity_cases.cases() if not pattern or pattern[0] in case[1]]
    if cases:
        build(cases)
        for engine in ("WARDMIS", "CYCLES"):
            rendered(engine, Path(folder) / f"parity-{engine.lower()}.exr")
    listed = [{"node": node, "case": case, "within": within} for node, case, within, _ in cases]
    (Path(folder) / "parity.json").write_text(json.dumps(listed))


if __name__ == "__main__":
    main()
