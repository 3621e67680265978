"""Fits to tables of loggers as they come: right numbers, or an error that says what to write."""

from datetime import datetime, timedelta

import numpy as np
import pytest

from conftest import each, output

SCENE = """\
&study kind = 'fit' /
&top mass = 1, inertia = 0.875, 0.875, 0.25, length = 0.85 /
&initial theta = 0.6, theta_rate = 0.3, psi_rate = 14 /
"""
ROWS = 61
COLUMNS = ("t", "omega1", "omega2", "theta", "accelerometer1")
G0 = 9.80665
ANGLE = 180 / np.pi
MIDNIGHT = datetime(2026, 5, 31, 23, 59, 57)


@pytest.fixture
def motion(spin):
    """Exact readings: times, and columns of trajectories in their units."""
    scene = SCENE.replace("fit", "trajectory")
    span = f"&span t_end = 6, samples = {ROWS} /\n"
    rows = spin(scene + span + output(*COLUMNS), name="motion").rows
    return {name: rows[name].to_numpy() for name in COLUMNS}


def millis(t, begin=0, bits=64):
    """The texts of a counter of milliseconds."""
    return [str((begin + round(1000 * x)) % 2**bits) for x in t]


def dates(t, form="%Y-%m-%dT%H:%M:%S.%f"):
    return [(MIDNIGHT + timedelta(seconds=round(x, 3))).strftime(form)[:-3] for x in t]


def columns_of(motion):
    """What columns of tables contain: clocks, angular velocities in deg/s and others."""
    t, x, y, theta, a = motion.values()
    x, y = ANGLE * x, ANGLE * y
    return {
        "s": t,
        "ms": 1000 * t,
        "us": 1e6 * t,
        "min": t / 60,
        "begin": millis(t, 123456),
        "later": millis(t, 500),
        "bits16": millis(t, 63000, 16),
        "bits32": millis(1000 * t, 2**32 - 10**6, 32),
        "date": dates(t),
        "zone": [text + "+02:00" for text in dates(t)],
        "blank": dates(t, "%Y-%m-%d %H:%M:%S.%f"),
        "german": dates(t, "%d.%m.%Y %H:%M:%S.%f"),
        "day": dates(t, "%H:%M:%S.%f"),
        "epoch": [f"{1.78e9 + v:.3f}" for v in t],
        "x": x,
        "y": y,
        "rpm": x / 6,
        "rad": np.radians(y),
        "commas": [str(v).replace(".", ",") for v in y],
        "missing": [*map(str, y[:-1]), "NA"],
        "word": [*map(str, y[:9]), "bad", *map(str, y[10:])],
        "theta": ANGLE * theta,
        "a": a,
        "g": a / G0,
        "mg": a / G0 * 1000,
        "one": np.ones(ROWS),
        "note": ["a b"] * ROWS,
        "": [""] * ROWS,
        "american": dates(t, "%m/%d/%Y %H:%M:%S.%f"),
        "minutes": ["05:22.1"] * ROWS,
        "noon": [*dates(t)[:-1], "noon"],
        "restart": millis([*t[:40], *t[:21]]),
        "coarse": millis(np.floor(t)),
        "lost": [*millis(t[:-1]), ""],
    }


def spell(motion, names, kinds, separator=",", head="", end="\n", trail="", comma=False, quote=""):
    """The text of a table with these names, and perhaps units below, where | separates them."""
    known = columns_of(motion)
    cells = [[str(cell) for cell in np.asarray(known[kind]).tolist()] for kind in kinds.split(" ")]
    if comma:
        cells = [[cell.replace(".", ",") for cell in column] for column in cells]
    rows = ["|".join(f"{quote}{cell}{quote}" for cell in row) for row in zip(*cells, strict=True)]
    lines = [line + trail for line in (*names.split("\n"), *rows)]
    return head + end.join(lines).replace("|", separator) + end


NAMES = "'t = time', 'omega1 = gx', 'omega2 = gy'"
GYRO = "time [ms]|gx [dps]|gy [dps]"
PLAIN = "time|gx [dps]|gy [dps]"
READ = ", ".join(f"'{a} = {b}'" for a, b in zip(COLUMNS, GYRO.split("|"), strict=False))

