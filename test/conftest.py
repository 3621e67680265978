"""Shared by the Python suites: the one way to run the program, scratch folders, and their counts.

A test with the argument `spin` runs an input with `spin(TEXT, "group.key=value", "--option")`.
"""

import contextlib
import io
import json
import os
import re
import resource
import shutil
import subprocess
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from unittest import mock

import numpy as np
import pandas as pd
import pytest

ROOT = Path(__file__).resolve().parent.parent

pytest_plugins = ["fortran_suites"]

# scripts/test names the program to test; a bare pytest takes the release build.
EXE = Path(os.environ.setdefault("SPINTOP_EXE", str(ROOT / "build/release/spintop"))).resolve()
KIND = os.environ.get("SPINTOP_TEST_KIND", "release")
MISSING = "this build has no FLINT"
"""What builds without FLINT say where they are asked for proofs."""

MPI_EXE = os.environ.get("SPINTOP_MPI_EXE", str(ROOT / "build/mpi/spintop"))
MPI = {
    **dict.fromkeys(("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"), "1"),
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_hwloc_base_binding_policy": "none",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
    "PRTE_MCA_hwloc_default_binding_policy": "none",
}
"""By default Open MPI starts nothing as root, and no more ranks than cores."""
needs_mpi = pytest.mark.skipif(
    not (shutil.which("mpirun") and Path(MPI_EXE).is_file()),
    reason="no MPI: scripts/setup --mpi installs and builds what it takes",
)


def each(names: str, *rows: object, **options: object) -> pytest.MarkDecorator:
    """Marks a test that has these arguments, and that runs once with each row of their values."""
    return pytest.mark.parametrize(names, rows, **options)


def under(ranks: int) -> tuple[str, ...]:
    """The command that starts so many ranks."""
    return ("mpirun", "-np", str(ranks), MPI_EXE)


GOOD = """\
&top
    mass = 1.0
    inertia = 0.875, 0.875, 0.25
    length = 0.8660254037844387
/
&initial
    theta = 0.19634954084936207
    psi_rate = 1.0
/
&span
    t_end = 0.5
/
&integration
    formulation = 'lagrange'
    method = 'rk4'
    steps = 10
/
&output
    columns = 't', 'theta', 'R4'
/
"""
"""An input for suites that need any; they replace parts of it."""
CLOSED = GOOD[: GOOD.index("&integration")]
"""Its body, start and span: a motion in closed form."""


