"""Make one HTML page of a folder of tables: what was run, figures, tables, and the top moving."""

import argparse
import subprocess
import sys
from pathlib import Path

from reporting.packages import PackageError
from reporting.page import make_alone, make_page, write_page
from reporting.study import list_tables, read_study
from spintop_figures.files import show_path
from spintop_figures.style.numbers import speak
from spintop_figures.tables.table import printable
from spintop_figures.tables.words import LANGUAGES

EXIT_INPUT, EXIT_OUTPUT = 2, 4
SCRIPTS = Path(__file__).resolve().parent.parent
PAGES_ALONE = {
    "--live": "the page of the live top, which answers to sliders at once",
    "--viewer": "the page in which the Python package shows a motion",
}


def parse_arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        prog="scripts/report",
        description=__doc__ + "\nThe page needs no other file and no network.",
        epilog="exit codes: 0 all is well; 2 wrong usage or no table; 4 the page could not be\n"
        "made or written; else that of scripts/run, the page being made of what there is. A file\n"
        "that is no table is named in the page.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add, alone = parser.add_argument, parser.add_mutually_exclusive_group()
    for option, what in PAGES_ALONE.items():
        alone.add_argument(option, dest="alone", action="store_const", const=option,
                           help=f"make {what}, and no other: {option} [-o FILE]")  # fmt: skip
    add("study", metavar="STUDY_DIR", type=Path, nargs="?", help="folder with tables")
    add("inputs", metavar="INPUT.nml", nargs="*", type=Path, help="run these first, into that "
        "folder; their tables come first, in this order")  # fmt: skip
    add("--title", metavar="TEXT", help="the title of the page (default: the name of the folder)")
    add("--language", choices=LANGUAGES, default="en", help="of the report and its figures (en)")
    add("-o", "--output", metavar="FILE", type=Path,
        help="the page (default: STUDY_DIR/report.html, output/live.html)")  # fmt: skip
    arguments = parser.parse_args()
    if arguments.alone and (arguments.study or arguments.title):
        parser.error(f"{arguments.alone} takes -o FILE only")
    if not arguments.alone and not arguments.study:
        parser.error("the following arguments are required: STUDY_DIR")
    if arguments.alone:
        default = Path("output") / f"{arguments.alone[2:]}.html"
    else:
        default = arguments.study / "report.html"
    arguments.output = arguments.output or default
    return arguments


def complain(message: str) -> None:
    """Tell what is wrong."""
    print(f"scripts/report: {printable(message)}", file=sys.stderr)


def run_inputs(folder: Path, inputs: list[Path]) -> int:
    """Run spintop on the inputs; return its exit code."""
    names = [f"./{path}" if str(path).startswith("-") else path for path in inputs]  # no options
    command = [SCRIPTS / "run", "--no-plots", "-o", folder, *names]
    return subprocess.run(command, check=False).returncode


def write_or_complain(page: str, output: Path) -> int:
    """Write a page and say where it is; return the exit code."""
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
        write_page(page, output)
    except OSError as error:
        complain(f"cannot write {output}: {error.strerror or error}")
        return EXIT_OUTPUT
    show_path(output)
    return 0


def main() -> int:
    """Run the inputs, if any, and make the page."""
    arguments = parse_arguments()
    speak(arguments.language)
    if arguments.alone:
        try:
            return write_or_complain(make_alone(arguments.alone), arguments.output)
        except PackageError as error:
            complain(str(error))
            return EXIT_OUTPUT
    before = list_tables(arguments.study) if arguments.inputs else None
    code = run_inputs(arguments.study, arguments.inputs) if arguments.inputs else 0
    if code == EXIT_INPUT:
        return code
    if not arguments.study.is_dir():
        complain(f"{arguments.study}: no such folder")
        return EXIT_INPUT
    sections, problems = read_study(arguments.study, before)
    for problem in problems:
        complain(problem)
    if not sections:
        complain(f"{arguments.study}: no table of spintop in it")
        return EXIT_INPUT
    title = printable(arguments.title or arguments.study.resolve().name)
    page, lacking = make_page(title, sections, problems)
    for sentence in lacking:
        complain(sentence)
    return write_or_complain(page, arguments.output) or code


if __name__ == "__main__":
    sys.exit(main())
