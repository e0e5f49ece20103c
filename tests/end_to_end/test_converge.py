# SPDX-License-Identifier: GPL-3.0-or-later
"""wardmis converge: its study on disk (resumed, stopped, refused), what it reports of renders whose error is known, and
that its findings on the scenes of blend/ are those of the theory. Images do not depend on the machine, so that ratios of
errors at equal samples are the same everywhere; nothing is asked of times but that they are there."""

import base64
import csv
import io
import json
import os
import re
import signal
import subprocess
import time
from pathlib import Path

import exr
import numpy as np
import OpenImageIO as oiio
from command import BINARY, CommandTest
from PIL import Image


def write_rgb(path, values):
    spec = oiio.ImageSpec(values.shape[1], values.shape[0], 3, oiio.FLOAT)
    file = oiio.ImageOutput.create(str(path))
    file.open(str(path), spec)
    file.write_image(np.ascontiguousarray(values, np.float32))
    file.close()


class Converge(CommandTest):
    scenes = ("teapot", "veach", "stiff-mirror")

    def study(self, *options, scene="teapot", folder="study", code=0, small=True, **more):
        size = ("--resolution", "48x32") if small else ()
        out = self.folder / folder
        done = self.run_command("converge", self.scene(scene), "-o", out, *size, *map(str, options), code=code, **more)
        report = json.loads((out / "report.json").read_text()) if code == 0 else None
        return done, report

    def quick(self, *options, seeds=4, **more):
        return self.study("--max-spp", 8, "--seeds", seeds, "-c", "equal", "-c", "second-moment", *options, **more)

    def split(self, glb):
        """A .glb file as a .gltf file with its buffer beside it: both paths."""
        data = glb.read_bytes()
        length = int.from_bytes(data[12:16], "little")
        scene = json.loads(data[20 : 20 + length])
        gltf, buffer = self.folder / "scene.gltf", self.folder / "scene.bin"
        buffer.write_bytes(data[28 + length :])
        scene["buffers"][0]["uri"] = buffer.name
        gltf.write_text(json.dumps(scene))
        return gltf, buffer

    def of(self, report, name):
        return next(c for c in report["configurations"] if c["name"] == name)

    def test_a_study_leaves_what_the_documentation_lists(self):
        done, report = self.quick("--title", "päth <b>")
        folder = self.folder / "study"
        for name in (
            "study.json",
            "reference.exr",
            "report.json",
            "report.html",
            "curves.csv",
            "configurations.csv",
            "groups.csv",
        ):
            self.assertTrue((folder / name).is_file(), name)
        self.assertEqual(len(list((folder / "runs" / "equal").glob("seed-*.exr"))), 4)
        self.assertEqual(report["schema"], "wardmis-report-1")
        self.assertEqual(report["checkpoints"], [1, 2, 4, 8])
        self.assertIn("päth <b>", done.stdout)
        page = (folder / "report.html").read_text()
        self.assertIn("<title>päth &lt;b&gt;", page)
        self.assertNotIn("{{", page.split("<script")[0])
        for c in report["configurations"]:
            self.assertEqual([at["spp"] for at in c["curve"]], [1, 2, 4, 8])
            walls = [at["wall"]["mean"] for at in c["curve"]]
            self.assertEqual(walls, sorted(walls))
            self.assertGreater(walls[0], 0)
        # CSV: the same numbers
        with open(folder / "curves.csv") as f:
            rows = list(csv.DictReader(f))
        self.assertEqual(len(rows), 8)
        self.assertAlmostEqual(float(rows[3]["relmse"]), self.of(report, "equal")["curve"][3]["relmse"]["mean"])

    def embedded(self, report, key):
        """An image of the page: its description, and the bytes of its PNG as (height, width, 3)."""
        page = (self.folder / "study" / "report.html").read_text()
        i = next(i for i, image in enumerate(report["images"]) if image["key"] == key)
        text = re.search(rf'id="image-{i}">([^<]*)<', page)[1]
        pixels = np.asarray(Image.open(io.BytesIO(base64.b64decode(text))).convert("RGB"), np.float64)
        return report["images"][i], pixels

    def test_the_page_holds_the_images(self):
        _, report = self.quick()
        folder = self.folder / "study"
        # radiance: a shared exponent, eight bits for the largest channel
        about, pixels = self.embedded(report, "reference")
        self.assertEqual(pixels.shape, (2 * about["height"], about["width"], 3))
        values = pixels[: about["height"]] * 2.0 ** (pixels[about["height"] :, :, :1] - 136)
        truth = exr.read(folder / "reference.exr").passes["Combined"][..., :3]
        self.assertLess(np.max(np.abs(values - truth) / truth.max(axis=-1, keepdims=True)), 0.5 / 127)
        # scalars: sixteen bits, here of a logarithm
        about, pixels = self.embedded(report, "equal/error")
        values = 10 ** (about["low"] + (about["high"] - about["low"]) * (256 * pixels[..., 0] + pixels[..., 1]) / 65534)
        truth = exr.read(folder / "images" / "equal-error.exr").passes["Combined"][..., 0]
        inside = (truth > 10 ** about["low"]) & (truth < 10 ** about["high"])
        self.assertGreater(inside.mean(), 0.5)
        np.testing.assert_allclose(values[inside], truth[inside], rtol=1e-4)
        # shares
        _, pixels = self.embedded(report, "equal/allocation")
        hit = pixels.sum(axis=-1) > 0
        np.testing.assert_allclose(pixels.sum(axis=-1)[hit], 255, atol=2)

    def test_metrics_of_a_run_are_those_of_its_image(self):
        _, report = self.quick()
        folder = self.folder / "study"
        said = json.loads(
            self.run_command("compare", folder / "runs/equal/seed-0001.exr", folder / "reference.exr", "--json").stdout
        )
        run = json.loads((folder / "runs/equal/seed-0001.json").read_text())
        self.assertAlmostEqual(run["checkpoints"][-1]["relmse"], said["relmse"], delta=1e-6 * said["relmse"])
        # and over the seeds, less the reference's own
        runs = [json.loads(path.read_text()) for path in sorted((folder / "runs/equal").glob("*.json"))]
        mean = np.mean([r["checkpoints"][-1]["mse"] for r in runs]) - report["reference"]["floor"]["mse"]
        self.assertAlmostEqual(self.of(report, "equal")["curve"][-1]["mse"]["mean"], mean, delta=1e-6 * mean)

    def test_parts_of_the_image_make_up_the_whole(self):
        _, report = self.study(
            "--max-spp", 4, "--seeds", 3, "-c", "equal", "--resolution", "96x64", scene="veach", small=False
        )
        groups, last = self.of(report, "equal")["groups"], self.of(report, "equal")["curve"][-1]
        for kind in ("object", "material"):
            parts = [g for g in groups if g["kind"] == kind]
            self.assertEqual(sum(g["pixels"] for g in parts), 96 * 64, "all of the image shows something")
            for metric in ("mse", "relmse", "mape", "smape"):
                mean = sum(g[metric]["mean"] * g["pixels"] for g in parts) / (96 * 64)
                self.assertAlmostEqual(mean / last[metric]["mean"], 1, places=6)
            for g in parts:
                self.assertGreater(g["relmse_trimmed"]["mean"], 0)
        self.assertIn("smape_high", (self.folder / "study/groups.csv").read_text().splitlines()[0])

    def test_a_run_is_the_render_of_its_seed(self):
        self.quick()
        self.render("--allocation", "second-moment", "--spp", "8", "--seed", "2")
        own = exr.read(self.folder / "study/runs/second-moment/seed-0002.exr").passes
        np.testing.assert_array_equal(own["Combined"], exr.read(self.out).passes["Combined"])

    def test_what_is_done_is_not_done_again(self):
        self.quick()
        folder = self.folder / "study"
        before = {path: path.stat().st_mtime_ns for path in folder.rglob("runs/*/*")}
        (folder / "runs/equal/seed-0003.json").unlink()
        whole = (folder / "reference.exr").read_bytes()
        (folder / "reference.exr").write_bytes(whole[:1000])
        self.quick(seeds=5)
        after = {path: path.stat().st_mtime_ns for path in folder.rglob("runs/*/*")}
        changed = {path.name for path in after if before.get(path) != after[path]}
        self.assertEqual((folder / "reference.exr").read_bytes(), whole, "damaged, and written again")
        self.assertEqual(changed, {"seed-0003.json", "seed-0003.exr", "seed-0005.json", "seed-0005.exr"})

    def test_another_study_is_not_mixed_in(self):
        self.quick()
        study = ("converge", self.scene(), "-o", self.folder / "study", "--resolution", "48x32", "--seeds", "4")
        self.refused(
            2, *study, "--max-spp", "16", "-c", "equal", "-c", "second-moment", says=("another study", "max_spp")
        )
        self.refused(2, *study, "--max-spp", "8", "-c", "equal", says=("another study", "configurations"))
        same = (*study, "--max-spp", "8", "-c", "equal", "-c", "second-moment")
        self.refused(2, *same, "--threads", "1", says=("another study", "threads"))
        self.assertEqual(self.run_command(*same, "--check").returncode, 0)
        # what a .gltf refers to belongs to its scene
        gltf, buffer = self.split(self.scene())
        study = ("converge", gltf, "-o", self.folder / "split", "--resolution", "8x8", "--seeds", "2", "--max-spp", "2")
        self.run_command(*study)
        self.run_command(*study, "--check")
        data = bytearray(buffer.read_bytes())
        data[0] ^= 1  # the last bit of a coordinate
        buffer.write_bytes(data)
        self.refused(2, *study, "--check", says=("another study", "'scene'"))
        # a run that was cut, and one without its image
        path = self.folder / "study/runs/equal/seed-0001.json"
        run = json.loads(path.read_text())
        path.write_text(json.dumps({**run, "checkpoints": run["checkpoints"][:2]}))
        self.refused(4, *same, says=("seed-0001.json", "not what a run of this study"))
        path.write_text(json.dumps(run))
        path.with_suffix(".exr").unlink()
        self.run_command(*same)
        self.assertTrue(path.with_suffix(".exr").is_file())
        (self.folder / "study/study.json").unlink()
        self.refused(2, *same, says=("no study.json",))

    def test_stopped_it_reports_and_goes_on(self):
        out = self.folder / "study"
        command = [
            BINARY,
            "converge",
            str(self.scene()),
            "-o",
            str(out),
            "--resolution",
            "64x48",
            "--max-spp",
            "64",
            "--seeds",
            "12",
            "-c",
            "equal",
            "-c",
            "variance",
        ]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        until = time.monotonic() + 60
        while len(list(out.glob("runs/*/seed-*.json"))) < 5 and time.monotonic() < until:
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, said)
        self.assertIn("goes on from there", said)
        report = json.loads((out / "report.json").read_text())
        self.assertFalse(report["complete"])
        self.assertIn("stopped early", " ".join(report["finding"]))
        done = len(list(out.glob("runs/*/seed-*.json")))
        self.assertLess(done, 24)
        self.run_command(*command[1:])
        self.assertTrue(json.loads((out / "report.json").read_text())["complete"])
        self.assertEqual(len(list(out.glob("runs/*/seed-*.json"))), 24)

    def test_whoever_started_it_has_gone(self):
        out = self.folder / "study"
        process = subprocess.Popen(
            [BINARY, "converge", str(self.scene()), "-o", str(out), "--max-spp", "4096", "--progress", "json", "--watch-stdin"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip
        first = json.loads(process.stdout.readline())
        self.assertEqual(first["event"], "start")
        self.assertEqual(json.loads(process.stdout.readline())["phase"], "reference")
        self.refused(4, "converge", self.scene(), "-o", out, "--max-spp", "4096", says=("another process",))
        process.stdin.close()
        process.stdout.close()
        self.assertEqual(process.wait(timeout=20), 130)

    def test_progress_for_programs(self):
        done, _ = self.quick("--progress", "json")
        events = self.events(done.stdout)
        self.assertEqual(events[0]["event"], "start")
        self.assertEqual(events[-1]["event"], "done")
        progress = [e for e in events if e["event"] == "progress"]
        self.assertEqual([e["phase"] for e in progress][-1], "report")
        fractions = [e["fraction"] for e in progress]
        self.assertEqual(fractions, sorted(fractions))
        self.assertTrue(all(e["left"] >= 0 for e in progress))

    def test_runs_are_interleaved(self):
        done, _ = self.quick("--progress", "json")
        order = []
        for e in self.events(done.stdout):
            if e["event"] == "progress" and e["phase"] == "runs" and (e["configuration"], e["seed"]) not in order:
                order.append((e["configuration"], e["seed"]))
        names = [name for name, _ in order]
        self.assertEqual(names, ["equal", "second-moment", "second-moment", "equal"] * 2)

    def test_a_budget_is_kept(self):
        start = time.monotonic()
        _, report = self.study("--budget-seconds", 6, "--seeds", 4, "-c", "equal", "-c", "auto")
        self.assertLess(time.monotonic() - start, 9)
        self.assertGreaterEqual(report["checkpoints"][-1], 4)
        start = time.monotonic()  # of strata each checkpoint is a render of its own
        strata = ("-c", "equal", "--sampler", "stratified")
        self.study("--budget-seconds", 6, "--seeds", 4, *strata, folder="strata")
        self.assertLess(time.monotonic() - start, 9)
        self.refused(
            2, "converge", self.scene(), "-o", self.folder / "poor", "--budget-seconds", "0.2", says=("give at least",)
        )
        self.assertFalse((self.folder / "poor").exists())

    def test_a_budget_cuts_the_seeds_before_it_refuses(self):
        options = ("--budget-seconds", 8, "--seeds", 10_000, "-c", "equal")
        done, report = self.study(*options)
        self.assertLess(len(report["seeds"]), 10_000)
        self.assertGreaterEqual(len(report["seeds"]), 4)
        self.assertEqual(report["checkpoints"][-1], 4)
        self.assertIn("suffices for", done.stderr)
        _, again = self.study(*options)  # goes on with as many
        self.assertEqual(again["seeds"], report["seeds"])

    def test_a_given_reference_is_held_against(self):
        self.render(
            "--spp",
            "256",
            "--seed",
            "99",
            "--allocation",
            "equal",
            "--sampler",
            "independent",
            out=self.folder / "reference.exr",
        )
        _, report = self.quick("--reference", self.folder / "reference.exr")
        self.assertEqual(report["reference"]["source"], "given")
        self.assertGreater(report["reference"]["floor"]["relmse"], 0)
        self.refused(2, "converge", self.scene(), "-o", self.folder / "b", "--reference", self.folder / "reference.exr", "--resolution", "24x16", says=("48 x 32",))  # fmt: skip

        # of evenly spread points the Variance pass is an upper bound
        self.render("--spp", "256", "--seed", "99", "--allocation", "equal", out=self.folder / "sobol.exr")
        done, report = self.quick("--reference", self.folder / "sobol.exr", folder="c")
        self.assertIsNone(report["reference"]["floor"]["relmse"])
        self.assertIn("upper bound", done.stderr)
        direct = ("-c", "direct:allocation=equal,integrator=direct")
        _, report = self.quick("--reference", self.folder / "reference.exr", *direct, folder="e")
        self.assertIn("although both are held against the one reference given", " ".join(report["finding"]))
        self.render("--spp", "256", "--seed", "3", "--allocation", "equal", out=self.folder / "own.exr")
        self.refused(2, "converge", self.scene(), "-o", self.folder / "d", "--reference", self.folder / "own.exr", "--resolution", "48x32", says=("seed 3",))  # fmt: skip

    def test_each_sampler_and_integrator_has_its_place(self):
        _, report = self.study(
            "--max-spp", 8, "--seeds", 3, "-c", "equal", "-c", "strata:allocation=equal,sampler=stratified",
            "-c", "direct:allocation=equal,integrator=direct,weights=power", "-c", "costly:allocation=auto,cost=1,1,2",
        )  # fmt: skip
        self.assertEqual(len(report["references"]), 2)
        self.assertEqual(self.of(report, "direct")["reference"], "direct light")
        said = " ".join(report["finding"])
        self.assertRegex(
            said, "direct estimates direct light, equal paths, depth 8: .* each held against its own reference"
        )
        self.assertNotRegex(said, "(strata|costly) estimate")
        costly = self.of(report, "costly")
        self.assertEqual(costly["settings"]["cost"], [1, 1, 2])
        self.assertIsNone(costly["allocation"]["clamped"], "auto has no least share")
        errors = [at["relmse"]["mean"] for at in self.of(report, "strata")["curve"]]
        self.assertEqual(errors, sorted(errors, reverse=True))
        self.assertIn("only 3 seeds", " ".join(report["finding"]))

    def test_the_default_allocation_yields_to_other_weights(self):
        done, report = self.quick("-c", "other:weights=nonbalance")
        self.assertEqual(self.of(report, "other")["settings"]["allocation"], "equal")
        self.assertEqual(done.stderr.count("shared equally"), 1)
        self.assertIn("configuration 'other': samples are shared equally", done.stderr)

    def test_a_target_that_no_time_leads_to(self):
        """Above all curves, and under them."""
        _, report = self.quick("--target", 1e6)
        for c in report["configurations"]:
            self.assertEqual(c["time_to_target"]["verdict"], "under from the start")
            self.assertIsNone(c["time_to_target"]["seconds"])
        said = " ".join(report["finding"])
        self.assertIn("equal is under a relMSE of 1e+06 from its first checkpoint on: no time can be compared", said)
        self.assertIn("Under it from their first checkpoint on: second-moment", said)
        self.assertNotIn("not surely reached", said)
        _, report = self.quick("--target", 1e-12)
        self.assertEqual({c["time_to_target"]["verdict"] for c in report["configurations"]}, {"not reached"})
        self.assertIn("equal itself does not surely reach", report["finding"][0])

    def test_a_black_image_has_nothing_to_compare(self):
        scene = self.folder / "dark.glb"
        text = json.dumps({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
                           "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}],
                           "nodes": [{"camera": 0}]}).encode()  # fmt: skip
        text += b" " * (-len(text) % 4)
        scene.write_bytes(
            b"glTF"
            + (2).to_bytes(4, "little")
            + (20 + len(text)).to_bytes(4, "little")
            + len(text).to_bytes(4, "little")
            + b"JSON"
            + text
        )
        self.run_command(
            "converge",
            scene,
            "-o",
            self.folder / "study",
            "--resolution",
            "32x24",
            "--max-spp",
            "4",
            "--seeds",
            "3",
            "-c",
            "equal",
            "-c",
            "auto",
        )
        report = json.loads((self.folder / "study/report.json").read_text())
        self.assertIn("no error to compare", report["finding"][0])

    def test_mistakes_are_named(self):
        out = ("-o", self.folder / "x", "--resolution", "48x32")
        self.refused(2, "converge", self.scene(), *out, "-c", "equall", says=("equall", "second-moment"))
        self.refused(2, "converge", self.scene(), *out, "-c", "a:allocation=equal,sampel=3", says=("sampel",))
        self.refused(2, "converge", self.scene(), *out, "-c", "equal", "-c", "equal", says=("two configurations",))
        self.refused(
            2, "converge", self.scene(), *out, "--baseline", "best", says=("best", "none of the configurations")
        )
        self.refused(4, "converge", self.scene(), *out, "--max-spp", "4", "--seeds", "2", "--external", self.folder / "none.json", says=("none.json",))  # fmt: skip
        (self.folder / "file").write_text("")
        self.refused(4, "converge", self.scene(), "-o", self.folder / "file" / "x", says=("folder",))

    def test_a_damaged_run_is_done_again(self):
        _, report = self.quick()
        started = report["provenance"]["started"]
        folder = self.folder / "study/runs/equal"
        whole = json.loads((folder / "seed-0002.json").read_text())
        (folder / "seed-0002.json").write_text("{")
        (folder / "seed-0003.json").write_text("[]")
        done, report = self.quick()
        for name in ("seed-0002.json", "seed-0003.json"):
            self.assertIn(f"{name} is damaged; the run is done again", done.stderr)
        again = json.loads((folder / "seed-0002.json").read_text())
        self.assertEqual([c["relmse"] for c in again["checkpoints"]], [c["relmse"] for c in whole["checkpoints"]])
        self.assertEqual(report["provenance"]["started"], started, "the first time")
        # images cut off or of another size, figures that cannot be
        image, other = folder / "seed-0002.exr", folder / "seed-0004.exr"
        image.write_bytes(image.read_bytes()[:-200])
        write_rgb(other, np.zeros((16, 24, 3)))
        wrong = json.loads((folder / "seed-0001.json").read_text())
        wrong["checkpoints"][0]["relmse"] = -1
        (folder / "seed-0001.json").write_text(json.dumps(wrong))
        chunk = self.folder / "study/reference/chunk-3.exr"
        chunk.write_bytes(chunk.read_bytes()[:-200])
        done, after = self.quick()
        for name in (image.name, other.name, "seed-0001.json"):
            self.assertIn(f"{name} is damaged; the run is done again", done.stderr)
        self.assertIn("chunk-3.exr is damaged; that part of the reference is rendered again", done.stderr)
        for name in ("equal", "second-moment"):
            now, before = self.of(after, name)["curve"][-1], self.of(report, name)["curve"][-1]
            self.assertEqual({**now, "wall": 0, "cpu": 0}, {**before, "wall": 0, "cpu": 0})
        (folder / "seed-0003.json").unlink()
        (folder / "seed-0003.json").mkdir()
        self.refused(
            4, "converge", self.scene(), "-o", self.folder / "study", "--resolution", "48x32", "--max-spp", 8, "--seeds", 4,
            "-c", "equal", "-c", "second-moment", says=("seed-0003.json: is no file",),
        )  # fmt: skip

    def test_a_refused_command_leaves_no_study(self):
        """The right one works in the same folder."""
        self.render("--resolution", "24x16")
        reference = ("--reference", self.out)
        self.refused(2, "converge", self.scene(), "-o", self.folder / "study", "--resolution", "48x32", "--max-spp", "8", "--seeds", "4", "-c", "equal", "-c", "second-moment", *reference, says=("24 x 16",))  # fmt: skip
        self.quick()

    def test_flip_is_reported_where_it_is_installed(self):
        """The program of its authors, run by hand on the same images, says the same."""
        flip = Path(os.environ["WARDMIS_FLIP"]) / "flip"
        temporary = self.folder / 'it\'s "$(touch away)"'  # no shell reads it
        temporary.mkdir()
        environment = {**os.environ, "PATH": f"{flip.parent}:/usr/bin:/bin", "TMPDIR": str(temporary)}
        _, report = self.quick(env=environment)
        self.assertEqual(list(temporary.iterdir()), [])
        self.assertEqual(report["metrics"][-1]["name"], "flip")
        folder = self.folder / "study"
        said = []
        for seed in range(1, 5):
            for name, path in (("r", folder / "reference.exr"), ("t", folder / f"runs/equal/seed-{seed:04}.exr")):
                write_rgb(self.folder / f"{name}.exr", exr.read(path).passes["Combined"][..., :3])
            command = [flip, "-r", "r.exr", "-t", "t.exr", "-v", "1", "-nexm", "-nerm"]
            text = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, check=True).stdout
            said.append(float(re.search(r"Mean: *([0-9.]+)", text)[1]))
        self.assertAlmostEqual(self.of(report, "equal")["curve"][-1]["flip"]["mean"], np.mean(said), delta=2e-6)
        # a program of the same name that is something else
        other = self.folder / "bin" / "flip"
        other.parent.mkdir()
        other.write_text("#!/bin/sh\necho usage: flip file\n")
        other.chmod(0o755)
        _, report = self.quick(folder="b", env={**os.environ, "PATH": f"{other.parent}:/usr/bin:/bin"})
        self.assertNotIn("flip", [m["name"] for m in report["metrics"]])

    # ---- renders of another program

    def manifest(self, scale=1.0, common=True, seeds=6):
        """Renders of ours as if another program had made them, `scale` times as bright."""
        folder = self.folder / "other"
        folder.mkdir()

        def image(name, *options):
            self.render(*options, out=self.folder / "one.exr")
            values = exr.read(self.folder / "one.exr").passes["Combined"][..., :3] * scale
            write_rgb(folder / name, values)
            return name

        runs = [
            {"seed": s, "spp": n, "wall": 0.01 * n, "cpu": 0.02 * n,
             "path": image(f"s{s}-{n}.exr", "--spp", n, "--seed", 100 + s, "--allocation", "equal", "--sampler", "independent")}
            for s in range(1, seeds + 1) for n in (2, 4, 8)
        ]  # fmt: skip
        reference = [image(f"r{k}.exr", "--spp", 128, "--seed", 900 + k, "--allocation", "equal") for k in range(3)]
        path = folder / "manifest.json"
        path.write_text(json.dumps({"name": "Other", "renderer": "Other 1.0", "notes": ["made up"], "common_reference": common,
                                    "reference": {"images": reference, "spp": 128}, "runs": runs}))  # fmt: skip
        return path

    def test_another_renderer_that_agrees(self):
        _, report = self.quick("--external", self.manifest())
        other = self.of(report, "Other")
        self.assertEqual([at["spp"] for at in other["curve"]], [2, 4, 8])
        self.assertEqual(other["runs"], 6)
        self.assertEqual(other["bias"]["verdict"], "none found")
        self.assertIs(report["models"][0]["agree"], True, report["models"])

    def test_scattered_times_of_one_that_tells_no_processor_time_are_said_to_be_rough(self):
        path = self.manifest(seeds=3)
        manifest = json.loads(path.read_text())
        for run in manifest["runs"]:
            del run["cpu"]
            run["wall"] *= 2 if run["seed"] == 3 else 1
        path.write_text(json.dumps(manifest))
        _, report = self.quick("--external", path)
        self.assertEqual((report["clock"], report["wall_scattered"]), ("wall", True))
        self.assertRegex(" ".join(report["finding"]), r"scattered by more than 15 %.* not every renderer .* rough")

    def test_products_are_of_one_clock(self):
        """Processor time of two threads is twice the wall time that a program tells which does not know its own."""
        path = self.manifest(seeds=3)
        _, known = self.quick("--external", path)
        manifest = json.loads(path.read_text())
        for run in manifest["runs"]:
            del run["cpu"]
        path.write_text(json.dumps(manifest))
        _, unknown = self.quick("--external", path)
        self.assertEqual((known["effort_clock"], unknown["effort_clock"]), ("cpu", "wall"))
        for report, clock in ((known, "cpu"), (unknown, "wall")):
            for c in report["configurations"]:
                product = c["efficiency"]["variance_x_seconds"]
                if product is None or report["metric"] != "relmse":
                    continue
                variance = product["mean"] / c["curve"][-1][clock]["mean"]
                other = next(o for o in known["configurations"] if o["name"] == c["name"])
                same = other["efficiency"]["variance_x_seconds"]["mean"] / other["curve"][-1]["cpu"]["mean"]
                self.assertAlmostEqual(variance / same, 1, delta=0.3, msg=(c["name"], clock))

    def test_mistakes_of_a_manifest_are_named(self):
        path = self.manifest(seeds=2)
        right = json.loads(path.read_text())
        for change, says in (
            ({"spp": -1}, "spp"), ({"spp": 1.7}, "spp"), ({"spp": 0}, "0 samples"), ({"wall": 0}, "0 s"), ({"cpu": -1}, "CPU"),
            ({"seed": "a"}, "seed"), ({"path": 3}, "path"),
        ):  # fmt: skip
            wrong = {**right, "runs": [{**right["runs"][0], **change}, *right["runs"][1:]]}
            path.write_text(json.dumps(wrong))
            self.refused(
                4, "converge", self.scene(), "-o", self.folder / "x", "--check", "--external", path, says=(says,)
            )
        path.write_text(json.dumps({**right, "runs": right["runs"] + right["runs"][:1]}))
        self.refused(
            4, "converge", self.scene(), "-o", self.folder / "x", "--check", "--external", path, says=("twice",)
        )
        self.refused(4, "converge", self.scene(), "-o", self.folder / "x", "--external", self.folder, says=("no file",))
        self.assertFalse((self.folder / "x").exists())

    def test_a_biased_renderer_is_caught_and_named(self):
        _, report = self.quick("--external", self.manifest(scale=1.1), seeds=6)
        self.assertEqual(self.of(report, "Other")["bias"]["verdict"], "biased")
        self.assertEqual(self.of(report, "equal")["bias"]["verdict"], "none found")
        self.assertIs(report["models"][0]["agree"], False)
        self.assertRegex(" ".join(report["finding"]), r"differs from the reference for Other")

    def test_under_a_heavy_tail_the_figures_with_all_pixels_stand_beside_those_without(self):
        path = self.manifest()
        for n in (2, 4, 8):  # a firefly in one seed
            image = path.parent / f"s3-{n}.exr"
            values = oiio.ImageInput.open(str(image)).read_image(format="float")
            values[20, 30] += 100 / n
            write_rgb(image, values)
        out, report = self.folder / "study", self.quick("--external", path, seeds=6)[1]
        self.assertEqual(report["metric"], "relmse_trimmed")
        floor = report["reference"]["floor"]
        self.assertLess(floor["relmse_trimmed"], floor["relmse"])
        last = {}
        for name in ("equal", "second-moment"):
            runs = [json.loads(p.read_text()) for p in sorted((out / "runs" / name).glob("*.json"))]
            last[name] = {key: np.mean([r["checkpoints"][-1][key] for r in runs]) - floor[key] for key in floor}
            c = self.of(report, name)
            self.assertAlmostEqual(c["equal_samples"]["error"]["mean"], last[name]["relmse_trimmed"], places=12)
            self.assertAlmostEqual(c["curve"][-1]["relmse_trimmed"]["mean"], last[name]["relmse_trimmed"], places=12)
            self.assertAlmostEqual(c["all_pixels"]["equal_samples"]["error"]["mean"], last[name]["relmse"], places=12)
        for found, key in ((c["equal_samples"], "relmse_trimmed"), (c["all_pixels"]["equal_samples"], "relmse")):
            self.assertAlmostEqual(found["ratio"]["mean"], last["second-moment"][key] / last["equal"][key], places=9)
        other = self.of(report, "Other")
        self.assertGreater(
            other["all_pixels"]["equal_samples"]["error"]["mean"], 2 * other["equal_samples"]["error"]["mean"]
        )
        self.assertRegex(
            " ".join(report["finding"]), r"With all pixels, .*errors at equal samples are .*second-moment \d"
        )
        with open(out / "configurations.csv") as file:
            rows = {row["configuration"]: row for row in csv.DictReader(file)}
        self.assertEqual(
            float(rows["second-moment"]["all_pixels_equal_samples_ratio"]),
            c["all_pixels"]["equal_samples"]["ratio"]["mean"],
        )

    def test_a_model_of_its_own_is_no_error(self):
        _, report = self.quick("--external", self.manifest(scale=1.1, common=False))
        other = self.of(report, "Other")
        self.assertEqual(other["bias"]["verdict"], "none found")
        model = report["models"][0]
        self.assertIsNone(model["agree"])
        self.assertAlmostEqual(model["difference"]["mean"]["g"], 0.1, delta=0.02)
        self.assertIn("not an error", model["text"])

    # ---- the finding and the theory

    def groups(self, report, name, kind="object"):
        return {g["name"]: g["error_ratio"] for g in self.of(report, name)["groups"] if g["kind"] == kind}

    THEORY = (
        "--integrator", "direct", "--sampler", "independent", "--samples-per-hit", 8, "--pilot-spp", 16, "--max-spp", 64,
        "--min-fraction", 0.001, "-c", "equal", "-c", "variance", "-c", "second-moment",
    )  # fmt: skip

    def test_known_times_in_known_ratios_out(self):
        """Three configurations with the same images, whose runs are given times that are known: as the baseline, 0.62 of it, and as it."""
        options = (
            "--max-spp",
            16,
            "--seeds",
            12,
            "-c",
            "equal",
            "-c",
            "sooner:allocation=equal",
            "-c",
            "again:allocation=equal",
        )
        self.study(*options)
        factor = {"equal": 1, "sooner": 0.62, "again": 1}
        runs = {}
        for name in factor:
            for path in sorted((self.folder / "study/runs" / name).glob("*.json")):
                run = json.loads(path.read_text())
                for at in run["checkpoints"]:
                    at["wall"] = (0.02 + 0.01 * at["spp"]) * factor[name]
                    at["cpu"] = 2 * at["wall"]
                    at["mape"] *= 2 if name == "sooner" else 1
                path.write_text(json.dumps(run))
                runs.setdefault(name, []).append(run)
        _, report = self.study(*options)
        self.assertEqual(report["clock"], "wall")
        key = report["metric"]
        floor = report["reference"]["floor"][key]
        error = np.mean([[at[key] for at in run["checkpoints"]] for run in runs["equal"]], axis=0) - floor
        wall = 0.02 + 0.01 * np.array([1, 2, 4, 8, 16])
        target = self.of(report, "equal")["time_to_target"]["target"]

        def along(x, xs, ys):
            return np.exp(np.interp(np.log(x), np.log(xs), np.log(ys)))

        self.assertAlmostEqual(
            self.of(report, "equal")["time_to_target"]["seconds"]["mean"],
            along(target, error[::-1], wall[::-1]),
            places=9,
        )
        at = self.of(report, "equal")["equal_time"]
        self.assertAlmostEqual(at["seconds"], 0.62 * wall[-1], places=12)
        self.assertAlmostEqual(at["error"]["mean"], along(at["seconds"], wall, error), places=9)
        for name, ratio in factor.items():
            if name == "equal":
                continue
            c = self.of(report, name)
            for found in (c["time_to_target"]["ratio"], c["efficiency"]["ratio"]):
                for end in ("mean", "low", "high"):
                    self.assertAlmostEqual(found[end], ratio, places=9)
            self.assertAlmostEqual(
                c["equal_time"]["error"]["mean"], along(at["seconds"] / ratio, wall, error), places=9
            )
            self.assertEqual(c["equal_samples"]["ratio"], {"mean": 1, "low": 1, "high": 1})
        self.assertEqual(self.of(report, "sooner")["time_to_target"]["verdict"], "faster")
        self.assertEqual(self.of(report, "again")["time_to_target"]["verdict"], "tie")
        for group in self.of(report, "sooner")["groups"]:
            self.assertAlmostEqual(group["ratio"]["mean"], 0.62, places=9)
            self.assertEqual(group["error_ratio"]["mean"], 1)
        cost, run = self.of(report, "equal")["cost"], runs["equal"][0]
        samples = np.mean([sum(run["samples"]) for run in runs["equal"]])
        self.assertAlmostEqual(cost["ns_per_sample"], 1e9 * run["checkpoints"][-1]["cpu"] / samples, places=3)
        self.assertAlmostEqual(
            cost["rays_per_path"],
            1 + np.sum([r["rays"] for r in runs["equal"]]) / np.sum([r["camera_rays"] for r in runs["equal"]]),
            places=9,
        )
        error = np.mean([run["checkpoints"][-1][key] for run in runs["equal"]]) - floor
        efficiency = self.of(report, "equal")["efficiency"]["variance_x_seconds"]["mean"]
        self.assertAlmostEqual(efficiency / (error * run["checkpoints"][-1]["cpu"]), 1, delta=0.1)
        shares = self.of(report, "equal")["allocation"]
        self.assertAlmostEqual(shares["lobe"] + shares["cosine"] + shares["light"], 1, places=6)
        self.assertIsNone(shares["clamped"])
        # a pixel of an edge, of which the survey met another surface than these 16 samples
        self.assertLess(shares["starved"], 0.002)
        for technique in report["techniques"]:  # a cost may be measured as 0 on a busy machine
            product = technique["variance"] * technique["ns_per_sample"]
            self.assertAlmostEqual(technique["variance_x_cost"], product, delta=1e-9 * product)
        wins = self.of(report, "sooner")["wins"]
        self.assertGreater(wins["better"], 0.5)
        self.assertEqual(wins["worse"], 0)
        self.assertEqual(self.of(report, "again")["wins"]["undecided"], 1)
        said = " ".join(report["finding"])
        self.assertIn("sooner 0.62 [0.62, 0.62]", said)
        self.assertIn("No difference from equal is found for again 1.00 [1.00, 1.00]", said)
        self.assertIn("errors in shares of that of equal: sooner 1.00 [1.00, 1.00]", said)
        self.assertRegex(
            said, r"By MAPE, .* more error than of equal at equal samples with sooner 0\.\d+; equal has 0\."
        )

    def test_veach(self):
        """Where a hit has one integral and two techniques, `variance` ties with `equal` (docs/theory.md); where a plate has two
        that share their light samples, allocations gain, and `second-moment` the most."""
        _, report = self.study(*self.THEORY, "--resolution", "72x48", scene="veach", small=False)
        variance, second = self.groups(report, "variance"), self.groups(report, "second-moment")
        for diffuse in ("Wall", "Floor"):
            self.assertLess(variance[diffuse]["low"], 1.02)
            self.assertGreater(variance[diffuse]["high"], 0.98)
        for plate in ("Plate 2", "Plate 3", "Plate 4"):
            self.assertLess(second[plate]["high"], 1, plate)
        self.assertLess(self.of(report, "second-moment")["equal_samples"]["ratio"]["high"], 1)

    def test_teapot(self):
        _, report = self.study(*self.THEORY, "--resolution", "72x48", small=False)
        ratio = self.of(report, "variance")["equal_samples"]["ratio"]
        self.assertLess(abs(ratio["mean"] - 1), 0.05, ratio)

    def test_stiff_mirror(self):
        _, report = self.study(*self.THEORY, "--resolution", "48x32", scene="stiff-mirror", small=False)
        ratio = self.of(report, "variance")["equal_samples"]["ratio"]
        self.assertLess(abs(ratio["mean"] - 1), 0.05, ratio)
        for c in report["configurations"]:
            self.assertEqual(c["counts"], {"nan": 0, "infinite": 0, "negative": 0})

    def test_a_variance_pass_that_can_be_believed(self):
        """With independent samples the runs' own variance is that over the seeds."""
        _, report = self.study("--max-spp", 64, "--sampler", "independent", "--integrator", "direct", "-c", "equal")
        prediction = self.of(report, "equal")["prediction"]
        self.assertLess(prediction["pooled"]["low"], 1.05)
        self.assertGreater(prediction["pooled"]["high"], 0.95)
        self.assertEqual(sum(prediction["counts"]) > 0, True)
