# SPDX-License-Identifier: GPL-3.0-or-later
"""The Compare panel: in the render properties, and in the Image Editor's sidebar, where its results are a panel of their own."""

from __future__ import annotations

from typing import Any

import bpy

from .. import compat
from ..layout import draw_text, is_narrow
from ..panels import RenderPanel
from ..properties import ALLOCATIONS
from . import job, operators, properties
from .estimate import duration

UNFINISHED = "Begun before, and not finished: Compare goes on from there, if the scene is still the same"
VERDICT_ICONS = {
    "faster": "CHECKMARK",
    "slower": "X",
    "no difference found": "REMOVE",
    "target not surely reached": "QUESTION",
    "under the target from the start": "SORTTIME",
    "the baseline has no time": "CANCEL",
}


def draw_choices(layout: Any, settings: Any) -> None:
    """Configurations, and how much of each."""
    narrow = is_narrow()
    body = layout.column()
    body.enabled = not job.running()
    body.use_property_split = not narrow
    body.use_property_decorate = False
    grid = body.grid_flow(columns=1 if narrow else 2, align=True)
    grid.use_property_split = False
    for name, *_ in ALLOCATIONS:
        grid.prop(settings, properties.checkbox(name))
    grid.prop(settings, "use_scene")
    body.row().prop(settings, "stop_by", expand=True)
    body.prop(settings, settings.stop_by)
    body.prop(settings, "percentage")
    body.prop(settings, "seeds")
    if narrow:
        column = body.column()
        column.prop(settings, "use_cycles", text="Compare With Cycles")
    else:
        column = body.column(heading="Cycles")
        column.prop(settings, "use_cycles", text="Compare With")
    sub = column.column()
    sub.active = settings.use_cycles
    sub.prop(settings, "cycles_as_is")
    sub.prop(settings, "cycles_seeds", text="Seeds of Cycles" if narrow else "Seeds")
    if narrow:
        body.label(text="Folder:")
        body.prop(settings, "folder", text="")
    else:
        body.prop(settings, "folder")


def estimate_text(scene: Any) -> str:
    """What pressing Compare means."""
    try:
        found = operators.estimate_of(scene)
    except RuntimeError:  # nothing is chosen
        return ""
    width, height = operators.size_of(scene)
    text = f"About {duration(found.seconds)} at {width} × {height}"
    if found.cycles:
        text += f", {duration(found.cycles)} of it for Cycles"
    if found.needed > found.seconds:
        return (
            f"{text}. Too little here: at least {duration(found.needed)}, or a lower resolution, or fewer allocations"
        )
    if not found.guessed:
        return text
    if scene.wardmis_comparison.stop_by == "seconds":
        return f"{text}. Whether that is enough is known after a render (F12)"
    return f"{text}. A guess: after a render (F12) it is better known"


def draw_progress(layout: Any, scene: Any) -> None:
    current = job.current()
    if job.running() and current is not None:
        compat.progress_bar(layout, current.fraction)
        draw_text(layout, current.text, "TIME")
        layout.operator(operators.WARDMIS_OT_compare_cancel.bl_idname, icon="CANCEL")
        return
    text = estimate_text(scene)
    if text:
        draw_text(layout, text, "TIME")
    row = layout.row()
    row.scale_y = 1.3
    row.operator(operators.WARDMIS_OT_compare.bl_idname, icon="RENDER_STILL")
    layout.operator(operators.WARDMIS_OT_compare_open.bl_idname, icon="FILE_FOLDER")
    if current is not None and current.failure:
        draw_text(layout, current.failure, "ERROR")
    elif current is not None and current.stopping:
        draw_text(layout, current.text, "INFO")
    elif text and operators.unfinished(scene):
        draw_text(layout, UNFINISHED, "INFO")


