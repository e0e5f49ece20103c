# SPDX-License-Identifier: GPL-3.0-or-later
"""wardmis.compare(): what Cycles is told, what its renders leave, how a comparison goes on, and that every failure is told."""

from __future__ import annotations

import itertools
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import bpy
import numpy as np
import wardmis
from comparison_support import SMALL, ComparisonTest
from support import ADDON, FAKE, HERE, read_exr
from wardmis import light_paths, lock
from wardmis.comparison import converge, cycles, cycles_settings
from wardmis.comparison.manifest import Manifest
from wardmis.comparison.overrides import overridden
from wardmis.comparison.run import size_of
from wardmis.comparison.scene_file import SceneFile, read_scene_file
from wardmis.exr import read_header, read_pass


class Comparing(ComparisonTest):
    def test_leaves_renders_and_a_report(self):
        outcome = wardmis.compare(self.folder, **SMALL)
        self.assertTrue(outcome.report_html.is_file() and outcome.report_json.is_file() and outcome.scene.is_file())
        self.assertEqual(outcome.manifest, self.folder / "cycles" / "manifest.json")
        self.assertEqual(outcome.warnings, ["this renderer is a fake"])
        data = self.manifest()
        self.assertEqual([(r["seed"], r["spp"]) for r in data["runs"]], [(1, 1), (1, 2), (2, 1), (2, 2)])
        self.assertEqual((len(data["reference"]["images"]), data["reference"]["spp"]), (4, 4))
        for name in [r["path"] for r in data["runs"]] + data["reference"]["images"]:
            image = read_pass(outcome.manifest.parent / name)
            self.assertEqual(image.shape, (8, 16, 4))
            self.assertGreater(float(image[4, 8, 0]), 0)
        self.assertEqual(sorted(p.name for p in outcome.manifest.parent.iterdir() if "tmp" in p.name), [])

    def test_seeds_and_samples_give_images_of_their_own(self):
        wardmis.compare(self.folder, **SMALL)
        data = self.manifest()
        names = [r["path"] for r in data["runs"]] + data["reference"]["images"]
        images = [read_pass(self.folder / "cycles" / name)[..., :3] for name in names]
        for i, image in enumerate(images):
            for other in images[:i]:
                self.assertFalse(np.array_equal(image, other))
        # they agree with what they converge to
        mean = np.mean([image.mean() for image in images[:4]])
        self.assertAlmostEqual(float(images[-1].mean() / mean), 1, delta=0.1)

    def test_settings_of_the_scene_reach_the_command(self):
        settings = self.scene.wardmis
        settings.allocation, settings.weights, settings.max_depth = "albedo", "power", 3
        self.scene.render.threads_mode, self.scene.render.threads = "FIXED", 1
        wardmis.compare(
            self.folder,
            configurations=["equal", "scene"],
            cycles=False,
            seeds=3,
            first_seed=5,
            max_spp=8,
            title="A title",
        )
        arguments = self.calls()[-1]
        pairs = dict(itertools.pairwise(arguments))
        self.assertEqual(arguments[0], "converge")
        self.assertEqual(pairs["--weights"], "auto")
        self.assertTrue(pairs["--configuration"].startswith("scene:allocation=albedo,pixels=auto,weights=power,"))
        for option, value in (
            ("--max-depth", "3"),
            ("--seeds", "3"),
            ("--seed", "5"),
            ("--max-spp", "8"),
            ("--title", "A title"),
            ("--threads", "1"),
        ):
            self.assertEqual(pairs[option], value, option)
        self.assertNotIn("--external", arguments)
        self.assertFalse((self.folder / "cycles").exists())

    def test_the_scenes_default_allocation_yields_to_its_weights(self):
        self.scene.wardmis.weights = "nonbalance"
        wardmis.compare(self.folder, configurations=["equal", "scene"], cycles=False, **SMALL)
        own = next(word for word in self.calls()[-1] if word.startswith("scene:"))
        self.assertTrue(own.startswith("scene:pixels=auto,weights=nonbalance,"), own)

    def test_budget_is_shared_with_cycles(self):
        """WardMIS' half decides on the samples, and Cycles has as many where they fit into its own."""
        wardmis.compare(self.folder, budget_seconds=60, **SMALL)
        first, second = self.calls()
        for arguments in (first, second):
            self.assertEqual(arguments[arguments.index("--budget-seconds") + 1], "30")
            self.assertNotIn("--max-spp", arguments)
        self.assertEqual(second[:-2], first)
        self.assertEqual(second[-2], "--external")
        data = self.manifest()
        self.assertEqual([(r["seed"], r["spp"]) for r in data["runs"]], [(s, n) for s in (1, 2) for n in (1, 2, 4)])
        self.assertEqual(len(data["reference"]["images"]), 4)

    def test_samples_that_a_budget_allows(self):
        """Of renders whose costs are known: 0.1 s each, and 0.01 s a sample; two seeds, and four images of eight times the samples,
        or four, or two."""
        affordable = (
            (10, (8, 64)),
            (30, (32, 256)),
            (1e6, (64, 512)),
            (5.5, (4, 32)),
            (5, (4, 16)),
            (3.5, (4, 8)),
            (3, None),
        )
        for budget, samples in affordable:
            plan = cycles.CyclesPlan([1, 2], 64, budget_seconds=budget)
            manifest = Manifest(self.folder / "cycles" / "manifest.json", {"settings": {}, "renderer": ""}, (8, 16))
            renders = cycles._Renders(self.scene, bpy.context.view_layer, manifest, plan, lambda _event: None)
            renders._measure_synchronisation = lambda: 0.1
            with mock.patch.object(renders, "_timed", lambda spp, _seed: (0.1 + 0.01 * spp, 0.0)):
                if samples is None:
                    with self.assertRaisesRegex(
                        RuntimeError, "4 samples per pixel by Cycles take about 1 s.* give at least"
                    ):
                        renders._affordable(budget / 2, 64)
                else:
                    self.assertEqual(renders._affordable(budget / 2, 64), samples, budget)

    def test_resolutions_are_pairs_or_as_the_command_has_them(self):
        for told in ((480, 270), [480, 270], "480x270"):
            self.assertEqual(size_of(told), (480, 270))
        for told in (
            "480",
            "480x",
            "480x2",
            "axb",
            " 480x270",
            "+480x270",
            "4_80x270",
            480,
            (480,),
            (480, None),
            (480.5, 270),
        ):
            with self.assertRaisesRegex(RuntimeError, "is no size of at least 4 x 4 pixels, as 480x270 is"):
                size_of(told)

    def test_a_budget_that_is_too_small_is_refused_at_once(self):
        with self.assertRaisesRegex(RuntimeError, "give at least 6 s in all, or fewer seeds, or compare without"):
            wardmis.compare(self.folder, budget_seconds=0.001, **SMALL)
        self.assertFalse(self.folder.exists())
        # Cycles' own half
        with self.assertRaisesRegex(RuntimeError, "4 samples per pixel by Cycles .* keeps the report without it"):
            wardmis.compare(self.folder, budget_seconds=0.02, **SMALL)
        self.assertTrue((self.folder / "report.html").is_file())

    def test_a_budget_of_nothing(self):
        with self.assertRaisesRegex(RuntimeError, "a budget of -5 seconds is none"):
            wardmis.compare(self.folder, budget_seconds=-5, **SMALL)
        self.assertFalse(self.folder.exists())

    def test_a_manifest_that_does_not_say_its_samples_goes_on_with_them(self):
        wardmis.compare(self.folder, budget_seconds=60, **SMALL)
        path = self.folder / "cycles" / "manifest.json"
        old = self.manifest()
        del old["max_spp"]
        path.write_text(json.dumps(old))
        with mock.patch.object(cycles._Renders, "_affordable", side_effect=AssertionError("it is decided")):
            wardmis.compare(self.folder, budget_seconds=60, **{**SMALL, "seeds": 3})
        self.assertEqual({run["spp"] for run in self.manifest()["runs"] if run["seed"] == 3}, {1, 2, 4})

    def test_one_process_at_a_time(self):
        (self.folder / "cycles").mkdir(parents=True)
        with (
            lock.alone(self.folder / "cycles"),
            self.assertRaisesRegex(RuntimeError, "another process is rendering into"),
        ):
            wardmis.compare(self.folder, **SMALL)
        wardmis.compare(self.folder, **SMALL)

    def test_progress_is_told(self):
        events = []
        wardmis.compare(self.folder, progress=events.append, **SMALL)
        phases = [e["phase"] for e in events if e["event"] == "progress"]
        self.assertEqual(list(dict.fromkeys(phases)), ["Cycles", "Cycles' reference", "runs"])
        for event in events:
            if event["event"] == "progress":
                self.assertTrue(0 <= event["fraction"] <= 1)
        self.assertEqual(events[-1]["event"], "done")

    def test_border_is_that_of_the_export(self):
        render = self.scene.render
        render.use_border, render.border_min_x, render.border_max_x = True, 0.25, 0.5
        render.border_min_y, render.border_max_y = 0.0, 0.5
        outcome = wardmis.compare(self.folder, **SMALL)
        self.assertEqual(read_scene_file(outcome.scene).film["border"], [4, 0, 8, 4])
        self.assertEqual(read_pass(self.folder / "cycles" / "run-0001-00001.exr").shape, (4, 4, 4))
        self.assertFalse(render.use_crop_to_border)


