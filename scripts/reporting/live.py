"""Pages without a study: the live top, and the viewer in which Python puts a motion."""

import argparse
import sys
from pathlib import Path
from typing import NamedTuple

from markupsafe import Markup

from reporting.bundle import bundle, styles
from reporting.packages import PAGE, PackageError
from reporting.page import new_environment, policy, write_page
from spintop_figures.files import show_path
from spintop_figures.tables.characters import printable

EXIT_INPUT, EXIT_OUTPUT = 2, 4


class Alone(NamedTuple):
    """A page with its script and style in one file."""

    template: str
    script: str
    output: Path
    """Where it is written if no file is named."""
    description: str


PAGES = {
    "--live": Alone(
        "live.html",
        "live_main.js",
        Path("output/live.html"),
        "Make one HTML page in which a top answers to sliders at once. Its motion is\n"
        "computed in the page; it needs no other file and no network.",
    ),
    "--viewer": Alone(
        "viewer.html",
        "main.js",
        Path("output/viewer.html"),
        "Make the page in which the Python package shows a motion: the viewer of a report,\n"
        "with places for the data.",
    ),
}


def make_alone(option: str) -> str:
    """A page; raises a PackageError if what it is made with is not to be had."""
    page = PAGES[option]
    script, style = bundle(PAGE / page.script), styles()
    return (
        new_environment()
        .get_template(page.template)
        .render(policy=policy(style, script), style=Markup(style), script=Markup(script))
    )


def parse_arguments(option: str, words: list[str]) -> argparse.Namespace:
    """Read the command line of `scripts/report OPTION`."""
    page = PAGES[option]
    parser = argparse.ArgumentParser(
        prog=f"scripts/report {option}",
        description=page.description,
        epilog="exit codes: 0 all is well; 2 wrong usage; 4 the page could not be made or written",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(option, action="store_true", help=argparse.SUPPRESS)
    parser.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        type=Path,
        default=page.output,
        help=f"the page (default: {page.output})",
    )
    return parser.parse_args(words)


def main(words: list[str]) -> int:
    """Make the page that the arguments name, and say where it is."""
    option = next(option for option in PAGES if option in words)
    output = parse_arguments(option, words).output
    try:
        page = make_alone(option)
        output.parent.mkdir(parents=True, exist_ok=True)
        write_page(page, output)
    except (PackageError, OSError) as error:
        reason = getattr(error, "strerror", None) or error
        what = "" if isinstance(error, PackageError) else f"cannot write {output}: "
        print(f"scripts/report: {printable(f'{what}{reason}')}", file=sys.stderr)
        return EXIT_OUTPUT
    show_path(output)
    return 0