GOOD = {
    "names without units": (NAMES, GYRO, "ms x y", {"separator": ";"}),
    "names as they stand": (READ, GYRO, "ms x y", {}),
    "other capitals": (NAMES.replace("gx", "GX"), GYRO, "ms x y", {}),
    "tabs": (NAMES, GYRO, "ms x y", {"separator": "\t"}),
    "blanks": (NAMES, GYRO, "ms x y", {"separator": "  "}),
    "bars, and one at the end": (NAMES, GYRO, "ms x y", {"separator": "|", "trail": "|"}),
    "decimal commas": (NAMES, GYRO, "ms x y", {"separator": ";", "comma": True}),
    "quoted decimal commas": (NAMES, GYRO, "ms x y", {"quote": '"', "comma": True}),
    "names in a comment": (NAMES, GYRO, "ms x y", {"separator": " ", "head": "# a b c\n# "}),
    "comments of other programs": (NAMES, GYRO, "ms x y", {"head": "% a, b, c\n// d\n\n"}),
    "a preamble": (NAMES, GYRO, "ms x y", {"head": "Device,X1\nRate,100\n\nNotes\n"}),
    "a line of units": (NAMES, "time|gx|gy\nms|°/s|dps", "ms x y", {"separator": ";"}),
    "units in brackets below": (NAMES, "time|gx|gy\n[s]|[deg/s]|[dps]", "s x y", {}),
    "byte order mark and CRLF": (NAMES, GYRO, "ms x y", {"head": "\ufeff", "end": "\r\n"}),
    "Latin-1": (NAMES, "time (µs)|gx (°/s)|gy (°/s)", "us x y", {}),
    "a clock that begins anywhere": (NAMES, GYRO, "begin x y", {}),
    "a clock that begins within its span": (NAMES, GYRO, "later x y", {}),
    "a counter of 16 bits": (NAMES, GYRO, "bits16 x y", {}),
    "a counter of 32 bits": (NAMES, GYRO.replace("ms", "us"), "bits32 x y", {}),
    "dates": (NAMES, PLAIN, "date x y", {}),
    "dates of a zone": (NAMES, PLAIN, "zone x y", {}),
    "dates with commas": (NAMES, PLAIN, "blank x y", {"separator": ";", "comma": True}),
    "German dates": (NAMES, PLAIN, "german x y", {}),
    "a clock of day over midnight": (NAMES, PLAIN, "day x y", {}),
    "seconds of an epoch": (NAMES, GYRO.replace("ms", "s"), "epoch x y", {}),
    "units of the mapping": (
        "'t = time (min)', 'omega1 = gx (rpm)', 'omega2 = gy (rad/s)'",
        "time|gx|gy",
        "min rpm rad",
        {},
    ),
    "a wrong unit in the table": (
        NAMES.replace("gx", "gx [rad/s] (dps)"),
        "time / ms|gx [rad/s]|gy [dps]",
        "ms x y",
        {},
    ),
    "suffixes": (
        "'t = time_ms', 'omega1 = gyro_x_dps', 'omega2 = gyro_y_dps'",
        "time_ms|gyro_x_dps|gyro_y_dps",
        "ms x y",
        {},
    ),
    "units of the columns": (
        "'t_ms = time', 'omega1_deg = gx', 'omega2_deg = gy'",
        "time|gx|gy",
        "ms x y",
        {},
    ),
    "other columns, some twice": (NAMES, GYRO + "|temp|temp|note|", "ms x y s s note ", {}),
    "standard deviations, and what is not there": (
        NAMES + ", 'omega1_sigma = error (dps)', 'omega2_sigma = error 2 (dps)'",
        GYRO + "|error|error 2",
        "ms x missing one one",
        {},
    ),
    "accelerations": (
        NAMES + ", 'accelerometer1 = Acc X'",
        GYRO + "|Acc X (g)",
        "ms x y g",
        {},
    ),
    "small accelerations": (NAMES + ", 'accelerometer1 = ax'", GYRO + "|ax / mg", "ms x y mg", {}),
    "squares": (NAMES + ", 'accelerometer1 = ax'", GYRO + '|"ax, m/s²"', "ms x y a", {}),
    "own names with units": ("", "t [ms]|omega1 (deg/s)|omega2_deg", "ms x y", {"separator": ";"}),
    "own names above units": ("", "t|omega1|omega2\nms|dps|dps", "ms x y", {"separator": " "}),
}


def fit_to(columns):
    given = f"columns = {columns}, " if columns else ""
    return (
        f"{SCENE}&fit data = 'data.csv', {given}unknown = 'initial.psi_rate' profile = .false. /\n"
    )


@each("kind", *GOOD)
def test_numbers(spin, motion, kind):
    """Measured values are those of the motion, and the fit is exact."""
    columns, names, kinds, form = GOOD[kind]
    data = spell(motion, names, kinds, **form)
    run = spin(fit_to(columns), data=data.encode("latin-1") if kind == "Latin-1" else data)
    assert run.status == "ok", run.out
    assert run.stderr == "" or "_sigma" in columns
    found = run.table("residuals")
    assert len(found.columns) == 1 + 3 * (3 if "accelerometer" in columns else 2)
    for name in found.columns[1::3]:
        quantity, _, unit = name.partition("_")
        values = motion[quantity] * (ANGLE if unit else 1)
        assert found[name][:-1].to_numpy() == pytest.approx(values[:-1], rel=1e-12, abs=1e-12)
    times = found.iloc[:, 0].to_numpy() / (1000 if "t_ms" in found else 1)
    assert times == pytest.approx(motion["t"], abs=1e-6 if "epoch" in kind else 1e-9)


