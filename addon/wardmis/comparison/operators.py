# SPDX-License-Identifier: GPL-3.0-or-later
"""What the Compare panel's buttons do, and the key that turns the images over."""

from __future__ import annotations

import dataclasses
import hashlib
import re
import tempfile
from pathlib import Path
from typing import Any

import bpy
from bpy.props import EnumProperty, StringProperty

from ..preferences import renderer_path
from ..process import RendererError
from ..properties import ALLOCATIONS
from . import child, images, job, plot, properties
from .converge import OWN, Outcome, Study, arguments, explain_half
from .cycles import require_cycles
from .run import CYCLES_FOLDER, SCENE_NAME, divide, forget, prepare, scene_title, threads_of
from .same_scene import same_but_for_rounding, settle
from .scene_file import read_scene_file

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


def home(scene: Any) -> Path:
    """The folder in which comparisons get theirs."""
    chosen = scene.wardmis_comparison.folder
    if chosen and (bpy.data.filepath or not chosen.startswith("//")):
        return Path(bpy.path.abspath(chosen))
    if bpy.data.filepath:
        return Path(bpy.data.filepath).with_suffix("").with_name(f"{Path(bpy.data.filepath).stem} comparisons")
    return Path(tempfile.gettempdir()) / "wardmis comparisons"  # not Blender's own, which goes when it ends


def begin(context: Any) -> job.Job:
    """Exports the scene, and starts what compares it. RuntimeError with a message for the user."""
    scene = context.scene
    settings = scene.wardmis_comparison
    study = study_of(scene)
    try:
        binary = renderer_path()
    except RendererError as error:
        raise RuntimeError(f"WardMIS: {error}") from error
    if settings.use_cycles:
        require_cycles(scene)
        _check_unsaved_images()
    staging = Path(bpy.app.tempdir) / "wardmis-comparison"
    exported = prepare(staging, study).scene
    folder = _folder(home(scene), study, settings, scene.wardmis, exported)
    new = not folder.exists()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        settle(exported, folder / SCENE_NAME)
    except OSError as error:
        raise RuntimeError(
            f"WardMIS: the folder {folder} cannot be written: {error.strerror}; choose another in the panel"
        ) from error
    outcome = Outcome(folder, folder / SCENE_NAME)
    stages, temporary = [], []

    def own() -> job.Stage:
        command = [str(binary), *arguments(study, scene.wardmis, outcome)]
        return job.Stage("the renderer", command, explain_half if settings.use_cycles else str)

    if settings.use_cycles:
        plan, study = divide(study, settings.cycles_seeds, None, settings.cycles_as_is)
        blend = staging / "scene.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(blend), copy=True, compress=False)
        temporary.append(blend)
        if study.budget_seconds is not None:  # finds out how many samples there are to be
            stages.append(own())
        renders = folder / CYCLES_FOLDER
        outcome.manifest = renders / "manifest.json"
        layer = context.view_layer.name
        stages.append(job.Stage("Cycles", child.command(blend, scene.name, layer, renders, outcome.scene, plan)))
    stages.append(own())
    return job.start(folder, stages, _finished, temporary, (lambda: forget(outcome)) if new else None)


def _folder(place: Path, study: Study, settings: Any, render_settings: Any, exported: Path) -> Path:
    """The same comparison goes on in the same folder, also with more seeds; another one begins its own."""
    what = arguments(dataclasses.replace(study, seeds=0), render_settings, Outcome(Path(), Path()))
    what.append(f"{settings.use_cycles} {settings.cycles_as_is}")
    title = re.sub(r"[^\w.-]+", "_", study.title)  # of any letters, but no signs that a folder's name cannot have
    name = f"{title}-{hashlib.sha256(chr(0).join(what).encode()).hexdigest()[:8]}"
    # the export's own hash would tell apart what is the same but for the last bits
    for earlier in sorted(place.glob(f"{name}-*")):
        if same_but_for_rounding(exported, earlier / SCENE_NAME):
            return earlier
    return place / f"{name}-{read_scene_file(exported).sha256[:8]}"


def _check_unsaved_images() -> None:
    """The other Blender reads images from their files."""
    for image in bpy.data.images:
        if image.is_dirty and image.users and image.source != "VIEWER" and not images.ours(image):
            raise RuntimeError(
                f"WardMIS: image '{image.name}' has changes that Cycles would not see, since it runs in a second Blender; "
                "save or pack the image, or compare without Cycles"
            )


