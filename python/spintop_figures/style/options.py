"""What a user asks of a figure: its size, letters, title and colours, or columns of choice."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import matplotlib as mpl

CENTIMETRE = 1 / 2.54
"""In inches."""

WIDTHS = {"column": 8.5, "page": 18.3, "slide": 25.4}
"""Widths of figures by their names, in centimetres: of a column and a page of print, of a slide."""

NARROWEST, WIDEST = 6.0, 100.0
"""In centimetres."""

LETTERS = 10.0
"""Size of the letters of a page, in points."""

LEAST_LETTERS = 8.0
"""Of narrow figures: what is smaller than letters is still at least SMALLEST."""

SMALLEST = 6.5
"""No letter is smaller, in points, unless the figure has the size that it wants itself."""


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
        if self.width is not None:
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
        self.sheet()

    def inches(self) -> float:
        """The width in inches."""
        width = WIDTHS.get(self.width, self.width)
        try:
            width = float(width)
        except ValueError:
            known = ", ".join(WIDTHS)
            raise ValueError(f"a width is {known} or centimetres, not {self.width!r}") from None
        if not NARROWEST <= width <= WIDEST:
            raise ValueError(
                f"a width is {NARROWEST:g} to {WIDEST:g} centimetres, not {self.width}"
            )
        return width * CENTIMETRE

    def sheet(self) -> dict[str, object]:
        """The settings of the style sheet; a ValueError if there is none of this name."""
        if self.style is None:
            return {}
        from matplotlib.style import library  # reads many files

        if str(self.style) in library:
            return dict(library[str(self.style)])
        try:
            return dict(mpl.rc_params_from_file(self.style, use_default_template=False))
        except OSError as error:
            cause = (error.strerror or str(error)).lower()
            raise ValueError(f"there is no style sheet {self.style}: {cause}") from None
        except UnicodeDecodeError:
            raise ValueError(f"{self.style} is no style sheet") from None


DEFAULT = Options()
"""The look of all figures."""
