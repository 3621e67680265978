"""Tests of scripts/gallery: its table of figures, what it draws, what it complains of."""

import re
import runpy
import subprocess
import unittest
import unittest.mock
from pathlib import Path

from PIL import Image

from conftest import EXE, ROOT, called
from manual.pages import links_of, manual_pages
from plot_case import TableCase
from spintop_figures.methods.peers import DOCUMENTED as PEERS
from spintop_figures.registry import COMPARISONS, FIGURES

SCRIPT = runpy.run_path(str(ROOT / "scripts" / "gallery"))
GALLERY, Run = SCRIPT["GALLERY"], SCRIPT["Run"]
DRIFT = next(exhibit.runs for exhibit in GALLERY if exhibit.name == "drift")
run_it = subprocess.run
NUTATIONS = 500


def run_program(command: list[object], **options: object) -> subprocess.CompletedProcess:
    """Run the program under test in place of scripts/run, which would build another; it lists."""
    if command[:2] == [EXE, "list"]:
        return run_it(command, **options)
    assert command[:2] == [ROOT / "scripts" / "run", "--no-plots"], command
    return run_it([EXE, *command[2:]], **options)


class TableTest(unittest.TestCase):
    def test_exhibits(self) -> None:
        """Names are different; inputs and kinds of figures exist; captions end."""
        names = [exhibit.name for exhibit in GALLERY]
        assert len(names) == len(set(names))
        kinds = {kind.name for kind in (*FIGURES, *COMPARISONS)}
        joined = {kind.name for kind in COMPARISONS}
        for exhibit in GALLERY:
            with self.subTest(exhibit.name):
                assert set(exhibit.figures) <= kinds
                assert set(exhibit.documented) <= set(exhibit.figures)
                assert exhibit.caption.endswith(".")
                assert len(exhibit.runs) == 1 or set(exhibit.figures) <= joined
                for run in exhibit.runs:
                    assert (ROOT / "input" / f"{run.input}.nml").is_file()

    def test_paper(self) -> None:
        names = {exhibit.name for exhibit in GALLERY}
        paper = {f"figure{number}" for number in (2, 3, 4, 5, 6, 7, 8, 9, 11)} | {"table1"}
        assert paper <= names

    def test_manual(self) -> None:
        """The pictures of the front page and of the manual are those that --doc draws."""
        links = [link for page in manual_pages() for _, link in links_of(page)]
        shown = {Path(link).stem for link in links if re.search(r"figures/\w+\.png$", link)}
        joined = {kind.name for kind in COMPARISONS}
        drawn = {
            name if name in joined else f"{exhibit.runs[0].table}_{name}"
            for exhibit in GALLERY
            for name in exhibit.documented
        } | set(PEERS)
        files = {path.stem for path in (ROOT / "doc" / "figures").glob("*.png")}
        assert (shown, files) == (drawn, drawn)

    def test_runs(self) -> None:
        """Runs of one input with other settings have tables of their own."""
        assert Run("a").table == "a"
        assert Run("a").command() == "scripts/run input/a.nml"
        run = Run("a", ("integration.method=rk4",))
        expected = "--set integration.method=rk4 --set output.file=a_rk4"
        assert (run.table, run.command()) == ("a_rk4", f"scripts/run {expected} input/a.nml")
        runs = {run for exhibit in GALLERY for run in exhibit.runs}
        assert len({run.table for run in runs}) == len(runs)


class GalleryTest(TableCase):
    def test_equal_cost(self) -> None:
        """In a short part of the runs, to four percent."""
        short = ["--set", f"span.nutations={NUTATIONS}", "--set", "span.samples=2"]
        for run in DRIFT:
            settings = [setting for setting in run.settings if "steps=" not in setting]
            for setting in set(run.settings) - set(settings):
                steps = int(setting.partition("=")[2]) * NUTATIONS / 1e6
                settings.append(f"integration.steps={round(steps)}")
            words = [word for setting in settings for word in ("--set", setting)]
            command = [EXE, "--verbose", "-o", self.folder, *words, *short]
            command.append(ROOT / "input/long_drift.nml")
            said = run_it(command, check=True, capture_output=True, text=True).stdout
            count = re.search(r"(\d+) (right-hand sides|(RHS|function) evaluations)", said)
            (title,) = (setting for setting in settings if setting.startswith("study.title="))
            usual, finest = map(int, re.search(r"(\d+) function.* (\d+)$", title).groups())
            with self.subTest(run.table):
                cost = finest if "integration.method=taylor" in run.settings else usual
                self.assertAlmostEqual(int(count[1]) / NUTATIONS / cost, 1, delta=0.04)

    def gallery(self, *arguments: str | Path) -> tuple[int, str, str]:
        script = str(ROOT / "scripts" / "gallery")
        main = runpy.run_path(script)["main"]
        with unittest.mock.patch("subprocess.run", run_program):
            return called(main, script, *arguments)

    def test_draw(self) -> None:
        """Figures, tables and an index with captions; a table is computed once."""
        folder = self.folder / "new" / "gallery"
        wanted = ("figure8", "figure9", "tips", "events")
        code, output, complaints = self.gallery("-o", folder, *wanted)
        assert (code, complaints) == (0, "")
        stems = ["slow_top_lagrange_ode45_angles", "slow_top_lagrange_ode45_forces"]
        stems += ["slow_top_events.events_events", "traces"]
        expected = [*(str(folder / f"{stem}.png") for stem in stems), str(folder / "gallery.md")]
        assert output.split("\n")[:-1] == expected
        tables = {path.stem for path in (folder / "tables").iterdir()}
        expected = {"slow_top_lagrange_ode45", "tip_loop", "tip_cusp", "tip_wave"}
        assert tables == {*expected, "slow_top_events", "slow_top_events.events"}
        index = (folder / "gallery.md").read_text("utf-8")
        for exhibit in GALLERY:
            assert (exhibit.caption in index) == (exhibit.name in wanted)
        assert "slow_top_events.events.csv. spintop " in index
        assert "ODE45, default tolerances" in index
        for stem in stems:
            assert f"]({stem}.png)" in index
            assert (folder / f"{stem}.svg").stat().st_size > 10_000

    def test_list(self) -> None:
        code, output, _ = self.gallery("--list", "-o", self.folder / "none")
        assert (code, len(output.split("\n")) - 1) == (0, len(GALLERY))
        assert "(long)" in output
        assert not (self.folder / "none").exists()

    def test_complaints(self) -> None:
        """An unknown name is wrong usage; a figure that fails has a message."""
        code, _, complaints = self.gallery("figure1")
        assert (code, "nothing is named figure1" in complaints) == (2, True)
        file = self.put("file", "")
        code, _, complaints = self.gallery("-o", file, "figure8")
        assert (code, f"cannot write to {file}" in complaints) == (4, True)
        with unittest.mock.patch(f"{__name__}.EXE", "false"):
            code, _, complaints = self.gallery("-o", self.folder, "figure8")
        assert code == 2
        assert "slow_top_lagrange_ode45.nml ended with exit code 1" in complaints

    def test_small(self) -> None:
        for path in (ROOT / "doc" / "figures").glob("*.png"):
            assert path.stat().st_size < 200_000, path.name
            with Image.open(path) as picture:
                assert picture.mode == "P"
