# SPDX-License-Identifier: GPL-3.0-or-later
"""The comparison in the background and what Blender shows of it. Timers and windows are none here: the tests look for themselves."""

from __future__ import annotations

import json
import os
import re
import sys
import time
import types
import unittest
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest import mock

import bpy
import numpy as np
import wardmis
from comparison_support import SMALL, ComparisonTest
from support import ADDON
from wardmis import compat, rendering, scripting, second_blender, temporary, warnings
from wardmis import layout as panel_layout
from wardmis.comparison import colours, cycles, estimate, folders, images, job, operators, panels, plot, properties
from wardmis.comparison.command_line import progress_text
from wardmis.comparison.estimate import duration
from wardmis.comparison.overrides import overridden
from wardmis.comparison.report import VERDICTS, Report
from wardmis.comparison.run import divide
from wardmis.comparison.same_scene import same_but_for_rounding
from wardmis.exr import read_pass
from wardmis.properties import ALLOCATIONS


class PanelTest(ComparisonTest):
    def setUp(self) -> None:
        super().setUp()
        # as a user's Blender finds its add-ons
        scripts = self.folder.parent / "scripts"
        (scripts / "addons").mkdir(parents=True)
        (scripts / "addons" / "wardmis").symlink_to(ADDON, target_is_directory=True)
        patch = mock.patch.dict(os.environ, {"BLENDER_USER_SCRIPTS": str(scripts)})
        patch.start()
        self.addCleanup(patch.stop)
        self.addCleanup(job.forget)
        self.addCleanup(properties.forget_report)
        self.settings = self.scene.wardmis_comparison
        self.settings.folder = str(self.folder)
        self.settings.stop_by, self.settings.percentage = "samples", 100
        self.settings.samples = self.settings.seeds = self.settings.cycles_seeds = 2
        self.settings.use_cycles = False

    def wait(self, seconds: float = 180) -> job.Job:
        """Until the comparison has ended, as the timer would."""
        deadline = time.monotonic() + seconds
        while job.running():
            self.assertLess(time.monotonic(), deadline, job.current().text)
            job._look()
            time.sleep(0.02)
        return job.current()

    def compare(self) -> Path:
        self.assertEqual(bpy.ops.wardmis.compare(), {"FINISHED"})
        done = self.wait()
        self.assertEqual(done.failure, "")
        return done.folder


