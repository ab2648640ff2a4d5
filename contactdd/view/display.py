"""A display for pictures where there is none.

VTK before 9.5 ends the whole process when it finds no X server, so one without a screen is started first.
"""

from __future__ import annotations

import atexit
import os
import shutil
import subprocess
import sys


def ensure_display() -> None:
    """Make sure that VTK can draw off screen. Raises RuntimeError where that takes a program that is missing."""
    import vtk

    draws_without = (vtk.VTK_MAJOR_VERSION, vtk.VTK_MINOR_VERSION) >= (9, 5)
    if os.environ.get("DISPLAY") or sys.platform != "linux" or draws_without:
        return
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
    os.environ["DISPLAY"] = f":{number}"
