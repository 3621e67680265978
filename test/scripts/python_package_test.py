"""The Python package: the bits of the program, errors, memory, threads, and its page."""

import itertools
import math
import os
import re
import resource
import subprocess
import sys
import tempfile
import threading
import unittest
import warnings
from pathlib import Path
from unittest import mock

import numpy as np
import pytest

import python_library  # noqa: F401
import spintop
from conftest import EXE, ROOT, Spin, each, execute, texts
from manual.pages import Block, blocks_of
from spintop.inputs import namelist
from spintop.library import chosen_folder, levels

BODY = spintop.Body(mass=1, inertia=(0.875, 0.875, 0.25), length=0.75**0.5)
TOP = spintop.Top(BODY, phi=0.3, theta=0.5, psi=-1.0, phi_rate=0.2, psi_rate=7.0)
SKEW = spintop.Body(
    mass=1, inertia=(0.9, 0.7, 0.25), centre_of_mass=(0.05, 0, 0.8), damping=(0.01,) * 3
)
NEEDED = {
    "v2": "cx16 lahf_lm popcnt sse4_1 sse4_2 ssse3",
    "v3": "abm avx avx2 bmi1 bmi2 f16c fma movbe xsave",
    "v4": "avx512bw avx512cd avx512dq avx512f avx512vl",
}
"""What a level of x86-64 has in addition to the one before it, in the words of /proc/cpuinfo."""


def by_program(groups: dict, name: str = "rows") -> dict[str, list[str]]:
    """The columns of the table that the program writes for an input, as text."""
    with tempfile.TemporaryDirectory() as folder:
        run = Spin(Path(folder))(namelist(groups), "--quiet")
        rows = texts(run.path.with_name("scene.csv" if name == "rows" else f"scene.{name}.csv"))
        return {name: list(rows[name]) for name in rows}


