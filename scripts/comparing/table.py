"""The table of all measurements, in the format of a work-precision study, and its summaries."""

import math
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd

from comparing import bodies
from comparing.crew import Trial
from comparing.problem import MOTIONS, Problem
from program import as_table, processor
from spintop_figures.tables.names import ended_well
from spintop_figures.tables.table import Table

OWN = "spintop"
"""What the column `program` calls itself."""
SHARED = ("inherent_error", "reference", "reference_error", "reference_check")
"""Columns that are the same in all rows of a problem."""
MEASURED = ("time_s", "orientation_error", "energy", "momentum", "steps", "rejected", "evaluations")
KEYS = ["problem", "program", "method", "formulation", "setting"]
"""What is measured in every round, of which the least time counts."""
ERRORS = tuple(float(f"1e-{digits}") for digits in range(3, 13))
NONE = "\N{EN DASH}"
"""In place of a number that is not there."""
NAMES = [motion.name for motion in MOTIONS]
BOX, TOP = NAMES[1], NAMES[5]
COMPARED = 1000
"""Steps per second of the errors of engines."""
LOST, CLEAR, GOAL = 1.0, 5.0, 1e-3
"""An error above the first, rad, has no order, nor one that is not so many times above the least;
the cost is that of the last."""
WORDS = {"most": "99 % of errors", "largest": "all errors"}
TARGETS = ((7.0, "most", 1e-8), (7.0, "most", 1e-10), (4.0, "largest", 1e-10))
"""Of many bodies: to which time, and at which errors programs are compared."""


def row_of(trial: Trial, problem: Problem, own: pd.DataFrame) -> dict:
    """A trial as a row beside those of spintop."""
    of_steps = trial.setting >= 1
    found = trial.answer | problem.judge(trial.answer.get("states", ()))
    return (
        {name: own[name].iloc[0] for name in SHARED if name in own}
        | {
            "problem": problem.name,
            "program": trial.program,
            "method": trial.method,
            "formulation": trial.formulation,
            "setting": f"steps {trial.setting:g}" if of_steps else f"tolerance {trial.setting:.0e}",
            "rate": trial.setting if of_steps else math.nan,
            "status": trial.status,
        }
        | {name: found[name] for name in MEASURED if found.get(name) is not None}
    )


def least(rounds: list[pd.DataFrame]) -> pd.DataFrame:
    """Each setting of each method and program once, by time, with the least of all rounds."""
    rows = pd.concat([rows for rows in rounds if len(rows)], ignore_index=True)
    rows = rows.sort_values("time_s", kind="stable", na_position="last", ignore_index=True)
    return rows.drop_duplicates(KEYS, ignore_index=True)


def join(parts: list[pd.DataFrame]) -> pd.DataFrame:
    """The rows of all problems, without the front of spintop alone."""
    rows = pd.concat(parts, ignore_index=True).drop(columns="front", errors="ignore")
    words = rows.select_dtypes(exclude="number").columns
    return rows.fillna(dict.fromkeys(words, "-"))


def write(path: Path, rows: pd.DataFrame, own: Table, versions: dict[str, str], title: str) -> None:
    """Write the table with a header that scripts/plot reads; a complete one alone has its name."""
    keys = ("program", "format", "revision", "compiler", "options", "date")
    header = {"title": title} | {key: own.header[key] for key in keys if key in own.header}
    header |= {"processor": processor()}
    header |= {f"peer {name}": text for name, text in versions.items()}
    lines = [*(f"{key}: {text}" for key, text in header.items()), "input:", "    &study"]
    meanings = own.meanings | {"program": "the program that was measured"}
    lines += ["        kind = 'work_precision'", f"        title = '{title}'", "    /", "columns:"]
    for name in rows:
        unit = f" [{own.units[name]}]" if own.units.get(name) else ""
        lines.append(f"    {name}{unit}: {meanings.get(name, '')}")
    part = path.with_name(path.name + ".part")
    with part.open("w", encoding="utf-8") as file:
        file.writelines(f"# {line}\n" for line in lines)
        rows.to_csv(file, index=False, na_rep="nan", float_format="%.17g")
    os.replace(part, path)


def cheapest(rows: pd.DataFrame, error: float) -> pd.Series | None:
    """The fastest row whose attitude is good enough."""
    good = rows[ended_well(rows) & (rows["orientation_error"] <= error)]
    return None if good.empty else good.loc[good["time_s"].idxmin()]


def as_time(seconds: float) -> str:
    """A time with three digits and a unit."""
    for unit, size in (("us", 1e-6), ("ms", 1e-3), ("s", 1.0)):
        if seconds < 999.5 * size or unit == "s":
            break
    return f"{seconds / size:#.3g}".rstrip(".") + f" {unit}"


def cell_of(row: pd.Series | None) -> str:
    """A time and the method that takes it."""
    return NONE if row is None else f"{as_time(row['time_s'])} {row['method']}/{row['formulation']}"


def ratio(other: pd.Series | None, own: pd.Series | None) -> str:
    """How many times the one takes as long as the other, to two digits."""
    if other is None or own is None:
        return NONE
    factor = float(f"{other['time_s'] / own['time_s']:.2g}")
    return f"{factor:g}" if factor < 10 else f"{factor:.0f}"


