"""Faults of the disk and of the memory: the n-th call of a kind fails, for every kind of output.

`test/support/faults.txt` stands between the program and the system. Here n is a sample of the
whole run; the long suite `all_faults_test` takes all of them.
"""

import errno
import os
import re
import shutil
import subprocess
import tempfile
import unittest
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import pytest

from program_test import PROGRAM, ROOT, ProgramCase

pytestmark = pytest.mark.slow

TOP = "&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /\n"
MOTION = TOP + "&initial theta_deg = 20, psi_rate = 5 /\n"
STEPS = "&integration formulation = 'lagrange', method = 'rk4', steps = 4 /\n"
SWEEP = (
    f"{TOP}&initial theta_deg = 20 /\n&span t_end = 0.1 /\n{STEPS}&study kind = 'sweep' /\n"
    "&sweep parameter(1) = 'initial.psi_rate', from(1) = 1, to(1) = 100, count(1) = 48 /\n"
)
STATISTICS = "&statistics columns = 'theta_end', over(1) = 'initial.psi_rate', bins(1) = 3 /\n"
NETCDF = "format = 'netcdf'"
INPUTS = {
    "trajectory": f"{MOTION}&span t_end = 3, samples = 40 /\n"
    "&output columns = 't', 'theta', 'phi', events = 'turning_points' /\n",
    "sweep": f"{SWEEP}&output columns = 'theta_end', 'phi_end' /\n",
    "statistics": f"{SWEEP}{STATISTICS}",
    "statistics_alone": f"{SWEEP}{STATISTICS}&output rows = 'none' /\n",
    "fit": f"{MOTION}&study kind = 'fit' /\n&span t_end = 1 /\n"
    "&fit data = 'measured.csv', unknown = 'initial.psi_rate' /\n",
    "stability": "&study kind = 'stability' /\n"
    "&stability cases = 'sleeping_above', methods = 'rk4' /\n",
    "precision": f"{MOTION}&study kind = 'work_precision' /\n&span t_end = 1 /\n"
    "&work_precision methods = 'rk4', steps = 100, tolerances = 1e-6, repeats = 1 /\n",
    "trajectory_nc": f"{MOTION}&span t_end = 3, samples = 40 /\n"
    f"&output columns = 't', 'theta', 'phi', {NETCDF} /\n",
    "sweep_nc": f"{SWEEP}&output columns = 'theta_end', 'phi_end', {NETCDF} /\n",
    "compressed_nc": f"{SWEEP}&output columns = 'theta_end', {NETCDF}, compression = 4 /\n",
    "statistics_nc": f"{SWEEP}{STATISTICS}&output {NETCDF} /\n",
}
"""One input for every kind of output."""
CALLS = ("open", "close", "read", "write", "fsync", "rename", "truncate", "mkdir", "memory")
SHORT = 0
REASONS = "No space left on device|Input/output error|NetCDF: |is not what was written"
UNFINISHED = (".part", ".new", ".journal", ".state1", ".state2")


@dataclass(frozen=True)
class Fault:
    """The n-th call of a kind fails, or all from there on."""

    call: str
    number: int
    kind: int = errno.EIO
    lasts: bool = False

    @property
    def environment(self) -> dict[str, str]:
        """As the library takes it."""
        given = {"FAULT_CALL": self.call, "FAULT_AT": str(self.number)}
        given["FAULT_KIND"] = str(self.kind)
        return given | ({"FAULT_LASTS": "1"} if self.lasts else {})


