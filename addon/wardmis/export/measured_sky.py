# SPDX-License-Identifier: GPL-3.0-or-later
"""The radiance of a Sky Texture node, as this Blender's own Cycles has it: asked of a second Blender without windows.

The models' data belong to Cycles, which gives them in no other way. It renders one sample a pixel, each of one direction that is
chosen here: without noise, the same every time. The user's session takes no part. It takes a second or two; skies that were asked for
in this session are known.
"""

from __future__ import annotations

import json
import math
import subprocess
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
import numpy as np

COLUMNS, ROWS = 512, 256  # of the sky: even steps in azimuth, and in the root of the height (as Nishita's has it)
DISC = 64  # texels a side of the sun's disc
SECONDS = 120.0  # to wait
SMALLEST_DISC = 1e-4  # radians


class NotMeasured(Exception):
    """The message says why."""


@dataclass
class MeasuredSky:
    """`sky`: (ROWS, COLUMNS, 3) without the sun's disc, the first row straight down, the others as in directions().

    `disc`: (DISC, DISC, 3), what the disc adds in the square around it, in a plane that is orthogonal to the direction of the sun:
    `axes` are the square's own, and that direction, in the sky's coordinates; `size` is its full angle. Around the disc it is as at
    its rim.
    """

    sky: np.ndarray
    disc: np.ndarray | None
    axes: np.ndarray
    size: float


_known: dict[str, MeasuredSky] = {}


def measured(node: Any, cancelled: Callable[[], None]) -> MeasuredSky:
    """Raises NotMeasured, and what `cancelled` raises, which is called now and then."""
    settings = _settings(node)
    key = json.dumps(settings, sort_keys=True)
    if key not in _known:
        if len(_known) > 64:
            _known.clear()
        _known[key] = _ask(settings, cancelled)
    return _known[key]


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


def _has_disc(settings: dict[str, Any]) -> bool:
    plain = settings["sky_type"] in {"PREETHAM", "HOSEK_WILKIE"}
    return bool(not plain and settings["sun_disc"] and settings["sun_size"] > SMALLEST_DISC)


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


def _ask(settings: dict[str, Any], cancelled: Callable[[], None]) -> MeasuredSky:
    if not bpy.app.binary_path:
        raise NotMeasured("this Blender is no program that can be started again")
    axes, size = (_axes(settings), float(settings["sun_size"])) if _has_disc(settings) else (np.eye(3), 0.0)
    task = {"settings": settings, "axes": axes.tolist(), "tangent": math.tan(size / 2.0), "texels": DISC}
    with tempfile.TemporaryDirectory(prefix="wardmis-sky-") as name:
        folder = Path(name)
        np.save(folder / "where.npy", directions().astype(np.float32))
        (folder / "task.json").write_text(json.dumps(task), encoding="utf-8")
        command = [bpy.app.binary_path, "--background", "--factory-startup", "--python-exit-code", "1"]
        command += ["--python", str(Path(__file__).with_name("sky_child.py")), "--", name]
        nothing = subprocess.DEVNULL
        try:
            with subprocess.Popen(command, stdin=nothing, stdout=nothing, stderr=nothing) as child:
                try:
                    _wait(child, cancelled)
                finally:
                    child.kill()
            disc = _around(np.load(folder / "disc.npy")) if size > 0 else None
            return MeasuredSky(np.load(folder / "sky.npy"), disc, axes, size)
        except subprocess.TimeoutExpired:
            raise NotMeasured(f"a second Blender has not answered for {SECONDS:g} s") from None
        except (OSError, ValueError) as error:
            raise NotMeasured(f"a second Blender, in which Cycles was to render it, has failed ({error})") from error


def _wait(child: subprocess.Popen[bytes], cancelled: Callable[[], None]) -> None:
    end = time.monotonic() + SECONDS
    while True:
        try:
            child.wait(0.1)
            return
        except subprocess.TimeoutExpired:
            if time.monotonic() > end:
                raise
        cancelled()
