"""A motion as a file of other programs: a trajectory of evo, input of NAIF msopck, a glTF scene."""

import json
import math
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from spintop.library import InputError
from spintop.runs import find_column

if TYPE_CHECKING:
    from spintop_figures.tables.table import Table as FileTable

QUATERNION = ("q0", "q1", "q2", "q3")
OMEGA = ("omega1", "omega2", "omega3")
PLACE = ("com_x", "com_y", "com_z")


def export(motion: "Mapping[str, Any] | FileTable", path: str | Path, t: Any = None) -> Path:
    """Write a motion as the file that the ending of `path` names; returns the path.

    `motion` is a table, a motion or the result of a run with the columns q0 to q3, and `t` its
    times, s, if it has no column `t`. Times increase. Columns may have other units, as `t_ms` and
    `com_z_mm`. An InputError says what is missing or wrong.

    `.tum`: a trajectory for evo, `t x y z qx qy qz qw` per line, with the centre of mass (columns
    com_x, com_y, com_z) as the place, else the pivot.
    `.msopck`: input for NAIF msopck, `t q0 q1 q2 q3` per line, with INPUT_DATA_TYPE = 'SPICE
    QUATERNIONS' (space to body, scalar first) and INPUT_TIME_TYPE = 'ET'; behind them
    omega1 to omega3 if there are these columns, for ANGULAR_RATE_FRAME = 'INSTRUMENT'.
    `.glb`: a glTF 2.0 scene with the node `top` that moves: a cone whose tip is the pivot, with
    a stripe that shows the spin. It begins at the first row. Viewers turn the shorter way from row
    to row: the body turns by less than half a turn there, or, without omega1 to omega3, a quarter.
    """
    path = Path(path)
    writers = {".tum": tum, ".msopck": msopck, ".glb": glb}
    if path.suffix not in writers:
        raise InputError(f"{path.name}: the ending is one of {', '.join(writers)}", code=2)
    if not isinstance(motion, Mapping):
        motion = getattr(motion, "rows", motion)
    found = {"t": column(motion, "t", "s") if t is None else np.asarray(t, dtype=float)}
    for names, unit in ((QUATERNION, ""), (OMEGA, "rad/s"), (PLACE, "m")):
        there = {name: column(motion, name, unit) for name in names}
        if not unit or any(values is not None for values in there.values()):
            found |= there
    if missing := [name for name, values in found.items() if values is None]:
        raise InputError(f"an export needs the column {missing[0]}", code=2)
    times = found["t"]
    if times.ndim != 1 or any(values.shape != times.shape for values in found.values()):
        raise InputError("an export needs a number in each column for each time", code=2)
    if not times.size or not all(np.isfinite(values).all() for values in found.values()):
        raise InputError("an export needs rows, and finite numbers in them", code=2)
    refuse(np.diff(times) <= 0, "its time is not after that of the row before")
    refuse(sum(found[name] ** 2 for name in QUATERNION) == 0, "q0 to q3 are 0", 1)
    path.write_bytes(writers[path.suffix](times, found))
    return path


def column(motion: Mapping[str, Any], name: str, unit: str) -> np.ndarray | None:
    """A column in its own unit, which the motion may have in another one; None if it has none."""
    named, size = find_column(motion, name, unit)
    return size * np.asarray(motion[named], dtype=float) if named else None


def refuse(wrong: np.ndarray, what: str, first: int = 2) -> None:
    """Name the first row that is wrong, if one is; `first` is the number of the first element."""
    if wrong.any():
        raise InputError(f"row {int(np.argmax(wrong)) + first}: {what}", code=2)


def lines(*columns: Any) -> bytes:
    """Numbers with all their digits, a row per line."""
    rows = np.stack([np.broadcast_to(column, len(columns[0])) for column in columns], axis=1)
    return "".join(" ".join(map(repr, row)) + "\n" for row in rows.tolist()).encode()


def tum(times: np.ndarray, columns: Mapping[str, np.ndarray]) -> bytes:
    """A trajectory in the format of the TUM RGB-D benchmark."""
    w, x, y, z = (columns[name] for name in QUATERNION)
    place = [columns.get(name, 0.0) for name in PLACE]
    return lines(times, *place, x, y, z, w)


