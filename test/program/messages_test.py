"""Messages about invalid values and foreign names, and the width of messages."""

import fcntl
import os
import pty
import re
import struct
import termios
import time

from program_test import GOOD, PROGRAM, ROOT, ProgramCase

SWEEP = GOOD[: GOOD.index("&output")].replace("&top", "&study kind = 'sweep' /\n&top")
CLOSED = GOOD[: GOOD.index("&integration")]
DAMPED = GOOD.replace("&top", "&top damping = 0.1, 0.1, 0.1").replace("'lagrange'", "'auto'")


class OverrideTest(ProgramCase):
    """No part of an override is ignored."""

    def test_what_follows_a_value(self) -> None:
        """A slash, a group, another key: refused, not dropped."""
        scene = self.write()
        for setting, rest in (
            ("top.length=1 / &x", "/ &x"),
            ("top.length=1/", "/"),
            ("top.length=1 &span", "&span"),
            ("top.length=1 mass=2", "mass=2"),
            ("top.inertia=1,1,1 / 3", "/ 3"),
            ("study.title='a' / b", "/ b"),
            ("output.columns='t' / 'theta'", "/ 'theta'"),
        ):
            with self.subTest(setting):
                error = self.refuse(scene, "--set", setting)
                column = setting.index(rest) + 1
                self.assertIn(f"--set:1:{column}: error: unexpected text after the value", error)
        # Without quotes a text goes to the end.
        result = self.run_program("--check", scene, "--set", "study.title=a / b &c")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("title = 'a / b &c'", result.stdout)

    def test_control_characters(self) -> None:
        """Anything that would end a line of the table for some reader is refused, in every text."""
        characters = ("\n", "\r", "\t", "\x0b", "\x0c", "\x1b", "\x1c", "\x7f", "\x85", "\u2028")
        for key in ("study.title", "output.file", "sweep.table", "span.stop_at"):
            for character in (*characters, "\u2029"):
                for text in (
                    f"a{character}b",
                    f"'a{character}b'",
                    f"{character}b",
                    f"a{character}",
                ):
                    with self.subTest(key=key, text=text):
                        self.refuse(self.write(), "--set", f"{key}={text}")
        for character in characters:
            with self.subTest(character=character):
                text = GOOD + f"&study title = 'a{character}b' /\n"
                self.refuse(self.write(text))
        # Letters of any language are text.
        table = self.compute(self.write(), "study.title=Kreisel \u00e4\u00df \u03b8")
        self.assertIn("Kreisel \u00e4\u00df \u03b8", "\n".join(table.header))