def quoted(names: Iterable[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)


def output(*names: str) -> str:
    """The group that names the columns of a table."""
    return f"&output columns = {quoted(names)} /\n"


def largest(numbers: Iterable[float]) -> float:
    """The largest size of numbers; nan if one is nan."""
    return float(np.abs(np.asarray(numbers, dtype=float)).max())


def read(path: Path, **options: object) -> pd.DataFrame:
    """The rows of a table to their last digit: numbers are floats or integers, words are texts."""
    options = {"na_values": ["nan"]} | options
    return pd.read_csv(path, comment="#", keep_default_na=False, **options)


def texts(path: Path) -> pd.DataFrame:
    """The rows of a table as they stand there."""
    return read(path, dtype=str, na_values=[])


@dataclass(frozen=True)
class Run:
    """What a run gave: its exit code, what it said, and its tables."""

    code: int
    out: str
    stderr: str
    path: Path

    @property
    def err(self) -> str:
        """What was said on standard error, in one line."""
        return " ".join(self.stderr.split())

    def table(self, kind: str = "") -> pd.DataFrame:
        """The table of the input, or one beside it: events, residuals, statistics ..."""
        return read(self.path.with_name(f"{self.path.stem}{kind and '.'}{kind}.csv"))

    @property
    def rows(self) -> pd.DataFrame:
        return self.table()

    @property
    def texts(self) -> pd.DataFrame:
        """The same, as they stand there."""
        return texts(self.path)

    @property
    def comments(self) -> list[str]:
        """The comments of the table, from its header to its end."""
        lines = self.path.read_text(encoding="utf-8").splitlines()
        return [line[2:] for line in lines if line.startswith("#")]

    @property
    def head(self) -> str:
        """The resolved input in the header of the table."""
        lines = self.comments
        begin, end = lines.index("input:") + 1, lines.index("columns:")
        return "\n".join(lines[begin:end]) + "\n"

    @property
    def status(self) -> str:
        """The status at the end of a trajectory, with its time unless it is ok."""
        return self.comments[-2].removeprefix("status: ")


def execute(
    *words: object,
    code: int | tuple[int, ...] | None = 0,
    environment: dict[str, str] | None = None,
    **options: object,
) -> subprocess.CompletedProcess[str]:
    """Run a command, whose exit code is `code` or one of them, or any if that is None."""
    given = {"env": os.environ | (environment or {}), "text": True} | options
    done = subprocess.run(list(map(str, words)), capture_output=True, check=False, **given)
    wanted = code if isinstance(code, tuple) else (code,)
    assert code is None or done.returncode in wanted, (words, done.stdout + done.stderr)
    return done


def called(main: Callable[[], int], *words: object) -> tuple[int, str, str]:
    """What the main procedure of a script answers: its code, and what it prints and complains."""
    printed, complaints = io.TextIOWrapper(io.BytesIO(), encoding="utf-8"), io.StringIO()
    with (
        mock.patch("sys.argv", list(map(str, words))),
        contextlib.redirect_stdout(printed),
        contextlib.redirect_stderr(complaints),
    ):
        try:
            code = main()
        except SystemExit as end:
            code = end.code
    printed.seek(0)
    return code, printed.read(), complaints.getvalue()


class Spin:
    """Runs the program in a folder, which has its tables in the folder `output`."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def write(self, text: str | bytes, name: str = "scene.nml") -> str:
        """Write a file; return its name."""
        data = text if isinstance(text, bytes) else text.encode()
        (self.folder / name).write_bytes(data)
        return name

    def call(
        self,
        *words: str | Path,
        code: int | tuple[int, ...] = 0,
        path: str = "output/scene.csv",
        command: tuple[str | Path, ...] = (EXE,),
        environment: dict[str, str] | None = None,
        **options: object,
    ) -> Run:
        """Call the program, whose exit code is `code` or one of them, and whose table is `path`."""
        given = {"code": code, "environment": environment, "cwd": self.folder} | options
        done = execute(*command, *words, **given)
        return Run(done.returncode, done.stdout, done.stderr, self.folder / path)

    def __call__(
        self,
        given: str | Path,
        *words: str,
        code: int | tuple[int, ...] = 0,
        name: str = "scene",
        environment: dict[str, str] | None = None,
        **files: str,
    ) -> Run:
        """Run a text, a file .nml, or an input of the folder `input`, with settings and options.

        An option has its value behind "=". Tables are written beside the text: FILE.csv for each
        `FILE=TEXT`.
        """
        scene = given
        if isinstance(given, str) and not given.endswith(".nml"):
            is_text = "&" in given or "\n" in given or not given
            scene = self.write(given, f"{name}.nml") if is_text else ROOT / f"input/{given}.nml"
        for file, text in files.items():
            self.write(text, f"{file}.csv")
        options = [word if word.startswith("-") else f"--set={word}" for word in words]
        folders = [word for word in words if word.startswith("--output=")]
        folder = folders[-1].removeprefix("--output=") if folders else "output"
        path = f"{folder}/{Path(scene).stem}.csv"
        return self.call(scene, *options, code=code, path=path, environment=environment)

    @contextlib.contextmanager
    def start(
        self,
        *words: str | Path,
        command: tuple[str | Path, ...] = (EXE,),
        environment: dict[str, str] | None = None,
        **options: object,
    ) -> Iterator[subprocess.Popen[str]]:
        """Start the program, and do not wait for it; at the end it is killed."""
        with subprocess.Popen(
            [*command, *words],
            cwd=self.folder,
            env=os.environ | (environment or {}),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            **options,
        ) as run:
            try:
                yield run
            finally:
                run.kill()

    def journalled(self, table: str) -> int:
        """The rows that the journal of a table has; -1 if there is no journal."""
        try:
            lines = (self.folder / f"{table}.journal").read_text(encoding="ascii").splitlines()
        except FileNotFoundError:
            return -1
        return next(sum(map(int, line.split()[1:])) for line in lines if line.startswith("rows: "))

    def produced(self) -> set[str]:
        """All files and folders but inputs."""
        paths = self.folder.rglob("*")
        return {str(p.relative_to(self.folder)) for p in paths if p.suffix != ".nml"}

    def parts(
        self, given: str | Path, count: int, *words: str, ending: str = "csv", **options: object
    ) -> list[str]:
        """Compute a study in so many parts; the names of their tables."""
        for part in range(1, count + 1):
            path = self(given, *words, f"--shard={part}/{count}", **options).path
        stem = path.relative_to(self.folder).with_suffix("")
        return [f"{stem}.{part}-of-{count}.{ending}" for part in range(1, count + 1)]

    def refuse(self, given: str | Path, *words: str, **files: str) -> str:
        """What is said of an input that is refused, for which nothing is made or printed."""
        before = self.produced() | {f"{file}.csv" for file in files}
        run = self(given, *words, code=2, **files)
        assert run.out == ""
        assert self.produced() == before
        return run.stderr

    def listed(self, topic: str) -> list[dict]:
        """The entries of a list of the program."""
        return json.loads(self.call("list", topic, "--json").out)[topic]


@pytest.fixture
def spin(folder: Path) -> Spin:
    """The program in a new folder."""
    return Spin(folder)


def merge(spin: Spin, *names: str, code: int = 0) -> str:
    """Merge parts of a study into the first of these tables; what is said of it."""
    run = spin.call("merge", *names, code=code)
    return run.out + run.stderr


@cache
def netcdf_is_missing(*settings: str) -> str:
    """Why this build writes no NetCDF with these settings, or nothing."""
    words = (f"--set={setting}" for setting in ("output.format=netcdf", *settings))
    said = Spin(ROOT).call("--check", "input/slow_top.nml", *words, code=(0, 2)).stderr
    return "no NetCDF" if re.search("has no NetCDF|no format NetCDF-4", said) else ""


needs_netcdf = pytest.mark.skipif(netcdf_is_missing() != "", reason=netcdf_is_missing() or "-")


def files_of(size: int) -> Callable[[], None]:
    """Prepares a process whose files may have so many bytes."""

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

    return limit


@pytest.fixture
def disk(spin: Spin) -> Iterator[Callable[[str], Path]]:
    """The folder `disk`, which is a disk of the size that is asked for; a later size changes it."""
    path = spin.folder / "disk"
    path.mkdir()

    def resize(size: str) -> Path:
        new = ("-t", "tmpfs", "-o", f"size={size}", "none")
        how = ("-o", f"remount,size={size}") if path.is_mount() else new
        if os.geteuid() or subprocess.run(["mount", *how, path], capture_output=True).returncode:
            pytest.skip("takes root")
        return path

    yield resize
    if path.is_mount():
        subprocess.run(["umount", path], check=True)


@pytest.fixture(scope="session")
def preload(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], dict[str, str]]:
    """Makes a library of a source in C; gives the environment that loads it with a program."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler is found")
    folder = tmp_path_factory.mktemp("libraries")

    @cache
    def build(source: str) -> dict[str, str]:
        library = folder / f"{len(list(folder.iterdir()))}.so"
        command = [compiler, "-O1", "-shared", "-fPIC", "-o", library, "-x", "c", "-", "-ldl"]
        subprocess.run(command, input=source, text=True, check=True)
        return {"LD_PRELOAD": str(library)}

    return build


