"""Kinds of figures. A figure is a function with a line that says to which tables it belongs."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from typing import NamedTuple

from matplotlib.figure import Figure

from spintop_figures.moving.assumptions import Assumption, broken
from spintop_figures.style import look
from spintop_figures.style.page import finish, is_crowded
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
    together: bool = False
    """Whether it is drawn of several tables."""

    def draw(self, tables: Table | Sequence[Table], options: look.Options = look.DEFAULT) -> Figure:
        """Draw the figure of a table, or of all tables that are compared, in the look of all.

        Where it would be too high for a slide, letters are smaller, so that its panels are wider;
        letters of a given size stay, and the panels are lower.
        """
        tables, asked, lack = as_list(tables), options.font_size, "does not fit on a slide"
        figure = self.draw_once(tables, options)
        if options.width == "slide" and asked and is_crowded(figure):
            lack += f" with letters of {asked:g} points; without --font-size they are as large as"
            raise TableError(f"{lack} fits: no {self.name} figure")
        most = look.SLIDE_HEIGHT if options.width == "slide" and not asked else math.inf
        while figure.get_size_inches()[1] > most:
            with look.the_look(figure.options):
                letters = look.LETTERS * look.scale() * 0.93
            if letters < look.SMALLEST:
                raise TableError(f"{lack}: no {self.name} figure")
            # as wide in centimetres, which leave the height free
            smaller = replace(options, width=look.WIDTHS["slide"], font_size=letters)
            figure = self.draw_once(tables, smaller)
        return figure

    def draw_once(self, tables: Sequence[Table], options: look.Options) -> Figure:
        """Draw it, however high it is."""
        given = [in_own_units(table, self.columns) for table in tables]
        for key in filter(None, options.unit):
            if not any(key in name for table in given for name in table.rows):
                raise TableError(f"has no column {key}, for its unit: no {self.name} figure")
        with look.the_look(options):
            try:
                figure = self.make(given if self.together else given[0])
            except TableError as error:
                raise TableError(f"{error}: no {self.name} figure") from None
            return finish(figure, options, given)

    def refusal(self, table: Table, has_cells: bool = True) -> str:
        """Why the figure does not belong to a table; empty if it does.

        It is an error if it does but for the cells of its columns, which hold nothing.
        """
        table = in_own_units(table, self.columns)
        if self.kind and table.kind != self.kind:
            return f"is no table of the kind {self.kind}"
        if missing := table.missing(self.words + self.columns):
            return f"has no column {', '.join(missing)}"
        wordless = [name for name in self.words if has_cells and not table.has_words(name)]
        if wordless:
            return f"has no word in column {', '.join(wordless)}"
        empty = table.empty(self.columns) if has_cells else []
        if empty and not (self.sparse and len(empty) < len(self.columns)):
            return f"has no number in column {', '.join(empty)}"
        return broken(self.assumes, table) or self.objection(table)


def as_list(tables: Table | Sequence[Table]) -> list[Table]:
    """Several tables, or one."""
    return [tables] if isinstance(tables, Table) else list(tables)


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
        known = {"objection": objection, "words": tuple(words.split()), "together": together}
        known = FigureKind(*named, kind, tuple(needs.split()), make, **known | asks)
        (COMPARISONS if together else FIGURES).append(known)
        return make

    return register
