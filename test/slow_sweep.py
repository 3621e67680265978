"""A sweep that is slow enough to be interrupted at any moment, and the same in closed form."""

import shutil
import signal
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path

from conftest import KIND, Spin, wait_until

STEPS = "steps = 2000" if KIND == "release" else "steps = 600"
STEPPING = f"formulation = 'lagrange', method = 'rk4', {STEPS}"
SLOW = f"""\
&study kind = 'sweep' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&initial theta_deg = 20 /
&span t_end = 2 /
&integration {STEPPING} /
&sweep parameter(1) = 'initial.psi_rate', from(1) = 1, to(1) = 100, count(1) = 1000 /
"""
"""A few seconds on one thread."""
FAST = SLOW.replace(STEPPING, "method = 'exact'")
PATIENCE = 600
"""Seconds for what ends at once, on a machine that has much else to do."""


@cache
def undisturbed(text: str, *words: str, code: int = 0) -> dict[str, bytes]:
    """The files of a sweep that nothing stopped; no log, which has times."""
    with tempfile.TemporaryDirectory() as folder:
        output = Spin(Path(folder))(text, *words, name="slow", code=code).path.parent
        files = (path for path in output.iterdir() if path.suffix != ".log")
        return {path.name: path.read_bytes() for path in files}


class Sweep:
    """A sweep in the folder of `spin`, run with these words, and its table."""

    def __init__(
        self, spin: Spin, text: str = SLOW, *words: str, table: str = "output/slow.csv"
    ) -> None:
        self.spin, self.text, self.words, self.table = spin, text, words, table
        self.name = spin.write(text, "slow.nml")
        self.options: dict[str, object] = {}
        """How the program is called."""

    def __call__(self, *words: str | Path, code: int = 0, **options: object) -> str:
        """Run it to its end; all that is said."""
        given = (self.name, *self.words, *words)
        run = self.spin.call(*given, code=code, **self.options | options)
        return run.out + run.stderr

    @contextmanager
    def start(self, *words: str | Path, **options: object) -> Iterator[subprocess.Popen[str]]:
        given = (self.name, *self.words, "--threads", "1", *words)
        with self.spin.start(*given, **self.options | options) as run:
            yield run

    @property
    def rows(self) -> int:
        """The rows that its journal has; -1 if there is no journal."""
        return self.spin.journalled(self.table)

    def wait(self, run: subprocess.Popen[str], rows: int) -> None:
        wait_until(lambda: self.rows >= rows or run.poll() is not None)
        assert self.rows >= rows, "the run ended too early"

    def interrupt(
        self, *words: str, rows: int = 1, by: int = signal.SIGKILL, **options: object
    ) -> tuple[int, str]:
        """Stop a run when its journal has so many rows; its exit code, and what it said."""
        with self.start(*words, **options) as run:
            self.wait(run, rows)
            run.send_signal(by)
            said = run.communicate(timeout=PATIENCE)[1]
        return run.returncode, said

    def read(self, name: str) -> bytes:
        return (self.spin.folder / name).read_bytes()

    def check(self, folder: str = "output") -> None:
        """The tables are those of an undisturbed run, and nothing else is left of the run."""
        path, whole = self.spin.folder / folder, undisturbed(self.text, *self.words)
        assert {file.name for file in path.iterdir()} == {*whole, "slow.log"}
        for name, content in whole.items():
            assert (path / name).read_bytes() == content, name

    def clear(self, folder: str = "output") -> None:
        shutil.rmtree(self.spin.folder / folder, ignore_errors=True)