class HintTest(ProgramCase):
    """The hint is what is meant."""

    def hint(self, text: str, *settings: str) -> str:
        """The messages of the program, with joined lines."""
        overrides = [part for setting in settings for part in ("--set", setting)]
        return " ".join(self.refuse(self.write(text), *overrides).split())

    def test_units(self) -> None:
        """Degrees where radians belong."""
        said = self.hint(GOOD, "initial.theta=20")
        self.assertIn("theta is out of range", said)
        self.assertIn("must be in [0, pi] rad; theta_deg takes degrees", said)
        said = self.hint(GOOD, "initial.phi_rate_deg=3")
        self.assertIn("'phi_rate' is in rad/s: 1 rad/s = 57.29577951308232 deg/s", said)
        said = self.hint(GOOD.replace("psi_rate", "psi_rate_deg"))
        self.assertIn("'psi_rate' is in rad/s: 1 rad/s = 57.29577951308232 deg/s", said)
        said = self.hint(SWEEP + "&sweep parameter(1) = 'initial.omega3_deg', values(1,:) = 1 /\n")
        self.assertIn("'omega3' is in rad/s", said)
        said = self.hint(SWEEP + "&sweep parameter(1) = 'initial.theta', values(1,:) = 1, 20 /\n")
        self.assertIn("theta_deg takes degrees", said)
        said = self.hint(GOOD, "output.columns=t,theta_rpm")
        self.assertIn("column 'theta_rpm': rpm is no unit of a quantity in rad", said)
        self.assertIn("theta is in rad, and can have a suffix: _rad, _mrad, _deg, _rev", said)
        said = self.hint(GOOD, "output.columns=t,theta_degr")
        self.assertIn("there is no column 'theta_degr'", said)
        said = self.hint(GOOD, "output.columns=t,q0_deg")
        self.assertIn("a number without a unit is wanted", said)
        said = self.hint(GOOD, "output.columns=t,theta_deg,theta_deg")
        self.assertIn("column 'theta_deg' is named twice", said)
        for setting, problem in (
            ("initial.theta=20 rpm", "rpm is no unit of a quantity in rad"),
            ("initial.theta=20 dge", "'dge' is not a unit"),
            ("initial.theta=20 kg m^2/s", "kg m^2/s is no unit of a quantity in rad"),
        ):
            said = self.hint(GOOD, setting)
            self.assertIn(problem, said)
            self.assertIn("units are rad, mrad, deg", said)

        for number in ("2 rpm", "2rpm"):
            said = self.hint(GOOD.replace("psi_rate = 1.0", f"psi_rate = {number}"))
            self.assertIn("a number with its unit is in quotes, as '20 deg'", said)

    def test_foreign_characters(self) -> None:
        """A character without a meaning is named at its place, alone, with what to write."""
        blank, minus = "\u00a0", "\u2212"
        for old, new, character, hint in (
            ("mass = 1.0", "mass: 1.0", ":", "a key is followed by ="),
            ("mass = 1.0", "mass = 1.0 # kg, don't", "#", "a comment starts with !"),
            ("mass = 1.0", "! [#;]\nmass = 1.0; title", ";", "values are separated by commas"),
            ("inertia =", "inertia[1] =", "[", "a subscript is in parentheses"),
            ("'rk4'", "\u2018rk4\u2019", "\u2018", "a text is in straight quotes"),
            ("'t', ", "\u201ct\u201d, ", "\u201c", "a text is in straight quotes"),
            ("mass = 1.0", f"mass{blank}= 1.0", blank, "write an ordinary blank"),
            ("0.25\n", f"0.25{blank}", blank, "write an ordinary blank"),
            ("= 0.5", f"= {minus}0.5", minus, "a minus sign is -"),
        ):
            with self.subTest(new):
                text = GOOD.replace(old, new, 1)
                first = new.index(character, new.rfind("\n") + 1)
                before = text[: text.index(new) + first]
                line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
                said = self.refuse(self.write(text))
                self.assertIn(f":{line}:{column}: error: unexpected ", said)
                self.assertIn(hint, said)
                self.assertRegex(said, r"\b1 error\n")
        # In texts and comments each of them may stand.
        title = f"! [#;] {minus}\n&study title = '[a]; #1: \u201cb\u201d' /\n"
        self.compute(self.write(title + GOOD))

    def test_errors_that_follow(self) -> None:
        """What cannot be read is reported, and nothing that would follow from it."""
        for setting, more in (
            ("effects.earth_rate=1 rev/day", "effects.latitude=0.7"),
            ("effects.vibration_rate=50 Hz", "effects.vibration_amplitude=0,0,0.01"),
            ("top.length=0.3 yards", "initial.spin_ratio=2"),
            ("top.inertia=1,1,x", "integration.method=exact"),
            ("top.damping=1,1,one", "output.columns=work_damping"),
            ("study.kind=swep", "output.columns=theta_max"),
        ):
            with self.subTest(setting):
                said = self.hint(CLOSED.replace("psi_rate = 1.0", ""), setting, more)
                self.assertRegex(said, r"\b1 error$")
        said = self.hint(GOOD.replace("mass = 1.0", "mass = '25,5 g'"))
        self.assertIn("a comma in the number '25,5 g'", said)
        self.assertIn("decimals follow a point", said)

    def test_names_of_other_programs(self) -> None:
        """Each other name leads to a key that exists, in its group or in another one."""
        source = (ROOT / "src/scenes/scene_keys.f90").read_text(encoding="utf-8")
        names = re.findall(r"'([a-z]\w*)=(\w+)\.(\w+)'", source)
        self.assertGreater(len(names), 40)
        keys = [f"{group}.{other}=1" for other, group, _ in names]
        said = self.hint(GOOD, *keys)
        for other, group, key in names:
            self.assertIn(f"unknown key '{other}' in group &{group}", said)
            self.assertIn(f"did you mean '{key}'?", said)
        known = self.run_program("list", "parameters").stdout
        for _, group, key in names:
            self.assertRegex(known, rf"(?m)^{group}\.{key}\b")
        said = self.hint(GOOD, "span.rtol=1e-9")
        self.assertIn("did you mean 'relative_tolerance' in group &integration?", said)

    def test_units_of_axes(self) -> None:
        """The unit of an axis is that of its parameter."""
        for setting, problem in (
            ("sweep.from(1)='3 deg'", "initial.omega3: deg is no unit of a quantity in rad/s"),
            ("sweep.from(1)=3 m", "initial.omega3: m is no unit of a quantity in rad/s"),
            ("sweep.to(1)=3 rpn", "initial.omega3: 'rpn' is not a unit"),
        ):
            axis = "&sweep parameter(1) = 'initial.omega3', from(1) = 1, to(1) = 2, count(1) = 2 /"
            said = self.hint(SWEEP.replace("psi_rate", "phi_rate") + axis, setting)
            self.assertIn(problem, said)
            self.assertIn("units are rad/s, mrad/s, deg/s", said)
        said = self.hint(SWEEP + "&sweep from(1) = '1 rpm', to(1) = 2, count(1) = 2 /")
        self.assertIn("from(1) has a unit, but sweep.parameter(1) is not given", said)
        laws = "combine = 'random' cases = 9 distribution(1) = 'lognormal' deviation(1) = 0.1"
        axis = f"&sweep parameter(1) = 'initial.phi_rate' {laws} mean(1) = '1 rpm' /"
        said = self.hint(SWEEP + axis)
        self.assertIn("the logarithm of initial.phi_rate: a number without a unit", said)

    def test_names_that_others_use(self) -> None:
        """Names of the methods in SciPy, MATLAB and textbooks."""
        for name, own in (
            ("rk45", "ode45"),
            ("RK45", "ode45"),
            ("dopri5", "ode45"),
            ("verlet", "splitting_2"),
            ("implicit_midpoint", "crank_nicolson_2"),
            ("rk44", "rk4"),
        ):
            self.assertIn(f"did you mean '{own}'?", self.hint(GOOD, f"integration.method={name}"))
            study = "study.kind=work_precision", "integration.method=auto"
            kept = GOOD[: GOOD.index("&integration")]
            said = self.hint(kept, *study, f"work_precision.methods=rk4,{name}")
            self.assertIn(f"did you mean '{own}'?", said)

    def test_columns_of_other_studies(self) -> None:
        """A column is known by the study that has it."""
        said = self.hint(GOOD, "output.columns=t,lyapunov_exponent")
        self.assertIn(
            "a trajectory has no column 'lyapunov_exponent': sweeps and stability studies have it",
            said,
        )
        sweep = SWEEP + "&sweep parameter(1) = 'initial.theta', values(1,:) = 1 /\n"
        said = self.hint(sweep, "output.columns=theta_min,gamma1")
        self.assertIn("a sweep has no column 'gamma1': trajectories have it", said)
        said = self.hint(GOOD, "output.columns=t,time_s")
        owners = "stability studies, work-precision studies and studies of benchmarks have it"
        self.assertIn(f"a trajectory has no column 'time_s': {owners}", said)

    def test_what_a_column_needs(self) -> None:
        """A column of work needs effects; an unknown effect is one error, not two."""
        scene = self.write(CLOSED)
        needs = "column 'work_friction' needs effects, which this body does not have"
        self.assertIn(needs, self.refuse(scene, "--set", "output.columns=work_friction"))
        error = self.refuse(
            self.write(CLOSED + "&effects no_friction = 1 /\n"),
            "--set",
            "output.columns=work_friction",
        )
        self.assertIn("unknown key 'no_friction'", error)
        self.assertNotIn("work_friction", error)

    def test_the_length_of_a_quaternion(self) -> None:
        """The message names it."""
        text = GOOD.replace("theta = 0.19634954084936207", "quaternion = 1, 0, 0.1, 0")
        text = text.replace("psi_rate = 1.0", "omega = 0, 0, 1").replace("'lagrange'", "'auto'")
        self.assertIn("norm of the quaternion is 1.004987562112089, not 1", self.hint(text))

    def test_carets_point_at_elements(self) -> None:
        """At the element of a list that is meant, not at its first."""
        for settings, element in (
            (["top.inertia=0.5,0.5,2.5"], "2.5"),
            (["top.inertia=0.5,-1,0.5"], "-1"),
            (["output.columns=t,theta,thetta"], "thetta"),
            (["output.columns=t,theta,t"], ",t"),
            (["output.events=maximum theta,nonsense"], "nonsense"),
            (["study.kind=stability", "stability.cases=thousand_nutations,nonsense"], "nonsense"),
            (["study.kind=stability", "stability.methods=rk4,ode45,nonsense"], "nonsense"),
            (["study.kind=stability", "stability.methods=rk4,ode45/nonsense"], "ode45/nonsense"),
        ):
            with self.subTest(settings):
                overrides = [part for setting in settings for part in ("--set", setting)]
                error = self.refuse(self.write(), *overrides)
                column = settings[-1].rindex(element) + 1 + element.startswith(",")
                self.assertIn(f"--set:1:{column}: error: ", error)
        text = SWEEP + "&sweep parameter(1) = 'top.mass'\nvalues(1,:) = 1, 2, -3, 4 /\n"
        error = self.refuse(self.write(text))
        line = text[: text.index("values(1")].count("\n") + 1
        self.assertIn(f"scene.nml:{line}:21: error: top.mass must be > 0", error)

    def test_what_is_there_elsewhere(self) -> None:
        """The exact solution is a method, but none that a stability study compares."""
        settings = ["--set", "study.kind=stability", "--set", "stability.methods=rk4,exact"]
        error = self.refuse(self.write(), *settings)
        self.assertIn("the exact solution is not among the compared methods", error)

    def test_ranges_of_swept_parameters(self) -> None:
        """A value of an axis outside an interval must be in it."""
        text = SWEEP + "&effects drag_moment = 0, 0, 0.1 drag_exponent = 2 /\n"
        text += "&sweep parameter(1) = 'effects.drag_exponent'\nvalues(1,:) = 1, 4 /\n"
        self.assertIn("effects.drag_exponent must be in [1, 3]", self.refuse(self.write(text)))

    def test_a_tolerance_that_is_not_used(self) -> None:
        """The motion is known in closed form: it is said, and computed all the same."""
        scene = self.write(CLOSED)
        for key, value in (("relative_tolerance", "1e-3"), ("absolute_tolerance", "1e-3")):
            result = self.run_program(scene, "--set", f"integration.{key}={value}")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn(f"warning: integration.{key} is not used", result.stderr)
            result = self.run_program("--check", scene, "--set", f"integration.{key}={value}")
            said = " ".join(result.stdout.replace("\n! ", " ").split())
            self.assertIn(f"integration.{key} is not used.", said)
        self.assertEqual(self.run_program(scene).stderr, "")
        result = self.run_program(self.write(), "--set", "integration.method=ode45")
        self.assertNotIn("not used", result.stderr)

    def test_every_case_of_a_sweep_is_looked_at(self) -> None:
        """An inertia that no body has, in a case that is not the first."""
        text = SWEEP + "&sweep parameter(1) = 'top.length', values(1,:) = 0.1, 0.2, 3, 4 /\n"
        result = self.run_program(self.write(text))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr.count("no mass distribution has this inertia"), 1)
        self.assertIn("warning: case 3: no mass distribution has this inertia", result.stderr)
        text = text.replace("0.1, 0.2, 3, 4", "3, 0.1, 4")
        result = self.run_program(self.write(text))
        self.assertEqual(result.stderr.count("no mass distribution has this inertia"), 1)
        self.assertNotIn("case 1", result.stderr)
        text = text.replace("3, 0.1, 4", "0.1, 0.2")
        self.assertEqual(self.run_program(self.write(text)).stderr, "")

    def test_what_damping_changes_is_not_constant(self) -> None:
        """Momentum and energy of the start."""
        result = self.run_program("--check", self.write(DAMPED))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertNotIn("constants", result.stdout)
        self.assertRegex(result.stdout, r"start +Lz = .* J s, E = .* J; the damping changes both")
        self.assertIn("constants c1 = Lz", self.run_program("--check", self.write()).stdout)


