# SPDX-License-Identifier: GPL-3.0-or-later
"""The contact sheet: images in the first row, their error images below, with labels and a colour bar."""

from dataclasses import dataclass, field

import numpy as np
from exr import Pixels
from metrics import relative_squares
from PIL import Image, ImageDraw, ImageFont

BACKGROUND, TEXT, FAINT, WARNING = (250, 250, 250), (25, 25, 25), (110, 110, 110), (176, 80, 0)
MARGIN, GAP, LINE = 24, 12, 30
# Relative error (square root of a pixel's relative squared error) at the two ends of the colour bar, on a log scale.
LOWEST, HIGHEST = 0.01, 1.0
# "inferno" of matplotlib at equal steps: dark is exact.
COLOURS = np.array(
    [(0, 0, 4), (31, 12, 72), (85, 15, 109), (136, 34, 106), (186, 54, 85), (227, 89, 51), (249, 140, 10),
     (249, 201, 50), (252, 255, 164)], dtype=np.float64,
)  # fmt: skip


@dataclass
class Column:
    title: str
    image: Pixels
    lines: list[str] = field(default_factory=list)  # under the title
    warning: str = ""  # over the error image: what it shows besides the error


def exposure(reference: Pixels) -> float:
    """1, or for a bright scene the power of two that brings its brighter parts below white."""
    bright = float(np.percentile(reference[..., :3].mean(axis=-1), 90))
    return 2.0 ** float(np.floor(-np.log2(max(bright, 1.0))))


def displayed(pixels: Pixels, scale: float) -> Image.Image:
    """Linear Rec. 709 to 8-bit sRGB."""
    v = np.clip(np.nan_to_num(pixels[..., :3].astype(np.float64) * scale), 0, 1)
    v = np.where(v <= 0.0031308, 12.92 * v, 1.055 * v ** (1 / 2.4) - 0.055)
    return Image.fromarray(np.round(v * 255).astype(np.uint8), "RGB")


def coloured(t: np.ndarray) -> Image.Image:
    """False colours of 0..1."""
    at = np.clip(np.nan_to_num(t, nan=1.0), 0, 1) * (len(COLOURS) - 1)
    low = np.minimum(at.astype(int), len(COLOURS) - 2)
    mixed = COLOURS[low] + (COLOURS[low + 1] - COLOURS[low]) * (at - low)[..., None]
    return Image.fromarray(np.round(mixed).astype(np.uint8), "RGB")


def error_image(image: Pixels, reference: Pixels) -> Image.Image:
    error = np.sqrt(relative_squares(image, reference))
    span = np.log(HIGHEST / LOWEST)
    return coloured(np.log(np.maximum(error, LOWEST) / LOWEST) / span)


def font(size: int, bold: bool = False) -> ImageFont.FreeTypeFont:
    return ImageFont.truetype("DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf", size)


def contact_sheet(heading: str, reference: Column, columns: list[Column], notes: list[str]) -> Image.Image:
    height, width = reference.image.shape[:2]
    labels = LINE * (2 + max(len(column.lines) for column in [reference, *columns]))
    top = MARGIN + 2 * LINE
    second = top + labels + height + GAP + LINE
    size = (
        2 * MARGIN + (len(columns) + 1) * width + len(columns) * GAP,
        second + height + GAP + LINE * len(notes) + MARGIN,
    )
    sheet = Image.new("RGB", size, BACKGROUND)
    draw = ImageDraw.Draw(sheet)
    scale = exposure(reference.image)
    shown = "sRGB" if scale == 1 else f"sRGB, exposure x {scale:g}"
    draw.text((MARGIN, MARGIN), heading, TEXT, font(28, bold=True))
    for i, column in enumerate([reference, *columns]):
        x = MARGIN + i * (width + GAP)
        draw.text((x, top), column.title, TEXT, font(24, bold=True))
        for row, line in enumerate(column.lines):
            draw.text((x, top + LINE * (row + 1) + 4), line, TEXT, font(21))
        sheet.paste(displayed(column.image, scale), (x, top + labels))
        if column is not reference:
            draw.text((x, second - LINE), column.warning or "error", WARNING if column.warning else FAINT, font(19))
            sheet.paste(error_image(column.image, reference.image), (x, second))
    draw.text((MARGIN, second - LINE), f"(shown as {shown})", FAINT, font(19))
    colour_bar(sheet, MARGIN, second, width)
    for row, note in enumerate(notes):
        draw.text((MARGIN, second + height + GAP + LINE * row), note, FAINT, font(19))
    return sheet


def colour_bar(sheet: Image.Image, x: int, y: int, width: int) -> None:
    draw = ImageDraw.Draw(sheet)
    draw.text((x, y + LINE), "relative error of a pixel", TEXT, font(21))
    draw.text((x, y + 2 * LINE), "sqrt(mean((x - r)² / (r² + 0.01)))", FAINT, font(19))
    top = y + 3 * LINE + 8
    sheet.paste(coloured(np.tile(np.linspace(0, 1, width), (28, 1))), (x, top))
    middle = (LOWEST * HIGHEST) ** 0.5
    for at, anchor, sign, error in ((0, "la", "≤ ", LOWEST), (0.5, "ma", "", middle), (1, "ra", "≥ ", HIGHEST)):
        draw.text((x + at * (width - 1), top + 34), f"{sign}{100 * error:g} %", TEXT, font(19), anchor)
