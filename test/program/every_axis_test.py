"""Every number that a sweep may vary changes the motion, or is refused: no axis is ignored."""

import itertools
import json
import re
import unittest
from typing import ClassVar

from program_test import ProgramCase

BODY = "&top mass = 1 inertia = 0.9, 0.8, 0.3 centre_of_mass = 0.1, 0.05, 0.7 /\n"
SYMMETRIC = "&top mass = 1 inertia = 0.9, 0.9, 0.3 length = 0.7 /\n"
ANGLES = "&initial theta = 0.4 omega3 = 7 /\n"
VECTORS = "&initial quaternion = 0.8, 0.6, 0, 0 omega = 1, 2, 7 /\n"
PARTS = (
    "&part shape = 'cone' density = 7800 radius = 0.02 thickness = 0.1 /\n"
    "&part shape = 'cylinder' mass = 0.5 radius = 0.1 thickness = 0.02 place = 0.1, 0, 0.5 /\n"
)
EFFECTS = (
    "&effects vibration_amplitude = 0.01, 0, 0.02 vibration_rate = 20 torque_body = 0.1, 0.1, 0.1"
    " torque_body_amplitude = 0.1, 0.2, 0.1 torque_body_rate = 3"
    " rotor_momentum = 0, 0, 0.5 earth_rate = 0.01 latitude = 1 /\n"
)
REST = (
    "&study kind = 'sweep' /\n&span t_end = 0.5 /\n"
    "&output columns = 'theta_end', 'phi_end', 'psi_end', 'force_max', 't_end' /\n"
)


class EveryAxisTest(ProgramCase):
    """The numbers of the groups that describe the motion, from the list of parameters."""

    #: What only says how a motion is computed need not change it.
    GROUPS: ClassVar = ("top", "part", "initial", "effects", "span")

    def numbers(self) -> list[str]:
        """All of them by name; of lists and of groups that repeat the first three."""
        listed = json.loads(self.run_program("list", "parameters", "--json").stdout)["parameters"]
        names = []
        for parameter in listed:
            if parameter["group"] not in self.GROUPS or parameter["type"] not in (
                "real",
                "integer",
            ):
                continue
            sizes = re.findall(r"\d+", parameter["full_name"].removeprefix(parameter["name"]))
            ranges = [range(1, min(3, int(size)) + 1) for size in sizes]
            for place in itertools.product(*ranges):
                subscripts = ",".join(map(str, place))
                names.append(parameter["name"] + (f"({subscripts})" if place else ""))
        self.assertIn("initial.omega(1)", names)
        self.assertIn("top.inertia_tensor(1,3)", names)
        return names

    def ends(self, scene: str, name: str) -> set[tuple[str, ...]] | None:
        """The ends of the motions with two values of a number; none if the sweep is refused."""
        axis = f"&sweep parameter(1) = '{name}' values(1,:) = 0.31, 0.37 /\n"
        result = self.run_program("--restart", self.write(scene + REST + axis))
        if result.returncode == 2:
            return None
        return {tuple(row[3:-1]) for row in self.table().rows}

    def test_no_axis_is_ignored(self) -> None:
        """In scenes that give their start and their body in different ways."""
        names = self.numbers()
        scenes = (BODY + ANGLES, BODY + VECTORS, SYMMETRIC + ANGLES, PARTS + ANGLES)
        for scene in (*scenes, BODY + ANGLES + EFFECTS):
            varied = 0
            for name in names:
                ends = self.ends(scene, name)
                varied += ends is not None
                self.assertNotEqual(len(ends or ()), 1, scene + name)
            self.assertGreater(varied, 5)

    def test_parts_of_vectors(self) -> None:
        """All elements have values or vary, whatever gives the cases."""
        grid = (
            "&sweep parameter(1) = 'top.mass' values(1,:) = 1\n"
            "parameter(2) = 'initial.omega(1)' values(2,:) = 1, 2 /\n"
        )
        scene = self.write(BODY + ANGLES + REST + grid)
        told = r"initial\.omega\(2\) is missing(\n.*)+initial\.omega\(1\) varies and requires it"
        self.assertRegex(self.refuse(scene), told)
        (self.folder / "cases.csv").write_text("top.centre_of_mass(3)\n0.5\n", encoding="utf-8")
        scene = self.write(SYMMETRIC + ANGLES + REST + "&sweep table = 'cases.csv' /\n")
        told = r"centre_of_mass\(1\) is missing(\n.*)+top\.centre_of_mass\(3\) varies"
        self.assertRegex(self.refuse(scene), told)
        start = "&initial theta = 0.4 /\n&sweep combine = 'zip',"
        axes = " parameter = 'initial.omega(1)', 'initial.omega(3)', 'initial.omega(2)',"
        values = " values(1,:) = 1, 2, values(2,:) = 3, 4, values(3,:) = 5, 6 /\n"
        varied = self.compute(self.write(BODY + REST + start + axes + values)).rows
        start = "&initial theta = 0.4 omega = 1, 5, 3 /\n"
        mass = "&sweep parameter = 'top.mass' values(1,:) = 1 /\n"
        given = self.compute(self.write(BODY + REST + start + mass)).rows
        self.assertEqual(given[0][3:], varied[0][5:])


if __name__ == "__main__":
    unittest.main()
