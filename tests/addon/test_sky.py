# SPDX-License-Identifier: GPL-3.0-or-later
"""Sky Texture nodes: what a second Blender is asked, how often, and what happens where it does not answer."""

from __future__ import annotations

import math
import os
import time
import types
import unittest.mock
from pathlib import Path

import bpy
import numpy as np
from support import RenderTest, SceneTest
from wardmis import temporary
from wardmis.export import ExportCancelled, measured_sky
from wardmis.export.scene import gather_scene
from wardmis.export.sky import mean_radiance

patched = unittest.mock.patch.object


class Sky(SceneTest):
    def setUp(self):
        super().setUp()
        world = self.scene.world = bpy.data.worlds.new("World")
        world.use_nodes = True
        self.tree = world.node_tree
        self.background = next(node for node in self.tree.nodes if node.bl_idname == "ShaderNodeBackground")
        self.background.inputs["Strength"].default_value = 1
        self.node = self.tree.nodes.new("ShaderNodeTexSky")
        self.tree.links.new(self.node.outputs["Color"], self.background.inputs["Color"])
        self.forget()

    def forget(self):
        for path in temporary.kept("skies").iterdir():
            path.unlink()

    def other_blender(self, script: str, version: str = bpy.app.version_string) -> Path:
        """In place of a second one; each start writes the process into the file that is returned."""
        path, starts = temporary.kept("other") / "blender", temporary.kept("other") / "starts"
        path.write_text(f"#!/bin/sh\necho $$ >> '{starts}'\n{script}\n")
        path.chmod(0o700)
        starts.write_text("")
        app = types.SimpleNamespace(binary_path=str(path), version_string=version)
        fake = patched(measured_sky, "bpy", types.SimpleNamespace(app=app, types=bpy.types))
        fake.start()
        self.addCleanup(fake.stop)
        return starts

    def is_its_mean(self, *words: str) -> None:
        scene = self.gather()
        (world,) = scene.worlds
        self.assertTrue(all(world.radiance))
        self.assertIsNone(world.program)
        (note,) = scene.notes
        start = "world 'World': node 'Sky Texture' (Sky Texture) could not be evaluated: a second Blender, in which Cycles was to render it, "
        for word in (start, *words, "; the mean of its light over all directions is used instead"):
            self.assertIn(word, note)