class Integrand(ComparisonTest):
    def test_diffuse_scene_has_a_common_reference(self):
        wardmis.compare(self.folder, **SMALL)
        self.assertIs(self.manifest()["common_reference"], True)

    def test_cycles_own_models_have_one(self):
        for number, kind in enumerate(("ShaderNodeBsdfGlossy", "ShaderNodeBsdfGlass", "ShaderNodeBsdfPrincipled")):
            material = self.material.copy()
            tree = material.node_tree
            node = tree.nodes.new(kind)
            node.distribution = "GGX"
            tree.links.new(node.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
            mesh = bpy.data.meshes.new(kind)
            mesh.from_pydata([(number, 9, 0), (number, 10, 0), (number, 10, 1)], [], [(0, 1, 2)])
            mesh.materials.append(material)
            self.scene.collection.objects.link(bpy.data.objects.new(kind, mesh))
        wardmis.compare(self.folder, **SMALL)
        self.assertIs(self.manifest()["common_reference"], True, self.manifest()["notes"])

    def test_wards_material_has_none(self):
        self.make_shiny()
        wardmis.compare(self.folder, **SMALL)
        data = self.manifest()
        self.assertIs(data["common_reference"], False)
        self.assertIn("WardMIS shows Ward's reflection, Cycles Beckmann's, of material 'Plaster'", data["notes"])

    def test_what_is_not_exported_has_none(self):
        tree = self.scene.objects["Floor"].data.materials[0].node_tree
        toon = tree.nodes.new("ShaderNodeBsdfToon")
        tree.links.new(toon.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
        wardmis.compare(self.folder, **SMALL)
        data = self.manifest()
        self.assertIs(data["common_reference"], False)
        self.assertIn("Toon", "\n".join(data["notes"]))

    def test_cycles_with_its_biases_has_none(self):
        self.scene.cycles.use_denoising = False  # not every Blender has a denoiser
        wardmis.compare(self.folder, as_is=True, **SMALL)
        self.assertIs(self.manifest()["common_reference"], False)


LOOKED_AT = [
    "device",
    "use_adaptive_sampling",
    "use_denoising",
    "sample_clamp_direct",
    "sample_clamp_indirect",
    "blur_glossy",
    "light_sampling_threshold",
    "caustics_reflective",
    "max_bounces",
    "diffuse_bounces",
    "glossy_bounces",
    "transmission_bounces",
    "transparent_max_bounces",
    "pixel_filter_type",
    "filter_width",
    "film_exposure",
]


class CyclesSettings(ComparisonTest):
    def during_a_render(self, **options) -> dict:
        """The settings in force while Cycles renders."""
        seen: dict = {}

        def look(_scene, *_):
            cycles, render = self.scene.cycles, self.scene.render
            for name in LOOKED_AT:
                seen[name] = getattr(cycles, name)
            seen["engine"], seen["persistent"] = render.engine, render.use_persistent_data

        bpy.app.handlers.render_pre.append(look)
        try:
            wardmis.compare(self.folder, **SMALL, **options)
        finally:
            bpy.app.handlers.render_pre.remove(look)
        return seen

    def test_biases_are_off_and_the_frame_is_the_same(self):
        settings, cycles = self.scene.wardmis, self.scene.cycles
        settings.film, settings.filter_type = "own", "gaussian"
        settings.filter_width, settings.film_exposure = 2.0, 1.5
        settings.max_depth = 4
        cycles.sample_clamp_indirect, cycles.samples, cycles.seed = 10, 77, 5
        self.scene.render.use_persistent_data = True
        self.scene.render.image_settings.file_format = "PNG"
        seen = self.during_a_render()
        expected = {
            "engine": "CYCLES",
            "device": "CPU",
            "use_adaptive_sampling": False,
            "use_denoising": False,
            "sample_clamp_direct": 0,
            "sample_clamp_indirect": 0,
            "blur_glossy": 0,
            "light_sampling_threshold": 0,
            "caustics_reflective": True,
            "max_bounces": 3,
            "diffuse_bounces": 3,
            "glossy_bounces": 3,
            "pixel_filter_type": "GAUSSIAN",
            "filter_width": 2.0,
            "film_exposure": 1.5,
            "persistent": False,
        }
        self.assertEqual({name: seen[name] for name in expected}, expected)
        # and afterwards the scene is the user's again
        self.assertEqual((cycles.sample_clamp_indirect, cycles.samples, cycles.seed), (10, 77, 5))
        self.assertEqual((cycles.max_bounces, cycles.filter_width, cycles.use_adaptive_sampling), (12, 1.5, True))
        render = self.scene.render
        self.assertEqual((render.engine, render.use_persistent_data), ("WARDMIS", True))
        self.assertEqual(render.image_settings.file_format, "PNG")

    def test_as_is_keeps_the_biases(self):
        self.scene.cycles.sample_clamp_indirect = 10
        self.scene.cycles.use_denoising = False
        seen = self.during_a_render(as_is=True)
        self.assertEqual((seen["sample_clamp_indirect"], seen["max_bounces"], seen["blur_glossy"]), (10, 12, 1))
        self.assertEqual(seen["device"], "CPU")
        self.assertEqual(self.manifest()["name"], "Cycles as set")

    def test_limits_are_the_same_in_both_and_that_is_said(self):
        settings, cycles = self.scene.wardmis, self.scene.cycles
        cycles.max_bounces, cycles.diffuse_bounces, cycles.glossy_bounces = 9, 2, 3
        cycles.transmission_bounces, cycles.transparent_max_bounces = 4, 5
        for changes, expected, options in (
            ({"max_depth": 8}, (7, 7, 7, 7, 8), "--max-depth 8"),
            ({"max_diffuse": 1}, (7, 1, 7, 7, 8), "--max-depth 8 --max-diffuse 1"),
            (
                {"max_transmission": 2, "max_transparent": 6},
                (7, 1, 7, 2, 6),
                "--max-depth 8 --max-diffuse 1 --max-transmission 2 --max-transparent 6",
            ),
            (
                {"bounces": "cycles"},
                (9, 2, 3, 4, 5),
                "--max-depth 10 --max-diffuse 2 --max-glossy 3 --max-transmission 4 --max-transparent 5",
            ),
            ({"integrator": "direct"}, (0, 0, 0, 0, 5), ""),
        ):
            for name, value in changes.items():
                setattr(settings, name, value)
            seen = self.during_a_render()
            kinds = ("max", "diffuse", "glossy", "transmission", "transparent_max")
            self.assertEqual(tuple(seen[f"{kind}_bounces"] for kind in kinds), expected)
            arguments = " ".join(self.calls()[-1])
            self.assertIn(options, arguments)
            said = f"paths end after the same bounces in both: {light_paths.Bounces(*expected)}"
            self.assertIn(said, self.manifest()["notes"])
            shutil.rmtree(self.folder)
        self.assertEqual(cycles.diffuse_bounces, 2)  # still the user's

    def test_limits_that_differ_are_said(self):
        self.scene.cycles.use_denoising = False
        self.during_a_render(as_is=True)
        theirs, ours = light_paths.Bounces(12, 4, 4, 12, 8), light_paths.Bounces(7, 7, 7, 7, 8)
        said = f"Cycles' paths have bounces of {theirs}, WardMIS' of {ours}"
        self.assertIn(said, " ".join(self.manifest()["notes"]))
        shutil.rmtree(self.folder)
        self.scene.wardmis.bounces = "cycles"
        self.during_a_render(as_is=True)
        self.assertNotIn("Cycles' paths", " ".join(self.manifest()["notes"]))

    def test_film_that_differs_is_said(self):
        settings, cycles = self.scene.wardmis, self.scene.cycles
        cycles.film_exposure, said = 1.75, "Cycles' film is WardMIS' own, not the scene's of exposure 1.75"
        self.assertEqual(self.during_a_render()["film_exposure"], 1.75)
        self.assertNotIn(said, " ".join(self.manifest()["notes"]))
        shutil.rmtree(self.folder)
        settings.film = "own"
        self.assertEqual(self.during_a_render()["film_exposure"], 1)
        self.assertIn(said, " ".join(self.manifest()["notes"]))

    def test_every_setting_exists(self):
        film = {"filter": {"type": "box", "width": 1.0}, "exposure": 1.0}
        later = {"media_type", "use_exr_interleave", "use_fast_gi"}
        settings = [
            *cycles_settings.frame(self.scene, bpy.context.view_layer, film, 2),
            *cycles_settings.unbiased(self.scene, light_paths.Bounces(7, 7, 7, 7, 8)),
        ]
        for owner, name, _ in settings:
            if owner in (self.scene.render, self.scene.cycles, self.scene.render.image_settings) and name not in later:
                self.assertTrue(hasattr(owner, name), name)

    def test_settings_come_back_after_a_failure(self):
        with self.assertRaises(ZeroDivisionError), overridden([(self.scene.cycles, "seed", 99)]):
            self.assertEqual(self.scene.cycles.seed, 99)
            1 / 0  # noqa: B018
        self.assertEqual(self.scene.cycles.seed, 0)


class Denoising(ComparisonTest):
    """By a Blender that was built without the denoiser: the render would be refused."""

    def setUp(self) -> None:
        super().setUp()
        import _cycles

        patch = mock.patch.object(_cycles, "with_openimagedenoise", False)
        patch.start()
        self.addCleanup(patch.stop)
        self.scene.cycles.use_denoising = True

    def test_is_left_out_where_cycles_is_as_set_and_that_is_said(self):
        outcome = wardmis.compare(self.folder, as_is=True, **SMALL)
        data = self.manifest()
        said = "Cycles' images are not denoised, .* this Blender was built without Open Image Denoise"
        self.assertRegex(" ".join(data["notes"]), said)
        self.assertRegex(outcome.warnings[0], said)
        self.assertIs(data["settings"]["use_denoising"], False)
        self.assertEqual(len(data["runs"]), 4)
        self.assertIs(self.scene.cycles.use_denoising, True)  # still the user's
        wardmis.compare(self.folder, as_is=True, **SMALL)  # and it goes on

    def test_is_off_anyway_otherwise(self):
        outcome = wardmis.compare(self.folder, **SMALL)
        self.assertNotIn("Open Image Denoise", " ".join(self.manifest()["notes"] + outcome.warnings))

    def test_is_not_missed_by_a_scene_without(self):
        self.assertTrue(cycles_settings.lacks_denoiser(self.scene))
        self.scene.cycles.use_denoising = False
        self.assertFalse(cycles_settings.lacks_denoiser(self.scene))


class Times(ComparisonTest):
    def test_are_stated_where_they_are_known(self):
        wardmis.compare(self.folder, **SMALL)
        for run in self.manifest()["runs"]:
            self.assertGreaterEqual(run["wall"], 0.005)
            self.assertLess(run["wall"], 5)
            if run["cpu"] is not None:
                self.assertGreater(run["cpu"], 0)

    def test_cpu_time_has_no_synchronisation_in_it(self):
        # half a million triangles to be synchronised for a few pixels: what is left of the render cannot be told from it
        mesh = bpy.data.meshes.new("Many")
        n = 500
        x, y = np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1))
        vertices = np.stack([x.ravel(), y.ravel(), 0 * x.ravel() - 1], axis=1)
        corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
        faces = np.stack([corner, corner + 1, corner + n + 2, corner + n + 1], axis=1)
        mesh.from_pydata(vertices.tolist(), [], faces.tolist())
        mesh.materials.append(self.material)
        self.add("Many", mesh)
        wardmis.compare(self.folder, **SMALL)
        for run in self.manifest()["runs"]:
            self.assertLess(run["wall"], 0.3)
            self.assertLess(run["cpu"] or 0, 0.3)


