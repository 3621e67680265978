"""scripts/wheel: what the wheel has, its bits at each level of the processor, and bare systems."""

import json
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path
from typing import ClassVar

import numpy as np

from conftest import ROOT, execute, read
from spintop.library import levels

LARGEST = 15_000_000
"""Most bytes of the wheel."""
OLDEST_GLIBC = (2, 35)
"""The manual says that the wheel runs on this version."""
SCENE = (ROOT / "input/slow_top.nml").read_text(encoding="utf-8")


def group(name: str) -> str:
    return re.search(rf"^&{name}$.*?^/$", SCENE, re.MULTILINE | re.DOTALL)[0]


INPUT = f"""\
{group("top")}
{group("initial")}
&span nutations = 3 samples = 101 /
&output columns = 't', 'phi', 'theta', 'psi', 'energy', 'q0' /
"""
ANSWER = """\
import json, sys, time
begin = time.perf_counter()
import spintop
rows = spintop.run(sys.argv[1]).rows
columns = {name: [cell.hex() for cell in rows[name].tolist()] for name in rows}
seconds = time.perf_counter() - begin
print(json.dumps({"columns": columns, "seconds": seconds, "file": spintop.library()._name}))
"""
"""The motion of the first example by the package, with all bits, and the time from its import."""
BARE = """\
set -e
apt-get update -qq
apt-get install -qq -y --no-install-recommends python3-pip python3-numpy
python3 -m pip install -q --no-deps --no-index --root-user-action=ignore \\
    $(python3 -m pip install --help | grep -o -m1 -e --break-system-packages) /srv/files/*.whl
! command -v gfortran gcc
cd /
python3 /srv/files/answer.py /srv/files/scene.nml >/srv/files/found.json
python3 /srv/files/compare.py
python3 /srv/files/many.py
"""
COMPARE = """\
import json
found, expected = (json.load(open(f"/srv/files/{name}.json")) for name in ("found", "expected"))
same = found["columns"] == expected
if 'VERSION_ID="12"' not in open("/etc/os-release").read():  # other mathematical functions
    pairs = ((a, b) for name in expected for a, b in zip(found["columns"][name], expected[name]))
    same = all(abs(float.fromhex(a) - float.fromhex(b)) < 1e-12 for a, b in pairs)
assert same, "other numbers"
print("Example 1 in", round(found["seconds"], 2), "s by", found["file"])
"""
MANY = """\
import time
import numpy as np
import spintop
given = {"inertia1": 0.875, "inertia3": 0.25, "mgl": 8.5, "theta": 0.2}
given["omega3"] = np.linspace(1, 30, 10**6)
seconds = []
for _ in range(10):
    begin = time.process_time()
    found = spintop.tops(["theta_max", "nutation_period"], **given)
    seconds.append(time.process_time() - begin)
assert all(np.isfinite(column).all() for column in found.values())
print("a million tops in", round(min(seconds), 3), "s of processor time")
"""
"""The time of a sweep over an array, the best of some."""


