# SPDX-License-Identifier: GPL-3.0-or-later
"""The contract of the command, docs/command.md: exit codes, messages, files, progress, statistics."""

import base64
import json
import os
import resource
import shutil
import signal
import subprocess
import time
from pathlib import Path

import exr
import numpy as np
import OpenImageIO as oiio
from command import BINARY, CommandTest, close, combined, same

PASSES = {
    "Combined": "RGBA",
    "Depth": "Z",
    "Normal": "XYZ",
    "Albedo": "RGB",
    "Variance": "RGB",
    "Allocation Lobe": "X",
    "Allocation Cosine": "X",
    "Allocation Light": "X",
}


def write_exr(path, pixels):
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, oiio.FLOAT)
    file = oiio.ImageOutput.create(str(path))
    file.open(str(path), spec)
    file.write_image(np.ascontiguousarray(pixels, np.float32))
    file.close()


def channels(path):
    file = oiio.ImageInput.open(str(path))
    spec = file.spec()
    file.close()
    return spec


class Usage(CommandTest):
    def test_help_and_version(self):
        self.assertIn("render", self.run_command("--help").stdout)
        for verb in ("render", "info", "compare"):
            self.assertIn(verb, self.run_command(verb, "--help").stdout)
        self.assertRegex(self.run_command("--version").stdout, r"\Awardmis \d+\.\d+\.\d+ ")

    def test_mistakes_end_with_2(self):
        render = "render", self.scene(), "-o", self.out
        for arguments, says in (
            ((), "a verb is missing; there are: render, info, compare"),
            (("paint",), "there is no verb 'paint'; there are: render, info, compare"),
            (("render",), "SCENE"),
            (("render", self.scene()), "--output"),
            ((*render, "--sppp", "4"), "--sppp"),
            ((*render, "--spp", "0"), "--spp"),
            ((*render, "--spp", "many"), "many"),
            ((*render, "--spp", "4", "--time", "1"), "--time"),
            ((*render, "--target-error", "0"), "--target-error"),
            ((*render, "--target-error", "0.01", "--samples", "0..4"), "--target-error"),
            ((*render, "--allocation", "fair"), "second-moment"),
            ((*render, "--sampler", "halton"), "sobol"),
            ((*render, "--allocation", "auto", "--weights", "nonbalance"), "standard-deviation"),
            ((*render, "--integrator", "bidirectional", "--weights", "cutoff"), "variance-aware"),
            ((*render, "--weights", "variance-aware"), "--integrator bidirectional"),
            ((*render, "--light-paths", "65"), "--light-paths"),
            ((*render, "--samples-per-hit", "257"), "256"),
            ((*render, "--min-fraction", "0.9"), "--min-fraction"),
            ((*render, "--threads", "-1"), "--threads"),
            ((*render, "--resolution", "48"), "WIDTHxHEIGHT"),
            ((*render, "--resolution", "0x10"), "WIDTHxHEIGHT"),
            ((*render, "--resolution", "1000000x10"), "at most 65536 pixels"),
            ((*render, "--passes", "combined,beauty"), "beauty"),
            ((*render, "--passes", "combined=Beauty"), "cannot be a name"),
            ((*render, "--passes", "combined,diffuse-direct=Combined"), "two passes are called 'Combined'"),
            ((*render, "--passes", "uv,uv"), "two passes are called 'UV'"),
            (("render", self.scene(), "-o", self.folder / "out.png"), "ends in .exr"),
            ((*render, "--preview", self.folder / "preview"), "ends in .exr"),
            (("render", self.scene(), "-o", ""), "--output: is empty"),
            ((*render, "--layer", ""), "--layer: is empty"),
            ((*render, "--layer", "x" * 201), "--layer: has 201 bytes"),
            ((*render, "--seed", "-1"), "'-1' is not a whole number"),
            ((*render, "--seed", str(2**64)), "is not a whole number"),
            ((*render, "--time", "nan"), "'nan' is not a number"),
            ((*render, "--spp", "4", "--spp", "5"), "--spp is given more than once"),
            ((*render, "--stats", self.out), "is named by both --output and --stats"),
            ((*render, "--preview", self.folder / "." / "out.exr"), "is named by both --output and --preview"),
            ((*render, "--stats", self.scene()), "is named by both SCENE and --stats"),
            (("compare", self.out, self.out, "--max-relmse", "nan"), "'nan' is not a number"),
            (("compare", self.out, self.scene(), "--difference", self.out), "both IMAGE and --difference"),
            (("compare", self.scene(), self.out, "--difference", self.out), "both REFERENCE and --difference"),
        ):
            with self.subTest(arguments=arguments):
                self.refused(2, *arguments, says=[says])
        self.assertFalse(self.out.exists())

    def test_the_default_allocation_yields_to_other_weights(self):
        """It is for balance weights; named, it stays, or is refused (above)."""
        stats = self.folder / "stats.json"
        for options, allocation, says in (
            ((), "auto", ""),
            (("--weights", "balance"), "auto", ""),
            (("--weights", "nonbalance"), "equal", "shared equally: the default allocation, auto, is for balance weights, not for nonbalance"),
            (("--weights", "power"), "equal", "not for power"),
            (("--allocation", "auto", "--weights", "power"), "auto", ""),
            (("--allocation", "variance", "--weights", "power"), "variance", ""),
        ):  # fmt: skip
            with self.subTest(options):
                done = self.render("--spp", 1, "--stats", stats, *options)
                said = json.loads(stats.read_text())
                self.assertEqual(said["settings"]["allocation"], allocation)
                for text in (done.stderr, " ".join(said["notes"])):
                    self.assertIn(says, text)
                    self.assertEqual("shared equally" in text, says != "")


