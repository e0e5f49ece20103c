# SPDX-License-Identifier: GPL-3.0-or-later
"""The file that an export writes: refused where there can be none, else complete or not there at all. No bpy in here."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from .context import ExportError


def check_target(path: str | os.PathLike[str]) -> None:
    """Raises ExportError where no file of that name can be written, as far as that can be told beforehand."""
    if os.path.isdir(path):
        raise ExportError(f"{path} is a folder; name a file in it")
    if os.path.exists(path) and not os.path.isfile(path):  # a rename would put a file in its place
        raise ExportError(f"{path} is a device or a pipe, not a file; name a file")
    folder = _resolved(path).parent
    if not folder.is_dir():
        raise ExportError(f"{path} cannot be written: the folder {folder} does not exist; create it, or choose another")


@contextlib.contextmanager
def writing(path: str | os.PathLike[str]) -> Iterator[IO[bytes]]:
    """A file under a temporary name that becomes `path` once the block is done; ExportError if it cannot be written."""
    check_target(path)
    target = _resolved(path)
    temporary = target.with_name(f".wardmis-{os.getpid()}.tmp")
    try:
        with open(temporary, "wb", buffering=0) as file:
            yield file
        os.replace(temporary, target)
    except OSError as error:
        raise ExportError(f"{path} cannot be written: {error.strerror or error}") from error
    finally:
        temporary.unlink(missing_ok=True)  # there only if something failed


def _resolved(path: str | os.PathLike[str]) -> Path:
    """Through symbolic links, which stay: it is what they point to that is written."""
    return Path(os.path.realpath(path))
