"""The reference set as files: made, or checked."""

import json
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from itertools import zip_longest
from pathlib import Path

from program import ROOT, ProgramError, call
from referencing.motions import LICENCE, VERSION, Motion, MotionError, as_text

FOLDER = ROOT / "reference"


def inputs(names: Sequence[str]) -> list[Path]:
    """The inputs of motions, or of all."""
    known = {path.stem: path for path in sorted((FOLDER / "inputs").glob("*.nml"))}
    for name in names:
        if name not in known:
            raise MotionError(f"there is no input reference/inputs/{name}.nml")
    return [known[name] for name in names] or list(known.values())


def files_of(path: Path) -> dict[Path, str]:
    """The files of a motion."""
    table = FOLDER / "motions" / f"{path.stem}.csv"
    old = table.with_suffix(".json")
    stated = json.loads(old.read_text(encoding="utf-8"))["errors"] if old.exists() else {}
    motion = Motion(path, stated)
    return {old: as_text(motion.description()), table: motion.table()}


def index() -> str:
    """The list of all motions, from their files."""
    found = [
        json.loads(path.read_text(encoding="utf-8"))
        for path in sorted((FOLDER / "motions").glob("*.json"))
    ]
    motions = {
        motion["name"]: {"title": motion["title"], "attitude": motion["errors"]["attitude"]}
        for motion in found
    }
    return as_text({"version": VERSION, "licence": LICENCE, "motions": motions})


def differences(path: Path, text: str) -> Iterator[str]:
    """The first place of a file that is not so."""
    if not path.exists():
        yield f"{path.name} is missing"
        return
    old = path.read_text(encoding="utf-8").splitlines()
    for number, (a, b) in enumerate(zip_longest(old, text.splitlines()), 1):
        if a != b:
            cells = zip_longest((a or "").split(","), (b or "").split(","), fillvalue="")
            pair = next(((x, y) for x, y in cells if x != y), ("", ""))
            yield f"{path.name}:{number}: {pair[0].strip()!r}, computed {pair[1].strip()!r}"
            return


def verified(table: Path) -> Iterator[str]:
    """What `spintop verify` finds wrong in a table."""
    try:
        call("verify", table)
    except ProgramError as error:
        yield str(error)


def main(arguments: Sequence[str]) -> int:
    """Make or check; the exit code."""
    names = [word for word in arguments if word != "--check"]
    is_check = len(names) < len(arguments)
    if any(name.startswith("-") for name in names):
        print(f"scripts/make_reference: {names[0]} is not an option; --check is", file=sys.stderr)
        return 2
    wrong: list[str] = []
    try:
        paths = inputs(names)
        (FOLDER / "motions").mkdir(exist_ok=True)
        with ProcessPoolExecutor() as pool:
            for path, files in zip(paths, pool.map(files_of, paths), strict=True):
                for file, text in files.items():
                    if is_check:
                        wrong += differences(file, text)
                    else:
                        file.write_text(text, encoding="utf-8")
                    if file.suffix == ".csv":
                        wrong += verified(file)
                print(path.stem, flush=True)
    except (MotionError, ProgramError, OSError) as error:
        print(f"scripts/make_reference: {error}", file=sys.stderr)
        return 1
    known = {path.stem for path in inputs([])}
    wrong += [
        f"{path.name} has no input"
        for path in sorted((FOLDER / "motions").iterdir())
        if path.stem not in known
    ]
    if is_check:
        wrong += differences(FOLDER / "index.json", index())
    else:
        (FOLDER / "index.json").write_text(index(), encoding="utf-8")
    print(*wrong, sep="\n", file=sys.stderr, end="\n" if wrong else "")
    return 1 if wrong else 0
