# SPDX-License-Identifier: GPL-3.0-or-later
"""The comparison as a command: `./dev compare`, blend/compare.py, and `blender --command wardmis compare` from 4.2 on."""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import shutil
import sys
import time
from collections.abc import Iterator
from typing import Any

import bpy

from ..process import STOPPED
from . import interrupt
from .converge import DEFAULT_CONFIGURATIONS
from .estimate import duration
from .run import compare, size_of

REDRAW_SECONDS = 0.5
LINE_SECONDS = 10.0  # where the output is no terminal

_command: Any = None


def parser(program: str) -> argparse.ArgumentParser:
    result = argparse.ArgumentParser(
        prog=program, description="Compares configurations of WardMIS, and Cycles, on the scene of a Blender file."
    )
    result.add_argument("-o", "--output", required=True, metavar="DIR", help="where everything goes, report.html too")
    result.add_argument(
        "-c",
        "--configuration",
        action="append",
        metavar="SPEC",
        help=f"an allocation, NAME:key=value,..., or 'scene' for the scene's settings; repeatable ({', '.join(DEFAULT_CONFIGURATIONS)})",
    )
    result.add_argument("--baseline", metavar="NAME", help="that the others are compared with (the first)")
    result.add_argument(
        "--seeds", type=int, default=16, metavar="N", help="renders of each configuration (%(default)s)"
    )
    result.add_argument("--seed", type=int, default=1, metavar="FIRST", help="the first one's (%(default)s)")
    result.add_argument("--max-spp", type=int, default=64, metavar="N", help="samples per pixel (%(default)s)")
    result.add_argument(
        "--budget-seconds", type=float, metavar="S", help="instead: of all; with Cycles, half of it is Cycles'"
    )
    result.add_argument("--reference", metavar="FILE.exr", help="a given one")
    result.add_argument("--reference-time", type=float, metavar="S", help="of the reference that is made")
    result.add_argument("--target", type=float, metavar="E", help="relMSE that the time is taken to")
    result.add_argument("--no-cycles", action="store_true", help="WardMIS alone")
    result.add_argument("--cycles-seeds", type=int, metavar="N", help="renders of Cycles (as --seeds)")
    result.add_argument(
        "--cycles-reference-spp", type=int, metavar="N", help="of each of its reference images (8 x --max-spp)"
    )
    result.add_argument("--as-is", action="store_true", help="Cycles with the file's settings, biases included")
    result.add_argument("--resolution", type=_size, metavar="WxH", help="instead of the file's")
    result.add_argument("--title", help="of the report (the file's name)")
    result.add_argument("--threads", type=int, metavar="T", help="of both renderers (the scene's, else all)")
    return result


def _size(text: str) -> tuple[int, int]:
    try:
        return size_of(text)
    except RuntimeError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def main(words: list[str], program: str = "wardmis compare") -> int:
    """For the scene that is open. Returns the exit code."""
    options = parser(program).parse_args(words)
    watch = Watch()
    place, temporary = os.path.abspath(options.output), bpy.app.tempdir

    def end(message: str) -> None:
        watch.stopped(message)
        shutil.rmtree(temporary, ignore_errors=True)  # Blender's own end does it

    try:
        with _without_blenders_own_progress(), interrupt.caught(end, place):
            outcome = compare(
                options.output,
                configurations=options.configuration,
                baseline=options.baseline,
                seeds=options.seeds,
                first_seed=options.seed,
                max_spp=options.max_spp,
                budget_seconds=options.budget_seconds,
                reference=options.reference,
                reference_time=options.reference_time,
                target=options.target,
                cycles=not options.no_cycles,
                cycles_seeds=options.cycles_seeds,
                cycles_reference_spp=options.cycles_reference_spp,
                as_is=options.as_is,
                title=options.title,
                resolution=options.resolution,
                threads=options.threads,
                progress=watch,
            )
    except interrupt.Stopped as stopped:
        watch.stopped(str(stopped))
        return STOPPED
    except RuntimeError as error:
        watch.end()
        print(f"error: {error}", file=sys.stderr)
        return 1
    watch.end()
    with open(outcome.report_json, encoding="utf-8") as file:
        report = json.load(file)
    print(*report["finding"], outcome.report_html, report["verdict"]["text"], sep="\n")
    return 0


@contextlib.contextmanager
def _without_blenders_own_progress() -> Iterator[None]:
    """Blender prints a line for each step of each render to standard output, without being asked and with no way to turn it off."""
    sys.stdout.flush()
    kept = os.dup(1)
    try:
        with open(os.devnull, "wb") as nowhere:
            os.dup2(nowhere.fileno(), 1)
        yield
    finally:
        sys.stdout.flush()
        os.dup2(kept, 1)
        os.close(kept)


class Watch:
    """Shows the events on standard error: in one line that is rewritten on a terminal, else now and then in a line of its own."""

    def __init__(self) -> None:
        self.terminal = sys.stderr.isatty()
        self.next = 0.0
        self.phase: object = None
        self.open = False

    def __call__(self, event: dict[str, Any]) -> None:
        kind, now = event.get("event"), time.monotonic()
        if kind == "warning":
            self.end()
            print(f"warning: {event.get('message')}", file=sys.stderr, flush=True)
        elif kind == "progress" and (now >= self.next or event.get("phase") != self.phase):
            self.next = now + (REDRAW_SECONDS if self.terminal else LINE_SECONDS)
            self.phase = event.get("phase")
            line = progress_text(event)
            print(
                f"\r\x1b[K{line}" if self.terminal else line,
                end="" if self.terminal else "\n",
                file=sys.stderr,
                flush=True,
            )
            self.open = self.terminal

    def stopped(self, message: str) -> None:
        self.end()
        print(message, file=sys.stderr, flush=True)

    def end(self) -> None:
        if self.open:
            print(file=sys.stderr)
        self.open = False


def progress_text(event: dict[str, Any], later: float = 0.0) -> str:
    """A progress event in words; `later`: seconds of what comes after what it tells of."""
    parts = [str(event.get("phase", "")).capitalize()]
    if event.get("configuration"):
        parts.append(str(event["configuration"]))
    if event.get("seed") is not None:
        parts.append(f"seed {event['seed']}")
    parts.append(f"{100 * float(event.get('fraction') or 0):.0f} %")
    if event.get("left") is not None:
        parts.append(f"{duration(float(event['left']) + later)} left")
    return ", ".join(parts)


def _run_command(words: list[str]) -> int:
    """blender [FILE.blend] --command wardmis compare [FILE.blend] -o DIR ..."""
    if words[:1] != ["compare"]:
        print(
            "usage: blender [FILE.blend] --command wardmis compare -o DIR ...; --help after it lists the options",
            file=sys.stderr,
        )
        return 2
    words = words[1:]
    if words and words[0].endswith(".blend"):
        try:
            bpy.ops.wm.open_mainfile(filepath=words[0])
        except RuntimeError as error:
            print(f"error: {str(error).strip()}", file=sys.stderr)
            return 1
        words = words[1:]
    return main(words, "blender --command wardmis compare")


def register() -> None:
    global _command
    if hasattr(bpy.utils, "register_cli_command"):  # from 4.2
        _command = bpy.utils.register_cli_command("wardmis", _run_command)


def unregister() -> None:
    global _command
    if _command is not None:
        bpy.utils.unregister_cli_command(_command)
        _command = None
