# SPDX-License-Identifier: GPL-3.0-or-later
"""The seed of a frame. Cycles' animated seed is a hash of frame and seed (Bob Jenkins' final mixing of three words), and so is this one:
with the same settings both engines' noise changes in the same frames."""

from __future__ import annotations

from typing import Any

WORD = 0xFFFFFFFF
LARGEST_INT = 0x7FFFFFFF


def seed_of(scene: Any) -> int:
    """Of the scene's current frame."""
    settings = scene.wardmis
    if not settings.use_animated_seed:
        return int(settings.seed)
    return animated(settings.seed, scene.frame_current, scene.frame_subframe)


def animated(seed: int, frame: int, subframe: float = 0.0) -> int:
    result = mixed(frame, seed)
    if subframe:
        result += mixed(int(subframe * (LARGEST_INT + 1)), seed)
    return result & WORD


def mixed(x: int, y: int) -> int:
    a = b = c = (0xDEADBEEF + 8 + 13) & WORD  # 8: bytes that are mixed
    a, b = (a + x) & WORD, (b + y) & WORD
    words = [a, b, c]
    # each word in turn takes in the one before it, and loses that one's rotation
    for target, source, turn in ((2, 1, 14), (0, 2, 11), (1, 0, 25), (2, 1, 16), (0, 2, 4), (1, 0, 14), (2, 1, 24)):
        word = words[source]
        words[target] = ((words[target] ^ word) - (word << turn | word >> (32 - turn))) & WORD
    return words[2]
