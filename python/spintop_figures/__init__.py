"""The figures of the tables of spintop, for scripts, notebooks and the report.

    from spintop_figures import draw, read_table, save_as

    table = read_table("output/slow_top.csv")
    figure = draw(table, "angles")  # a figure of matplotlib
    save_as(figure, "slow_top_angles")  # PNG and SVG

Folders: `tables` reads tables, `style` is what all figures share, `motion`, `sweeps` and `methods`
draw the figures of trajectories, of sweeps and of studies of methods. `registry` lists all figures.
Nothing here changes the settings of matplotlib beyond its own figures.
"""

import importlib

PLACES = {
    "tables.table": ("Table", "TableError", "read_table"),
    "registry": ("COMPARISONS", "FIGURES", "FigureKind", "choose_figures", "draw"),
    "style.page": ("save", "save_as"),
}
"""The public names by the modules that have them, which are loaded when they are asked for."""

__all__ = sorted(name for names in PLACES.values() for name in names)


def __getattr__(name: str) -> object:
    """A public name, from its module."""
    for module, names in PLACES.items():
        if name in names:
            return getattr(importlib.import_module(f"{__name__}.{module}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
