# SPDX-License-Identifier: GPL-3.0-or-later
"""The documentation that came with the add-on, and a report of a problem with everything in it but what its user saw."""

from __future__ import annotations

import os
import platform
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy

from . import warnings
from .comparison import job
from .export import VERSION
from .preferences import renderer_path
from .process import RendererError, version
from .reporting import reported

PACKAGED = Path(__file__).parent / "documentation" / "README.html"  # tools/package.py puts it there
CHECKOUT = Path(__file__).resolve().parents[2] / "README.md"
QUESTION = "What did you do, what did you expect, and what happened instead?"


def documentation() -> Path:
    """The page to begin with. Raises RuntimeError where there is none."""
    for page in (PACKAGED, CHECKOUT):
        if page.is_file():
            return page
    raise RuntimeError(f"WardMIS: there is no documentation at {PACKAGED}; install the packaged add-on again")


def tracker() -> str:
    """Where the project wants problems to be reported; empty: nowhere in public."""
    return str(sys.modules[__package__].bl_info.get("tracker_url", ""))


def problem(scene: Any) -> str:
    """A report to be completed."""
    lines = ["A problem with WardMIS", "", QUESTION, "...", ""]
    for title, content in (
        ("Versions", _versions()),
        ("Settings", _settings(scene)),
        ("The last failure", _failures()),
        ("Warnings of the last render", (warning.full for warning in warnings.of_scene(scene))),
    ):
        lines += [f"{title}:", *([f"  {line}" for line in content] or ["  none"]), ""]
    return "\n".join(lines)


def _versions() -> Iterator[str]:
    yield f"add-on {VERSION} in {Path(__file__).parent}"
    try:
        path = renderer_path()
        yield f"renderer {version(path)} at {path}"
    except RendererError as error:
        yield f"renderer: {error}"
    yield f"Blender {bpy.app.version_string} ({bpy.app.build_hash.decode(errors='replace')}), Python {platform.python_version()}"
    yield f"{platform.platform()}, {' '.join(platform.libc_ver())}, {os.cpu_count()} processors"


def _settings(scene: Any) -> Iterator[str]:
    render, settings = scene.render, scene.wardmis
    yield f"engine {render.engine}, {render.resolution_x} x {render.resolution_y} at {render.resolution_percentage} %"
    yield f"{len(scene.objects)} objects, {len(scene.view_layers)} view layers, frame {scene.frame_current}"
    for prop in settings.bl_rna.properties:
        if prop.identifier not in {"rna_type", "name"}:
            yield f"{prop.identifier} = {getattr(settings, prop.identifier)}"


def _failures() -> Iterator[str]:
    if warnings.last_failure:
        yield warnings.last_failure
    comparison = job.current()
    if comparison is not None and comparison.failure:
        yield f"of a comparison: {comparison.failure}"


class WARDMIS_OT_documentation(bpy.types.Operator):
    bl_idname = "wardmis.documentation"
    bl_label = "Documentation"
    bl_description = "Open the manual of WardMIS in the browser; it came with the add-on and needs no network"

    @reported
    def execute(self, _context: Any) -> set[str]:
        bpy.ops.wm.url_open(url=documentation().as_uri())
        return {"FINISHED"}


class WARDMIS_OT_report_problem(bpy.types.Operator):
    bl_idname = "wardmis.report_problem"
    bl_label = "Report a Problem"
    bl_description = (
        "Put a report into the clipboard and into a file: versions, settings, the last failure and the warnings. "
        "Nothing is sent; read it and complete it first"
    )

    def execute(self, context: Any) -> set[str]:
        text = problem(context.scene)
        path = Path(tempfile.gettempdir()) / "wardmis-problem.txt"
        try:
            path.write_text(text, encoding="utf-8")
        except OSError as error:
            self.report({"ERROR"}, f"WardMIS: {path} cannot be written: {error.strerror}")
            return {"CANCELLED"}
        context.window_manager.clipboard = text
        if not bpy.app.background:
            context.window_manager.popup_menu(_after(path), title=self.bl_label, icon="INFO")
        self.report({"INFO"}, f"The report is in the clipboard and in {path}")
        return {"FINISHED"}


def _after(path: Path) -> Any:
    def draw(self: Any, _context: Any) -> None:
        layout = self.layout
        layout.label(text="The report is in the clipboard, ready to be pasted, and in a file:")
        layout.operator("wm.path_open", text=str(path), icon="TEXT").filepath = str(path)
        layout.label(text="Say in it what you did, what you expected and what happened;")
        if tracker():
            layout.operator("wm.url_open", text="then send it by this page", icon="URL").url = tracker()
        else:
            layout.label(text="then send it to those from whom you have WardMIS.")

    return draw


_CLASSES = (WARDMIS_OT_documentation, WARDMIS_OT_report_problem)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
