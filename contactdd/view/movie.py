"""Animations: frames of pixels written as a GIF (pillow) or as an MP4 (ffmpeg)."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

#: Pictures of (height, width, 3) bytes.
Frames = Iterable[NDArray[np.uint8]]


def write_gif(path: Path, frames: Frames, per_second: float) -> None:
    """Write a GIF that runs for ever."""
    from PIL import Image

    first, *others = (Image.fromarray(frame) for frame in frames)
    first.save(path, save_all=True, append_images=others, duration=1000.0 / per_second, loop=0)


def write_mp4(path: Path, frames: Frames, per_second: float) -> None:
    """Write an MP4 that any player reads. Raises RuntimeError without ffmpeg, or where that fails."""
    program = ffmpeg()
    shown = [frame[: len(frame) // 2 * 2, : frame.shape[1] // 2 * 2] for frame in frames]  # H.264 wants even numbers
    height, width, _ = shown[0].shape
    given = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", f"{per_second:g}", "-i", "-"]
    command = [program, "-y", "-loglevel", "error", *given, "-pix_fmt", "yuv420p", str(path)]
    done = subprocess.run(command, input=np.stack(shown).tobytes(), capture_output=True)
    if done.returncode != 0:
        raise RuntimeError(f"path = {str(path)!r}: ffmpeg failed: {done.stderr.decode(errors='replace').strip()}")


def ffmpeg() -> str:
    """The program: the system's, or that of the package imageio-ffmpeg."""
    program = shutil.which("ffmpeg")
    if program is not None:
        return program
    try:
        from imageio_ffmpeg import get_ffmpeg_exe
    except ImportError:
        raise RuntimeError("an .mp4 needs ffmpeg: install it, or imageio-ffmpeg, or write a .gif") from None
    return get_ffmpeg_exe()


#: What writes an animation, by the file's ending.
WRITERS = {".gif": write_gif, ".mp4": write_mp4}