class Background(PanelTest):
    def test_comparison_ends_with_images(self):
        folder = self.compare()
        self.assertEqual(folder.parent, self.folder)
        report = properties.report()
        self.assertEqual(report.folder, folder)
        self.assertEqual(report.image_names, ["equal", "variance", "second-moment", "auto", "reference"])
        chosen = properties.results()
        self.assertEqual((chosen.a, chosen.b), ("equal", "reference"))
        a = bpy.data.images[images.A]
        self.assertEqual(tuple(a.size), (16, 8))
        pixels = np.empty(16 * 8 * 4, np.float32)
        a.pixels.foreach_get(pixels)
        expected = read_pass(report.image("equal"))[::-1, :, :3]
        np.testing.assert_allclose(pixels.reshape(8, 16, 4)[..., :3], expected, rtol=1e-6)
        self.assertGreater(bpy.data.images[images.DIFFERENCE].size[0], 16)

    def test_panel_reaches_the_command(self):
        self.settings.allocations = {"albedo", "equal"}
        self.settings.use_scene = True
        self.settings.stop_by, self.settings.seconds = "seconds", 12
        self.compare()
        arguments = self.calls()[-1]
        chosen = [arguments[i + 1] for i, word in enumerate(arguments) if word == "--configuration"]
        self.assertEqual(chosen[:2], ["equal", "albedo"])
        self.assertTrue(chosen[2].startswith("scene:"))
        self.assertEqual(arguments[arguments.index("--budget-seconds") + 1], "12")
        self.assertIn("--watch-stdin", arguments)

    def test_with_cycles_in_a_blender_of_its_own(self):
        self.settings.use_cycles = True
        folder = self.compare()
        self.assertIn("Cycles", properties.report().image_names)
        manifest = folder / "cycles" / "manifest.json"
        arguments = self.calls()[-1]
        self.assertEqual(arguments[arguments.index("--external") + 1], str(manifest))
        self.assertFalse((temporary.kept("comparison") / "scene.blend").exists())
        # the scene is the user's, and has not been rendered by this Blender
        self.assertEqual(self.scene.render.engine, "WARDMIS")

    def test_cycles_as_it_is_set_is_among_the_results(self):
        """Its name has spaces, and its file's name has none."""
        self.settings.use_cycles = self.settings.cycles_as_is = True
        self.scene.cycles.use_denoising = False
        self.compare()
        self.assertIn("Cycles as set", properties.report().image_names)

    def test_a_budget_with_cycles(self):
        self.settings.use_cycles = True
        self.settings.stop_by, self.settings.seconds = "seconds", 60
        folder = self.compare()
        first, second = self.calls()
        self.assertNotIn("--external", first)
        self.assertIn("--external", second)
        self.assertIn("Cycles", properties.report().image_names)
        manifest = json.loads((folder / "cycles" / "manifest.json").read_text())
        self.assertEqual(sorted({run["spp"] for run in manifest["runs"]}), [1, 2, 4])

    def test_without_time_for_cycles_the_others_are_shown(self):
        self.settings.use_cycles = True
        self.settings.stop_by = "seconds"
        with mock.patch.object(
            operators, "divide", lambda study, *_: divide(replace(study, budget_seconds=0.02), 2, None, False)
        ):
            bpy.ops.wardmis.compare()
            failed = self.wait()
        self.assertRegex(
            failed.failure, "4 samples per pixel by Cycles .* a lower resolution. The results below are without"
        )
        self.assertNotIn("folder", failed.failure)
        self.assertEqual(properties.report().folder, failed.folder)
        self.assertNotIn("Cycles", properties.report().image_names)

    def test_a_refused_budget_leaves_no_folder(self):
        self.settings.use_cycles = True
        self.settings.stop_by = "seconds"
        with mock.patch.object(
            operators, "divide", lambda study, *_: divide(replace(study, budget_seconds=0.002), 2, None, False)
        ):
            self.assertEqual(bpy.ops.wardmis.compare(), {"FINISHED"})
            failed = self.wait()
        self.assertIn("WardMIS' half of the time, 0.001 s, is too little", failed.failure)
        self.assertIn("give at least 6 s in all, or fewer seeds, or compare without", failed.failure)
        self.assertNotIn("--", failed.failure)
        self.assertFalse(failed.folder.exists())
        self.settings.seconds = 5  # the panel has learnt from it
        self.assertIn("Too little here: at least 6 s", panels.estimate_text(self.scene))
        self.settings.seconds = 7
        self.assertNotIn("Too little", panels.estimate_text(self.scene))

    def test_cancel_ends_the_other_blender(self):
        self.settings.use_cycles = True
        self.settings.samples, self.settings.cycles_seeds = 4096, 100
        bpy.ops.wardmis.compare()
        deadline = time.monotonic() + 60
        while job.current().fraction == 0:
            self.assertLess(time.monotonic(), deadline, job.current().text)
            job._look()
            time.sleep(0.05)
        bpy.ops.wardmis.compare_cancel()
        done = self.wait(10)
        self.assertEqual((done.failure, done.stopping), ("", True))
        self.assertEqual(self.calls(), [])
        manifest = json.loads((done.folder / "cycles" / "manifest.json").read_text())
        self.assertGreater(len(manifest["runs"]), 0)

    def test_same_comparison_goes_on_and_another_begins(self):
        first = self.compare()
        self.settings.seeds = 3
        self.assertEqual(self.compare(), first)
        self.settings.samples = 4
        second = self.compare()
        self.camera.location.z = 4
        third = self.compare()
        self.scene.wardmis.max_depth = 2
        fourth = self.compare()
        self.assertEqual(len({first, second, third, fourth}), 4)

    def test_goes_on_although_the_export_has_other_last_bits(self):
        self.export_with_noise()
        first = self.compare()
        scene = (first / "scene.glb").read_bytes()
        self.assertEqual(self.compare(), first)
        self.assertEqual((first / "scene.glb").read_bytes(), scene)

    def test_one_at_a_time(self):
        with mock.patch.dict(os.environ, {"WARDMIS_FAKE": "slow"}):
            bpy.ops.wardmis.compare()
            self.assertFalse(bpy.ops.wardmis.compare.poll())
            self.assertTrue(bpy.ops.wardmis.compare_cancel.poll())

    def test_cancel_asks_then_ends(self):
        with mock.patch.dict(os.environ, {"WARDMIS_FAKE": "slow"}):
            bpy.ops.wardmis.compare()
        deadline = time.monotonic() + 20
        while job.current().fraction == 0:
            self.assertLess(time.monotonic(), deadline)
            job._look()
        bpy.ops.wardmis.compare_cancel()
        done = self.wait(10)
        self.assertEqual((done.failure, done.stopping), ("", True))
        self.assertEqual(done.text, job.CANCELLED)
        with mock.patch.dict(os.environ, {"WARDMIS_FAKE": "hang"}):
            bpy.ops.wardmis.compare()
            self.started()
            bpy.ops.wardmis.compare_cancel()
            bpy.ops.wardmis.compare_cancel()
        self.assertFalse(job.running())
        self.assertEqual(job.current().text, job.CANCELLED)
        self.gone()

    def started(self) -> None:
        deadline = time.monotonic() + 20
        before = len(self.calls())
        while len(self.calls()) <= before - 1 or not self.log.exists():
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.02)

    def gone(self) -> None:
        self.assertIsNone(job.current()._process)

    def test_another_file_ends_it(self):
        with mock.patch.dict(os.environ, {"WARDMIS_FAKE": "slow"}):
            bpy.ops.wardmis.compare()
        process, folder = job.current()._process, job.current().folder
        self.assertTrue(process.running())

        def load() -> list[str]:
            """Loading a file would take this test's scene away."""
            for handler in bpy.app.handlers.load_pre:
                if handler.__module__.startswith("wardmis."):
                    handler()
            layout = Layout()
            with mock.patch.object(panels, "draw_text", lambda layout, text, *_: layout.label(text)):
                panels.draw_progress(layout, self.scene)
            return [label for label in layout.labels if label.startswith("Opening")]

        said = load()
        self.assertFalse(process.running())
        self.assertFalse(job.running())
        self.assertIsNone(properties.report())
        self.assertEqual(len(said), 1)  # in the new file, though it has compared nothing
        self.assertIn(str(folder), said[0])
        self.assertTrue((folder / "scene.glb").exists())
        self.assertEqual(load(), [])  # and not in the one after it
        self.assertEqual(self.compare(), folder)

    def test_whoever_opens_another_file_is_warned(self):
        from wardmis.comparison import leaving

        browser = types.SimpleNamespace(active_operator=types.SimpleNamespace(bl_idname=leaving.OPERATOR))
        panel, context = leaving.WARDMIS_FILEBROWSER_PT_leaving, types.SimpleNamespace(space_data=browser)

        def menu() -> list[str]:
            layout = Layout()
            layout.separator = layout.part
            leaving._draw(types.SimpleNamespace(layout=layout), None)
            return [label.strip() for label in layout.labels]

        self.assertEqual((menu(), panel.poll(context)), ([], False))
        with mock.patch.dict(os.environ, {"WARDMIS_FAKE": "slow"}):
            bpy.ops.wardmis.compare()
        self.assertEqual((menu(), panel.poll(context)), ([leaving.TEXT], True))
        status = Layout()
        leaving._draw_status(types.SimpleNamespace(layout=status), None)
        self.assertEqual([label.strip() for label in status.labels], [leaving.TEXT])
        for name in leaving.MENUS:
            self.assertIn(leaving._draw, getattr(bpy.types, name)._dyn_ui_initialize())
        self.assertIn(leaving._draw_status, bpy.types.STATUSBAR_HT_header._dyn_ui_initialize())

    def test_unregistering_ends_it(self):
        with mock.patch.dict(os.environ, {"WARDMIS_FAKE": "slow"}):
            bpy.ops.wardmis.compare()
        process = job.current()._process
        wardmis.unregister()
        wardmis.register()
        self.assertFalse(process.running())
        self.scene.render.engine = "WARDMIS"


