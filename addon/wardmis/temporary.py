# SPDX-License-Identifier: GPL-3.0-or-later
"""Temporary folders that hold whole scenes. They go when their work is done; where Blender was killed meanwhile, the next one removes
them: when it starts, and before it makes one itself."""

from __future__ import annotations

import contextlib
import glob
import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import bpy

from .lock import alone

PREFIX = "wardmis-work-"
YOUNG_SECONDS = 60.0  # an unlocked folder may be about to be locked

_kept: dict[Path, contextlib.ExitStack] = {}  # and their locks


@contextlib.contextmanager
def folder() -> Iterator[Path]:
    with tempfile.TemporaryDirectory(prefix=PREFIX, dir=_place()) as name, alone(Path(name)):
        yield Path(name)


def kept(name: str) -> Path:
    """The folder of that name, which this Blender has until it ends. OSError if it cannot be made."""
    path = _place() / f"{PREFIX}{name}"
    if path in _kept and path.is_dir():
        return path
    path.mkdir(exist_ok=True)
    lock = contextlib.ExitStack()
    lock.enter_context(alone(path))
    if path in _kept:  # of a folder that is gone
        _kept[path].close()
    _kept[path] = lock
    return path


def _place() -> Path:
    """Of this Blender alone, beside those of others."""
    place = Path(bpy.app.tempdir)
    place.mkdir(parents=True, exist_ok=True)  # who clears the temporary folder may have taken it
    _remove_abandoned(place.parent)
    return place


def _remove_abandoned(place: Path) -> None:
    """The system releases the lock of a process that ends, however it ends.

    So its Blender is gone, too, and the folder that Blender had goes if nothing else is in it. Other folders of Blender's stay: their
    names do not say whose they are.
    """
    for name in glob.glob(
        f"{glob.escape(str(place))}/blender_*/{PREFIX}*"
    ):  # pathlib's fails where a folder goes meanwhile
        path = Path(name)
        with contextlib.suppress(OSError, RuntimeError):
            status = path.stat()
            if status.st_uid == os.getuid() and time.time() - status.st_mtime > YOUNG_SECONDS:
                with alone(path) as locked:
                    if locked:
                        shutil.rmtree(path, ignore_errors=True)
                        path.parent.rmdir()


def register() -> None:
    with contextlib.suppress(OSError):  # who needs a folder hears of it
        _place()


def unregister() -> None:
    for path, lock in _kept.items():
        shutil.rmtree(path, ignore_errors=True)
        lock.close()
    _kept.clear()