class Resuming(ComparisonTest):
    def rendered(self, **options) -> int:
        """How many images Cycles renders, those of one pixel left out."""
        count = [0]

        def look(_scene, *_):
            count[0] += not (self.scene.render.use_border)

        bpy.app.handlers.render_pre.append(look)
        self.addCleanup(lambda: look in bpy.app.handlers.render_pre and bpy.app.handlers.render_pre.remove(look))
        try:
            wardmis.compare(self.folder, **{**SMALL, **options})
        finally:
            bpy.app.handlers.render_pre.remove(look)
        return count[0] - 1  # the export

    def test_nothing_is_rendered_twice(self):
        self.assertEqual(self.rendered(), 8)
        self.assertEqual(self.rendered(), 0)
        self.assertEqual(self.rendered(cycles_seeds=3), 2)
        (self.folder / "cycles" / "run-0002-00002.exr").unlink()
        self.assertEqual(self.rendered(cycles_seeds=3), 1)
        self.assertEqual(self.rendered(cycles_reference_spp=8), 4)

    def test_a_damaged_image_is_rendered_again(self):
        self.rendered()
        folder = self.folder / "cycles"
        run, reference, other = (
            folder / name for name in ("run-0002-00002.exr", "reference-1000004-00004.exr", "run-0001-00001.exr")
        )
        run.write_bytes(run.read_bytes()[:300])
        reference.write_bytes(b"")
        other.write_bytes((self.folder / "images" / "Cycles.exr").read_bytes()[:50])
        said = []
        self.assertEqual(self.rendered(progress=said.append), 3)
        warnings = [event["message"] for event in said if event["event"] == "warning"]
        for path in (run, reference, other):
            self.assertIn(f"{path} is damaged; it is rendered again", warnings)

    def test_goes_on_although_the_export_has_other_last_bits(self):
        self.export_with_noise()
        self.assertEqual(self.rendered(), 8)
        first = (self.folder / "scene.glb").read_bytes()
        self.assertEqual(self.rendered(), 0)
        self.assertEqual((self.folder / "scene.glb").read_bytes(), first)
        self.assertEqual([p.name for p in self.folder.iterdir() if "tmp" in p.name], [])

    def test_goes_on_after_a_failure(self):
        failing = mock.patch.object(Manifest, "add_reference", side_effect=RuntimeError("stopped"))
        with failing, self.assertRaisesRegex(RuntimeError, "stopped"):
            self.rendered()
        self.assertEqual(len(self.manifest()["runs"]), 4)
        self.assertEqual(self.rendered(), 4)

    def test_another_scene_is_refused_and_takes_nothing_with_it(self):
        self.rendered()
        scene = self.folder / "scene.glb"
        kept, place = scene.read_bytes(), self.camera.location.z
        self.camera.location.z = 4
        for with_cycles in (True, False):
            with self.assertRaisesRegex(RuntimeError, "holds a comparison of another scene.* choose another output"):
                wardmis.compare(self.folder, **{**SMALL, "cycles": with_cycles})
        self.assertEqual(scene.read_bytes(), kept)
        self.assertEqual([p.name for p in self.folder.iterdir() if p.suffix == ".tmp"], [])
        self.camera.location.z = place
        self.assertEqual(self.rendered(), 0)

    def test_damaged_manifest_is_named(self):
        (self.folder / "cycles").mkdir(parents=True)
        (self.folder / "cycles" / "manifest.json").write_text("{}")
        with self.assertRaisesRegex(RuntimeError, "manifest.json is no list of renders .* delete it"):
            wardmis.compare(self.folder, **SMALL)