class PythonPackageTest(unittest.TestCase):
    def compare(self, motion: spintop.Motion, table: dict[str, list[str]]) -> None:
        assert list(motion) == list(table)
        for name, column in table.items():
            assert motion[name].tolist() == [float(cell) for cell in column], name

    def test_exact(self) -> None:
        """The bits of the program, for times of any shape, and a number for a number."""
        columns = ["t", "phi", "theta", "psi", "phi_rate", "energy", "force_z", "q0"]
        columns += ["t_ms", "theta_deg", "omega3_rpm"]
        span, output = {"t_end": 30.0, "samples": 301}, {"columns": columns}
        lying = spintop.Body(mass=1, inertia=(0.25, 0.875, 0.875), centre_of_mass=(0.5, 0, 0))
        free = spintop.Body(mass=2, inertia=(0.3, 0.5, 0.7), centre_of_mass=(0, 0, 0))
        for top in (spintop.Top(lying, **TOP.start), spintop.Top(free, **TOP.start), TOP):
            table = by_program(top.input(span=span, output=output))
            t = np.array([float(cell) for cell in table["t"]])
            self.compare(top.exact(t, columns), table)
        self.compare(TOP.exact(t, columns[:5]), {name: table[name] for name in columns[:5]})
        grid = TOP.exact(t[:300].reshape(20, 15), ["theta"]).theta
        assert grid.shape == (20, 15)
        assert grid.ravel().tolist() == TOP.exact(t[:300]).theta.tolist()
        assert TOP.exact(t[::-2]).theta.tolist() == TOP.exact(t).theta[::-2].tolist()
        assert float(TOP.exact(t[7]).theta) == TOP.exact(t).theta[7]
        assert TOP.exact(t[7]).theta.shape == ()
        assert TOP.exact([]).theta.shape == (0,)
        assert TOP.exact(0).units["phi_rate"] == "rad/s"
        units = {"t_ms": "ms", "theta_deg": "deg", "phi_rate_deg": "deg/s"}
        assert TOP.exact(0, list(units)).units == units
        result = spintop.run(TOP.input(span=span, output={"columns": list(units)}))
        assert result.rows.units == units
        with self.assertRaises(AttributeError):
            TOP.exact(0).eta  # noqa: B018

    def test_integrate(self) -> None:
        """The bits of the program, for steps of both kinds, and for the work of effects."""
        columns, dragged = ["t", "theta", "psi", "energy"], {"drag_moment": (0.1, 0.1, 0.1)}
        for settings, (body, effects, more) in itertools.product(
            ({"method": "dop853", "relative_tolerance": 1e-8}, {"method": "rk4", "steps": 90}),
            ((BODY, {}, []), (SKEW, {}, []), (BODY, dragged, ["work", "energy_error"])),
        ):
            with self.subTest(f"{settings} {body} {effects}"):
                top = spintop.Top(body, effects=effects, theta=0.4, psi_rate=12.0)
                span, output = {"t_end": 3.0, "samples": 31}, {"columns": columns + more}
                table = by_program(top.input(span=span, output=output, integration=settings))
                t = [float(cell) for cell in table["t"]]
                self.compare(top.integrate(t, columns + more, **settings), table)

    def test_integrate_by_default(self) -> None:
        t = np.linspace(0, 10, 50)
        difference = TOP.integrate(t).theta - TOP.exact(t).theta
        assert np.abs(difference).max() < 1e-7

    def test_quantities(self) -> None:
        found = TOP.quantities()
        theta = TOP.exact(np.linspace(0, found["nutation_period"], 20001)).theta
        self.assertAlmostEqual(theta.max(), found["theta_max"], delta=1e-7)
        self.assertAlmostEqual(theta.min(), found["theta_min"], delta=1e-7)
        assert found["motion_class"] in ("loop", "wave", "cusp")

    def test_events(self) -> None:
        """Their table is that of the program, and the motion may end at one."""
        columns, named = ["t", "theta", "energy"], ["lower_turning_points", "theta = 0.6 rising"]
        output = {"columns": columns, "events": named}
        ends = {"stop_at": named[0], "stop_after": 2}
        for method, end in itertools.product(("exact", "taylor", "dop853", "rk4"), ({}, ends)):
            settings = {"method": method} | ({"steps": 900} if method == "rk4" else {})
            groups = TOP.input(span={"t_end": 5.0, **end}, output=output, integration=settings)
            table = by_program(groups, "events")
            found = TOP.events(named, 5.0, columns, **end, **settings)
            assert found.ok
            assert found.events["event"].tolist() == table.pop("event")
            for name, cells in table.items():
                assert found.events[name].tolist() == [float(cell) for cell in cells], name
        early = TOP.events(["turning_points"], 50.0, method="ode45", max_steps=5)
        assert not early.ok
        assert "step_limit" in early.summary
        with self.assertRaisesRegex(spintop.InputError, "no event|unknown event|is not an event"):
            TOP.events(["lower_turning"], 5.0)

    def test_derivatives(self) -> None:
        """Those of the program's table, in closed form and by a method; a turn of the start."""
        names = ["theta__initial.psi_rate", "psi__top.mass", "phi__initial.phi"]
        columns = ["theta", *names]
        top = spintop.Top(BODY, phi=0.1, theta=0.4, psi_rate=12.0)
        span, output = {"t_end": 3.0, "samples": 7}, {"columns": columns}
        t = np.linspace(0.0, 3.0, 7)
        for settings in ({"method": "exact"}, {"method": "taylor"}):
            table = by_program(top.input(span=span, output=output, integration=settings))
            if settings["method"] == "exact":
                found = top.exact(t, columns)
            else:
                found = top.integrate(t, columns, **settings)
            self.compare(found, table)
            assert found.units["theta__initial.psi_rate"] == "rad/(rad/s)"
            assert np.all(found["phi__initial.phi_error"] < 1e-7)
            np.testing.assert_allclose(found["phi__initial.phi"], 1, rtol=0, atol=1e-7)
        step = 1e-4
        other = [spintop.Top(BODY, phi=0.1, theta=0.4, psi_rate=12 + d) for d in (-step, step)]
        slope = (other[1].exact(t).theta - other[0].exact(t).theta) / (2 * step)
        np.testing.assert_allclose(found["theta__initial.psi_rate"], slope, rtol=0, atol=1e-6)
        with self.assertRaisesRegex(spintop.InputError, "no motion by this method"):
            top.exact(t, ["theta__top.inertia(1)"])

    def test_errors(self) -> None:
        """Exceptions have the message of the program and the status."""
        with self.assertRaisesRegex(spintop.InputError, "unknown key 'thta'") as caught:
            spintop.Top(BODY, thta=1.0)
        # Nobody wrote the lines of the text that is made of groups.
        assert (caught.exception.code, caught.exception.source) == (2, "")
        assert (caught.exception.line, caught.exception.column) == (0, 0)
        assert "|" not in str(caught.exception)
        with self.assertRaisesRegex(spintop.InputError, "no column|unknown column|column 'theta_'"):
            TOP.exact(0.0, ["theta_"])
        with self.assertRaisesRegex(spintop.InputError, "the exact solution exists only for"):
            spintop.Top(SKEW, theta=0.2).exact(1.0)
        with self.assertRaises(spintop.MotionError) as failed:
            TOP.integrate([0.0, 50.0], method="ode45", max_steps=5)
        assert (failed.exception.status, failed.exception.code) == ("step_limit", 3)
        for times in ([math.nan], [math.inf], [1.0, 0.5], [-1.0]):
            with self.assertRaises(spintop.InputError):
                TOP.integrate(times)
        # Steps without a method are for the one that the program chooses.
        stepwise = TOP.integrate([0.0, 0.5, 1.0], steps=1000)
        np.testing.assert_allclose(stepwise.theta, TOP.exact([0.0, 0.5, 1.0]).theta, rtol=1e-9)
        with self.assertRaises(spintop.InputError):
            spintop.Top(spintop.Body(mass=math.nan), theta=0.2)
        with self.assertRaises(spintop.InputError):
            spintop.Top(spintop.Body(mass=1, shape="a\0b"), theta=0.2)
        assert issubclass(spintop.InputError, ValueError)

    def test_a_path_a_text_a_dictionary(self) -> None:
        """All give the tables of the program."""
        path = ROOT / "input/slow_top_events.nml"
        with tempfile.TemporaryDirectory() as folder:
            execute(EXE, "--quiet", "-o", folder, path)
            paths = {name: Path(folder) / f"slow_top_events{name}.csv" for name in ("", ".events")}
            tables = {name: spintop.read(path).rows for name, path in paths.items()}
        for given in (path, str(path), path.read_text(encoding="utf-8")):
            found = spintop.run(given)
            assert found.ok
            assert "status" in found.summary
            for name, table in (("", found.rows), (".events", found.events)):
                assert list(table) == list(tables[name].columns)
                for column in table:
                    expected = tables[name][column].to_numpy()
                    if table[column].dtype.kind == "f":
                        np.testing.assert_array_equal(table[column], expected)
                    else:
                        assert table[column].tolist() == expected.tolist()
        assert found.rows.units["theta"] == "rad"
        assert list(found.rows.to_pandas().columns) == list(found.rows)

    def test_studies(self) -> None:
        """A work-precision study, statistics, and a folder."""
        groups = {"study": {"kind": "sweep"}, "top": BODY.keys, "initial": {"theta": 0.3}}
        groups |= {"span": {"t_end": 1.0}, "output": {"columns": ["theta_max"]}}
        groups["sweep"] = {"parameter": ["initial.psi_rate"], "values": [[1.0, 5.0, 9.0]]}
        table = by_program(groups)
        found = spintop.run(groups)
        assert found["theta_max"].tolist() == [float(cell) for cell in table["theta_max"]]
        statistics = {"columns": ["theta_max"]}
        before = {**os.environ}
        with tempfile.TemporaryDirectory() as folder:
            os.environ["TMPDIR"] = folder
            try:
                described = spintop.run({**groups, "statistics": statistics})
            finally:
                os.environ.pop("TMPDIR")
                os.environ.update(before)
            assert list(Path(folder).iterdir()) == []
        expected = by_program({**groups, "statistics": statistics}, "statistics")
        assert list(described.statistics) == list(expected)
        mean = [float(cell) for cell in expected["theta_max_mean"]]
        assert described.statistics["theta_max_mean"].tolist() == mean
        with tempfile.TemporaryDirectory() as folder:
            kept = spintop.run(groups, folder=folder)
            assert {path.name for path in Path(folder).iterdir()} == {"input.csv", "input.log"}
            assert kept["theta_max"].tolist() == found["theta_max"].tolist()
            assert folder in kept.summary

    def test_a_motion_that_ends_early(self) -> None:
        """It is a result with the rows up to there, which is not ok."""
        groups = TOP.input(span={"t_end": 9.0}, integration={"method": "ode45", "max_steps": 20})
        found = spintop.run(groups)
        assert not found.ok
        assert "step_limit" in found.summary
        assert found["t"].size > 0

    def test_registry(self) -> None:
        assert "rk4" in [method["name"] for method in spintop.registry("methods")["methods"]]
        assert spintop.registry()["version"] == spintop.version()
        assert spintop.__version__ == spintop.version()
        with self.assertRaisesRegex(spintop.InputError, "did you mean 'methods'"):
            spintop.registry("metods")

    def test_pages(self) -> None:
        """Their programs run, those of a page one after the other, and each prints something."""
        found = 0
        for path in sorted((ROOT / "doc").glob("*.md")):
            if path.name == "python_tutorial.md":  # has a suite of its own
                continue
            blocks = [block for block in blocks_of(path) if block.tags == ("python", "library")]
            found += len(blocks)
            names: dict[str, object] = {}
            for block in blocks:
                self.run_block(block, names)
        assert found > 5

    def run_block(self, block: Block, names: dict[str, object]) -> None:
        lines: list[tuple] = []
        names["print"] = lambda *words: lines.append(words)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            exec(compile(block.text, str(block), "exec"), names)
        assert lines != [], str(block)

    def test_pip(self) -> None:
        """`pip install` puts the library beside the modules."""
        try:
            from setuptools.command import bdist_wheel  # noqa: F401
        except ImportError:
            self.skipTest("no setuptools from version 70.1 on")
        with tempfile.TemporaryDirectory(prefix="spintop pip ") as folder:
            words = [sys.executable, "-m", "pip", "install", "--quiet", "--no-build-isolation"]
            words += ["--no-deps", "--no-index", "--disable-pip-version-check", "--target", folder]
            execute(*words, ROOT / "python")
            assert (Path(folder) / "spintop/libspintop.so.1").is_file()
            program = "import spintop, spintop_figures; print(spintop.version(), spintop.__file__)"
            words = (sys.executable, "-c", program)
            done = execute(*words, cwd=folder, environment={"PYTHONPATH": folder})
            assert done.stdout.startswith(f"{spintop.version()} {folder}")

    def test_levels(self) -> None:
        """Those that the dynamic linker names; each has its features in /proc/cpuinfo, too."""
        if os.uname().machine != "x86_64":
            self.skipTest("no x86-64")
        text = Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace")
        words = set(re.search(r"^flags\s*: (.*)$", text, re.MULTILINE)[1].split())
        has = {level: words.issuperset(needed.split()) for level, needed in NEEDED.items()}
        assert levels() == list(itertools.takewhile(has.get, NEEDED))
        for said, expected in (
            ("  x86-64-v4\n  x86-64-v3 (supported, searched)\n  x86-64-v2 (supported)", "v2 v3"),
            ("  x86-64-v4\n  x86-64-v3\n  x86-64-v2\n  x86_64 (supported, searched)", ""),
            ("", ""),
        ):
            done = subprocess.CompletedProcess((), 0, stdout=said)
            with mock.patch("subprocess.run", return_value=done) as run:
                assert levels() == expected.split()
            assert run.call_args[0][0][0] in Path("/proc/self/maps").read_text(encoding="utf-8")
        with mock.patch("pathlib.Path.read_text", return_value="/usr/lib/ld-musl-x86_64.so.1\n"):
            self.assertRaisesRegex(ImportError, "glibc", levels)

    def test_chosen_folder(self) -> None:
        """The highest level, or that of SPINTOP_LEVEL; a package without levels is one folder."""
        with tempfile.TemporaryDirectory() as name:
            package = Path(name)
            with mock.patch.dict(os.environ, {"SPINTOP_LEVEL": "v9"}):
                assert chosen_folder(package) == package
            for level in NEEDED:
                (package / level).mkdir()
            with mock.patch("spintop.library.levels", return_value=["v2", "v3"]):
                for wanted, level in (("", "v3"), ("v2", "v2"), ("v3", "v3")):
                    with mock.patch.dict(os.environ, {"SPINTOP_LEVEL": wanted}):
                        assert chosen_folder(package) == package / level
                for wrong in ("v4", "V2", "native"):
                    with (
                        mock.patch.dict(os.environ, {"SPINTOP_LEVEL": wrong}),
                        self.assertRaisesRegex(ImportError, f"'{wrong}', but .*: v2, v3"),
                    ):
                        chosen_folder(package)
            with (
                mock.patch("spintop.library.levels", return_value=[]),
                self.assertRaisesRegex(ImportError, "older than x86-64-v2"),
            ):
                chosen_folder(package)


