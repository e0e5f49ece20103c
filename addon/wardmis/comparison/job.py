# SPDX-License-Identifier: GPL-3.0-or-later
"""A comparison in the background of a Blender that goes on to be used: processes one after the other, looked at by a timer.

There is one at a time. It ends with Blender, since the processes watch their input, and when another file is loaded, which no add-on
can prevent; what they have rendered stays in the folder.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy

from ..layout import redraw, redraw_status_bars
from ..process import STOPPED, Renderer, RendererError
from .command_line import progress_text

LOOK_SECONDS = 0.25
CANCELLED = "Cancelled; what is done is kept, and Compare goes on from there"


@dataclass
class Stage:
    """A process that prints JSON lines, ends with what it has when interrupted, and at once when its input is closed."""

    name: str  # what messages call it
    command: list[str]
    explain: Callable[[str], str] = str  # what a failure says, to its user
    seconds: float = 0.0  # that it may take, as far as is known before
    then: Callable[[Job], list[Stage]] | None = None  # once it has ended well: what comes next, before all others


class Job:
    def __init__(
        self, begin: Callable[[Job], list[Stage]], finished: Callable[[Job], None], temporary: list[Path]
    ) -> None:
        """`begin` gives the first stages, and may set `folder` and `failed`; so may a stage's `then`. `finished` is called once all
        has ended well, or was stopped; `temporary` are files to be removed at the end."""
        self.folder: Path | None = None  # of the results; where it is not known yet, none
        self.failed: Callable[[], None] = lambda: None  # called after a failure
        self.text = "Starting"
        self.fraction = 0.0
        self.failure = ""  # the message for the user
        self.stopping = False
        self.heard: Callable[[dict[str, Any]], None] = lambda _event: None  # is told of every event
        self.running = True
        self._finished = finished
        self._temporary = temporary
        self._process: Renderer | None = None
        self._stages = begin(self)
        self._stage = self._stages[0]
        self._start_next()

    def _start_next(self) -> None:
        stage = self._stage = self._stages.pop(0)
        self.fraction = 0.0
        self.text = f"{stage.name[0].upper()}{stage.name[1:]} begins"
        try:
            self._process = Renderer(stage.command, stage.name)
        except RendererError as error:
            self._fail(str(error))

    def look(self) -> None:
        """Takes in what has happened. Does not wait."""
        process = self._process
        if not self.running or process is None:
            return
        for event in process.events(0):
            self._take(event)
        if process.running():
            return
        if process.exit_code() == STOPPED:
            self.stopping = True
        else:
            try:
                for event in process.finish():
                    self._take(event)
            except RendererError as error:
                if not self.stopping:  # else it is how the interrupted end
                    self._fail(str(error))
                    return
        process.stop()
        self._process = None
        if self._stage.then is not None and not self.stopping:
            try:
                self._stages[:0] = self._stage.then(self)
            except RuntimeError as error:
                self._fail(str(error))
                return
        if self._stages and not self.stopping:
            self._start_next()
            return
        self.running = False
        self.text = CANCELLED if self.stopping else "Done"
        self._tidy()
        try:
            self._finished(self)
        except RuntimeError as error:
            if not self.stopping:  # else there may be no report yet
                self.failure = str(error)

    def _take(self, event: dict[str, Any]) -> None:
        self.heard(event)
        with contextlib.suppress(KeyError, TypeError, ValueError):
            if event.get("event") == "progress":
                self.fraction = float(event["fraction"])
                self.text = progress_text(event, sum(stage.seconds for stage in self._stages))

    def _fail(self, message: str) -> None:
        self.failure = self._stage.explain(message)
        self.stop()
        self.failed()

    def cancel(self) -> None:
        """Asks the process to end with what it has; a second time ends it."""
        if self.stopping:
            self.text = CANCELLED
            self.stop()
            return
        self.stopping = True
        self.text = "Cancelling"
        if self._process is not None:
            self._process.interrupt()

    def stop(self) -> None:
        """Ends everything now."""
        self.running = False
        if self._process is not None:
            self._process.stop()
            self._process = None
        self._tidy()

    def _tidy(self) -> None:
        for path in self._temporary:
            with contextlib.suppress(OSError):
                path.unlink()
        self._temporary = []


_job: Job | None = None


def current() -> Job | None:
    """The job that runs, or the last one of this file, or that which ended when this file was opened."""
    return _job


def running() -> bool:
    return _job is not None and _job.running


def start(begin: Callable[[Job], list[Stage]], finished: Callable[[Job], None], temporary: list[Path]) -> Job:
    global _job
    if running():
        raise RuntimeError("WardMIS: a comparison is running; wait for it, or cancel it")
    _job = Job(begin, finished, temporary)
    if not bpy.app.timers.is_registered(_look):
        bpy.app.timers.register(_look, first_interval=LOOK_SECONDS, persistent=True)
    return _job


def forget() -> None:
    """Ends what runs, and its message."""
    global _job
    if _job is not None:
        _job.stop()
    _job = None
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)


def _look() -> float | None:
    if _job is None:
        return None
    _job.look()
    redraw()
    if _job.running:
        return LOOK_SECONDS
    redraw_status_bars()  # they say that it runs (leaving.py)
    return None


def ended_text(folder: Path | None) -> str:
    """Of a comparison that ended with its file."""
    text = "Opening a file has ended the comparison"
    if folder is None:
        return f"{text} before anything was rendered"
    return f"{text}. What is done is kept in {folder}; with the earlier file open again, Compare goes on from there"


@bpy.app.handlers.persistent
def _on_load(*_: Any) -> None:
    global _job
    ended = _job if running() else None
    forget()
    if ended is not None:  # that is said in the new file
        ended.stopping, ended.text = True, ended_text(ended.folder)
        _job = ended


def register() -> None:
    bpy.app.handlers.load_pre.append(_on_load)


def unregister() -> None:
    forget()
    bpy.app.handlers.load_pre.remove(_on_load)