BAD = {
    "no mapping": ("", GYRO, "ms x y", READ),
    "a phone": (
        "",
        "Time (s)|Gyroscope x (rad/s)|Gyroscope y (rad/s)",
        "s x y",
        "'t = Time (s)', 'omega1 = Gyroscope x (rad/s)', 'omega2 = Gyroscope y (rad/s)'",
    ),
    "names that say nothing": ("", "a|b", "s x", "'t = TIME (ms)'"),
    "a column beside": ("", "t|theta|temp (K)", "s theta x", "columns = 'theta'"),
    "no unit": (NAMES, "time (s)|gx|gy (dps)", "s x y", "'omega1 = gx (deg/s)'"),
    "no unit of the time": (NAMES, PLAIN, "s x y", "'t = time (s)'"),
    "no such column": (NAMES.replace("gx", "g1"), GYRO, "ms x y", READ),
    "two such columns": (NAMES, GYRO + "|gx [dps]", "ms x y y", "different names"),
    "two units": (NAMES.replace("gx", "gx (rad/s)"), GYRO, "ms x y", "gx [dps] (rad/s)'"),
    "a misspelt unit": (NAMES.replace("gx", "gx (rpn)"), GYRO, "ms x y", "'rpn' is not a unit"),
    "another quantity": (
        NAMES,
        "time (s)|gx (g)|gy (dps)",
        "s x y",
        "no unit of a quantity in rad/s",
    ),
    "counts": (NAMES, "time (s)|gx (LSB)|gy (dps)", "s x y", "'omega1 = gx (LSB) (deg/s)'"),
    "an angle is missing": (NAMES, "time (s)|gx (1/s)|gy (dps)", "s x y", "an angle is missing"),
    "no such name": (NAMES.replace("a1", "a4"), GYRO, "ms x y", "did you mean 'omega1'?"),
    "one column twice": (NAMES.replace("gy", "gx"), GYRO, "ms x y", "maps a column twice"),
    "one name twice": (NAMES.replace("a2", "a1"), GYRO, "ms x y", "maps a column twice"),
    "one quantity twice": (NAMES.replace("a2", "a1_deg"), GYRO, "ms x y", "named twice"),
    "commas and points": (NAMES, GYRO, "ms x commas", "both decimal commas and points"),
    "commas between commas": (NAMES, GYRO, "ms commas commas", "decimals have points"),
    "a word": (NAMES, GYRO, "ms x word", "data.csv:11: 'bad'"),
    "American dates": (NAMES, PLAIN, "american x y", "'t = time (s)'"),
    "a clock of minutes": (NAMES, PLAIN, "minutes x y", "'t = time (s)'"),
    "a wrong date": (NAMES, PLAIN, "noon x y", "write 2026-05-31T13:05:22.123"),
    "a restart": (NAMES, GYRO, "restart x y", "the times do not increase"),
    "a coarse clock": (NAMES, GYRO, "coarse x y", "one per time"),
    "no time": (NAMES, GYRO, "lost x y", "'' in column t"),
    "no clock": ("'omega1 = gx'", "gx [dps]|gy", "x y", "is the time"),
    "two clocks": ("", "t|t_ms|theta", "s ms theta", "'t' and 't_ms'"),
    "milliseconds as seconds": (NAMES, GYRO.replace("ms", "s"), "ms x y", "give the times in s"),
}


@each("kind", *BAD)
def test_errors(spin, motion, kind):
    """What is wrong has a message that says what to write."""
    columns, names, kinds, message = BAD[kind]
    separator = ";" if kind == "commas and points" else ","
    error = spin.refuse(fit_to(columns), data=spell(motion, names, kinds, separator))
    assert message in " ".join(error.split())


@each(
    "change, message",
    (lambda text: text[:-30], "the row ends before"),
    (lambda text: text.encode("utf-16"), "UTF-8"),
    (lambda text: text[text.index("\n") + 1 :], "has no column 'time'"),
    (lambda text: text[: text.index("\n")], "data.csv: the table has no rows"),
    (lambda text: "", "data.csv: the table has no rows"),
)
def test_damage(spin, motion, change, message):
    """So has a file that was cut or is no table."""
    text = fit_to(NAMES).replace("unknown =", "unknown = 'offset.omega1',")
    error = spin.refuse(text, data=change(spell(motion, GYRO, "ms x y")))
    assert message in " ".join(error.split())
    assert "not measured" not in error
    assert ("1 error\n" in error) == ("no column" not in message)


def test_mapping_of_an_error(spin, motion):
    """The line that an error names does what it says."""
    data = spell(motion, GYRO, "ms x y", ";")
    error = " ".join(spin.refuse(fit_to(""), data=data).split())
    line = error[error.index("columns = ") + len("columns = ") : error.rindex("'") + 1]
    assert spin(fit_to(line), data=data).status == "ok"


def test_what_was_understood(spin, motion):
    """It is in --check; a standard deviation with a unit is that of a mapped column."""
    text = fit_to("'omega1 = gx', 'omega2 = gy', 't = time', sigma = '1 deg/s', 0.1")
    data = spell(motion, GYRO, "ms x y", ";", comma=True)
    said = " ".join(spin(text, "--check", data=data).out.replace("!", "").split())
    assert "columns omega1 = gx [dps] (deg/s), omega2 = gy [dps] (deg/s) clock" in said
    assert "clock t = time [ms] from 0,0: 61 rows over 6.000 s, 0.1000 s apart; ';'" in said
    assert "between cells, decimal commas" in said
