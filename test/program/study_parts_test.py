"""Studies other than sweeps in parts: merged parts are the whole, apart from dates and times."""

import csv
import os
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
EXE = os.environ["SPINTOP_EXE"]
MPI_EXE = os.environ.get("SPINTOP_MPI_EXE", str(ROOT / "build/mpi/spintop"))
MPI = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_hwloc_base_binding_policy": "none",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
    "PRTE_MCA_hwloc_default_binding_policy": "none",
}
BODY = """
&top mass = 1  inertia = 1, 1.5, 2.25  centre_of_mass = 0.1, 0.05, 0.2 /
&initial quaternion = 0.8, 0.6, 0, 0  omega = 0.5, 0.5, 1 /
&span t_end = 2 /
"""
PRECISION = f"""
&study kind = 'work_precision' /{BODY}
&work_precision methods = 'taylor', 'rk4', 'ode45' repeats = 1
                tolerances = 1e-6, 1e-9 steps = 100, 200 /
&sweep parameter(1) = 'initial.omega(3)', values(1,:) = 1, 2, 3 /
"""
STABILITY = f"""
&study kind = 'stability' /{BODY}
&stability cases = 'slow_top', 'sleeping_below', 'intermediate_axis', 'slow_top', 'sleeping_above'
           methods = 'taylor', 'rk4', 'dop853/lagrange' /
"""
BENCHMARK = """
&study kind = 'benchmark' /
&benchmark cases = 'steady_cone', 'heavy_top_start', 'simo_wong' /
"""
TRAJECTORY = f"&study kind = 'trajectory' /{BODY}"
TIMED = {"time_s", "front"}
"""Columns that depend on times."""
BEST = {"method", "formulation", "setting", "value", "error", "evaluations"}
"""Those of a benchmark that belong to its fastest setting."""


