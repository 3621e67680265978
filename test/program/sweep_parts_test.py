"""A sweep in parts, also as jobs of Slurm, and bad cases among good ones."""

import os
import re

import pytest

from axes_test import HYPERCUBE
from conftest import CLOSED, EXE, GOOD, MPI, ROOT, each, merge, needs_mpi, texts, under
from indices_test import FAILING, VECTOR
from slow_sweep import FAST, SLOW, STEPS, Sweep, undisturbed
from statistics_test import BARE, MAP


def parts_of(name, count):
    return [f"output/{name}.{i}-of-{count}.csv" for i in range(1, count + 1)]


CLOSED_FORMS = CLOSED.replace("    psi_rate = 1.0\n", "") + (
    "&study kind = 'sweep' /\n&sweep parameter(1) = 'initial.psi_rate', from(1) = 0.01,"
    " to(1) = 100, count(1) = 20000, spacing(1) = 'log' /\n"
)
FEW = VECTOR.replace("cases = 64", "cases = 12")  # a group of cases may lie in three parts


@each(
    "text, parts",
    (CLOSED_FORMS, 3),  # many blocks of cases
    (SLOW.replace("= 1000", "= 210").replace(STEPS, "steps = 10"), 2),
    (HYPERCUBE, 3),
    (HYPERCUBE.replace("latin_hypercube", "random"), 3),
    (MAP, 3),
    (BARE, 2),
    (FAILING, 7),
    (FEW, 7),
    (FEW, 13),  # a part may be empty
)
def test_threads_and_parts(spin, text, parts):
    """The same bytes, of statistics too, on any threads, and merged from parts in any order."""
    failing = (0, 3)
    for n in (1, 2, 5):
        spin(text, f"--threads={n}", f"--output={n}", code=failing)
    kind = "statistics." * ("rows = 'none'" in text)
    ending = "statistics.state" if kind else "csv"
    names = spin.parts(text, parts, "--output=parts", ending=ending, code=failing)
    spin.call("merge", f"parts/scene.{kind}csv", *reversed(names), code=failing)
    tables = {path.name: path.read_bytes() for path in (spin.folder / "1").glob("*.csv")}
    for folder in ("2", "5", "parts"):
        for name, content in tables.items():
            assert (spin.folder / folder / name).read_bytes() == content, (folder, name)


@pytest.mark.slow
def test_three_parts_make_the_whole(spin):
    slow = Sweep(spin, table="output/slow.2-of-3.csv")
    one, two, three = parts_of("slow", 3)
    slow("--shard", "1/3")
    slow.interrupt("--shard", "2/3")
    merge(spin, "output/slow.csv", one, two, three, code=2)
    slow("--resume", "--shard", "2/3")
    said = slow("--resume", "--shard", "3/3", "--threads", "1")
    assert "part 3 of 3: cases 668 to 1000 of 1000" in said
    said = merge(spin, "output/slow.csv", three, one, two)
    assert said == "3 parts, 1000 cases -> output/slow.csv\n"
    assert slow.read("output/slow.csv") == undisturbed(SLOW)["slow.csv"]
    assert "output/slow.csv.part" not in spin.produced()
    lines = slow.read(two).decode().splitlines()
    assert lines[0] == "# part 2 of 3: cases 335 to 667 of 1000"
    rows = [line.split(",")[0] for line in lines if not line.startswith("#")][1:]
    assert (rows[0], rows[-1]) == ("335", "667")


def test_parts_that_do_not_fit(spin):
    """A missing, repeated, foreign or cut part is refused by its name; nothing is written."""
    for shard in ("1/2", "2/2", "2/3"):
        spin(FAST, f"--shard={shard}")
    (one, two), third, table = parts_of("scene", 2), parts_of("scene", 3)[1], "output/scene.csv"
    path = spin.folder / two
    whole = path.read_bytes()

    def refused(*names):
        return merge(spin, *names, code=2)

    assert "missing of 2 parts: 2" in refused(table, one)
    assert f"{one}: it is part 1" in refused(table, one, two, one)
    assert f"{third}: it is a part of " in refused(table, one, third)
    assert "also one of the parts" in refused(one, one, two)
    path.write_bytes(whole[:-200])
    assert f"{two}: it has 49" in refused(table, one, two)
    path.write_bytes(whole)
    spin.write("of an interrupted merge", f"{table}.part")
    merge(spin, table, one, two)
    merged = (spin.folder / table).read_bytes()
    assert spin(FAST).path.read_bytes() == merged
    spin(FAST, "--shard=2/2", "top.mass=2")
    assert f"{two}: mass = 2\n" in refused(table, one, two)
    assert (spin.folder / table).read_bytes() == merged
    for names in ([], [table]):
        refused(*names)


def test_resume_and_shard_are_not_for_all_studies(spin):
    assert "--shard is not for trajectories" in spin.refuse(GOOD, "--shard=1/2")
    said = spin.refuse(GOOD, "--resume", "study.kind=stability")
    assert "--resume is for sweeps and trajectories" in said
    for shard in ("0/3", "4/3", "3", "1/2/3", "a/b", "1/2000000"):
        said = spin.refuse(SLOW, f"--shard={shard}")
        assert "--shard takes I/N" in said
        assert "with N up to 1000000" in said


