# SPDX-License-Identifier: GPL-3.0-or-later
"""Where comparisons lie: the same one goes on in the same folder, another one begins its own."""

from __future__ import annotations

import dataclasses
import hashlib
import re
import tempfile
import time
from pathlib import Path
from typing import Any

import bpy

from .converge import Outcome, Study, arguments
from .run import SCENE_NAME
from .same_scene import same_but_for_rounding
from .scene_file import read_scene_file

LOOK_AGAIN_SECONDS = 2.0  # panels are drawn at every movement of the mouse, and disks may be slow


def home(scene: Any) -> Path:
    """The folder in which comparisons get theirs."""
    chosen = scene.wardmis_comparison.folder
    if chosen and (bpy.data.filepath or not chosen.startswith("//")):
        return Path(bpy.path.abspath(chosen))
    if bpy.data.filepath:
        return Path(bpy.data.filepath).with_suffix("").with_name(f"{Path(bpy.data.filepath).stem} comparisons")
    return Path(tempfile.gettempdir()) / "wardmis comparisons"  # not Blender's own, which goes when it ends


def folder_of(place: Path, study: Study, settings: Any, render_settings: Any, exported: Path) -> Path:
    """Of this comparison of the exported scene, in `place`; with more seeds it is the same one."""
    name = _name(study, settings, render_settings)
    # the export's own hash would tell apart what is the same but for the last bits
    for earlier in sorted(place.glob(f"{name}-*")):
        if same_but_for_rounding(exported, earlier / SCENE_NAME):
            return earlier
    return place / f"{name}-{read_scene_file(exported).sha256[:8]}"


def is_unfinished(place: Path, study: Study, settings: Any, render_settings: Any) -> bool:
    """Whether a comparison with these settings was begun in `place` and left without a report. That the scene is still the same, only its
    export could tell."""
    name, now = _name(study, settings, render_settings), time.monotonic()
    seen = _seen.get((place, name))
    if seen is None or now - seen[0] > LOOK_AGAIN_SECONDS:
        begun = (f for f in place.glob(f"{name}-*") if (f / SCENE_NAME).is_file())
        found = any(not Outcome(f, f / SCENE_NAME).report_json.is_file() for f in begun)
        _seen.clear()
        seen = _seen[place, name] = now, found
    return seen[1]


_seen: dict[tuple[Path, str], tuple[float, bool]] = {}  # when it was looked for, and whether it was there


def _name(study: Study, settings: Any, render_settings: Any) -> str:
    """What its folders begin with: the scene's title, and a hash of what is asked for."""
    what = arguments(dataclasses.replace(study, seeds=0), render_settings, Outcome(Path(), Path()))
    what.append(f"{settings.use_cycles} {settings.cycles_as_is}")
    title = re.sub(r"[^\w.-]+", "_", study.title)  # of any letters, but no signs that a folder's name cannot have
    return f"{title}-{hashlib.sha256(chr(0).join(what).encode()).hexdigest()[:8]}"
