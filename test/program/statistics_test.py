"""Statistics of sweeps: their numbers, the same bytes however a run goes, hostile input."""

import re

import numpy as np

from conftest import each, needs_netcdf, wait_until
from indices_test import VECTOR
from slow_sweep import SLOW as SWEEP
from spintop_figures.sweeps.statistics import rows_beside
from spintop_figures.tables.table import read_table

# Cases that fail (at a pole), cases without a period, two quantities that are binned.
MAP = """\
&study kind = 'sweep' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&initial psi_rate = 3 /
&span t_end = 0.5 /
&integration formulation = 'lagrange', method = 'rk4', steps = 20 /
&sweep parameter(1) = 'initial.theta_deg', from(1) = 0, to(1) = 90, count(1) = 31
       parameter(2) = 'initial.phi_rate', values(2,:) = 1, -1, 0, 2
       parameter(3) = 'top.gravity', from(3) = 0, to(3) = 9.81, count(3) = 7 /
&output columns = 'theta_max', 'precession_period', 'motion_class', 'theta_end' /
&statistics columns = 'theta_max', 'precession_period', 'motion_class', 'status'
            over = 'initial.phi_rate', 'theta_end'  bins(2) = 3  from(2) = 0.1  to(2) = 1.5
            quantiles = 0, 0.1, 0.5, 1 quantiles_of = 'bins' /
"""
# A run of seconds, without rows.
SLOW = f"""\
{SWEEP}
&statistics columns = 'theta_max', 'theta_end', 'status'  over = 'initial.psi_rate'  bins = 20 /
&output rows = 'none' /
"""
ROWS = "rows = 'none'"
COLUMNS = MAP[MAP.index("columns = 'theta_max'") : MAP.index(" /\n&statistics")]
BARE = MAP.replace(COLUMNS, ROWS)
OVER = "over = 'initial.phi_rate', 'theta_end'"
BINS = f"{OVER}  bins(2) = 3  from(2) = 0.1  to(2) = 1.5"
RESULT = ("statistics.csv", "histogram.csv")


NETCDF = "output.format=netcdf"
ANY = (0, 3)
"""Exit codes of sweeps whose cases may fail."""


def swept(spin, text, *words, name="map", code=ANY):
    return spin(text, *words, name=name, code=code)


def results(spin, folder: str, name: str = "map") -> list[bytes]:
    return [(spin.folder / folder / f"{name}.{ending}").read_bytes() for ending in RESULT]


def numbers(tables: list[bytes]) -> list[list[bytes]]:
    return [[line for line in t.splitlines() if not line.startswith(b"#")] for t in tables]


def compare(found, name, values: np.ndarray) -> None:
    """The cells of a column in a row against the values of its cases; NaN counts for none."""
    there = np.sort(values[np.isfinite(values)])
    assert found[f"{name}_count"] == len(there)
    if not len(there):
        assert all(np.isnan(found[f"{name}_{key}"]) for key in ("mean", "deviation", "min", "max"))
        return
    assert abs(found[f"{name}_mean"] / np.mean(there) - 1) <= 1e-14
    assert (found[f"{name}_min"], found[f"{name}_max"]) == (there[0], there[-1])
    for share in (0, 0.1, 0.5, 1):
        expected = there[max(int(np.ceil(share * len(there))), 1) - 1]
        assert abs(found[f"{name}_q{share}"] - expected) <= 2**-8 * abs(expected)
    deviation = found[f"{name}_deviation"]
    if len(there) > 1:
        assert abs(deviation - np.std(there, ddof=1)) <= 1e-12 * np.mean(there)
    else:
        assert np.isnan(deviation)


