"""A display for pictures where there is none.

VTK before 9.5 ends the whole process when it finds no X server, so one without a screen is started first. Only VTK is
told of it, while it draws: matplotlib would put a window on it, which does not outlive the server at the end.
"""

from __future__ import annotations

import atexit
import functools
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def display() -> Iterator[None]:
    """A context in which VTK can draw off screen. Raises RuntimeError where that takes a program that is missing."""
    import vtk

    draws_without = (vtk.VTK_MAJOR_VERSION, vtk.VTK_MINOR_VERSION) >= (9, 5)
    if os.environ.get("DISPLAY") or sys.platform != "linux" or draws_without:
        yield
        return
    os.environ["DISPLAY"] = _virtual()
    try:
        yield
    finally:
        os.environ.pop("DISPLAY", None)


@functools.cache
def _virtual() -> str:
    """The name of an X server without a screen, which is started at the first call and ends with the process."""
    program = shutil.which("Xvfb")
    if program is None:
        raise RuntimeError("no display: this VTK needs an X server to draw; install xvfb, or VTK >= 9.5")
    reader, writer = os.pipe()
    server = subprocess.Popen(
        [program, "-displayfd", str(writer), "-screen", "0", "1600x1200x24", "-nolisten", "tcp"],
        pass_fds=[writer],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,  # Ctrl-C in the terminal must not take the server away from its user
    )
    os.close(writer)
    atexit.register(server.terminate)
    with os.fdopen(reader) as pipe:
        number = pipe.readline().strip()
    if not number:
        raise RuntimeError("no display: Xvfb did not start")
    return f":{number}"
