"""One table of spintop's rows and those of its peers, in the format of a work-precision study."""

import math
import os
from collections.abc import Iterable
from pathlib import Path

import pandas as pd

from peers.crew import Trial
from peers.problem import Problem
from peers.program import processor
from spintop_figures.tables.table import Table
from spintop_figures.tables.words import ended_well

OWN = "spintop"
"""What the column `program` calls itself."""
PROGRAM = "the program that was measured"
SHARED = ("inherent_error", "reference", "reference_error", "reference_check")
"""Columns that are the same in all rows of a problem."""
KEYS = ["program", "method", "formulation", "setting"]
"""What is measured in every round, of which the least time counts."""


def own_rows(table: Table, name: str) -> pd.DataFrame:
    """The rows of spintop's study of a problem."""
    return table.rows.assign(problem=name, program=OWN)


def row_of(trial: Trial, problem: Problem, own: pd.DataFrame) -> dict:
    """A trial of a peer as a row, with the columns of spintop's rows."""
    row = {name: math.nan if is_numeric(own[name]) else "-" for name in own}
    row |= {name: own[name].iloc[0] for name in SHARED if name in own}
    row |= {
        "problem": problem.name,
        "program": trial.program,
        "method": trial.method,
        "formulation": trial.formulation,
        "setting": trial.setting,
        "status": trial.status,
    }
    if trial.answer:
        q = trial.answer["quaternion"]
        row |= {name: value for name, value in trial.answer.items() if name in row}
        row["orientation_error"] = problem.orientation_error(q)
        row["tip_error"] = problem.tip_error(q)
    return row


def is_numeric(column: pd.Series) -> bool:
    """Whether a column holds numbers."""
    return pd.api.types.is_numeric_dtype(column)


def least(rounds: list[pd.DataFrame], keys: list[str] = KEYS) -> pd.DataFrame:
    """Each setting of each method and program once, with the least time of all rounds."""
    rows = pd.concat([rows for rows in rounds if len(rows)], ignore_index=True)
    rows = rows.sort_values("time_s", kind="stable", na_position="last", ignore_index=True)
    return rows.drop_duplicates(keys, ignore_index=True)


def join(parts: list[pd.DataFrame]) -> pd.DataFrame:
    """All rows, those of a problem by time, with the front among all programs."""
    rows = pd.concat(parts, ignore_index=True)
    for name in rows:
        if not is_numeric(rows[name]):
            rows[name] = rows[name].fillna("-")
    rows["front"] = "no"
    for _, group in rows.groupby("problem", sort=False):
        rows.loc[front(group).index, "front"] = "yes"
        rows.loc[group.index[group["method"] == "exact"], "front"] = "yes"
    order = {name: place for place, name in enumerate(dict.fromkeys(rows["problem"]))}
    return rows.sort_values(
        ["problem", "time_s"], key=lambda keys: keys.map(order) if keys.name == "problem" else keys,
        kind="stable", ignore_index=True,
    )  # fmt: skip


def front(rows: pd.DataFrame) -> pd.DataFrame:
    """Those that step and are both cheaper and more exact than no other, by time."""
    good = rows[ended_well(rows) & (rows["method"] != "exact")]
    good = good.sort_values(["time_s", "orientation_error"])
    best = good["orientation_error"].cummin().shift(fill_value=math.inf)
    return good[good["orientation_error"] < best]


def write(path: Path, rows: pd.DataFrame, own: Table, versions: dict[str, str], title: str) -> None:
    """Write the table with a header that scripts/plot reads."""
    keys = ("program", "format", "revision", "compiler", "options", "date")
    header = {"title": title} | {key: own.header[key] for key in keys if key in own.header}
    lines = ["input:", "    &study", "        kind = 'work_precision'"]
    lines += [f"        title = '{title}'", "    /", "columns:"]
    meanings = own.meanings | {"program": PROGRAM}
    for name in rows:
        unit = f" [{own.units[name]}]" if own.units.get(name) else ""
        lines.append(f"    {name}{unit}: {meanings.get(name, '')}")
    write_table(path, header, versions, lines, rows, na_rep="nan", float_format="%.17g")


def write_table(
    path: Path,
    header: dict[str, str],
    versions: dict[str, str],
    lines: Iterable[str],
    rows: pd.DataFrame,
    **form: str,
) -> None:
    """Write a table below what was measured where; a complete one alone has its name."""
    header = header | {"processor": processor()}
    header |= {f"peer {name}": text for name, text in versions.items()}
    part = path.with_name(path.name + ".part")
    with part.open("w", encoding="utf-8") as file:
        told = (f"{key}: {text}" for key, text in header.items())
        file.writelines(f"# {line}\n" for line in (*told, *lines))
        rows.to_csv(file, index=False, **form)
    os.replace(part, path)
