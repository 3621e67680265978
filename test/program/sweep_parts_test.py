"""A sweep in parts, also as jobs of Slurm, and bad cases among good ones."""

import os
import re

import pytest

from axes_test import HYPERCUBE
from conftest import CLOSED, EXE, GOOD, ROOT, each, merge
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
    whole = spin(text, "--output=whole").path.parent
    said, calls = submit(spin, "scene.nml", parts, "--time=1")
    assert calls.count("sbatch") == jobs, said
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
