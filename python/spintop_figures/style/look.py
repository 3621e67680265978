"""The look of all figures: colours by their role, settings of matplotlib, what a user asks for."""

import csv
import math
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.colors import get_named_colors_mapping, to_hex, to_rgb

from spintop_figures.style.numbers import COMMA
from spintop_figures.tables.names import UNITS, column_units
from spintop_figures.tables.words import LANGUAGE, LANGUAGES

CENTIMETRE = 1 / 2.54
"""In inches."""

WIDTHS = {"column": 8.5, "page": 18.3, "slide": 25.4}
"""Widths of figures by their names, in centimetres: of a column and a page of print, of a slide."""

WIDTH, LETTERS, SMALLEST = 7.2, 10.0, 6.5
"""Inches of a page, points of its letters and of the smallest that can be read."""

NARROWEST, SLIDE_HEIGHT = 2.4, WIDTHS["slide"] * 9 / 16 * CENTIMETRE
"""Inches of the narrowest figure with the usual letters; inches of the height of a slide."""

with Path(__file__).with_name("colours.csv").open(encoding="utf-8", newline="") as file:
    ROLES = {row["role"]: (row["light"], row["dark"]) for row in csv.DictReader(file)}
"""Colours on light and on dark ground. Those of lines, and the first three of classes of motion,
are far apart in lightness, for grey print; families of methods are in the registry's order."""

OURS = "spintop:"
INK, GROUND, GREY, FAINT, WASH, FAULT, HIDDEN, PALE = (
    OURS + role for role in ("ink", "ground", "grey", "faint", "wash", "fault", "pale1", "pale2")
)
"""Roles as names of colours, which matplotlib knows within the look; HIDDEN and PALE are tints of
the first two lines, for what is behind or below something."""

LINES = tuple(
    {"color": f"{OURS}line{number}", "linestyle": dashes}
    for number, dashes in enumerate(("-", "--", "-.", ":"), start=1)
)
"""Lines that differ in colour, in lightness and in dashes."""

DOTS = {"color": LINES[0]["color"], "linestyle": "", "marker": ".", "markersize": 4}
"""Rows that are too far apart to be joined."""

SETTINGS = {
    "axes.labelsize": "medium",
    **dict.fromkeys(("xtick.labelsize", "ytick.labelsize", "legend.fontsize"), "small"),
    **dict.fromkeys(("text.color", "axes.labelcolor", "xtick.color", "ytick.color"), INK),
    **dict.fromkeys(("axes.edgecolor", "lines.color", "patch.edgecolor"), INK),
    **dict.fromkeys(("figure.facecolor", "axes.facecolor", "savefig.facecolor"), GROUND),
    **dict.fromkeys(("axes.spines.top", "axes.spines.right", "legend.frameon"), False),
    **dict.fromkeys(("pdf.fonttype", "ps.fonttype"), 42),
    "axes.linewidth": 0.8,
    "axes.titley": 1.0,  # to look for a free place takes a quarter of the time
    "axes.titlelocation": "left",
    "axes.titlepad": 4,
    "axes.axisbelow": True,
    "grid.color": FAINT,
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.2,
    "lines.markersize": 6.0,
    "agg.path.chunksize": 10_000,
    "svg.hashsalt": "spintop",
}
"""Settings of matplotlib. They hold while a figure is drawn or saved, not for other figures. Sizes
of letters are relative to `font.size`, which follows from the width of the figure."""


@dataclass(frozen=True)
class Options:
    """What a user asks of a figure; without that it has the size and the look of all figures."""

    width: str | float | None = None
    """A name of WIDTHS, or centimetres; None is what the figure wants."""
    title: str | None = None
    """In place of the figure's own; the empty one leaves out the title and the line below."""
    dark: bool = False
    style: str | Path | None = None
    """A style sheet of matplotlib: its name, or a file."""
    font_size: float | None = None
    """Of the letters at the axes, in points."""
    decimal_comma: bool = False
    language: str = "en"
    """One of LANGUAGES; other numbers than English ones have decimal commas."""
    unit: Mapping[str, str] = field(default_factory=dict)
    """The unit of the axes of a column, such as rpm of `omega3`; of `""` all that can be in it."""
    line: Mapping[str, object] = field(default_factory=dict)
    """Values of x or y at which there are lines, of all panels: numbers, or texts with units."""
    at: Mapping[str, object] = field(default_factory=dict)
    """Values of swept parameters: of a sweep over several, the cases that are nearest to them."""
    x: str = "t"
    """The column that the columns `y` are drawn over."""
    y: Sequence[str] = ()
    log: str = ""
    """Which axes of chosen columns are logarithmic: x, y or xy."""
    range: Mapping[str, tuple[float | None, float | None]] = field(default_factory=dict)
    """The ends of the axes x and y of chosen columns, as they are shown."""

    def __post_init__(self) -> None:
        """Refuse what no figure can have, with a ValueError."""
        if isinstance(self.y, str):
            object.__setattr__(self, "y", tuple(self.y.split(",")))
        self.inches()
        if self.font_size is not None and not SMALLEST <= self.font_size <= 72:
            raise ValueError(f"letters have {SMALLEST} to 72 points, not {self.font_size:g}")
        if self.log not in ("", "x", "y", "xy"):
            raise ValueError(f"log axes are x, y or xy, not {self.log!r}")
        for axis, (low, high) in self.range.items():
            if axis not in ("x", "y"):
                raise ValueError(f"a range is of x or y, not of {axis!r}")
            if None not in (low, high) and not low < high:
                raise ValueError(f"the range of {axis} has to end above its begin")
        if (self.log or self.range) and not self.y:
            raise ValueError("log axes and ranges are of chosen columns: name them by y")
        letters = self.font_size or self.sheet().get("font.size", 0)
        least = letters / LETTERS * NARROWEST
        if self.inches() < least:
            least = math.ceil(least / CENTIMETRE)
            raise ValueError(f"letters of {letters:g} points need a width of {least} cm")
        if self.language not in LANGUAGES:
            raise ValueError(f"languages are {', '.join(LANGUAGES)}, not {self.language!r}")
        known = column_units().items()
        units = {each for (_, suffix), unit in known for each in (suffix, unit["unit"])}
        if unknown := set(self.unit.values()) - units:
            raise ValueError(f"{min(unknown)!r} is no unit of a column")
        if unknown := self.line.keys() - {"x", "y"}:
            raise ValueError(f"a line is at a value of x or y, not of {min(unknown)!r}")

    def inches(self) -> float:
        """The width in inches."""
        if self.width is None:
            return float(self.sheet().get("figure.figsize", (WIDTH,))[0])
        try:
            width = float(WIDTHS.get(self.width, self.width))
        except ValueError:
            known = ", ".join(WIDTHS)
            raise ValueError(f"a width is {known} or centimetres, not {self.width!r}") from None
        if not 6 <= width <= 100:
            raise ValueError(f"a width is 6 to 100 centimetres, not {self.width}")
        return width * CENTIMETRE

    def sheet(self) -> dict[str, Any]:
        """The settings of the style sheet; a ValueError if there is none of this name."""
        if self.style is None:
            return {}
        from matplotlib.style import library  # reads many files

        read, known = mpl.rc_params_from_file, library.get(str(self.style))
        try:
            return dict(known or read(self.style, use_default_template=False))
        except OSError as error:
            cause = (error.strerror or str(error)).lower()
            raise ValueError(f"there is no style sheet {self.style}: {cause}") from None
        except UnicodeDecodeError:
            raise ValueError(f"{self.style} is no style sheet") from None