def wait_until(seen: Callable[[], bool], limit: float = 300) -> None:
    """Wait until something is seen, which fails after a limit (s)."""
    deadline = time.monotonic() + limit
    while not seen():
        assert time.monotonic() < deadline
        time.sleep(0.005)


def listed(topic: str) -> list[dict]:
    return Spin(ROOT).listed(topic)


@pytest.fixture
def folder(request: pytest.FixtureRequest) -> Iterator[Path]:
    """A new folder that is removed afterwards; its path has a space.

    A class with `@pytest.mark.usefixtures("folder")` has it as `self.folder`, also in `setUp`.
    """
    with tempfile.TemporaryDirectory(prefix="spintop test ") as name:
        if request.instance is not None:
            request.instance.folder = Path(name)
        yield Path(name)


class Counts:
    """Counts each test once, as passed or failed; what cannot be collected is a failed test.

    It keeps how long each file took at most, by which the next run has its order.
    """

    def pytest_configure_node(self, node: object) -> None:
        """Tell a process how long the files took in earlier runs."""
        node.workerinput["times"] = node.config.cache.get("spintop/times", {})

    def pytest_report_teststatus(
        self, report: pytest.CollectReport | pytest.TestReport
    ) -> tuple[str, str, str] | None:
        """Show failures only."""
        return None if report.failed else ("", "", "")

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_sessionfinish(self, session: pytest.Session) -> Generator[None]:
        """Print the counts, after all else, and why tests were left out."""
        yield
        config = session.config
        kept = config.pluginmanager.get_plugin("terminalreporter").stats.values()
        known = pytest.CollectReport, pytest.TestReport  # of phases of tests, and of subtests
        reports = [report for part in kept for report in part if isinstance(report, known)]
        failed = {report.nodeid for report in reports if report.failed}
        passed = {report.nodeid for report in reports if report.passed and report.when == "call"}
        left_out = [
            each.longrepr for each in reports if each.skipped and not hasattr(each, "wasxfail")
        ]
        times = Counter(config.cache.get("spintop/times", {}))
        taken: Counter[str] = Counter()
        for report in reports:
            taken[report.nodeid.partition("::")[0]] += getattr(report, "duration", 0)
        config.cache.set("spintop/times", times | taken)
        if session.exitstatus == pytest.ExitCode.NO_TESTS_COLLECTED and left_out:
            session.exitstatus = pytest.ExitCode.OK
        terminal = config.get_terminal_writer()
        for text in dict.fromkeys(
            str(why[2] if isinstance(why, tuple) else why) for why in left_out
        ):
            terminal.line(f"  left out: {text.removeprefix('Skipped: ')}")
        terminal.line(f"{len(passed - failed)} passed, {len(failed)} failed", flush=True)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--counts", action="store_true", help='end with "N passed, N failed"')


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """The files that took longest come first, so that in the end no processor waits for them.

    Of others those with slow tests come first.
    """
    if not hasattr(config, "workerinput"):
        return
    times: dict[Path, float] = {}
    for item in items:
        known = config.workerinput.get("times", {}).get(item.nodeid.partition("::")[0])
        guess = 60.0 if item.get_closest_marker("slow") else 0.0
        times[item.path] = max(times.get(item.path, 0.0), guess if known is None else known)
    items.sort(key=lambda item: -times[item.path])


def pytest_configure(config: pytest.Config) -> None:
    """Count, if asked to; what runs in several processes is counted in the first."""
    if config.getoption("counts") and not hasattr(config, "workerinput"):
        config.pluginmanager.register(Counts(), "spintop-counts")