class Failures(ComparisonTest):
    def check(self, message: str, fake: str = "good", **options) -> None:
        with mock.patch.dict(os.environ, {"WARDMIS_FAKE": fake}), self.assertRaisesRegex(RuntimeError, message):
            wardmis.compare(self.folder, **{"cycles": False, **SMALL, **options})

    def test_renderer(self):
        self.check("the renderer failed .exit code 3.: bufferViews.0.: lies beyond the file", "exit3")
        self.check("ended without a report", "nothing")
        with mock.patch.dict(os.environ, {"WARDMIS_BINARY": "/nowhere"}):
            self.check("there is no renderer at /nowhere")

    def test_too_few_samples(self):
        self.check("1 samples per pixel make no curve; take at least 2", max_spp=1)

    def test_too_few_seeds(self):
        self.check("1 seeds cannot tell how sure", seeds=1)
        self.check("1 seeds of Cycles cannot tell", cycles_seeds=1, cycles=True)

    def test_no_camera(self):
        self.scene.camera = None
        self.check("no camera")

    def test_folder_that_cannot_be_made(self):
        self.folder.parent.mkdir(exist_ok=True)
        self.folder.write_text("a file")
        self.check("cannot be made: File exists; choose another output folder")

    def test_cycles_is_off(self):
        import addon_utils

        addon_utils.disable("cycles")
        try:
            self.check("Cycles is not there to be compared with: its add-on is off", cycles=True)
        finally:
            addon_utils.enable("cycles")


