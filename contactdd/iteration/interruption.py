"""What signals do to a run: those that end the process let it save its state first; Ctrl-C ends all ranks together."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from ..base.ranks import Ranks

#: Signals by which batch systems, closed terminals and limits of CPU time end a process; not every system has all.
ENDING = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP", "SIGXCPU") if hasattr(signal, name))


#: Seconds that a process which has saved its state has to end by itself before it is ended.
GRACE = 1.0


@contextmanager
def saved_on_signals(save: Callable[[], None]) -> Iterator[None]:
    """Signals that would end the process at once call `save` before they do.

    A thread sees to it where the main one waits for another rank or for a long computation: who sends such a signal
    often gives a second only. Signals that the user handles are left alone; so are all outside of the main thread.
    """
    caught = [number for number in ENDING if signal.getsignal(number) is signal.SIG_DFL]
    if threading.current_thread() is not threading.main_thread() or not caught:
        yield
        return

    def end(number: int, frame: FrameType | None) -> None:
        save()
        signal.signal(number, signal.SIG_DFL)
        os.kill(os.getpid(), number)

    with _watched(caught, save):
        for number in caught:
            signal.signal(number, end)
        try:
            yield
        finally:
            for number in caught:
                signal.signal(number, signal.SIG_DFL)


@contextmanager
def _watched(ending: list[signal.Signals], save: Callable[[], None]) -> Iterator[None]:
    """A thread that receives signals as they come, saves, and ends the process where nothing else does."""
    readable, writable = os.pipe()
    os.set_blocking(writable, False)

    def watch() -> None:
        while numbers := os.read(readable, 1):
            if numbers[0] in (*ending, signal.SIGINT):
                save()
            if numbers[0] in ending:
                time.sleep(GRACE)
                os._exit(128 + numbers[0])

    before = signal.set_wakeup_fd(writable, warn_on_full_buffer=False)
    if before != -1:  # somebody else is told already, such as an event loop
        signal.set_wakeup_fd(before)
    thread = threading.Thread(target=watch, daemon=True, name="contactdd checkpoint")
    thread.start()
    try:
        yield
    finally:
        if before == -1:
            signal.set_wakeup_fd(-1)
        os.close(writable)
        thread.join()
        os.close(readable)


@contextmanager
def interrupts_agreed(ranks: Ranks) -> Iterator[None]:
    """Ctrl-C ends all ranks where they next meet, rather than one of them while the others wait; twice, at once."""
    before = signal.getsignal(signal.SIGINT)
    main = threading.current_thread() is threading.main_thread()
    if ranks.alone or not main or before is not signal.default_int_handler:
        yield
        return

    def ask(number: int, frame: FrameType | None) -> None:
        if ranks.interrupted:
            raise KeyboardInterrupt
        ranks.interrupted = True

    signal.signal(signal.SIGINT, ask)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
