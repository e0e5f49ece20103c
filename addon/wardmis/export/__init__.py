# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's scene -> plain data (model.py) -> a GLB file."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

import bpy

from .context import ExportCancelled, ExportError, Tell
from .glb import write_glb
from .motion import SetFrame
from .scene import gather_scene

__all__ = ["VERSION", "ExportCancelled", "ExportError", "export_depsgraph"]

VERSION = "0.1.0"  # the same as in bl_info and blender_manifest.toml


def export_depsgraph(
    depsgraph: Any,
    path: str | os.PathLike[str],
    camera: Any = None,
    cancelled: Callable[[], bool] | None = None,
    set_frame: SetFrame | None = None,
    tell: Tell | None = None,
) -> list[str]:
    """Writes what the render of `depsgraph` needs to `path`; returns the notes for the user. `set_frame` takes `depsgraph` to other
    times, for motion blur; it is left at its own. `tell` is called with what it is doing that takes long, and with "" afterwards.

    Raises ExportError (the scene cannot be exported, or the file not written) or ExportCancelled.
    """

    def check_cancelled() -> None:
        if cancelled is not None and cancelled():
            raise ExportCancelled

    generator = f"WardMIS {VERSION}, Blender {bpy.app.version_string}"
    scene = gather_scene(depsgraph, generator, camera, cancelled, set_frame, tell)
    write_glb(scene, path, check_cancelled)
    return scene.notes
