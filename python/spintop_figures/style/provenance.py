"""Where a figure comes from, in words: title, run and program of its tables."""

from collections.abc import Sequence

from spintop_figures.style.numbers import write, write_count
from spintop_figures.tables.names import name_of
from spintop_figures.tables.table import Table, printable
from spintop_figures.tables.words import is_good_end


def provenance_of(tables: Sequence[Table]) -> dict[str, str]:
    """The title, the run, the program and the files of tables, each once, for metadata.

    A run is how a table was computed, and how that ended if not well.
    """
    runs = (joined((describe_run(table), warning_of(table))) for table in tables)
    return {
        "Title": joined(table.title for table in tables),
        "Description": joined(run[0].upper() + run[1:] for run in runs),
        "Software": joined(
            f"{table.header['program']}, revision {table.header.get('revision', 'unknown')}"
            for table in tables
        ),
        "Source": joined(printable(table.path.name) for table in tables),
    }


def joined(texts: object) -> str:
    """Texts that are not empty, each once."""
    return "; ".join(dict.fromkeys(filter(None, texts)))


def caption_of(tables: Sequence[Table], letters: int) -> str:
    """The line below a figure: the title of its table, and what a reader has to know of the rows.

    It has so many letters at most. The title of a single table may be shortened for it.
    """
    known = joined(warning_of(table) for table in tables)
    titles = {table.title for table in tables}
    title = titles.pop() if len(titles) == 1 else ""  # panels of several have their titles
    room = letters - (len(known) + 2 if known else 0)
    if len(title) > room:
        title = title[: max(room - 1, 0)].rstrip() + "\N{HORIZONTAL ELLIPSIS}"
    return "; ".join(filter(None, (title, known)))


def warning_of(table: Table) -> str:
    """How a run ended if not well, and whether only some cases are drawn; empty if all is well."""
    words = []
    if table.status is not None and not is_good_end(table.status):
        words.append(f"ended early: {describe_end(table.status)}")
    if table.stride > 1:
        words.append(f"one case in {write_count(table.stride)} is drawn")
    return "; ".join(words)


def describe_end(status: str) -> str:
    """How a motion ended, in words: `pole at t = 1.25` is at a pole at t = 1.25 s."""
    word, at, time = status.partition(" at t = ")
    try:
        return f"{name_of(word)}{at}{write(float(time), 6)} s" if at else name_of(word)
    except ValueError:
        return status


def describe_run(table: Table) -> str:
    """Formulation, method, and steps or tolerances, in words."""
    if "setting" in table.rows:
        return "methods, formulations and settings as named"
    if "method" in table.rows:
        return ", ".join(["methods and formulations as named", *describe_tolerances(table)])
    formulation, method = model_of(table)
    if method == "exact":
        return "exact solution"
    words = [name_of(formulation), name_of(table.setting("integration.table") or method)]
    if steps := table.setting("integration.steps"):
        words.append(f"{write_count(float(steps))} steps")
    elif step := table.setting("integration.step"):
        words.append(f"steps of {step} s")
    else:
        words += describe_tolerances(table)
    return ", ".join(words)


def model_of(table: Table) -> tuple[str, str]:
    """The formulation and the method of a run: those of the input, or what `auto` became."""
    given = table.setting("integration.formulation"), table.setting("integration.method")
    if given[1] == "exact" or "auto" not in given:
        return given
    return table.model_and_method


def describe_tolerances(table: Table) -> list[str]:
    """The tolerances that the input gives."""
    given = [
        f"{kind} tolerance {write(float(value))}"
        for kind in ("relative", "absolute")
        if (value := table.setting(f"integration.{kind}_tolerance"))
    ]
    return given or ["default tolerances"]
