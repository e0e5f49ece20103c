# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine: exports, runs the renderer as a process, and brings its images back.

Blender's traps that shape this file: an exception in render() would end in a saved blank image and exit code 0, and a render() without
a result can crash Blender when it saves an EXR. A reported ERROR avoids both, so that every failure ends in one.
"""

from __future__ import annotations

import contextlib
import json
import shutil
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from . import compat, light_paths, rendering, sharing, temporary, warnings
from .export import ExportCancelled, ExportError, export_depsgraph
from .export.camera import border, full_resolution
from .exr import read_header, read_pass
from .passes import not_available, passes_of, passes_option, register_passes, tell
from .preferences import renderer_path
from .process import Renderer, RendererError
from .seed import seed_of

POLL_SECONDS = 0.1

# where the next render shall write the scene, instead of rendering it: see scene_export_to()
_export_to: Path | None = None


@contextlib.contextmanager
def scene_export_to(path: Path) -> Iterator[None]:
    """Within it, a render with this engine only exports.

    Blender evaluates a scene for a render (levels of subdivision, what is visible) for render engines alone; this is how an export gets
    exactly the scene that F12 would show.
    """
    global _export_to
    _export_to = path
    try:
        yield
    finally:
        _export_to = None


class _Stopped(Exception):
    """The user stopped the render."""


class WARDMIS_RenderEngine(bpy.types.RenderEngine):
    bl_idname = rendering.ENGINE
    bl_label = "WardMIS"
    bl_use_preview = False
    bl_use_gpu_context = False
    bl_use_shading_nodes_custom = False
    bl_use_eevee_viewport = True
    bl_use_postprocess = True

    def update_render_passes(self, scene: Any = None, renderlayer: Any = None) -> None:
        register_passes(self, scene, renderlayer)

    def render(self, depsgraph: Any) -> None:
        try:
            with temporary.folder() as folder:
                _Render(self, depsgraph, folder).run()
        except (ExportCancelled, _Stopped):
            self.keep_text("Cancelled")
            # a script must not take it for a success, and an animation not go on without the add-on
            if bpy.app.background or rendering.stopping():
                self.report({"ERROR"}, "WardMIS: stopped before the image was complete")
        except (ExportError, RendererError) as error:
            self._fail(str(error))
        except OSError as error:
            self._fail(f"{error.strerror or error}: {error.filename or 'a file of the render'}")
        except Exception as error:  # a mistake of ours; without the report Blender would save a blank image
            traceback.print_exc()
            self._fail(f"an error in the add-on, please report it with the console's text: {error!r}")

    def keep_text(self, text: str) -> None:
        """Beside the time, also when the render has ended, which update_stats() does not outlast."""
        self.update_stats("", text)
        if not bpy.app.background:
            self.error_set(text)

    def _fail(self, message: str) -> None:
        self.keep_text("Failed")
        warnings.failed(message)
        self.report({"ERROR"}, f"WardMIS: {message}")


class _Render:
    """One call of render(): one view layer of one frame."""

    def __init__(self, engine: Any, depsgraph: Any, folder: Path) -> None:
        self.engine = engine
        self.depsgraph = depsgraph
        self.layer = depsgraph.view_layer_eval
        self.scene = depsgraph.scene_eval
        self.scene_path = folder / "scene.glb"
        self.image_path = folder / "image.exr"
        self.preview_path = folder / "preview.exr"
        x0, y0, x1, y1 = border(self.scene.render, full_resolution(self.scene.render))
        self.width, self.height = x1 - x0, y1 - y0
        self.result: Any = None
        self.started = False
        self.told: set[str] = set()  # the names of the passes that the renderer writes
        self.statistics: dict[str, Any] = {}

    def run(self) -> None:
        warnings.begin(*self._place())
        try:
            self._run()
        finally:
            warnings.redraw()

    def _run(self) -> None:
        if _export_to is not None:
            self._export(_export_to)
            return
        if self.scene.render.use_multiview:
            raise ExportError("stereoscopy is not supported; turn it off in Output Properties > Stereoscopy")
        # before the export: what cannot work should not take long to be told
        binary = renderer_path()
        self._check_room_for_output(3 * self.width * self.height)
        self._export(self.scene_path)
        try:
            with Renderer([str(binary), "render", *self._arguments()]) as renderer:
                self._follow(renderer)
            if self.scene.render.image_settings.file_format == "OPEN_EXR_MULTILAYER":
                self._check_room_for_output(self.image_path.stat().st_size)
            self._show(self.image_path)
        except Exception:
            if self.result is not None and not self._stopped():
                self.engine.end_result(self.result, cancel=True)
                self.result = None
            raise
        finally:
            # a stopped render keeps the image so far
            if self.result is not None:
                self.engine.end_result(self.result)
        # saved files carry it, as they do Cycles' own
        name = f"wardmis.{self.layer.name}.statistics"
        self.engine.get_result().stamp_data_add_field(name, json.dumps(self.statistics))
        count = warnings.count(*self._place())
        if count and not bpy.app.background:
            self.engine.keep_text(warnings.count_text(count))
            self.engine.report(
                {"WARNING"}, f"WardMIS: {warnings.count_text(count)}, see Warnings in the Render Properties"
            )

    def _place(self) -> tuple[str, str]:
        return self.scene.name, self.layer.name

    def _stopped(self) -> bool:
        return rendering.stopping() or self.engine.test_break()

    def _export(self, path: Path) -> None:
        self._show_export("")
        for name in not_available(self.layer):
            self._warn(f"view layer '{self.layer.name}': there is no pass {name}; it is left out")
        for note in self._exported(path):
            self._warn(note)

    def _exported(self, path: Path) -> list[str]:
        """Writes the scene; returns what there is to tell."""
        engine = self.engine
        return export_depsgraph(
            self.depsgraph, path, engine.camera_override, self._stopped, engine.frame_set, self._show_export
        )

    def _show_export(self, doing: str) -> None:
        self._show_text(f"Exporting the scene: {doing}" if doing else "Exporting the scene")

    def _check_room_for_output(self, size: int) -> None:
        """Raises ExportError where Blender is about to save the image to a disk without room for `size` bytes.

        Blender does not notice that: it would leave a truncated file and end with exit code 0.
        """
        if not (bpy.app.background or self.engine.is_animation):
            return
        folder = Path(self.depsgraph.scene.render.frame_path()).absolute().parent
        while not folder.exists():
            folder = folder.parent
        free = shutil.disk_usage(folder).free
        if free < size:
            raise ExportError(
                f"the disk of {folder} has {free / 1024:,.0f} KiB free, and the image wants {size / 1024:,.0f}; "
                "make room, or choose another output"
            )

    def _warn(self, message: str) -> None:
        warnings.add(*self._place(), message)

    def _show_text(self, text: str, left: str = "") -> None:
        count = warnings.count(*self._place())
        self.engine.update_stats(left, f"{text} | {warnings.count_text(count)}" if count else text)

    def _arguments(self) -> list[str]:
        settings, render = self.scene.wardmis, self.scene.render
        arguments = [self.scene_path, "-o", self.image_path, f"--layer={self.layer.name}"]
        arguments += ["--passes", passes_option(self.layer), "--uncompressed"]
        arguments += ["--progress", "json", "--watch-stdin"]
        if not bpy.app.background:  # nobody watches
            arguments += ["--preview", self.preview_path]
        arguments += ["--integrand", settings.integrand, "--integrator", settings.integrator]
        arguments += ["--sampler", settings.sampler, "--seed", seed_of(self.scene)]
        for option, value in {**sharing.options(settings), **light_paths.options(self.scene)}.items():
            arguments += [f"--{option}", value]
        arguments += ["--samples-per-hit", settings.samples_per_hit]
        if settings.stop_by == "samples":
            arguments += ["--spp", settings.samples]
        elif settings.stop_by == "seconds":
            arguments += ["--time", f"{settings.seconds:.6g}"]
        else:
            arguments += ["--target-error", f"{settings.target_error:.6g}", "--spp", settings.max_samples]
        if sharing.uses_pilot(settings):
            arguments += ["--pilot-spp", settings.pilot_samples, "--min-fraction", f"{settings.min_fraction:.6g}"]
        if render.threads_mode == "FIXED":
            arguments += ["--threads", render.threads]
        return [str(argument) for argument in arguments]

    def _follow(self, renderer: Renderer) -> None:
        """Until the renderer has ended well. Raises RendererError if it ends otherwise, _Stopped if the user stops."""
        while renderer.running():
            for event in renderer.events(POLL_SECONDS):
                self._handle(event)
            if self._stopped():
                raise _Stopped
        try:
            events = renderer.finish()
        except RendererError as error:
            if self._stopped():
                raise _Stopped from error
            raise
        for event in events:
            self._handle(event)
        if not self.image_path.is_file():
            doubt = "" if self.started else "; it never said that it started, so that it may be another program"
            raise RendererError(f"the renderer {renderer.path} ended without an image{doubt}{renderer.said()}")

    def _handle(self, event: dict[str, Any]) -> None:
        try:
            self._act_on(event)
        except (KeyError, TypeError, ValueError) as error:
            raise RendererError(
                f"the renderer sent what this add-on does not understand ({error!r} in {str(event)[:200]}); "
                "use the renderer that came with the add-on"
            ) from error

    def _act_on(self, event: dict[str, Any]) -> None:
        kind = event.get("event")
        if kind == "start":
            self.started = True
            self.scene_path.unlink(missing_ok=True)  # it has been read: should Blender be killed, no file stays behind
            for note in event.get("notes", []):
                self._warn(note)
            self._add_passes(event.get("passes", []))
        elif kind == "progress":
            self._show_progress(event)
        elif kind == "preview":
            self._show(self.preview_path)
        elif kind == "warning":
            self._warn(event["message"])
        elif kind == "done":
            self.statistics = event.get("stats", {})
            if event.get("samples") and event.get("seconds"):
                rendering.note_speed(float(event["samples"]) * self.width * self.height, float(event["seconds"]))

    def _add_passes(self, passes: list[dict[str, Any]]) -> None:
        """Those that the scene has beside the registered ones: a technique for each lobe of its surfaces."""
        registered = {p.name for p in passes_of(self.scene, self.layer)}
        self.told = {p["name"] for p in passes}
        for p in passes:
            if p["name"] not in registered:
                self.engine.add_pass(p["name"], len(p["channels"]), p["channels"], layer=self.layer.name)
        tell(self.scene, self.layer, [p["name"] for p in passes])

    def _show_progress(self, event: dict[str, Any]) -> None:
        self.engine.update_progress(event["fraction"])
        samples = f"{event['samples']}" + (f"/{event['of']}" if event.get("of") else "")
        phase = "Pilot" if event["phase"] == "pilot" else "Sample"
        left = f"Remaining: {_clock(event['left'])}" if event.get("left") is not None else ""
        self._show_text(f"{phase} {samples}", left)

    def _show(self, path: Path) -> None:
        """Loads an image into the result, which begins with the first one."""
        if self.result is None:
            self.result = self.engine.begin_result(0, 0, self.width, self.height, layer=self.layer.name)
        try:
            self._load(path)
        except RuntimeError as error:
            raise RendererError(
                f"Blender cannot read the image of the renderer as one of {self.width} x {self.height} pixels: {str(error).strip()}"
            ) from error
        self.engine.update_result(self.result)

    def _load(self, path: Path) -> None:
        """RuntimeError where the image is not of the result's size."""
        passes = self.result.layers[0].passes
        longest = max(len(f"{self.layer.name}.{p.name}.X".encode()) for p in passes)
        if longest <= compat.LONGEST_CHANNEL and all(p.name in self.told for p in passes):
            self.result.load_from_file(str(path))
            return
        there = {name.split(".")[-2] for name, _ in read_header(path).channels()}
        for render_pass in (p for p in passes if p.name in there):
            pixels = read_pass(path, render_pass.name)[::-1]
            if pixels.shape != (self.height, self.width, render_pass.channels):
                raise RuntimeError(f"{render_pass.name} has {pixels.shape[1]} x {pixels.shape[0]} pixels")
            compat.set_pixels(render_pass, np.ascontiguousarray(pixels.reshape(-1, render_pass.channels)))


def _clock(seconds: float) -> str:
    minutes, rest = divmod(max(0.0, seconds), 60)
    return f"{int(minutes):02}:{rest:05.2f}"


def register() -> None:
    bpy.utils.register_class(WARDMIS_RenderEngine)


def unregister() -> None:
    bpy.utils.unregister_class(WARDMIS_RenderEngine)
