# SPDX-License-Identifier: GPL-3.0-or-later
"""Error against time, both logarithmic, with the 95 % bands, as an image. Drawn by the GPU, which Blender has in a window alone."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import blf  # type: ignore[import-not-found]
import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader  # type: ignore[import-not-found]

from .. import compat
from .report import Curve

WIDTH, HEIGHT = 1200, 800
LEFT, BOTTOM, TOP = 150, 110, 70  # margins; on the right is what the names need
WIDEST_NAMES = 480
BACKGROUND = (1.0, 1.0, 1.0, 1.0)
INK, GRID = (0.1, 0.1, 0.1, 1.0), (0.88, 0.88, 0.88, 1.0)
# Okabe and Ito's colours, which the colour-blind can tell apart, without the yellow
COLOURS = (
    (0.0, 0.45, 0.70),
    (0.84, 0.37, 0.0),
    (0.0, 0.62, 0.45),
    (0.80, 0.47, 0.65),
    (0.0, 0.0, 0.0),
    (0.34, 0.71, 0.91),
    (0.90, 0.62, 0.0),
    (0.45, 0.30, 0.65),
    (0.55, 0.35, 0.20),
    (0.50, 0.50, 0.50),
)
TEXT_SIZE, FONT = 26, 0
NAMES_AT = 46  # right of the curves


def available() -> bool:
    return not bpy.app.background


def draw(curves: Sequence[Curve], title: str, metric: str, clock: str) -> np.ndarray:
    """(HEIGHT, WIDTH, 3), rows from the top, sRGB from 0 to 1. Only where available()."""
    offscreen = gpu.types.GPUOffScreen(WIDTH, HEIGHT)
    try:
        with offscreen.bind():
            framebuffer = gpu.state.active_framebuffer_get()
            framebuffer.clear(color=BACKGROUND)
            with gpu.matrix.push_pop(), gpu.matrix.push_pop_projection():
                gpu.matrix.load_identity()
                gpu.matrix.load_projection_matrix(compat.pixel_projection(WIDTH, HEIGHT))
                _Plot(curves, title, metric, clock).draw()
            buffer = framebuffer.read_color(0, 0, WIDTH, HEIGHT, 4, 0, "UBYTE")
    finally:
        offscreen.free()
    buffer.dimensions = WIDTH * HEIGHT * 4
    pixels = np.array(buffer, np.uint8).reshape(HEIGHT, WIDTH, 4)
    return pixels[::-1, :, :3] / np.float32(255)


class _Plot:
    def __init__(self, curves: Sequence[Curve], title: str, metric: str, clock: str) -> None:
        self.curves, self.title, self.metric, self.clock = curves, title, metric, clock
        self.right = WIDTH - min(NAMES_AT + 20 + max(_width(c.name) for c in curves), WIDEST_NAMES)
        self.x = _Axis([s for c in curves for s in c.seconds], LEFT, self.right)
        self.y = _Axis([e for c in curves for e in [*c.low, *c.high]], BOTTOM, HEIGHT - TOP)
        self.shader = compat.uniform_colour_shader()

    def draw(self) -> None:
        self._frame()
        for i, curve in enumerate(self.curves):
            colour = COLOURS[i % len(COLOURS)]
            xs = [self.x.place(s) for s in curve.seconds]
            band = []
            for x, low, high in zip(xs, curve.low, curve.high):
                band += [(x, self.y.place(low)), (x, self.y.place(high))]
            self._shape("TRI_STRIP", band, (*colour, 0.2))
            line = [(x, self.y.place(e)) for x, e in zip(xs, curve.error)]
            self._line(line, (*colour, 1.0))
            for x, y in line:
                self._square(x, y, 4, (*colour, 1.0))
            y = HEIGHT - TOP - 24 - 40 * i
            self._square(self.right + 26, y + 9, 9, (*colour, 1.0))
            _text(curve.name, self.right + NAMES_AT, y)

    def _frame(self) -> None:
        for value, label in self.x.ticks():
            x = self.x.place(value)
            self._shape("LINES", [(x, BOTTOM), (x, HEIGHT - TOP)], GRID)
            _text(label, x, BOTTOM - 36, "CENTRE")
        for value, label in self.y.ticks():
            y = self.y.place(value)
            self._shape("LINES", [(LEFT, y), (self.right, y)], GRID)
            _text(label, LEFT - 12, y - 9, "RIGHT")
        corners = [(LEFT, BOTTOM), (self.right, BOTTOM), (self.right, HEIGHT - TOP), (LEFT, HEIGHT - TOP)]
        self._shape("LINE_STRIP", [*corners, corners[0]], INK)
        _text("CPU seconds" if self.clock == "cpu" else "seconds", (LEFT + self.right) / 2, 24, "CENTRE")
        _text(self.metric, 36, (BOTTOM + HEIGHT - TOP) / 2, "CENTRE", upright=True)
        _text(f"{self.title}: error against time, bands of 95 %", LEFT, HEIGHT - 44)

    def _shape(self, kind: str, points: Sequence[tuple[float, float]], colour: Sequence[float]) -> None:
        batch = batch_for_shader(self.shader, kind, {"pos": [(x, y, 0.0) for x, y in points]})
        gpu.state.blend_set("ALPHA")  # each time: text ends without
        self.shader.bind()
        self.shader.uniform_float("color", colour)
        batch.draw(self.shader)
        gpu.state.blend_set("NONE")

    def _square(self, x: float, y: float, half: float, colour: Sequence[float]) -> None:
        corners = [(x - half, y - half), (x + half, y - half), (x - half, y + half), (x + half, y + half)]
        self._shape("TRI_STRIP", corners, colour)

    def _line(self, points: Sequence[tuple[float, float]], colour: Sequence[float]) -> None:
        """Two pixels to each side: how wide lines may be is up to the driver."""
        for (x0, y0), (x1, y1) in itertools.pairwise(points):
            length = math.hypot(x1 - x0, y1 - y0) or 1.0
            nx, ny = -2 * (y1 - y0) / length, 2 * (x1 - x0) / length
            quad = [(x0 + nx, y0 + ny), (x0 - nx, y0 - ny), (x1 + nx, y1 + ny), (x1 - nx, y1 - ny)]
            self._shape("TRI_STRIP", quad, colour)


class _Axis:
    """A logarithmic scale from pixel `start` to pixel `end`."""

    def __init__(self, values: Sequence[float], start: float, end: float) -> None:
        self.low, self.high = math.log10(min(values)), math.log10(max(values))
        room = max(0.05 * (self.high - self.low), 0.05)
        self.low, self.high = self.low - room, self.high + room
        self.start, self.end = start, end

    def place(self, value: float) -> float:
        return self.start + (self.end - self.start) * (math.log10(value) - self.low) / (self.high - self.low)

    def ticks(self) -> list[tuple[float, str]]:
        steps: tuple[int, ...] = (1,) if self.high - self.low > 2 else (1, 2, 5)
        values = [m * 10.0**k for k in range(math.floor(self.low), math.ceil(self.high) + 1) for m in steps]
        return [(v, f"{v:g}") for v in values if self.low <= math.log10(v) <= self.high]


def _width(text: str) -> float:
    compat.text_size(FONT, TEXT_SIZE)
    return float(blf.dimensions(FONT, text)[0])


def _text(text: str, x: float, y: float, align: str = "LEFT", upright: bool = False) -> None:
    """`upright`: from below to above, (x, y) is where its line is aligned."""
    before = {"LEFT": 0.0, "CENTRE": 0.5, "RIGHT": 1.0}[align] * _width(text)
    blf.color(FONT, *INK)
    blf.position(FONT, *((x, y - before) if upright else (x - before, y)), 0)
    if upright:
        blf.enable(FONT, blf.ROTATION)
        blf.rotation(FONT, math.pi / 2)
    blf.draw(FONT, text)
    blf.disable(FONT, blf.ROTATION)
