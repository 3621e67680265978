"""Kinds of figures. A figure is a function with a line that says to which tables it belongs."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from typing import NamedTuple

from matplotlib.figure import Figure

from spintop_figures.moving.assumptions import Assumption, broken
from spintop_figures.style.look import (
    DEFAULT,
    LETTERS,
    SLIDE_HEIGHT,
    SMALLEST,
    Options,
    scale,
    the_look,
)
from spintop_figures.style.page import finish
from spintop_figures.tables.table import Table, TableError, in_own_units


class FigureKind(NamedTuple):
    """A figure: the study and the columns it is made of, and what else it asks of a table."""

    name: str
    what: str
    kind: str
    """Of the study; empty is any."""
    columns: tuple[str, ...]
    make: Callable[..., Figure]
    """Draws it from the table, or from all tables that are compared."""
    objection: Callable[[Table], str] = lambda table: ""
    """Why a table with these columns has no such figure; empty if it has."""
    sparse: bool = False
    """Whether some of the columns may have no numbers."""
    words: tuple[str, ...] = ()
    """The categorical columns that it needs."""
    assumes: tuple[Assumption, ...] = ()
    """What holds for the scenes that it is true for."""

    def draw(self, tables: Table | Sequence[Table], options: Options = DEFAULT) -> Figure:
        """Draw the figure of a table, or of all tables that are compared, in the look of all.

        Letters are smaller where it would be too high for a slide, so that its panels are wider.
        """
        figure = self.draw_once(tables, options)
        while options.width == "slide" and figure.get_size_inches()[1] > SLIDE_HEIGHT:
            with the_look(figure.options):
                letters = LETTERS * scale() * 0.93
            if options.font_size or letters < SMALLEST:
                hint = " with such letters; without --font-size they are as large as fits"
                lack = f"does not fit on a slide{hint if options.font_size else ''}"
                raise TableError(f"{lack}: no {self.name} figure")
            figure = self.draw_once(tables, replace(options, font_size=letters))
        return figure

    def draw_once(self, tables: Table | Sequence[Table], options: Options) -> Figure:
        """Draw it, however high it is."""
        alone = isinstance(tables, Table)
        columns = {name for table in ([tables] if alone else tables) for name in table.rows}
        for key in filter(None, options.unit):
            if not any(key in name for name in columns):
                raise TableError(f"has no column {key}, for its unit: no {self.name} figure")
        with the_look(options):
            try:
                figure = self.make(in_own_units(tables) if alone else [*map(in_own_units, tables)])
            except TableError as error:
                raise TableError(f"{error}: no {self.name} figure") from None
            return finish(figure, options)

    def refusal(self, table: Table) -> str:
        """Why the figure does not belong to a table; empty if it does."""
        table = in_own_units(table)
        if self.kind and table.kind != self.kind:
            return f"is no table of the kind {self.kind}"
        if missing := table.missing(self.words + self.columns):
            return f"has no column {', '.join(missing)}"
        if wordless := [name for name in self.words if not table.has_words(name)]:
            return f"has no word in column {', '.join(wordless)}"
        empty = table.empty(self.columns)
        if empty and not (self.sparse and len(empty) < len(self.columns)):
            return f"has no number in column {', '.join(empty)}"
        return broken(self.assumes, table) or self.objection(table)

    def is_expected(self, table: Table) -> bool:
        """Whether the table has all columns, so that it is an error if they hold no number."""
        return (
            table.kind == self.kind
            and not table.missing(self.words + self.columns)
            and not (broken(self.assumes, table) or self.objection(table))
        )


def unknown(name: str, kinds: Sequence[FigureKind]) -> str:
    """What is wrong with the name of a figure that does not exist."""
    known = [kind.name for kind in kinds]
    near = get_close_matches(name, known, 1)
    hint = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(known)}"
    return f"there is no figure {name}; {hint}"


FIGURES: list[FigureKind] = []
COMPARISONS: list[FigureKind] = []
"""Figures of a table, and of several tables together, of each of which they ask the same."""


def figure(
    kind: str,
    needs: str = "",
    words: str = "",
    together: bool = False,
    unless: Mapping[str, Callable[[Table], object]] = {},
    **asks: object,
) -> Callable[[Callable], Callable]:
    """Register `draw_NAME` below as the figure NAME, which is what its docstring says.

    It belongs to tables of a kind of study with the columns of numbers that it `needs` and the
    columns of `words`. What it objects to, `unless` something holds, is said in order; `asks` are
    the other fields of FigureKind. A figure `together` is drawn of several tables.
    """

    def objection(table: Table) -> str:
        return next((reason for reason, holds in unless.items() if not holds(table)), "")

    def register(make: Callable) -> Callable:
        what = make.__doc__.partition("\n")[0].removesuffix(".")
        named = make.__name__.removeprefix("draw_"), what[0].lower() + what[1:]
        asks.setdefault("objection", objection)
        asked = kind, tuple(needs.split()), make
        known = FigureKind(*named, *asked, words=tuple(words.split()), **asks)
        (COMPARISONS if together else FIGURES).append(known)
        return make

    return register