class Files(unittest.TestCase):
    def setUp(self) -> None:
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def test_exr_of_the_renderer(self):
        sys.path.insert(0, str(HERE))
        from fake_files import write_exr

        path = self.folder / "image.exr"
        write_exr(
            path, "Layer.1", {"Combined": "RGBA", "Normal": "XYZ"}, {"border": [2, 1, 12, 5], "resolution": [20, 10]}
        )
        channels = read_exr(path)
        combined, normal = read_pass(path), read_pass(path, "Normal")
        for i, letter in enumerate("RGBA"):
            np.testing.assert_array_equal(combined[..., i], channels[f"Layer.1.Combined.{letter}"])
        np.testing.assert_array_equal(normal[..., 2], channels["Layer.1.Normal.Z"])
        with self.assertRaisesRegex(OSError, "has no pass 'Depth'"):
            read_pass(path, "Depth")

    def test_exr_of_blender_in_each_compression(self):
        image = bpy.data.images.new("Test", 37, 21, alpha=True, float_buffer=True)
        self.addCleanup(bpy.data.images.remove, image)
        values = np.random.default_rng(1).random((21, 37, 4), np.float32)
        values[..., 3] = 1
        image.pixels.foreach_set(values.ravel())
        scene = bpy.context.scene
        settings = scene.render.image_settings
        if hasattr(settings, "media_type"):
            settings.media_type = "IMAGE"
        settings.file_format, settings.color_depth, settings.color_mode = "OPEN_EXR", "32", "RGBA"
        for codec in ("NONE", "ZIP", "ZIPS"):
            settings.exr_codec = codec
            path = self.folder / f"{codec}.exr"
            image.save_render(str(path), scene=scene)
            np.testing.assert_array_equal(read_pass(path), values[::-1])
        settings.exr_codec = "PIZ"
        image.save_render(str(path), scene=scene)
        with self.assertRaisesRegex(OSError, "compressed in a way"):
            read_pass(path)

    def test_what_is_no_exr(self):
        path = self.folder / "x.exr"
        path.write_bytes(b"nothing")
        with self.assertRaisesRegex(OSError, "is no OpenEXR file"):
            read_header(path)

    def test_reasons_are_short(self):
        def material(name):
            return {"name": name, "extensions": {"WARDMIS_scene": {"specular": {"value": [1, 1, 1]}}}}

        document = {"materials": [material(n) for n in "ABCDE"], "extensions": {"WARDMIS_scene": {"notes": []}}}
        (reason,) = SceneFile("", document).other_than_blenders()
        self.assertTrue(reason.endswith("of material 'A', 'B', 'C' and 2 more"), reason)

    def test_models_that_cycles_lacks(self):
        def reasons(**closure):
            material = {"name": "A", "extensions": {"WARDMIS_scene": {"closures": [{"weight": {}, **closure}]}}}
            document = {"materials": [material], "extensions": {"WARDMIS_scene": {"notes": ["fog"]}}}
            return SceneFile("", document).other_than_blenders()

        self.assertEqual(reasons(type="glossy", distribution="multi-ggx", version=4), ["fog"])
        self.assertEqual(reasons(type="ward")[0], "WardMIS shows Ward's reflection, Cycles Beckmann's, of material 'A'")
        self.assertIn("from facet to facet", reasons(type="principled", distribution="multi-ggx", version=3)[0])
        self.assertIn("from facet to facet", reasons(type="glass", distribution="multi-ggx", version=3)[0])
        beckmann = {"type": "glossy", "distribution": "beckmann", "version": 3, "alphaX": {"value": 0.1}}
        self.assertIn("by one roughness", reasons(**beckmann, alphaY={"value": 0.2})[0])
        self.assertEqual(reasons(**beckmann, alphaY={"value": 0.1}), ["fog"])
        self.assertEqual(reasons(type="glossy", distribution="ashikhmin-shirley", version=3), ["fog"])

    def test_checkpoints(self):
        self.assertEqual(converge.checkpoints(1), [1])
        self.assertEqual(converge.checkpoints(64), [1, 2, 4, 8, 16, 32, 64])
        self.assertEqual(converge.checkpoints(48), [1, 2, 4, 8, 16, 32, 48])


