# SPDX-License-Identifier: GPL-3.0-or-later
"""The documentation is found without a network, and a report of a problem holds what its reader needs."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from unittest import mock

import bpy
from support import FAKE, SceneTest
from wardmis import support, warnings
from wardmis.export import VERSION


class Documentation(SceneTest):
    def test_opens_the_packaged_pages_else_the_checkouts(self):
        with tempfile.TemporaryDirectory() as folder, mock.patch("webbrowser.open") as opened:
            page = Path(folder) / "README with äöü.html"
            page.write_text("")
            with mock.patch.object(support, "PACKAGED", page):
                self.assertEqual(bpy.ops.wardmis.documentation(), {"FINISHED"})
            self.assertEqual(opened.call_args[0][0], page.as_uri())
            self.assertEqual(bpy.ops.wardmis.documentation(), {"FINISHED"})
            self.assertTrue(opened.call_args[0][0].endswith("/README.md"))
            nowhere = Path(folder) / "none"
            with (
                mock.patch.multiple(support, PACKAGED=nowhere, CHECKOUT=nowhere),
                self.assertRaisesRegex(RuntimeError, "install the packaged add-on again"),
            ):
                bpy.ops.wardmis.documentation()


class Problem(SceneTest):
    def test_report_is_filled_in(self):
        place = self.scene.name, self.scene.view_layers[0].name
        quiet = mock.patch.object(warnings, "_tell", lambda _text: None)
        with quiet:
            warnings.begin(*place)
            warnings.add(*place, "object 'Camera': something odd")
        self.addCleanup(warnings.begin, *place)
        self.addCleanup(warnings.failed, "")
        warnings.failed("the renderer crashed (SIGSEGV)")
        self.scene.wardmis.samples = 77
        with mock.patch.dict(os.environ, {"WARDMIS_BINARY": str(FAKE)}):
            text = support.problem(self.scene)
        for expected in (
            support.QUESTION,
            f"add-on {VERSION}",
            "renderer wardmis 0.0.0 (fake)",
            f"Blender {bpy.app.version_string}",
            "samples = 77",
            "the renderer crashed (SIGSEGV)",
            "object 'Camera': something odd",
        ):
            self.assertIn(expected, text)

    def test_it_is_left_in_a_file_and_not_in_the_users(self):
        texts = len(bpy.data.texts)
        with tempfile.TemporaryDirectory() as folder, mock.patch.object(tempfile, "gettempdir", lambda: folder):
            environment = mock.patch.dict(os.environ, {"WARDMIS_BINARY": "/nowhere/wardmis"})
            with environment:
                self.assertEqual(bpy.ops.wardmis.report_problem(), {"FINISHED"})
            written = (Path(folder) / "wardmis-problem.txt").read_text(encoding="utf-8")
        self.assertIn("renderer: there is no renderer at /nowhere/wardmis", written)
        self.assertEqual(len(bpy.data.texts), texts)
