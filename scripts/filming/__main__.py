"""Film a trajectory for a lecture: MP4, WebM or GIF, drawn without a browser or a window."""

import argparse
import math
import re
import sys
from collections.abc import Callable
from pathlib import Path

from filming.encode import check_means, write
from filming.picture import Camera
from filming.stage import NAMES, View
from filming.take import FilmError, Part, Take, compute, span_of
from spintop_figures.files import show_path
from spintop_figures.style.numbers import speak
from spintop_figures.tables.table import printable
from spintop_figures.tables.words import LANGUAGES

SIZES = {".gif": (640, 360)}
SIZE = (1280, 720)
RATES = {".gif": 20}
RATE = 30
SECONDS = 12.0
LEAST_SECONDS, MOST_SECONDS, MOST_PIXELS = 1e-3, 3600.0, 4096
MOST_TIME = 1e12
SPEEDS = (1e-9, 1e9)


def size_of(text: str) -> tuple[int, int]:
    """Width and height: even numbers, as films have them."""
    match = re.fullmatch(r"(\d+)x(\d+)", text)
    size = tuple(int(x) for x in match.groups()) if match else (0, 0)
    if not all(0 < x <= MOST_PIXELS and x % 2 == 0 for x in size):
        raise argparse.ArgumentTypeError(
            f"{text!r} is no size such as 1280x720: two even numbers up to {MOST_PIXELS}"
        )
    return size


def number_of(what: str, least: float, most: float) -> Callable[[str], float]:
    """What reads a number within these bounds from the command line."""

    def read(text: str) -> float:
        try:
            number = float(text)
        except ValueError:
            number = math.nan
        if not least <= number <= most:
            raise argparse.ArgumentTypeError(f"{text!r} is no {what} from {least:g} to {most:g}")
        return number

    return read


def parse_arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        prog="scripts/film",
        description=__doc__,
        epilog="exit codes: 0 all is well; 2 wrong usage, or an input that is no trajectory;\n"
        "4 the film could not be made or written; else that of the program",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    time = number_of("time, s,", 0.0, MOST_TIME)
    add = parser.add_argument
    add("input", metavar="INPUT", type=Path,
        help="an input (.nml), or a table, whose input is run again")  # fmt: skip
    add("second", metavar="SECOND", type=Path, nargs="?",
        help="a second motion, beside the first at the same times")  # fmt: skip
    add("--ghost", action="store_true", help="draw the second motion as a ghost of the first")
    add("-o", "--output", metavar="FILE", type=Path,
        help="the film: .mp4, .webm or .gif (default: output/NAME.mp4)")  # fmt: skip
    add("--from", type=time, default=0.0, dest="start", metavar="T", help="begin at this time, s")
    add("--to", type=time, dest="end", metavar="T", help="end at this time, s")
    add_length = parser.add_mutually_exclusive_group().add_argument
    add_length("--seconds", type=number_of("duration", LEAST_SECONDS, MOST_SECONDS),
               default=SECONDS, help=f"how long the film is (default: {SECONDS:g})")  # fmt: skip
    add_length("--speed", type=number_of("speed", *SPEEDS), metavar="X",
               help="seconds of motion per second of the film, below 1 slow motion; instead of "
               "--seconds")  # fmt: skip
    add("--rate", type=int, choices=range(1, 61), metavar="N",
        help=f"pictures a second (default: {RATE}; GIF: {RATES['.gif']})")  # fmt: skip
    add("--size", type=size_of, metavar="WxH", help="pixels (default: 1280x720; GIF: 640x360)")
    add("--arrow", action="append", choices=list(NAMES), default=[], dest="arrows",
        help="draw this vector too (repeatable)")  # fmt: skip
    for name, most, what in (
        ("azimuth", 360, "where the eye is, about the vertical from x towards y"),
        ("elevation", 90, "how high it is over the horizon; 90 is from above"),
    ):
        default = getattr(View, name)
        add(f"--{name}", type=number_of("angle", -most, most), default=default, metavar="DEG",
            help=f"{what} (default: {default:g})")  # fmt: skip
    add("--language", choices=LANGUAGES, default="en", help="of the words in the film (en)")
    add("--dark", action="store_true", help="light on dark, for a projector")
    arguments = parser.parse_args()
    if arguments.ghost and not arguments.second:
        parser.error("--ghost takes a second motion: INPUT SECOND --ghost")
    return arguments


def part_of(arguments: argparse.Namespace, sources: list[Path]) -> list[Part]:
    """The part of each motion that is filmed: of two, as long as both last."""
    spans = [span_of(source) for source in sources]
    end = min(spans) if arguments.end is None else arguments.end
    for source, span in zip(sources, spans, strict=True):
        if not arguments.start < end <= span:
            raise FilmError(
                f"{source}: the motion lasts from 0 to {span:g} s, which has no part from "
                f"{arguments.start:g} to {end:g} s: see --from and --to"
            )
    return [Part(arguments.start, end, span / (end - arguments.start)) for span in spans]


def make_takes(arguments: argparse.Namespace, rate: int) -> tuple[list[Take], float]:
    """The motions of a film, and how long it is, s."""
    sources = list(filter(None, (arguments.input, arguments.second)))
    parts: list[Part | None] = [None]
    seconds = arguments.seconds
    if arguments.start or arguments.end or arguments.speed or arguments.second:
        parts = part_of(arguments, sources)
    if arguments.speed:
        seconds = (parts[0].end - parts[0].start) / arguments.speed
        if seconds > MOST_SECONDS:
            raise FilmError(f"a film of {seconds:.4g} s is longer than {MOST_SECONDS:g} s: --speed")
    pictures = max(2, round(seconds * rate))
    return [compute(*pair) for pair in zip(sources, [pictures] * 2, parts, strict=False)], seconds


def main() -> int:
    """Make the film."""
    arguments = parse_arguments()
    speak(arguments.language)
    output = arguments.output or Path("output") / f"{arguments.input.stem}.mp4"
    rate = arguments.rate or RATES.get(output.suffix, RATE)
    size = arguments.size or SIZES.get(output.suffix, SIZE)
    try:
        check_means(output)
        takes, seconds = make_takes(arguments, rate)
        camera = Camera(
            takes, size, list(dict.fromkeys(arguments.arrows)), arguments.dark,
            is_ghost=arguments.ghost, view=View(arguments.azimuth, arguments.elevation),
            speed=(takes[0].times[-1] - takes[0].times[0]) / seconds,
        )  # fmt: skip
        write(output, camera, rate)
    except FilmError as error:
        print(f"scripts/film: {printable(str(error))}", file=sys.stderr)
        return error.code
    show_path(output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
