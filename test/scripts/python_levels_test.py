"""The level of the processor, by which the Python package chooses its library."""

import os
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from spintop.levels import NEEDED, chosen_folder, features, levels_of


class LevelsTest(unittest.TestCase):
    """Processors of all kinds."""

    def test_levels_of(self) -> None:
        """A level has all features of the levels before it."""
        words = [set(needed.split()) for needed in NEEDED.values()]
        assert levels_of(set()) == []
        assert levels_of(words[0] | words[1]) == ["v2", "v3"]
        assert levels_of(words[0] | words[2]) == ["v2"]
        assert levels_of(set.union(*words) | {"sse"}) == ["v2", "v3", "v4"]

    def test_features(self) -> None:
        """Those of the first processor; none where the system does not list any."""
        text = "model name\t: flags\nflags\t\t: fpu sse\n\nprocessor: 1\nflags\t: fpu\n"
        assert features(text) == {"fpu", "sse"}
        assert features("Features\t: fp asimd\n") == set()

    def test_chosen_folder(self) -> None:
        """The highest level, or that of SPINTOP_LEVEL; a package without levels is one folder."""
        with tempfile.TemporaryDirectory() as name:
            package = Path(name)
            with mock.patch.dict(os.environ, {"SPINTOP_LEVEL": "v9"}):
                assert chosen_folder(package) == package
            for level in NEEDED:
                (package / level).mkdir()
            with mock.patch("spintop.levels.levels_of", return_value=["v2", "v3"]):
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
                mock.patch("spintop.levels.levels_of", return_value=[]),
                self.assertRaisesRegex(ImportError, "older than x86-64-v2"),
            ):
                chosen_folder(package)