class Files(CommandTest):
    def test_scene_that_is_missing(self):
        self.refused(4, "render", self.folder / "none.glb", "-o", self.out, says=["none.glb"])
        self.refused(4, "info", self.folder / "none.glb", says=["none.glb"])

    def test_scene_that_cannot_be_read(self):
        whole = self.scene().read_bytes()
        bad = self.folder / "bad.glb"
        for content in (b"", b"glTF", whole[:-1], whole[: len(whole) // 2], b"solid" + whole[5:], b"{}"):
            bad.write_bytes(content)
            for verb in (("render", bad, "-o", self.out), ("info", bad)):
                self.refused(3, *verb, says=["bad.glb"])
        self.refused(4, "render", self.folder, "-o", self.out)
        self.assertFalse(self.out.exists())

    def test_output_that_cannot_be_written(self):
        for out in (self.folder / "none" / "out.exr", self.folder, Path("/proc/out.exr")):
            self.refused(4, "render", self.scene(), "-o", out, says=[str(out)])
        self.refused(
            4, "render", self.scene(), "-o", self.out, "--stats", self.folder / "none" / "s.json", says=["s.json"]
        )
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_disk_that_is_full(self):
        """A limit on the size of files stands for it. What was there stays, and nothing is left over."""
        self.out.write_bytes(b"old")
        for limit in (0, 4096):
            self.refused(
                4, "render", self.scene(), "-o", self.out, "--spp", "1", "--resolution", "64x64", says=["out.exr", "free space"],
                preexec_fn=lambda limit=limit: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)),
            )  # fmt: skip
        self.assertEqual([p.name for p in self.folder.iterdir()], ["out.exr"])
        self.assertEqual(self.out.read_bytes(), b"old")

    def test_frame_that_memory_does_not_hold(self):
        """Refused with numbers before anything is drawn: 65536 x 65536 pixels, and what a limit of its own leaves."""
        frame = "render", self.scene(), "-o", self.out, "--resolution"
        limit = resource.RLIMIT_AS, (700_000_000, 700_000_000)
        for options, says, more in (
            (
                ("65536x65536",),
                ("65536 x 65536 pixels with 'auto' take 1151.1 GB", "are free", "lower the resolution"),
                {},
            ),
            (
                ("3000x2000",),
                ("1.6 GB of memory (268 bytes each)", "0."),
                {"preexec_fn": lambda: resource.setrlimit(*limit)},
            ),
        ):
            done = self.run_command(*frame, *options, code=5, **more)
            for text in says:
                self.assertIn(text, done.stderr)
            self.assertFalse(self.out.exists())

    def test_memory_of_a_pixel(self):
        """`auto` takes at most 300 bytes a pixel in all; they were 643."""

        def peak(size):
            words = "render", self.scene(), "-o", self.out, "--resolution", size, "--spp", 16, "--integrator", "direct"
            words += "--samples-per-hit", 1, "--allocation", "auto", "--threads", 2
            process = subprocess.Popen([BINARY, *map(str, words)], stdout=subprocess.DEVNULL)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            self.assertEqual(process.returncode, 0)
            return 1024 * usage.ru_maxrss

        self.assertLess((peak("1000x600") - peak("100x60")) / (1000 * 600 - 100 * 60), 300)

    def test_paths_of_every_kind(self):
        place = self.folder / "Bilder für '東京' $HOME %04d"
        place.mkdir()
        scene, out = place / "eine Szene.glb", place / "ein Bild.exr"
        shutil.copy(self.scene(), scene)
        more = "--stats", place / "Größe.json", "--preview", place / "Vorschau.exr", "--preview-interval", "0"
        self.render("--spp", "2", "--layer", "Ebene 1.ä", *more, scene=scene, out=out)
        names = ["Größe.json", "Vorschau.exr", "ein Bild.exr", "eine Szene.glb"]
        self.assertEqual(sorted(p.name for p in place.iterdir()), names)
        self.assertIn("Ebene 1.ä.Combined.R", channels(out).channelnames)
        self.assertEqual(json.loads(more[1].read_text())["scene"], str(scene))
        # of the current folder, with a dash in front
        (place / "-o.glb").write_bytes(scene.read_bytes())
        self.render("--spp", "1", scene="./-o.glb", out="-x.exr", cwd=place)
        self.assertTrue((place / "-x.exr").exists())


