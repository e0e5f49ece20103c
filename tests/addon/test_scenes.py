# SPDX-License-Identifier: GPL-3.0-or-later
"""The Blender files of blend/: that they hold what their names promise, and that make_scenes.py still makes them."""

import subprocess
import sys
import tempfile
import unittest
from collections import Counter
from pathlib import Path

import bpy
import numpy as np
from wardmis.export.scene import gather_scene

BLEND = Path(__file__).resolve().parents[2] / "blend"
sys.path.insert(0, str(BLEND))

import make_scenes  # noqa: E402
from teapot_patches import patches, tessellate  # noqa: E402


def export_open_file():
    bpy.context.view_layer.update()
    return gather_scene(bpy.context.evaluated_depsgraph_get(), "test")


class Files(unittest.TestCase):
    def open(self, name):
        bpy.ops.wm.open_mainfile(filepath=str(BLEND / f"{name}.blend"), load_ui=False)
        self.addCleanup(lambda: bpy.ops.wm.read_homefile(use_factory_startup=True))
        return export_open_file()

    def material(self, scene, name):
        return next(material for material in scene.materials if material.name == name)

    def test_every_file_is_small_and_renders_with_wardmis_without_a_note(self):
        for name in make_scenes.SCENES:
            with self.subTest(name):
                scene = self.open(name)
                self.assertEqual(scene.notes, [])
                self.assertEqual(bpy.context.scene.render.engine, "WARDMIS")
                self.assertEqual(bpy.context.scene.view_settings.view_transform, "Standard")
                stiff = name.startswith("stiff-")
                size = (512, 256) if name == "furnace" else (512, 384) if stiff else (768, 512)
                self.assertEqual(scene.film.resolution, size)
                self.assertLess((BLEND / f"{name}.blend").stat().st_size, 100_000 if stiff else 1 << 20)

    def test_cycles_is_set_up_without_bias(self):
        for name in make_scenes.SCENES:
            self.open(name)
            cycles = bpy.context.scene.cycles
            self.assertEqual((cycles.sample_clamp_direct, cycles.sample_clamp_indirect), (0, 0))
            self.assertEqual((cycles.blur_glossy, cycles.light_sampling_threshold), (0, 0))
            self.assertFalse(cycles.use_adaptive_sampling or cycles.use_denoising)

    def test_script_makes_what_is_committed(self):
        with tempfile.TemporaryDirectory() as folder:
            here, make_scenes.HERE = make_scenes.HERE, Path(folder)
            self.addCleanup(lambda: setattr(make_scenes, "HERE", here))
            for name in make_scenes.SCENES:
                if name == "studio" and bpy.app.version >= (4, 0):
                    continue  # its script gives Principled's inputs the names of 3.4, which has made the file
                with self.subTest(name):
                    committed = self.open(name)
                    make_scenes.make(name)
                    made = export_open_file()
                    self.assertEqual(made.materials, committed.materials)
                    self.assertEqual(made.film, committed.film)
                    self.assertEqual([light.name for light in made.lights], [light.name for light in committed.lights])
                    for a, b in zip(made.meshes, committed.meshes, strict=True):
                        np.testing.assert_array_equal(a.positions, b.positions)

    def test_teapot(self):
        scene = self.open("teapot")
        glaze = self.material(scene, "Glaze")
        self.assertEqual((glaze.variant, glaze.alpha_x), ("ward", glaze.alpha_y))
        teapot = next(mesh for mesh in scene.meshes if mesh.name == "Teapot")
        self.assertIsNotNone(teapot.normals)
        self.assertGreater(sum(len(primitive.triangles) for primitive in teapot.primitives), 30000)
        self.assertEqual(scene.images[scene.textures[scene.worlds[0].texture].image].mime_type, "image/x-exr")
        self.assertEqual(scene.lights, [])

    def test_sky_of_the_teapot_is_the_cosine(self):
        self.open("teapot")
        image = bpy.data.images["cosine-sky.exr"]
        self.assertIsNotNone(image.packed_file)
        radiance = np.array(image.pixels[:]).reshape(256, -1, image.channels)[..., :3]
        theta = (np.arange(256) + 0.5) / 256 * np.pi  # from straight up, the top row
        np.testing.assert_allclose(radiance[::-1, 0, 0], np.maximum(np.cos(theta), 0), atol=1e-6)
        self.assertEqual(np.ptp(radiance, axis=(1, 2)).max(), 0)
        solid_angle = np.sin(theta) * (np.pi / 256) ** 2
        irradiance = (radiance[::-1, :, 0] * (np.maximum(np.cos(theta), 0) * solid_angle)[:, None]).sum()
        self.assertAlmostEqual(irradiance, 2 * np.pi / 3, places=4)

    def test_veach_has_round_lights_of_equal_power_and_very_different_size(self):
        for name in ("veach", "veach-glossiness"):
            scene = self.open(name)
            radii = sorted(light.radius for light in scene.lights)
            self.assertEqual(len(radii), 4)
            self.assertGreater(radii[-1] / radii[0], 20)
            self.assertEqual(len({light.emission for light in scene.lights}), 1)
            self.assertTrue(all("camera" not in light.hidden_from for light in scene.lights))

    def test_plates_of_veach(self):
        plates = [m for m in self.open("veach").materials if m.name.startswith("Plate")]
        self.assertEqual(len(plates), 4)
        self.assertEqual(len({(m.variant, m.alpha_x.value, m.specular.value) for m in plates}), 1)
        plates = [m for m in self.open("veach-glossiness").materials if m.name.startswith("Plate")]
        alphas = [m.alpha_x.value for m in sorted(plates, key=lambda m: m.name)]
        self.assertEqual(len(set(alphas)), 4)
        self.assertEqual(alphas, sorted(alphas))

    def test_plates_of_veach_mirror_the_lights_into_the_camera(self):
        scene = self.open("veach")
        eye = np.array(bpy.context.scene.camera.matrix_world.translation)
        for number in range(1, 5):
            plate = bpy.data.objects[f"Plate {number}"].data.polygons[0]
            center, normal = np.array(plate.center), np.array(plate.normal)
            to_eye = (eye - center) / np.linalg.norm(eye - center)
            mirrored = 2 * (to_eye @ normal) * normal - to_eye
            to_light = -center / np.linalg.norm(center)  # the lights are on the x axis
            self.assertGreater(mirrored @ to_light, 0.999)
        self.assertEqual(scene.worlds, [])

    def test_spheres_of_the_furnace_see_the_sky_alone(self):
        scene = self.open("furnace")
        self.assertEqual([(w.radiance, w.texture) for w in scene.worlds], [((1, 1, 1), None)])
        hidden = frozenset({"diffuse", "glossy", "transmission", "shadow"})
        self.assertEqual({i.hidden_from for i in scene.instances}, {hidden})
        half, ward = self.material(scene, "Half"), self.material(scene, "Ward")
        self.assertEqual((half.diffuse.value, half.specular.value), ((0.5, 0.5, 0.5), (0, 0, 0)))
        self.assertEqual(ward.variant, "ward-gmd")
        self.assertTrue(all(mesh.normals is None for mesh in scene.meshes))

    def test_stiff_scenes_are_as_extreme_as_they_say(self):
        alphas = [m.alpha_x.value for m in self.open("stiff-alphas").materials]
        np.testing.assert_allclose((min(alphas), max(alphas)), (1e-6, 10), rtol=1e-6)
        self.assertAlmostEqual(self.material(self.open("stiff-mirror"), "Mirror").alpha_x.value, 1e-4)
        self.assertEqual(sorted(round(light.size[0], 6) for light in self.open("stiff-lights").lights), [1e-4, 10])
        self.open("stiff-large")
        self.assertGreater(min(min(o.matrix_world.translation) for o in bpy.data.objects), 0.99e6)
        self.open("stiff-small")
        self.assertLess(max(max(abs(v) for v in o.matrix_world.translation) for o in bpy.data.objects), 1e-5)

    def test_stiff_mesh_is_broken(self):
        self.open("stiff-mesh")
        mesh = bpy.data.objects["Wings"].data
        edges = Counter(key for polygon in mesh.polygons for key in polygon.edge_keys)
        self.assertGreater(max(edges.values()), 2)
        self.assertTrue(any(polygon.area == 0 for polygon in mesh.polygons))
        places = [tuple(vertex.co) for vertex in mesh.vertices]
        self.assertLess(len(set(places)), len(places))


