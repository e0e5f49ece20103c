# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees as Cycles of the same Blender evaluates them: hundreds of emitting patches in one picture, against the exported values."""

import math
import tempfile
from pathlib import Path

import bpy
import numpy as np
import patches
from patches import Nodes
from support import SceneTest
from wardmis.export.context import ExportContext
from wardmis.export.image import export_image
from wardmis.export.light import export_light
from wardmis.export.material import export_material

PIXELS = 4  # of a patch
# of spectra Cycles has tables with finer steps, and a fit
LOOSE = {"blackbody": 2e-3, "wavelength": 2e-3}
OF_THE_HIT = {"fresnel", "layer weight", "layer weight facing", "light falloff", "shadow ray", "camera ray"}


def materials(builders):
    """Name -> a material that emits what each builder makes."""
    made = {}
    for name, build in builders:
        material = made[name] = bpy.data.materials.new(name)
        material.use_nodes = True
        material.node_tree.nodes.clear()
        nodes = Nodes(material.node_tree)
        shown = build(nodes)
        if shown.type != "SHADER":
            shown = patches.out(nodes("Emission", shown, 1.0))
        nodes.feed(nodes("OutputMaterial").inputs["Surface"], shown)
    return made


class Patches(SceneTest):
    def compare(self, builders):
        made = materials(builders)
        colors = self.cycles(made)
        context = ExportContext(export_image)
        context.owner = "O"
        for name, material in made.items():
            with self.subTest(name):
                data = export_material(material, context)
                self.assertIsNone(data.emission.texture)
                if data.program is not None:  # of the view or the path: tests/cycles/parity.py compares these
                    self.assertIn(name, OF_THE_HIT)
                    continue
                tolerance = next((t for word, t in LOOSE.items() if name.startswith(word)), 1e-3)
                np.testing.assert_allclose(data.emission.value, colors[name], rtol=tolerance, atol=tolerance)
                self.assertFalse(any(data.diffuse.value), "magenta")
        return context

    def test_functions_of_constants_in_a_lamp(self):
        """The same trees with the same values, which are computed elsewhere."""
        builders = list(patches.functions())
        colors = self.cycles(materials(builders))
        context = ExportContext(export_image)
        lamp = bpy.data.lights.new("Lamp", "POINT")
        lamp.energy, lamp.shadow_soft_size = 4 * math.pi, 0
        lamp.use_nodes = True
        for name, build in builders:
            if name in OF_THE_HIT:
                continue
            with self.subTest(name):
                lamp.node_tree.nodes.clear()
                nodes = Nodes(lamp.node_tree)
                nodes.feed(nodes("OutputLight").inputs["Surface"], patches.out(nodes("Emission", build(nodes), 1.0)))
                data = export_light(lamp, "Lamp", np.eye(4), frozenset(), context)
                tolerance = next((t for word, t in LOOSE.items() if name.startswith(word)), 1e-3)
                found = (0, 0, 0) if data is None else np.multiply(data.color, data.emission)
                np.testing.assert_allclose(found, colors[name], rtol=tolerance, atol=tolerance)

    def cycles(self, made):
        """Name -> what Cycles shows."""
        columns = math.ceil(math.sqrt(len(made)))
        rows = math.ceil(len(made) / columns)
        for i, (name, material) in enumerate(made.items()):
            x, y = i % columns, i // columns
            corners = [(x, y, 0), (x + 1, y, 0), (x + 1, y + 1, 0), (x, y + 1, 0)]
            self.add_mesh(name, corners, [(0, 1, 2, 3)]).data.materials.append(material)
        self.camera.location = (columns / 2, rows / 2, 1)
        self.camera.data.type, self.camera.data.ortho_scale = "ORTHO", max(columns, rows)
        render, cycles = self.scene.render, self.scene.cycles
        render.engine = "CYCLES"
        render.resolution_x, render.resolution_y = columns * PIXELS, rows * PIXELS
        cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = 1, False, False
        cycles.pixel_filter_type = "BOX"
        settings = render.image_settings
        settings.file_format, settings.color_depth = "OPEN_EXR", "32"
        with tempfile.TemporaryDirectory() as folder:
            render.filepath = str(Path(folder) / "patches.exr")
            bpy.ops.render.render(write_still=True)
            image = bpy.data.images.load(render.filepath)
            image.colorspace_settings.name = "Non-Color"
            pixels = np.empty(len(image.pixels), np.float32)
            image.pixels.foreach_get(pixels)
        pixels = pixels.reshape(image.size[1], image.size[0], -1)[PIXELS // 2 :: PIXELS, PIXELS // 2 :: PIXELS, :3]
        return {name: pixels[i // columns, i % columns] for i, name in enumerate(made)}

    def test_muted_hidden_and_grouped_nodes(self):
        self.assertEqual(self.compare(patches.trees()).notes, [])

    def test_functions_of_constants(self):
        self.assertEqual(self.compare(patches.functions()).notes, [])
