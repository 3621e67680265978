"""Studies other than sweeps in parts: merged parts are the whole, apart from dates and times."""

import re

from conftest import MPI, each, needs_mpi, texts, under

BODY = """
&top mass = 1  inertia = 1, 1.5, 2.25  centre_of_mass = 0.1, 0.05, 0.2 /
&initial quaternion = 0.8, 0.6, 0, 0  omega = 0.5, 0.5, 1 /
&span t_end = 2 /
"""
PRECISION = f"""
&study kind = 'work_precision' /{BODY}
&work_precision methods = 'taylor', 'rk4', 'ode45' repeats = 1
                tolerances = 1e-6, 1e-9 steps = 100, 200 /
&sweep parameter(1) = 'initial.omega(3)', values(1,:) = 1, 2, 3 /
"""
STABILITY = f"""
&study kind = 'stability' /{BODY}
&stability cases = 'slow_top', 'sleeping_below', 'intermediate_axis', 'slow_top', 'sleeping_above'
           methods = 'taylor', 'rk4', 'dop853/lagrange' /
"""
BENCHMARK = """
&study kind = 'benchmark' /
&benchmark cases = 'steady_cone', 'heavy_top_start', 'simo_wong' /
"""
TRAJECTORY = f"&study kind = 'trajectory' /{BODY}"
TIMED = {"time_s", "front"}
"""Columns that depend on times."""
BEST = {"method", "formulation", "setting", "value", "error", "evaluations"}
"""Those of a benchmark that belong to its fastest setting."""


def compute(spin, text, folder, *options, ranks=0):
    scene = spin.write(text, "study.nml")
    words = [scene, "-o", folder, *options]
    if not ranks:
        return spin.call(*words).out
    return spin.call(*words, command=under(ranks), environment=MPI).out


def check_same(spin, found, whole, varying=TIMED):
    """Two tables are the same apart from dates, times, and the order by times of a problem."""
    heads, tables, words = [], [], []
    for name in (found, whole):
        lines = (spin.folder / name).read_text(encoding="utf-8").splitlines()
        first = next(i for i, line in enumerate(lines) if not line.startswith("#"))
        head = [line for line in lines[:first] if not line.startswith("# date: ")]
        assert len(head) == first - 1, "one date"
        heads.append(head)
        assert re.match(r"# end: \d+ rows, ", lines[-1])
        rest = [line for line in lines[first:-1] if line.startswith("#")]
        words.append([re.split(" is | takes ", word)[0] for word in rest])
        rows = texts(spin.folder / name)
        if "problem" in rows:
            rows = rows.sort_values(["problem", "method", "setting"], ignore_index=True)
        tables.append(rows[[column for column in rows if column not in varying]])
    assert heads[0] == heads[1]
    assert words[0] == words[1]
    assert tables[0].equals(tables[1])


@each(
    "text, parts, varying",
    (PRECISION, 2, TIMED),  # a problem is a case
    (PRECISION, 4, TIMED),  # one of the parts is empty
    (STABILITY, 3, TIMED),  # a motion of the catalogue is a case
    (BENCHMARK, 2, TIMED | BEST),  # which setting is the fastest depends on times
)
def test_parts(spin, text, parts, varying):
    """The merged parts are the whole, and byte for byte what the parts have."""
    compute(spin, text, "whole")
    names, bodies = [], []
    for part in range(1, parts + 1):
        said = compute(spin, text, "parts", "--shard", f"{part}/{parts}")
        assert re.search(rf"part {part} of {parts}: (no )?cases ", said)
        names.append(f"parts/study.{part}-of-{parts}.csv")
        lines = (spin.folder / names[-1]).read_text(encoding="utf-8").splitlines(keepends=True)
        columns, *rows = (line for line in lines if not line.startswith("#"))
        bodies += rows
    spin.call("merge", "all.csv", *reversed(names))
    check_same(spin, "all.csv", "whole/study.csv", varying)
    merged = (spin.folder / "all.csv").read_text(encoding="utf-8")
    assert columns + "".join(bodies) in merged
    assert "# part " not in merged


def test_check(spin):
    said = compute(spin, PRECISION, "none", "--check", "--shard", "2/2")
    assert "part 2 of 2: cases 3 to 3 of 3" in said


def test_refused(spin):
    """Trajectories have no parts; a part is missing, cut off, or of another input."""
    assert "--shard is not for trajectories" in spin.refuse(TRAJECTORY, "--shard=1/2")
    for part in (1, 2):
        compute(spin, STABILITY, "parts", "--shard", f"{part}/2")
    first, second = (f"parts/study.{part}-of-2.csv" for part in (1, 2))
    other = STABILITY.replace("omega = 0.5, 0.5, 1", "omega = 0.5, 0.5, 2")
    compute(spin, other, "other", "--shard", "2/2")
    path = spin.folder / second
    text = path.read_text(encoding="utf-8")
    path.write_text(text[: text.rindex("# end")], encoding="utf-8")
    for names, said in (
        ([first], "missing of 2 parts: 2"),
        ([first, "other/study.2-of-2.csv"], "part of another study than"),
        ([first, second], "study.2-of-2.csv is not complete"),
    ):
        assert said in spin.call("merge", "all.csv", *names, code=2).stderr
    assert not (spin.folder / "all.csv").exists()


@needs_mpi
@each("text", STABILITY, PRECISION, TRAJECTORY)
def test_ranks(spin, text):
    """Ranks share the cases of a stability study; other studies are computed by the first."""
    said = compute(spin, text, "alone")
    for ranks in (1, 2, 3):
        heard = compute(spin, text, "ranks", ranks=ranks)
        assert heard.count("study.nml: ") == 1
        check_same(spin, "ranks/study.csv", "alone/study.csv")
        if text == STABILITY:
            one, other = (re.findall(r".* accurate.*", each) for each in (said, heard))
            assert one == other


@needs_mpi
def test_parts_by_ranks(spin):
    compute(spin, STABILITY, "alone", "--shard", "1/2")
    compute(spin, STABILITY, "ranks", "--shard", "1/2", ranks=2)
    check_same(spin, "ranks/study.1-of-2.csv", "alone/study.1-of-2.csv")