DEFAULT = Options()
"""The look of all figures."""


def set_colours(sheet: Mapping[str, Any] = {}, dark: bool = False) -> None:
    """Have matplotlib know the roles, with the ground and the lines of a style sheet."""
    ground = sheet.get("figure.facecolor")
    is_dark = dark or (ground is not None and lightness(ground) < 0.5)
    colours = {role: pair[is_dark] for role, pair in ROLES.items()}
    if ground is not None and not dark:
        colours["ground"] = to_hex(ground)
    if cycle := sheet.get("axes.prop_cycle"):
        own = cycle.by_key().get("color", [])
        colours |= {
            f"line{number}": to_hex(colour) for number, colour in enumerate(own[:4], start=1)
        }
    names = get_named_colors_mapping()
    for role, colour in colours.items():
        names[OURS + role] = colour  # one by one, which forgets what was looked up before


set_colours()


@contextmanager
def the_look(options: Options = DEFAULT) -> Iterator[None]:
    """A context in which matplotlib has this look, a style sheet's in part, and LaTeX if it can."""
    sheet = options.sheet()
    letters = options.font_size or sheet.get("font.size")
    letters = letters or max(8.0, LETTERS * options.inches() / WIDTH)  # they shrink a little
    set_colours(sheet, options.dark)
    left_out = ("labelsize", "titlesize", "fontsize", *["color"] * options.dark)
    kept = {key: value for key, value in sheet.items() if not key.endswith(left_out)}
    most = SLIDE_HEIGHT if options.width == "slide" and options.font_size else math.inf
    page = {"font.size": letters, "figure.figsize": (options.inches(), most)}
    page["axes.titlesize"] = 0.95 * letters
    for key in ("lines.linewidth", "lines.markersize"):
        page[key] = (kept.get(key) or SETTINGS[key]) * letters / LETTERS
    if kept.get("text.usetex", mpl.rcParams["text.usetex"]):
        page["text.usetex"] = bool(shutil.which("latex") and shutil.which("dvipng"))
    asked = {COMMA: options.decimal_comma or options.language != "en"}
    asked |= {LANGUAGE: options.language, UNITS: options.unit}
    tokens = {variable: variable.set(value) for variable, value in asked.items()}
    try:
        with mpl.rc_context({**SETTINGS, **kept, **page}):
            yield
    finally:
        for variable, token in tokens.items():
            variable.reset(token)


def scale() -> float:
    """The size of letters over the usual one: inches of the paper for one of the usual letters."""
    return float(mpl.rcParams["font.size"]) / LETTERS


def drawn_size() -> tuple[float, float]:
    """The width of a figure and its most height in inches of the usual letters.

    A slide with letters of a given size has no more height. Outside of the look there is a page.
    """
    has_look = mpl.rcParams["svg.hashsalt"] == "spintop"
    width, most = mpl.rcParams["figure.figsize"] if has_look else (WIDTH * scale(), math.inf)
    return width / scale(), most / scale()


def by_width(wide: Any, narrow: Any) -> Any:
    """The first on a figure as wide as a page or on a slide, the second on a narrow column."""
    return wide if drawn_size()[0] > 5.0 or is_slide() else narrow


def is_slide() -> bool:
    """Whether the height of the page is given, too."""
    return drawn_size()[1] < math.inf


def lightness(colour: object) -> float:
    """How light a colour is in grey print, from 0 to 1."""
    red, green, blue = to_rgb(colour)
    return 0.299 * red + 0.587 * green + 0.114 * blue


def tint(colour: object, share: float) -> tuple[float, ...]:
    """A colour so much of the way to the ground."""
    pairs = zip(to_rgb(colour), to_rgb(GROUND), strict=True)
    return tuple(own + share * (ground - own) for own, ground in pairs)