class WidthTest(ProgramCase):
    """Messages on a terminal are as wide as it is."""

    def on_terminal(self, columns: int, *arguments: object) -> list[str]:
        """The lines that the program shows on a terminal of so many columns, without colours."""
        try:
            child, terminal = pty.fork()
        except OSError as error:
            self.skipTest(f"no terminal can be opened: {error}")
        if child == 0:
            os.chdir(self.folder)
            os.read(0, 1)  # until the terminal has its size
            environment = {**os.environ, "NO_COLOR": "1"}
            os.execve(PROGRAM, [str(PROGRAM), *map(str, arguments)], environment)
        fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        os.write(terminal, b"\n")
        shown, deadline = b"", time.monotonic() + 30
        while time.monotonic() < deadline:
            try:
                piece = os.read(terminal, 65536)
            except OSError:  # the program ended
                break
            if not piece:
                break
            shown += piece
        os.close(terminal)
        os.waitpid(child, 0)
        return shown.decode().replace("\r", "").strip("\n").split("\n")

    def test_width_of_messages(self) -> None:
        """Words are wrapped; the line with the place stays one, for tools."""
        scene = self.write(GOOD.replace("mass", "masss").replace("'rk4'", "'nonsensical'"))
        wide = self.refuse(scene)
        for columns in (50, 72, 120):
            lines = self.on_terminal(columns, scene)
            places = [line for line in lines if line.startswith(str(scene))]
            self.assertEqual(len(places), wide.count("error: "))
            for line in lines:
                if not line.startswith(str(scene)):
                    self.assertLessEqual(len(line), columns)
            self.assertEqual("".join("".join(lines).split()), "".join(wide.split()))
        for line in wide.splitlines():
            if not line.startswith(str(scene)):
                self.assertLessEqual(len(line), 100)

    def test_width_of_lists(self) -> None:
        """Output for other programs is not wrapped."""
        for topic in ("columns", "methods", "parameters", "events"):
            whole = self.run_program("list", topic).stdout
            lines = self.on_terminal(70, "list", topic)
            self.assertEqual("".join("".join(lines).split()), "".join(whole.split()))
            self.assertLessEqual(max(map(len, lines)), 70)


