"""The motion of a film: computed by the program at the times of the pictures, and between them."""

import math
import os
import re
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from spintop_figures.moving.body import Body, draw_body, read_body
from spintop_figures.moving.motion import FORCE, OMEGA, QUATERNION
from spintop_figures.tables.table import Table, TableError, read_table

PROGRAM = os.environ.get("SPINTOP_EXE", "build/release/spintop")
BETWEEN = 8
"""Rows a picture: the path of the axis has so many pieces from one picture to the next, or more."""

FINE = 0.06
"""The axis turns by no more from row to row, rad, unless that takes too many rows."""

MOST_ROWS = 30_000
KIND = re.compile(r"^[^!\n]*\bkind\s*=\s*(['\"])(\w+)\1", re.MULTILINE | re.IGNORECASE)
"""The kind of study that an input names."""

COLUMNS = ("t", *QUATERNION, *OMEGA, *FORCE, "theta")


class FilmError(Exception):
    """Why there is no film, in a sentence; `code` is the exit code."""

    def __init__(self, message: str, code: int = 2) -> None:
        super().__init__(message)
        self.code = code


@dataclass(frozen=True)
class Take:
    """A motion: times (s), attitudes, axis of the body and vectors in space; and its body."""

    title: str
    body: Body
    solids: list[dict[str, object]]
    times: np.ndarray
    theta: np.ndarray
    rotations: np.ndarray
    axis: np.ndarray
    vectors: dict[str, np.ndarray]
    rows: np.ndarray
    """The row of each picture."""

    def steps(self) -> np.ndarray:
        """How far the axis turns from each row to the next, rad."""
        chords = np.linalg.norm(np.diff(self.axis, axis=0), axis=1)
        return 2 * np.arcsin(np.minimum(chords / 2, 1.0))


def compute(source: Path, pictures: int) -> Take:
    """The motion of an input, or of a table by the input in its header, for so many pictures."""
    with tempfile.TemporaryDirectory(prefix="film ") as name:
        folder = Path(name)
        file = source
        if source.suffix != ".nml":
            file = folder / f"{source.stem}.nml"
            file.write_text(input_of(source), encoding="utf-8")
        between, most = BETWEEN, max(BETWEEN, MOST_ROWS // pictures)
        take = take_of(run(file, folder, pictures, between), pictures)
        while take.steps().max(initial=0.0) > FINE and between < most:
            between = min(between * max(2, math.ceil(take.steps().max() / FINE)), most)
            take = take_of(run(file, folder, pictures, between), pictures)
    return take


def input_of(path: Path) -> str:
    """The resolved input in the header of a table."""
    try:
        table = read_table(path)
    except (TableError, OSError) as error:
        raise FilmError(str(error)) from error
    if table.kind != "trajectory":
        raise FilmError(f"{path}: this is no trajectory, which a film is made of")
    return table.input


def run(file: Path, folder: Path, pictures: int, between: int) -> Table:
    """Run the program on an input, with rows at the times of the pictures and between."""
    kind = KIND.search(file.read_text(encoding="utf-8", errors="replace"))
    if kind and kind[2].lower() != "trajectory":
        raise FilmError(f"{file}: this is no trajectory, which a film is made of")
    rows = (pictures - 1) * between + 1
    settings = (f"span.samples={rows}", f"output.columns={','.join(COLUMNS)}")
    command = [PROGRAM, "--quiet", "-o", str(folder)]
    for setting in (*settings, "output.format=csv"):
        command += ["--set", setting]
    command += ["--", str(file)]
    try:
        done = subprocess.run(command, check=False, capture_output=True, text=True)
    except OSError as error:
        raise FilmError(f"cannot run {PROGRAM}: {error.strerror}") from error
    table = folder / f"{file.stem}.csv"
    if not table.exists():
        raise FilmError(
            (done.stderr or done.stdout).strip() or f"{file}: no table was made",
            done.returncode or 2,
        )
    try:
        found = read_table(table)
    except TableError as error:
        raise FilmError(str(error)) from error
    if found.kind != "trajectory":
        raise FilmError(f"{file}: this is no trajectory, which a film is made of")
    return found


def take_of(table: Table, pictures: int) -> Take:
    """What is to be seen of a trajectory."""
    body = read_body(table)
    values = {name: table.rows[name].to_numpy(float) for name in COLUMNS if name in table.rows}
    good = np.all([np.isfinite(values[name]) for name in ("t", *QUATERNION)], axis=0)
    if body is None or good.sum() < 2:
        raise FilmError(f"{table.path.stem}: there is no motion to be filmed")
    values = {name: column[good] for name, column in values.items()}
    q = np.column_stack([values[name] for name in QUATERNION])
    rotations = matrices(q / np.linalg.norm(q, axis=1, keepdims=True))
    omega = np.column_stack([values[name] for name in OMEGA])
    vectors = {
        "momentum": np.einsum("nij,nj->ni", rotations, omega @ body.tensor()),
        "omega": np.einsum("nij,nj->ni", rotations, omega),
        "force": np.column_stack([values[name] for name in FORCE]),
    }
    times = values["t"]
    moments = np.linspace(times[0], times[-1], pictures)
    rows = np.clip(
        np.searchsorted(times, moments - 1e-9 * (times[-1] - times[0])), 0, len(times) - 1
    )
    return Take(
        table.title or table.path.stem,
        body,
        draw_body(table, body).solids,
        times,
        values["theta"],
        rotations,
        np.einsum("nij,j->ni", rotations, body.axis()),
        vectors,
        rows,
    )


def matrices(q: np.ndarray) -> np.ndarray:
    """The rotations of unit quaternions, body to space."""
    w, x, y, z = q.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)