class SecondBlender(PanelTest):
    """As in a window, where the second Blender exports."""

    def setUp(self) -> None:
        super().setUp()
        patch = mock.patch.object(second_blender, "wanted", lambda: True)
        patch.start()
        self.addCleanup(patch.stop)

    def paint(self) -> None:
        """The floor, on an image that is in no file."""
        image = bpy.data.images.new("Painted", 4, 4)
        image.pixels[:] = [0.25, 0.5, 0.75, 1] * 16
        image.update()
        self.assertTrue(image.is_dirty)
        tree = self.material.node_tree
        texture = tree.nodes.new("ShaderNodeTexImage")
        texture.image = image
        tree.links.new(texture.outputs[0], self.shader.inputs[0])
        self.floor.data.uv_layers.new()

    def test_it_exports_what_the_first_one_would(self):
        self.paint()
        self.folder.mkdir()
        first, second = self.folder / "first.glb", self.folder / "second.glb"
        with mock.patch.object(second_blender, "wanted", lambda: False):
            wardmis.export_scene(first)
        wardmis.export_scene(second)
        self.assertTrue(same_but_for_rounding(first, second))

    def test_the_last_render_stays(self):
        self.scene.render.engine = "CYCLES"
        self.scene.cycles.samples, self.scene.cycles.use_denoising = 1, False
        bpy.ops.render.render()

        def last_render() -> np.ndarray:
            path = self.folder.parent / "last.exr"
            settings = self.scene.render.image_settings
            with overridden(compat.multilayer_exr(settings)):
                bpy.data.images["Render Result"].save_render(str(path), scene=self.scene)
            return read_pass(path)

        before = last_render()
        self.assertGreater(before[..., :3].max(), 0)
        self.folder.mkdir()
        wardmis.export_scene(self.folder / "scene.glb")
        np.testing.assert_array_equal(last_render(), before)
        self.settings.use_cycles = True
        self.compare()
        np.testing.assert_array_equal(last_render(), before)

    def test_the_first_goes_on_while_it_exports(self):
        """What is changed meanwhile belongs to the next comparison."""
        self.assertEqual(bpy.ops.wardmis.compare(), {"FINISHED"})
        self.settings.seeds, self.settings.folder = 5, "/nowhere"
        self.camera.location.z = 7
        done = self.wait()
        self.assertEqual((done.failure, done.folder.parent), ("", self.folder))
        arguments = self.calls()[-1]
        self.assertEqual(arguments[arguments.index("--seeds") + 1], "2")
        self.assertEqual(list(temporary.kept("comparison").iterdir()), [])

    def test_its_warnings_are_seen_in_the_first(self):
        tree = self.floor.data.materials[0].node_tree
        toon = tree.nodes.new("ShaderNodeBsdfToon")
        tree.links.new(toon.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
        self.folder.mkdir()
        quiet = mock.patch.object(warnings, "_tell", lambda _text: None)
        quiet.start()
        self.addCleanup(quiet.stop)
        place = self.scene.name, self.scene.view_layers[0].name
        self.addCleanup(warnings.begin, *place)
        for export in (lambda: wardmis.export_scene(self.folder / "scene.glb"), self.compare):
            warnings.begin(*place)
            export()
            found = {warning.text: warning.owner for warning in warnings.of_scene(self.scene)}
            about = [text for text in found if "Toon" in text]
            self.assertEqual([found[text] for text in about], ["Floor"], found)

    def test_failures_are_told(self):
        self.scene.camera = None
        self.folder.mkdir()
        with self.assertRaisesRegex(RuntimeError, "WardMIS: the second Blender failed .*camera"):
            wardmis.export_scene(self.folder / "scene.glb")
        bpy.ops.wardmis.compare()
        self.assertRegex(self.wait().failure, "the export failed .*camera")
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_cancel_while_it_exports(self):
        bpy.ops.wardmis.compare()
        bpy.ops.wardmis.compare_cancel()
        done = self.wait(10)
        self.assertEqual((done.failure, done.stopping, done.folder), ("", True, None))


class Failures(PanelTest):
    def test_of_the_renderer_are_shown(self):
        with mock.patch.dict(os.environ, {"WARDMIS_FAKE": "exit3"}):
            bpy.ops.wardmis.compare()
            done = self.wait()
        self.assertIn("bufferViews[0]: lies beyond the file", done.failure)

    def test_of_cycles_name_it(self):
        current = job.start(lambda _: [job.Stage("Cycles", ["/bin/false"])], operators._finished, [])
        self.wait()
        self.assertIn("Cycles failed (exit code 1)", current.failure)

    def test_before_the_start_are_reported(self):
        self.settings.allocations = set()
        with self.assertRaisesRegex(RuntimeError, "nothing is chosen to be compared"):
            bpy.ops.wardmis.compare()
        self.settings.allocations = {"equal"}
        self.folder.write_text("a file")
        with self.assertRaisesRegex(RuntimeError, "cannot be written: .*choose another in the panel"):
            bpy.ops.wardmis.compare()

    def test_folder_without_results(self):
        with self.assertRaisesRegex(RuntimeError, "there is no report in"):
            bpy.ops.wardmis.compare_open(directory=str(self.folder))


class Results(PanelTest):
    def setUp(self) -> None:
        super().setUp()
        wardmis.compare(self.folder, cycles=False, **{**SMALL, "max_spp": 16})

    def test_can_be_opened(self):
        bpy.ops.wardmis.compare_open(directory=str(self.folder))
        self.assertEqual(properties.report().folder, self.folder)
        chosen = properties.results()
        chosen.a, chosen.b, chosen.top = "auto", "auto", 2.0
        self.assertEqual(chosen.failure, "")
        self.assertIn("auto", bpy.data.images[images.A]["wardmis"])

    def test_scale_is_such_that_a_difference_is_seen(self):
        bpy.ops.wardmis.compare_open(directory=str(self.folder))
        chosen = properties.results()
        self.assertTrue(chosen.fit)
        report = properties.report()

        def fitting(a: str, b: str) -> float:
            return colours.fitting_top(
                colours.relative_difference(read_pass(report.image(a)), read_pass(report.image(b)))
            )

        self.assertAlmostEqual(chosen.top, fitting(chosen.a, chosen.b), 5)
        chosen.b = "variance"
        self.assertAlmostEqual(chosen.top, fitting(chosen.a, "variance"), 5)
        chosen.top = 3.0
        self.assertFalse(chosen.fit)
        chosen.b = "auto"
        self.assertEqual(chosen.top, 3.0)
        chosen.fit = True
        self.assertAlmostEqual(chosen.top, fitting(chosen.a, "auto"), 5)

    def test_images_that_are_gone_are_named(self):
        bpy.ops.wardmis.compare_open(directory=str(self.folder))
        (self.folder / "images" / "variance.exr").unlink()
        chosen = properties.results()
        chosen.a = "variance"
        self.assertIn("variance.exr", chosen.failure)

    def test_what_is_recommended_is_set_by_a_button(self):
        self.assertFalse(bpy.ops.wardmis.compare_use.poll())
        bpy.ops.wardmis.compare_open(directory=str(self.folder))
        report, render = properties.report(), self.scene.wardmis
        self.assertEqual(report.recommended, "variance")
        self.assertFalse(operators.is_used(render, report))
        with mock.patch("wardmis.properties.redraw") as drawn:  # the button's own label, in another editor too
            bpy.ops.wardmis.compare_use()
        self.assertEqual(drawn.call_count, len(report.settings(report.recommended)))
        self.assertEqual((render.allocation, render.weights, render.samples_per_hit), ("variance", "balance", 5))
        self.assertAlmostEqual(render.min_fraction, 0.2, 6)
        self.assertTrue(operators.is_used(render, report))
        report.data["verdict"] = None  # of an earlier version
        self.assertEqual((report.verdict, report.why, report.recommended), ("", [], None))
        self.assertFalse(bpy.ops.wardmis.compare_use.poll())

    def test_view_turns_over(self):
        self.assertFalse(bpy.ops.wardmis.compare_view.poll())
        bpy.ops.wardmis.compare_open(directory=str(self.folder))
        chosen = properties.results()
        seen = []
        for _ in range(4):
            bpy.ops.wardmis.compare_view()
            seen.append(chosen.view)
        self.assertEqual(seen, ["B", "DIFFERENCE", "A", "B"])
        bpy.data.images.remove(bpy.data.images[images.DIFFERENCE])
        bpy.ops.wardmis.compare_view(view="DIFFERENCE")
        self.assertIn(images.DIFFERENCE, bpy.data.images)

    def test_no_plot_in_the_background(self):
        self.assertFalse(plot.available())
        bpy.ops.wardmis.compare_open(directory=str(self.folder))
        self.assertNotIn(images.PLOT, bpy.data.images)
        self.assertEqual(bpy.ops.wardmis.compare_view(view="PLOT"), {"CANCELLED"})

    def test_table_and_curves(self):
        report = Report(self.folder)
        rows = report.rows()
        self.assertEqual([r.name for r in rows], ["equal", "variance", "second-moment", "auto"])
        self.assertEqual(rows[1].ratio, "0.80 (0.72–0.88)")
        self.assertEqual((rows[0].verdict, rows[1].verdict), ("", "faster"))
        self.assertEqual(report.metric, "relMSE")
        curve = report.curves()[0]
        self.assertEqual(len(curve.seconds), 5)
        report.data["clock"] = "cpu"
        self.assertEqual(report.curves()[0].seconds[0], 2 * curve.seconds[0])
        self.assertTrue(all(low < error < high for low, error, high in zip(curve.low, curve.error, curve.high)))

    def test_figures_that_are_not_known(self):
        report = Report(self.folder)
        for c in report.configurations:
            c["equal_time"], c["time_to_target"], c["curve"][0]["wall"] = None, None, None
            c["curve"][1]["relmse"] = {"mean": -1e-4, "low": -2e-4, "high": 1e-5}
        self.assertEqual((report.rows()[0].error, report.rows()[0].ratio, report.rows()[0].verdict), ("", "", ""))
        self.assertEqual(len(report.curves()[0].seconds), 3)
        self.assertIsNone(report.equal_seconds)
        self.assertIsNone(report.target)


class UsersFile(PanelTest):
    """What a comparison shows is no part of the file that the user works on."""

    def setUp(self) -> None:
        super().setUp()
        wardmis.compare(self.folder, cycles=False, **SMALL)
        bpy.ops.wardmis.compare_open(directory=str(self.folder))
        images.put(images.PLOT, np.full((8, 16, 3), 0.5, np.float32), "a plot", srgb=True)
        self.editor = types.SimpleNamespace(image=bpy.data.images[images.B])  # there is no window here
        patch = mock.patch.object(images, "image_editors", lambda: [self.editor])
        patch.start()
        self.addCleanup(patch.stop)

    def ours(self) -> list[str]:
        return sorted(image.name for image in bpy.data.images if images.ours(image))

    def save(self) -> Path:
        path = self.folder.parent / "user.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, compress=False)
        return path

    def test_blender_has_nothing_to_ask_about(self):
        self.assertEqual(self.ours(), sorted(images.NAMES.values()))
        self.assertEqual([image.name for image in bpy.data.images if image.is_dirty], [])
        properties.results().top = 2.0  # makes them anew
        self.assertEqual([image.name for image in bpy.data.images if image.is_dirty], [])

    def test_saving_leaves_them_out_and_in_place(self):
        pixels = read_pixels(bpy.data.images[images.B])
        for image in bpy.data.images:
            image.use_fake_user = True  # as an editor's use has it
        for autopack in (False, True):
            if bpy.data.use_autopack != autopack:
                bpy.ops.file.autopack_toggle()
            path = self.save()
            with bpy.data.libraries.load(str(path)) as (stored, _):
                self.assertEqual([name for name in stored.images if name.startswith("WardMIS")], [])
            self.assertEqual(self.ours(), sorted(images.NAMES.values()))
            self.assertEqual(self.editor.image, bpy.data.images[images.B])
            np.testing.assert_allclose(read_pixels(self.editor.image), pixels, rtol=1e-6)
        bpy.ops.file.autopack_toggle()

    def test_an_image_that_the_user_takes_is_saved(self):
        tree = self.material.node_tree
        tree.nodes.new("ShaderNodeTexImage").image = bpy.data.images[images.A]
        with bpy.data.libraries.load(str(self.save())) as (stored, _):
            self.assertEqual([name for name in stored.images if name.startswith("WardMIS")], [images.A])

    def test_they_go_with_the_results(self):
        bpy.ops.wardmis.compare_close()
        self.assertEqual(self.ours(), [])
        self.assertIsNone(properties.report())
        self.editor.image = None  # as Blender's own do
        bpy.ops.wardmis.compare_open(directory=str(self.folder))
        wardmis.unregister()
        gone = self.ours()
        wardmis.register()
        self.scene.render.engine = "WARDMIS"
        self.assertEqual(gone, [])


def read_pixels(image: Any) -> np.ndarray:
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    return pixels


class Times(PanelTest):
    """What is said of the time before it is taken."""

    def test_in_words(self):
        expected = {
            0.4: "0 s",
            59: "59 s",
            90: "1 min 30 s",
            120: "2 min",
            754: "13 min",
            3600: "1 h",
            13924: "3 h 52 min",
        }
        expected |= {86400: "24 h", 3 * 86400 + 7200: "3 days 2 h"}
        self.assertEqual({seconds: duration(seconds) for seconds in expected}, expected)
        event = {"phase": "runs", "fraction": 0.5, "left": 13000}
        self.assertEqual(progress_text(event, later=924), "Runs, 50 %, 3 h 52 min left")

    def test_defaults_are_two_minutes_at_half_the_resolution(self):
        scene = bpy.data.scenes.new("Fresh")
        self.addCleanup(bpy.data.scenes.remove, scene)
        self.assertEqual(
            panels.estimate_text(scene),
            "About 2 min at 960 × 540, 1 min of it for Cycles. Whether that is enough is known after a render (F12)",
        )

    def test_samples_take_what_a_render_took(self):
        self.settings.allocations = {"equal"}
        self.settings.samples, self.settings.seeds, self.settings.cycles_seeds = 4, 10, 10
        with mock.patch.object(rendering, "speed", lambda: None):
            self.assertIn("A guess", panels.estimate_text(self.scene))
        with mock.patch.object(rendering, "speed", lambda: 16 * 8 * 2.0):  # two samples per pixel a second
            own = 4 * (10 + 16) / 2
            self.assertEqual(operators.estimate_of(self.scene).seconds, own)
            self.assertEqual(panels.estimate_text(self.scene), "About 52 s at 16 × 8")
            self.settings.use_cycles = True
            cycles = ((1 + 2 + 4) * 10 + 32 * 4) / 2
            self.assertEqual(operators.estimate_of(self.scene).seconds, own + cycles)
            self.settings.percentage = 50
            self.assertEqual(operators.estimate_of(self.scene).seconds, (own + cycles) / 4)
        self.settings.allocations = set()
        self.assertEqual(panels.estimate_text(self.scene), "")

    def test_too_little_time_is_said_before(self):
        self.settings.stop_by, self.settings.seconds = "seconds", 10.0
        self.settings.seeds = 16
        for speed, said in (
            (16 * 8 * 100.0, "About 10 s at 16 × 8"),
            (16 * 8 * 2.0, "Too little here: at least 2 min 1 s"),
        ):
            with mock.patch.object(rendering, "speed", lambda speed=speed: speed):
                self.assertIn(said, panels.estimate_text(self.scene))

    def test_too_little_time_is_what_the_command_takes_for_it(self):
        """The button's rule has the numbers of the refusal's."""
        source = (ADDON.parents[1] / "native" / "report" / "converge.cpp").read_text(encoding="utf-8")
        number = {name: float(value) for name, value in re.findall(r"constexpr \w+ (k\w+) = ([\d.]+);", source)}
        self.assertEqual(estimate.FEWEST_SAMPLES, number["kFewestSamples"])
        self.assertEqual(estimate.FEWEST_SEEDS, number["kFewestOfBudget"])
        self.assertEqual(estimate.SURVEY_SAMPLES, number["kSurveySamples"])
        self.assertEqual(estimate.MARGIN, number["kMargin"])
        self.assertAlmostEqual(estimate.OWN_SHARE, number["kUsedShare"] - number["kReferenceShare"])
        self.assertEqual(
            (estimate.FEWEST_SAMPLES, estimate.FEWEST_SEEDS, estimate.CYCLES_SHARE, estimate.MARGIN),
            (cycles.FEWEST_OF_BUDGET, cycles.FEWEST_SEEDS_OF_BUDGET, cycles.BUDGET_SHARE, cycles.MARGIN),
        )
        factors = [factor * cycles.REFERENCE_IMAGES for factor in cycles.REFERENCE_FACTORS]
        self.assertEqual(estimate.CYCLES_REFERENCE_FACTORS, (factors[0], factors[-1]))

    def test_a_render_is_measured(self):
        rendering.note_speed(100.0, 2.0)
        self.assertEqual(rendering.speed(), 50.0)
        rendering.note_speed(100.0, 0.0)
        self.assertIsNone(rendering.speed())

    def test_a_comparison_is_measured(self):
        self.compare()
        self.assertEqual(operators._speeds(operators.scene_title(self.scene)).own, 16 * 8 / 0.01)
        self.assertIsNone(operators._speeds("another scene").own)

    def test_the_resolution_is_that_of_the_panel(self):
        self.settings.percentage, self.settings.use_cycles = 50, True
        folder = self.compare()
        self.assertEqual(tuple(bpy.data.images[images.A].size), (8, 4))
        self.assertEqual(self.scene.render.resolution_percentage, 100)
        self.assertEqual(read_pass(next((folder / "cycles").glob("*.exr"))).shape[:2], (4, 8))

    def test_checkboxes_choose_one_by_one(self):
        self.settings.use_albedo, self.settings.use_equal = True, False
        self.assertEqual(self.settings.allocations, {"variance", "second-moment", "auto", "albedo"})
        self.assertTrue(self.settings.use_second_moment)
        self.assertFalse(self.settings.use_equal)


class Settings(unittest.TestCase):
    def test_every_setting_is_described_and_shown(self):
        source = (ADDON / "comparison" / "panels.py").read_text()
        for group in (properties.WARDMIS_PG_comparison, properties.WARDMIS_PG_results):
            for prop in group.bl_rna.properties:
                if prop.identifier in {"rna_type", "name"}:
                    continue
                self.assertTrue(prop.description, prop.identifier)
                if prop.identifier in {"samples", "seconds"}:  # shown by the name of the choice
                    continue
                if prop.identifier in {"allocations", *(properties.checkbox(name) for name, *_ in ALLOCATIONS)}:
                    continue  # the ones are the other
                self.assertRegex(source, rf'"{prop.identifier}"|chosen\.{prop.identifier}\b')

    def test_defaults_are_those_of_the_command(self):
        from wardmis.comparison.converge import DEFAULT_CONFIGURATIONS, Study

        defaults = properties.WARDMIS_PG_comparison.bl_rna.properties
        self.assertEqual(set(defaults["allocations"].default_flag), set(DEFAULT_CONFIGURATIONS))
        self.assertEqual((defaults["seeds"].default, defaults["samples"].default), (Study().seeds, Study().max_spp))

    def test_every_verdict_has_a_sign(self):
        self.assertEqual(set(panels.VERDICT_ICONS), set(VERDICTS.values()))
        known = bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items.keys()
        self.assertLessEqual(set(panels.VERDICT_ICONS.values()), set(known))


class Layout:
    """Stands in for Blender's, of which there is none in the background: what is shown, and that no label is cut off."""

    def __init__(self) -> None:
        self.shown: list[str] = []
        self.labels: list[str] = []

    def label(self, text: str = "", icon: str = "NONE") -> None:
        self.labels.append(("    " if icon != "NONE" else "") + text)

    def prop(self, _owner, name: str, **_) -> None:
        self.shown.append(name)

    def operator(self, name: str, **_):
        self.shown.append(name)
        return types.SimpleNamespace()

    def part(self, **_) -> Layout:
        return self

    row = column = box = grid_flow = part


class Sidebar(PanelTest):
    """The Image Editor's, as narrow as it opens."""

    def draw(self, panel: type) -> Layout:
        layout, region = Layout(), types.SimpleNamespace(width=200)
        preferences = types.SimpleNamespace(system=types.SimpleNamespace(ui_scale=1))  # 0 without a window
        context = types.SimpleNamespace(region=region, preferences=preferences, scene=self.scene)
        blender = types.SimpleNamespace(context=context)
        with mock.patch.object(panel_layout, "bpy", blender):
            panel.draw(types.SimpleNamespace(layout=layout), context)
        return layout

    def test_has_the_choices_of_the_properties_editor(self):
        choices = [
            layout.shown
            for layout in map(self.draw, (panels.WARDMIS_IMAGE_PT_compare, panels.WARDMIS_RENDER_PT_compare))
        ]
        self.assertEqual(choices[0], choices[1])
        for name in (
            "use_second_moment",
            "use_scene",
            "percentage",
            "stop_by",
            "samples",
            "seeds",
            "use_cycles",
            "wardmis.compare",
        ):
            self.assertIn(name, choices[0])

    def test_says_what_was_not_finished(self):
        def says() -> bool:
            folders._seen.clear()
            job.forget()  # as another Blender
            labels = " ".join(label.strip() for label in self.draw(panels.WARDMIS_IMAGE_PT_compare).labels)
            return panels.UNFINISHED in labels

        self.assertFalse(says())
        folder = self.compare()
        self.assertFalse(says())
        (folder / "report.json").unlink()  # as a Blender that was killed leaves it
        self.assertTrue(says())
        self.settings.seeds = 3
        self.assertTrue(says())
        self.settings.samples = 64
        self.assertFalse(says())
        self.settings.samples = 2
        self.assertEqual(self.compare(), folder)
        self.assertFalse(says())

    def test_table_fits_and_its_signs_are_explained(self):
        self.assertFalse(panels.WARDMIS_IMAGE_PT_results.poll(bpy.context))
        wardmis.compare(self.folder, cycles=False, **SMALL)
        bpy.ops.wardmis.compare_open(directory=str(self.folder))
        self.assertTrue(panels.WARDMIS_IMAGE_PT_results.poll(bpy.context))
        labels = self.draw(panels.WARDMIS_IMAGE_PT_results).labels
        self.assertLessEqual(max(map(len, labels)), 22, labels)
        self.assertIn("    second-moment", labels)
        said = " ".join(label.strip() for label in labels)
        self.assertTrue(said.startswith("Use variance: the noise of equal in 80 % of its time."), said)
        self.assertIn("auto is better and worse.", said)
        self.assertIn("variance 0.008 × 0.80 (0.72–0.88)", said)
        self.assertIn("The signs: whether a relMSE of 0.01 is reached faster than by equal", said)
        self.assertIn("equal faster", said)
        self.assertIn("whether the target is reached", panels.legend_text("relMSE", None, "equal"))


class Colours(unittest.TestCase):
    def test_inferno_is_matplotlibs(self):
        expected = {
            0.0: (0.001, 0.000, 0.014),
            0.25: (0.342, 0.062, 0.429),
            0.5: (0.736, 0.216, 0.330),
            1.0: (0.988, 0.998, 0.645),
        }
        for t, rgb in expected.items():
            np.testing.assert_allclose(colours.inferno(np.array([t]))[0], rgb, atol=0.03)

    def test_top_fits_all_but_a_hundredth(self):
        values = np.full(1000, 0.013)
        values[:5], values[5] = 700.0, np.nan
        self.assertAlmostEqual(colours.fitting_top(values), 0.02)
        self.assertAlmostEqual(colours.fitting_top(np.full(9, 0.05)), 0.05)
        self.assertAlmostEqual(colours.fitting_top(np.full(9, 7.0)), 10.0)
        self.assertEqual(colours.fitting_top(np.zeros(9)), colours.SMALLEST_TOP)
        self.assertEqual(colours.fitting_top(np.full(9, np.nan)), colours.SMALLEST_TOP)

    def test_scale_stands_beside(self):
        values = np.full((120, 40), 0.5)
        values[3, 4] = np.nan
        image = colours.false_colour(values, 0.5)
        self.assertGreater(image.shape[1], 40 + 20)
        np.testing.assert_allclose(image[10, 10], colours.inferno(np.array(1.0)))
        np.testing.assert_allclose(image[3, 4], colours.NOT_A_NUMBER)
        strip = image[:, 40:]
        self.assertGreater(strip[:, 10].sum(), strip[::-1, 10][:60].sum())
        for top in (1e-4, 0.37, 12345.0, 1e7):
            for height in (1, 4, 8, 333):
                self.assertEqual(colours.false_colour(np.zeros((height, 3)), top).shape[0], height)

    def test_numbers_can_be_read_and_leave_the_image_its_place(self):
        for height, tall in ((36, 5), (120, 10), (270, 10), (480, 20), (1080, 30), (4000, 30)):
            strip = colours.false_colour(np.zeros((height, 4)), 0.5)[:, 4:]
            written = np.isclose(strip, 0.9).all(axis=2).any(axis=1)  # rows with parts of numbers
            edges = np.flatnonzero(np.diff(np.concatenate([[False], written, [False]]).astype(int)))
            self.assertEqual((edges[1::2] - edges[::2]).tolist(), 5 * [tall], height)
            self.assertLess(strip.shape[1], max(2 * height / 3, 40))  # a third of an image of 2 : 1

    def test_difference(self):
        a, b = np.full((2, 2, 4), 3.0), np.full((2, 2, 4), 1.0)
        np.testing.assert_allclose(colours.relative_difference(a, b), 2 / 1.01)


class Scripting(unittest.TestCase):
    def test_name_for_scripts_in_an_extension(self):
        other = {k: v for k, v in sys.modules.items() if k != "wardmis"}
        with (
            mock.patch.dict(sys.modules, other, clear=True),
            mock.patch.object(scripting, "__package__", "bl_ext.x.wardmis"),
        ):
            scripting.register()
            import wardmis as alias

            self.assertIs(alias.compare, wardmis.compare)
            self.assertIs(alias.export_scene, wardmis.export_scene)
            self.assertIsInstance(alias, types.ModuleType)
            scripting.unregister()
            self.assertNotIn("wardmis", sys.modules)
        self.assertIs(sys.modules["wardmis"], wardmis)