def draw_results(layout: Any) -> None:
    report, chosen = properties.report(), properties.results()
    if report is None:
        return
    _draw_verdict(layout.box(), report)
    view = operators.WARDMIS_OT_compare_view.bl_idname
    column = layout.column(align=True)
    column.prop(chosen, "a")
    column.prop(chosen, "b")
    scale = column.row(align=True)
    scale.prop(chosen, "top")
    scale.prop(chosen, "fit", toggle=True)
    row = layout.row(align=True)
    for name, label in (("A", "A"), ("B", "B"), ("DIFFERENCE", "Diff")):
        row.operator(view, text=label, depress=chosen.view == name).view = name
    if operators.key_text():
        draw_text(layout, f"{operators.key_text()} over the image: the next of the three")
    if chosen.failure:
        draw_text(layout, chosen.failure, "ERROR")
    _draw_table(layout.box(), report)
    column = layout.column(align=True)
    column.operator(view, text="Plot", icon="GRAPH").view = "PLOT"
    column.operator(operators.WARDMIS_OT_compare_report.bl_idname, icon="URL")
    column.operator(operators.WARDMIS_OT_compare_close.bl_idname, icon="X")


def _draw_verdict(box: Any, report: Any) -> None:
    if not report.verdict:  # an earlier report
        return
    draw_text(box, report.verdict, "INFO")
    if report.recommended is not None:
        row = box.row()
        used = operators.is_used(bpy.context.scene.wardmis, report)
        row.enabled = not used
        text = "In Use" if used else operators.WARDMIS_OT_compare_use.bl_label
        row.operator(operators.WARDMIS_OT_compare_use.bl_idname, text=text, icon="CHECKMARK")


def _draw_table(box: Any, report: Any) -> None:
    """The name of a configuration, and its figures below: the sidebar is narrow."""
    seconds, target, rows = report.equal_seconds, report.target, report.rows()
    baseline = report.data.get("baseline", "")
    if seconds is not None:
        kind = " of CPU time" if report.clock == "cpu" else ""
        draw_text(box, f"{report.metric} after {seconds:.3g} s{kind}; its ratio to that of {baseline}, 95 %:")
    if not report.data.get("complete", True):
        draw_text(box, "Of a comparison that was stopped", "INFO")
    table = box.column(align=True)
    for row in rows:
        table.label(text=row.name, icon=VERDICT_ICONS.get(row.verdict, "BLANK1"))
        figures = f"{row.error} × {row.ratio}" if row.ratio else row.error
        if figures:
            draw_text(table, figures, "BLANK1")
    for why in report.why:
        draw_text(box, why)
    verdicts = [verdict for verdict in VERDICT_ICONS if any(row.verdict == verdict for row in rows)]
    if not verdicts:
        return
    legend = box.column(align=True)
    legend.active = False
    draw_text(legend, legend_text(report.metric, target, baseline))
    for verdict in verdicts:
        legend.label(text=verdict, icon=VERDICT_ICONS[verdict])


def legend_text(metric: str, target: float | None, baseline: str) -> str:
    """What the signs beside the configurations are about."""
    until = "the target" if target is None else f"a {metric} of {target:.3g}"
    return f"The signs: whether {until} is reached faster than by {baseline}"


class WARDMIS_RENDER_PT_compare(RenderPanel, bpy.types.Panel):
    bl_label = "Compare"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        draw_choices(self.layout, context.scene.wardmis_comparison)
        draw_progress(self.layout, context.scene)
        draw_results(self.layout)


class WARDMIS_IMAGE_PT_compare(bpy.types.Panel):
    bl_label = "Compare"
    bl_space_type = "IMAGE_EDITOR"
    bl_region_type = "UI"
    bl_category = "WardMIS"
    layout: Any

    def draw(self, context: Any) -> None:
        draw_choices(self.layout, context.scene.wardmis_comparison)
        draw_progress(self.layout, context.scene)


class WARDMIS_IMAGE_PT_results(bpy.types.Panel):
    """Apart, so that the choices can be folded away while the images are looked at."""

    bl_label = "Results"
    bl_space_type = "IMAGE_EDITOR"
    bl_region_type = "UI"
    bl_category = "WardMIS"
    layout: Any

    @classmethod
    def poll(cls, _context: Any) -> bool:
        return properties.report() is not None

    def draw(self, _context: Any) -> None:
        self.layout.use_property_split = not is_narrow()
        self.layout.use_property_decorate = False
        draw_results(self.layout)


_CLASSES = (WARDMIS_RENDER_PT_compare, WARDMIS_IMAGE_PT_compare, WARDMIS_IMAGE_PT_results)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
