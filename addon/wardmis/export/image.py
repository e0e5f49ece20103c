# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's images -> the bytes of their files where every renderer reads those, else pixels. Nothing is saved or packed."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import bpy
import numpy as np

from .. import compat
from .blender_pixels import alpha_affects_colors, as_in_the_file, blender_pixels, is_cut_off
from .elsewhere import pixels_elsewhere
from .file_alpha import file_alpha
from .model import FileOnDisk, ImageData, Rgb
from .simplify import FULL_SIZE, Shrinking

# what stands in for an image that cannot be shown: never black, easy to see, and Blender's own sign for it
MISSING: Rgb = (1.0, 0.0, 1.0)

# How files begin that the renderer reads without OpenImageIO, which the packaged one does not have.
SIGNATURES = (
    (b"\x89PNG\r\n\x1a\n", "image/png"),
    (b"\xff\xd8\xff", "image/jpeg"),
    (b"\x76\x2f\x31\x01", "image/x-exr"),
)
EXR_BEGINS = SIGNATURES[2][0]
COLOR_SPACES = {"sRGB": "sRGB", "Linear": "linear", "Linear Rec.709": "linear", "Non-Color": "linear", "Raw": "linear"}
COLOR_SPACES[""] = "sRGB"  # of a movie that Blender could not read


@dataclass(frozen=True)
class Pixels:
    """Linear ones that the exporter makes, under the names by which the context tells images apart."""

    name: str
    name_full: str
    pixels: np.ndarray  # (height, width, channels) float32, rows from the bottom

    def export(self) -> ImageData:
        return ImageData(self.name, "linear", pixels=self.pixels)


