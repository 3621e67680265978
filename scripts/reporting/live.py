"""The page with the live top alone: its script, style and template in one file."""

import argparse
import sys
from pathlib import Path

import jinja2
from markupsafe import Markup

from reporting.bundle import bundle, styles
from reporting.packages import PAGE, PackageError
from reporting.page import policy, write_page
from spintop_figures.files import show_path
from spintop_figures.tables.characters import printable

EXIT_INPUT, EXIT_OUTPUT = 2, 4


def make_live_page() -> str:
    """The page; raises a PackageError if what it is made with is not to be had."""
    script, style = bundle(PAGE / "live_main.js"), styles()
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(PAGE), autoescape=True, undefined=jinja2.StrictUndefined
    )
    return environment.get_template("live.html").render(
        policy=policy(style, script), style=Markup(style), script=Markup(script)
    )


def parse_arguments(words: list[str]) -> argparse.Namespace:
    """Read the command line of `scripts/report --live`."""
    parser = argparse.ArgumentParser(
        prog="scripts/report --live",
        description="Make one HTML page in which a symmetric top answers to sliders at once. The\n"
        "exact solution is computed in the page; it needs no other file and no network.",
        epilog="exit codes: 0 all is well; 2 wrong usage; 4 the page could not be made or written",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--live", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        type=Path,
        default=Path("output/live.html"),
        help="the page (default: output/live.html)",
    )
    return parser.parse_args(words)


def main(words: list[str]) -> int:
    """Make the page and say where it is."""
    output = parse_arguments(words).output
    try:
        page = make_live_page()
        output.parent.mkdir(parents=True, exist_ok=True)
        write_page(page, output)
    except (PackageError, OSError) as error:
        reason = getattr(error, "strerror", None) or error
        what = "" if isinstance(error, PackageError) else f"cannot write {output}: "
        print(f"scripts/report: {printable(f'{what}{reason}')}", file=sys.stderr)
        return EXIT_OUTPUT
    show_path(output)
    return 0