def test_every_number(spin):
    """Count, mean, deviation, extremes with cases, quantiles, words: of each bin and of all."""
    run = swept(spin, MAP)
    rows, table = run.rows, run.table("statistics")
    good = rows.status == "ok"
    assert good.any()
    assert not good.all()
    assert rows.precession_period[good].isna().any()
    assert list(table.bin) == list(range(13))
    for row, found in table.iterrows():
        inside = np.ones(len(rows), dtype=bool)
        if row:
            low, high = found.theta_end_from, found.theta_end_to
            ends = rows.theta_end
            inside = (ends >= low) & ((ends < high) | ((high == 1.5) & (ends == high)))
            inside &= rows["initial.phi_rate"] == found["initial.phi_rate"]
        assert found.cases == inside.sum()
        assert found.failed == (inside & ~good).sum()
        for name in ("theta_max", "precession_period"):
            counted = rows[name].where(good)[inside]
            compare(found, name, counted.to_numpy())
            for key in ("min", "max"):
                first = 0
                if counted.notna().any():
                    first = rows.case[inside][counted == getattr(counted, key)()].iloc[0]
                assert found[f"{name}_{key}_case"] == first
        for name in ("motion_class", "status"):
            for word in set(rows[name]):
                assert found[f"{name}_{word}"] == (rows[name][inside] == word).sum()


def test_histograms(spin):
    """The intervals reach from minimum to maximum, with the numbers of the rows in them."""
    run = swept(spin, MAP)
    rows, table = run.rows, run.table("histogram")
    assert list(table) == ["column", "from", "to", "cases"]
    for name in ("theta_max", "precession_period"):
        values = rows[name][rows.status == "ok"].dropna()
        mine = table[table.column == name]
        assert (mine["from"].iloc[0], mine["to"].iloc[-1]) == (values.min(), values.max())
        assert len(mine) <= 100
        assert mine.cases.sum() == len(values)
        inside = [
            values.between(low, high, inclusive="left" if number < len(mine) else "both").sum()
            for number, (low, high) in enumerate(zip(mine["from"], mine["to"], strict=True), 1)
        ]
        assert list(mine.cases) == inside


def test_bins_of_an_axis(spin):
    """By default the bins are those of the axis: its values on a grid, or its interval."""
    assert BINS in MAP
    text = MAP.replace(BINS, "over = 'initial.theta_deg'")
    found = swept(spin, text).table("statistics")
    np.testing.assert_allclose(found["initial.theta_deg"][1:], np.linspace(0, 90, 31))
    assert set(found.cases[1:]) == {28}
    drawn = text.replace("count(1) = 31", "").replace("count(3) = 7", "")
    drawn = drawn.replace("&sweep ", "&sweep combine = 'random', cases = 300 ")
    found = swept(spin, drawn).table("statistics")
    assert len(found) == 51
    assert found["initial.theta_deg_from"][1] == 0
    assert found["initial.theta_deg_to"][50] == 90
    assert sum(found.cases[1:]) == 300


def test_all_cases_without_bins(spin):
    text = MAP.replace(BINS, "").replace("quantiles_of = 'bins'", "")
    assert list(swept(spin, text).table("statistics").cases) == [868]


@needs_netcdf
def test_the_same_numbers_as_netcdf(spin):
    """Bit for bit those of the CSV, with rows and without, as a whole and in parts."""
    csv = swept(spin, MAP)
    for text, name in ((MAP, "map"), (BARE, "bare")):
        swept(spin, text, NETCDF, name=name)
    states = spin.parts(BARE, 2, NETCDF, ending="statistics.state", name="bare", code=ANY)
    merged = spin.call("merge", "output/merged.nc", *states, path="output/merged.nc", code=ANY)
    whole = (spin.folder / "output/bare.statistics.nc").read_bytes()
    assert merged.path.read_bytes() == whole
    text = read_table(csv.path.with_suffix(".statistics.csv"))
    histogram = csv.table("histogram")
    for name in ("map.statistics.nc", "bare.statistics.nc"):
        table = read_table(spin.folder / "output" / name)
        assert table.kind == "statistics"
        assert set(table.rows) == set(text.rows)
        for column in text.rows:
            found, expected = (each.rows[column].to_numpy(float) for each in (table, text))
            np.testing.assert_array_equal(found, expected, err_msg=column)
        found = rows_beside(table, "histogram")
        for column in ("column", "cases", "from", "to"):
            np.testing.assert_array_equal(found[column], histogram[column])


