# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of the command share: scenes exported once, and runs of `wardmis`."""

import json
import os
import signal
import subprocess
import tempfile
import unittest
from pathlib import Path

import blender
import exr
import numpy as np
from blender import ROOT

BINARY = os.environ.get("WARDMIS_BINARY", "")
EXPORT = """
import sys, bpy, wardmis
blend, exports, *names = sys.argv[sys.argv.index("--") + 1 :]
for name in names:
    bpy.ops.wm.open_mainfile(filepath=f"{blend}/{name}.blend", load_ui=False)
    wardmis.export_scene(f"{exports}/{name}.glb")
"""


class CommandTest(unittest.TestCase):
    """Has exports of the `scenes` of blend/, and an empty folder of its own for each test."""

    scenes = ("teapot",)

    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.exports = Path(temporary.name)
        blender.run("--python-exit-code", "1", "--python-expr", EXPORT, "--", ROOT / "blend", cls.exports, *cls.scenes)

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        self.out = self.folder / "out.exr"

    def scene(self, name="teapot"):
        return self.exports / f"{name}.glb"

    def run_command(self, *arguments, code=0, **options):
        done = subprocess.run(
            [BINARY, *map(str, arguments)],
            capture_output=True,
            text=True,
            stdin=subprocess.DEVNULL,
            timeout=120,
            **options,
        )
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def render(self, *options, scene=None, out=None, **more):
        """A small render; returns what it said."""
        small = () if "--resolution" in options else ("--resolution", "48x32")
        return self.run_command("render", scene or self.scene(), "-o", out or self.out, *small, *options, **more)

    def refused(self, code, *arguments, says=(), **options):
        """Ends with `code`, and one message that says each of `says`."""
        done = self.run_command(*arguments, code=code, **options)
        self.assertRegex(done.stderr, r"\Awardmis: error: [^\n]+\n\Z")
        for text in says:
            self.assertIn(text, done.stderr)
        return done

    def events(self, text):
        return [json.loads(line) for line in text.splitlines()]

    def started(self, *options, out=None):
        """A long render of which there is an image already, the pilot being over."""
        command = [
            BINARY,
            "render",
            self.scene(),
            "-o",
            out or self.out,
            "--time",
            "100",
            "--resolution",
            "96x64",
            *options,
        ]
        pipes = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
        process = subprocess.Popen([*map(str, command), "--progress", "json"], text=True, **pipes)
        self.addCleanup(close, process)
        for line in process.stdout:
            event = json.loads(line)
            if event["event"] == "progress" and event["phase"] == "render" and event["samples"] > 8:
                return process
        raise AssertionError(process.stderr.read())


def close(process):
    if process.poll() is None:
        process.send_signal(signal.SIGKILL)
        process.wait()
    for stream in (process.stdin, process.stdout, process.stderr):
        stream.close()


def combined(path):
    return exr.read(path).passes["Combined"]


def same(a, b):
    """Bit for bit, in every pass."""
    first, second = exr.read(a).passes, exr.read(b).passes
    return first.keys() == second.keys() and all(np.array_equal(first[p], second[p], equal_nan=True) for p in first)
