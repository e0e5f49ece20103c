# SPDX-License-Identifier: GPL-3.0-or-later
"""What a comparison keeps in the temporary folder, and who removes it when its Blender was killed."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import time
import unittest
from pathlib import Path
from unittest import mock

import bpy
from support import RenderTest, blender
from wardmis import lock, temporary

# as a user compares, with a copy of the scene and with images of earlier results
COMPARES = """
import time
import numpy as np
from wardmis.comparison import images, job
images.put(images.A, np.zeros((8, 16, 3), np.float32), "earlier results")
scene.wardmis_comparison.folder = {results!r}
scene.wardmis_comparison.use_cycles = True
scene.wardmis_comparison.stop_by = "samples"
bpy.ops.wardmis.compare()
assert job.running(), job.current().failure
print("compares", flush=True)
time.sleep(100)
"""


class Killed(RenderTest):
    def compares(self, name: str) -> tuple[subprocess.Popen, list[Path]]:
        """A Blender that compares, and its folders, which look as if they were old."""
        before = set(self.folders())
        place = self.folder / name
        place.mkdir()
        process = blender(
            place,
            COMPARES.format(results=str(self.folder / "results")),
            "--render-frame",
            "1",
            fake="slow",
            TMPDIR=str(self.folder),
        )
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        for line in process.stdout:
            if line.startswith("compares"):
                break
        folders = sorted(set(self.folders()) - before)
        for path in folders:
            os.utime(path, (0, 0))
        return process, folders

    def folders(self) -> list[Path]:
        return [path for path in self.folder.glob("blender_*/wardmis-*") if path.is_dir()]

    def test_what_it_leaves_goes_when_the_next_one_starts(self):
        living, of_the_living = self.compares("living")
        killed, of_the_killed = self.compares("killed")
        kept = ["wardmis-work-comparison", "wardmis-work-results"]
        for folders in (of_the_living, of_the_killed):
            self.assertEqual([path.name for path in folders], kept)
            self.assertTrue((folders[0] / "scene.blend").exists())
            self.assertEqual([path.name for path in folders[1].iterdir()], ["WardMIS A.exr"])
        killed.send_signal(signal.SIGKILL)
        killed.communicate()
        results = sorted((self.folder / "results").rglob("*"))
        self.assertTrue(results)
        next_one = self.run_blender("", "--python-expr", "pass", TMPDIR=str(self.folder))
        self.assertEqual(next_one.code, 0, next_one.output)
        self.assertEqual(sorted(self.folders()), of_the_living)
        self.assertFalse(of_the_killed[0].parent.exists(), "Blender's own folder, which is empty")
        self.assertIsNone(living.poll())
        self.assertLessEqual(set(results), set((self.folder / "results").rglob("*")))


class Kept(unittest.TestCase):
    def setUp(self) -> None:
        self.path = temporary.kept("test")

    def test_it_is_one_folder(self):
        (self.path / "file").touch()
        self.assertEqual(temporary.kept("test"), self.path)
        self.assertTrue((self.path / "file").exists())

    def test_it_is_locked_as_long_as_the_addon_is_there(self):
        def taken() -> bool:
            try:
                with lock.alone(self.path):
                    return False
            except RuntimeError:
                return True

        self.assertTrue(taken())
        shutil.rmtree(self.path)  # as those do who clear temporary folders
        self.assertEqual(temporary.kept("test"), self.path)
        self.assertTrue(taken())
        temporary.unregister()
        self.assertFalse(self.path.exists())
        temporary.register()

    def test_nothing_goes_where_there_are_no_locks(self):
        """Nobody knows there who lives."""
        old = Path(bpy.app.tempdir).parent / "blender_without" / f"{temporary.PREFIX}locks"
        old.mkdir(parents=True)
        self.addCleanup(shutil.rmtree, old.parent, ignore_errors=True)
        os.utime(old, (0, 0))
        with mock.patch.object(lock, "fcntl", None):
            temporary.register()
        self.assertTrue(old.exists())
        self.assertGreater(time.time() - old.stat().st_mtime, temporary.YOUNG_SECONDS)
        other = old.with_name("of something else")
        other.touch()
        temporary.register()
        self.assertFalse(old.exists())
        self.assertTrue(other.exists())
