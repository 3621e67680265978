"""Tests of what users ask of figures: the language, units, lines, and cases of a sweep."""

import math
import re
import subprocess

import numpy as np
import pytest
from matplotlib.text import Text

from conftest import ROOT
from figure_checks import problems_of
from figure_look_test import made_up
from plot_case import TRAJECTORY, TableCase, a_cloud, a_map, a_trajectory
from reporting.page import make_page
from reporting.study import read_study
from spintop_figures import draw, read_table
from spintop_figures.registry import choose_figures
from spintop_figures.style.look import Options, the_look
from spintop_figures.style.numbers import speak
from spintop_figures.tables.names import NAMES, axis_of, name_of, number_in
from spintop_figures.tables.table import TableError
from spintop_figures.tables.words import LANGUAGES, dictionary, phrases, say

LETTERS = re.compile(r"[A-Za-z\u00c0-\u017f]{3,}")
OWN = {"rpm", "hard", "case", "heyoka", "Gauss", "Crank", "Nicolson", "DOP", "Taylor", "Euler"}
"""Names, and words of the tables' own."""


def strange_words(figure: object, language: str) -> set[str]:
    """The words of a figure, but those of titles, that the dictionary does not have."""
    texts = [text.get_text() for text in figure.findobj(Text)]
    texts = [re.sub(r"\$[^$]*\$", "", text) for text in texts if not text.startswith("A top")]
    known = " ".join(entry[language] for entry in dictionary().values())
    return set(LETTERS.findall(" ".join(texts))) - set(LETTERS.findall(known)) - OWN


