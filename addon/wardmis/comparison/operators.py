# SPDX-License-Identifier: GPL-3.0-or-later
"""What the Compare panel's buttons do, and the key that turns the images over."""

from __future__ import annotations

import contextlib
import functools
import math
import os
import re
import types
from dataclasses import replace
from pathlib import Path
from typing import Any

import bpy
from bpy.props import EnumProperty, StringProperty

from .. import rendering, second_blender, temporary, warnings
from ..operators import export_command
from ..preferences import renderer_path
from ..process import RendererError
from ..properties import ALLOCATIONS
from ..reporting import reported
from . import child, editors, images, job, plot, properties
from .converge import OWN, Outcome, Study, arguments, enough_of, explain_half
from .cycles import require_cycles
from .estimate import Estimate, Speeds, estimate
from .folders import folder_of, home, is_unfinished
from .overrides import overridden
from .run import CYCLES_FOLDER, SCENE_NAME, check_study, divide, forget, prepare, scene_title, threads_of
from .same_scene import settle

WITHOUT_CYCLES = ". The results below are without Cycles"
KEY = "J"  # with Shift; alone it turns Blender's own render slots over


def study_of(scene: Any) -> Study:
    """What the panel says."""
    settings = scene.wardmis_comparison
    configurations = [name for name, *_ in ALLOCATIONS if name in settings.allocations]
    if settings.use_scene:
        configurations.append(OWN)
    if not configurations:
        raise RuntimeError("WardMIS: nothing is chosen to be compared; choose an allocation, or the scene's settings")
    return Study(
        configurations,
        settings.seeds,
        max_spp=settings.samples,
        budget_seconds=settings.seconds if settings.stop_by == "seconds" else None,
        title=scene_title(scene),
        threads=threads_of(scene),
    )


def percentage_of(scene: Any) -> int:
    """Of the full resolution, at which the scene is compared."""
    return max(1, round(scene.render.resolution_percentage * scene.wardmis_comparison.percentage / 100))


