# SPDX-License-Identifier: GPL-3.0-or-later
"""The radiance of a Sky Texture node, as this Blender's own Cycles has it: asked of a second Blender without windows.

The models' data belong to Cycles, which gives them in no other way. It renders one sample a pixel, each of one direction that is
chosen here: without noise, the same every time. The user's session takes no part. It takes two or three seconds; the last skies of this
session are kept in its temporary folder, so that a sky is measured once and not for every render or frame.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from .. import temporary
from ..process import Renderer, RendererError
from .context import ExportContext

COLUMNS, ROWS = 512, 256  # of the sky: even steps in azimuth, and in the root of the height (as Nishita's has it)
DISC = 64  # texels a side of the sun's disc
SMALLEST_DISC = 5e-4  # radians: Cycles makes no smaller ones
SECONDS = 120.0  # to wait
KEPT = 32  # skies, of 1.6 MB
NAME = "a second Blender, in which Cycles was to render it,"  # what messages call it

_gave_no_answer = False  # within SECONDS: every frame of an animation would wait as long


class NotMeasured(Exception):
    """The message says why."""


@dataclass
class MeasuredSky:
    """`sky`: (ROWS, COLUMNS, 3) without the sun's disc, the first row straight down, the others as in directions().

    `disc`: (DISC, DISC, 3), what the disc adds in the square around it, in a plane that is orthogonal to the direction of the sun:
    `axes` are the square's own, and that direction, in the sky's coordinates; `size` is its full angle. Around the disc it is as at
    its rim. None: there is none, or it has set.
    """

    sky: np.ndarray
    disc: np.ndarray | None
    axes: np.ndarray
    size: float


def measured(node: Any, context: ExportContext) -> MeasuredSky:
    """Raises NotMeasured, and ExportCancelled."""
    settings = _settings(node)
    key = json.dumps(settings, sort_keys=True)
    if key not in context.skies:
        try:
            context.skies[key] = _found(settings, f"{hashlib.sha256(key.encode()).hexdigest()}.npz", context)
        except (NotMeasured, RendererError) as error:
            context.skies[key] = str(error)
        except (OSError, ValueError, KeyError) as error:
            context.skies[key] = f"{NAME} left nothing that can be read ({error})"
    sky = context.skies[key]
    if isinstance(sky, str):
        raise NotMeasured(sky)
    return sky


def _settings(node: Any) -> dict[str, Any]:
    """What makes a sky, and nothing of how it is looked at."""
    common = {p.identifier for p in bpy.types.ShaderNode.bl_rna.properties}
    settings = {}
    for p in node.bl_rna.properties:
        if p.identifier in common or p.type not in {"BOOLEAN", "INT", "FLOAT", "ENUM"}:
            continue
        value = getattr(node, p.identifier)
        settings[p.identifier] = value if isinstance(value, (bool, int, float, str)) else list(value)
    return settings


def _size(settings: dict[str, Any]) -> float:
    """The full angle of the sun's disc, in radians; 0: there is none."""
    if settings["sky_type"] in {"PREETHAM", "HOSEK_WILKIE"} or not settings["sun_disc"]:
        return 0.0
    return max(float(settings["sun_size"]), SMALLEST_DISC)


def directions() -> np.ndarray:
    """(ROWS, COLUMNS, 3): of the sky's texels, u = (azimuth from +x over a full turn), v = (1 + sign(h) sqrt|h|)/2, h in quarter turns."""
    azimuth = 2.0 * np.pi * (np.arange(COLUMNS) + 0.5) / COLUMNS
    v = 2.0 * (np.arange(ROWS) + 0.5) / ROWS - 1.0
    height = np.copysign(v * v, v) * np.pi / 2.0
    height, azimuth = np.meshgrid(height, azimuth, indexing="ij")
    return np.stack([np.cos(height) * np.cos(azimuth), np.cos(height) * np.sin(azimuth), np.sin(height)], axis=-1)


def _axes(settings: dict[str, Any]) -> np.ndarray:
    """(3, 3): to the right, upwards and towards the sun, for one who looks at it."""
    height, turn = settings["sun_elevation"], settings["sun_rotation"]
    sun = np.array((math.cos(height) * math.sin(turn), math.cos(height) * math.cos(turn), math.sin(height)))
    right = np.cross(sun, (0.0, 0.0, 1.0) if abs(sun[2]) < 0.9 else (1.0, 0.0, 0.0))
    right /= np.linalg.norm(right)
    return np.array((right, np.cross(right, sun), sun))


def _around(disc: np.ndarray) -> np.ndarray:
    """With the texels outside the disc as the next ones inside."""
    middle = (DISC - 1) / 2.0
    y, x = np.mgrid[0:DISC, 0:DISC] - middle
    radius = np.hypot(x, y)
    scale = np.minimum(1.0, (DISC / 2.0 - 1.0) / np.maximum(radius, 1e-9))
    return np.asarray(disc[np.rint(y * scale + middle).astype(int), np.rint(x * scale + middle).astype(int)])


def _found(settings: dict[str, Any], name: str, context: ExportContext) -> MeasuredSky:
    size = _size(settings)
    axes = _axes(settings) if size > 0 else np.eye(3)
    kept = temporary.kept("skies") / name
    if not kept.exists():
        context.tell("a second Blender measures the sky")
        try:
            _measure({"settings": settings, "axes": axes.tolist(), "size": size, "texels": DISC}, kept, context)
        finally:
            context.tell("")
    with np.load(kept) as tables:
        sky, disc = tables["sky"], tables["disc"]
    return MeasuredSky(sky, _around(disc) if disc.any() else None, axes, size)


def _measure(task: dict[str, Any], kept: Path, context: ExportContext) -> None:
    """Into the file `kept`."""
    if not bpy.app.binary_path:
        raise NotMeasured("this Blender is no program that can be started again")
    if _gave_no_answer:
        raise NotMeasured(f"{NAME} has not answered before, and none is asked until Blender is started again")
    for old in sorted(kept.parent.iterdir(), key=lambda path: path.stat().st_mtime)[: 1 - KEPT]:
        old.unlink()
    with temporary.folder() as folder:
        np.save(folder / "where.npy", directions().astype(np.float32))
        task = {**task, "version": bpy.app.version_string}
        (folder / "task.json").write_text(json.dumps(task), encoding="utf-8")
        command = [bpy.app.binary_path, "--background", "--factory-startup", "--python-exit-code", "1"]
        command += ["--python", str(Path(__file__).with_name("sky_child.py")), "--", str(folder)]
        # nobody's own scripts; colours are managed as here
        with Renderer(command, NAME, {**os.environ, "BLENDER_USER_SCRIPTS": str(folder)}) as child:
            _wait(child, context)
            child.finish()
        (folder / "tables.npz").replace(kept)


def _wait(child: Renderer, context: ExportContext) -> None:
    global _gave_no_answer
    end = time.monotonic() + SECONDS
    while child.running():
        context.check_cancelled()
        if time.monotonic() > end:
            _gave_no_answer = True
            raise NotMeasured(f"{NAME} has not answered for {SECONDS:g} s")
        child.events(0.1)
