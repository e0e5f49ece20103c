# SPDX-License-Identifier: GPL-3.0-or-later
"""Every object that Cycles sees is exported, in the same place and shape, or named in a note; and nothing else is.

Cycles renders one sample of each pixel. Where it meets something, a ray from the camera through that point must meet the exported
triangles there and not before; where it meets nothing around a pixel, a ray through its middle must meet nothing.
"""

from __future__ import annotations

import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree
from strand_surfaces import surface_of
from support import HERE
from wardmis import compat, engine
from wardmis.export.scene import gather_scene
from wardmis.exr import read_header, read_pass

sys.path[:0] = [str(HERE.parent / "cycles")]

import forms  # noqa: E402
import render  # noqa: E402
from stage import SCENES  # noqa: E402

TOPICS = ("deformation", "geometry", "instances", "strands")
WIDTH, HEIGHT = 96, 72
FAR = 1e-3  # metres between Cycles' point and the exported surface; the scenes are some metres wide
FAR_OF_STRANDS = 5e-3  # which triangles only come close to, most of all where ribbons are bent
BEFORE = 0.05  # metres by which a ray may meet the triangles of a tube too early, where it grazes it
STRAY = 0.005  # of the points: those on edges may lie a rounding beside them


def cycles_view(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What one sample of each pixel meets: whether, where, and of which pass index. Rows from the top."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    for owner, name, value in compat.cycles_samples(
        scene.cycles, 0, 1
    ):  # the very first one alone has places and indices
        setattr(owner, name, value)
    scene.cycles.pixel_filter_type = "BOX"
    scene.render.film_transparent = True
    layer = bpy.context.view_layer
    layer.use_pass_position = layer.use_pass_object_index = True
    scene.render.filepath, scene.render.use_file_extension = str(path), False
    for owner, name, value in compat.multilayer_exr(scene.render.image_settings):
        if hasattr(owner, name):
            setattr(owner, name, value)
    bpy.ops.render.render(write_still=True)
    index = next(n.split(".")[-2] for n, _ in read_header(path).channels() if "Index" in n)
    met = read_pass(path)[..., 3] > 0
    return met, read_pass(path, "Position"), read_pass(path, index)[..., 0].round().astype(int)


def exported_scene():
    """As a render has it."""
    scenes = []

    def keep(depsgraph, *_):
        scenes.append(gather_scene(depsgraph, "test"))
        return []

    bpy.context.scene.render.engine = "WARDMIS"
    with mock.patch.object(engine, "export_depsgraph", keep), engine.scene_export_to(Path("nowhere")):
        bpy.ops.render.render()
    return scenes[0]


def tree_of(scene) -> BVHTree:
    """Of all triangles that the camera sees, in the world; of curves and spheres those that look like them from there."""
    vertices, triangles, count = [], [], 0
    for instance in scene.instances:
        if "camera" in instance.hidden_from:
            continue
        mesh = scene.meshes[instance.mesh]
        if mesh.radii is not None:
            placed, own = surface_of(mesh, instance.matrix, scene.camera.matrix[:3, 3])
            own = [own]
        else:
            placed = mesh.positions @ instance.matrix[:3, :3].T + instance.matrix[:3, 3]
            own = [primitive.triangles.astype(np.int64) for primitive in mesh.primitives]
        vertices.append(placed)
        triangles += [part + count for part in own]
        count += len(placed)
    if not triangles:
        return BVHTree.FromPolygons([(0, 0, 0)] * 3, [(0, 1, 2)])
    return BVHTree.FromPolygons(
        np.concatenate(vertices).tolist(), np.concatenate(triangles).tolist(), all_triangles=True
    )


class Shapes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.addClassCleanup(lambda: bpy.ops.wm.read_homefile(use_factory_startup=True))

    def check(self, entry) -> None:
        render.make(entry)
        scene = bpy.context.scene
        scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
        for number, obj in enumerate(bpy.data.objects):
            obj.pass_index = number + 1
        names = {obj.pass_index: obj.name for obj in bpy.data.objects}
        exported = exported_scene()
        with tempfile.TemporaryDirectory() as folder:
            met, places, indices = cycles_view(Path(folder) / "view.exr")
        self.assertGreater(met.mean(), 0.02, "Cycles sees next to nothing")
        self.assertTrue((indices[met] > 0).all())
        tree = tree_of(exported)
        eye = scene.camera.matrix_world.translation
        strands = any(mesh.radii is not None for mesh in exported.meshes)
        far, before = (FAR_OF_STRANDS, BEFORE) if strands else (FAR, FAR)
        wrong: dict[str, int] = {}
        for y, x in zip(*np.nonzero(met)):
            place = Vector(places[y, x])
            nearest = tree.find_nearest(place)[3]
            hit = tree.ray_cast(eye, place - eye, (place - eye).length - before)[0]
            if nearest is None or nearest > far or hit is not None:
                name = names.get(int(indices[y, x]), "?")
                wrong[name] = wrong.get(name, 0) + 1
        self.assertLessEqual(sum(wrong.values()), STRAY * met.sum(), f"points of Cycles that are not exported: {wrong}")
        self.assertEqual(self.seen_by_us_alone(exported, tree, met), 0, "pixels where Cycles sees nothing")

    def seen_by_us_alone(self, exported, tree, met) -> int:
        matrix = exported.camera.matrix
        left, right, bottom, top = exported.camera.view_plane
        parallel = exported.camera.projection == "orthographic"
        padded = np.pad(met, 1, constant_values=True)
        around = sum(padded[i : i + HEIGHT, j : j + WIDTH].astype(int) for i in range(3) for j in range(3))
        count = 0
        for y, x in zip(*np.nonzero(around == 0)):
            across, up = left + (right - left) * (x + 0.5) / WIDTH, top - (top - bottom) * (y + 0.5) / HEIGHT
            start, ray = ((across, up, 0), (0, 0, -1)) if parallel else ((0, 0, 0), (across, up, -1))
            origin = Vector(matrix[:3, 3] + matrix[:3, :3] @ start)
            count += tree.ray_cast(origin, Vector(matrix[:3, :3] @ ray))[0] is not None
        return count


def _add(entry) -> None:
    def test(self):
        if bpy.app.version[:2] < entry.since:
            self.skipTest(f"since Blender {entry.since}")
        if entry.name == "deformation-fluid_domain" and bpy.app.version[:2] == (4, 3) and sys.version_info >= (3, 13):
            self.skipTest("this Blender's fluids end it with this Python")
        self.check(entry)

    setattr(Shapes, f"test_{entry.name.replace('-', '_')}", test)


for _entry in [*(e for name, e in SCENES.items() if name.split("-")[0] in TOPICS), *forms.SCENES]:
    _add(_entry)
