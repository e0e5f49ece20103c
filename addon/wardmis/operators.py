# SPDX-License-Identifier: GPL-3.0-or-later
"""File > Export > WardMIS scene (.glb), and the same for scripts."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import bpy
from bpy.props import StringProperty
from bpy_extras.io_utils import ExportHelper

from . import second_blender, temporary, warnings
from .engine import WARDMIS_RenderEngine, scene_export_to
from .export import ExportError, export_depsgraph
from .export.target import check_target
from .process import Renderer, RendererError
from .reporting import reported

WAIT_SECONDS = 0.1


def export_scene(path: str | os.PathLike[str], depsgraph: Any = None) -> None:
    """Writes the scene of `depsgraph`, or the scene as a render of the active view layer sees it, for the command `wardmis`.

    Raises RuntimeError with a message for the user.
    """
    path = Path(path).absolute()
    try:
        check_target(path)  # before Blender evaluates the scene, which may take long
        if depsgraph is not None:
            export_depsgraph(depsgraph, path)
        elif second_blender.wanted():
            _export_by_second_blender(path)
        else:
            _export_by_render(path)
    except (ExportError, RendererError) as error:
        raise RuntimeError(f"WardMIS: {error}") from error


def export_command(blend: Path, place: dict[str, str], percentage: int, path: Path) -> list[str]:
    """Of the second Blender, for the export of its copy, at `percentage` of the resolution."""
    return second_blender.command(blend, place, "operators", percentage=percentage, path=str(path))


def run_task(tell: second_blender.Tell, percentage: int, path: str) -> None:
    bpy.context.scene.render.resolution_percentage = percentage
    export_scene(path)
    for event in warnings.events(**second_blender.place(bpy.context)):
        tell(event)


def _export_by_second_blender(path: Path) -> None:
    with temporary.folder() as folder:
        blend = second_blender.save_copy(folder)[0]
        percentage = bpy.context.scene.render.resolution_percentage
        place = second_blender.place(bpy.context)
        warnings.begin(**place)
        with Renderer(export_command(blend, place, percentage, path), second_blender.NAME) as process:
            while process.running():
                for event in process.events(WAIT_SECONDS):
                    warnings.take(event, **place)
            for event in process.finish():
                warnings.take(event, **place)


def _export_by_render(path: Path) -> None:
    """By Blender's render operator, which alone evaluates a scene as for a render; the image of the last render is lost."""
    scene, layer = bpy.context.scene, bpy.context.view_layer
    engine = scene.render.engine
    try:
        scene.render.engine = WARDMIS_RenderEngine.bl_idname
        with scene_export_to(path):
            bpy.ops.render.render(scene=scene.name, layer=layer.name)
    except RuntimeError as error:  # the engine's reports, as Blender prints them
        raise RuntimeError(str(error).strip().removeprefix("Error: ")) from error
    finally:
        scene.render.engine = engine


class WARDMIS_OT_export(bpy.types.Operator, ExportHelper):
    bl_idname = "wardmis.export"
    bl_label = "Export WardMIS Scene"
    bl_description = (
        "Write the scene as it would be rendered now into a glTF file, which the command 'wardmis' "
        "renders and compares without Blender"
    )

    filename_ext = ".glb"
    filter_glob: StringProperty(default="*.glb", options={"HIDDEN"})

    @reported
    def execute(self, _context: Any) -> set[str]:
        export_scene(self.filepath)
        self.report({"INFO"}, f"Wrote {self.filepath}")
        return {"FINISHED"}


def _menu(self: Any, _context: Any) -> None:
    self.layout.operator(WARDMIS_OT_export.bl_idname, text="WardMIS scene (.glb)")


def register() -> None:
    bpy.utils.register_class(WARDMIS_OT_export)
    bpy.types.TOPBAR_MT_file_export.append(_menu)


def unregister() -> None:
    bpy.types.TOPBAR_MT_file_export.remove(_menu)
    bpy.utils.unregister_class(WARDMIS_OT_export)