@needs_netcdf
def test_a_changed_netcdf_result_is_not_resumed(spin):
    for options in ([], ["--resume"]):
        swept(spin, BARE, NETCDF, *options, name="bare")
    path = spin.folder / "output/bare.histogram.nc"
    data = bytearray(path.read_bytes())
    data[-9] ^= 1
    path.write_bytes(data)
    refused = swept(spin, BARE, NETCDF, "--resume", name="bare", code=2)
    assert "bare.histogram.nc was changed after it was written" in refused.stderr


def test_rows_and_parts(spin):
    swept(spin, MAP, "--output=one")
    one, two, three = spin.parts(MAP, 3, "--output=parts", name="map", code=ANY)
    (spin.folder / "parts/map.2-of-3.statistics.state").unlink()
    refused = spin.call("merge", "parts/map.csv", two, three, one, code=2)
    assert "map.2-of-3.statistics.state" in refused.stderr
    swept(spin, BARE, "--output=one", name="bare")
    assert numbers(results(spin, "one")) == numbers(results(spin, "one", "bare"))
    assert not (spin.folder / "one/bare.csv").exists()


@each("text", BARE, VECTOR)
def test_damaged_parts(spin, text):
    """A part that is cut short, changed, twice there or missing is refused, with indices too."""
    states = spin.parts(text, 3, ending="statistics.state", name="map", code=ANY)
    damaged = spin.folder / states[1]
    whole = damaged.read_bytes()
    begin, end = whole.index(b"spintop statistics 3"), len(whole)
    damages = [whole[: begin + 30], whole[:-1], whole[:-40], whole[:begin]]
    middle = end // 2 + begin // 2
    for place in (*range(begin + 25, begin + 900, 97), middle, *range(end - 5, begin, -331)):
        damages.append(whole[:place] + bytes([whole[place] ^ 64]) + whole[place + 1 :])
    merge = ("merge", "output/all.statistics.csv")
    for damage in damages:
        damaged.write_bytes(damage)
        assert "map.2-of-3.statistics.state" in spin.call(*merge, *states, code=2).stderr
        assert not list(spin.folder.glob("output/all.*"))
    damaged.write_bytes(whole)
    for parts in ([states[0]], [states[0], states[0]]):
        spin.call(*merge, *parts, code=2)
    spin.call(*merge, *states, code=ANY)


RESUMED = ("map.nml", "--resume", "--threads", "1")


def test_damaged_snapshot(spin):
    spin.write(SLOW, "map.nml")
    with spin.start(*RESUMED) as run:
        wait_until(lambda: run.poll() is None and spin.journalled("output/map.statistics.csv") > 0)
    states = list((spin.folder / "output").glob("*.state?"))
    assert states
    for state in states:
        content = bytearray(state.read_bytes())
        content[-30] ^= 1
        state.write_bytes(bytes(content))
    assert "--restart discards it" in spin.call("map.nml", "--resume", code=2).stderr
    said = spin.call("map.nml", code=2).stderr
    assert "an interrupted run of output/map.statistics.csv is there" in said
    spin.call("map.nml", "--restart", code=ANY)
    assert not list((spin.folder / "output").glob("*.state?"))


@each("text", MAP, SLOW.replace("count(1) = 1000", "count(1) = 20"))
def test_nothing_left_to_compute(spin, text):
    swept(spin, text)
    assert "the table is already complete" in swept(spin, text, "--resume").out


