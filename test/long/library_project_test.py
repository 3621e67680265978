"""The project of the library's page: fpm builds it, and with it the whole library."""

import os
import sys
from pathlib import Path

from conftest import ROOT
from manual_test import ManualCase, parts_of_library_page


class LibraryProjectTest(ManualCase):
    def test_it_is_built(self) -> None:
        """It is built as the page says, and prints what the page says."""
        parts = parts_of_library_page()
        project = self.folder / "my_top"
        (project / "app").mkdir(parents=True)
        path = os.path.relpath(ROOT, project.resolve())
        manifest = parts["toml",].replace('"../spintop"', f'"{path}"')
        self.assertNotEqual(manifest, parts["toml",])
        (project / "fpm.toml").write_text(manifest, encoding="utf-8")
        (project / "app/main.f90").write_text(parts["fortran",], encoding="utf-8")
        activate = Path(sys.executable).parent / "activate"
        fpm = f". '{activate}' && '{sys.executable}' -m fpm"
        self.assertEqual(self.shell(f"cd my_top && {fpm} build").returncode, 0)
        done = self.shell(f"cd my_top && {fpm} run 2>/dev/null")
        self.check_output(done, parts["text", "output"])
