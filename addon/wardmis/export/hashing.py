# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' random numbers of objects, curves and points."""

from __future__ import annotations

import numpy as np


def random_numbers(count: int) -> np.ndarray:
    """Of the numbers 0 to count - 1, (count,) float32 from 0 to 1."""
    return unit(hash_of(np.arange(count, dtype=np.uint32)))


def unit(words: np.ndarray) -> np.ndarray:
    """Words of 32 bits as float32 from 0 to 1, to the last bit as Cycles makes them of words: white noise shows each bit."""
    return words.astype(np.float32) * (np.float32(1) / np.float32(0xFFFFFFFF))


def hash_of(x: np.ndarray) -> np.ndarray:
    """Jenkins' of the words x and 0, uint32."""
    with np.errstate(over="ignore"):
        seed = np.uint32((0xDEADBEEF + (2 << 2) + 13) & 0xFFFFFFFF)
        a, b, c = x + seed, np.full_like(x, seed), np.full_like(x, seed)

        def turned(v: np.ndarray, bits: int) -> np.ndarray:
            return (v << np.uint32(bits)) | (v >> np.uint32(32 - bits))

        c = (c ^ b) - turned(b, 14)
        a = (a ^ c) - turned(c, 11)
        b = (b ^ a) - turned(a, 25)
        c = (c ^ b) - turned(b, 16)
        a = (a ^ c) - turned(c, 4)
        b = (b ^ a) - turned(a, 14)
        return (c ^ b) - turned(b, 24)


def random_of(instance: int | None, name: str) -> float:
    """Object Info's Random: of an instance's number, else of a hash of the object's name, as Cycles makes it."""
    if instance is None:
        number = 0
        for byte in name.encode():
            number = (number * 37 + byte) & 0xFFFFFFFF
        instance = int(hash_of(np.array([number], np.uint32))[0])
    return float(unit(np.array([instance & 0xFFFFFFFF], np.uint32))[0])
