# SPDX-License-Identifier: GPL-3.0-or-later
"""The native renderer as a process: finding it, its arguments, and its events without blocking. No bpy in here."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import shutil
import signal
import stat
import subprocess
import threading
from collections import deque
from pathlib import Path
from typing import Any

BINARY = "wardmis.exe" if os.name == "nt" else "wardmis"
PACKAGED = Path(__file__).parent / "bin" / BINARY
VARIABLE = "WARDMIS_BINARY"
GRACE_SECONDS = 1.0
STOPPED = 130  # the exit code of what the user has stopped


class RendererError(Exception):
    """The renderer could not be found or started, or failed; the message is for the user."""


def find_renderer(chosen: str) -> Path:
    """The renderer's path: `chosen` (the preferences), else the packaged one, else $WARDMIS_BINARY, else on the PATH."""
    if chosen:
        return _existing(chosen, "the add-on's preferences name")
    if PACKAGED.is_file():
        _make_executable(PACKAGED)
        return PACKAGED
    if os.environ.get(VARIABLE):
        return _existing(os.environ[VARIABLE], f"the environment variable {VARIABLE} names")
    on_path = shutil.which(BINARY)
    if on_path is None:
        raise RendererError(
            f"the renderer '{BINARY}' was not found: the add-on's preferences name none, there is none at {PACKAGED}, "
            f"the environment variable {VARIABLE} is not set, and none is on the PATH; "
            "install the packaged add-on, or set the path in Preferences > Add-ons > WardMIS"
        )
    return Path(on_path)


def _existing(path: str, named_by: str) -> Path:
    if not Path(path).is_file():
        raise RendererError(f"there is no renderer at {path}, which {named_by}; correct the path or clear it")
    return Path(path)


def _make_executable(path: Path) -> None:
    """Blender unpacks add-ons without the permission to run their files."""
    if not os.access(path, os.X_OK):
        try:
            path.chmod(path.stat().st_mode | stat.S_IXUSR | stat.S_IXGRP | stat.S_IXOTH)
        except OSError as error:
            raise RendererError(
                f"the renderer {path} may not be run, and cannot be made to ({error}); chmod +x it"
            ) from error


def _identities(program: str) -> dict[Path, tuple[int, ...]]:
    """Of its files, the packaged libraries beside it included: what one that is written anew does not share with the one before."""
    found: dict[Path, tuple[int, ...]] = {}
    for path in (Path(program), *(Path(program).parent / "lib").glob("*")):
        with contextlib.suppress(OSError):
            status = path.stat()
            found[path] = (status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns)
    return found


def version(path: Path) -> str:
    """What `wardmis --version` says."""
    try:
        done = subprocess.run(
            [path, "--version"], capture_output=True, text=True, errors="replace", timeout=10, stdin=subprocess.DEVNULL
        )
    except OSError as error:
        raise RendererError(f"{path} cannot be run: {error.strerror or error}") from error
    except subprocess.TimeoutExpired as error:
        raise RendererError(
            f"{path} --version did not answer within 10 seconds; is it the WardMIS renderer?"
        ) from error
    if done.returncode != 0 or not done.stdout.startswith("wardmis"):
        raise RendererError(
            f"{path} is not the WardMIS renderer: --version said '{(done.stdout or done.stderr).strip()[:200]}'"
        )
    return done.stdout.strip().splitlines()[0]


class Renderer:
    """A running renderer. Leaving the `with` block ends it in any case."""

    def __init__(
        self, command: list[str], name: str = "the renderer", environment: dict[str, str] | None = None
    ) -> None:
        """`name` is what messages call it; `environment` its variables, by default Blender's own."""
        self.path = command[0]
        self._name = name
        self._files = _identities(self.path)
        self._events: queue.SimpleQueue[dict[str, Any] | None] = queue.SimpleQueue()  # None: it has ended
        self._tail: deque[str] = deque(maxlen=6)  # of what it said besides events
        self._error: dict[str, Any] | None = None
        try:
            # its own session: a Ctrl-C on the terminal is Blender's, which then stops the renderer itself
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                start_new_session=True,
                env=environment,
            )
        except OSError as error:
            raise RendererError(f"{name} {command[0]} cannot be run: {error.strerror or error}") from error
        self._readers = [
            threading.Thread(target=self._read_events, daemon=True),
            threading.Thread(target=self._read_messages, daemon=True),
        ]
        for reader in self._readers:
            reader.start()

    def __enter__(self) -> Renderer:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def _read_events(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            try:
                event = json.loads(line)
            except ValueError:
                event = None
            if not isinstance(event, dict):
                self._say(line)
            elif event.get("event") == "error":
                self._error = event
            else:
                self._events.put(event)
        self._process.wait()
        self._events.put(None)  # who waits for an event need not wait any longer

    def _read_messages(self) -> None:
        assert self._process.stderr is not None
        for line in self._process.stderr:
            self._say(line)

    def _say(self, line: bytes) -> None:
        text = line[:300].decode("utf-8", "replace").strip()
        if text:
            self._tail.append(text)

    def running(self) -> bool:
        return self._process.poll() is None

    def exit_code(self) -> int | None:
        return self._process.poll()

    def was_replaced(self) -> bool:
        """Whether a file of it is another one than at its start: Blender installs over it, and the process then crashes."""
        return _identities(self.path) != self._files

    def interrupt(self) -> None:
        """Asks it to end with what it has done so far, as Ctrl-C does; returns at once."""
        if os.name == "nt":  # there is no such signal for a single process
            self._process.terminate()
        else:
            self._process.send_signal(signal.SIGINT)

    def events(self, wait_seconds: float) -> list[dict[str, Any]]:
        """The events so far; waits for the first one, or for the end, up to `wait_seconds`."""
        events: list[dict[str, Any] | None] = []
        with contextlib.suppress(queue.Empty):
            events.append(self._events.get(timeout=wait_seconds))
            while True:
                events.append(self._events.get_nowait())
        return [event for event in events if event is not None]

    def finish(self) -> list[dict[str, Any]]:
        """After the process has ended: its last events. Raises RendererError, with what it said, if it failed."""
        for reader in self._readers:
            reader.join(GRACE_SECONDS)
        code = self._process.wait()
        if code != 0:
            raise RendererError(self._failure(code))
        return self.events(0)

    def said(self) -> str:
        """The end of what it said besides events, for messages."""
        return f"; it said: {' | '.join(self._tail)}" if self._tail else ""

    def _failure(self, code: int) -> str:
        if self._error is not None:
            return f"{self._name} failed (exit code {code}): {self._error.get('message', 'no message')}"
        if code < 0 and self.was_replaced():
            return (
                f"{self._name} was replaced while it ran, as by an add-on that is installed again, and could not go on; "
                "render or compare again"
            )
        if code < 0:
            with contextlib.suppress(ValueError):
                return f"{self._name} crashed ({signal.Signals(-code).name}){self.said()}"
        return f"{self._name} failed (exit code {code}){self.said() or ' without a message'}"

    def stop(self) -> None:
        """Ends the process, gently for a moment, then not; closes what connects to it."""
        process = self._process
        if process.poll() is None:
            process.terminate()
            try:
                process.wait(GRACE_SECONDS)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        for reader in self._readers:
            reader.join(GRACE_SECONDS)
        for stream in (process.stdin, process.stdout, process.stderr):
            with contextlib.suppress(OSError):
                if stream is not None:
                    stream.close()