def msopck(times: np.ndarray, columns: Mapping[str, np.ndarray]) -> bytes:
    """Attitudes as SPICE has them: from the reference frame to that of the body."""
    w, x, y, z = (columns[name] for name in QUATERNION)
    omega = [columns[name] for name in OMEGA if name in columns]
    return lines(times, w, -x, -y, -z, *(omega if len(omega) == len(OMEGA) else []))


def cone(corners: int = 32) -> tuple[np.ndarray, np.ndarray]:
    """Corners and colours of an inverted cone of height 1, three per triangle.

    Its faces are flat, for which viewers find the normals.
    """
    turns = 2 * math.pi * np.arange(corners + 1) / corners
    rim = np.stack([np.cos(turns) / 2, np.sin(turns) / 2, np.ones(corners + 1)], axis=1)
    tip, top = np.zeros((corners, 3)), np.tile([0.0, 0.0, 1.0], (corners, 1))
    faces = (tip, rim[1:], rim[:-1]), (top, rim[:-1], rim[1:])  # the side and the lid
    triangles = np.concatenate([np.stack(each, axis=1) for each in faces])
    colours = np.tile([0.55, 0.65, 0.8, 1.0], (2 * corners, 1))
    colours[[0, corners]] = [0.8, 0.1, 0.1, 1.0]
    return triangles.reshape(-1, 3), np.repeat(colours, 3, 0)


def attitudes(times: np.ndarray, columns: Mapping[str, np.ndarray]) -> np.ndarray:
    """Quaternions of glTF, scalar last, between whose rows viewers turn the way that the body does.

    Rows between which the body may turn another way than the shortest are refused.
    """
    turns = np.stack([columns[name] for name in (*QUATERNION[1:], QUATERNION[0])], axis=1)
    turns = turns / np.linalg.norm(turns, axis=1, keepdims=True)
    along = np.sum(turns[1:] * turns[:-1], axis=1)
    turns[1:] *= np.cumprod(np.where(along < 0, -1, 1))[:, None]
    if all(name in columns for name in OMEGA):
        rate, known = np.sqrt(sum(columns[name] ** 2 for name in OMEGA)), ""
        far = np.diff(times) * np.maximum(rate[1:], rate[:-1]) >= math.pi
    else:
        far, known = np.abs(along) <= math.sqrt(0.5), ", or the columns omega1 to omega3"
    refuse(far, f"too far from the row before for the turn of the body: give more rows{known}")
    return turns


def glb(times: np.ndarray, columns: Mapping[str, np.ndarray]) -> bytes:
    """A scene of glTF 2.0 in one binary file."""
    turns, times = attitudes(times, columns), (times - times[0]).astype("<f4")
    refuse(np.diff(times) <= 0, "its time is that of the row before in single precision")
    kinds = ("VEC3", "VEC4", "SCALAR", "VEC4")
    blob, views, accessors = b"", [], []
    for number, (array, kind) in enumerate(zip((*cone(), times, turns), kinds, strict=True)):
        data = np.ascontiguousarray(array, dtype="<f4").reshape(len(array), -1)
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": data.nbytes})
        known = {"bufferView": number, "componentType": 5126, "count": len(data), "type": kind}
        ends = {"min": data.min(axis=0).tolist(), "max": data.max(axis=0).tolist()}
        accessors.append(known | ends)
        blob += data.tobytes()
    half = math.sqrt(0.5)
    motion = {
        "name": "motion",
        "samplers": [{"input": 2, "output": 3, "interpolation": "LINEAR"}],
        "channels": [{"sampler": 0, "target": {"node": 1, "path": "rotation"}}],
    }
    scene = {
        "asset": {"version": "2.0", "generator": "spintop"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [  # the vertical of glTF is y
            {"name": "space", "rotation": [-half, 0, 0, half], "children": [1]},
            {"name": "top", "mesh": 0, "rotation": turns[0].tolist()},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 1}}]}],
        "animations": [motion],
        "buffers": [{"byteLength": len(blob)}],
        "bufferViews": views,
        "accessors": accessors,
    }
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    size = 12 + 8 + len(text) + 8 + len(blob)
    head = struct.pack("<4sII", b"glTF", 2, size) + struct.pack("<I4s", len(text), b"JSON")
    return head + text + struct.pack("<I4s", len(blob), b"BIN\0") + blob
