# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' part of a comparison in the second Blender: each render is kept as soon as it is done, so that it can be ended at any time."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import bpy

from .. import second_blender
from .cycles import CyclesPlan, render_cycles
from .scene_file import read_scene_file


def command(
    blend: Path, place: dict[str, str], percentage: int, folder: Path, scene_file: Path, plan: CyclesPlan
) -> list[str]:
    """`percentage`: of the resolution, that the scene file was made with."""
    return second_blender.command(
        blend,
        place,
        "comparison.child",
        percentage=percentage,
        folder=str(folder),
        scene_file=str(scene_file),
        plan=dataclasses.asdict(plan),
    )


def run_task(tell: second_blender.Tell, percentage: int, folder: str, scene_file: str, plan: dict[str, Any]) -> None:
    bpy.context.scene.render.resolution_percentage = percentage
    render_cycles(Path(folder), read_scene_file(Path(scene_file)), CyclesPlan(**plan), tell)
