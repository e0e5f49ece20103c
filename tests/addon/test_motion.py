# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves while the shutter is open, and that the scene is where it was afterwards."""

import time

import bpy
import numpy as np
from support import SceneTest
from wardmis import compat
from wardmis.export import ExportCancelled, ExportError
from wardmis.export.scene import gather_scene


def animate(obj, path, *values):
    """By steps of one frame from frame 9 on, linearly."""
    for frame, value in enumerate(values, 9):
        setattr(obj, path, value)
        obj.keyframe_insert(path, frame=frame)
    for curve in compat_curves(obj):
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"


def compat_curves(obj):
    action = obj.animation_data.action
    if hasattr(action, "fcurves"):
        return action.fcurves
    return [c for layer in action.layers for strip in layer.strips for bag in strip.channelbags for c in bag.fcurves]


class Motion(SceneTest):
    def setUp(self):
        super().setUp()
        self.scene.render.use_motion_blur, self.scene.render.motion_blur_shutter = True, 1.0
        self.scene.frame_set(10)
        self.frames = []
        self.seconds = 0.0  # that going to a frame takes

    def gather_moving(self, cancelled=None):
        def set_frame(frame, part):
            self.frames.append(frame + part)
            time.sleep(self.seconds)
            self.scene.frame_set(frame, subframe=part)

        self.scene.update_tag()  # for Cycles' settings, which Blender does not watch
        return gather_scene(bpy.context.evaluated_depsgraph_get(), "test", None, cancelled, set_frame)

    def positions(self, data, name="Quad"):
        instance = next(i for i in data.instances if i.name == name)
        return [tuple(m[:3, 3]) for m in instance.motion]

    def test_objects_and_their_steps(self):
        quad, still = self.add_quad(), self.add_quad("Still")
        animate(quad, "location", (0, 0, 0), (1, 0, 0), (1, 4, 0))
        data = self.gather_moving()
        np.testing.assert_allclose(self.positions(data), [(0.5, 0, 0), (1, 0, 0), (1, 2, 0)], atol=1e-6)
        self.assertEqual(self.positions(data, "Still"), [])
        self.assertEqual(self.frames, [9.5, 10.5, 10])
        self.assertEqual((self.scene.frame_current, self.scene.frame_subframe), (10, 0))
        quad.cycles.motion_steps = 2
        self.assertEqual(len(self.positions(self.gather_moving())), 5)
        quad.cycles.use_motion_blur = False
        self.assertEqual(self.positions(self.gather_moving()), [])
        self.assertEqual(still.location.x, 0)

    def test_where_the_shutter_opens(self):
        animate(self.add_quad(), "location", (0, 0, 0), (1, 0, 0), (1, 4, 0))
        for position, first, last in (("START", (1, 0, 0), (1, 4, 0)), ("END", (0, 0, 0), (1, 0, 0))):
            compat.motion_blur_owner(self.scene).motion_blur_position = position
            found = self.positions(self.gather_moving())
            np.testing.assert_allclose((found[0], found[-1]), (first, last), atol=1e-6)
            self.assertEqual((self.scene.frame_current, self.scene.frame_subframe), (10, 0))

    def test_camera(self):
        animate(self.camera, "location", (0, 0, 0), (1, 0, 0), (1, 4, 0))
        data = self.gather_moving().camera
        np.testing.assert_allclose([m[:3, 3] for m in data.motion], [(0.5, 0, 0), (1, 0, 0), (1, 2, 0)], atol=1e-6)
        self.assertEqual(data.view_planes, [])
        animate(self.camera.data, "lens", 40, 50, 60)
        planes = self.gather_moving().camera.view_planes
        np.testing.assert_allclose([p[1] for p in planes], [18 / 45, 18 / 50, 18 / 55], 1e-5)

    def test_shape(self):
        quad = self.add_quad()
        quad.shape_key_add(name="Basis")
        key = quad.shape_key_add(name="Up")
        key.data[0].co.z = 2
        key.value = 0
        key.keyframe_insert("value", frame=9)
        key.value = 1
        key.keyframe_insert("value", frame=11)
        for curve in compat_curves(quad.data.shape_keys):
            for point in curve.keyframe_points:
                point.interpolation = "LINEAR"
        self.scene.frame_set(10)
        mesh = self.gather_moving().meshes[0]
        np.testing.assert_allclose([p[:, 2].max() for p in mesh.motion_positions], [0.5, 1, 1.5], atol=1e-6)
        np.testing.assert_array_equal(mesh.motion_positions[1], mesh.positions)
        quad.cycles.use_deform_motion = False
        self.assertEqual(self.gather_moving().meshes[0].motion_positions, [])

    def test_topology_that_changes_is_noted(self):
        quad = self.add_quad()
        quad.shape_key_add(name="Basis")
        quad.shape_key_add(name="Up")
        modifier = quad.modifiers.new("Array", "ARRAY")
        for frame, count in ((9, 1), (10, 2), (11, 3)):
            modifier.count = count
            modifier.keyframe_insert("count", frame=frame)
        quad.modifiers.new("Wave", "WAVE")
        self.scene.frame_set(10)
        data = self.gather_moving()
        self.assertEqual(data.meshes[0].motion_positions, [])
        self.assertIn("object 'Quad': its topology changes; what deforms is not blurred", data.notes)

    def test_shutter(self):
        self.scene.cycles.rolling_shutter_type, self.scene.cycles.rolling_shutter_duration = "TOP", 0.25
        curve = self.scene.render.motion_blur_shutter_curve
        self.assertEqual(self.gather_moving().film.shutter, {"rolling": 0.25})
        curve.curves[0].points[0].location.y = 0
        curve.update()
        found = self.gather_moving().film.shutter["curve"]
        self.assertEqual((len(found), round(found[0], 3), round(found[-1], 3)), (256, 0, 1))

    def test_nothing_is_done_where_it_is_off(self):
        animate(self.add_quad(), "location", (0, 0, 0), (1, 0, 0))
        self.scene.render.use_motion_blur = False
        data = self.gather_moving()
        self.assertEqual((self.frames, data.instances[0].motion, data.film.shutter), ([], [], {}))
        self.scene.render.use_motion_blur, bpy.context.view_layer.use_motion_blur = True, False
        self.assertEqual((self.gather_moving().instances[0].motion, self.frames), ([], []))

    def test_the_frame_comes_back_whatever_happens(self):
        animate(self.add_quad(), "location", (0, 0, 0), (1, 0, 0), (2, 0, 0))
        self.scene.frame_set(10, subframe=0.25)
        self.seconds = 0.11  # as often as it is asked
        with self.assertRaises(ExportCancelled):
            self.gather_moving(lambda: len(self.frames) > 0)
        self.assertEqual((self.scene.frame_current, self.scene.frame_subframe), (10, 0.25))
        animate(self.camera, "scale", (1, 1, 1), (1, 1, 1), (0, 0, 0))
        self.camera.scale = (1, 1, 1)
        self.scene.render.motion_blur_shutter = 2.0
        self.scene.frame_set(10)
        with self.assertRaisesRegex(ExportError, "camera 'Camera' has a scale of zero"):
            self.gather_moving()
        self.assertEqual((self.scene.frame_current, self.scene.frame_subframe), (10, 0))

    def test_what_becomes_flat_is_noted(self):
        animate(self.add_quad(), "scale", (1, 1, 1), (1, 1, 1), (1, 1, 0))
        self.scene.render.motion_blur_shutter = 2.0
        data = self.gather_moving()
        self.assertEqual(data.instances[0].motion, [])
        self.assertIn("object 'Quad': it is flat at some time; its motion is not blurred", data.notes)
