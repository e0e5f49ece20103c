# SPDX-License-Identifier: GPL-3.0-or-later
"""wardmis.compare() with the real Cycles and the real renderer: a diffuse scene, where both have the same integrand, has one
reference and both agree with it; a glossy one has two, and the difference of the models is no error."""

import json
import os
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import blender
from blender import ROOT

COMPARE = """
import sys
folder, scene, *names = sys.argv[sys.argv.index("--") + 1 :]
sys.path[:0] = [folder]
import bpy, wardmis
if scene.endswith(".blend"):
    bpy.ops.wm.open_mainfile(filepath=scene, load_ui=False)
else:
    sys.path[:0] = [names[0]]
    import render
    render.make(render.SCENES[scene])
wardmis.compare(folder + "/study", resolution=(72, 48), configurations=["equal", "auto"], max_spp=16, seeds=6, cycles_reference_spp=512)
"""


class Compare(unittest.TestCase):
    def compare(self, scene):
        temporary = tempfile.TemporaryDirectory(prefix="vergleich ü ")
        self.addCleanup(temporary.cleanup)
        scenes = ROOT / "tests" / "cycles"
        blender.run(
            "--factory-startup",
            "--python-exit-code",
            "1",
            "--python-expr",
            COMPARE,
            "--",
            temporary.name,
            scene,
            scenes,
        )
        self.folder = Path(temporary.name) / "study"
        return json.loads((self.folder / "report.json").read_text())

    def test_a_diffuse_scene_has_one_reference_and_both_agree_with_it(self):
        report = self.compare("lamps-areas")
        (model,) = report["models"]
        self.assertTrue(model["common"], model)
        self.assertIs(model["agree"], True, model)
        for c in report["configurations"]:
            self.assertEqual(c["bias"]["verdict"], "none found", c["bias"])
            self.assertEqual([at["spp"] for at in c["curve"]], [1, 2, 4, 8, 16])
        cycles = report["configurations"][-1]
        self.assertTrue(cycles["renderer"].startswith("Cycles"))
        self.assertEqual(cycles["reference"], report["configurations"][0]["reference"])
        self.assertLess(cycles["curve"][-1]["relmse"]["mean"], cycles["curve"][0]["relmse"]["mean"] / 4)

    def test_a_glossy_scene_has_two(self):
        report = self.compare(str(ROOT / "blend" / "veach.blend"))
        (model,) = report["models"]
        self.assertFalse(model["common"])
        self.assertIsNone(model["agree"])
        self.assertGreater(model["difference"]["relmse"], 1e-3)
        self.assertIn("not an error", model["text"])
        self.assertEqual(report["configurations"][-1]["bias"]["verdict"], "none found")
        notes = " ".join(report["configurations"][-1]["notes"])
        self.assertIn("synchronisation", notes)

    def dev_compare(self, out, *options):
        return [ROOT / "dev", "compare", "blend/teapot.blend", "-o", out, *options]

    def wait(self, process, condition):
        """Until it holds; the process goes on meanwhile."""
        deadline = time.monotonic() + 120
        while not condition():
            self.assertLess(time.monotonic(), deadline)
            self.assertIsNone(process.poll())
            time.sleep(0.02)

    def test_stopped_by_ctrl_c_and_gone_on_with(self):
        """./dev compare, as a terminal sends it, while Cycles renders; the teapot's export has other last bits each time."""
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "study"
            size = ("--seeds", "2", "--max-spp", "32", "--cycles-reference-spp", "32", "--resolution", "96x64")
            command = self.dev_compare(out, "-c", "equal", *size)
            pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
            process = subprocess.Popen(command, cwd=ROOT, start_new_session=True, **pipes)
            self.addCleanup(process.kill)
            manifest = out / "cycles" / "manifest.json"
            self.wait(process, lambda: manifest.exists() and json.loads(manifest.read_text())["runs"])
            os.killpg(process.pid, signal.SIGINT)
            _, said = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 130, said)
            self.assertIn(f"WardMIS: stopped; {out} keeps what is done, and the same comparison again goes on", said)
            self.assertNotIn("error", said)
            kept = json.loads(manifest.read_text())["runs"]
            self.assertLess(len(kept), 12)
            done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, stdin=subprocess.DEVNULL)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            runs = json.loads(manifest.read_text())["runs"]
            self.assertEqual(len(runs), 12)
            for run in kept:  # with the times that it had
                self.assertIn(run, runs)
            self.assertTrue(json.loads((out / "report.json").read_text())["complete"])

    def test_ended_by_force_it_leaves_no_blender_behind(self):
        """./dev compare becomes Blender, and what Blender has started ends with it."""
        for rendering, *more in (("cycles/*.exr",), ("runs/*/*.exr", "--no-cycles", "--max-spp", "4096")):
            with self.subTest(rendering), tempfile.TemporaryDirectory() as folder:
                out = Path(folder) / "study"
                command = self.dev_compare(out, "-c", "equal", "--resolution", "96x64", "--reference-time", "1", *more)
                process = subprocess.Popen(command, cwd=ROOT, stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # fmt: skip
                self.addCleanup(process.kill)
                self.wait(process, lambda where=out, what=rendering: list(where.glob(what)))
                process.kill()
                process.wait()
                time.sleep(0.5)
                found = subprocess.run(["pgrep", "-f", str(out)], capture_output=True, text=True).stdout
                self.assertEqual(found, "")

    def test_by_the_script(self):
        """./dev compare, as it is documented."""
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "study"
            command = self.dev_compare(
                out, "--max-spp", "2", "--seeds", "2", "-c", "equal", "--no-cycles", "--resolution", "48x32"
            )
            done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, stdin=subprocess.DEVNULL)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            self.assertTrue((out / "report.html").is_file())
            self.assertIn("report.html", done.stdout)
            self.assertIn("On teapot", done.stdout)
            self.assertEqual(json.loads((out / "report.json").read_text())["width"], 48)
            done = subprocess.run(
                [ROOT / "dev", "compare", "none.blend", "-o", out],
                cwd=ROOT,
                capture_output=True,
                text=True,
                stdin=subprocess.DEVNULL,
            )
            self.assertNotEqual(done.returncode, 0)
            self.assertIn("none.blend", done.stderr)
