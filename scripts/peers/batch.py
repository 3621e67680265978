"""Many bodies at once, by spintop in lanes and by peers in batches: cases per second at an error.

All programs take turns, round after round, so that a busy machine is as hard on one as on another.
What counts is the least time of each.
"""

import math
import re
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import pandas as pd

from peers import bodies
from peers.answer import HALF_DECADES
from peers.crew import LostError, Worker
from peers.program import as_table, call
from peers.result import OWN, least, write_table
from peers.summary import NONE

EVERY = 10
"""Every so many of the bodies is judged."""
ROUNDS, REPEATS = 3, 2
"""How often all take turns, and the runs of spintop in each."""
SECONDS = 200.0
"""For one peer with one setting, which includes its compilation."""


@dataclass(frozen=True)
class Span:
    """Bodies to a time, and at which errors programs are compared: which of `Errors`, and what."""

    name: str
    t_end: float
    targets: tuple[tuple[str, float], ...]


SPANS = (
    Span("bodies", 7.0, (("most", 1e-8), ("most", 1e-10))),
    Span("bodies_short", 4.0, (("largest", 1e-10),)),
)
WORDS = {"most": "99 % of errors", "largest": "all errors"}


def measure_batches(
    workers: list[Worker], every: int, folder: Path, say: Callable[[str], None]
) -> pd.DataFrame:
    """All rows: a program, its method, a tolerance, the errors and the least time of each."""
    able = [worker for worker in workers if hasattr(worker.peer, "BATCHES")]
    tolerances = HALF_DECADES[::every]
    rounds: list[pd.DataFrame] = []
    for span in SPANS:
        say(f"{span.name}: ends in quadruple precision")
        right = bodies.run_reference(folder, repr(span.t_end), EVERY)
        scene = bodies.write_scene(folder, "many_bodies", 1)
        for turn in range(1, ROUNDS + 1):
            say(f"{span.name}: round {turn} of {ROUNDS}")
            rounds += [
                pd.DataFrame(take_turns(able, scene, span, tolerance, right))
                for tolerance in tolerances
            ]
    rows = least(rounds, ["problem", "program", "method", "tolerance"])
    return rows.sort_values(["problem", "time_s"], ignore_index=True)


def take_turns(
    workers: list[Worker], scene: Path, span: Span, tolerance: float, right: list[list[float]]
) -> list[dict]:
    """Each program once with a tolerance."""
    runs = [bodies.run(scene, 1, repr(span.t_end), repr(tolerance)) for _ in range(REPEATS)]
    ends = list(map(bodies.quaternion_of, runs[0][0][::EVERY]))
    found = [(OWN, "lanes", ends, min(seconds for _, seconds in runs))]
    for worker in workers:
        for method in worker.peer.BATCHES:
            batch = {"t_end": span.t_end, "every": EVERY, "method": method, "setting": tolerance}
            try:
                answer = worker.ask({"batch": batch}, SECONDS)
            except LostError:
                continue
            if "failure" not in answer:
                found.append((worker.peer.NAME, method, answer["ends"], answer["time_s"]))
    return [
        {"problem": span.name, "program": program, "method": method, "tolerance": tolerance}
        | asdict(bodies.judge(ends, right))
        | {"time_s": seconds, "cases_per_s": bodies.CASES / seconds}
        for program, method, ends, seconds in found
    ]


def write_batches(path: Path, rows: pd.DataFrame, versions: dict[str, str]) -> None:
    """Write the table."""
    header = {"title": "Many bodies at once, by spintop and by other programs"}
    header |= {"program": call("--version").strip()}
    write_table(path, header, versions, (), rows, float_format="%.6g")


def summarise_batches(rows: pd.DataFrame) -> str:
    """A table in Markdown: at each error the fastest setting of each program."""
    others = [name for name in rows["program"].unique() if name != OWN]
    lines = []
    for span in SPANS:
        mine = rows[rows["problem"] == span.name]
        for which, error in span.targets:
            rates = {name: fastest(mine[mine["program"] == name], which, error)
                     for name in (OWN, *others)}  # fmt: skip
            best = max((rate for name, rate in rates.items() if name != OWN), default=math.nan)
            lines.append([
                f"to {span.t_end:g} s, {WORDS[which]} below {error:.0e} rad",
                *(as_rate(rate) for rate in rates.values()),
                f"{rates[OWN] / best:.2f}" if best > 0 else NONE,
            ])  # fmt: skip
    return as_table(["cases per second", OWN, *others, "ratio to the best other"], lines)


def fastest(rows: pd.DataFrame, which: str, error: float) -> float:
    """The most cases per second at an error; zero if it is not reached."""
    return rows.loc[rows[which] <= error, "cases_per_s"].max() if len(rows) else 0.0


def as_rate(rate: float) -> str:
    """A rate with three digits and commas."""
    if not rate > 0:
        return NONE
    return re.sub(r"\.0$", "", f"{float(f'{rate:.3g}'):,}")