def tell_solvers(rows: pd.DataFrame) -> str:
    """Of each problem: who is cheapest, by what factor each is dearer; and a table of all."""
    texts, every = [], [[f"{error:.0e}" for error in ERRORS]]
    for name, group in rows.groupby("problem", sort=False):
        is_own, is_exact = group["program"] == OWN, group["method"] == "exact"
        own = [cheapest(group[is_own & ~is_exact], error) for error in ERRORS]
        others = [cheapest(group[~is_own], error) for error in ERRORS]
        lines = [["spintop, closed form", *(cheapest(group[is_exact], error) for error in ERRORS)]]
        lines += [["spintop, numerical", *own], ["cheapest other", *others]]
        lines = [[line[0], *map(cell_of, line[1:])] for line in lines]
        for program, mine in group[~is_own].groupby("program", sort=False):
            best = (cheapest(mine, error) for error in ERRORS)
            lines.append([f"{program}, relative to that", *map(ratio, best, own)])
        texts.append(f"{name}\n\n{as_table([name, *every[0]], lines)}")
        every.append([
            NONE if mine is None else f"{as_time(mine['time_s'])}, {ratio(other, mine)}"
            for mine, other in zip(own, others, strict=True)
        ])  # fmt: skip
    texts.append(as_table(["error, rad", *rows["problem"].unique()], zip(*every, strict=True)))
    return "\n\n".join(texts)


def order(rows: pd.DataFrame) -> float:
    """The median of the slopes of the error against the step size, where these show an order."""
    rows = rows[rows["rate"].notna() & ended_well(rows)].sort_values("rate")
    steps, values = rows["rate"].to_numpy(float), rows["orientation_error"].to_numpy(float)
    good = [
        math.log(values[i] / values[i + 1]) / math.log(steps[i + 1] / steps[i])
        for i in range(len(rows) - 1)
        if LOST > values[i] > 0 and values[i + 1] > CLEAR * max(values.min(), 1e-15)
    ]
    return float(np.median(good)) if good else math.nan


def compared(rows: pd.DataFrame, motion: str) -> pd.Series | None:
    """The run at the compared step size, or at the next larger one that there is.

    Of a method without step sizes, that of the smallest error.
    """
    rows = rows[(rows["problem"] == motion) & (rows["status"] != "refused")]
    if rows["rate"].notna().any():
        rows = rows[rows["rate"] <= COMPARED]
        return rows.loc[rows["rate"].idxmax()]
    rows = rows[rows["orientation_error"].notna()]
    return rows.loc[rows["orientation_error"].idxmin()] if len(rows) else None


def as_error(row: pd.Series | None) -> str:
    """An error, with the steps per second if these are fewer; a large one is only said to be so."""
    if row is None:
        return NONE
    error = row["orientation_error"]
    text = f"{error:.1e}" if error < LOST else "lost"
    return f"{text} ({row['rate']:.0f})" if row["rate"] < COMPARED else text


def cell(value: float, form: str = ".1e") -> str:
    """A number, or a dash for what is not there."""
    return f"{value:{form}}" if math.isfinite(value) else NONE


def tell_engines(rows: pd.DataFrame) -> str:
    """Errors of the engines at one step size; order, drifts and cost."""
    methods = list(rows.groupby(["program", "method"], sort=False))
    first, second = [], []
    for who, group in methods:
        first.append([*who, *(as_error(compared(group, name)) for name in NAMES)])
        box, row = group[group["problem"] == BOX], compared(group, BOX)
        if row is None:
            second.append([*who, *[NONE] * 6])
            continue
        costs = []
        for motion in (MOTIONS[1], MOTIONS[5]):
            best = cheapest(group[group["problem"] == motion.name], GOAL)
            costs.append(math.inf if best is None else best["time_s"] / motion.t_end)
        per_step = row["time_s"] / (row["rate"] * MOTIONS[1].t_end) * 1e6
        second.append([*who, cell(order(box), ".1f"), cell(row["energy"]), cell(row["momentum"]),
                       cell(per_step, ".3g"), *map(cell, costs)])  # fmt: skip
    header = ["engine", "method", "order", "energy", "momentum", "us per step"]
    header += [f"cost of 1e-3 rad, `{BOX}`", f"`{TOP}`"]
    names = ["engine", "method", *(f"`{name}`" for name in NAMES)]
    return f"{as_table(names, first)}\n\n{as_table(header, second)}"


def tell_bodies(rows: pd.DataFrame) -> str:
    """Every setting of many bodies, and at each error the fastest setting of each program."""
    rate, lines = bodies.CASES / rows["time_s"], []
    rows = rows.assign(rate=rate).sort_values(["program", "problem", "setting"])
    names = ["program", "method", "problem", "setting"]
    errors = ["median", "most", "largest"]
    every = [
        [*(str(row[name]) for name in names), f"{row['rate']:.3g}",
         *(cell(row[name]) for name in errors)]
        for _, row in rows.iterrows()
    ]  # fmt: skip
    programs = [OWN, *(name for name in rows["program"].unique() if name != OWN)]
    for t_end, which, error in TARGETS:
        good = rows[(rows["problem"] == bodies_to(t_end)) & (rows[which] <= error)]
        rates = good.groupby("program")["rate"].max().reindex(programs)
        lines.append([
            f"to {t_end:g} s, {WORDS[which]} below {error:.0e} rad",
            *(cell(float(f"{rate:.3g}"), ",.0f") for rate in rates),
            cell(rates[OWN] / rates.drop(OWN).max(), ".2f"),
        ])  # fmt: skip
    header = [*names, "cases/s per thread", "median error, rad", "99 %", "largest"]
    last = ["cases per second", *programs, "ratio to the best other"]
    return f"{as_table(header, every)}\n\n{as_table(last, lines)}"


def bodies_to(t_end: float) -> str:
    """The name of the problem of many bodies to a time."""
    return f"bodies to {t_end:g} s"


TELL: dict[str, Callable[[pd.DataFrame], str]] = {
    "peers": tell_solvers, "engines": tell_engines, "bodies": tell_bodies,
}  # fmt: skip
"""The summary of each kind of comparison, which has its name from the file of the table."""
