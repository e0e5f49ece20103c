# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's images -> the bytes of their files where every renderer reads those, else pixels. Nothing is saved or packed."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from .emission import MISSING
from .model import ImageData

# How files begin that the renderer reads without OpenImageIO, which the packaged one does not have.
SIGNATURES = (
    (b"\x89PNG\r\n\x1a\n", "image/png"),
    (b"\xff\xd8\xff", "image/jpeg"),
    (b"\x76\x2f\x31\x01", "image/x-exr"),
)
COLOR_SPACES = {"sRGB": "sRGB", "Linear": "linear", "Linear Rec.709": "linear", "Non-Color": "linear", "Raw": "linear"}
MOVING = {"SEQUENCE", "MOVIE"}


@dataclass(frozen=True)
class BakedImage:
    """Pixels that the exporter makes of an image, under the names by which the context tells images apart."""

    name: str
    name_full: str
    pixels: Callable[[], np.ndarray]  # (height, width, channels) float32, linear


def export_image(image: Any) -> ImageData:
    """`image`: Blender's, or a BakedImage. A missing one becomes a magenta texel, Blender's own sign for it."""
    if isinstance(image, BakedImage):
        return ImageData(image.name, "linear", pixels=image.pixels())
    if missing(image):
        return ImageData(image.name, "linear", pixels=texels(image)[..., :3])
    color_space = COLOR_SPACES.get(image.colorspace_settings.name, "sRGB")
    mime_type = _mime_type(image)
    if mime_type and image.colorspace_settings.name in COLOR_SPACES:
        return ImageData(image.name, color_space, encoded=_file(image), mime_type=mime_type)
    pixels = _pixels(image)
    # Blender has already turned float pixels into linear ones
    return ImageData(image.name, "linear" if pixels.dtype == np.float32 else color_space, pixels=pixels)


def missing(image: Any) -> str | None:
    """Why there are no pixels, naming the image and its file, or None."""
    reason = _reason_missing(image)
    return f"image '{image.name}' cannot be shown: {reason}" if reason else None


def _reason_missing(image: Any) -> str | None:
    if image.type == "MULTILAYER":
        return "a multi-layer EXR cannot be read as a texture; save the layer as an image of its own"
    if image.source == "VIEWER":
        return "a render or viewer result cannot be read as a texture; save it as a file"
    path = _path(image)
    if image.source == "FILE" and not image.is_dirty and not image.packed_file and not os.path.isfile(path):
        kind = "a folder" if os.path.isdir(path) else "a device or a pipe" if os.path.exists(path) else "missing"
        return f"its file '{path}' is {kind}"
    if 0 in image.size:  # Blender has tried: a damaged file, too, is better found here than by the renderer
        return f"it cannot be read from '{path}'"
    return None


def deviations(image: Any) -> list[str]:
    """What is rendered other than Blender shows it, naming the image."""
    found = []
    space = image.colorspace_settings.name
    if space not in COLOR_SPACES and not image.is_float:
        found.append(f"colour space '{space}' is not supported; its colours are read as sRGB")
    if image.source == "TILED" and len(image.tiles) > 1:
        found.append(f"UDIM tiles are not supported; tile {image.tiles[0].number} is used everywhere")
    if image.source in MOVING:
        found.append("movies and sequences are not supported; the picture that Blender holds now is used")
    return [f"image '{image.name}': {deviation}" for deviation in found]


def texels(image: Any) -> np.ndarray:
    """(height, width, 4) float32: linear RGBA, rows from the bottom."""
    if missing(image):
        return np.array([[(*MISSING, 1.0)]], np.float32)
    pixels = _pixels(image)
    if pixels.dtype == np.uint8:
        code = np.arange(256, dtype=np.float32) / 255.0
        if COLOR_SPACES.get(image.colorspace_settings.name, "sRGB") == "sRGB":
            linear = np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4).astype(np.float32)
        else:
            linear = code
        pixels = np.concatenate([linear[pixels[..., :3]], code[pixels[..., 3:]]], axis=-1)
    height, width, channels = pixels.shape
    if channels < 3:
        pixels = np.repeat(pixels[..., :1], 3, axis=-1)
    if channels < 4:
        pixels = np.concatenate([pixels, np.ones((height, width, 1), np.float32)], axis=-1)
    return pixels


def _path(image: Any) -> str:
    path = image.filepath
    if image.source == "TILED":
        path = path.replace("<UDIM>", str(image.tiles[0].number))
    return str(bpy.path.abspath(path, library=image.library))


def _mime_type(image: Any) -> str:
    """Of the file that the image was read from, if it is still what the file holds and the renderer reads such files."""
    if image.is_dirty or image.source not in {"FILE", "TILED"}:
        return ""
    head = _file(image, 16)
    return next((mime_type for signature, mime_type in SIGNATURES if head.startswith(signature)), "")


def _file(image: Any, size: int = -1) -> bytes:
    """The first bytes, or all, of the file on disk or packed."""
    if image.packed_files:
        content = bytes(image.packed_files[0].packed_file.data)
        return content[:size] if size >= 0 else content
    try:
        with open(_path(image), "rb") as file:
            return file.read(size)
    except OSError:
        return b""


def _pixels(image: Any) -> np.ndarray:
    """(height, width, channels) uint8 as in the file, or float32 and linear, rows from the bottom."""
    width, height = image.size
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(height, width, image.channels)
    return pixels if image.is_float else np.rint(pixels * 255.0).astype(np.uint8)
