"""scripts/fresh_machine trusts no folder that others than root may change."""

import os
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
SOMEBODY = 65534


@unittest.skipUnless(os.geteuid() == 0, "the owner of a folder is for root to change")
class OwnerTest(unittest.TestCase):
    """The folder of the systems and all above it belong to root."""

    def setUp(self) -> None:
        """A folder with a program in place of debootstrap, which fails."""
        folder = tempfile.TemporaryDirectory(prefix="spintop machines ")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        program = self.folder / "programs/debootstrap"
        program.parent.mkdir()
        program.write_text("#!/bin/sh\nexit 1\n", encoding="utf-8")
        program.chmod(0o755)

    def call(self, machines: Path) -> subprocess.CompletedProcess:
        """Run the script with a folder of the systems."""
        path = f"{self.folder / 'programs'}:{os.environ['PATH']}"
        return subprocess.run(
            [ROOT / "scripts/fresh_machine", "bookworm"], capture_output=True, text=True,
            env=os.environ | {"PATH": path, "SPINTOP_MACHINES": str(machines)}, check=False,
        )  # fmt: skip

    def test_own(self) -> None:
        """A folder that is made, and one of root's alone, are taken."""
        for _ in range(2):
            done = self.call(self.folder / "own")
            self.assertEqual((done.returncode, done.stdout), (0, "0 passed, 0 failed\n"))
            self.assertIn("debootstrap failed", done.stderr)
        self.assertEqual((self.folder / "own").stat().st_mode & 0o777, 0o700)

    def test_of_others(self) -> None:
        """Those of somebody else, or open to others, or below such a folder, or a link are not."""
        places = {name: self.folder / name for name in ("foreign", "open", "link", "sticky")}
        for name in ("foreign", "open", "sticky"):
            places[name].mkdir()
        os.chown(places["foreign"], SOMEBODY, -1)
        places["open"].chmod(0o777)
        places["sticky"].chmod(0o1777)
        places["link"].symlink_to(self.folder / "programs")
        for place in (*places.values(), places["foreign"] / "below", places["open"] / "below"):
            with self.subTest(place.relative_to(self.folder)):
                done = self.call(place)
                self.assertEqual((done.returncode, done.stdout), (2, ""))
                self.assertIn("others than root may change", done.stderr)
                self.assertEqual(list(place.rglob("*.tar")), [])
        self.assertEqual(self.call(places["sticky"] / "below").returncode, 0)


if __name__ == "__main__":
    unittest.main()