def submit(spin, scene, parts, *words, warn=False):
    """Run the script for Slurm; what its jobs said, and what was asked of Slurm.

    Here `sbatch` runs a copy of the script, each task in turn, and `srun` what it is given. Both
    clear the environment, as sites do that have `--export=NONE`. With `warn` the first task gets
    the signal that it asked for once it has rows, and runs again if it is requeued.
    """
    folder = spin.folder
    (folder / "bin").mkdir()
    clear = f"env -i PATH='{folder}/bin':/usr/bin:/bin SLURM_CPUS_PER_TASK=1"
    job = f"""{clear} $job bash '{folder}/bin/slurm_script' "$@" >>'{folder}/log' 2>&1 &"""
    scripts = {
        "sbatch": f"""\
echo sbatch >>"$calls"
[ "$(wc -l <"$calls")" -lt 9 ] || exit 1 # jobs that submit jobs without end
for a; do
    case $a in --array=1-*) tasks=${{a#--array=1-}} ;; */slurm_sweep.sh) break ;; esac
    case $a in --signal=*) signal=${{a#--signal=}} ;; esac
    shift
done
cp "$1" '{folder}/bin/slurm_script' && shift
for ((i = 1; i <= ${{tasks:-1}}; ++i)); do
    job="SLURM_JOB_ID=17"
    if [ -n "${{tasks:-}}" ]; then job+=" SLURM_ARRAY_JOB_ID=17 SLURM_ARRAY_TASK_ID=$i"; fi
    {job}
    if [ -e '{folder}/warn' ] && [[ $signal = B:USR1@* ]]; then
        rm '{folder}/warn'
        until grep -qs '^rows: [1-9]' '{folder}/o u t/'*.journal; do sleep 0.01; done
        kill -USR1 $!
        wait $!
        grep -q requeue "$calls" || exit 1
        {job}
    fi
    wait $!
done
echo 17
""",
        "scontrol": 'echo "$@" >>"$calls"\n',
        "srun": f'while [[ $1 = --* ]]; do shift; done\nexec {clear} "$@"\n',
    }
    for name, text in scripts.items():
        spin.write(f"#!/usr/bin/env bash\ncalls='{folder}/calls'\n{text}", f"bin/{name}")
        (folder / "bin" / name).chmod(0o755)
    if warn:
        spin.write("", "warn")
    environment = {"PATH": f"{folder}/bin:{os.environ['PATH']}", "SPINTOP_EXE": str(EXE)}
    environment["OUTPUT"] = "o u t"
    script = (ROOT / "scripts/slurm_sweep.sh",)
    spin.call(scene, parts, *words, command=script, environment=environment)
    return (folder / "log").read_text(), (folder / "calls").read_text().splitlines()


GATHERED = FAST + "&statistics columns = 'theta_max', over = 'initial.psi_rate', bins = 7 /\n"


@each(
    "text, parts, names, jobs",
    (FAST + "&output file = 'named.csv' /\n", "4", ["named.csv"], 2),
    (FAST + "&output file = 'named.csv' /\n", "mpi", ["named.csv"], 1),
    (GATHERED, "3", ["scene.csv", "scene.statistics.csv"], 2),
    (GATHERED + "&output rows = 'none' /\n", "3", ["scene.statistics.csv"], 2),
)
def test_a_job_array(spin, text, parts, names, jobs):
    """The script for Slurm, where jobs get no environment: an array, MPI, statistics."""
    change = "initial.theta_deg=25"
    whole = spin(text, "--output=whole", change).path.parent
    said, calls = submit(spin, "scene.nml", parts, "--time=1", "--set", change)
    assert calls.count("sbatch") == jobs, said
    assert ("the last runs of the parts took" in said) == (parts != "mpi"), said
    for name in names:
        assert (spin.folder / "o u t" / name).read_bytes() == (whole / name).read_bytes(), said


@pytest.mark.slow
@each("parts, jobs", ("2", 2), ("mpi", 1))
def test_a_job_out_of_time_is_queued_again(spin, parts, jobs):
    """The warning ends each task with its rows kept; it requeues itself, and goes on."""
    said, calls = submit(spin, spin.write(SLOW, "slow.nml"), parts, warn=True)
    assert calls.count("sbatch") == jobs, said
    assert calls.count("requeue 17" + "_1" * (parts == "2")) == 1, said
    assert "out of time; queued again" in said
    assert re.search(r"resumes after \d+ rows", said)
    assert (spin.folder / "o u t/slow.csv").read_bytes() == undisturbed(SLOW)["slow.csv"]


def test_bad_cases_do_not_touch_the_others(spin):
    """About one case in a hundred is no top or starts at a pole; each is named."""
    thetas = [10 + 0.1 * i for i in range(200)]
    inertias = [0.2 + 0.005 * i for i in range(200)]
    text = SLOW.replace("theta_deg = 20", "psi_rate = 3").replace(STEPS, "steps = 4")

    def swept(first, second, code):
        axes = ((1, "top.inertia(3)", first), (2, "initial.theta_deg", second))
        lines = [
            f"parameter({i}) = '{name}', values({i},:) = " + ",\n ".join(map(repr, values))
            for i, name, values in axes
        ]
        run = spin(text.split("&sweep")[0] + "&sweep " + "\n".join(lines) + " /\n", code=code)
        assert "internal" not in run.out
        return run.texts

    good = swept(inertias, thetas, 0)
    bad = swept([*inertias[:77], 1.8, *inertias[77:]], [*thetas[:123], 0, *thetas[123:]], 3)
    assert len(bad) == 201 * 201
    wrong = bad[bad.status != "ok"]
    cases = zip(*(wrong[name].astype(float) for name in list(bad)[1:3]), strict=True)
    expected = dict.fromkeys(((1.8, theta) for theta in [*thetas, 0]), "bad_input")
    expected |= dict.fromkeys(((inertia, 0.0) for inertia in inertias), "pole")
    assert dict(zip(cases, wrong.status, strict=True)) == expected
    assert (wrong.notes != "").all()
    left = bad[bad.status == "ok"].iloc[:, 1:].reset_index(drop=True)
    assert left.equals(good.iloc[:, 1:])


# Studies other than sweeps in parts: merged parts are the whole, apart from dates and times.

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