class FaultCase(ProgramCase):
    """Runs with a fault."""

    library: ClassVar[Path]
    tried: ClassVar[int] = 0

    @classmethod
    def setUpClass(cls) -> None:
        """Compile the library, and find out which formats the program has."""
        compiler = shutil.which("gcc") or shutil.which("cc")
        if compiler is None:
            raise unittest.SkipTest("no C compiler is found")
        if os.environ.get("SPINTOP_TEST_KIND") == "sanitized":
            raise unittest.SkipTest("the sanitizers have an allocator of their own")
        folder = Path(tempfile.mkdtemp(prefix="spintop-faults-"))
        cls.addClassCleanup(shutil.rmtree, folder)
        cls.library = folder / "faults.so"
        source = ROOT / "test/support/faults.txt"
        command = [
            compiler,
            "-O1",
            "-shared",
            "-fPIC",
            "-o",
            cls.library,
            "-x",
            "c",
            source,
            "-ldl",
        ]
        subprocess.run(command, check=True)

    def setUp(self) -> None:
        """The measurements of the fit."""
        super().setUp()
        rows = "\n".join(f"{i / 10},{0.349 + 0.01 * i}" for i in range(8))
        (self.folder / "measured.csv").write_text(f"t,theta\n{rows}\n", encoding="utf-8")

    def run_with(
        self, folder: Path, name: str, *options: str, **environment: str
    ) -> tuple[int, str]:
        """Run an input on one thread; the code, and what was said on standard error."""
        preload = {"LD_PRELOAD": str(self.library), "FAULT_TICK": "10000000"}
        result = subprocess.run(
            [PROGRAM, "--threads", "1", "--quiet", "-o", str(folder), *options, f"{name}.nml"],
            cwd=self.folder,
            env=os.environ | (preload | environment if environment else {}),
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
            timeout=120,
        )
        return result.returncode, result.stderr

    def contents(self, folder: Path) -> dict[str, bytes]:
        """The files that have their final names; of measured times only that they are there."""
        found = {}
        for path in sorted(folder.glob("*")):
            if path.name.endswith(UNFINISHED):
                continue
            data = path.read_bytes()
            data = re.sub(rb"\d{4}-\d\d-\d\dT[:\d]+Z", b"", data)
            if path.suffix == ".log" or path.name.startswith(("precision", "stability")):
                data = re.sub(rb"CRC-32 .*", b"", data)
                data = re.sub(rb"[-+.:\d]+([Ee][-+]?\d+)?( [mun]s\b)?", b"0", data)
            found[path.name] = data
        return found

    def prepare(self, name: str) -> tuple[dict[str, bytes], dict[str, int]] | None:
        """The output without a fault, and the calls of each kind; None without NetCDF."""
        self.write(INPUTS[name], f"{name}.nml")
        folder, counts = self.folder / "output", self.folder / "counts"
        shutil.rmtree(folder, ignore_errors=True)
        code, said = self.run_with(folder, name, FAULT_COUNTS=str(counts))
        if name.endswith("_nc") and code == 2:
            self.assertRegex(said, "this build has no NetCDF|NetCDF-4")
            return None
        self.assertEqual(code, 0, said)
        lines = counts.read_text(encoding="utf-8").split("\n")
        return self.contents(folder), {call: int(n) for call, n in map(str.split, lines[:-1])}

    def check(self, name: str, expected: dict[str, bytes], fault: Fault) -> None:
        """A true message, the documented code, no half-written file; then the same bytes."""
        FaultCase.tried += 1
        folder = self.folder / "output"
        shutil.rmtree(folder, ignore_errors=True)
        code, said = self.run_with(folder, name, **fault.environment)
        found = self.contents(folder)
        for file, data in found.items():
            self.assertEqual(data, expected.get(file), f"{file}: {said}")
        if code == 0:
            self.assertEqual(list(found), list(expected))
            return
        if fault.call == "memory":
            self.assertEqual(code, 5, said)
            self.assertIn("there is no more memory", said)
        else:
            self.assertIn(code, (2, 4), said)
            self.assertRegex(said, REASONS)
            if code == 2:
                self.assertIn("cannot read", said)
                self.assertEqual(found, {})
        resumes = name.startswith(("trajectory", "sweep", "compressed", "statistics"))
        code, said = self.run_with(folder, name, *["--resume"] * resumes)
        self.assertEqual(code, 0, said)
        # A log of the fault's run, whose table is complete, is not written again.
        for file, data in expected.items():
            if not file.endswith(".log"):
                self.assertEqual((file, self.contents(folder).get(file)), (file, data))
        left = [path.name for path in folder.iterdir() if path.suffix in (".part", ".journal")]
        self.assertEqual(left, [])

    def kinds(self, call: str) -> tuple[tuple[int, bool], ...]:
        """The faults of a call: the error, and whether it lasts."""
        if call == "memory":
            return ((errno.ENOMEM, False),)
        faults = [(errno.EIO, False), (errno.ENOSPC, True)]
        return (*faults, (SHORT, False)) if call in ("read", "write") else tuple(faults)


def sample(count: int, most: int, start: int) -> Iterator[int]:
    """At most so many of the numbers from 1 to the count, over all of them."""
    step = max(1, -(-count // most))
    yield from range(1 + start % step, count + 1, step)


class FaultsTest(FaultCase):
    """A sample of the faults of each kind of output."""

    def test_every_kind_of_output(self) -> None:
        """The input's name gives the place where the sample begins."""
        for index, name in enumerate(INPUTS):
            prepared = self.prepare(name)
            if prepared is None:
                continue
            expected, counts = prepared
            for call in CALLS:
                kinds = self.kinds(call)
                for k, number in enumerate(sample(counts[call], 6, 7 * index)):
                    kind, lasts = kinds[(k + index) % len(kinds)]
                    fault = Fault(call, number, kind, lasts)
                    with self.subTest(name, fault=fault):
                        self.check(name, expected, fault)
        self.assertGreater(self.tried, 200)


if __name__ == "__main__":
    unittest.main()
