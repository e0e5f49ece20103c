# SPDX-License-Identifier: GPL-3.0-or-later
"""Run by a second Blender for measured_sky.py: has Cycles render a Sky Texture node in given directions.

Reads task.json and where.npy of the folder that it is told; writes tables.npz: "sky", and "disc", of zeros if there is none.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix


def main(folder: Path) -> None:
    task = json.loads((folder / "task.json").read_text(encoding="utf-8"))
    if task["version"] != bpy.app.version_string:
        raise RuntimeError(f"it is Blender {bpy.app.version_string} now, not {task['version']}; restart Blender")
    scene = bpy.context.scene
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    camera = scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    tree, sky = _world(scene, task["settings"])
    texels = task["texels"]
    disc: np.ndarray = np.zeros((texels, texels, 3), np.float32)
    if task["size"] > 0:  # with a disc the node takes no coordinates but those of the world
        right, up, sun = task["axes"]
        camera.matrix_world = Matrix(np.array((right, up, np.negative(sun))).T.tolist()).to_4x4()
        camera.data.sensor_width = 1.0
        camera.data.lens = 0.5 / math.tan(task["size"] / 2.0)
        with_disc = _rendered(scene, folder, texels, texels)
        sky.sun_disc = False
        disc = with_disc - _rendered(scene, folder, texels, texels)
    if hasattr(sky, "sun_disc"):
        sky.sun_disc = False
    where = np.load(folder / "where.npy")
    _look(tree, sky, where)
    np.savez(folder / "tables.npz", sky=_rendered(scene, folder, where.shape[1], where.shape[0]), disc=disc)


def _world(scene: Any, settings: dict[str, Any]) -> tuple[Any, Any]:
    world = scene.world = bpy.data.worlds.new("Sky")
    world.use_nodes = True
    tree = world.node_tree
    sky = tree.nodes.new("ShaderNodeTexSky")
    for name, value in sorted(settings.items(), key=lambda item: item[0] != "sky_type"):
        setattr(sky, name, value)
    background = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeBackground")
    background.inputs["Strength"].default_value = 1.0
    tree.links.new(sky.outputs["Color"], background.inputs["Color"])
    return tree, sky


def _look(tree: Any, sky: Any, where: np.ndarray) -> None:
    """At the sky in the direction that an image holds for each pixel."""
    height, width = where.shape[:2]
    image = bpy.data.images.new("Where", width, height, float_buffer=True, alpha=False)
    image.colorspace_settings.is_data = True
    pixels: np.ndarray = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = where
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image, texture.interpolation, texture.extension = image, "Closest", "EXTEND"
    tree.links.new(coordinates.outputs["Window"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], sky.inputs["Vector"])


def _rendered(scene: Any, folder: Path, width: int, height: int) -> np.ndarray:
    """(height, width, 3): the middles of the pixels."""
    render = scene.render
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.image_settings.color_mode = "RGB"
    render.filepath = str(folder / "radiance.exr")
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = "CPU", 1, False, False
    cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", 0.01
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(render.filepath)
    image.colorspace_settings.is_data = True
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, -1)[..., :3]


if __name__ == "__main__":
    try:
        main(Path(sys.argv[sys.argv.index("--") + 1]))
    except Exception as error:
        print(json.dumps({"event": "error", "message": str(error)}), flush=True)
        raise
