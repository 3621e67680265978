"""The errata of the paper, and which of them concern a table.

They stand in doc/errata.md, a section each, which ends with what it concerns.
"""

import re
from dataclasses import dataclass
from pathlib import Path

from reporting.paper import numbers_named, runs_of
from spintop_figures.tables.table import Table

ERRATA = Path(__file__).resolve().parent.parent.parent / "doc" / "errata.md"
SECTION = re.compile(r"^## (.+)$", re.MULTILINE)
CONCERNS = re.compile(r"^Concerns: (.+?)\.$", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Erratum:
    """What is wrong in the paper: where, what is right, and what it concerns."""

    heading: str
    paragraphs: tuple[str, ...]
    concerns: tuple[frozenset[str], ...]
    """It concerns what has all topics of one of these."""


def read_errata(path: Path = ERRATA) -> list[Erratum]:
    """All errata, in the order of the file."""
    text = path.read_text(encoding="utf-8")
    _, *pieces = SECTION.split(text)
    errata = []
    for heading, body in zip(pieces[::2], pieces[1::2], strict=True):
        concerns = CONCERNS.search(body)
        if not concerns:
            raise ValueError(f"{path}: the section {heading!r} does not say what it concerns")
        words = [" ".join(word.split()) for word in concerns[1].split(",")]
        choices = tuple(frozenset(word.split(" with ")) for word in words)
        paragraphs = CONCERNS.sub("", body).strip().split("\n\n")
        errata.append(
            Erratum(
                heading.strip(),
                tuple(" ".join(paragraph.split()) for paragraph in paragraphs),
                choices,
            )
        )
    return errata


def topics_of(table: Table) -> set[str]:
    """What a table is about, in the words of the errata.

    The hard cases that it names; and of a run of the paper, its example, figure or table there, its
    kind, formulation and method, its columns, and the equations that these name.
    """
    topics = words_in(table, "case")
    runs = runs_of(table)
    if not runs:
        return topics
    topics |= runs | {table.kind, table.setting("top.shape"), *table.axes()}
    topics |= {table.setting(f"integration.{key}") for key in ("formulation", "method")}
    topics |= set(table.model_and_method)
    topics |= words_in(table, "method") | words_in(table, "formulation")
    for text in table.meanings.values():
        topics |= {name for name in numbers_named(text) if name.startswith("Eq ")}
    topics |= {f"column {name}" for name in table.rows}
    return topics - {""}


def words_in(table: Table, column: str) -> set[str]:
    """The words of a categorical column; none of a column of numbers."""
    if column not in table.rows or table.numeric(column):
        return set()
    return {str(word) for word in table.rows[column].unique()}


def errata_for(table: Table, errata: list[Erratum]) -> list[Erratum]:
    """Those errata that concern a table."""
    topics = topics_of(table)
    return [erratum for erratum in errata if any(c <= topics for c in erratum.concerns)]
