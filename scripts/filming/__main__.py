"""Film a trajectory for a lecture: MP4, WebM or GIF, drawn without a browser or a window."""

import argparse
import multiprocessing
import os
import re
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from filming.encode import check_means, write
from filming.picture import NAMES, Camera
from filming.take import FilmError, Take, compute
from spintop_figures.files import show_path
from spintop_figures.tables.characters import printable

SIZES = {".gif": (640, 360)}
SIZE = (1280, 720)
RATES = {".gif": 20}
RATE = 30
SECONDS = 12.0
MOST_SECONDS, MOST_PIXELS = 3600.0, 4096
cameras: list[Camera] = []
"""What a child draws with; it inherits it."""


def size_of(text: str) -> tuple[int, int]:
    """Width and height: even numbers, as films have them."""
    match = re.fullmatch(r"(\d+)x(\d+)", text)
    size = tuple(int(x) for x in match.groups()) if match else (0, 0)
    if not all(0 < x <= MOST_PIXELS and x % 2 == 0 for x in size):
        raise argparse.ArgumentTypeError(
            f"{text!r} is no size such as 1280x720: two even numbers up to {MOST_PIXELS}"
        )
    return size


def seconds_of(text: str) -> float:
    """How long a film is, s."""
    try:
        seconds = float(text)
    except ValueError:
        seconds = 0.0
    if not 0 < seconds <= MOST_SECONDS:
        raise argparse.ArgumentTypeError(f"{text!r} is no duration up to {MOST_SECONDS:g} s")
    return seconds


def parse_arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        prog="scripts/film",
        description=__doc__,
        epilog="exit codes: 0 all is well; 2 wrong usage, or an input that is no trajectory;\n"
        "4 the film could not be made or written; else that of the program",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add(
        "input",
        metavar="INPUT",
        type=Path,
        help="an input (.nml), or a table, whose input is run again",
    )
    add(
        "-o",
        "--output",
        metavar="FILE",
        type=Path,
        help="the film: .mp4, .webm or .gif (default: output/NAME.mp4)",
    )
    add(
        "--seconds",
        type=seconds_of,
        default=SECONDS,
        help=f"how long the film is; it shows the whole span (default: {SECONDS:g})",
    )
    add(
        "--rate",
        type=int,
        choices=range(1, 61),
        metavar="N",
        help=f"pictures a second (default: {RATE}; GIF: {RATES['.gif']})",
    )
    add("--size", type=size_of, metavar="WxH", help="pixels (default: 1280x720; GIF: 640x360)")
    add(
        "--arrow",
        action="append",
        choices=list(NAMES),
        default=[],
        dest="arrows",
        help="draw this vector too (repeatable)",
    )
    add("--dark", action="store_true", help="light on dark, for a projector")
    return parser.parse_args()


def shoot(picture: int) -> bytes:
    """Draw a picture, in a child."""
    return cameras[0].shoot(picture)


def shoot_all(take: Take, size: tuple[int, int], arguments: argparse.Namespace) -> Iterator[bytes]:
    """All pictures in their order, drawn on as many processors as there are."""
    camera = Camera(take, size, list(dict.fromkeys(arguments.arrows)), arguments.dark)
    cameras[:] = [camera]
    total, workers = len(take.rows), os.cpu_count() or 1
    if workers < 2 or "fork" not in multiprocessing.get_all_start_methods():
        yield from told(map(shoot, range(total)), total)
        return
    sys.stdout.flush()
    context = multiprocessing.get_context("fork")
    with ProcessPoolExecutor(workers, context) as pool:
        # A few at a time: pictures that wait for the encoder take memory.
        batch = 8 * workers
        parts = (range(i, min(i + batch, total)) for i in range(0, total, batch))
        yield from told((picture for part in parts for picture in pool.map(shoot, part)), total)


def told(pictures: Iterator[bytes], total: int) -> Iterator[bytes]:
    """The pictures; the terminal tells how many there are."""
    for i, picture in enumerate(pictures, start=1):
        if sys.stderr.isatty():
            end = "\n" if i == total else ""
            print(f"\rpicture {i} of {total}", end=end, file=sys.stderr, flush=True)
        yield picture


def main() -> int:
    """Make the film."""
    arguments = parse_arguments()
    output = arguments.output or Path("output") / f"{arguments.input.stem}.mp4"
    rate = arguments.rate or RATES.get(output.suffix, RATE)
    size = arguments.size or SIZES.get(output.suffix, SIZE)
    try:
        check_means(output)
        if not arguments.input.is_file():
            raise FilmError(f"{arguments.input}: no such file")
        take = compute(arguments.input, max(2, round(arguments.seconds * rate)))
        write(output, shoot_all(take, size, arguments), size, rate)
    except FilmError as error:
        print(f"scripts/film: {printable(str(error))}", file=sys.stderr)
        return error.code
    show_path(output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
