# SPDX-License-Identifier: GPL-3.0-or-later
"""Temporary folders that hold whole scenes. They go when their work is done; where Blender was killed meanwhile, before the next one."""

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


@contextlib.contextmanager
def folder() -> Iterator[Path]:
    place = Path(bpy.app.tempdir)  # of this Blender alone, beside those of others
    place.mkdir(parents=True, exist_ok=True)  # who clears the temporary folder may have taken it
    _remove_abandoned(place.parent)
    with tempfile.TemporaryDirectory(prefix=PREFIX, dir=place) as name, alone(Path(name)):
        yield Path(name)


def _remove_abandoned(place: Path) -> None:
    """The system releases the lock of a process that ends, however it ends."""
    for name in glob.glob(
        f"{glob.escape(str(place))}/blender_*/{PREFIX}*"
    ):  # pathlib's fails where a folder goes meanwhile
        path = Path(name)
        with contextlib.suppress(OSError, RuntimeError):
            status = path.stat()
            if status.st_uid == os.getuid() and time.time() - status.st_mtime > YOUNG_SECONDS:
                with alone(path):
                    shutil.rmtree(path, ignore_errors=True)
