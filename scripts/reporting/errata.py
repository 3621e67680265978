"""The errata of the paper, and which of them concern a table.

They stand in doc/errata.md, a section each, which ends with what it concerns.
"""

import re
from dataclasses import dataclass
from pathlib import Path

from figures.registry import FIGURES
from figures.table import Table, is_word
from reporting.body import read_body

ERRATA = Path(__file__).resolve().parent.parent.parent / "doc" / "errata.md"
SECTION = re.compile(r"^## (.+)$", re.MULTILINE)
CONCERNS = re.compile(r"^Concerns: (.+?)\.$", re.MULTILINE | re.DOTALL)
NUMBERED = re.compile(r"\b(Example|Figure|Eq|Table)s? (\d+\w?)(?:(?: to |-)(\d+))?")

EXAMPLE_1 = {"inertia": (0.875, 0.875, 0.25)}
EXAMPLE_2 = {"mass": (2.450442269800039,)}


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

    Its kind, formulation, method and shape; the examples of the paper; and what its title, its
    columns and its figures name: figures, tables and equations of the paper.
    """
    topics = {table.kind, *table.axes()}
    topics |= {table.setting(f"integration.{key}") for key in ("formulation", "method")}
    topics.add(table.setting("top.shape"))
    for key in ("model", "method"):
        topics.add(table.header.get(key, "").split(":")[0])
    for column in ("method", "formulation", "case"):
        if column in table.rows and not table.numeric(column):
            topics |= {str(word) for word in table.rows[column].unique()}
    texts = [table.title, *table.meanings.values()]
    texts += [kind.what for kind in FIGURES if not kind.refusal(table)]
    for text in texts:
        topics |= numbers_named(text)
    topics |= {f"column {name}" for name in table.rows}
    topics |= examples_of(table)
    return topics - {""}


def examples_of(table: Table) -> set[str]:
    """The examples of the paper whose body the table is of."""
    examples = set()
    if body := read_body(table):
        inertia, mass = tuple(body.inertia), (body.mass,)
    else:
        inertia, mass = (
            tuple(float(x) for x in table.settings.get(f"top.{key}", []) if not is_word(x))
            for key in ("inertia", "mass")
        )
    if inertia == EXAMPLE_1["inertia"]:
        examples.add("Example 1")
    if mass == EXAMPLE_2["mass"] or table.setting("top.shape") == "spinning_wheel":
        examples.add("Example 2")
    return examples


def numbers_named(text: str) -> set[str]:
    """`Figure 2`, `Figure 3`, ... of a text that names `Figures 2 to 3`; so of equations."""
    found = set()
    for kind, first, last in NUMBERED.findall(text):
        if last:
            found |= {f"{kind} {i}" for i in range(int(first), int(last) + 1)}
        else:
            found.add(f"{kind} {first}")
    return found


def errata_for(table: Table, errata: list[Erratum]) -> list[Erratum]:
    """Those errata that concern a table."""
    topics = topics_of(table)
    return [erratum for erratum in errata if any(c <= topics for c in erratum.concerns)]