class Image(CommandTest):
    def test_passes_and_attributes(self):
        stats = self.folder / "stats.json"
        self.render("--spp", "8", "--layer", "Front", "--stats", stats)
        spec = channels(self.out)
        self.assertEqual((spec.width, spec.height, spec.nchannels), (48, 32, sum(map(len, PASSES.values()))))
        expected = {f"Front.{name}.{c}" for name, letters in PASSES.items() for c in letters}
        self.assertEqual(set(spec.channelnames), expected)
        self.assertEqual(str(spec.format), "float")
        image = exr.read(self.out)
        for name, pixels in image.passes.items():
            self.assertTrue(np.isfinite(pixels).all(), name)
        hit = image.passes["Depth"][..., 0] < 1e10
        self.assertGreater(hit.mean(), 0.3)
        shares = sum(image.passes[f"Allocation {t}"][..., 0] for t in ("Lobe", "Cosine", "Light"))
        np.testing.assert_allclose(shares[hit], 1, atol=1e-5)
        self.assertTrue((np.linalg.norm(image.passes["Normal"], axis=2) < 1 + 1e-5).all())
        self.assertTrue((image.passes["Variance"] >= 0).all())
        attributes = {k: v for k, v in image.attributes.items() if k.startswith("wardmis:")}
        wanted = ["version", "settings", "seconds", "samples", "rays", "left_out", "notes"]
        self.assertLessEqual({f"wardmis:{key}" for key in wanted}, set(attributes))
        self.assertEqual(json.loads(attributes["wardmis:settings"]), json.loads(stats.read_text())["settings"])

    def test_subset_of_passes(self):
        self.render("--spp", "2")
        whole = exr.read(self.out).passes
        self.render("--spp", "2", "--passes", "depth,combined", out=self.folder / "some.exr")
        some = exr.read(self.folder / "some.exr").passes
        self.assertEqual(set(some), {"Combined", "Depth"})
        for name, pixels in some.items():
            np.testing.assert_array_equal(pixels, whole[name])

    def test_passes_of_what_is_met_first(self):
        self.render(
            "--spp",
            "2",
            "--passes",
            "position,uv,object-index=IndexOB,material-index,emission,environment=Env,glossy-color=GlossCol,depth",
        )
        passes = exr.read(self.out).passes
        self.assertEqual(
            set(passes), {"Position", "UV", "IndexOB", "Material Index", "Emission", "Env", "GlossCol", "Depth"}
        )
        self.assertEqual(passes["UV"].shape[2], 3)
        hit = passes["Depth"][..., 0] < 1e10
        self.assertTrue(hit.sum() > 0)
        np.testing.assert_array_equal(np.abs(passes["Position"]).max(axis=2) > 0, hit)

    def test_resolution(self):
        self.render("--spp", "1", "--resolution", "33x70")
        self.assertEqual(combined(self.out).shape, (70, 33, 4))

    def test_output_that_is_full(self):
        """What is lost on its way out is no success."""
        self.render("--spp", "1")
        for words in (
            ("info", self.scene()),
            ("info", "--json", self.scene()),
            ("compare", self.out, self.out),
            ("study", "--trials", 0),
            ("study", "--trials", 0, "--json"),
        ):
            with self.subTest(words=words), open("/dev/full", "w") as full:
                done = subprocess.run(
                    [BINARY, *map(str, words)], stdout=full, stderr=subprocess.PIPE, text=True, timeout=60
                )
                self.assertEqual(done.returncode, 4, done.stderr)
                self.assertRegex(done.stderr, r"\Awardmis: error: [^\n]*No space left on device[^\n]*\n\Z")

    def test_statistics(self):
        file = self.folder / "stats.json"
        pilot = "--allocation", "second-moment"
        self.render("--spp", "8", "--threads", "2", "--seed", "7", "--stats", file, *pilot)
        stats = json.loads(file.read_text())
        for key, parts in {
            "seconds": "read build pilot render write total",
            "cpu_seconds": "pilot render",
            "samples": "lobe cosine light total",
            "rays": "camera lobe cosine shadow total",
            "counts": "nan infinite negative underflow",
            "scene_counts": "triangles instances materials lights emissive_triangles",
        }.items():
            self.assertEqual(set(stats[key]), set(parts.split()), key)
            self.assertTrue(all(value >= 0 for value in stats[key].values()), key)
        for key in ("samples", "rays"):
            self.assertEqual(sum(stats[key].values()), 2 * stats[key]["total"], key)
        times = stats["seconds"]
        self.assertLessEqual(sum(v for k, v in times.items() if k != "total"), times["total"] * 1.01)
        self.assertGreater(times["pilot"], 0)
        self.assertEqual(stats["pixels"], 48 * 32)
        self.assertEqual(stats["camera_paths"], 48 * 32 * 8)
        self.assertEqual((stats["samples_per_pixel"], stats["threads"], stats["scene"]), (8, 2, str(self.scene())))
        self.assertEqual((stats["settings"]["seed"], stats["settings"]["allocation"]), (7, "second-moment"))
        self.assertEqual([stats["counts"][key] for key in ("nan", "infinite", "negative")], [0, 0, 0])
        for key in ("version", "needs", "isa"):
            self.assertIsInstance(stats[key], str)
        for key in ("left_out", "notes"):
            self.assertIsInstance(stats[key], list)
        self.assertAlmostEqual(
            stats["mean_variance"], luminance(exr.read(self.out).passes["Variance"]).mean(), delta=1e-6
        )

    def test_statistics_of_paths_from_lights(self):
        file = self.folder / "stats.json"
        numbers = "--light-paths", "0.5", "--connections", "2", "--later-connections", "0"
        bidirectional = "--integrator", "bidirectional", "--allocation", "equal"
        self.render("--spp", "4", "--stats", file, *bidirectional, *numbers)
        stats = json.loads(file.read_text())
        self.assertEqual(set(stats["rays"]), {"camera", "lobe", "cosine", "shadow", "light", "connections", "total"})
        self.assertEqual(sum(stats["rays"].values()), 2 * stats["rays"]["total"])
        self.assertGreater(stats["rays"]["light"], 48 * 32 * 4 * 0.5)
        self.assertGreater(stats["rays"]["connections"], 0)
        expected = {"samples_at_hit": 6, "light_paths": 0.5, "connections": 2, "later_connections": 0}
        self.assertEqual({**stats["ways"], **expected}, stats["ways"])
        self.assertTrue(stats["ways"]["light_tracing"])
        self.render("--spp", "4", "--stats", file, *bidirectional, "--light-paths", "0")
        stats = json.loads(file.read_text())
        self.assertIsNone(stats["ways"])
        self.assertTrue(any(note.startswith("no paths from lights") for note in stats["left_out"]))

    def test_scene_that_needs_little(self):
        """No lights but points, no specular, no sky: what is left out is said, and has no pass."""
        quad = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
        indices = np.array([0, 1, 2, 0, 2, 3], np.uint32)
        document = {
            "asset": {"version": "2.0"},
            "extensionsUsed": ["KHR_lights_punctual", "WARDMIS_scene"],
            "extensions": {
                "KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 5}]},
                "WARDMIS_scene": {"version": 1, "film": {"resolution": [16, 16]}},
            },
            "scenes": [{"nodes": [0, 1, 2]}],
            "nodes": [
                {"mesh": 0},
                {"camera": 0, "translation": [0, 0, 3]},
                {"translation": [0, 0, 2], "extensions": {"KHR_lights_punctual": {"light": 0}}},
            ],
            "cameras": [{"type": "perspective", "perspective": {"yfov": 0.4, "znear": 0.1}}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "accessors": [
                {
                    "bufferView": 0,
                    "componentType": 5126,
                    "count": 4,
                    "type": "VEC3",
                    "min": [-1, -1, 0],
                    "max": [1, 1, 0],
                },
                {"bufferView": 1, "componentType": 5125, "count": 6, "type": "SCALAR"},
            ],
            "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
            "buffers": [{"byteLength": 72, "uri": "quad.bin"}],
        }
        (self.folder / "quad.bin").write_bytes(quad.tobytes() + indices.tobytes())
        scene = self.folder / "quad.gltf"
        scene.write_text(json.dumps(document))
        self.run_command("render", scene, "-o", self.out, "--spp", "4", "--stats", self.folder / "s.json")
        stats = json.loads((self.folder / "s.json").read_text())
        left_out = " ".join(stats["left_out"])
        for what in ("environment", "specular", "pilot"):
            self.assertIn(what, left_out)
        self.assertEqual(stats["seconds"]["pilot"], 0)
        self.assertEqual(stats["samples"]["lobe"], 0)
        self.assertNotIn("Allocation Lobe", exr.read(self.out).passes)
        named = "--passes", "allocation,depth", "--preview", self.folder / "p.exr", "--preview-interval", "0"
        self.run_command("render", scene, "-o", self.folder / "named.exr", "--spp", "2", *named)
        for path in (self.folder / "named.exr", self.folder / "p.exr"):
            passes = exr.read(path).passes
            self.assertEqual(set(passes), {"Depth", *(f"Allocation {t}" for t in ("Lobe", "Cosine", "Light"))})
            self.assertFalse(passes["Allocation Lobe"].any())
        # Lambert under a point, straight below it: 0.8/pi * 5/2^2
        self.assertAlmostEqual(combined(self.out)[7:9, 7:9, 0].mean(), 0.8 / np.pi * 5 / 4, delta=2e-3)
        # with a lamp that is too small to be there, or without any, nothing gives light
        document["nodes"][2]["extensions"] = {"WARDMIS_scene": {"light": 0}}
        lamp = {"type": "area", "radiance": 1, "size": [1e-12, 1e-12]}
        document["extensions"]["WARDMIS_scene"]["lights"] = [lamp]
        scene.write_text(json.dumps(document))
        said = self.run_command("render", scene, "-o", self.out, "--spp", "1").stderr
        self.assertIn("the scene's lights are so weak or so small", said)
        document["scenes"][0]["nodes"].pop()
        scene.write_text(json.dumps(document))
        self.assertIn("gives light", self.run_command("render", scene, "-o", self.out, "--spp", "1").stderr)


class Progress(CommandTest):
    def test_json_lines(self):
        done = self.render(
            "--spp", "16", "--progress", "json", "--preview", self.folder / "p.exr", "--preview-interval", "0"
        )
        events = self.events(done.stdout)
        kinds = [event["event"] for event in events]
        self.assertEqual((kinds[0], kinds[-1]), ("start", "done"))
        self.assertEqual((kinds.count("start"), kinds.count("done")), (1, 1))
        self.assertEqual(done.stderr, "")
        start, last = events[0], events[-1]
        self.assertEqual((start["width"], start["height"], start["spp"]), (48, 32, 16))
        self.assertEqual({p["name"]: p["channels"] for p in start["passes"]}, PASSES)
        self.assertLessEqual({"version", "left_out", "notes"}, set(start))
        progress = [event for event in events if event["event"] == "progress"]
        self.assertEqual({event["phase"] for event in progress}, {"pilot", "render"})
        for key in ("samples", "fraction", "seconds"):
            values = [event[key] for event in progress]
            self.assertEqual(values, sorted(values), key)
        self.assertTrue(
            all(event["of"] == 16 and 0 <= event["fraction"] <= 1 and event["left"] >= 0 for event in progress)
        )
        previews = [event for event in events if event["event"] == "preview"]
        self.assertTrue(previews)
        self.assertEqual(previews[0]["path"], str(self.folder / "p.exr"))
        self.assertEqual(set(exr.read(self.folder / "p.exr").passes), {"Combined"})
        self.assertEqual((last["path"], last["samples"]), (str(self.out), 16))
        self.assertEqual(last["stats"]["samples_per_pixel"], 16)

    def test_something_is_seen_at_once(self):
        """Of a sample that takes seconds coarse images are there before it, and its parts, without holes."""
        preview = self.folder / "p.exr"
        command = [BINARY, "render", self.scene(), "-o", self.out, "--resolution", "1200x800", "--threads", "1"]
        command += ["--spp", "1", "--samples-per-hit", "6", "--progress", "json", "--preview", preview]
        command += ["--preview-interval", "0"]
        pipes = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
        process = subprocess.Popen([*map(str, command)], text=True, **pipes)
        self.addCleanup(close, process)
        means, dark, seconds, began = [], [], [], None
        for line in process.stdout:
            event = json.loads(line)
            if event["event"] == "start":
                began = time.monotonic()
            if event["event"] == "preview":
                seconds.append(time.monotonic() - began)
                image = combined(preview)[..., :3]
                self.assertEqual(image.shape, (800, 1200, 3))
                means.append(float(np.minimum(image, 1).mean()))
                dark.append(float((image == 0).all(axis=2).mean()))
        self.assertEqual(process.wait(), 0)
        self.assertGreater(len(means), 3)
        final = combined(self.out)[..., :3]
        np.testing.assert_allclose(means, np.minimum(final, 1).mean(), rtol=0.05)
        np.testing.assert_allclose(dark, (final == 0).all(axis=2).mean(), atol=0.05)
        self.assertLess(seconds[0], 0.25 * seconds[-1])

    def test_error_is_an_event_too(self):
        done = self.refused(4, "render", self.folder / "none.glb", "-o", self.out, "--progress", "json")
        (event,) = self.events(done.stdout)
        self.assertEqual((event["event"], event["code"]), ("error", 4))
        self.assertIn(event["message"], done.stderr)

    def test_time(self):
        began = time.monotonic()
        done = self.render("--time", "1.5", "--progress", "json")
        self.assertLess(time.monotonic() - began, 1.5 + 3)
        events = self.events(done.stdout)
        self.assertIsNone(events[0]["spp"])
        self.assertTrue(all(event["of"] is None for event in events if event["event"] == "progress"))
        seconds = events[-1]["stats"]["seconds"]
        self.assertTrue(1.2 < seconds["pilot"] + seconds["render"] < 2.5, seconds)
        self.assertGreater(events[-1]["samples"], 0)
        self.assertTrue(self.out.exists())

    def test_target_error(self):
        done = self.render("--target-error", "0.01", "--progress", "json")
        events = self.events(done.stdout)
        self.assertIsNone(events[0]["spp"])
        progress = [event for event in events if event["event"] == "progress"]
        self.assertTrue(all(event["of"] is None for event in progress))
        fractions = [event["fraction"] for event in progress]
        self.assertTrue(all(0 <= fraction <= 1 for fraction in fractions), fractions)
        self.assertIsNone(progress[0]["left"])  # before there is an estimate
        stats = events[-1]["stats"]
        self.assertEqual((stats["settings"]["target_error"], stats["settings"]["spp"]), (0.01, 65536))
        self.assertTrue(0 < stats["error"]["relmse_trimmed"] < stats["error"]["upper"] <= 0.01, stats["error"])
        self.assertLess(stats["samples_per_pixel"], 1024)
        done = self.render("--target-error", "0.01")
        self.assertRegex(done.stdout, r"error about [\d.]+, below [\d.]+ with 95 %")

    def test_target_error_out_of_reach(self):
        """The image is there, and what it lacks is said."""
        done = self.render("--target-error", "1e-8", "--spp", "16")
        self.assertIn("the image's error is not yet surely below 1e-08: after 16 samples per pixel", done.stderr)
        done = self.render("--target-error", "1e-8", "--spp", "4")
        self.assertIn("4 samples per pixel are too few to tell the image's error", done.stderr)
        self.assertTrue(self.out.exists())

    def test_bar(self):
        done = self.render("--spp", "4", "--progress", "bar")
        self.assertRegex(done.stderr, r"\[#*\.*\] +\d+ %")
        self.assertIn(str(self.out), done.stdout)


class Stopping(CommandTest):
    def end(self, process, within=10):
        process.stdout.read()
        return process.wait(within)

    def left(self):
        return [p.name for p in self.folder.iterdir()]

    def test_interrupt_keeps_the_image_so_far(self):
        process = self.started()
        process.send_signal(signal.SIGINT)
        self.assertEqual(self.end(process), 130)
        self.assertIn("out.partial.exr", process.stderr.read())
        self.assertEqual(self.left(), ["out.partial.exr"])
        image = exr.read(self.folder / "out.partial.exr")
        self.assertEqual(set(image.passes), set(PASSES))
        self.assertGreater(combined(self.folder / "out.partial.exr").mean(), 0.1)

    def test_termination_writes_nothing(self):
        process = self.started()
        began = time.monotonic()
        process.terminate()
        self.assertEqual(self.end(process), 130)
        self.assertLess(time.monotonic() - began, 3)
        self.assertEqual(self.left(), [])

    def test_closed_input_writes_nothing(self):
        process = self.started("--watch-stdin")
        process.stdin.close()
        self.assertEqual(self.end(process), 130)
        self.assertEqual(self.left(), [])

    def test_input_is_left_alone_otherwise(self):
        process = self.started()
        process.stdin.close()
        with self.assertRaises(subprocess.TimeoutExpired):
            process.wait(1)

    def deaf(self, *words, stream, sink):
        """The exit code where nobody reads what the command writes to `stream`; its other stream."""
        other = {"stdout": "stderr", "stderr": "stdout"}[stream]
        pipes = {stream: sink, other: subprocess.PIPE}
        done = subprocess.run([BINARY, *map(str, words)], stdin=subprocess.DEVNULL, timeout=60, text=True, **pipes)
        return done.returncode, getattr(done, other)

    def test_listener_that_has_gone(self):
        """A render goes on when nobody reads its progress, and what has failed still says so by its exit code."""
        # longer than the quarter of a second after which a thread of its own tells the progress
        words = ["render", self.scene(), "-o", self.out, "--time", "1", "--resolution", "96x64", "--progress"]
        gone, write = os.pipe()
        os.close(gone)
        full = os.open("/dev/full", os.O_WRONLY)
        try:
            for sink in (write, full):
                for progress, stream in (("json", "stdout"), ("bar", "stderr")):
                    with self.subTest(progress=progress, full=sink is full):
                        self.out.unlink(missing_ok=True)
                        code, said = self.deaf(*words, progress, stream=stream, sink=sink)
                        # only what a program reads must arrive: a full disk cuts its last line
                        self.assertEqual(code, 4 if (progress, sink) == ("json", full) else 0, said)
                        self.assertTrue(self.out.exists())
            code, said = self.deaf("info", self.folder / "none.glb", stream="stderr", sink=full)
            self.assertEqual((code, said), (4, ""))
        finally:
            os.close(write)
            os.close(full)


class Info(CommandTest):
    def test_json(self):
        info = json.loads(self.run_command("info", self.scene(), "--json").stdout)
        self.assertEqual((info["scene"], info["resolution"], info["camera"]), (str(self.scene()), [768, 512], "Camera"))
        self.assertGreater(info["scene_counts"]["triangles"], 10000)
        self.assertEqual(info["scene_counts"]["materials"], 2)
        self.assertIsInstance(info["needs"], str)
        self.assertIsInstance(info["left_out"], list)

    def test_text(self):
        said = self.run_command("info", self.scene()).stdout
        for word in ("768 x 512", "triangles", "environment image", "left out"):
            self.assertIn(word, said)


class Foreign(CommandTest):
    """A file of another program, without camera and light."""

    @classmethod
    def setUpClass(cls):
        """Needs no scene of Blender's."""

    def setUp(self):
        super().setUp()
        triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4").tobytes()
        data = "data:application/octet-stream;base64," + base64.b64encode(triangle).decode()
        self.gltf = self.folder / "triangle.gltf"
        self.gltf.write_text(
            json.dumps(
                {
                    "asset": {"version": "2.0"},
                    "buffers": [{"byteLength": 36, "uri": data}],
                    "bufferViews": [{"buffer": 0, "byteLength": 36}],
                    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
                    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
                    "nodes": [{"mesh": 0}],
                }
            )
        )

    def test_a_view_and_a_sky_are_chosen_and_said(self):
        for size, least in (("48x32", 0.15), ("20x60", 0.08)):
            done = self.render("--spp", "4", "--resolution", size, "--progress", "json", scene=self.gltf)
            notes = self.events(done.stdout)[0]["notes"]
            self.assertIn("the scene has no camera: a view of all that it holds is used", notes[0])
            self.assertIn("the scene has no lights: a constant sky of radiance 1 is used", notes[1])
            passes = exr.read(self.out).passes
            seen = passes["Depth"][..., 0] < 1e9
            self.assertGreater(seen.mean(), least)
            self.assertFalse(seen[0].any() or seen[-1].any() or seen[:, 0].any() or seen[:, -1].any(), "all is in view")
            # a diffuse triangle of albedo 0.8 alone in a sky of radiance 1
            self.assertAlmostEqual(passes["Combined"][..., :3][seen].mean(), 0.8, delta=0.05)
        info = json.loads(self.run_command("info", self.gltf, "--json").stdout)
        self.assertEqual(info["camera"], "(fitted)")

    def test_what_the_file_holds_and_the_image_lacks_is_said(self):
        plain = json.loads(self.gltf.read_text())
        (primitive,) = plain["meshes"][0]["primitives"]
        glass = {"name": "Glass", "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.5}}}
        listed = {"materials": [glass]}
        scenes = {
            "KHR_materials_transmission of material 'Glass'": listed
            | {"meshes": [{"primitives": [primitive | {"material": 0}]}]},
            "it has no POSITION": {"meshes": [{"primitives": [primitive, {"attributes": {"NORMAL": 0}}]}]},
            "vertex colours of mesh": {"meshes": [{"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 0}}]}]},
            "the root 'Child'": {"nodes": [{"children": [1]}, {"mesh": 0, "name": "Child"}]}
            | {"scene": 0, "scenes": [{"nodes": [0, 1]}]},
        }
        small = ("--resolution", "8x6")
        for i, (what, changes) in enumerate(scenes.items()):
            self.gltf.write_text(json.dumps(plain | changes))
            study = ("converge", self.gltf, "-o", self.folder / f"study {i}", "--seeds", "2", "--max-spp", "2")
            for done in (self.render("--spp", "1", *small, scene=self.gltf), self.run_command(*study, *small)):
                (said,) = [line for line in done.stderr.splitlines() if "left out" in line]
                self.assertIn("warning: left out: ", said)
                self.assertIn(what, said)
        self.gltf.write_text(json.dumps(plain | listed))  # no triangle has it
        self.assertNotIn("left out", self.render("--spp", "1", *small, scene=self.gltf).stderr)
        many = [primitive] + [{"attributes": {"POSITION": 0}, "targets": [{"POSITION": 0}]}] * 20
        meshes = [{"name": f"Mesh {i}", "primitives": [p]} for i, p in enumerate(many)]
        nodes = [{"mesh": i} for i in range(len(many))]
        self.gltf.write_text(json.dumps(plain | {"meshes": meshes, "nodes": nodes}))
        said = self.render("--spp", "1", *small, scene=self.gltf).stderr
        self.assertEqual(said.count("left out"), 12)
        self.assertIn("left out: 9 more, which wardmis info lists", said)

    def test_without_defaults(self):
        self.refused(
            3, "render", self.gltf, "-o", self.out, "--no-defaults", says=("triangle.gltf: the scene has no camera",)
        )
        self.refused(
            3, "converge", self.gltf, "-o", self.folder / "study", "--no-defaults", says=("the scene has no camera",)
        )


class Compare(CommandTest):
    def setUp(self):
        super().setUp()
        self.pixels = np.random.default_rng(1).random((8, 12, 3)).astype(np.float32)
        self.reference = self.folder / "reference.exr"
        write_exr(self.reference, self.pixels)

    def changed(self, pixels):
        path = self.folder / "image.exr"
        write_exr(path, pixels)
        return path

    def test_identical(self):
        found = json.loads(self.run_command("compare", self.reference, self.reference, "--json").stdout)
        for key in ("mse", "relmse", "relmse_without_top_0.1_percent", "mape"):
            self.assertEqual(found[key], 0, key)
        self.run_command("compare", self.reference, self.reference, "--max-relmse", "0")

    def test_known_errors(self):
        image = self.changed(self.pixels + np.float32(0.1))
        found = json.loads(self.run_command("compare", image, self.reference, "--json").stdout)
        r, x = self.pixels.astype(float), (self.pixels + np.float32(0.1)).astype(float)
        self.assertAlmostEqual(found["mse"], np.mean((x - r) ** 2), places=7)
        self.assertAlmostEqual(found["relmse"] / np.mean((x - r) ** 2 / (r**2 + found["relmse_epsilon"])), 1, places=5)
        self.assertAlmostEqual(found["mape"] / np.mean(abs(x - r) / (abs(r) + found["mape_epsilon"])), 1, places=5)
        self.run_command("compare", image, self.reference, "--max-relmse", "1e-6", code=1)
        for name in ("d.png", "d.exr"):
            self.run_command("compare", image, self.reference, "--difference", self.folder / name)
            self.assertIsNotNone(oiio.ImageInput.open(str(self.folder / name)))

    def test_other_sizes(self):
        image = self.changed(self.pixels[:, :-1])
        self.refused(2, "compare", image, self.reference, says=["11 x 8", "12 x 8"])

    def test_nan_is_named(self):
        self.pixels[3, 5, 1] = np.nan
        image = self.changed(self.pixels)
        self.refused(4, "compare", image, self.reference, says=["image.exr", "not finite", "(5, 3)"])
        self.refused(4, "compare", self.reference, image, says=["image.exr"])

    def test_image_that_is_none(self):
        self.refused(4, "compare", self.folder / "none.exr", self.reference, says=["none.exr"])
        bad = self.folder / "bad.exr"
        bad.write_bytes(self.reference.read_bytes()[:200])
        self.refused(4, "compare", bad, self.reference, says=["bad.exr"])

    def test_pipe_is_refused_not_waited_for(self):
        pipe = self.folder / "pipe"
        os.mkfifo(pipe)
        self.refused(4, "compare", pipe, self.reference, says=["pipe", "not a regular file"])
        self.refused(4, "compare", self.reference, pipe, says=["pipe", "not a regular file"])
        self.refused(4, "compare", self.reference, self.reference, "--difference", pipe, says=["pipe", "not a file"])

    def test_layers_with_dots(self):
        self.render("--spp", "1", "--layer", "Layer.001")
        self.run_command("compare", self.out, self.out)
        self.run_command("compare", self.out, self.out, "--layer", "Layer.001")

    def test_own_images(self):
        """A layer is found by itself, or named."""
        self.render("--spp", "4")
        self.render("--spp", "4", "--layer", "Other", out=self.folder / "other.exr")
        self.assertFalse(same(self.out, self.reference))
        found = json.loads(self.run_command("compare", self.out, self.folder / "other.exr", "--json").stdout)
        self.assertEqual((found["mse"], found["width"], found["height"]), (0, 48, 32))
        self.refused(4, "compare", self.out, self.out, "--layer", "Missing", says=["Missing"])


def luminance(rgb):
    return rgb @ np.array([0.2126, 0.7152, 0.0722], np.float32)
