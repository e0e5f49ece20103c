# SPDX-License-Identifier: GPL-3.0-or-later
"""Ctrl-C during a comparison. No bpy in here.

Blender's own answer to it is of no use: it ends a render that is under way, calls that a success and hands out what there is of the
image, and forgets a Ctrl-C that comes between two renders. So the command takes the signal over. Python's handlers wait until Blender
comes back from what it does, which a long render does late: a thread, which does not wait, ends the process then. That loses nothing
but the render, since files become what they are called only once they are whole.
"""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import threading
from collections.abc import Callable, Iterator

from ..process import STOPPED


class Stopped(RuntimeError):
    """The comparison was stopped by the user; the message says how it goes on."""

    def __init__(self, place: object) -> None:
        super().__init__(
            f"WardMIS: stopped; {place} keeps what is done, and the same comparison again goes on from there"
        )


_requested = False
_busy: object = None  # the folder of a comparison that Blender does not come back from for long


def requested() -> bool:
    return _requested


def check(place: object) -> None:
    """Raises Stopped where a Ctrl-C has come; `place` is the folder that keeps what is done."""
    if _requested:
        raise Stopped(place)


@contextlib.contextmanager
def busy(place: object) -> Iterator[None]:
    """A part that may be ended at any moment, and with it the process: nothing that it does needs an end."""
    global _busy
    check(place)
    _busy = place
    try:
        yield
    finally:
        _busy = None
    check(place)


@contextlib.contextmanager
def caught(end: Callable[[str], None], place: object) -> Iterator[None]:
    """Ctrl-C is requested() in here; in a busy() part, or a second time, the process ends with STOPPED, after `end` is told why."""
    global _requested
    _requested = False
    ours, pythons = socket.socketpair()
    pythons.setblocking(False)

    def watch() -> None:
        global _requested
        while received := ours.recv(64):
            again, _requested = _requested, True
            if again or _busy is not None or len(received) > 1:
                end(str(Stopped(_busy or place)))
                os._exit(STOPPED)

    before = signal.signal(signal.SIGINT, lambda *_: None)
    pipe = signal.set_wakeup_fd(pythons.fileno())
    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        signal.set_wakeup_fd(pipe)
        signal.signal(signal.SIGINT, signal.SIG_DFL if before is None else before)
        pythons.close()  # the watcher receives nothing, and ends
        watcher.join()
        ours.close()
