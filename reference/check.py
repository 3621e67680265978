"""Compare the trajectory of an engine with a reference motion of spintop. It needs numpy only.

    from check import check, order
    print(check(times, quaternions, omega, motion="slow_top"))

Conventions of the set: quaternions have the scalar first and turn body axes into space axes,
angular velocities are in body axes, space z is up. Those of the engine are found, or named.
Public domain (CC0-1.0).
"""

import json
import zlib
from itertools import product
from pathlib import Path

import numpy as np

MOTIONS = Path(__file__).resolve().parent / "motions"
SCALARS, DIRECTIONS = ("first", "last"), ("body to space", "space to body")
FRAMES, SIGNS = ("body", "space"), ("plus", "minus")


class Report(dict):
    """What was found, by name; as text a line for each number and word."""

    def __str__(self):
        return "\n".join(
            f"{name:18} {value if isinstance(value, str) else format(value, '.2g')}"
            for name, value in self.items()
            if np.ndim(value) == 0
        )


def read(motion):
    """The data of a motion, and its columns by name: `motion` is a name or a path of a JSON."""
    path = Path(motion) if str(motion).endswith(".json") else MOTIONS / f"{motion}.json"
    data = json.loads(path.read_text(encoding="utf-8"))
    text = path.with_suffix(".csv").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    body, end = text[text.index(lines[0]) :].split("# end:")
    if int(end.split()[-1], 16) != zlib.crc32(body.encode()):
        raise ValueError(f"{path.stem}.csv was changed: its checksum is not that of its last line")
    cells = np.array([line.split(",") for line in lines[1:]], dtype=float)
    return data, dict(zip(lines[0].split(","), cells.T, strict=True))


def check(
    times, quaternions, omega=None, *, motion, scalar=None, direction=None, frame=None, sign=None
):
    """Compare a trajectory with a motion; returns a Report, a dictionary.

    `times` (n), s; `quaternions` (n, 4); `omega` (n, 3), rad/s, or None; `motion` is a name or a
    path. Times that the reference does not have are left out; a ValueError says that fewer than
    two are common. The conventions of the trajectory are those that fit best, or as named:
    `scalar` "first" or "last", `direction` "body to space" or "space to body", of omega `frame`
    "body" or "space" and `sign` "plus" or "minus". Arrays of the report at the common times `t`:
    `attitude_errors` (angle of the rotation from the reference, rad), `omega_errors` (rad/s);
    numbers: the largest of both, and the largest change of energy (over the kinetic energy at the
    start plus m g |r|) and of momentum (over the largest) against the reference;
    `attitude_floor`: what no program in double precision can be asked for, the error of the
    reference plus that by rounding of the data.
    """
    data, columns = read(motion)
    times, quaternions = np.asarray(times, float), np.asarray(quaternions, float)
    if quaternions.shape != (*times.shape, 4) or times.ndim != 1:
        raise ValueError("`quaternions` must have a row of four numbers for each time")
    rows, mine = common(columns["t"], times)
    reference = np.stack([columns[f"q{i}"] for i in range(4)], 1)[rows]
    best = None
    for names in product(given(scalar, SCALARS), given(direction, DIRECTIONS)):
        found = converted(quaternions[mine], *names)
        errors = angles(found, reference)
        if best is None or np.median(errors) < np.median(best[0]):
            best = errors, found, names
    errors, attitude, names = best
    floor = data["errors"]["attitude"]["value"] + columns["inherent_error"][rows]
    report = Report(motion=data["name"], scalar=names[0], direction=names[1])
    report |= {"t": times[mine], "attitude_errors": errors, "attitude_error": errors.max()}
    report["attitude_floor"] = floor.max()
    if omega is None:
        return report
    omega = np.asarray(omega, float)
    if omega.shape != (*times.shape, 3):
        raise ValueError("`omega` must have a row of three numbers for each time")
    wanted = np.stack([columns[f"omega{i}"] for i in (1, 2, 3)], 1)[rows]
    fits = []
    for name, plus in product(given(frame, FRAMES), given(sign, SIGNS)):
        body = omega[mine] * (1 if plus == "plus" else -1)
        body = turned(attitude, body, back=True) if name == "space" else body
        fits.append((np.median(np.linalg.norm(body - wanted, axis=1)), len(fits), name, plus, body))
    *_, report["frame"], report["sign"], body = min(fits)
    report["omega_errors"] = np.linalg.norm(body - wanted, axis=1)
    report["omega_error"] = report["omega_errors"].max()
    energy, momentum, _ = invariants(data, attitude, body)
    true_energy, true_momentum, scale = invariants(data, reference, wanted)
    report["energy_change"] = np.abs(energy - true_energy).max() / scale
    report["momentum_change"] = np.linalg.norm(momentum - true_momentum, axis=1).max() / (
        np.linalg.norm(true_momentum, axis=1).max() or 1
    )
    return report


def order(steps, errors):
    """The order of convergence: the slope of log(error) over log(step), of three steps or more."""
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


def common(reference, times):
    """The rows of both at common times: within 1e-9 of the interval between rows."""
    rows = np.searchsorted(reference, times - 1e-9 * (reference[1] - reference[0]))
    rows = np.minimum(rows, len(reference) - 1)
    mine = np.flatnonzero(np.abs(reference[rows] - times) <= 1e-9 * (reference[1] - reference[0]))
    if len(mine) < 2:
        first = ", ".join(map(repr, reference[:3].tolist()))
        raise ValueError(f"fewer than two of the times are those of the motion: {first}, ...")
    return rows[mine], mine


def given(name, names):
    """The name that was given, or all."""
    if name is not None and name not in names:
        raise ValueError(f"{name!r} is not one of {names}")
    return names if name is None else (name,)


def converted(quaternions, scalar, direction):
    """Unit quaternions, scalar first, body to space."""
    found = quaternions if scalar == "first" else np.roll(quaternions, 1, axis=1)
    found = found / np.linalg.norm(found, axis=1, keepdims=True)
    return found if direction == "body to space" else found * [1, -1, -1, -1]


def angles(first, second):
    """The angle of the rotation from one attitude to another, rad; the signs do not matter."""
    scalar = np.abs(np.sum(first * second, axis=1))
    vector = first[:, :1] * second[:, 1:] - second[:, :1] * first[:, 1:]
    vector = vector - np.cross(first[:, 1:], second[:, 1:])
    return 2 * np.arctan2(np.linalg.norm(vector, axis=1), scalar)


def turned(quaternions, vectors, back=False):
    """Vectors turned by quaternions: from body to space axes, or back."""
    axis = -quaternions[:, 1:] if back else quaternions[:, 1:]
    twice = 2 * np.cross(axis, vectors)
    return vectors + quaternions[:, :1] * twice + np.cross(axis, twice)


def invariants(data, quaternions, omega):
    """Energy, J, angular momentum of the body in space axes, J s, and the scale of the energy."""
    body = data["body"]
    momentum = omega @ np.array(body["inertia"])
    weight = body["mass"] * body["gravity"]
    centre = np.array(body["centre_of_mass"])
    height = turned(quaternions, np.broadcast_to(centre, omega.shape))[:, 2]
    kinetic = np.sum(omega * momentum, axis=1) / 2
    scale = kinetic[0] + weight * np.linalg.norm(centre)
    return kinetic + weight * height, turned(quaternions, momentum), scale or 1