def size_of(scene: Any) -> tuple[int, int]:
    """Of the images that are compared, in pixels, without a border."""
    render, percentage = scene.render, percentage_of(scene)
    return max(1, render.resolution_x * percentage // 100), max(1, render.resolution_y * percentage // 100)


def estimate_of(scene: Any) -> Estimate:
    """How long what the panel says takes."""
    study = study_of(scene)
    pixels, cycles_seeds = _pixels(scene), _cycles_seeds(scene)
    threads = study.threads or os.cpu_count() or 1
    found = estimate(study, pixels, cycles_seeds, _speeds(study.title), threads)
    found.needed = max(found.needed, _refusals.get(_but_for_time(scene), 0.0))
    return found


def _pixels(scene: Any) -> int:
    render, (width, height) = scene.render, size_of(scene)
    if not render.use_border:
        return width * height
    share = (render.border_max_x - render.border_min_x) * (render.border_max_y - render.border_min_y)
    return max(1, round(width * height * share))


def _cycles_seeds(scene: Any) -> int | None:
    settings = scene.wardmis_comparison
    return int(settings.cycles_seeds) if settings.use_cycles else None


_refusals: dict[str, float] = {}  # seconds that comparisons need which were refused for want of time


def _but_for_time(scene: Any) -> str:
    """Equal for comparisons that differ in nothing else."""
    return repr((replace(study_of(scene), budget_seconds=None), _pixels(scene), _cycles_seeds(scene)))


def unfinished(scene: Any) -> bool:
    """Whether a comparison as the panel says it was begun and not finished, perhaps by a Blender that is no more."""
    return is_unfinished(home(scene), study_of(scene), scene.wardmis_comparison, scene.wardmis)


def _speeds(title: str) -> Speeds:
    """Of the last comparison of the scene, else of the last render."""
    report = properties.report()
    if report is not None and report.data.get("title") == title:
        own, cycles = report.speeds()
        return Speeds(own, cycles)
    return Speeds(rendering.speed())


def begin(context: Any) -> job.Job:
    """Starts what exports the scene and compares it. RuntimeError with a message for the user."""
    scene = context.scene
    try:
        staging = temporary.kept("comparison")
    except OSError as error:
        raise RuntimeError(
            f"WardMIS: the folder {error.filename} cannot be made: {error.strerror}; make room, or name another folder "
            "for temporary files in the preferences"
        ) from error
    asked = _Asked(context, staging)
    files = second_blender.save_copy(staging) if asked.needs_copy else []
    percentage = asked.percentage
    if second_blender.wanted():
        place = second_blender.place(context)
        warnings.begin(**place)
        command = export_command(files[0], place, percentage, staging / SCENE_NAME)
        stages = [job.Stage("the export", command, then=asked.stages)]
        started = job.start(lambda _job: stages, _finished, files)
        started.heard = lambda event: warnings.take(event, **place)
        return started
    with overridden([(scene.render, "resolution_percentage", percentage)]):
        prepare(staging, asked.study)
    return job.start(asked.stages, _finished, files)


class _Asked:
    """What the panels say when Compare is pressed, which the user may go on to change."""

    def __init__(self, context: Any, staging: Path) -> None:
        scene = context.scene
        self.settings, self.render_settings = _as_it_is(scene.wardmis_comparison), _as_it_is(scene.wardmis)
        # the limits of paths may be those of Cycles, which are the scene's too
        cycles = _as_it_is(scene.cycles) if hasattr(scene, "cycles") else None
        self.render_settings.id_data = types.SimpleNamespace(wardmis=self.render_settings, cycles=cycles)
        self.study = study_of(scene)
        check_study(self.study)
        try:
            self.binary = renderer_path()
        except RendererError as error:
            raise RuntimeError(f"WardMIS: {error}") from error
        if self.settings.use_cycles:
            require_cycles(scene)
        self.home = home(scene)
        self.percentage = percentage_of(scene)
        self.estimate = estimate_of(scene)
        self.but_for_time = _but_for_time(scene)
        self.staging = staging
        self.needs_copy = self.settings.use_cycles or second_blender.wanted()
        self._cycles = functools.partial(
            child.command, staging / second_blender.COPY, second_blender.place(context), self.percentage
        )

    def stages(self, comparison: job.Job) -> list[job.Stage]:
        """Once the scene is exported into the staging folder, which decides where the results go."""
        settings, study = self.settings, self.study
        exported = self.staging / SCENE_NAME
        folder = folder_of(self.home, study, settings, self.render_settings, exported)
        new = not folder.exists()
        try:
            folder.mkdir(parents=True, exist_ok=True)
            settle(exported, folder / SCENE_NAME)
        except OSError as error:
            raise RuntimeError(
                f"WardMIS: the folder {folder} cannot be written: {error.strerror}; choose another in the panel"
            ) from error
        outcome = Outcome(folder, folder / SCENE_NAME)
        comparison.folder = folder
        comparison.failed = functools.partial(_failed, outcome, new)
        if not settings.use_cycles:
            return [self._own(study, outcome, self.estimate.own)]
        stages = []
        plan, study = divide(study, settings.cycles_seeds, None, settings.cycles_as_is)
        seconds = self.estimate.own
        if study.budget_seconds is not None:  # finds out how many samples there are to be
            stages.append(self._own(study, outcome, seconds))
            seconds = 0.0
        renders = folder / CYCLES_FOLDER
        outcome.manifest = renders / "manifest.json"
        command = self._cycles(renders, outcome.scene, plan)
        stages.append(job.Stage("Cycles", command, self._refused, self.estimate.cycles))
        return [*stages, self._own(study, outcome, seconds)]

    def _own(self, study: Study, outcome: Outcome, seconds: float) -> job.Stage:
        command = [str(self.binary), *arguments(study, self.render_settings, outcome)]
        return job.Stage("the renderer", command, self._refused, seconds)

    def _refused(self, message: str) -> str:
        """A failure in the panel's words; of what a comparison needs, the estimate knows from now on."""
        message = explain_half(message) if self.settings.use_cycles else message
        enough = enough_of(message)
        if enough is not None:
            _refusals[self.but_for_time] = enough
        whose = "WardMIS' half of the time" if self.settings.use_cycles else "the time"
        message = re.sub(r"--budget-seconds ([\d.e+]+):", rf"{whose}, \1 s, is too little:", message)
        message = re.sub(r"^.* failed \(exit code 2\): ", "", message)
        message = re.sub(r",? and another output folder; .* keeps the report without it", WITHOUT_CYCLES, message)
        for ours, panels in (("--seeds", "seeds"), ("--resolution", "resolution"), ("configurations", "allocations")):
            message = message.replace(ours, panels)
        return message


def _as_it_is(group: Any) -> Any:
    """The values of a property group, which do not change with it."""
    return types.SimpleNamespace(**{p.identifier: getattr(group, p.identifier) for p in group.bl_rna.properties})


def _failed(outcome: Outcome, new: bool) -> None:
    """Of what has rendered nothing nothing stays; a report that there is already, as that without Cycles, is shown."""
    if new:
        forget(outcome)
    if outcome.report_json.is_file():
        with contextlib.suppress(RuntimeError):
            show(outcome.folder)


def _finished(done: job.Job) -> None:
    if done.folder is not None:
        show(done.folder)


def show(folder: Path) -> None:
    """Results as images, in an Image Editor where there is one."""
    report = properties.show_report(folder)
    curves = report.curves()
    if plot.available() and curves:
        drawn = plot.draw(curves, str(report.data.get("title", "")), report.metric, report.clock)
        images.put(images.PLOT, drawn, "error against time", srgb=True)
    editors.show(bpy.data.images[images.NAMES[properties.results().view]])


class WARDMIS_OT_compare(bpy.types.Operator):
    bl_idname = "wardmis.compare"
    bl_label = "Compare"
    bl_description = (
        "Render the scene with every chosen configuration, and by Cycles, and say which has the least "
        "noise for its time. It runs in the background, and Blender can be used meanwhile"
    )

    @classmethod
    def poll(cls, _context: Any) -> bool:
        return not job.running()

    @reported
    def execute(self, context: Any) -> set[str]:
        begin(context)
        return {"FINISHED"}


class WARDMIS_OT_compare_cancel(bpy.types.Operator):
    bl_idname = "wardmis.compare_cancel"
    bl_label = "Cancel"
    bl_description = (
        "Stop, and report what is done if that is enough for a report. Pressed again: stop at once, "
        "without one. Compare goes on from there"
    )

    @classmethod
    def poll(cls, _context: Any) -> bool:
        return job.running()

    def execute(self, _context: Any) -> set[str]:
        current = job.current()
        if current is not None:
            current.cancel()
        return {"FINISHED"}


class WARDMIS_OT_compare_open(bpy.types.Operator):
    bl_idname = "wardmis.compare_open"
    bl_label = "Open Results..."
    bl_description = "Show the results of an earlier comparison: choose the folder that it has made"

    directory: StringProperty(subtype="DIR_PATH")
    filter_folder: bpy.props.BoolProperty(default=True, options={"HIDDEN"})

    def invoke(self, context: Any, _event: Any) -> set[str]:
        self.directory = str(home(context.scene)) + "/"
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    @reported
    def execute(self, _context: Any) -> set[str]:
        show(Path(bpy.path.abspath(self.directory)))
        return {"FINISHED"}


class _OfResults:
    """An operator on the results that are shown."""

    @classmethod
    def poll(cls, _context: Any) -> bool:
        return properties.report() is not None


class WARDMIS_OT_compare_view(_OfResults, bpy.types.Operator):
    bl_idname = "wardmis.compare_view"
    bl_label = "Show"
    bl_description = "Show this image of the comparison in the Image Editor"

    view: EnumProperty(
        items=[
            *properties.VIEWS,
            ("PLOT", "Plot", "Error against time"),
            ("NEXT", "Next", "A, B, their difference, and A again"),
        ],
        default="NEXT",
    )

    @reported
    def execute(self, _context: Any) -> set[str]:
        chosen = properties.results()
        view = self.view
        if view == "NEXT":
            order = [name for name, *_ in properties.VIEWS]
            view = order[(order.index(chosen.view) + 1) % len(order)]
        if view != "PLOT":
            chosen.view = view
        if images.NAMES[view] not in bpy.data.images:  # removed, or undone
            properties.reload_images()
        if images.NAMES[view] not in bpy.data.images:
            self.report({"WARNING"}, "WardMIS: there is no plot; Blender draws it in a window alone. The report has it")
            return {"CANCELLED"}
        editors.show(bpy.data.images[images.NAMES[view]])
        return {"FINISHED"}


class WARDMIS_OT_compare_use(bpy.types.Operator):
    bl_idname = "wardmis.compare_use"
    bl_label = "Use This"
    bl_description = (
        "Set the scene to what the comparison recommends: its allocation, weights and other settings of the sampling"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, _context: Any) -> bool:
        report = properties.report()
        return report is not None and report.recommended is not None

    def execute(self, context: Any) -> set[str]:
        report = properties.report()
        if report is None or report.recommended is None:
            return {"CANCELLED"}
        for name, value in report.settings(report.recommended).items():
            setattr(context.scene.wardmis, name, value)
        return {"FINISHED"}


def is_used(settings: Any, report: Any) -> bool:
    """Whether the scene is set to what `report` recommends."""
    wanted = report.settings(report.recommended)
    return all(
        math.isclose(getattr(settings, name), value, rel_tol=1e-5)
        if isinstance(value, float)
        else getattr(settings, name) == value
        for name, value in wanted.items()
    )


class WARDMIS_OT_compare_close(_OfResults, bpy.types.Operator):
    bl_idname = "wardmis.compare_close"
    bl_label = "Close Results"
    bl_description = "Remove the comparison's images from Blender. The folder keeps everything, for Open Results"

    def execute(self, _context: Any) -> set[str]:
        properties.forget_report()
        return {"FINISHED"}


class WARDMIS_OT_compare_report(_OfResults, bpy.types.Operator):
    bl_idname = "wardmis.compare_report"
    bl_label = "Open Report"
    bl_description = "Open the report in the browser: every figure, the curves, and the images under a magnifier"

    def execute(self, _context: Any) -> set[str]:
        report = properties.report()
        if report is None or not report.html.is_file():
            self.report({"ERROR"}, "WardMIS: the report is gone; compare again")
            return {"CANCELLED"}
        bpy.ops.wm.url_open(url=report.html.as_uri())
        return {"FINISHED"}


_CLASSES = (
    WARDMIS_OT_compare,
    WARDMIS_OT_compare_cancel,
    WARDMIS_OT_compare_open,
    WARDMIS_OT_compare_view,
    WARDMIS_OT_compare_use,
    WARDMIS_OT_compare_close,
    WARDMIS_OT_compare_report,
)
_register_classes, _unregister_classes = bpy.utils.register_classes_factory(_CLASSES)
_keys: list[tuple[Any, Any]] = []


def key_text() -> str:
    """What turns the images over, as the user has it now; empty: no key does."""
    for _keymap, item in _keys:
        user = bpy.context.window_manager.keyconfigs.user.keymaps["Image Generic"].keymap_items
        now = next((i for i in user if i.idname == item.idname and i.active), None)
        return now.to_string() if now is not None else ""
    return ""


def register() -> None:
    _register_classes()
    configuration = bpy.context.window_manager.keyconfigs.addon
    if configuration is not None:  # there is none in the background
        keymap = configuration.keymaps.new(name="Image Generic", space_type="IMAGE_EDITOR")
        _keys.append((keymap, keymap.keymap_items.new(WARDMIS_OT_compare_view.bl_idname, KEY, "PRESS", shift=True)))


def unregister() -> None:
    for keymap, item in _keys:
        keymap.keymap_items.remove(item)
    _keys.clear()
    _unregister_classes()
