"""Long calls of the library: their progress, and their end by Ctrl-C."""

import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from spintop.library import PROGRESS, InputError, library

Progress = bool | Callable[[float], object]
"""True for a line on standard error, or a function of the share that is done, from 0 to 1."""
PAUSE = 0.1
"""Seconds between two reports of the progress, and until a signal is handled at the latest."""


class Call:
    """A call in a thread of its own, while the calling one waits for signals and reports."""

    def __init__(self, function: Callable[..., Any], arguments: tuple) -> None:
        """Prepare a call."""
        self.function, self.arguments = function, arguments
        self.result: Any = None
        self.error: BaseException | None = None
        self.share = 0.0
        self.stops = False
        self.asks = PROGRESS(self.answer)
        # A thread whose `join` is interrupted is taken to have ended by some versions of Python.
        self.ended = threading.Event()
        self.thread = threading.Thread(target=self.work, daemon=True)

    def answer(self, share: float, _: object) -> int:
        """Note how far the call is, and say whether it is to stop."""
        self.share = share
        return int(self.stops)

    def work(self) -> None:
        """Do the work."""
        try:
            library().spintop_on_progress(self.asks, None)
            self.result = self.function(*self.arguments)
        except BaseException as error:
            self.error = error
        finally:
            self.ended.set()

    def wait(self, report: Callable[[float], object] | None) -> None:
        """Wait for the end, and report the progress up to there.

        A signal does not end a waiting that begins just after it, nor is the waiting thread told
        of one that another takes: it looks for signals after each pause.
        """
        while not self.ended.wait(PAUSE):
            if report:
                report(self.share)

    def run(self, report: Callable[[float], object] | None) -> Any:
        """Run the call. What interrupts the waiting, as Ctrl-C does, stops the call."""
        try:
            self.thread.start()
            self.wait(report)
        except BaseException:
            self.stops = True
            while self.thread.ident and not self.ended.is_set():
                with suppress(KeyboardInterrupt):
                    self.ended.wait()
            raise
        if self.error:
            raise self.error
        return self.result


def call(function: Callable[..., Any], *arguments: Any, progress: Progress = False) -> Any:
    """Call a function of the library that may take long."""
    if progress is not True and progress and not callable(progress):
        raise InputError("progress is True, or a function of the share that is done", code=2)
    report = show if progress is True else progress or None
    result = Call(function, arguments).run(report)
    if report:
        report(1.0)
    return result


def show(share: float) -> None:
    """Show the share that is done, in one line."""
    end = "\n" if share >= 1 else ""
    print(f"\rspintop: {share:4.0%}", end=end, file=sys.stderr, flush=True)