@dataclass(frozen=True)
class Picture:
    """What an image node shows of an image, as Cycles does: which picture of a sequence or movie, and what alpha does to the colours.

    `alpha`: the colours are "kept" as they are stored, or "multiplied" by it; or it is "ignored", and 1. `divided`: the colours are
    divided by it after they are filtered.
    """

    image: Any
    alpha: str = "kept"
    divided: bool = False
    frame: int | None = None  # of a sequence or a movie
    tile: int | None = None  # of UDIM; None: the first

    @property
    def name(self) -> str:
        return str(self.image.name)

    @property
    def name_full(self) -> str:
        """Unlike all other pictures'. The library is part of it: two linked images may be called the same."""
        return f"{self.image.name_full} {self.alpha} {self.frame} {self.tile}"

    @property
    def is_encoded(self) -> bool:
        """Whether it is kept and filtered as sRGB. Blender has made floats linear, which Cycles does not see where it reads the file."""
        if self._is_float:
            return self.image.colorspace_settings.name == "sRGB" and self._is_read_by_cycles
        return self._space == "sRGB"

    @property
    def _space(self) -> str:
        return COLOR_SPACES.get(self.image.colorspace_settings.name, "sRGB")

    @property
    def path(self) -> str:
        path = self.image.filepath
        if self.image.source == "TILED":
            path = path_of_tile(path, self.image.tiles[0].number, self._tile)
        path = bpy.path.abspath(path, library=self.image.library)
        return (
            path_of_frame(path, self.frame) if self.image.source == "SEQUENCE" and self.frame is not None else str(path)
        )

    @property
    def _tile(self) -> int:
        return self.image.tiles[0].number if self.tile is None else self.tile

    @property
    def _is_later_tile(self) -> bool:
        """Whether Blender does not give its pixels: it does of the first tile alone."""
        return self.image.source == "TILED" and self._tile != self.image.tiles[0].number

    @property
    def _is_elsewhere(self) -> bool:
        """Whether its pixels, where they are wanted, are others than those that Blender holds."""
        return not self.image.is_dirty and (self.frame is not None or self._is_later_tile)

    @cached_property
    def _elsewhere(self) -> np.ndarray | None:
        return pixels_elsewhere(self.image, self.path, self.frame if self.image.source == "MOVIE" else None)

    @property
    def _pixels(self) -> np.ndarray:
        return (
            blender_pixels(self.image) if not self._is_elsewhere or self._elsewhere is None else self._elsewhere.copy()
        )

    @property
    def _is_float(self) -> bool:
        if self._is_elsewhere and not self.mime_type:
            return self._elsewhere is not None and self._elsewhere.dtype != np.uint8
        return bool(self.image.is_float)

    @property
    def mime_type(self) -> str:
        """Of the file that the image was read from, if it is still what the file holds and the renderer reads such files."""
        if self.image.is_dirty or self.image.source not in {"FILE", "TILED", "SEQUENCE"} or self._is_blenders:
            return ""
        head = self._file(16)
        return next((mime_type for signature, mime_type in SIGNATURES if head.startswith(signature)), "")

    @property
    def _is_blenders(self) -> bool:
        """Whether Cycles gets Blender's pixels, not those of the packed file, and loading has changed these.

        It makes floats linear, and multiplies straight ones by alpha; it divides bytes that are said to be multiplied.
        """
        if not self.image.packed_files:
            return False
        if self.image.is_float and self._file(4) == EXR_BEGINS:
            return bool(self.image.alpha_mode == "STRAIGHT" or self._space != "linear")
        return bool(self.image.is_float or self.image.alpha_mode == "PREMUL")

    @property
    def _is_read_by_cycles(self) -> bool:
        """Whether Cycles reads its file, and not the pixels that Blender holds."""
        image = self.image
        return not image.is_dirty and not image.packed_files and image.source in {"FILE", "TILED", "SEQUENCE"}

    @property
    def is_to_be_multiplied(self) -> bool:
        """Whether Cycles multiplies the colours of what it reads, the file or Blender's pixels, by alpha."""
        if not alpha_affects_colors(self.image):
            return False
        of_file = file_alpha(self.path) if self._is_read_by_cycles else None
        if of_file is not None and of_file.is_of_grey:
            return False
        if compat.ALPHA_MODES_ARE_TRUSTED:
            return bool(self.image.alpha_mode == "STRAIGHT")
        return of_file.is_straight if of_file is not None else not self._is_float

    def export(self) -> ImageData:
        """A missing one becomes a magenta texel."""
        if self.missing():
            texel = np.array([[MISSING]], np.float32)  # whose edge is filtered as that of its colour space
            space = "sRGB" if self.is_encoded else "linear"
            return ImageData(self.name, space, pixels=texel, filter_encoded=self.is_encoded)
        mime_type = self.mime_type
        # of later tiles there are no pixels; deviations() names their colour space
        readable = self.image.colorspace_settings.name in COLOR_SPACES or self._is_later_tile
        if mime_type and readable:
            return ImageData(
                self.name,
                self._space,
                encoded=self._complete_file(),
                mime_type=mime_type,
                filter_encoded=self.is_encoded,
                alpha={"multiplied": "multiplies", "ignored": "ignored"}.get(self.alpha, "kept"),
            )
        space = "sRGB" if self.is_encoded else "linear"
        return ImageData(self.name, space, pixels=self._stored(), filter_encoded=self.is_encoded)

    def missing(self) -> str | None:
        """Why there are no pixels, naming the image and its file, or None."""
        reason = self._reason_missing()
        return f"image '{self.name}' cannot be shown: {reason}" if reason else None

    def _reason_missing(self) -> str | None:
        image = self.image
        if image.type == "MULTILAYER":
            return "a multi-layer EXR cannot be read as a texture; save the layer as an image of its own"
        if image.source == "VIEWER":
            return "a render or viewer result cannot be read as a texture; save it as a file"
        path = self.path
        if image.source in {"FILE", "SEQUENCE", "MOVIE"} and not image.is_dirty and not image.packed_files:
            if not os.path.isfile(path):
                kind = (
                    "a folder" if os.path.isdir(path) else "a device or a pipe" if os.path.exists(path) else "missing"
                )
                return f"its file '{path}' is {kind}"
        elif self._is_later_tile and not self.mime_type:
            if image.is_dirty or not image.filepath:
                return f"its tile {self._tile} is no file; save the image"
            if not os.path.isfile(path):
                return f"'{path}' of its tile {self._tile} is missing"
        if self._is_elsewhere:
            can_be_read = bool(self.mime_type) or self._elsewhere is not None
        else:
            can_be_read = 0 not in image.size  # a damaged file, too, is better found here than by the renderer
        return None if can_be_read else f"it cannot be read from '{path}'"

    def deviations(self) -> list[str]:
        """What is rendered other than Blender shows it, naming the image."""
        found = []
        image = self.image
        space = image.colorspace_settings.name
        if space not in COLOR_SPACES and not self._is_float:
            found.append(f"colour space '{space}' is not supported; its colours are read as sRGB")
        if not self.mime_type and self._is_read_by_cycles and is_cut_off(image, self._pixels):
            found.append(
                "it is said to be Premultiplied, and it seems that its colours are not multiplied by alpha: Blender cuts those off that "
                "are above it, and they become darker; set its alpha to what the file has, or save it as PNG"
            )
        return [f"image '{image.name}': {deviation}" for deviation in found]

    def _file(self, size: int = -1) -> bytes:
        """The first bytes, or all, of the file on disk or packed."""
        if self.image.packed_files:
            packed = compat.packed_file(self.image, self._tile if self.image.source == "TILED" else None)
            content = b"" if packed is None else bytes(packed.data)
            return content[:size] if size >= 0 else content
        try:
            with open(self.path, "rb") as file:
                return file.read(size)
        except OSError:
            return b""

    def _complete_file(self) -> bytes | FileOnDisk:
        if self.image.packed_files:
            return self._file()
        return FileOnDisk(self.path, os.path.getsize(self.path))

    def _stored(self) -> np.ndarray:
        """(height, width, channels) uint8, or float32 where the image is one: sRGB if `is_encoded`, else linear."""
        pixels = self._pixels
        if self._is_read_by_cycles:
            pixels = as_in_the_file(self.image, pixels, self.is_encoded)
        if pixels.shape[-1] < 4 or self.alpha == "kept":
            return pixels
        if self.alpha == "ignored":
            return pixels[..., :3]
        if pixels.dtype == np.uint8:
            pixels[..., :3] = pixels[..., :3].astype(np.uint16) * pixels[..., 3:] // 255
        else:
            pixels[..., :3] *= pixels[..., 3:]
        return pixels