class Measured(Sky):
    def test_table_and_a_sun_of_its_own(self):
        self.node.sun_elevation, self.node.sun_rotation, self.node.sun_size = 0.5, 0.7, 0.02
        scene = self.gather()
        self.assertEqual(scene.notes, [])
        around, sun = scene.worlds
        self.assertIsNone(around.cone)
        expected = (math.cos(0.5) * math.sin(0.7), math.cos(0.5) * math.cos(0.7), math.sin(0.5), 0.02)
        np.testing.assert_allclose(sun.cone, expected, atol=1e-6)
        table, disc = (image.pixels for image in scene.images)
        self.assertGreater(disc[len(disc) // 2, len(disc) // 2].min(), 100 * table.max())
        self.node.sun_disc = False
        self.assertEqual(len(self.gather().worlds), 1)

    def test_sun_that_has_set_is_no_light(self):
        self.node.sun_elevation = -0.1
        scene = self.gather()
        self.assertEqual((len(scene.worlds), len(scene.images), scene.notes), (1, 1, []))

    def test_smallest_sun(self):
        """Cycles makes none smaller."""
        self.node.sun_size = 0
        self.assertAlmostEqual(self.gather().worlds[1].cone[3], 5e-4)

    def test_measured_once(self):
        """How it is looked at does not matter; another sky is another one, as in an animation of it."""
        self.node.keyframe_insert("sun_elevation", frame=1)
        self.node.sun_elevation = 0.1
        self.node.keyframe_insert("sun_elevation", frame=2)
        starts = []
        measure = measured_sky._measure

        def counted(*arguments):
            starts.append(arguments)
            measure(*arguments)

        with patched(measured_sky, "_measure", counted):
            images = []
            for frame in (1, 2, 1):
                self.scene.frame_set(frame)
                images.append(self.gather().images[0].pixels)
            self.assertEqual(len(starts), 2)
            self.background.inputs["Strength"].default_value = 0.3
            self.node.texture_mapping.rotation = 0.1, 0.2, 0.3
            self.node.location = 10, 20
            self.gather()
            self.assertEqual(len(starts), 2)
        np.testing.assert_array_equal(images[0], images[2])
        self.assertGreater(np.abs(images[0] - images[1]).max(), 0.1)

    def test_few_are_kept(self):
        folder = temporary.kept("skies")
        for i in range(40):
            path = folder / f"{i:02}.npz"
            path.write_bytes(b"")
            os.utime(path, (i, i))
        self.gather()
        names = sorted(path.name for path in folder.iterdir())
        self.assertEqual((len(names), "08.npz" in names, "09.npz" in names), (measured_sky.KEPT, False, True))

    def test_it_is_told(self):
        told = []
        gather_scene(bpy.context.evaluated_depsgraph_get(), "test", tell=told.append)
        self.assertEqual(told, ["a second Blender measures the sky", ""])

    def test_is_told_in_a_render(self):
        setup = 'tree = scene.world.node_tree\ntree.links.new(tree.nodes.new("ShaderNodeTexSky").outputs[0], tree.nodes["Background"].inputs[0])\n'
        show = "from wardmis import engine\nengine._Render._show_text = lambda self, text, left='': print('text:', text, flush=True)\n"
        test = RenderTest()
        RenderTest.setUp(test)
        self.addCleanup(test.doCleanups)
        run = test.run_blender(setup + show + "scene.frame_end = 2\n", "--render-anim")
        self.assertEqual((run.code, run.left_over), (0, []), run.output)
        self.assertEqual(
            run.output.count("text: Exporting the scene: a second Blender measures the sky"), 1, run.output
        )
        self.assertNotIn("warning: world", run.output)


class NotMeasured(Sky):
    def test_failure_is_told_and_tried_again(self):
        starts = self.other_blender("echo 'there is no Cycles' >&2; exit 3")
        self.is_its_mean("failed (exit code 3); it said: there is no Cycles")
        self.assertEqual(len(starts.read_text().split()), 1)  # for all kinds of ray
        self.is_its_mean("failed (exit code 3)")
        self.assertEqual(len(starts.read_text().split()), 2)

    def test_crash(self):
        self.other_blender("kill -SEGV $$")
        self.is_its_mean("crashed (SIGSEGV)")

    def test_nothing_is_written(self):
        self.other_blender("exit 0")
        self.is_its_mean("left nothing that can be read", "tables.npz")

    def test_no_program(self):
        self.other_blender("").with_name("blender").unlink()
        self.is_its_mean("cannot be run: No such file or directory")

    def test_another_version(self):
        self.other_blender(f"exec '{bpy.app.binary_path}' \"$@\"", version="9.9.9")
        self.is_its_mean(
            f"failed (exit code 1): it is Blender {bpy.app.version_string} now, not 9.9.9; restart Blender"
        )

    def test_who_does_not_answer_is_not_asked_again(self):
        starts = self.other_blender("exec sleep 100")
        with patched(measured_sky, "SECONDS", 0.5), patched(measured_sky, "_gave_no_answer", False):
            self.is_its_mean("has not answered for 0.5 s")
            self.node.sun_elevation = 0.3
            self.is_its_mean("has not answered before, and none is asked until Blender is started again")
        self.assertEqual(len(starts.read_text().split()), 1)

    def test_esc(self):
        starts = self.other_blender("exec sleep 100")
        begun = time.monotonic()
        with self.assertRaises(ExportCancelled):
            gather_scene(
                bpy.context.evaluated_depsgraph_get(), "test", cancelled=lambda: time.monotonic() > begun + 0.5
            )
        self.assertLess(time.monotonic() - begun, 10)
        with self.assertRaises(ProcessLookupError):
            os.kill(int(starts.read_text()), 0)
        self.assertEqual(list(temporary.kept("skies").iterdir()), [])


class EveryModel(Sky):
    def test_mean_of_its_table(self):
        """Is the one that was measured before of each, for the heights of the sun."""
        for item in bpy.types.ShaderNodeTexSky.bl_rna.properties["sky_type"].enum_items:
            with self.subTest(item.identifier):
                self.node.sky_type = item.identifier
                self.node.sun_disc = False
                self.node.sun_direction = math.cos(0.5), 0, math.sin(0.5)
                self.node.sun_elevation = math.radians(45)
                scene = self.gather()
                self.assertEqual(scene.notes, [])
                v = 2 * (np.arange(measured_sky.ROWS) + 0.5) / measured_sky.ROWS - 1
                weights = np.abs(v) * np.cos(v * v * np.pi / 2)  # of a row, all around
                mean = np.average(scene.images[0].pixels.mean(axis=1), axis=0, weights=weights)
                np.testing.assert_allclose(mean, mean_radiance(self.node), rtol=0.02)
