# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on is disabled or installed anew while it renders: Blender frees an engine that is unregistered, also one at work."""

from __future__ import annotations

import contextlib
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

from support import RenderTest
from wardmis.process import Renderer, RendererError

REMOVE = "bpy.ops.preferences.addon_disable(module='wardmis')"

# a render as F12 begins it, in Blender's own thread; an exit code of 0 only from the very end
IN_A_WINDOW = """
import os
preferences = bpy.context.preferences.view
preferences.show_splash, preferences.render_display_type = False, "NONE"
scene.render.engine = "WARDMIS"
steps = [
    lambda: bpy.ops.render.render("INVOKE_DEFAULT", animation=True),
    lambda: REMOVE,
    lambda: BRING_BACK,
    lambda: print("alive", hasattr(scene, "wardmis"), bpy.app.is_job_running("RENDER"), flush=True),
    lambda: os._exit(0),
]

def step():
    steps.pop(0)()
    return 1.5

bpy.app.timers.register(step, first_interval=2)
"""


class WhileItRenders(RenderTest):
    def test_it_is_ended_and_waited_for(self):
        """With the threads the other way round: without a window the main one renders."""
        script = """
import threading
from wardmis import rendering
threading.Timer(1, rendering.end).start()
bpy.app.handlers.render_cancel.append(lambda *_: print("cancelled", flush=True))
"""
        run = self.run_blender(script, fake="slow")
        self.assertEqual(run.code, 1, run.output)
        self.assertIn("cancelled", run.output)
        self.assertIn("WardMIS: stopped before the image was complete", run.output)
        self.assertNotIn("StructRNA", run.output)
        self.assertEqual(run.left_over, [])

    def test_within_the_render_it_is_refused(self):
        run = self.run_blender(f"bpy.app.handlers.render_pre.append(lambda *_: {REMOVE})\n")
        self.assertIn("the add-on cannot be removed by what runs within a render with it", run.output)
        self.assertEqual(len(run.images), 1, run.output)

    @unittest.skipUnless(shutil.which("Xvfb"), "there is no Xvfb")
    def test_in_a_window(self):
        self.check_in_a_window(REMOVE, "bpy.ops.preferences.addon_enable(module='wardmis')")

    @unittest.skipUnless(shutil.which("Xvfb"), "there is no Xvfb")
    def test_scripts_are_reloaded(self):
        self.check_in_a_window("bpy.ops.script.reload()", "None")

    @unittest.skipUnless(shutil.which("Xvfb"), "there is no Xvfb")
    def test_another_engine_goes(self):
        """With which Blender frees all of them."""
        self.check_in_a_window("bpy.ops.preferences.addon_disable(module='cycles')", "None")

    def check_in_a_window(self, remove, bring_back):
        with display() as name:
            run = self.run_blender(
                IN_A_WINDOW.replace("REMOVE", remove).replace("BRING_BACK", bring_back),
                "--window-geometry",
                *["0", "0", "640", "480"],
                fake="slow",
                window=True,
                DISPLAY=name,
                LIBGL_ALWAYS_SOFTWARE="1",
            )
        self.assertEqual(run.code, 0, run.output)
        self.assertIn("alive True False", run.output)
        self.assertEqual(len(run.calls), 1, "the animation went on without the add-on")


class Replaced(unittest.TestCase):
    """Blender 3.4 writes an add-on over the one whose renderer runs."""

    def test_renderer(self):
        with tempfile.TemporaryDirectory() as folder:
            path = shutil.copy(shutil.which("sleep"), folder)
            with Renderer([path, "60"]) as renderer:
                self.assertFalse(renderer.was_replaced())
                os.unlink(path)
                shutil.copy(shutil.which("true"), path)
                self.assertTrue(renderer.was_replaced())

    def test_a_library_of_it(self):
        """Which is written before the renderer itself: the process crashes while that is still its own."""
        for replaced in (False, True):
            with self.subTest(replaced=replaced), tempfile.TemporaryDirectory() as folder:
                path, library = shutil.copy(shutil.which("bash"), folder), Path(folder) / "lib" / "libany.so"
                library.parent.mkdir()
                library.write_text("before")
                with Renderer([path, "-c", "read; kill -SEGV $$"]) as renderer:
                    if replaced:
                        library.write_text("after")
                    renderer._process.stdin.close()
                    with self.assertRaisesRegex(RendererError, "was replaced while it ran" if replaced else "SIGSEGV"):
                        renderer.finish()


@contextlib.contextmanager
def display():
    """An X server without a screen; its name."""
    read, write = os.pipe()
    with tempfile.TemporaryFile() as log:
        server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", "800x600x24", "-nolisten", "tcp"],
            stderr=log,
            pass_fds=[write],
        )
        try:
            os.close(write)
            yield f":{os.read(read, 16).decode().strip()}"
        finally:
            os.close(read)
            server.terminate()
            server.wait()
