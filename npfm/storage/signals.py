"""Being told to stop: what a process was writing is removed before it ends."""

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import NoReturn

#: Asked to end by a person, Snakemake or a cluster's queue; the terminal has gone.
ASKED_TO_STOP = (signal.SIGTERM, signal.SIGHUP)


class _Stopped(BaseException):
    """Nothing but a block that cleans up should catch it."""


@contextmanager
def stopping_cleanly() -> Iterator[None]:
    """Let the block clean up when a signal asks the process to stop, then end by that signal.

    A signal that the process ignores (``nohup``) stays ignored.
    """
    received = []

    def stop(number: int, frame: FrameType | None) -> NoReturn:
        received.append(number)
        for again in previous:
            signal.signal(again, signal.SIG_IGN)  # so that nothing interrupts the cleaning
        raise _Stopped

    previous = {number: signal.getsignal(number) for number in ASKED_TO_STOP}
    previous = {number: was for number, was in previous.items() if was is not signal.SIG_IGN}
    for number in previous:
        signal.signal(number, stop)
    try:
        yield
    except _Stopped:
        # The caller is to see what ended the process, as if it had not been caught.
        signal.signal(received[0], signal.SIG_DFL)
        os.kill(os.getpid(), received[0])
    finally:
        for number, was in previous.items():
            signal.signal(number, was)