def picture_of(image: Any, shows_alpha: bool, user: Any, scene_frame: int) -> Picture:
    """The picture that a node with the image user `user` shows; `shows_alpha`: its Alpha output is used.

    Cycles multiplies colours by alpha where the file has not done so, and divides them again where the alpha is used.
    """
    if image.source == "MOVIE":
        tuple(image.size)  # Blender finds its colour space when it reads it
    plain = Picture(image, frame=frame_of(user, scene_frame) if image.source in {"SEQUENCE", "MOVIE"} else None)
    alpha = "ignored" if image.alpha_mode == "NONE" else "multiplied" if plain.is_to_be_multiplied else "kept"
    return replace(plain, alpha=alpha, divided=alpha_affects_colors(image) and shows_alpha)


def frame_of(user: Any, scene_frame: int) -> int:
    """The number of the picture that an image user shows in this frame."""
    number = scene_frame - user.frame_start + 1
    length = user.frame_duration
    if length == 0:
        return 0
    if user.use_cyclic:
        number = number % length or length
    return int(min(max(number, 0), length) + user.frame_offset)


def path_of_frame(path: str, frame: int) -> str:
    """The path of a picture of a sequence, of which `path` is one: the last digits of the name are its number."""
    folder, name = os.path.split(path)
    number = re.search(r"(\d+)(?=\D*$)", name)
    if number is None:
        return path
    return os.path.join(folder, f"{name[: number.start()]}{frame:0{len(number[1])}}{name[number.end() :]}")


def path_of_tile(path: str, first: int, number: int) -> str:
    """The path of a UDIM tile. Without a token in the name, `path` is that of tile `first`."""
    folder, name = os.path.split(path)
    u, v = (number - 1001) % 10 + 1, (number - 1001) // 10 + 1
    if "<UDIM>" not in name and "<UVTILE>" not in name:
        name = name.replace(str(first), "<UDIM>")
    return os.path.join(folder, name.replace("<UDIM>", str(number)).replace("<UVTILE>", f"u{u}_v{v}"))


def export_image(image: Picture | Pixels) -> ImageData:
    return image.export()


class WithinMemory:
    """export_image() for a whole scene. Asking Blender about an image makes it read all pixels, which it keeps: beyond `limit` bytes
    those of files that it had not read before are given back, the oldest first."""

    def __init__(self, shrinking: Shrinking = FULL_SIZE, limit: int = 1_000_000_000) -> None:
        self._shrinking, self._limit = shrinking, limit
        self._read_before = {image.name_full for image in bpy.data.images if image.has_data}
        self._read: dict[str, tuple[Any, int]] = {}

    def __call__(self, image: Picture | Pixels) -> ImageData:
        data = export_image(image)
        if isinstance(image, Picture):
            data.halvings, data.limit = self._shrinking.halvings, self._shrinking.limit
            self._bound(image.image)
        return data

    def _bound(self, image: Any) -> None:
        if image.name_full in self._read_before or image.source not in {"FILE", "TILED"} or not image.has_data:
            return
        width, height = image.size
        self._read.pop(image.name_full, None)
        self._read[image.name_full] = image, width * height * (16 if image.is_float else 4)
        while sum(size for _, size in self._read.values()) > self._limit:
            oldest, _ = self._read.pop(next(iter(self._read)))
            if not oldest.is_dirty:
                oldest.buffers_free()