@unittest.skipIf(platform.machine() != "x86_64", "the levels are those of x86-64")
class WheelTest(unittest.TestCase):
    folder: ClassVar[Path]
    wheel: ClassVar[Path]
    site: ClassVar[Path]

    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = Path(tempfile.mkdtemp(prefix="spintop wheel "))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        command = [ROOT / "scripts/wheel", cls.folder / "wheels"]
        subprocess.run(command, check=True, stdout=subprocess.PIPE)
        (cls.wheel,) = (cls.folder / "wheels").iterdir()
        cls.site = cls.folder / "site"
        pip = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        pip += ["--no-deps", "--no-index", "--target", str(cls.site), str(cls.wheel)]
        subprocess.run(pip, check=True)
        (cls.folder / "scene.nml").write_text(INPUT, encoding="utf-8")
        (cls.folder / "answer.py").write_text(ANSWER, encoding="utf-8")

    def answer(self, level: str) -> dict:
        paths = os.pathsep.join(map(str, (self.site, Path(np.__file__).parents[1])))
        environment = {"PATH": os.environ["PATH"], "PYTHONPATH": paths, "SPINTOP_LEVEL": level}
        words = (self.folder / "answer.py", self.folder / "scene.nml")
        done = execute(sys.executable, "-S", *words, cwd=self.folder, env=environment)
        return json.loads(done.stdout)

    def by_program(self, level: str) -> dict[str, list[str]]:
        folder = self.folder / level
        words = (ROOT / f"build/shared_{level}/spintop", "--quiet", "-o", folder)
        execute(*words, self.folder / "scene.nml", environment={"SPINTOP_LEVEL": level})
        rows = read(folder / "scene.csv", dtype=float)
        return {name: [number.hex() for number in rows[name].tolist()] for name in rows}

    def test_name_and_size(self) -> None:
        """For any Python, on the glibc that the manual names, and not too large."""
        known = r"spintop-[\d.]+-py3-none-manylinux_(\d+)_(\d+)_x86_64\.whl"
        self.assertRegex(self.wheel.name, f"^{known}$")
        tag = re.fullmatch(known, self.wheel.name)
        self.assertLessEqual((int(tag[1]), int(tag[2])), OLDEST_GLIBC)
        self.assertLess(self.wheel.stat().st_size, LARGEST)

    def test_licences(self) -> None:
        """Each library that comes along has the licence of its package beside it."""
        with zipfile.ZipFile(self.wheel) as wheel:
            names = wheel.namelist()
        licences, along = (
            [name.rpartition("/")[2] for name in names if name.startswith(folder)]
            for folder in ("spintop/licences", "spintop.libs/")
        )
        self.assertIn("spintop", licences)
        self.assertTrue(any(name.startswith("libgfortran") for name in along), along)
        self.assertTrue(any(name.startswith("libsundials_arkode") for name in along), along)
        self.assertFalse([name for name in along if re.match("lib(mpi|netcdf|flint)", name)], along)
        for name in along:
            stem = re.sub(r"-[0-9a-f]{8}(?=\.)", "", name)
            # The copy has the name by which it is loaded, the package that of the file.
            owners = execute("dpkg-query", "-S", f"*/{stem}*").stdout
            self.assertTrue(
                {line.split(":")[0] for line in owners.splitlines()} & {*licences}, name
            )

    def test_self_contained(self) -> None:
        """Nothing of the checkout is named, and libraries are looked for in the wheel only."""
        libraries = [path for path in self.site.rglob("*.so*") if path.is_file()]
        self.assertGreater(len(libraries), 8)
        for path in libraries:
            self.assertNotIn(os.fsencode(ROOT), path.read_bytes(), path.name)
            for found in re.findall(
                r"(?:RUNPATH|RPATH).*\[(.*)\]", execute("readelf", "-d", path).stdout
            ):
                self.assertTrue(found.startswith("$ORIGIN"), f"{path}: {found}")

    def test_levels(self) -> None:
        """Each level loads its library, with the bits of the program for that level."""
        for level in levels():
            with self.subTest(level):
                found = self.answer(level)
                self.assertIn(f"/spintop/{level}/libspintop.so.", found["file"])
                self.assertEqual(found["columns"], self.by_program(level))
        self.assertEqual(self.answer("")["file"], self.answer(levels()[-1])["file"])

    def test_bare_systems(self) -> None:
        """It installs in a Debian with Python and nothing else, and has the same numbers there."""
        files = self.folder / "files"
        files.mkdir()
        for path in (self.wheel, self.folder / "answer.py", self.folder / "scene.nml"):
            shutil.copy2(path, files)
        (files / "compare.py").write_text(COMPARE, encoding="utf-8")
        (files / "many.py").write_text(MANY, encoding="utf-8")
        expected = json.dumps(self.by_program(levels()[-1]))
        (files / "expected.json").write_text(expected, encoding="utf-8")
        for suite in ("bookworm", "trixie"):
            words = (ROOT / "scripts/fresh_machine", suite, BARE)
            done = execute(*words, code=None, environment={"SPINTOP_FILES": str(files)})
            if done.stdout.endswith("0 passed, 0 failed\n"):
                self.skipTest(done.stderr.strip())
            print(done.stdout)
            self.assertTrue(done.stdout.endswith("1 passed, 0 failed\n"), done.stdout + done.stderr)
