# SPDX-License-Identifier: GPL-3.0-or-later
"""What an image's file says of its alpha, as Cycles reads it: Blender does not tell. No bpy in here."""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import BinaryIO


@dataclass(frozen=True)
class FileAlpha:
    is_straight: bool = True  # the colours have not been multiplied by it
    is_of_grey: bool = False  # it is beside a single colour, which Cycles does not multiply


MULTIPLIED = FileAlpha(is_straight=False)
PNG_KIND, PNG_GREY_WITH_ALPHA = 25, 4  # where a PNG says what its pixels are, and one such kind
TIFF_SAMPLES_PER_PIXEL, TIFF_EXTRA_SAMPLES, TIFF_UNASSOCIATED = 277, 338, 2
TGA_FOOTER, TGA_SIGNATURE, TGA_ALPHA_TYPE, TGA_MULTIPLIED = 26, b"TRUEVISION-XFILE", 494, 4


def file_alpha(path: str) -> FileAlpha:
    """Of a file that cannot be read or understood: straight, as Cycles takes most formats."""
    try:
        with open(path, "rb") as file:
            head = file.read(PNG_KIND + 1)
            found = next((read for signature, read in FORMATS if head.startswith(signature)), _tga)
            return found(file)
    except (OSError, struct.error, IndexError):
        return FileAlpha()


def _png(file: BinaryIO) -> FileAlpha:
    file.seek(PNG_KIND)
    return FileAlpha(is_of_grey=file.read(1)[0] == PNG_GREY_WITH_ALPHA)


def _tiff(file: BinaryIO) -> FileAlpha:
    """Of its first directory; a classic one has offsets of 32 bits, a BigTIFF of 64."""
    file.seek(0)
    order = "<" if file.read(2) == b"II" else ">"

    def read(kinds: str) -> tuple[int, ...]:
        return struct.unpack(order + kinds, file.read(struct.calcsize(order + kinds)))

    (version,) = read("H")
    big = version == 43
    offset, count = ("Q", "Q") if big else ("I", "H")
    if big:
        read("HH")
    file.seek(*read(offset))
    (entries,) = read(count)
    first = {}  # value of a tag of short integers
    for _ in range(entries):
        tag, _kind, number = read("HH" + offset)
        here, size = file.tell(), struct.calcsize(order + offset)
        if tag in {TIFF_SAMPLES_PER_PIXEL, TIFF_EXTRA_SAMPLES}:
            if 2 * number > size:
                file.seek(*read(offset))
            (first[tag],) = read("H")
        file.seek(here + size)
    return FileAlpha(first.get(TIFF_EXTRA_SAMPLES) == TIFF_UNASSOCIATED, first.get(TIFF_SAMPLES_PER_PIXEL) == 2)


def _tga(file: BinaryIO) -> FileAlpha:
    """Or of a format that is none of these, and has no such footer."""
    end = file.seek(0, 2)
    file.seek(max(0, end - TGA_FOOTER))
    footer = file.read()
    if footer[8:24] != TGA_SIGNATURE:
        return FileAlpha()
    (extension,) = struct.unpack("<I", footer[:4])
    file.seek(extension + TGA_ALPHA_TYPE)
    return FileAlpha(extension == 0 or file.read(1)[0] != TGA_MULTIPLIED)


def _multiplied(_file: BinaryIO) -> FileAlpha:
    return MULTIPLIED


FORMATS: tuple[tuple[bytes, Callable[[BinaryIO], FileAlpha]], ...] = (
    (b"\x89PNG\r\n\x1a\n", _png),
    (b"\x76\x2f\x31\x01", _multiplied),  # OpenEXR
    (b"SDPX", _multiplied),
    (b"XPDS", _multiplied),
    (b"II", _tiff),
    (b"MM", _tiff),
)