SWEPT = {"study": {"kind": "sweep"}, "top": BODY.keys, "initial": {"theta": 0.3}}
SWEPT |= {"span": {"t_end": 2.0}}
SWEPT["output"] = {"columns": ["theta_max", "nutation_period", "phi_end", "motion_class"]}


class SweepTest(unittest.TestCase):
    def test_bits(self) -> None:
        """A sweep over arrays is that of the program over the same values, also of any bodies."""
        rate = np.linspace(0.0, 20.0, 700)
        theta = np.geomspace(0.01, 2.0, 700)
        values = {"from": [0.0], "to": [20.0], "count": [700]}
        axis = {"parameter": ["initial.psi_rate"], **values}
        for body in (BODY, SKEW):
            groups = {**SWEPT, "top": body.keys}
            groups["output"] = {"columns": ["theta_end", "phi_end"]}
            table = by_program({**groups, "sweep": axis})
            given = [float(cell) for cell in table["initial.psi_rate"]]
            found = spintop.sweep(groups, {"initial.psi_rate": given}).rows
            for name in ("theta_end", "phi_end"):
                assert found[name].tolist() == [float(cell) for cell in table[name]]
        found = spintop.sweep(SWEPT, {"initial.psi_rate": rate, "initial.theta": theta}).rows
        assert found["initial.theta"].tolist() == theta.tolist()
        assert set(found["status"]) == {"ok"}
        fifth = {"initial.psi_rate": rate[5], "initial.theta": theta[5]}
        one = spintop.sweep(SWEPT, fifth).rows
        assert one["phi_end"][0] == found["phi_end"][5]
        assert found.row_count == 700

    def test_tops(self) -> None:
        """The same bits by `tops`, for arrays of any strides."""
        rate = np.linspace(0.0, 20.0, 1500)
        table = spintop.sweep(SWEPT, {"initial.omega3": rate}).rows
        names = ["theta_max", "nutation_period", "phi_end"]
        data = {"inertia1": 0.875, "inertia3": 0.25, "mgl": 9.81 * 0.75**0.5}
        data |= {"theta": 0.3, "t_end": 2.0}
        found = spintop.tops(names, omega3=rate, **data)
        wide = np.zeros((1500, 3))
        wide[:, 1] = rate
        for other in (wide[:, 1], rate[::-1][::-1], rate.reshape(3, 500)):
            again = spintop.tops(names, omega3=other, **data, threads=2)
            for name in names:
                assert again[name].shape == other.shape
                np.testing.assert_array_equal(again[name].ravel(), found[name])
        backwards = spintop.tops(names, omega3=rate[::-1], **data)
        for name in names:
            np.testing.assert_array_equal(found[name], table[name])
            np.testing.assert_array_equal(backwards[name][::-1], found[name])

    def test_tops_that_cannot_be_computed(self) -> None:
        """They are NaN, and the others are not; wrong names are errors."""
        data = {"inertia1": [0.875, -1.0, math.nan], "inertia3": 0.25, "mgl": 8.0, "theta": 0.3}
        found = spintop.tops(["theta_max"], **data, omega3=3.0)["theta_max"]
        assert np.isnan(found).tolist() == [False, True, True]
        with self.assertRaisesRegex(spintop.InputError, "'theta_mx' is none of theta_min, "):
            spintop.tops(["theta_mx"], **data)
        with self.assertRaisesRegex(spintop.InputError, "'omega' is none of inertia1, "):
            spintop.tops(["theta_max"], **data, omega=3.0)
        assert spintop.tops(["theta_max"], **{**data, "inertia1": []})["theta_max"].size == 0

    def test_wrong_sweeps(self) -> None:
        """Names, values and shapes are checked; failed cases have a status."""
        for parameters, message in (
            ({"initial.thet": [1.0]}, "did you mean|initial.thet"),
            ({"initial.theta": [1.0, math.nan]}, "element 2 of initial.theta must be finite"),
            ({"initial.theta": [1.0, -9.0]}, "element 2 of initial.theta must be"),
            ({"initial.theta": []}, "1 to 2147483647 cases"),
            ({"initial.theta": [1.0, 2.0], "span.t_end": [1.0, 2.0, 3.0]}, "different shapes"),
            ({"output.samples": [1.0]}, "output.samples"),
            ({"top.centre_of_mass(1)": [0.1]}, r"centre_of_mass\(2\) is missing"),
        ):
            with self.subTest(parameters), self.assertRaisesRegex(spintop.InputError, message):
                spintop.sweep(SWEPT, parameters)
        both = {**SWEPT, "sweep": {"parameter": ["span.t_end"], "values": [[1.0, 2.0]]}}
        with self.assertRaisesRegex(spintop.InputError, "the cases are given twice"):
            spintop.sweep(both, {"initial.theta": [1.0]})
        axes = {"initial.theta": [0.5, 0.6], "top.inertia(3)": [0.25, 9.0]}
        result = spintop.sweep(SWEPT, axes)
        assert not result.ok
        assert result.rows["status"][0] == "ok"
        assert result.rows["status"][1] != "ok"
        assert result.rows["notes"][1] != ""


