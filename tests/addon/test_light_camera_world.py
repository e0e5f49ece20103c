# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights in radiometric units, the camera's view plane, film and world."""

from __future__ import annotations

import itertools
import math
import tempfile

import bpy
import numpy as np
from mathutils import Vector
from support import SceneTest
from wardmis import compat
from wardmis.export import ExportError
from wardmis.export.camera import full_resolution, view_plane

NEW = compat.LIGHTS_OF_4_0


class Lights(SceneTest):
    def light(self, kind: str, **settings):
        data = bpy.data.lights.new("Light", kind)
        data.energy = 100
        for name, value in settings.items():
            setattr(data, name, value)
        return self.add("Light", data)

    def only(self):
        scene = self.gather()
        self.assertEqual(len(scene.lights), 1, scene.notes)
        return scene.lights[0]

    def test_area_lights_give_their_power(self):
        for shape, size, area in (
            ("SQUARE", (2, 9), 4),
            ("RECTANGLE", (2, 3), 6),
            ("DISK", (2, 9), math.pi),
            ("ELLIPSE", (2, 3), 1.5 * math.pi),
        ):
            with self.subTest(shape):
                obj = self.light("AREA", shape=shape, size=size[0], size_y=size[1])
                light = self.only()
                self.assertAlmostEqual(light.emission, 100 / ((math.pi if NEW else 4) * area), 4)
                self.assertEqual(light.shape, "ellipse" if shape in {"DISK", "ELLIPSE"} else "rectangle")
                self.assertAlmostEqual(light.spread, math.pi, 5)
                bpy.data.objects.remove(obj)

    def test_scale_makes_an_area_light_larger_and_weaker(self):
        self.light("AREA", size=1).scale = (2, 5, 1)
        self.assertAlmostEqual(self.only().emission, 10 / (math.pi if NEW else 4), 5)

    def under_sheared_parent(self, obj):
        parent = self.add("Parent", None)
        parent.scale = 1, 3, 0.5
        obj.parent = parent
        obj.rotation_euler = 0.4, 0.7, 1.1
        bpy.context.view_layer.update()
        return np.array(obj.matrix_world)[:3, :3]

    def test_sheared_area_light_gives_its_power(self):
        """Over the area that its axes span, which are not orthogonal."""
        axes = self.under_sheared_parent(self.light("AREA", shape="RECTANGLE", size=2, size_y=3))
        light = self.only()
        np.testing.assert_allclose(light.matrix[:3, :3], axes, atol=1e-6)
        area = 6 * np.linalg.norm(np.cross(axes[:, 0], axes[:, 1]))
        self.assertLess(area, 5.9 * np.prod(np.linalg.norm(axes[:, :2], axis=0)))
        self.assertAlmostEqual(light.emission, 100 / ((math.pi if NEW else 4) * area), 4)

    def test_sheared_area_lights_that_cycles_has_not_are_named(self):
        """And no others: what Cycles renders is held against the integral over the lamp, point by point."""
        for shape, spread, named in (
            ("RECTANGLE", math.pi, True),
            ("ELLIPSE", math.pi, False),
            ("RECTANGLE", 2.0, True),
            ("ELLIPSE", 2.0, NEW),
        ):
            with self.subTest(shape, spread=spread):
                obj = self.light("AREA", shape=shape, size=2, size_y=1.2, spread=spread)
                obj.location.z = 2
                obj.parent = self.add("Parent", None)
                obj.parent.scale, obj.parent.rotation_euler.z = (0.6, 1.5, 1), 0.5
                obj.rotation_euler.z = 0.6
                bpy.context.view_layer.update()
                notes = [n for n in self.gather().notes if "Cycles' picture is not that of this shape" in n]
                self.assertEqual(len(notes), int(named))
                ratio = self.lit_by_cycles() / self.lit_by_lamp(np.array(obj.matrix_world), shape, spread)
                worst = np.abs(ratio - 1).max()
                if named:
                    self.assertGreater(worst, 0.15)
                else:
                    self.assertLess(worst, 0.08)
                bpy.data.objects.remove(obj)

    POINTS = (np.arange(4) + 0.5) * 0.75 - 1.5  # in x and in y, on a floor below the lamp

    def lit_by_cycles(self) -> np.ndarray:
        """Radiance at POINTS of a white diffuse floor."""
        scene = self.scene
        if "Floor" not in scene.objects:
            floor = self.add_quad("Floor")
            floor.scale = 9, 9, 1
            white = bpy.data.materials.new("White")
            white.use_nodes = True
            nodes, links = white.node_tree.nodes, white.node_tree.links
            nodes.clear()
            diffuse = nodes.new("ShaderNodeBsdfDiffuse")
            diffuse.inputs["Color"].default_value = 1, 1, 1, 1
            links.new(diffuse.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
            floor.data.materials.append(white)
            self.camera.location.z = 9
            self.camera.data.type, self.camera.data.ortho_scale = "ORTHO", 3
            scene.render.resolution_x = scene.render.resolution_y = 4
            scene.render.resolution_percentage = 100
            scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
            scene.cycles.light_sampling_threshold = 0
            scene.cycles.samples, scene.cycles.max_bounces = 1024, 0
            for name, value in (("media_type", "IMAGE"), ("file_format", "OPEN_EXR"), ("color_depth", "32")):
                if hasattr(scene.render.image_settings, name):
                    setattr(scene.render.image_settings, name, value)
        scene.render.engine = "CYCLES"
        with tempfile.TemporaryDirectory() as folder:
            scene.render.filepath = f"{folder}/lit.exr"
            bpy.ops.render.render(write_still=True)
            image = bpy.data.images.load(scene.render.filepath)
            pixels = np.array(image.pixels[:]).reshape(4, 4, 4)[..., 0]
            bpy.data.images.remove(image)
        scene.render.engine = "WARDMIS"
        return pixels

    def lit_by_lamp(self, matrix: np.ndarray, shape: str, spread: float) -> np.ndarray:
        """The same of a lamp that has its 100 W: the integral over its points, and over each pixel's."""
        u, v = (np.mgrid[0:120, 0:120] + 0.5) / 120 - 0.5
        inside = (u**2 + v**2 < 0.25) | (shape == "RECTANGLE")
        u, v = u[inside][:, None], v[inside][:, None]
        x, y = matrix[:3, 0] * 2, matrix[:3, 1] * 1.2
        points = matrix[:3, 3] + u * x + v * y
        normal = -np.cross(x, y) / np.linalg.norm(np.cross(x, y))
        lit = np.zeros((4, 4))
        for (row, column), offset in itertools.product(np.ndindex(4, 4), itertools.product((-0.2, 0.2), repeat=2)):
            way = points - (self.POINTS[column] + offset[0], self.POINTS[row] + offset[1], 0)
            distance = np.linalg.norm(way, axis=1)
            cosine = -(way @ normal) / distance
            light = way[:, 2] / distance * cosine / distance**2
            if spread < 3:
                tangent = np.sqrt(np.maximum(0, 1 - cosine**2)) / cosine
                light *= np.maximum(0, math.tan(spread / 2) - tangent) / (math.tan(spread / 2) - spread / 2)
            lit[row, column] += light.mean() / 4
        return lit * 100 / (math.pi if NEW else 4) / math.pi

    def test_cone_of_a_sheared_spot(self):
        """Round until 4.0, then as the axes have it."""
        axes = self.under_sheared_parent(self.light("SPOT"))
        exported = self.only().matrix[:3, :3]
        if NEW:
            np.testing.assert_allclose(exported, axes, atol=1e-6)
        else:
            np.testing.assert_allclose(exported.T @ exported, np.eye(3), atol=1e-6)
            np.testing.assert_allclose(exported[:, 2], axes[:, 2] / np.linalg.norm(axes[:, 2]), atol=1e-6)

    def test_area_light_without_area_is_noted(self):
        self.light("AREA", size=1).scale = (0, 1, 1)
        scene = self.gather()
        self.assertEqual(scene.lights, [])
        self.assertIn("light 'Light': its area is zero", scene.notes[0])

    def test_light_that_is_not_finite_is_an_error(self):
        obj = self.light("POINT", color=(1, float("nan"), 1))
        with self.assertRaisesRegex(ExportError, "light 'Light': its power or colour is not a finite number"):
            self.gather()
        obj.data.color, obj.data.energy = (1, 1, 1), float("inf")
        with self.assertRaises(ExportError):
            self.gather()
        obj.data.energy, obj.data.shadow_soft_size = 1, float("nan")
        with self.assertRaisesRegex(ExportError, "light 'Light': its radius is not a finite number"):
            self.gather()

    def test_point_light(self):
        self.light("POINT", shadow_soft_size=0.5, color=(1, 0.5, 0.25))
        light = self.only()
        self.assertAlmostEqual(light.emission, 100 / (4 * math.pi), 5)
        self.assertEqual((light.radius, light.color, light.facing), (0.5, (1, 0.5, 0.25), True))

    def test_true_spheres_where_blender_has_them(self):
        obj = self.light("POINT", shadow_soft_size=0.5)
        if hasattr(obj.data, "use_soft_falloff"):
            obj.data.use_soft_falloff = False
            self.assertFalse(self.only().facing)
        else:
            self.assertTrue(self.only().facing)

    def test_spot_light(self):
        self.light("SPOT", spot_size=1.25, spot_blend=0.25, shadow_soft_size=0)
        light = self.only()
        self.assertAlmostEqual(light.emission, 100 / (4 * math.pi), 5)
        self.assertEqual((light.angle, light.blend, light.cosine), (1.25, 0.25, not NEW))

    def test_sun(self):
        for angle in (0, 0.01, 1.0, 3.0):
            with self.subTest(angle):
                obj = self.light("SUN", angle=angle)
                obj.data.energy = 2
                # what a disk of Cycles' radiance gives a surface that faces it, by its own formula
                h = angle / 2
                expected = 2 if NEW or h == 0 else 2 * 2 * (1 / math.cos(h) - 1) / math.tan(h) ** 2
                self.assertAlmostEqual(self.only().emission, expected, 4)
                self.assertEqual(self.only().flat, not NEW and h > 0)  # its radiance grows towards the rim
                bpy.data.objects.remove(obj)

    def test_sun_as_wide_as_the_sky(self):
        self.light("SUN", angle=math.pi)
        scene = self.gather()
        if NEW:
            self.assertAlmostEqual(scene.lights[0].emission, 100, 4)
        else:  # its disk is infinitely far aside
            self.assertEqual(scene.lights, [])
            self.assertIn("light 'Light': a sun as wide as the sky gives no light", scene.notes[0])

    def test_exposure_temperature_and_normalization(self):
        obj = self.light("AREA", size=2, shape="SQUARE")
        if not hasattr(obj.data, "normalize"):
            self.skipTest("this Blender has none of them")
        obj.data.exposure, obj.data.normalize = 3, False
        self.assertAlmostEqual(self.only().emission, 800 / math.pi, 3)
        obj.data.use_temperature, obj.data.temperature = True, 3000
        red, green, blue = self.only().color
        self.assertGreater(red, green)
        self.assertGreater(green, blue)

    def test_node_tree_multiplies(self):
        data = self.light("POINT").data
        data.use_nodes = True
        emission = next(n for n in data.node_tree.nodes if n.bl_idname == "ShaderNodeEmission")
        emission.inputs["Color"].default_value = (0.5, 1, 1, 1)
        emission.inputs["Strength"].default_value = 4
        self.assertEqual(self.only().color, (2, 4, 4))
        self.assertIsNone(self.only().program)
        texture = data.node_tree.nodes.new("ShaderNodeTexChecker")
        data.node_tree.links.new(texture.outputs["Color"], emission.inputs["Color"])
        texture.inputs["Color1"].default_value, texture.inputs["Color2"].default_value = (0.8, 0, 0, 1), (0.2, 0, 1, 1)
        light = self.only()
        self.assertEqual(light.color, (4, 4, 4))
        self.assertIn("checker", [o["op"] for o in light.program.operations])
        self.assertEqual(light.program.operations[light.result]["op"], "mix")
        self.assertEqual(self.gather().notes, [])

    def test_nodes_of_a_light_as_cycles_sees_them(self):
        data = self.light("POINT").data
        data.use_nodes = True
        tree = data.node_tree
        emission = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeEmission")
        falloff = tree.nodes.new("ShaderNodeLightFalloff")
        falloff.inputs["Strength"].default_value = 7
        tree.links.new(falloff.outputs["Quadratic"], emission.inputs["Strength"])
        self.assertEqual(self.only().color, (7, 7, 7))
        self.assertEqual(self.gather().notes, [])
        tree.links.new(falloff.outputs["Linear"], emission.inputs["Strength"])
        self.assertEqual(self.only().program.operations[0]["op"], "light-falloff-linear")
        self.assertEqual(self.gather().notes, [])
        emission.mute = True
        scene = self.gather()
        self.assertEqual(scene.lights, [])
        body = tree.nodes.new("ShaderNodeBlackbody")
        body.inputs[0].default_value = 3000
        tree.links.new(body.outputs[0], tree.get_output_node("ALL").inputs["Surface"])  # a colour shines
        red, green, blue = self.only().color
        self.assertGreater(red, green)
        self.assertGreater(green, blue)

    def test_lights_that_give_no_light_are_left_out(self):
        self.light("POINT").data.energy = 0
        self.light("POINT").data.color = (0, 0, 0)
        portal = self.light("AREA").data
        portal.cycles.is_portal = True
        scene = self.gather()
        self.assertEqual((scene.lights, scene.notes), ([], []))

    def test_negative_light_takes_light_away(self):
        self.light("POINT").data.energy = -5
        light = self.only()
        self.assertAlmostEqual(light.emission, -5 / (4 * math.pi), 6)

    def test_shadow_and_visibility(self):
        obj = self.light("POINT")
        obj.visible_camera, obj.visible_glossy = False, False
        if hasattr(obj.data.cycles, "cast_shadow"):
            obj.data.cycles.cast_shadow = False
        else:
            obj.data.use_shadow = False
        obj.data.cycles.max_bounces = 3
        light = self.only()
        self.assertFalse(light.shadow)
        self.assertEqual(light.max_bounces, 3)
        self.assertEqual(light.hidden_from, {"camera", "glossy"})


class Camera(SceneTest):
    def test_view_plane_is_that_of_blenders_own_matrix(self):
        render, data = self.scene.render, self.camera.data
        combinations = itertools.product(
            ("PERSP", "ORTHO"),
            ("AUTO", "HORIZONTAL", "VERTICAL"),
            ((160, 90), (90, 160), (100, 100)),
            ((1, 1), (2, 1), (1, 1.5)),
            (0, 0.3),
        )
        for kind, fit, (width, height), (ax, ay), shift in combinations:
            with self.subTest(f"{kind} {fit} {width}x{height} {ax}:{ay} {shift}"):
                data.type, data.sensor_fit, data.sensor_width, data.sensor_height = kind, fit, 36, 20
                data.lens, data.ortho_scale, data.shift_x, data.shift_y = 40, 5, shift, -shift / 2
                render.resolution_x, render.resolution_y, render.pixel_aspect_x, render.pixel_aspect_y = (
                    width,
                    height,
                    ax,
                    ay,
                )
                left, right, bottom, top = view_plane(data, render, full_resolution(render))
                depsgraph = bpy.context.evaluated_depsgraph_get()
                matrix = self.camera.calc_matrix_camera(depsgraph, x=width, y=height, scale_x=ax, scale_y=ay)
                for x, sx in ((left, -1), (right, 1)):
                    for y, sy in ((bottom, -1), (top, 1)):
                        point = matrix @ Vector((x, y, -1, 1))
                        np.testing.assert_allclose((point.x / point.w, point.y / point.w), (sx, sy), atol=1e-5)

    def test_scale_of_the_camera_does_not_count(self):
        self.camera.scale = (2, 3, 4)
        self.camera.rotation_euler = (1, 0.5, 0.2)
        matrix = self.gather().camera.matrix
        np.testing.assert_allclose(matrix[:3, :3].T @ matrix[:3, :3], np.eye(3), atol=1e-6)

    def test_depth_of_field(self):
        dof = self.camera.data.dof
        dof.use_dof, dof.focus_distance, dof.aperture_fstop, dof.aperture_blades = True, 3, 1.4, 5
        self.camera.data.lens = 35
        camera = self.gather().camera
        self.assertAlmostEqual(camera.lens_radius, 0.035 / 2.8, 6)
        self.assertEqual((camera.focus_distance, camera.blades), (3, 5))
        dof.focus_distance = 0
        self.assertEqual(self.gather().camera.focus_distance, 1e-5)  # as in Cycles
        dof.aperture_fstop = 0
        self.assertAlmostEqual(self.gather().camera.lens_radius, 0.035 / 2e-5, 1)
        dof.aperture_fstop = 1.4
        focus = self.add("Focus", None)
        focus.location = (2, 0, -7)
        dof.focus_object, dof.aperture_blades, self.camera.data.type = focus, 2, "ORTHO"
        camera = self.gather().camera
        self.assertAlmostEqual(camera.focus_distance, 7, 5)
        self.assertAlmostEqual(camera.lens_radius, 1 / 2.8, 6)
        self.assertEqual(camera.blades, 0)

    def test_number_that_is_not_finite(self):
        self.camera.data.shift_x = math.nan
        with self.assertRaisesRegex(ExportError, "camera 'Camera': its view plane is not a finite number"):
            self.gather()

    def test_clip_distances_the_wrong_way_round(self):
        self.camera.data.clip_start = 1e6
        with self.assertRaisesRegex(ExportError, "camera 'Camera' sees nothing: its Clip Start"):
            self.gather()

    def test_panoramas(self):
        data, render = self.camera.data, self.scene.render
        data.type, data.shift_x, data.shift_y = "PANO", 0.1, 0.25
        render.resolution_x, render.resolution_y = 300, 200
        settings = compat.panorama_settings(data)
        settings.fisheye_fov, settings.fisheye_lens, data.sensor_width = 2.0, 9.0, 36.0
        settings.longitude_min, settings.latitude_max = -1.0, 0.5
        half = math.pi / 4
        expected = {
            "EQUIRECTANGULAR": ("equirectangular", (-1, math.pi, -math.pi / 2, 0.5)),
            "EQUIANGULAR_CUBEMAP_FACE": ("equiangular-cube-face", (-half, half, -half, half)),
            "MIRRORBALL": ("mirror-ball", (-1, 1, -1, 1)),
            "FISHEYE_EQUIDISTANT": ("fisheye-equidistant", (-1, 1, -1, 1)),
            "FISHEYE_EQUISOLID": ("fisheye-equisolid", (-2, 2, -4 / 3, 4 / 3)),
            "FISHEYE_LENS_POLYNOMIAL": ("fisheye-polynomial", (-18, 18, -12, 12)),
        }
        kinds = {e.identifier for e in settings.bl_rna.properties["panorama_type"].enum_items}
        if "CENTRAL_CYLINDRICAL" in kinds:
            settings.central_cylindrical_radius, settings.central_cylindrical_range_v_max = 2, 3
            expected["CENTRAL_CYLINDRICAL"] = ("central-cylindrical", (-math.pi, math.pi, -0.5, 1.5))
        self.assertEqual(set(expected), kinds)
        for kind, (projection, (left, right, bottom, top)) in expected.items():
            with self.subTest(kind):
                settings.panorama_type = kind
                data.update_tag()  # for what was Cycles' own
                camera = self.gather().camera
                self.assertEqual(camera.projection, projection)
                x, y = 0.1 * (right - left), 0.25 * (top - bottom)
                np.testing.assert_allclose(camera.view_plane, (left + x, right + x, bottom + y, top + y), 1e-6)
                self.assertEqual(camera.fov, 2.0 if "FISHEYE" in kind else None)
        settings.panorama_type, settings.longitude_max = "EQUIRECTANGULAR", -1.0
        data.update_tag()
        with self.assertRaisesRegex(ExportError, "camera 'Camera' sees nothing: its panorama"):
            self.gather()

    def test_no_camera(self):
        self.scene.camera = None
        with self.assertRaisesRegex(ExportError, "no active camera"):
            self.gather()

    def test_active_camera_that_is_no_camera(self):
        self.scene.camera = self.add("Camera", bpy.data.cameras.new("Camera"))
        expected = self.gather().camera
        self.scene.camera = self.add("Empty", None)
        found = self.gather().camera
        self.assertEqual((found.projection, found.view_plane), (expected.projection, expected.view_plane))


class Film(SceneTest):
    def test_settings(self):
        render, settings = self.scene.render, self.scene.wardmis
        film = self.gather().film
        self.assertEqual(
            (film.filter_type, film.filter_width, film.exposure, film.transparent), ("blackman-harris", 1.5, 1, False)
        )
        render.resolution_x, render.resolution_y, render.resolution_percentage = 333, 101, 50
        render.film_transparent = True
        settings.filter_type, settings.film_exposure, settings.film = "box", 2, "own"
        film = self.gather().film
        self.assertEqual((film.resolution, film.border), ((166, 50), (0, 0, 166, 50)))
        self.assertEqual((film.filter_type, film.exposure, film.transparent), ("box", 2, True))

    def test_film_is_cycles_unless_told(self):
        cycles = self.scene.cycles
        cycles.film_exposure, cycles.pixel_filter_type, cycles.filter_width = 1.75, "GAUSSIAN", 2.5
        film = self.gather().film
        self.assertEqual((film.filter_type, film.filter_width, film.exposure), ("gaussian", 2.5, 1.75))

    def test_alpha_threshold_of_passes(self):
        self.assertEqual(self.gather().film.alpha_threshold, 0.5)
        layer = bpy.context.view_layer
        self.addCleanup(setattr, layer, "pass_alpha_threshold", layer.pass_alpha_threshold)
        layer.pass_alpha_threshold = 0.25
        self.assertEqual(self.gather().film.alpha_threshold, 0.25)

    def test_transparent_glass_is_named(self):
        cycles = self.scene.cycles
        self.addCleanup(setattr, cycles, "film_transparent_glass", cycles.film_transparent_glass)
        cycles.film_transparent_glass = True
        self.assertEqual(self.gather().notes, [])
        self.scene.render.film_transparent = True
        self.addCleanup(setattr, self.scene.render, "film_transparent", False)
        self.assertIn("Transparent Glass is not supported", "\n".join(self.gather().notes))

    def test_border_without_pixels(self):
        render = self.scene.render
        render.use_border, render.border_min_x, render.border_max_x = True, 0.5, 0.5001
        with self.assertRaisesRegex(ExportError, "the render region holds no pixel"):
            self.gather()


class World(SceneTest):
    def setUp(self) -> None:
        super().setUp()
        self.world = self.scene.world = bpy.data.worlds.new("World")
        self.world.use_nodes = True
        self.tree = self.world.node_tree
        self.background = next(n for n in self.tree.nodes if n.bl_idname == "ShaderNodeBackground")
        self.background.inputs["Color"].default_value = (0.1, 0.2, 0.4, 1)
        self.background.inputs["Strength"].default_value = 2

    def only(self, scene):
        """The sky of a scene that has one for all rays."""
        (world,) = scene.worlds
        self.assertEqual(world.hidden_from, frozenset())
        return world

    def test_no_world_is_black(self):
        self.scene.world = None
        self.assertEqual(self.gather().worlds, [])

    def test_background(self):
        np.testing.assert_allclose(self.only(self.gather()).radiance, (0.2, 0.4, 0.8))

    def test_background_that_is_not_finite(self):
        self.background.inputs["Strength"].default_value = math.nan
        scene = self.gather()
        self.assertEqual(scene.worlds, [])
        self.assertIn(
            "world 'World': node 'Background' (Background) has a 'Strength' that is not a finite number", scene.notes[0]
        )

    def test_limit_of_an_image(self):
        self.world.cycles.max_bounces = 2
        self.assertEqual(self.only(self.gather()).max_bounces, 1024)  # one colour has none, as in Cycles
        node = self.world.node_tree.nodes.new("ShaderNodeTexEnvironment")
        node.image = bpy.data.images.new("Sky", 4, 2)
        self.world.node_tree.links.new(node.outputs[0], self.background.inputs["Color"])
        scene = self.gather()
        self.assertEqual((self.only(scene).max_bounces, scene.notes), (2, []))

    def test_negative_background_takes_light_away(self):
        self.background.inputs["Strength"].default_value = -1
        scene = self.gather()
        np.testing.assert_allclose(self.only(scene).radiance, (-0.1, -0.2, -0.4))
        self.assertEqual(scene.notes, [])

    def test_color_without_nodes(self):
        if compat.VERSION >= (5, 0, 0):
            self.skipTest("this Blender's worlds always have nodes")
        self.world.use_nodes, self.world.color = False, (0.3, 0.2, 0.1)
        np.testing.assert_allclose(self.only(self.gather()).radiance, (0.3, 0.2, 0.1))

    def environment(self, mapping_type: str | None, rotation=(0, 0, 0), scale=(1, 1, 1)):
        node = self.tree.nodes.new("ShaderNodeTexEnvironment")
        node.image = bpy.data.images.new("Sky", 8, 4, float_buffer=True)
        self.tree.links.new(node.outputs["Color"], self.background.inputs["Color"])
        if mapping_type:
            coordinates, mapping = self.tree.nodes.new("ShaderNodeTexCoord"), self.tree.nodes.new("ShaderNodeMapping")
            mapping.vector_type = mapping_type
            mapping.inputs["Rotation"].default_value, mapping.inputs["Scale"].default_value = rotation, scale
            self.tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
            self.tree.links.new(mapping.outputs["Vector"], node.inputs["Vector"])
        return node

    def test_environment_texture(self):
        self.environment(None)
        scene = self.gather()
        self.assertEqual(self.only(scene).radiance, (2, 2, 2))
        self.assertEqual(scene.images[scene.textures[self.only(scene).texture].image].name, "Sky")
        np.testing.assert_array_equal(self.only(scene).matrix, np.eye(3))
        self.assertEqual(scene.notes, [])

    def test_mapping_turns_the_environment(self):
        quarter = (0, 0, math.pi / 2)
        for kind, turned in (
            ("POINT", (0, 1, 0)),
            ("VECTOR", (0, 1, 0)),
            ("NORMAL", (0, 1, 0)),
            ("TEXTURE", (0, -1, 0)),
        ):
            with self.subTest(kind):
                self.environment(kind, quarter)
                scene = self.gather()
                np.testing.assert_allclose(self.only(scene).matrix @ (1, 0, 0), turned, atol=1e-6)
                self.assertEqual(scene.notes, [])

    def test_mapping_mirrors_the_environment(self):
        self.environment("POINT", scale=(-1, 1, 1))
        np.testing.assert_allclose(self.only(self.gather()).matrix, np.diag((-1, 1, 1)), atol=1e-6)

    def test_mapping_stretches_the_environment(self):
        for kind, stretched in (("POINT", (2, 1, -4)), ("TEXTURE", (0.5, 1, -0.25)), ("NORMAL", (0.5, 1, -0.25))):
            with self.subTest(kind):
                self.environment(kind, scale=(2, 1, -4))
                scene = self.gather()
                np.testing.assert_allclose(self.only(scene).matrix, np.diag(stretched), atol=1e-6)
                self.assertEqual(scene.notes, [])

    def test_what_is_more_than_an_image_is_a_program(self):
        self.environment("POINT", scale=(1, 0, 1))
        scene = self.gather()
        self.assertEqual(self.only(scene).texture, None)
        names = [o["op"] for o in self.only(scene).program.operations]
        self.assertEqual(
            (names, self.only(scene).radiance, scene.notes), (["direction", "mapping", "environment"], (2, 2, 2), [])
        )

    def test_mirror_ball(self):
        self.environment("POINT", scale=(1, 2, 1)).projection = "MIRROR_BALL"
        scene = self.gather()
        self.assertEqual((self.only(scene).projection, scene.notes), ("mirror-ball", []))

    def test_volume_is_noted(self):
        volume = self.tree.nodes.new("ShaderNodeVolumeScatter")
        self.tree.links.new(volume.outputs[0], self.tree.get_output_node("ALL").inputs["Volume"])
        self.assertIn("world 'World': volumes are not supported", "\n".join(self.gather().notes))

    def test_ray_visibility(self):
        self.world.cycles_visibility.camera = self.world.cycles_visibility.glossy = False
        (world,) = self.gather().worlds
        self.assertEqual(world.hidden_from, {"camera", "glossy"})
        self.world.cycles_visibility.diffuse = self.world.cycles_visibility.transmission = False
        self.world.update_tag()
        self.assertEqual(self.gather().worlds, [])

    def test_light_path_makes_skies_for_kinds_of_ray(self):
        """Those that see the same share one; what is known of the ray's kind is nothing to note."""
        seen = {
            "Is Camera Ray": [(2, {"camera"}), (1, {"diffuse", "glossy", "transmission"})],
            "Is Diffuse Ray": [(1, {"camera", "glossy", "transmission"}), (2, {"diffuse"})],
            "Is Glossy Ray": [(1, {"camera", "diffuse"}), (2, {"glossy", "transmission"})],
            "Is Reflection Ray": [(1, {"camera", "transmission"}), (2, {"diffuse", "glossy"})],
            "Is Transmission Ray": [(1, {"camera", "diffuse", "glossy"}), (2, {"transmission"})],
            "Is Shadow Ray": [(1, {"camera", "diffuse", "glossy", "transmission"})],
        }
        path, add = self.tree.nodes.new("ShaderNodeLightPath"), self.tree.nodes.new("ShaderNodeMath")
        add.inputs[1].default_value = 1
        self.tree.links.new(add.outputs[0], self.background.inputs["Strength"])
        self.background.inputs["Color"].default_value = (1, 1, 1, 1)
        self.world.cycles.max_bounces = 3
        for output, expected in seen.items():
            with self.subTest(output):
                self.tree.links.new(path.outputs[output], add.inputs[0])
                scene = self.gather()
                kinds = {"camera", "diffuse", "glossy", "transmission"}
                self.assertEqual([(w.radiance[0], kinds - w.hidden_from) for w in scene.worlds], expected)
                self.assertEqual(scene.notes, [])
                self.assertEqual({w.max_bounces for w in scene.worlds}, {3 if len(expected) > 1 else 1024})
        self.tree.links.new(path.outputs["Diffuse Depth"], add.inputs[0])
        self.assertIn("0 as its Diffuse Depth is used instead", self.gather().notes[0])
        self.tree.links.new(path.outputs["Ray Depth"], add.inputs[0])
        scene = self.gather()
        ours = next(w for w in scene.worlds if "camera" not in w.hidden_from)
        other = next(w for w in scene.worlds if "camera" in w.hidden_from)
        self.assertEqual((ours.program, other.program.operations[0]["op"]), (None, "ray-depth"))
        self.assertIn("where the world is aimed at", scene.notes[0])

    def test_missing_image_is_magenta(self):
        self.environment(None).image = None
        scene = self.gather()
        self.assertEqual(self.only(scene).radiance, (2, 0, 2))
        self.assertIn("world 'World': node 'Environment Texture' (Environment Texture) has no image", scene.notes[0])

    def test_worlds_of_other_nodes(self):
        output = self.tree.get_output_node("ALL").inputs["Surface"]
        rgb, value = self.tree.nodes.new("ShaderNodeRGB"), self.tree.nodes.new("ShaderNodeValue")
        rgb.outputs[0].default_value, value.outputs[0].default_value = (0.1, 0.2, 0.3, 1), 3
        emission = self.tree.nodes.new("ShaderNodeEmission")
        emission.inputs["Color"].default_value, emission.inputs["Strength"].default_value = (0.5, 0.25, 1, 1), 2
        mix = self.tree.nodes.new("ShaderNodeMixShader")
        mix.inputs[0].default_value = 0.25
        self.tree.links.new(emission.outputs[0], mix.inputs[1])
        self.tree.links.new(self.background.outputs[0], mix.inputs[2])
        diffuse = self.tree.nodes.new("ShaderNodeBsdfDiffuse")
        group = bpy.data.node_groups.new("G", "ShaderNodeTree")
        compat.add_group_socket(group, "Shader", "NodeSocketShader", "OUTPUT")
        inner, end = group.nodes.new("ShaderNodeBackground"), group.nodes.new("NodeGroupOutput")
        inner.inputs["Color"].default_value, inner.inputs["Strength"].default_value = (1, 0.5, 0.25, 1), 4
        group.links.new(inner.outputs[0], end.inputs[0])
        grouped = self.tree.nodes.new("ShaderNodeGroup")
        grouped.node_tree = group
        for node, expected in (
            (rgb, (0.1, 0.2, 0.3)),
            (value, (3, 3, 3)),
            (emission, (1, 0.5, 2)),
            (mix, (0.75 + 0.05, 0.375 + 0.1, 1.5 + 0.2)),
            (diffuse, (0, 0, 0)),  # in a world nothing is lit
            (grouped, (4, 2, 1)),
        ):
            with self.subTest(node.bl_idname):
                self.tree.links.new(node.outputs[0], output)
                scene = self.gather()
                radiance = self.only(scene).radiance if scene.worlds else (0, 0, 0)
                np.testing.assert_allclose(radiance, expected, rtol=1e-6)
                self.assertEqual(scene.notes, [])
        grouped.mute = True
        self.assertEqual(self.gather().worlds, [])

    def test_sky_behind_nodes_is_a_program(self):
        texture = self.environment(None)
        texture.image.pixels.foreach_set(
            np.tile(np.float32((0.5, 0.5, 0.5, 1)), 8 * 4)
        )  # some Blenders multiply by alpha
        gamma = self.tree.nodes.new("ShaderNodeGamma")
        gamma.inputs["Gamma"].default_value = 2
        self.tree.links.new(texture.outputs["Color"], gamma.inputs["Color"])
        self.tree.links.new(gamma.outputs["Color"], self.background.inputs["Color"])
        scene = self.gather()
        self.assertEqual(self.only(scene).radiance, (2, 2, 2))
        self.assertEqual([o["op"] for o in self.only(scene).program.operations], ["direction", "environment", "gamma"])
        self.assertEqual(scene.notes, [])
