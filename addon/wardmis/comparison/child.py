# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' part of a comparison in a Blender of its own, so that the one that the user works in stays usable.

command() is for the one who starts it, main() runs in it. It prints the events of the command `wardmis converge`, and ends when it
is interrupted or its input is closed: each render is kept as soon as it is done.
"""

from __future__ import annotations

import dataclasses
import json
import os
import signal
import sys
import threading
from pathlib import Path
from typing import Any

import bpy

from .converge import STOPPED
from .cycles import CyclesPlan, render_cycles
from .scene_file import read_scene_file


def command(
    blend: Path, scene_name: str, layer_name: str, folder: Path, scene_file: Path, plan: CyclesPlan
) -> list[str]:
    addon = __package__.rpartition(".")[0]
    task = {
        "scene": scene_name,
        "layer": layer_name,
        "folder": str(folder),
        "scene_file": str(scene_file),
        "plan": dataclasses.asdict(plan),
    }
    # the file's own scripts and drivers run where they do in this Blender
    scripts = ["--disable-autoexec" if bpy.app.autoexec_fail else "--enable-autoexec"]
    start = f"import importlib; importlib.import_module({__name__!r}).main()"
    return [
        *(bpy.app.binary_path, "--background", "--addons", addon, *scripts, str(blend)),
        *("--python-exit-code", "1", "--python-expr", start, "--", json.dumps(task)),
    ]


def main() -> None:
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Blender itself would end after a second one alone
    events = os.fdopen(os.dup(1), "w", encoding="utf-8")
    with open(os.devnull, "wb") as nowhere:  # what Blender prints meanwhile
        os.dup2(nowhere.fileno(), 1)

    def tell(event: dict[str, Any]) -> None:
        print(json.dumps(event), file=events, flush=True)

    threading.Thread(target=_end_with_input, daemon=True).start()
    task = json.loads(sys.argv[sys.argv.index("--") + 1])
    window = bpy.context.window
    window.scene = bpy.data.scenes[task["scene"]]
    window.view_layer = window.scene.view_layers[task["layer"]]
    try:
        plan = CyclesPlan(**task["plan"])
        render_cycles(Path(task["folder"]), read_scene_file(Path(task["scene_file"])), plan, tell)
    except (RuntimeError, OSError) as error:
        tell({"event": "error", "code": 1, "message": str(error).removeprefix("WardMIS: ")})
        sys.exit(1)


def _end_with_input() -> None:
    while os.read(0, 1024):
        pass
    os._exit(STOPPED)