class Teapot(unittest.TestCase):
    def test_patches_are_newells(self):
        """His 32 patches have 290 different control points; the widest are the handle's and the spout's."""
        points = patches().reshape(-1, 3)
        self.assertEqual(len(points), 32 * 16)
        self.assertEqual(len(np.unique(np.round(points, 5), axis=0)), 290)
        np.testing.assert_allclose((points.min(axis=0), points.max(axis=0)), ((-3, -2, 0), (3.525, 2, 3.15)))

    def test_surface_is_closed_but_for_its_known_openings(self):
        n = 8
        _, faces = tessellate(n)
        edges = Counter()
        for face in faces.tolist():
            corners = list(dict.fromkeys(face))
            edges.update(frozenset(pair) for pair in zip(corners, corners[1:] + corners[:1]))
        self.assertEqual(max(edges.values()), 2)
        # lid and rim are rings of four patches; both ends of handle and spout of two
        self.assertEqual(sum(count == 1 for count in edges.values()), (4 + 4 + 2 * 2 + 2 * 2) * n)

    def test_surface_is_smooth_and_faces_outwards(self):
        """A crease between patches would turn the normal by the same angle however fine the grid; curvature does not."""
        n = 64
        vertices, faces = tessellate(n)
        a, b, c, d = (vertices[faces[:, i]] for i in range(4))
        normals = np.cross(c - a, d - b)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        neighbours = {}
        for index, face in enumerate(faces.tolist()):
            corners = list(dict.fromkeys(face))
            for pair in zip(corners, corners[1:] + corners[:1]):
                neighbours.setdefault(frozenset(pair), []).append(index)
        pairs = np.array([pair for pair in neighbours.values() if len(pair) == 2])
        cosines = (normals[pairs[:, 0]] * normals[pairs[:, 1]]).sum(axis=1)
        self.assertGreater(cosines.min(), np.cos(np.radians(25)))
        body = slice(4 * n * n, 12 * n * n)
        centers = (a + c)[body] / 2
        self.assertGreater((normals[body, :2] * centers[:, :2]).sum(axis=1).min(), 0)


class Scripts(unittest.TestCase):
    def test_without_arguments_they_say_how_they_are_called(self):
        for name in ("render_with", "export_scene"):
            script = BLEND / f"{name}.py"
            command = [bpy.app.binary_path, "--background", "--addons", "wardmis", "--python", script]
            done = subprocess.run(command, capture_output=True, text=True, timeout=60)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn(f"--python blend/{name}.py -- ", done.stderr)
            self.assertNotIn("Traceback", done.stderr)
