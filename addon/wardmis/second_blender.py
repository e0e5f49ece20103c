# SPDX-License-Identifier: GPL-3.0-or-later
"""A second Blender in the background, with a copy of what the user has open.

There go the renders that the user has not asked to see: in the first one they would replace the image of the user's last render, and
Blender could not be used meanwhile. save_copy() and command() are for the first, main() runs in the second. That prints events, as
the native renderer does, and ends when it is interrupted or its input is closed.
"""

from __future__ import annotations

import importlib
import json
import os
import signal
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from .process import STOPPED

Tell = Callable[[dict[str, Any]], None]

NAME = "the second Blender"  # what messages call it
COPY, IMAGES = "scene.blend", "images.json"


def wanted() -> bool:
    """Without a window nobody looks at the image of the last render, or waits."""
    return not bpy.app.background


def save_copy(folder: Path) -> list[Path]:
    """Saves what is open as it is now, with the images that have been painted on; returns the files, the first of which is the .blend.

    Raises RuntimeError with a message for the user.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        painted: list[dict[str, Any]] = []
        files: list[Path] = []
        for image in bpy.data.images:
            if not (image.is_dirty and image.users and image.source != "VIEWER"):
                continue
            if image.library is not None or image.source not in {"FILE", "GENERATED"}:
                raise RuntimeError(
                    f"WardMIS: image '{image.name}' has changes that {NAME} would not see, since it is of several files, or of another "
                    "Blender file; save the image"
                )
            files.append(folder / f"image-{len(files)}.npy")
            pixels = np.empty(len(image.pixels), np.float32)
            image.pixels.foreach_get(pixels)
            np.save(files[-1], pixels)
            painted.append({"name": image.name, "size": list(image.size), "file": str(files[-1])})
        (folder / IMAGES).write_text(json.dumps(painted), encoding="utf-8")
    except OSError as error:
        raise RuntimeError(f"WardMIS: {folder} cannot be written: {error.strerror or error}; make room") from error
    blend = folder / COPY
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(blend), copy=True, compress=False)
    except RuntimeError as error:
        raise RuntimeError(f"WardMIS: a copy of the file cannot be saved in {folder}: {str(error).strip()}") from error
    return [blend, folder / IMAGES, *files]


def place(context: Any) -> dict[str, str]:
    """Where the task of a command() is to be done: the scene and the view layer that are open."""
    return {"scene": context.scene.name, "layer": context.view_layer.name}


def command(blend: Path, place: dict[str, str], module: str, **arguments: Any) -> list[str]:
    """Of a Blender that calls `module`.run_task(tell, **arguments) at `place`.

    `module` is one of this add-on, as "comparison.child"; a RuntimeError or OSError of the task becomes an event, and the exit code 1.
    """
    task = {
        **place,
        "images": str(blend.with_name(IMAGES)),
        "module": module,
        "arguments": arguments,
    }
    # the file's own scripts and drivers run where they do in this Blender
    scripts = ["--disable-autoexec" if bpy.app.autoexec_fail else "--enable-autoexec"]
    start = f"import importlib; importlib.import_module({__name__!r}).main()"
    return [
        *(bpy.app.binary_path, "--background", "--addons", __package__, *scripts, str(blend)),
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
        _paint(Path(task["images"]))
        importlib.import_module(f"{__package__}.{task['module']}").run_task(tell, **task["arguments"])
    except (RuntimeError, OSError) as error:
        tell({"event": "error", "code": 1, "message": str(error).removeprefix("WardMIS: ")})
        sys.exit(1)


def _paint(images: Path) -> None:
    """What save_copy() has kept of the images, as images of no file: Cycles would read the others anew from theirs."""
    for painted in json.loads(images.read_text(encoding="utf-8")):
        old = bpy.data.images[painted["name"]]
        new = bpy.data.images.new(old.name, *painted["size"], alpha=True, float_buffer=old.is_float)
        new.colorspace_settings.name, new.alpha_mode = old.colorspace_settings.name, old.alpha_mode
        pixels = np.load(painted["file"])
        channels = len(pixels) // (new.size[0] * new.size[1])
        rgba: np.ndarray = np.ones((len(pixels) // channels, 4), np.float32)
        rgba[:, : max(3, channels)] = pixels.reshape(-1, channels)  # one channel is grey
        new.pixels.foreach_set(rgba.ravel())
        new.update()
        old.user_remap(new)
        bpy.data.images.remove(old)
        new.name = painted["name"]


def _end_with_input() -> None:
    while os.read(0, 1024):
        pass
    os._exit(STOPPED)
