"""Long calls from Python: their progress, and their end by Ctrl-C or by an exception."""

import contextlib
import io
import os
import signal
import tempfile
import threading
import unittest
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np

import python_library  # noqa: F401
import spintop
from spintop import runs
from spintop.library import PROGRESS

PATIENCE = 60  # s
TOP = {"mass": 1, "inertia": (0.9, 1.0, 0.3), "length": 0.5}
START = {"theta": 1.0, "psi_rate": 9.0}
LONG = {"top": TOP, "initial": START, "span": {"t_end": 1e9, "samples": 11}}
LONG["integration"] = {"max_steps": 2147483646}
SHORT = {"top": TOP, "initial": START, "span": {"t_end": 1.0, "samples": 11}}
LANES = {"top": TOP, "span": {"t_end": 1e4}, "output": {"columns": ("theta_end", "psi_end")}}
ANGLES = {"initial.theta": np.linspace(0.5, 2.5, 100_000)}
FRICTION = {**LANES, "effects": {"friction_torque": 1e-9}}


def long_fit() -> spintop.Result:
    t = np.linspace(0, 2e4, 100_001)
    data = {"t": t, "theta": 1 + 0.1 * np.cos(t), "phi": t}
    given = {"top": {**TOP, "damping": (0, 0, 1e-9)}, "initial": START}
    return spintop.fit(data, ["top.mass", "initial.theta"], given)


CALLS: dict[str, Callable[[], Any]] = {
    "motion": lambda: spintop.run(LONG),
    "sweep in lanes": lambda: spintop.sweep(LANES, ANGLES),
    "sweep one after another": lambda: spintop.sweep(FRICTION, ANGLES),
    "fit": long_fit,
}


class InterruptTest(unittest.TestCase):
    """The package is as before after each end."""

    def setUp(self) -> None:
        """Heed Ctrl-C, which a shell has its background jobs ignore."""
        inherited = signal.signal(signal.SIGINT, signal.default_int_handler)
        self.addCleanup(signal.signal, signal.SIGINT, inherited)

    def check_usable(self) -> None:
        assert len(spintop.run(SHORT).rows["theta"]) == 11

    def interrupt(self, function: Callable[[], Any], *, computing: bool = False) -> None:
        """One Ctrl-C ends a call, which would take hours, soon enough on a busy machine, too.

        It is sent when the library asks for the first time whether it is to stop: then it computes.
        So it does if the computing thread takes the signal, as the system may choose.
        """
        asked, ended, sent_again = threading.Event(), threading.Event(), []

        def noting(answer: Callable[[float, object], int]) -> object:
            return PROGRESS(lambda *words: asked.set() or answer(*words))

        def send() -> None:
            if not asked.wait(PATIENCE) or ended.is_set():
                return
            if computing:
                taking = next(thread for thread in threading.enumerate() if thread.daemon)
                signal.pthread_kill(taking.ident, signal.SIGINT)
            else:
                os.kill(os.getpid(), signal.SIGINT)
            if not ended.wait(PATIENCE):
                sent_again.append(True)
                signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)

        self.addCleanup(asked.set)
        self.addCleanup(ended.set)
        with mock.patch.object(runs, "PROGRESS", noting), self.assertRaises(KeyboardInterrupt):
            threading.Thread(target=send).start()
            function()
        ended.set()
        assert sent_again == []
        self.check_usable()

    def test_interrupts(self) -> None:
        """Of a motion, of sweeps and of a fit, by a signal to each thread."""
        for name, function in CALLS.items():
            for computing in (False, True):
                with self.subTest(name, computing=computing):
                    self.interrupt(function, computing=computing)

    def test_files(self) -> None:
        """A file of an interrupted run is not there, or it is a part."""
        with tempfile.TemporaryDirectory() as folder:
            self.interrupt(lambda: spintop.run(LONG, folder=folder))
            assert list(Path(folder).glob("*.csv")) == []

    def test_progress(self) -> None:
        """The shares increase to 1; an exception of the function ends the call."""
        shares = []
        few = {"initial.theta": np.linspace(0.5, 2.5, 4000)}
        given = {**FRICTION, "span": {"t_end": 5}}
        found = spintop.sweep(given, few, progress=shares.append, threads=2)
        assert len(found.rows["psi_end"]) == 4000
        assert shares == sorted(shares)
        assert shares[-1] == 1
        assert len(set(shares)) > 2

        def fail(share: float) -> None:
            raise ZeroDivisionError(share)

        with self.assertRaises(ZeroDivisionError):
            spintop.run(LONG, progress=fail)
        self.check_usable()

    def test_line(self) -> None:
        """True shows a line; other values are refused."""
        with contextlib.redirect_stderr(io.StringIO()) as shown:
            spintop.run(SHORT, progress=True)
        assert shown.getvalue().endswith("spintop: 100%\n")
        with self.assertRaisesRegex(spintop.InputError, "progress is True, or a function"):
            spintop.run(SHORT, progress="bar")

    def test_columns(self) -> None:
        """Columns are an argument for a dictionary, and keys of other inputs."""
        found = spintop.run(SHORT, columns="theta")
        assert set(found.rows) == {"theta"}
        swept = spintop.sweep(LANES, {"initial.theta": [0.5]}, columns=("phi_end",))
        assert "phi_end" in swept.rows
        with self.assertRaisesRegex(spintop.InputError, r"output\.columns"):
            spintop.run("&top mass = 1 /", columns="theta")

    def test_other_names(self) -> None:
        """Names of other programs lead to those of the keys."""
        top = spintop.Top(spintop.Body(**TOP), **START)
        with self.assertRaisesRegex(spintop.InputError, "did you mean 'relative_tolerance'"):
            top.integrate([1.0], rtol=1e-9)
        with self.assertRaisesRegex(spintop.InputError, "did you mean 'inertia'"):
            spintop.Top(spintop.Body(mass=1, I=(1, 1, 1), length=0.1), theta=1)
