"""A sweep that nothing can lose: threads, signals, full disks, damaged files."""

import os
import random
import re
import signal
import time

import pytest

from conftest import GOOD, each, files_of, merge, netcdf_is_missing, wait_until
from slow_sweep import PATIENCE, SLOW, Sweep, undisturbed

pytestmark = pytest.mark.slow

PART, JOURNAL = "output/slow.csv.part", "output/slow.csv.journal"
HANGUP = """\
#include <signal.h>
static void nothing(int number) { (void)number; }
__attribute__((constructor)) static void begin(void) { signal(SIGHUP, nothing); }
"""
"""A library that has a handler for SIGHUP, as UCX does."""


@pytest.fixture
def slow(spin):
    return Sweep(spin)


def size_of(path):
    try:
        return path.stat().st_size
    except FileNotFoundError:
        return -1


def heed(number):
    """Prepares a process that heeds a signal, which a shell has its background jobs ignore.

    It lets the sender go first.
    """

    def prepare():
        signal.signal(number, signal.SIG_DFL)
        os.nice(19)

    return prepare


def test_any_number_of_threads_gives_the_same_bytes(slow):
    """One (the reference), two, four threads; the log has what varies."""
    undisturbed(SLOW, "--threads=1")
    for threads in ("1", "2", "4"):
        said = slow("--verbose", "--threads", threads, "-o", threads)
        slow.check(threads)
        log = slow.read(f"{threads}/slow.log").decode()
        assert log == said
        assert f" s on {threads} threads" in log
        assert re.search(r"\n  ended     20\d\d-\d\d-\d\dT\d\d:\d\d:\d\dZ on \S+\n", log)
        assert "\n  status    1000 ok" in log


