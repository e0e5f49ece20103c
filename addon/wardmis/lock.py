# SPDX-License-Identifier: GPL-3.0-or-later
"""One process at a time in a folder, where its file system has locks, as the command has it for its own. No bpy in here."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows has no such locks for folders
    fcntl = None  # type: ignore[assignment]


@contextlib.contextmanager
def alone(folder: Path) -> Iterator[bool]:
    """Raises RuntimeError where another process is in here for the same folder. The lock ends with its process, however that ends.

    Gives whether there is a lock: without one, nobody is known to be away.
    """
    if fcntl is None:
        yield False
        return
    descriptor, locked = None, False
    try:
        try:
            descriptor = os.open(folder, os.O_RDONLY)
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            locked = True
        except BlockingIOError as error:
            raise RuntimeError(
                f"WardMIS: another process is rendering into {folder}; wait for it, or choose another output folder"
            ) from error
        except OSError:
            pass  # there are none here
        yield locked
    finally:
        if descriptor is not None:
            os.close(descriptor)