class OptionsTest(TableCase):
    def test_words(self) -> None:
        """Nothing is said twice, and every name of a quantity is in the dictionary."""
        for language in LANGUAGES[1:]:
            with self.subTest(language), the_look(Options(language=language)):
                for text in phrases(language)[1].values():
                    assert say(text) == text
        names = {name.words for name in NAMES.values()} - phrases("de")[1].keys()
        assert [name for name in names if re.search(r"\b[a-z]{3}", name)] == []

    @pytest.mark.slow
    def test_languages(self) -> None:
        """All words are in the language, in legends and at ticks too; titles of tables stay."""
        seen = set()
        for name, text in made_up().items():
            table = read_table(self.put(f"{name}.csv", text))
            for kind in choose_figures(table)[0]:
                for language in LANGUAGES[1:] if kind.name not in seen else ():
                    seen.add(kind.name)
                    with self.subTest(table=name, kind=kind.name, language=language):
                        figure = draw(table, kind.name, language=language)
                        assert problems_of(figure) == []
                        assert strange_words(figure, language) == set()
                        assert figure.get_supxlabel() == table.title

    def test_numbers(self) -> None:
        """Numbers of other languages have commas; a unit is that of the axes which are named."""
        table = self.read(a_trajectory())
        unit = {"theta": "rad", "t": "ms"}
        figure = draw(table, "angles", language="de", unit=unit, line={"x": "0.5 s"})
        assert problems_of(figure) == []
        labels = {text.get_text() for text in figure.findobj(Text)}
        assert {"Neigung $\\theta$ (rad)", "Pr\u00e4zession $\\phi$ (Grad)"} <= labels
        assert "Zeit t (ms)" in labels
        inclination = figure.axes[1].yaxis
        angle = np.radians(np.mean(inclination.get_view_interval()))
        ticks = [label.get_text() for label in inclination.get_ticklabels()]
        shown = [float(text.replace(",", ".")) for text in ticks]
        assert min(shown) - 0.1 < angle < max(shown) + 0.1
        for axes in figure.axes:
            assert 0.5 in [line.get_xdata()[0] for line in axes.lines]
        spinning = self.read(a_trajectory([*TRAJECTORY, "omega3"], omega3=math.pi))
        spinning.units["omega3"] = "rad/s"
        figure = draw(spinning, y="omega3", unit={"": "rpm"}, range={"y": (0, 60)})
        assert problems_of(figure) == []
        axes = figure.axes[0]
        assert axes.get_ylabel() == "spin $\\omega_3$ (rpm)"
        self.assertAlmostEqual(axes.get_ylim()[1], 2 * math.pi)

    def test_names_with_units(self) -> None:
        assert axis_of("initial.omega3_rpm") == axis_of("initial.omega3")
        assert name_of("top.mass_g") == "mass"
        assert name_of("offset.omega3_deg") == "offset of \N{GREEK SMALL LETTER OMEGA}\u2083"
        assert name_of("scale.axis_x") == "scale of axis x"
        assert number_in("90", "rad/s") == 90
        assert number_in("60 rpm", "rad/s") == pytest.approx(2 * np.pi)
        assert number_in("3.14159rad", "degrees") == pytest.approx(180, rel=1e-5)

    def test_columns_in_other_units(self) -> None:
        """A column has its name with a unit, too: in that it is drawn, on log axes as on others."""
        spinning = self.read(a_trajectory([*TRAJECTORY, "omega3"], omega3=math.pi))
        names = ["theta_deg", "omega3_rpm", "theta_rad"]
        for log in ("", "y"):
            figure = draw(spinning, y=names, x="t_ms", log=log)
            assert problems_of(figure) == []
            found = [axes.get_ylabel().replace("\n", " ") for axes in figure.axes]
            theta = "inclination $\\theta$"
            assert found == [f"{theta} (degrees)", "spin $\\omega_3$ (rpm)", f"{theta} (rad)"]
            assert "(ms)" in figure.axes[-1].get_xlabel()
            drawn = [axes.lines[0].get_ydata()[0] for axes in figure.axes]
            angle = spinning.column("theta")[0]
            assert drawn == pytest.approx([math.degrees(angle), 30, angle])
        for name in ("theta_furlong", "theta_", "nowhere_deg"):
            with self.assertRaisesRegex(TableError, f"has no column {name}: no columns figure"):
                draw(spinning, y=name)

    def test_cases(self) -> None:
        """The nearest cases of a sweep over several parameters; the caption tells the value."""
        table = self.read(a_map())
        inclinations = sorted(set(table.rows["initial.theta_deg"]))
        figure = draw(table, "curves", at={"initial.theta_deg": inclinations[1] + 0.1})
        assert figure.get_supxlabel().endswith(f"initial inclination {inclinations[1]:g}")
        assert "spin ratio" in " ".join(axes.get_xlabel() for axes in figure.axes)
        cloud = self.read(a_cloud(2))
        for wrong in ({"top.mass": 1}, dict.fromkeys(cloud.axes(), 1)):
            with self.assertRaisesRegex(TableError, "among several swept parameters"):
                draw(cloud, "curves", at=wrong)

    def test_refusals(self) -> None:
        table = self.read(a_trajectory())
        for options, reason in (
            ({"language": "it"}, "languages are en, de, fr, not 'it'"),
            ({"unit": {"theta": "furlong"}}, "'furlong' is no unit of a column"),
            ({"line": {"z": 1}}, "a line is at a value of x or y, not of 'z'"),
        ):
            with self.assertRaisesRegex(ValueError, reason):
                draw(table, "angles", **options)
        for line, reason in (({"y": "1"}, "no y axis"), ({"x": "1 kg"}, "'1 kg' is no number in")):
            with self.assertRaisesRegex(TableError, reason):
                draw(table, "angles", line=line)
        path = self.put("a.csv", a_trajectory())
        assert "it is not like name=value" in self.call("--line", "x", path, code=2)
        looks = ("--language", "de", "--unit", "theta=rad", "--line", "x=0.5,1")
        assert self.call("--figure", "angles", *looks, path) == ""

    def test_report(self) -> None:
        """A report in German has German words for its own; the table and the title stay."""
        self.put("a.csv", a_trajectory())
        self.addCleanup(speak, "en")
        speak("de")
        page = make_page("My title", *read_study(self.folder))[0]
        assert '<html lang="de">' in page
        for words in ("Was gerechnet wurde", "Vollst\u00e4ndige Eingabe", "My title", "A top"):
            assert words in page
        assert not re.search(">(spintop report|Contents|Table|Columns|Method|Program)<", page)

    def test_film(self) -> None:
        """The film knows the languages; its words are in the dictionary."""
        command = [ROOT / "scripts" / "film", "--language", "it", "a.nml"]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        assert "invalid choice: 'it'" in run.stderr
        assert "2 times faster than real time" not in say_in("de", "2 times faster than real time")


def say_in(language: str, text: str) -> str:
    """A text in a language."""
    with the_look(Options(language=language)):
        return say(text)
