"""Faults of the disk and of the memory: the n-th call of a kind fails, for every kind of output.

`test/support/faults.txt` stands between the program and the system. Here n is a sample of the
whole run; the long suite `all_faults_test` takes all of them.
"""

import errno
import re
import shutil
from collections.abc import Iterator
from dataclasses import dataclass

import pytest

from conftest import KIND, ROOT, each, netcdf_is_missing

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
FAULTS = (ROOT / "test/support/faults.txt").read_text()
CALLS = ("open", "close", "read", "write", "fsync", "rename", "truncate", "mkdir", "memory")
SHORT = 0
REASONS = "No space left on device|Input/output error|NetCDF: |is not what was written"
NO_MEMORY = "NetCDF: |Cannot allocate memory"
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
        given = {"FAULT_CALL": self.call, "FAULT_AT": str(self.number)}
        given["FAULT_KIND"] = str(self.kind)
        return given | ({"FAULT_LASTS": "1"} if self.lasts else {})


class Faulty:
    """The program with a fault, in a folder that has the measurements of the fit."""

    def __init__(self, spin, library: dict[str, str]) -> None:
        self.spin, self.library = spin, library
        self.output = spin.folder / "output"
        rows = "\n".join(f"{i / 10},{0.349 + 0.01 * i}" for i in range(8))
        spin.write(f"t,theta\n{rows}\n", "measured.csv")

    def run(self, name: str, *options: str, **environment: str) -> tuple[int, str]:
        """Run an input on one thread; the code, and what was said on standard error."""
        preload = self.library | {"FAULT_TICK": "10000000"}
        run = self.spin.call(
            *("--threads", "1", "--quiet", "-o", str(self.output), *options, f"{name}.nml"),
            environment=preload | environment if environment else {},
            code=(0, 2, 4, 5),
            errors="replace",
            timeout=120,
        )
        return run.code, run.stderr

    def contents(self) -> dict[str, bytes]:
        """The files that have their final names; of measured times only that they are there."""
        found = {}
        for path in sorted(self.output.glob("*")):
            if path.name.endswith(UNFINISHED):
                continue
            data = path.read_bytes()
            data = re.sub(rb"\d{4}-\d\d-\d\dT[:\d]+Z", b"", data)
            if path.suffix == ".log" or path.name.startswith(("precision", "stability")):
                data = re.sub(rb"CRC-32 .*", b"", data)
                data = re.sub(rb"[-+.:\d]+([Ee][-+]?\d+)?( [mun]s\b)?", b"0", data)
            found[path.name] = data
        return found

    def prepare(self, name: str) -> tuple[dict[str, bytes], dict[str, int]]:
        """The output without a fault, and the calls of each kind; skips without NetCDF."""
        if name.endswith("_nc") and (reason := netcdf_is_missing()):
            pytest.skip(reason)
        self.spin.write(INPUTS[name], f"{name}.nml")
        counts = self.spin.folder / "counts"
        code, said = self.run(name, FAULT_COUNTS=str(counts))
        assert code == 0, said
        lines = counts.read_text(encoding="utf-8").split("\n")
        return self.contents(), {call: int(n) for call, n in map(str.split, lines[:-1])}

    def check(self, name: str, expected: dict[str, bytes], fault: Fault) -> None:
        """A true message, the documented code, no half-written file; then the same bytes."""
        shutil.rmtree(self.output, ignore_errors=True)
        code, said = self.run(name, **fault.environment)
        found = self.contents()
        for file, data in found.items():
            assert data == expected.get(file), (fault, file, said)
        if code == 0:
            assert list(found) == list(expected), fault
            return
        if code == 5:
            assert fault.call == "memory", (fault, said)
            assert "there is no more memory" in said, fault
        else:  # without memory NetCDF and HDF5 cannot write, or read back what was written
            assert code in (2, 4), (fault, said)
            reasons = NO_MEMORY if fault.call == "memory" else REASONS
            assert re.search(reasons, said), (fault, said)
            if code == 2:
                assert "cannot read" in said, fault
                assert found == {}, fault
        resumes = name.startswith(("trajectory", "sweep", "compressed", "statistics"))
        code, said = self.run(name, *["--resume"] * resumes)
        assert code == 0, (fault, said)
        # A log of the fault's run, whose table is complete, is not written again.
        again = self.contents()
        for file, data in expected.items():
            if not file.endswith(".log"):
                assert (file, again.get(file)) == (file, data), fault
        left = [p.name for p in self.output.iterdir() if p.suffix in (".part", ".journal")]
        assert left == [], fault


@pytest.fixture
def faulty(spin, preload) -> Faulty:
    if KIND == "sanitized":
        pytest.skip("the sanitizers have an allocator of their own")
    return Faulty(spin, preload(FAULTS))


def kinds_of(call: str) -> tuple[tuple[int, bool], ...]:
    if call == "memory":
        return ((errno.ENOMEM, False),)
    faults = ((errno.EIO, False), (errno.ENOSPC, True))
    return (*faults, (SHORT, False)) if call in ("read", "write") else faults


def sample(count: int, most: int, start: int) -> Iterator[int]:
    """At most so many of the numbers from 1 to the count, over all of them."""
    step = max(1, -(-count // most))
    yield from range(1 + start % step, count + 1, step)


@each("index, name", *enumerate(INPUTS), ids=list(INPUTS))
def test_a_sample_of_the_faults(faulty, index, name):
    """Of each kind of output; the input's number gives the place where the sample begins."""
    expected, counts = faulty.prepare(name)
    tried = 0
    for call in CALLS:
        kinds = kinds_of(call)
        for k, number in enumerate(sample(counts[call], 6, 7 * index)):
            faulty.check(name, expected, Fault(call, number, *kinds[(k + index) % len(kinds)]))
            tried += 1
    assert tried > 20
