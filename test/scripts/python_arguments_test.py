"""What the Python package takes, and what it refuses: values, names, threads, copies."""

import contextlib
import copy
import datetime
import pickle
import time
import unittest
import warnings
from decimal import Decimal
from functools import partial
from multiprocessing import get_context

import numpy as np

import python_library  # noqa: F401
import spintop
from spintop.library import ask

INERTIA = (0.875, 0.875, 0.25)
BODY = spintop.Body(mass=1, inertia=INERTIA, length=0.8)
TOP = spintop.Top(BODY, theta_deg=11.25, psi_rate=1.0)
SYMMETRIC = {"inertia1": 0.875, "inertia3": 0.25, "mgl": 8.0, "theta": 0.2}
GIVEN = {"top": {"mass": 1, "inertia": (0.875, 0.875, 0.24), "length": 0.75**0.5}}
GIVEN["initial"] = {"theta_deg": 30, "psi_rate": 15.0}
TIMES = np.arange(20) / 20


def theta_of(top: spintop.Top) -> float:
    return float(top.exact(1.0).theta)


def quantities_in_a_process() -> float:
    return TOP.quantities("theta_max")["theta_max"]


class PythonArgumentsTest(unittest.TestCase):
    def test_changed_arguments(self) -> None:
        """Later changes of lists and arrays change neither body nor top."""
        inertia, centre, psi_rate = [0.875, 0.875, 0.25], np.array([0, 0, 0.8]), np.array(1.0)
        body = spintop.Body(mass=1, inertia=inertia, centre_of_mass=centre)
        top = spintop.Top(body, theta_deg=11.25, psi_rate=psi_rate)
        inertia[0], centre[2], psi_rate[()] = 3.0, 0.1, 9.0
        body.keys["mass"] = top.start["psi_rate"] = 7
        assert theta_of(top) == theta_of(TOP)
        assert theta_of(spintop.Top(body, theta_deg=11.25, psi_rate=1)) == theta_of(TOP)
        assert top.integrate([1.0]).theta == TOP.integrate([1.0]).theta

    def test_copies_and_pickles(self) -> None:
        """A top can be copied and sent to other processes; a result says that it cannot."""
        rotor = spintop.Top(BODY, effects={"rotor_momentum": [0, 0, 0.1]}, theta=1, psi_rate=2)
        for top in (TOP, rotor):
            for same in (copy.deepcopy(top), pickle.loads(pickle.dumps(top))):
                assert theta_of(same) == theta_of(top)
                assert repr(same) == repr(top)
        assert theta_of(TOP) != theta_of(rotor)
        result = spintop.sweep({"study": {"kind": "sweep"}, **TOP.input(span={"t_end": 1})}, {})
        with self.assertRaisesRegex(TypeError, "to_pandas"):
            pickle.dumps(result)

    def test_composed_body(self) -> None:
        """Parts are lists of groups, for a body and for an input."""
        disc = {"shape": "disc", "mass": 0.5, "radius": 0.1, "place": [0, 0, 0.2]}
        disc["thickness"] = 0.01
        rod = {"shape": "rod", "mass": 0.1, "radius": 0.005, "thickness": 0.2, "place": (0, 0, 0.1)}
        top = spintop.Top(spintop.Body(parts=[disc, rod]), theta=0.5, psi_rate=90.0)
        found = spintop.run(
            {**top.input(span={"t_end": 1, "samples": 2}), "integration": {"method": "taylor"}}
        )
        assert found["theta"][1] == top.integrate(1.0).theta
        disc["mass"] = 5
        assert top.body.parts[0]["mass"] == 0.5

    def test_warnings(self) -> None:
        """A body that no mass distribution has is one with a warning, as of the program."""
        with self.assertWarnsRegex(spintop.InputWarning, "no mass distribution has this inertia"):
            spintop.Top(spintop.Body(mass=1, inertia=(0.5, 0.5, 0.26), length=0.9), theta=1)
        with self.assertWarnsRegex(spintop.InputWarning, "stays upright only because"):
            spintop.Top(BODY, theta=0, omega3=0.1)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            assert theta_of(spintop.Top(BODY, theta_deg=11.25, psi_rate=1)) == theta_of(TOP)

    def test_forked_process(self) -> None:
        """A quantity of one top needs no threads, which a forked process does not have."""
        quantities_in_a_process()
        with get_context("fork").Pool(1) as pool:
            found = pool.apply_async(quantities_in_a_process).get(timeout=60)
        assert found == quantities_in_a_process()

    def test_no_numbers(self) -> None:
        """Dates, durations, complex numbers, words and masked values are refused by name."""
        wrong = (
            np.array([0, 1], dtype="timedelta64[s]"),
            np.array(["2026-01-01"], dtype="datetime64[D]"),
            np.array([1 + 0j]),
            ["1", "2"],
            np.array(["1"], dtype=object),
            [datetime.timedelta(seconds=1)],
            [None],
            np.ma.masked_array([1.0, 2.0], [False, True]),
            {"t": 1},
        )
        for values in wrong:
            calls = (
                partial(TOP.exact, values),
                partial(TOP.integrate, values, method="rk4", steps=4),
                partial(spintop.sweep, {"study": {"kind": "sweep"}}, {"top.mass": values}),
                partial(spintop.tops, "theta_max", **{**SYMMETRIC, "mgl": values}),
                partial(spintop.fit, {"t": [0, 1], "theta": values}, "top.mass", GIVEN),
            )
            for i, call in enumerate(calls):
                with self.subTest(values=values, call=i), self.assertRaises(spintop.InputError):
                    call()

    def test_numbers(self) -> None:
        """Whole numbers, decimals, masked arrays without a masked value, and none at all."""
        expected = TOP.exact([0.0, 2.0]).theta.tolist()
        for values in ([0, 2], (Decimal(0), Decimal(2)), np.ma.masked_array([0.0, 2.0])):
            assert TOP.exact(values).theta.tolist() == expected
        assert TOP.exact(np.arange(4.0)[::-2]).t.tolist() == [3, 1]
        for empty in (TOP.exact([]), TOP.integrate([]), TOP.integrate([], method="rk4", steps=5)):
            assert empty.theta.shape == (0,)

    def test_times(self) -> None:
        for call in (
            lambda: TOP.exact([0, np.nan]),
            lambda: TOP.integrate([0, np.inf]),
            lambda: TOP.integrate([0, 0.51, 1], method="rk4", steps=10),
        ):
            with self.assertRaisesRegex(spintop.SpintopError, "not finite, .* or not the time of"):
                call()

    def test_rows_of_a_list(self) -> None:
        """Rows may have different lengths, and may be left out."""
        study = {"kind": "sweep"}
        base = {"study": study, **TOP.input(span={"t_end": 1}, output={"columns": ["theta_max"]})}
        axes = {"parameter": ["initial.psi_rate", "top.mass"], "values": [[1, 2, 3], [1.0, 2.0]]}
        assert spintop.run({**base, "sweep": axes}).rows.row_count == 6
        axes = {"parameter": [None, "top.mass"], "values": [None, [1.0, 2.0]]}
        with self.assertRaises(spintop.InputError):
            spintop.run({**base, "sweep": axes})

    def test_no_groups(self) -> None:
        for group in (None, 3, "mass = 1", [3]):
            with self.assertRaises(spintop.InputError):
                spintop.run({"top": group})
        body = TOP.body
        for call, name in (
            (lambda: spintop.Top(None), "body: a Body is wanted, not NoneType"),
            (lambda: spintop.Top(body, theta=1, effects=[1]), "effects: names .* not list"),
            (lambda: spintop.run(None), "input: names with their values are wanted, not NoneType"),
            (lambda: spintop.sweep(3, {}), "input: names with their values"),
            (lambda: spintop.fit("x.csv", "top.mass", {}), "data: names .* not str"),
            (lambda: spintop.fit({"t": [0]}, "top.mass", 3), "given: names .* not int"),
        ):
            with self.assertRaisesRegex(spintop.InputError, name):
                call()

    def test_one_name(self) -> None:
        assert list(TOP.exact(1.0, "theta")) == ["theta"]
        assert list(TOP.quantities("theta_max")) == ["theta_max"]
        assert list(spintop.tops("theta_max", **SYMMETRIC)) == ["theta_max"]
        assert TOP.events("lower_turning_points", 3.0).events.row_count == 1
        every = TOP.quantities("all")
        assert every["theta_max"] == TOP.quantities("theta_max")["theta_max"]

    def test_long_names(self) -> None:
        """A name that begins as a quantity is none."""
        for name in ("theta_max" + " " * 15 + "x", "nutation_periods", "theta_max\n"):
            with self.assertRaisesRegex(spintop.InputError, "is none of"):
                spintop.tops([name], **SYMMETRIC)

    def test_names_that_are_none(self) -> None:
        """A group or a key is a name: no text reaches the namelist as anything else."""
        hostile = ("a / &sweep", "a/", "a = 1 b", "a!", "", " a", "a\n", "&a", "a'b", "1a")
        hostile += ("a\u00e4", 7, "a(1) = 2, b", "a(", "a(1))", "a%b", "a,b", "a\0")
        for name in hostile:
            with self.subTest(name=name):
                for groups in ({name: {}}, {name: {"mass": 1}}, {"top": {name: 1}}):
                    with self.assertRaisesRegex(spintop.InputError, "is no name of a (group|key)"):
                        spintop.run(GIVEN | groups)
                if isinstance(name, str):
                    with self.assertRaises(spintop.InputError):
                        spintop.Top(spintop.Body(**{"mass": 1, "inertia": INERTIA, name: 1}))
                    with self.assertRaises(spintop.InputError):
                        spintop.Top(BODY, theta=0.2, effects={name: 1})
                    with self.assertRaises(spintop.InputError):
                        TOP.quantities("theta_max", **{name: 1})
                    with self.assertRaises(spintop.InputError):
                        spintop.sweep({"study": {"kind": "sweep"}, **GIVEN}, {name: [1.0]})
        for text in ("a\n/ &sweep", "a\r", "\n"):
            with self.assertRaisesRegex(spintop.InputError, "more than one line"):
                spintop.run(GIVEN | {"study": {"title": text}})
        rows = {"parameter(1)": "initial.psi_rate", "values(1,:)": [9, 15], "from(2)": None}
        span = {"span": {"t_end": 1.0}}
        found = spintop.run({"study": {"kind": "sweep"}, **GIVEN, **span, "sweep": rows})
        assert len(found.rows["case"]) == 2

    def test_long_texts_take_linear_time(self) -> None:
        """Each text that the library takes, four times as long: not ten times the time."""
        text = "&top mass = 1 inertia = 0.875, 0.875, 0.25 length = 0.8 / &initial theta = 1 /"
        text += " &span t_end = 1 samples = 2 /"
        study = "&study kind = 'sweep' / "
        calls = {
            "name": lambda n: ask("run", "&nothing /", "x" * n, None, 1),
            "name of tabs": lambda n: ask("run", "&nothing /", "\t" * n, None, 1),
            "folder": lambda n: ask("run", text, "x", "/nowhere/" + "x" * n, 1),
            "comment": lambda n: spintop.run(f"{text} ! {'x' * n}"),
            "lines": lambda n: spintop.run(text + "\n! x" * n),
            "title": lambda n: spintop.run(f"&study title = '{'x' * n}' / {text}"),
            "group": lambda n: spintop.run("&" + "x" * n),
            "groups": lambda n: spintop.run(text + "&x /" * n),
            "topic": lambda n: spintop.registry("x" * n),
            "quantity": lambda n: spintop.tops("x" * n, **SYMMETRIC),
            "parameter": lambda n: spintop.sweep(study + text, {"x" * n: [1.0]}),
        }
        for what, call in calls.items():
            times = []
            for n in (100_000, 400_000):
                began = time.process_time()
                with contextlib.suppress(spintop.SpintopError):
                    call(n)
                times.append(time.process_time() - began)
            with self.subTest(what):
                assert times[1] < 0.2 + 10 * times[0], times

    def test_threads(self) -> None:
        for threads in (-1, 4097, 2**40, 2**32 + 1, 1.5, "2", None):
            with self.assertRaisesRegex(spintop.InputError, "threads"):
                spintop.tops("theta_max", threads=threads, **SYMMETRIC)
            with self.assertRaisesRegex(spintop.InputError, "threads"):
                spintop.run(TOP.input(span={"t_end": 1}), threads=threads)
        many = {**SYMMETRIC, "theta": np.linspace(0.1, 3, 5000)}
        one = spintop.tops("theta_max", **many)["theta_max"].tolist()
        assert spintop.tops("theta_max", threads=4096, **many)["theta_max"].tolist() == one