INTERRUPTS = """
import os, signal, sys, time
import bpy, wardmis
from wardmis.comparison import cycles, run
render = bpy.context.scene.render
render.resolution_percentage = 2

def ctrl_c():
    os.kill(os.getpid(), signal.SIGINT)

def never():
    pass

def exporting():
    export = run.export_scene
    run.export_scene = lambda path: (ctrl_c(), export(path))

def in_render(wanted):
    def look(*_):
        if render.engine == "CYCLES" and wanted():
            ctrl_c()
            time.sleep(0.2)  # a render that takes its time
    bpy.app.handlers.render_pre.append(look)

def one_pixel():
    in_render(lambda: render.use_border)

def rendering():
    count = []
    in_render(lambda: not render.use_border and (count.append(1) or len(count) == 2))

def around_save(which, after):
    count, save = [], cycles._Renders._save
    def saving(self, path):
        count.append(path)
        here = len(count) == which
        if here and not after:
            ctrl_c()
        save(self, path)
        if here and after:
            ctrl_c()
            time.sleep(0.2)  # another thread may be the one that hears it, and the next render is a short one
    cycles._Renders._save = saving

def saving():
    around_save(2, after=False)

def saved():
    around_save(2, after=True)

def in_the_renderer():
    note = run._note
    def noting(event, *others):
        if event.get("phase") == "runs" and event["done"] == 2:
            ctrl_c()
        note(event, *others)
    run._note = noting
"""