def test_killed_at_many_moments(slow):
    """SIGKILL and SIGTERM, as soon as a stage of the start or a size of the part is seen."""
    sizes = random.Random(1)
    (whole,) = undisturbed(SLOW).values()
    part, journal, table = (slow.spin.folder / f for f in (PART, JOURNAL, slow.table))
    taken_over = 0
    for trial in range(14):
        before, size = max(slow.rows, 0), sizes.randrange(len(whole))
        stages = (lambda: True, part.exists, journal.exists)
        seen = stages[trial // 2 % 3] if trial % 2 else lambda size=size: size_of(part) > size
        number = (signal.SIGKILL, signal.SIGTERM)[trial // 2 % 2]
        with slow.start("--resume") as run:
            wait_until(lambda run=run, seen=seen: run.poll() is not None or seen())
            run.send_signal(number)
            code = run.wait()
        if table.exists():
            assert code in (0, -number)
            slow("--resume")
            assert table.read_bytes() == whole
            slow.clear()
        else:
            assert code == -number
            assert max(slow.rows, 0) >= before
            taken_over = max(taken_over, slow.rows)
    assert taken_over > 0
    slow("--resume")
    slow.check()


GATHERED = "&statistics columns = 'theta_end', over = 'initial.psi_rate', bins = 7 /\n"
"""Of a column that is integrated: turning points have a closed form, which takes no time."""
ALONE = "&output rows = 'none' /\n"
INDICES = (
    SLOW[: SLOW.index("&sweep")]
    + """\
&sweep combine = 'saltelli'  cases = 1000
       parameter(1) = 'initial.psi_rate'  from(1) = 1  to(1) = 100
       parameter(2) = 'initial.phi_rate'  from(2) = 0  to(2) = 1
       parameter(3) = 'top.gravity'  from(3) = 9  to(3) = 10 /
&statistics columns = 'theta_max', 'theta_end'  indices = 'sobol' /
"""
)
NETCDF = "output.format=netcdf"


@each(
    "text, table, settings",
    (SLOW, "slow.csv", []),
    (SLOW + GATHERED, "slow.csv", []),
    (SLOW.replace("= 1000", "= 5000") + GATHERED + ALONE, "slow.statistics.csv", []),
    (INDICES, "slow.csv", []),
    (INDICES + ALONE, "slow.statistics.csv", []),
    (SLOW, "slow.nc", [NETCDF]),
    (SLOW, "slow.nc", [NETCDF, "output.compression=5"]),
    (SLOW + GATHERED, "slow.nc", [NETCDF]),
)
def test_killed_and_resumed(spin, text, table, settings):
    """Killed again and again, it has the bytes of a run that nothing stopped, and says so."""
    if settings and (reason := netcdf_is_missing(*settings[1:])):
        pytest.skip(reason)
    words = (f"--set={setting}" for setting in settings)
    slow = Sweep(spin, text, *words, table=f"output/{table}")
    for _ in range(1 if text.endswith(ALONE) else 3):  # statistics alone are seldom journalled
        rows = max(slow.rows, 0)
        slow.interrupt("--resume", rows=rows + 1)
        assert slow.rows > rows
    rows = slow.rows
    said = slow("--resume", "--progress")
    assert said.count(f"resumes after {rows} rows of an interrupted run") == 2
    assert re.search(r"  status    [15]000 ok", said)
    slow.check()
    before = (spin.folder / slow.table).stat()
    spin.write("of a run that was killed while it renamed its log", "output/slow.log.new")
    assert "nothing was computed: the table is already complete" in slow("--resume")
    assert (spin.folder / slow.table).stat() == before
    slow.check()


def test_nothing_to_resume(slow):
    for _ in range(2):
        said = slow("--resume")
        assert "nothing to resume: the run starts from the beginning" in said
        slow.check()
        (slow.spin.folder / slow.table).rename(slow.spin.folder / PART)


def test_failed_cases_of_an_earlier_run_count(spin):
    axis = "count(1) = 200, parameter(2) = 'initial.theta_deg', values(2,:) = 0, 20, 30, 40, 50"
    slow = Sweep(spin, SLOW.replace("theta_deg = 20", "").replace("count(1) = 1000", axis))
    slow.interrupt()
    said = slow("--resume", "--verbose", code=3)
    assert "  status    800 ok" in said
    assert "  status    200 pole" in said


def test_nothing_is_discarded_unasked(slow):
    """An interrupted run is an error that names the rows and both options; nothing runs."""
    slow.interrupt()
    spin, rows, kept = slow.spin, slow.rows, (slow.read(PART), slow.read(JOURNAL))
    for words in ([], [spin.write(GOOD)], ["--set", "top.mass=2"]):
        said = slow(*words, code=2)
        for part in (f"output/slow.csv is there: {rows} rows are kept", "--resume", "--restart"):
            assert part in said
        assert "output/scene.csv" not in spin.produced()
    # Nor by a table of another kind under the same name.
    spin.refuse(GOOD, "output.file=slow.csv")
    assert "--resume and --restart exclude each other" in slow("--resume", "--restart", code=2)
    assert (slow.read(PART), slow.read(JOURNAL)) == kept
    slow("--check")
    assert f"discards an interrupted run of {rows} rows" in slow("--restart")
    slow.check()


def test_a_merge_does_not_discard_an_interrupted_run(slow):
    for shard in ("1/2", "2/2"):
        slow("--shard", shard)
    names = slow.table, *(f"output/slow.{i}-of-2.csv" for i in (1, 2))
    slow.interrupt()
    part = slow.read(PART)
    assert "rows are kept" in merge(slow.spin, *names, code=2)
    assert slow.read(PART) == part
    slow("--resume")
    merge(slow.spin, *names)
    assert slow.read(slow.table) == undisturbed(SLOW)["slow.csv"]


def test_restart_takes_the_place_of_any_kind_of_run(slow):
    slow.interrupt()
    slow.spin(GOOD, "output.file=slow.csv", "--restart")
    assert slow.rows == -1
    slow()
    slow.check()


def test_a_signal_says_what_is_kept_and_how_to_resume(slow):
    """Ctrl-C, and the signals of batch systems; the printed command completes the table."""
    place, rows = "it's here", 0
    slow.table = f"{place}/slow.csv"
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        for _ in range(25):
            before, options = rows, {"by": number, "preexec_fn": heed(number)}
            code, said = slow.interrupt("-o", place, "--resume", rows=rows + 1, **options)
            if code:
                break
            # The disk took so long for the entry that the run was over: once more, from the start.
            slow.clear(place)
            rows = 0
        assert code == -number
        rows = slow.rows
        first, second = said.splitlines()
        pattern = r"spintop: interrupted: (\d+) of 1000 rows of it's here/slow.csv are kept"
        # The last entry may be on the disk, and its rows not yet counted.
        assert before <= int(re.match(pattern, first)[1]) <= rows
    assert second.startswith("to resume: ")
    command = second.removeprefix("to resume: ")
    assert f"resumes after {rows} rows" in slow.spin.call("-c", command, command=("sh",)).out
    slow.check(place)


@each("threads", "1", "2")
def test_a_signal_in_the_midst_of_long_cases(spin, threads):
    """What was computed before is kept at once, although the next cases would take hours."""
    quick, slow = ", ".join(map(str, range(10, 26))), ", ".join(["1000000000"] * 16)
    text = SLOW.split("&integration")[0] + (
        "&output columns = 'theta_end' /\n&integration method = 'rk4', max_steps = 2000000000 /\n"
        f"&sweep parameter = 'integration.steps', values(1,:) = {quick}, {slow} /\n"
    )
    long = Sweep(spin, text)

    def stop(number, wait):
        """Start it, wait when it has begun its table, send a signal; what it said."""
        long.clear()
        how = {"preexec_fn": lambda: signal.signal(number, signal.SIG_DFL)}
        with spin.start(long.name, "--threads", threads, **how) as run:
            wait_until((spin.folder / PART).exists)
            wait(run)
            run.send_signal(number)
            said = run.communicate(timeout=PATIENCE)[1]
        assert run.returncode == -number
        return said

    # Without a signal the journal has them, too, after a while.
    said = stop(signal.SIGTERM, lambda run: long.wait(run, 16))
    assert "interrupted: 16 of 32 rows of output/slow.csv are kept" in said
    for _ in range(25):
        said = stop(signal.SIGINT, lambda run: time.sleep(0.04))
        if said:
            break  # else it came before the run waited for signals
    kept = f"{long.rows} of 32 rows" if long.rows >= 0 else "nothing is kept"
    assert f"interrupted: {kept}" in said


def test_a_handler_of_a_library_does_not_keep_a_signal(slow, preload):
    options = {"environment": preload(HANGUP), "preexec_fn": heed(signal.SIGHUP)}
    code, said = slow.interrupt(by=signal.SIGHUP, **options)
    assert code == -signal.SIGHUP, said
    assert "spintop: interrupted: " in said


def test_a_signal_that_is_ignored_stays_so(slow):
    ignore = {"preexec_fn": lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN)}
    code, said = slow.interrupt(by=signal.SIGHUP, **ignore)
    assert code == 0, said
    slow.check()


def test_damage_and_strangers_are_refused(slow):
    """With the reason, exit code 2, and all as it was."""
    slow.interrupt()
    part, journal = slow.read(PART), slow.read(JOURNAL)
    length = int(journal.split(b"\n")[1].split()[1])
    middle, revision = length - 100, part.index(b"# revision: ") + len(b"# revision: ")
    files = slow.spin.folder / PART, slow.spin.folder / JOURNAL
    for new_part, new_journal, settings, reason in (
        (part[:middle], journal, [], "shorter than its journal records"),
        (part[:middle] + b"~" + part[middle + 1 :], journal, [], "changed after it was"),
        (part[:revision] + b"~" + part[revision + 1 :], journal, [], "revision: ~"),
        (part, journal.replace(b"bytes: ", b"bytes: 1"), [], "journal is damaged"),
        (part, journal[:-5], [], "journal is damaged"),
        (part, b"", [], "journal is damaged"),
        (part, journal + b"   ", [], "journal is damaged"),
        (part, journal + b"\nrows: 1", [], "journal is damaged"),
        (part, journal, ["--set", "top.mass=2"], "here: mass = 2"),
    ):
        files[0].write_bytes(new_part)
        files[1].write_bytes(new_journal)
        said = slow("--resume", *settings, code=2)
        assert reason in said
        assert "--restart discards it" in said
        assert (slow.read(PART), slow.read(JOURNAL)) == (new_part, new_journal)
    # What lies behind the journalled bytes may be anything: a power cut leaves zeros, say.
    for rest in (bytes(5000), b" " * 5000, b"1000,0.5"):
        (slow.spin.folder / slow.table).unlink(missing_ok=True)
        files[0].write_bytes(part[:length] + rest)
        files[1].write_bytes(journal)
        assert "resumes after" in slow("--resume")
        slow.check()
    assert "here: mass = 2" in slow("--resume", "--set", "top.mass=2", code=2)
    slow.check()


def test_two_runs_at_once(slow):
    with slow.start() as first:
        slow.wait(first, 0)
        for words in ([], ["--resume"]):
            assert "another run is writing it" in slow(*words, code=4)
        assert first.wait() == 0
    slow.check()


def test_a_file_that_may_not_grow(slow):
    said = slow(code=4, preexec_fn=files_of(200_000))
    assert "slow.csv.part: File too large" in said
    assert len(slow.read(PART)) == 200_000
    assert slow.rows > -1
    slow("--resume")
    slow.check()


def test_a_folder_removed_meanwhile(slow):
    with slow.start() as run:
        slow.wait(run, 0)
        slow.clear()
        said = run.communicate(timeout=PATIENCE)[1]
    assert run.returncode == 4, said
    assert "output/slow.csv" in said
    assert "is kept" not in said


def test_folders_that_cannot_be_written(slow):
    slow("-o", "/proc/spintop", code=4)
    (slow.spin.folder / "output/slow.csv.journal.new").mkdir(parents=True)
    said = slow(code=4)
    # No case was computed: there is no part that a later run could resume.
    assert "are kept" not in said
    assert "slow.csv.journal.new" in said
    assert slow.spin.produced() == {"output", "output/slow.csv.journal.new"}
    if os.geteuid() != 0:
        (slow.spin.folder / "locked").mkdir(mode=0o500)
        slow("-o", "locked", code=4)
