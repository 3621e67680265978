"""What does not exist is nan with a note: each column of a sweep alone, for every sort of body."""

import json
import unittest

from program_test import ProgramCase

HEAD = "&study kind = 'sweep' /\n&initial theta = 0.9 omega = 0.3, 0.2, 9 /\n"
TOP = "&top mass = 1 inertia = 0.9, 0.9, 0.25 length = 0.7 "
SPAN = "&span t_end = 2.5 /\n"
TABLE = "&sweep table = 'cases.csv' /\n"
BODIES = """\
top.inertia(1),top.inertia(2),top.gravity,initial.theta
0.9,0.9,9.81,0.8
0.9,0.9,9.81,0
0.9,0.9,0,0.8
0.9,0.8,9.81,0.8
0.9,0.8,0,0.8
0.9,0.8,9.81,3.141592653589793
"""
"""Heavy, upright, free and asymmetric bodies, and one that hangs."""
SCENES = {
    "plain": TOP + "/\n",
    "friction": TOP + "/\n&effects friction_torque = 0.3 friction_smoothing = 0 /\n",
    "vibration": TOP + "/\n&effects vibration_amplitude = 0, 0, 0.01 vibration_rate = 60 /\n",
}


class MissingNumbersTest(ProgramCase):
    """No cell of a row that is ok is nan or inf without a word."""

    def test_every_column(self) -> None:
        """A bound that is not proved is inf, which says so; builds without balls have none."""
        listed = json.loads(self.run_program("list", "columns", "--json").stdout)["columns"]
        columns = [entry["name"] for entry in listed if entry["study"] == "sweep"]
        self.assertGreater(len(columns), 40)
        self.write(BODIES, "cases.csv")
        for scene, body in SCENES.items():
            self.write(HEAD + body + SPAN + TABLE, "scene.nml")
            for column in columns:
                with self.subTest(f"{column} of {scene}"):
                    self.check(column)

    def check(self, column: str) -> None:
        """Look at the rows of a table of one column."""
        run = self.run_program("scene.nml", "--set", f"output.columns={column}")
        if run.returncode == 2:
            self.assertIn("FLINT", run.stderr)
            return
        self.assertIn(run.returncode, (0, 3), run.stderr)
        table = self.table()
        self.assertEqual(len(table.rows), 6)
        for status, cell, notes in zip(*map(table.texts, ("status", column, "notes")), strict=True):
            if status == "ok" and not notes:
                unproved = column.endswith("_bound") and cell == "inf"
                self.assertTrue(unproved or cell not in ("nan", "inf", "-inf"), cell)


if __name__ == "__main__":
    unittest.main()