class CommandLine(unittest.TestCase):
    """In a Blender of its own, as ./dev compare starts it."""

    def setUp(self) -> None:
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def run_blender(self, *arguments: str, fake: str = "good") -> subprocess.CompletedProcess[str]:
        (self.folder / "scripts" / "addons").mkdir(parents=True, exist_ok=True)
        link = self.folder / "scripts" / "addons" / "wardmis"
        if not link.exists():
            link.symlink_to(ADDON, target_is_directory=True)
        environment = {
            "BLENDER_USER_RESOURCES": str(self.folder / "resources"),
            "BLENDER_USER_SCRIPTS": str(self.folder / "scripts"),
            "BLENDER_USER_CONFIG": str(self.folder / "config"),
            "WARDMIS_BINARY": str(FAKE),
            "WARDMIS_FAKE": fake,
            "TMPDIR": str(self.folder / "temporary"),
        }
        (self.folder / "temporary").mkdir(exist_ok=True)
        command = [bpy.app.binary_path, *arguments]
        return subprocess.run(command, env={**os.environ, **environment}, capture_output=True, text=True, timeout=120)

    SMALL = ("--seeds", "2", "--max-spp", "2", "--cycles-reference-spp", "1")
    SCRIPT = str(HERE.parents[1] / "blend" / "compare.py")

    def test_script(self):
        small = "import bpy; bpy.context.scene.render.resolution_percentage = 2"
        start = ["--background", "--factory-startup", "--addons", "wardmis", "--python-expr", small]
        start += ["--python-exit-code", "1", "--python", self.SCRIPT, "--"]
        done = self.run_blender(*start, "-o", str(self.folder / "out"), *self.SMALL)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn(str(self.folder / "out" / "report.html"), done.stdout)
        self.assertNotIn("Fra:", done.stdout)
        self.assertIn("Cycles, seed 1, 0 %", done.stderr)
        done = self.run_blender(*start, "-o", str(self.folder / "out"), "--seeds", "1")
        self.assertEqual(done.returncode, 1)
        self.assertIn("error: WardMIS: 1 seeds cannot", done.stderr)

    def interrupted(self, moment: str, start: str, fake: str = "good") -> subprocess.CompletedProcess[str]:
        """A comparison, begun by `start`, to which Ctrl-C comes at a moment: a function that INTERRUPTS has."""
        script = INTERRUPTS + f"{moment}()\n{start}"
        arguments = ["--background", "--factory-startup", "--addons", "wardmis", "--python-exit-code", "1"]
        words = ["-o", str(self.folder / "out"), *self.SMALL]
        return self.run_blender(*arguments, "--python-expr", script, "--", *words, fake=fake)

    def runs_left(self) -> list[dict]:
        """Of the manifest; each with its image."""
        manifest = self.folder / "out" / "cycles" / "manifest.json"
        runs = json.loads(manifest.read_text(encoding="utf-8"))["runs"]
        for run in runs:
            self.assertEqual(read_pass(manifest.parent / run["path"]).shape, (21, 38, 4))
        return runs

    def test_ctrl_c_at_any_moment(self):
        main = "from wardmis.comparison.command_line import main; sys.exit(main(sys.argv[sys.argv.index('--') + 1 :]))"
        moments = {"exporting": None, "one_pixel": 0, "rendering": 1, "saving": 2, "saved": 2, "in_the_renderer": 4}
        for moment, runs in moments.items():
            with self.subTest(moment):
                out = self.folder / "out"
                fake = "slow" if moment == "in_the_renderer" else "good"
                done = self.interrupted(moment, main, fake)
                self.assertEqual(done.returncode, 130, done.stdout + done.stderr)
                self.assertRegex(done.stderr, "(?m)^WardMIS: stopped; .* the same comparison again goes on from there$")
                self.assertIn(f"stopped; {out} keeps what is done", done.stderr)
                self.assertNotIn("error", done.stderr)
                self.assertEqual(list((self.folder / "temporary").glob("blender_*")), [])
                self.assertEqual([p for p in out.rglob("*") if "tmp" in p.name], [])
                if runs is not None:
                    self.assertEqual(len(self.runs_left()), runs)
                done = self.interrupted("never", main)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                self.assertEqual(len(self.runs_left()), 4)
                shutil.rmtree(out)

    def test_a_part_of_an_image_is_no_run(self):
        """Blender's own answer to a Ctrl-C, where a script calls wardmis.compare(): FINISHED, and a part of the image."""
        call = (
            "try: wardmis.compare(sys.argv[-7], seeds=2, max_spp=2)\n"
            "except wardmis.comparison.interrupt.Stopped as stopped: print(stopped, file=sys.stderr)"
        )
        done = self.interrupted("rendering", call)
        self.assertIn("stopped; ", done.stderr, done.stdout)
        self.assertEqual(len(self.runs_left()), 1)

    @unittest.skipUnless(hasattr(bpy.utils, "register_cli_command"), "came with Blender 4.2")
    def test_command(self):
        file = self.folder / "small scene.blend"
        make = "import bpy; bpy.context.scene.render.resolution_percentage = 2; bpy.ops.wm.save_mainfile(filepath={!r})"
        self.run_blender("--background", "--factory-startup", "--python-expr", make.format(str(file)))
        command = ["--addons", "wardmis", "--command", "wardmis", "compare"]
        done = self.run_blender(*command, str(file), "-o", str(self.folder / "out"), *self.SMALL)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertTrue((self.folder / "out" / "report.html").is_file())
        done = self.run_blender(*command, str(self.folder / "none.blend"), "-o", str(self.folder / "out"))
        self.assertEqual(done.returncode, 1)
        self.assertIn("none.blend", done.stderr)
