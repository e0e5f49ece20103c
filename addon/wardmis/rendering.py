# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether Blender is rendering with this add-on's engine, how to make it end, and how fast the last one was.

In a window Blender renders in a thread of its own. An engine that is unregistered meanwhile is freed under it, and Blender crashes.
Blender is done with the engine when it calls the handlers of the render's end; until then it may be evaluating the scene for it, be in
its render(), or be about to call that for the next view layer or frame.

That of any other engine, too: with it Blender frees all engines, as Reload Scripts does with Cycles before it comes to this add-on.
So before an add-on with an engine is disabled, the render is ended.
"""

from __future__ import annotations

import contextlib
import functools
import threading
import time
from collections.abc import Callable
from typing import Any

import addon_utils  # type: ignore[import-not-found]
import bpy

ENGINE = "WARDMIS"
LONGEST_SECONDS = 60.0  # that the evaluation of a scene may take, which nothing can stop
START_SECONDS = 0.5  # within which a thread that has been started is in the render
LOOK_SECONDS = 0.02

_thread: int | None = None  # that renders
_stopping = False
_speed: float | None = None  # camera samples a second, of the last render


def speed() -> float | None:
    return _speed


def note_speed(samples: float, seconds: float) -> None:
    """`samples` of the camera, all pixels together."""
    global _speed
    _speed = samples / seconds if samples > 0 and seconds > 0 else None


def stopping() -> bool:
    """Whether the renders are to end, now and with an error, so that Blender begins no further one of an animation."""
    return _stopping


def end() -> None:
    """Ends the render that is under way, and waits for it. Raises RuntimeError where that cannot be."""
    global _stopping
    if _thread is None and bpy.app.is_job_running("RENDER"):
        _wait(lambda: _thread is not None, START_SECONDS)  # if not, its end alone has not been noticed yet
    if _thread is None:
        return
    if _thread == threading.get_ident():
        raise RuntimeError("WardMIS: the add-on cannot be removed by what runs within a render with it")
    _stopping = True
    try:
        ended = _wait(lambda: _thread is None, LONGEST_SECONDS)
    finally:
        _stopping = False
    if not ended:
        raise RuntimeError(
            f"WardMIS: Blender is rendering, and has not stopped within {LONGEST_SECONDS:.0f} s; the add-on cannot be removed "
            "meanwhile. Stop the render, then disable the add-on again"
        )


def _wait(condition: Any, seconds: float) -> bool:
    deadline = time.monotonic() + seconds
    while not condition() and time.monotonic() < deadline:
        time.sleep(LOOK_SECONDS)  # and lets the render's Python go on
    return bool(condition())


@bpy.app.handlers.persistent
def _on_start(*_: Any) -> None:
    """The scene's own engine does not tell: a sequence or the compositor may render others."""
    global _thread
    if any(scene.render.engine == ENGINE for scene in bpy.data.scenes):
        _thread = threading.get_ident()


@bpy.app.handlers.persistent
def _on_end(*_: Any) -> None:
    global _thread
    _thread = None


def _brings_an_engine(module: str) -> bool:
    return any(engine.__module__.split(".")[: module.count(".") + 1] == module.split(".") for engine in _engines())


def _engines() -> list[type]:
    engines, found = [bpy.types.RenderEngine], []
    while engines:
        engines += (more := engines.pop().__subclasses__())
        found += more
    return found


def _ending_before(disable: Callable[..., Any]) -> Callable[..., Any]:
    """Blender's function that disables an add-on, with an end to the render before one with an engine goes."""

    @functools.wraps(disable)
    def disable_after_end(module_name: str, *arguments: Any, **named: Any) -> Any:
        if _brings_an_engine(module_name):
            end()
        return disable(module_name, *arguments, **named)

    return disable_after_end


_disable: Callable[..., Any] | None = None  # Blender's own, while ours is in its place

_HANDLERS = (("render_init", _on_start), ("render_complete", _on_end), ("render_cancel", _on_end))


def register() -> None:
    global _disable
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)
    _disable = addon_utils.disable
    addon_utils.disable = _ending_before(_disable)


def unregister() -> None:
    global _disable
    for name, handler in _HANDLERS:
        with contextlib.suppress(ValueError):
            getattr(bpy.app.handlers, name).remove(handler)
    if getattr(addon_utils.disable, "__wrapped__", None) is _disable:  # nobody else's is around it
        addon_utils.disable = _disable
    _disable = None