def _finished(done: job.Job) -> None:
    show(done.folder)


def show(folder: Path) -> None:
    """Results as images, in an Image Editor where there is one."""
    report = properties.show_report(folder)
    curves = report.curves()
    if plot.available() and curves:
        drawn = plot.draw(curves, str(report.data.get("title", "")), report.metric, report.clock)
        images.put(images.PLOT, drawn, "error against time", srgb=True)
    _put_into_editors(properties.results().view)


def _put_into_editors(view: str) -> None:
    """Into those that show one of ours, else into the one under the pointer."""
    image = bpy.data.images.get(images.NAMES[view])
    spaces = [
        area.spaces.active
        for window in bpy.context.window_manager.windows
        for area in window.screen.areas
        if area.type == "IMAGE_EDITOR"
    ]
    showing = [space for space in spaces if space.image is not None and images.ours(space.image)]
    here = getattr(bpy.context, "space_data", None)
    if not showing and here in spaces:
        showing = [here]
    for space in showing or spaces[:1]:
        space.image = image


class WARDMIS_OT_compare(bpy.types.Operator):
    bl_idname = "wardmis.compare"
    bl_label = "Compare"
    bl_description = "Render the scene with every chosen configuration, and by Cycles, in the background, until it is known which is best"

    @classmethod
    def poll(cls, _context: Any) -> bool:
        return not job.running()

    def execute(self, context: Any) -> set[str]:
        try:
            begin(context)
        except RuntimeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class WARDMIS_OT_compare_cancel(bpy.types.Operator):
    bl_idname = "wardmis.compare_cancel"
    bl_label = "Cancel"
    bl_description = "Stop, with a report of what is done if that is enough for one; once more stops without"

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
    bl_description = "Show the results of an earlier comparison, from its folder"

    directory: StringProperty(subtype="DIR_PATH")
    filter_folder: bpy.props.BoolProperty(default=True, options={"HIDDEN"})

    def invoke(self, context: Any, _event: Any) -> set[str]:
        self.directory = str(home(context.scene)) + "/"
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, _context: Any) -> set[str]:
        try:
            show(Path(bpy.path.abspath(self.directory)))
        except RuntimeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class WARDMIS_OT_compare_view(bpy.types.Operator):
    bl_idname = "wardmis.compare_view"
    bl_label = "Show"
    bl_description = "Show one of the comparison's images in the Image Editor"

    view: EnumProperty(
        items=[
            *properties.VIEWS,
            ("PLOT", "Plot", "Error against time"),
            ("NEXT", "Next", "A, B, their difference, and A again"),
        ],
        default="NEXT",
    )

    @classmethod
    def poll(cls, _context: Any) -> bool:
        return properties.report() is not None

    def execute(self, _context: Any) -> set[str]:
        chosen = properties.results()
        view = self.view
        if view == "NEXT":
            order = [name for name, *_ in properties.VIEWS]
            view = order[(order.index(chosen.view) + 1) % len(order)]
        if view != "PLOT":
            chosen.view = view
        try:
            if images.NAMES[view] not in bpy.data.images:  # removed, or undone
                properties.reload_images()
        except RuntimeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if images.NAMES[view] not in bpy.data.images:
            self.report({"WARNING"}, "WardMIS: there is no plot; Blender draws it in a window alone. The report has it")
            return {"CANCELLED"}
        _put_into_editors(view)
        return {"FINISHED"}


class WARDMIS_OT_compare_report(bpy.types.Operator):
    bl_idname = "wardmis.compare_report"
    bl_label = "Open Report"
    bl_description = "Open the report in the browser: every figure, the curves, and the images under a magnifier"

    @classmethod
    def poll(cls, _context: Any) -> bool:
        return properties.report() is not None

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
    WARDMIS_OT_compare_report,
)
_keys: list[tuple[Any, Any]] = []


def register() -> None:
    for cls in _CLASSES:
        bpy.utils.register_class(cls)
    configuration = bpy.context.window_manager.keyconfigs.addon
    if configuration is not None:  # there is none in the background
        keymap = configuration.keymaps.new(name="Image Generic", space_type="IMAGE_EDITOR")
        _keys.append((keymap, keymap.keymap_items.new(WARDMIS_OT_compare_view.bl_idname, KEY, "PRESS", shift=True)))


def unregister() -> None:
    for keymap, item in _keys:
        keymap.keymap_items.remove(item)
    _keys.clear()
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