def peak() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


@pytest.mark.slow
class ResourcesTest(unittest.TestCase):
    def test_no_leak(self) -> None:
        """Memory does not grow with the number of calls of any kind."""

        def use(times: int) -> None:
            for i in range(times):
                TOP.exact(0.1)
                if i % 100 == 0:
                    spintop.Top(BODY, theta=0.2, psi_rate=3.0)
                    spintop.sweep(SWEPT, {"initial.psi_rate": np.arange(9.0)}, threads=1)
                    TOP.integrate([0.0, 1.0], ["theta"], method="dop853")
                    spintop.tops(["theta_max"], inertia1=1, inertia3=1, mgl=1, theta=np.ones(999))
                    with self.assertRaises(spintop.InputError):
                        spintop.Top(BODY, thta=0.2)
                if i % 2000 == 0:
                    spintop.run(TOP.input(span={"t_end": 1.0, "samples": 50}))
                    spintop.registry()

        use(2000)
        before = peak()
        use(16000)
        assert peak() - before < 4000

    def test_threads(self) -> None:
        """Eight at once, each with calls of all kinds: all results are those of one."""

        def work(number: int) -> list[float]:
            t = np.linspace(0, 5, 500)
            top = spintop.Top(BODY, theta=0.3 + 0.1 * number, psi_rate=9.0)
            found = TOP.exact(t).theta.tolist() + top.exact(t).psi.tolist()
            found += TOP.integrate(t, method="rk4", steps=499).theta.tolist()
            found += top.integrate(t, method="ode45", relative_tolerance=1e-9).theta.tolist()
            rates = {"initial.psi_rate": t + number}
            found += spintop.sweep(SWEPT, rates, threads=2).rows["phi_end"].tolist()
            data = {"inertia1": 1, "inertia3": 1, "mgl": 1, "theta": 1 + 0.1 * t, "omega3": number}
            found += spintop.tops(["theta_max"], **data)["theta_max"].tolist()
            try:
                spintop.Top(BODY, theta=0.2, **{f"key_{number}": 1})
            except spintop.InputError as error:
                found.append(float(f"key_{number}" in str(error)))
            return found

        alone = [work(number) for number in range(8)]
        together: list[list[float]] = [[] for _ in range(8)]

        def fill(number: int) -> None:
            for _ in range(3):
                together[number] = work(number)

        threads = [threading.Thread(target=fill, args=(number,)) for number in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for number in range(8):
            assert together[number] == alone[number], number


START = {"theta": 0.6, "phi": 0.3, "theta_rate": 0.3, "psi_rate": 6.0}
BODIES = {
    "symmetric": {"inertia": (0.875, 0.875, 0.25), "length": 0.6},
    "about x": {"inertia": (0.25, 0.875, 0.875), "centre_of_mass": (0.6, 0, 0)},
    "damped": {"inertia": (0.875, 0.875, 0.25), "length": 0.6, "damping": (0.05,) * 3},
    "asymmetric": {"inertia": (0.9, 0.7, 0.4), "centre_of_mass": (0.1, -0.05, 0.5)},
    "free": {"inertia": (0.6, 0.5, 0.4), "centre_of_mass": (0, 0, 0)},
}
EFFECTS = ({}, {"drag_force": 0.2}, {"earth_rate": 0.3, "latitude_deg": 60})
EFFECTS += ({"rotor_momentum": (0, 0, 0.3)},)
KINDS = [(body, effects) for body in BODIES for effects in EFFECTS]
ANGLES = ("phi", "theta", "psi")
COLUMNS = (*ANGLES, "omega1", "omega3", "force_z", "energy", "theta__initial.psi_rate")


def make(body: str, effects: dict) -> spintop.Top:
    return spintop.Top(spintop.Body(mass=1.3, **BODIES[body]), effects=effects, **START)


@each("body, effects", *KINDS)
def test_tops(body: str, effects: dict) -> None:
    """Angles, forces, energies and derivatives at times are those among more times."""
    top = make(body, effects)
    t = np.linspace(0.0, 3.0, 13)
    ways = [lambda t: top.integrate(t, COLUMNS, relative_tolerance=1e-12)]
    ways += [lambda t: top.integrate(t, COLUMNS, method="rk4", steps=120 * round(t[-1] / 3))]
    if body in ("symmetric", "free") and not effects:
        ways += [lambda t: top.exact(t, COLUMNS), lambda t: top.exact(t, ANGLES)]
    for way in ways:
        all_times = way(t)
        for first in (0, 1, 5):
            some = way(t[first:])
            for name in some:
                if name.endswith("_error"):
                    continue
                scale = np.abs(all_times[name]).max()
                known = all_times[name][first:]
                np.testing.assert_allclose(some[name], known, rtol=0, atol=1e-9 * scale)
