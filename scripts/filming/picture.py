"""The pictures of a film: one motion or two, the time, and the inclination against time."""

import re
import textwrap
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from filming.stage import FROM_ASIDE, Look, Shape, Stage, View
from filming.take import Take
from spintop_figures.style.numbers import COMMA, localised
from spintop_figures.tables.words import say

DPI = 100
LETTERS, LARGE = 1 / 36, 1.3
"""Height of letters, of the height of a picture; titles are larger than the rest."""

LEAST_LETTERS, LARGEST_LETTERS = 12, 1 / 15
"""Pixels; smaller ones cannot be read. But no more than so large a part of a low picture."""

WIDE = 0.55
"""Width of a letter, of its height."""

STRIP, LINES = 0.2, 4.0
"""The part of a picture below the stages, the inclination against time: or as many lines."""

CURVES = ("ink", "ghost")
"""The colours of the inclination of the first motion and of the second, and of their titles."""

SHEET = Path(__file__).resolve().parent.parent / "reporting" / "page" / "page.css"
"""The style sheet of the report, whose stage has the colours of a film."""

REAL = 0.005
"""A speed that differs from that of life by less is that of life."""


def palette(dark: bool) -> dict[str, str]:
    """The colours of the page by their names, light or dark."""
    sheet = SHEET.read_text(encoding="utf-8")
    pairs = re.findall(r"--(?:body-)?([a-z]+): light-dark\((#\w+), (#\w+)\);", sheet)
    return {name: pair[dark] for name, *pair in pairs}


def describe_speed(speed: float) -> str:
    """How fast the film shows the motion: its seconds per second."""
    if abs(speed - 1) < REAL:
        return "real time"
    if speed > 1:
        return f"{speed:.3g} times faster than real time"
    return f"{1 / speed:.3g} times slower than real time"


class Camera:
    """Draws the pictures of a take, or of two, one after the other, on one figure."""

    def __init__(
        self, takes: list[Take], size: tuple[int, int], arrows: list[str], dark: bool, *,
        is_ghost: bool = False, view: View = FROM_ASIDE, speed: float = 0.0,
    ) -> None:  # fmt: skip
        """Prepare all that is the same in every picture.

        A second take is the ghost of the first, or beside it. The speed, seconds of motion per
        second of the film, is said if it is above zero.
        """
        self.takes, self.colours, self.scale = takes, palette(dark), size[1] / 720
        pixels = max(min(LEAST_LETTERS, LARGEST_LETTERS * size[1]), LETTERS * size[1])
        self.letters = pixels * 72 / DPI
        inches = (size[0] / DPI, size[1] / DPI)
        self.figure = Figure(figsize=inches, dpi=DPI, facecolor=self.colours["stage"])
        FigureCanvasAgg(self.figure)
        groups = [takes] if is_ghost else [[take] for take in takes]
        width, self.row = 1 / len(groups), 1.35 * pixels / size[1]
        self.strip = max(STRIP, LINES * self.row)
        top = self.add_titles(groups, round(width * size[0] / (LARGE * WIDE * pixels)))
        reach = max(Shape(take).reach for take in takes)
        aspect = width * size[0] / ((top - self.strip) * size[1])
        look = Look(self.colours, arrows, view, self.scale, self.letters)
        self.stages = []
        for i, group in enumerate(groups):
            axes = self.figure.add_axes((i * width, self.strip, width, top - self.strip))
            self.stages.append(Stage(axes, group, look, reach, aspect))
        self.cursor = self.add_chart()
        style = {"size": self.letters, "color": self.colours["quiet"]}
        style |= {"y": self.strip - 0.5 * self.row, "va": "center"}
        self.clock = self.figure.text(0.98, s="", ha="right", **style)
        if speed > 0:
            self.figure.text(0.5, s=say(localised(describe_speed(speed))), ha="center", **style)

    def add_titles(self, groups: list[list[Take]], letters: int) -> float:
        """The title of each motion, in lines of so many letters, in the colour of its curve.

        Returns the height of the lowest line, below which the stages are.
        """
        style = {"size": LARGE * self.letters, "va": "top"}
        lowest, colours = 1.0, iter(CURVES)
        for i, takes in enumerate(groups):
            height = 1 - 0.4 * self.row
            for take in takes:
                lines = textwrap.wrap(take.title, letters) or [""]
                words, place = "\n".join(lines), 0.02 + i / len(groups)
                colour = self.colours[next(colours)]
                self.figure.text(place, height, words, color=colour, **style)
                height -= LARGE * self.row * len(lines)
            lowest = min(lowest, height)
        return lowest

    def add_chart(self) -> object:
        """The inclination against time; returns the line of the present."""
        colours, size = self.colours, self.letters
        chart = self.figure.add_axes((0.075, 1.35 * self.row, 0.905, self.strip - 2.6 * self.row))
        chart.patch.set_alpha(0)
        for take, colour in zip(self.takes, CURVES, strict=False):
            theta = np.degrees(take.theta)
            chart.plot(take.times, theta, color=colours[colour], lw=1.3 * self.scale)
        chart.set_xlim(self.takes[0].times[0], self.takes[0].times[-1])
        for side in ("top", "right"):
            chart.spines[side].set_visible(False)
        for spine in chart.spines.values():
            spine.set_color(colours["faint"])
        chart.tick_params(colors=colours["quiet"], labelsize=size, length=3 * self.scale)
        chart.yaxis.set_major_locator(MaxNLocator(2))
        for axis in (chart.xaxis, chart.yaxis):
            axis.set_major_formatter(lambda x, _: localised(f"{x:.6g}"))
        words = {"size": size, "color": colours["quiet"], "va": "center"}
        what = say("θ (degrees) against time (s)")
        self.figure.text(0.02, self.strip - 0.5 * self.row, what, **words)
        return chart.axvline(self.takes[0].times[0], color=colours["mark"], lw=1.8 * self.scale)

    def show(self, picture: int) -> None:
        """Bring the figure to a picture of the film."""
        for stage in self.stages:
            stage.show(picture)
        rows = [take.rows[picture] for take in self.takes]
        time = self.takes[0].times[rows[0]]
        self.cursor.set_xdata([time, time])
        angles = [
            f"{np.degrees(take.theta[row]):.2f}°"
            for take, row in zip(self.takes, rows, strict=True)
        ]
        angles = "; ".join(angles) if COMMA.get() else ", ".join(angles)
        self.clock.set_text(localised(f"t = {time:.3f} s   θ = {angles}"))
