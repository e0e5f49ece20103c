# SPDX-License-Identifier: GPL-3.0-or-later
"""What is compared, `scene.wardmis_comparison`, and which of its results are looked at, `window_manager.wardmis_results`.

The latter are no data of the file: they must neither be undone nor saved.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from ..properties import ALLOCATIONS
from . import images
from .colours import SMALLEST_TOP
from .converge import DEFAULT_CONFIGURATIONS
from .report import Report

STOPS = (
    ("samples", "Samples", "Renders of 1, 2, 4 ... samples per pixel up to a number"),
    ("seconds", "Time", "As many renders as a time allows; with Cycles, half of it is Cycles'"),
)
VIEWS = (
    ("A", "A", "The first image, chosen above as A"),
    ("B", "B", "The second image, chosen above as B"),
    (
        "DIFFERENCE",
        "Difference",
        "How far A is from B at each pixel, relative to the brightness of B, in colours that a scale beside explains",
    ),
)

_report: Report | None = None
_choosing = False  # both images are being chosen
_items: list[tuple[str, str, str]] = []  # Blender keeps no copy of the texts of a list that is made by a function


class WARDMIS_PG_comparison(bpy.types.PropertyGroup):
    allocations: EnumProperty(
        name="Allocations",
        description="The allocations to compare, each with the weights that go with it; everything else is as set in "
        "the panels above",
        items=[(name, label, text, 1 << i) for i, (name, label, text) in enumerate(ALLOCATIONS)],
        default=set(DEFAULT_CONFIGURATIONS),
        options={"ENUM_FLAG"},
    )
    use_scene: BoolProperty(
        name="Scene's Settings",
        description="Compare what is set in the panels above, its weights included, as one more configuration",
        default=False,
    )
    stop_by: EnumProperty(name="Stop by", description="What ends the comparison", items=STOPS, default="seconds")
    samples: IntProperty(
        name="Samples", description="The largest number of samples in each pixel", default=64, min=2, soft_max=4096
    )
    seconds: FloatProperty(
        name="Seconds",
        description="Time for everything, the reference and Cycles included. Where it does not suffice for all seeds "
        "there are fewer",
        default=120.0,
        min=1.0,
        soft_max=36000.0,
        max=1e7,
        precision=0,
    )
    percentage: IntProperty(
        name="Resolution",
        description="Of the scene's resolution. Which allocation is best hardly depends on it, and the time does",
        default=50,
        min=1,
        max=100,
        subtype="PERCENTAGE",
    )
    seeds: IntProperty(
        name="Seeds",
        description="How often each configuration is rendered, each time with other noise: what is better by chance "
        "is told from what is better",
        default=16,
        min=2,
        soft_max=64,
        max=10000,
    )
    use_cycles: BoolProperty(
        name="Cycles",
        description="Compare with Cycles, on the processor, in a second Blender in the background",
        default=True,
    )
    cycles_seeds: IntProperty(
        name="Seeds",
        description="How often Cycles renders, each time with other noise",
        default=16,
        min=2,
        soft_max=64,
        max=10000,
    )
    cycles_as_is: BoolProperty(
        name="As Set",
        description="Cycles with the scene's settings for it. Off: everything by which its image differs from what it "
        "converges to (clamping, adaptive sampling, denoising ...) is off, and paths are as long as WardMIS'",
        default=False,
    )
    folder: StringProperty(
        name="Folder",
        description="Each comparison gets a folder in it. Empty: beside the file, or in the folder for temporary "
        "files where there is none",
        subtype="DIR_PATH",
    )


def checkbox(allocation: str) -> str:
    """The property by which an allocation is chosen on its own: a click into a list of several would leave the others out."""
    return "use_" + allocation.replace("-", "_")


def _checkbox(allocation: str, label: str, text: str) -> Any:
    def get(self: Any) -> bool:
        return allocation in self.allocations

    def set_(self: Any, value: bool) -> None:
        self.allocations = self.allocations | {allocation} if value else self.allocations - {allocation}

    return BoolProperty(name=label, description=text, get=get, set=set_)


WARDMIS_PG_comparison.__annotations__.update({checkbox(item[0]): _checkbox(*item) for item in ALLOCATIONS})


def _image_items(_self: Any, _context: Any) -> list[tuple[str, str, str]]:
    return _items


def _changed(self: Any, _context: Any) -> None:
    """Another image was chosen."""
    if _choosing:
        return
    self.failure = ""
    try:
        reload_images()
    except RuntimeError as error:
        self.failure = str(error)


def _scaled(self: Any, context: Any) -> None:
    """The user chose the scale."""
    if not _choosing and self.fit:
        self.fit = False  # which makes the images anew
    else:
        _changed(self, context)


class WARDMIS_PG_results(bpy.types.PropertyGroup):
    a: EnumProperty(
        name="A",
        description="The configuration whose result is the image WardMIS A",
        items=_image_items,
        update=_changed,
    )
    b: EnumProperty(
        name="B",
        description="The configuration whose result is the image WardMIS B, or the reference, which has the least noise",
        items=_image_items,
        update=_changed,
    )
    top: FloatProperty(
        name="Scale",
        description="The relative difference of a pixel that has the brightest colour: 0.1 is a tenth of its "
        "brightness in B",
        default=0.5,
        min=SMALLEST_TOP,
        soft_max=10.0,
        precision=4,
        update=_scaled,
    )
    fit: BoolProperty(
        name="Fit",
        description="Choose the scale for each pair of images so that their differences are seen. Off: keep it, to "
        "compare pairs",
        default=True,
        update=_changed,
    )
    view: EnumProperty(
        name="View",
        description="The image that the Image Editor shows: A, B or their difference",
        items=VIEWS,
        default="A",
    )
    failure: StringProperty(description="Why the images could not be made")


def results() -> Any:
    return bpy.context.window_manager.wardmis_results


def report() -> Report | None:
    """The one whose results are shown."""
    return _report


def show_report(folder: Path) -> Report:
    """Shows the results in `folder`, the baseline against the reference. RuntimeError if there are none."""
    global _report, _items, _choosing
    new = Report(folder)
    names = new.image_names
    if not names:
        raise RuntimeError(f"WardMIS: {folder} has a report and no images; compare again")
    _report, _items = new, [(name, name, "") for name in names]
    chosen = results()
    _choosing = True  # each of the two would load both images
    chosen.a, chosen.b, chosen.failure, chosen.fit = names[0], names[-1], "", True
    _choosing = False
    reload_images()
    return new


def forget_report() -> None:
    global _report, _items
    _report, _items = None, []
    images.forget()


def reload_images() -> None:
    global _choosing
    chosen = results()
    if _report is not None and chosen.a and chosen.b:
        top = images.load(_report, chosen.a, chosen.b, None if chosen.fit else chosen.top)
        _choosing = True
        chosen.top = top
        _choosing = False


@bpy.app.handlers.persistent
def _on_load(*_: Any) -> None:
    forget_report()  # its images were the old file's


_CLASSES = (WARDMIS_PG_comparison, WARDMIS_PG_results)
_register_classes, _unregister_classes = bpy.utils.register_classes_factory(_CLASSES)


def register() -> None:
    _register_classes()
    bpy.types.Scene.wardmis_comparison = PointerProperty(type=WARDMIS_PG_comparison)
    bpy.types.WindowManager.wardmis_results = PointerProperty(type=WARDMIS_PG_results)
    bpy.app.handlers.load_pre.append(_on_load)


def unregister() -> None:
    forget_report()
    bpy.app.handlers.load_pre.remove(_on_load)
    del bpy.types.WindowManager.wardmis_results
    del bpy.types.Scene.wardmis_comparison
    _unregister_classes()