class StudyPartsTest(unittest.TestCase):
    """A study as a whole, in parts, and by ranks."""

    def setUp(self) -> None:
        """Make a folder for inputs and results."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def call(self, *arguments: object, command: tuple = (EXE,)) -> subprocess.CompletedProcess:
        """Run the program in the folder."""
        return subprocess.run(
            list(map(str, (*command, *arguments))),
            capture_output=True, text=True, timeout=1200, cwd=self.folder,
            env=os.environ | MPI, check=False,
        )  # fmt: skip

    def run_study(self, text: str, folder: str, *options: object, command: tuple = (EXE,)) -> str:
        """Run a study into a folder, and give what it says."""
        (self.folder / "study.nml").write_text(text, encoding="utf-8")
        result = self.call("study.nml", "-o", folder, *options, command=command)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        return result.stdout

    def read(self, name: str) -> tuple[list[str], list[dict[str, str]], list[str]]:
        """Header without its date, rows, and comments after them."""
        lines = (self.folder / name).read_text(encoding="utf-8").splitlines()
        first = next(i for i, line in enumerate(lines) if not line.startswith("#"))
        head = [line for line in lines[: first + 1] if not line.startswith("# date: ")]
        self.assertEqual(len(head), first, "one date")
        last = next((i for i in range(first, len(lines)) if lines[i].startswith("#")), len(lines))
        self.assertRegex(lines[-1], r"^# end: \d+ rows, ")
        return head, list(csv.DictReader(lines[first:last])), lines[last:-1]

    def check_same(self, found: str, whole: str, varying: set[str]) -> None:
        """Two tables are the same apart from dates, times, and the order by times of a problem."""
        heads, rows, words = zip(self.read(found), self.read(whole), strict=True)
        self.assertEqual(*heads)
        self.assertEqual(*([re.split(" is | takes ", word)[0] for word in each] for each in words))
        for each in rows:
            if "problem" in each[0]:
                each.sort(key=lambda row: (row["problem"], row["method"], row["setting"]))
        kept = [[{k: v for k, v in r.items() if k not in varying} for r in each] for each in rows]
        self.assertEqual(*kept)

    def check_parts(self, text: str, parts: int, varying: set[str] = TIMED) -> None:
        """The merged parts are the whole, and byte for byte what the parts have."""
        self.run_study(text, "whole")
        names = []
        for part in range(1, parts + 1):
            said = self.run_study(text, "parts", "--shard", f"{part}/{parts}")
            self.assertRegex(said, rf"part {part} of {parts}: (no )?cases ")
            names.append(f"parts/study.{part}-of-{parts}.csv")
        result = self.call("merge", "all.csv", *reversed(names))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.check_same("all.csv", "whole/study.csv", varying)
        bodies = []
        for name in names:
            *_, columns, rows = self.split(name)
            bodies.append("".join(f"{line}\n" for line in rows.splitlines() if line[0] != "#"))
        merged = (self.folder / "all.csv").read_text(encoding="utf-8")
        self.assertIn(columns + "".join(bodies), merged)
        self.assertNotIn("# part ", merged)

    def split(self, name: str) -> tuple[str, str, str]:
        """Comments, names of columns, and the rest of a table."""
        text = (self.folder / name).read_text(encoding="utf-8")
        end = 0
        while text[end] == "#":
            end = text.index("\n", end) + 1
        names = text.index("\n", end) + 1
        return text[:end], text[end:names], text[names:]

    def test_work_precision(self) -> None:
        """A problem is a case; more parts than problems leave one empty."""
        self.check_parts(PRECISION, 2)
        self.check_parts(PRECISION, 4)

    def test_stability(self) -> None:
        """A motion of the catalogue is a case."""
        self.check_parts(STABILITY, 3)

    def test_benchmarks(self) -> None:
        """A benchmark is a case. Which setting is the fastest depends on times."""
        self.check_parts(BENCHMARK, 2, TIMED | BEST)

    def test_check(self) -> None:
        """--check tells of the part."""
        said = self.run_study(PRECISION, "none", "--check", "--shard", "2/2")
        self.assertIn("part 2 of 2: cases 3 to 3 of 3", said)

    def test_refused(self) -> None:
        """Trajectories have no parts; a part is missing, cut off, or of another input."""
        (self.folder / "study.nml").write_text(TRAJECTORY, encoding="utf-8")
        refused = self.call("study.nml", "--shard", "1/2")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("--shard is not for trajectories", refused.stderr)
        for part in (1, 2):
            self.run_study(STABILITY, "parts", "--shard", f"{part}/2")
        names = [f"parts/study.{part}-of-2.csv" for part in (1, 2)]
        self.assertIn("missing of 2 parts: 2", self.call("merge", "all.csv", names[0]).stderr)
        other = STABILITY.replace("omega = 0.5, 0.5, 1", "omega = 0.5, 0.5, 2")
        self.run_study(other, "other", "--shard", "2/2")
        result = self.call("merge", "all.csv", names[0], "other/study.2-of-2.csv")
        self.assertIn("part of another study than", result.stderr)
        path = self.folder / names[1]
        text = path.read_text(encoding="utf-8")
        path.write_text(text[: text.rindex("# end")], encoding="utf-8")
        result = self.call("merge", "all.csv", *names)
        self.assertEqual(result.returncode, 2)
        self.assertIn("study.2-of-2.csv is not complete", result.stderr)
        self.assertFalse((self.folder / "all.csv").exists())

    def test_ranks(self) -> None:
        """Ranks share the cases of a stability study; other studies are computed by the first."""
        if not shutil.which("mpirun") or not Path(MPI_EXE).is_file():
            self.skipTest("no MPI: scripts/setup --mpi installs and builds what it takes")
        for name, text in (
            ("stability", STABILITY),
            ("precision", PRECISION),
            ("trajectory", TRAJECTORY),
        ):
            said = self.run_study(text, name)
            for ranks in (1, 2, 3):
                with self.subTest(f"{name}, {ranks} ranks"):
                    command = ("mpirun", "-np", ranks, MPI_EXE)
                    heard = self.run_study(text, f"{name}_{ranks}", command=command)
                    self.assertEqual(heard.count("study.nml: "), 1)
                    self.check_same(f"{name}_{ranks}/study.csv", f"{name}/study.csv", TIMED)
                    if name == "stability":
                        counts = [[line for line in text.splitlines() if " accurate" in line]
                                  for text in (said, heard)]  # fmt: skip
                        self.assertEqual(*counts)

    def test_parts_by_ranks(self) -> None:
        """A part is shared out like a whole."""
        if not shutil.which("mpirun") or not Path(MPI_EXE).is_file():
            self.skipTest("no MPI: scripts/setup --mpi installs and builds what it takes")
        self.run_study(STABILITY, "alone", "--shard", "1/2")
        command = ("mpirun", "-np", 2, MPI_EXE)
        self.run_study(STABILITY, "ranks", "--shard", "1/2", command=command)
        self.check_same("ranks/study.1-of-2.csv", "alone/study.1-of-2.csv", TIMED)


if __name__ == "__main__":
    unittest.main()