class FitTest(unittest.TestCase):
    def setUp(self) -> None:
        body = spintop.Body(**{**GIVEN["top"], "inertia": (0.875, 0.875, 0.25)})
        top = spintop.Top(body, **GIVEN["initial"])
        motion = top.exact(TIMES, ["t", "phi", "theta"])
        self.data = {name: motion[name] for name in motion}

    def test_bodies_are_checked(self) -> None:
        """A wrong body is refused where it is made, before there is a top."""
        good = {"mass": 1, "inertia": (0.875, 0.875, 0.25), "length": 0.866}
        assert spintop.Body(**good).keys == good
        for bad, message in (
            ({**good, "mass": -1}, "mass is out of range"),
            ({**good, "mas": 1}, "did you mean 'mass'"),
            ({"mass": 1}, "top.inertia is not given"),
        ):
            with self.assertRaisesRegex(spintop.InputError, message):
                spintop.Body(**bad)

    def test_own_group(self) -> None:
        """Keys of the group `fit` are taken, but not twice."""
        given = {**GIVEN, "FIT": {"Columns": ["theta"]}}
        found = spintop.fit(self.data, "top.inertia(3)", given)
        alone = {"t": self.data["t"], "theta": self.data["theta"]}
        assert found["estimate"] == spintop.fit(alone, "top.inertia(3)", GIVEN)["estimate"]
        assert found.ok
        for twice in ({"unknown": "top.mass"}, {"SIGMA": 1.0}, {"data": "x.csv"}):
            with self.assertRaisesRegex(spintop.InputError, "is an argument"):
                spintop.fit(self.data, "top.inertia(3)", {**GIVEN, "fit": twice})

    def test_deviations_of_another_unit(self) -> None:
        """Deviations of which the squares are no numbers are refused, not found to fit."""
        for sigma in (1e-200, 1e200, 1e-155):
            with self.assertRaisesRegex(spintop.InputError, "not comparable"):
                spintop.fit(self.data, "top.inertia(3)", GIVEN, sigma=sigma)
        for sigma in (1e-60, 1.0, 1e60):
            result = spintop.fit(self.data, "top.inertia(3)", GIVEN, sigma=sigma)
            self.assertAlmostEqual(float(result["estimate"][0]), 0.25, places=9)