class StartTest(ProgramCase):
    """The first row is the start as it was given."""

    COLUMNS = (
        "'t', 'phi', 'theta', 'psi', 'phi_rate', 'theta_rate', 'psi_rate', 'omega1',"
        " 'omega2', 'omega3', 'q0', 'q1', 'q2', 'q3', 'energy_error', 'R3', 'R4'"
    )
    HEAD = """\
&top mass = 1, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&span t_end = 0.1 samples = 2 /
"""

    def first_row(self, text: str, *settings: str) -> dict[str, str]:
        """The first row of a trajectory, as it stands there."""
        scene = self.write(self.HEAD + f"&output columns = {self.COLUMNS} /\n" + text)
        table = self.compute(scene, *settings)
        return dict(zip(table.names, table.rows[0], strict=True))

    def test_every_way_to_give_it(self) -> None:
        """Under every formulation: each number given stands there, to its last digit."""
        ways = (
            {
                "phi": 0.1,
                "theta": 0.3,
                "psi": -0.7,
                "phi_rate": 0,
                "theta_rate": 0,
                "psi_rate": 1.1,
            },
            {"phi": 0, "theta": 1.7, "psi": 0, "phi_rate": 0.9, "theta_rate": -0.3, "omega3": 4.7},
            {"theta": 2.9, "phi_rate": 1.3, "theta_rate": 0.1, "omega3": -0.7},
            {"phi": 1, "theta": 1.1, "psi": 2, "omega": [0.1, 0.2, 0.7]},
            {"quaternion": [0.5, -0.5, 0.5, 0.5], "omega": [0.3, 0, 0.7]},
            {"quaternion": [-0.48, 0.64, 0.36, 0.48], "omega": [0.3, 0.1, -7]},
        )
        forms = (
            "auto",
            "euler",
            "lagrange",
            "lagrange_energy",
            "rigid_body",
            "space_frame",
        )
        for way in ways:
            start = ", ".join(f"{k} = {str(v).strip('[]')}" for k, v in way.items())
            numbers = {k: v for k, v in way.items() if not isinstance(v, list)}
            for prefix, name, count in (("q", "quaternion", 4), ("omega", "omega", 3)):
                for i in range(count if name in way else 0):
                    numbers[f"{prefix}{i + (name == 'omega')}"] = way[name][i]
            for form in forms:
                settings = [] if form == "auto" else [f"integration.formulation={form}"]
                settings += (
                    [] if form == "auto" else ["integration.method=rk4", "integration.steps=8"]
                )
                with self.subTest(form=form, start=start):
                    row = self.first_row(f"&initial {start} /\n", *settings)
                    for name, number in numbers.items():
                        self.assertEqual(float(row[name]), number, name)
                    for name in ("t", "energy_error", "R3", "R4"):
                        self.assertEqual(float(row[name]), 0, name)
                    self.assertNotIn("-0", row.values())

    def test_the_next_row_is_close(self) -> None:
        """No angle and no sign of the quaternion jumps after the start."""
        for start in (
            "quaternion = -0.48, 0.64, 0.36, 0.48",
            "quaternion = 0.48, -0.64, -0.36, -0.48",
        ):
            for method in ("exact", "taylor"):
                scene = self.write(
                    self.HEAD + f"&output columns = {self.COLUMNS} /\n"
                    f"&initial {start}, omega = 0.3, 0.1, -2 /\n"
                )
                table = self.compute(scene, f"integration.method={method}", "span.t_end=1e-3")
                first, second = ([float(x) for x in row[1:4] + row[10:14]] for row in table.rows)
                for a, b in zip(first, second, strict=True):
                    self.assertAlmostEqual(a, b, delta=0.01)


class EvaluationsTest(ProgramCase):
    """Work and time of a work-precision row are of the same computation."""

    def test_evaluations_do_not_count_comparisons(self) -> None:
        """The interval between error checks has no influence."""
        text = GOOD[: GOOD.index("&integration")].replace(
            "&top", "&study kind = 'work_precision' /\n&top"
        )
        scene = self.write(
            text
            + "&work_precision methods = 'dop853', 'ode45', 'arkode_erk', 'taylor', 'gauss_4'\n"
            "tolerances = 1e-9, steps = 200, repeats = 1 /\n"
        )
        counts = []
        for samples in (2, 101):
            table = self.compute(scene, f"span.samples={samples}")
            rows = zip(table.texts("method"), table.texts("evaluations"), strict=True)
            counts.append(dict(rows))
        self.assertEqual(counts[0], counts[1])


if __name__ == "__main__":
    import unittest

    unittest.main()
