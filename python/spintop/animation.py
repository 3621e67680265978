"""The top in motion in a page: the viewer of a report, in a notebook or as a file."""

import html
import re
import subprocess
import tempfile
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from spintop_figures.tables.table import Table

LARGEST = 3_000_000
"""Bytes of the data in a page; longer motions have fewer rows there."""
PLACE = re.compile("@(TITLE|FACTS|ANCHOR|DATA|NAME|ROWS)@")


class Animation:
    """A page in which the top moves: a notebook shows it. It needs no other file and no network."""

    def __init__(self, page: str) -> None:
        """Take the text of a page."""
        self.page = page
        """The page, in HTML."""

    def save(self, path: str | Path) -> Path:
        """Write the page to a file, for a browser."""
        Path(path).write_text(self.page, encoding="utf-8")
        return Path(path)

    def _repr_html_(self) -> str:
        """The page as a frame of a notebook."""
        return (
            f'<iframe srcdoc="{html.escape(self.page)}" sandbox="allow-scripts allow-downloads" '
            f'style="width: 100%; height: 780px; border: 0" title="The top moving"></iframe>'
        )

    def __repr__(self) -> str:
        """What it is."""
        return f"<spintop.Animation: {len(self.page)} bytes of HTML; save it, or see a notebook>"


@cache
def viewer() -> str:
    """The viewer without a motion: that of the package, or made from the checkout."""
    package = Path(__file__).resolve().parent
    made = package / "viewer.html"
    if made.exists():
        return made.read_text(encoding="utf-8")
    report = package.parents[1] / "scripts" / "report"
    if not report.exists():
        raise FileNotFoundError(f"{made} is missing: the package was installed without a network")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "viewer.html"
        done = subprocess.run(
            [report, "--viewer", "-o", path], capture_output=True, text=True, check=False
        )
        if done.returncode:
            raise FileNotFoundError(f"the viewer cannot be made: {done.stderr.strip()}")
        return path.read_text(encoding="utf-8")


def animate(table: "Table | str | Path") -> Animation:
    """Show the motion of a table of a trajectory, from a file that the program wrote.

    It needs the columns `phi theta psi` or `q0` to `q3`; others are shown where they are there. A
    TypeError says why a table cannot be shown.
    """
    from spintop_figures.moving.motion import facts_text, pack_all, refusal
    from spintop_figures.tables.table import in_own_units, read_table

    if isinstance(table, str | Path):
        table = read_table(Path(table))
    table = in_own_units(table)
    if reason := refusal(table):
        raise TypeError(f"the motion cannot be shown: the table {reason}")
    (data,) = pack_all([table], LARGEST)
    words = {
        "TITLE": html.escape(table.title or table.path.stem),
        "FACTS": facts_text(table, data, "data"),
        "ANCHOR": "data",
        "DATA": data.address,
        "NAME": html.escape(data.name),
        "ROWS": data.which,
    }
    return Animation(PLACE.sub(lambda place: words[place[1]], viewer()))