STATISTICS_OF = "columns = 'theta_max', 'precession_period', 'motion_class', 'status'"
QUANTILES = "quantiles = 0, 0.1, 0.5, 1"
NONE = "&output rows = 'none' /"
SINGLE = SLOW.replace(SLOW[SLOW.index("&sweep") : SLOW.index("&statistics")], "")
SINGLE = SINGLE.replace("'sweep'", "'trajectory'")
REFUSED = [
    (STATISTICS_OF, "columns = 'theta_mx'", "there is no column 'theta_mx'", "'theta_max'?"),
    (STATISTICS_OF, "columns = 'theta_max', 'theta_max'", "named twice"),
    (STATISTICS_OF, "columns = 'com_z_min'", "the table has no column", "add it to output.columns"),
    (STATISTICS_OF, "columns = 'top.mass'", "top.mass is not swept"),
    (STATISTICS_OF, "columns = 'notes'", "has no statistics"),
    (STATISTICS_OF, "", "there are no columns of which statistics are computed"),
    (OVER, "over = 'initial.phi_rate', 'motion_class'", "has words, and no numbers"),
    (OVER, "over = 'initial.phi_rate', 'initial.phi'", "is not swept"),
    (OVER, "over = 'theta_end', 'theta_end' from(1) = 0 to(1) = 1", "both quantities are the same"),
    ("from(2) = 0.1", "", "is not known before it is computed", "statistics.from(2)"),
    ("to(2) = 1.5", "to(2) = 0.1", "not above 0.1", "give from < to"),
    ("from(2) = 0.1", "from(2) = -1 spacing(2) = 'log'", "needs positive ends, not -1"),
    ("bins(2) = 3", "bins(2) = 0", "must be >= 1"),
    ("bins(2) = 3", "bins(2) = 2000000000", "more memory than this machine has"),
    ("bins(2) = 3", "bins(2) = 5000000 bins(1) = 1000", "than this machine has", "use fewer bins"),
    ("from(2) = 0.1", "from(2) = 1.4999999999999998", "narrower than the spacing"),
    ("from(2) = 0.1  to(2) = 1.5", "from(2) = -1.7e308  to(2) = 1.7e308", "too far apart"),
    (OVER, "", "described, but not what they are over"),
    (QUANTILES, "quantiles = 0.5, 1.5", "must be in [0, 1]"),
    (QUANTILES, "quantiles = 0.5, 0.5", "do not increase"),
    (BINS, "", "there are no bins"),
    ("'bins' /", "'some' /", "all", "bins"),
    ("&output columns", "&output rows = 'none' columns", "there are no rows to have columns"),
]
REFUSED = [(MAP, *row) for row in REFUSED] + [
    (SLOW, SLOW[SLOW.index("&statistics") :], NONE, "nothing would be written"),
    (SLOW, ROWS, "rows = 'some'", "all", "none"),
    (SINGLE, NONE, "", "a trajectory has no statistics", "study.kind = 'sweep'"),
    (SINGLE, SINGLE[SINGLE.index("&statistics") :], NONE, "a trajectory always has its rows"),
]


@each("row", *REFUSED)
def test_what_is_refused(spin, row):
    text, old, new, *words = row
    assert old in text
    spin.write(text.replace(old, new), "map.nml")
    said = spin.refuse("map.nml")
    assert re.search(r"^map\.nml:\d+:\d+: error: ", said)
    for word in words:
        assert word in said


def test_check(spin):
    said = swept(spin, MAP, "--check").out
    assert "statistics 12 bins, 4 columns, about " in said
    assert "MB of memory" in said
    assert "initial.phi_rate: 4 bins from -1.5 to 2.5" in said
    assert "output/map.csv, its statistics -> output/map.statistics.csv" in said
    spin(said[said.index("&study") :], "--check", name="again")


@each("bins", 3, 60)
def test_bytes_of_the_tables(spin, bins):
    """--check tells them: at most, and no more than some times what is then written."""
    text = BARE.replace("quantiles_of = 'bins'", "").replace("bins(2) = 3", f"bins(2) = {bins}")
    said = swept(spin, text, "--check").out
    assert "bytes per case" not in said
    found = re.search(r"! +statistics +about (\S+) (k?M?)B at most\n", said)
    assert found, said
    forecast = float(found[1]) * {"": 1, "k": 1e3, "M": 1e6}[found[2]]
    swept(spin, text)
    written = sum(part.stat().st_size for part in spin.folder.glob("output/map.*.csv"))
    assert written < 1.5 * forecast
    assert forecast < 4 * written
