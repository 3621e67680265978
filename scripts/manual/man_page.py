"""The manual page of the program in section 1: the text of `spintop --help`, and more sections.

usage: python -m manual.man_page PROGRAM >spintop.1        with scripts/ in PYTHONPATH
"""

import re
import subprocess
import sys
from pathlib import Path

HEADINGS = {"options": "OPTIONS", "exit codes": "EXIT STATUS"}
"""The headings of the text whose lines have a term and its meaning, as manual pages name them."""

DESCRIPTION = """\
spintop computes the motion of a heavy spinning top: a rigid body with one fixed point, under
gravity. An input is a Fortran namelist that describes the body, its start, the span of time and
the study: one motion, a sweep over many tops, the errors of methods, or a fit to measurements. For
each input the program writes a table and prints a summary. The motion of a symmetric top without
damping is computed in closed form, any other motion numerically."""

INPUT = """\
&top      mass = 1  inertia = 0.875, 0.875, 0.25  length = 0.866 /
&initial  theta = '20 deg'  omega3 = '300 rpm' /
&span     t_end = 5  samples = 501 /
"""
"""The input of the examples."""

EXAMPLES = {
    "spintop top.nml": "Compute the motion, and write output/top.csv.",
    "spintop --check top.nml": "Print the whole input, the method and the reason for it.",
    "spintop --set span.t_end=10 -o long top.nml": "Change a number for this run.",
    "spintop --resume sweep.nml": "Compute the rows that an interrupted sweep lacks.",
    "spintop --shard 2/8 sweep.nml": "Compute the second of eight parts, output/sweep.2-of-8.csv.",
    "spintop merge output/sweep.csv output/sweep.?-of-8.csv": "Join the parts.",
    "spintop list parameters": "List all groups and keys of an input.",
}
FILES = {
    "output/NAME.csv": "The table of NAME.nml. Its header has the input and the columns.",
    "output/NAME.nc": "The same as a NetCDF file, with output.format = 'netcdf'.",
    "output/NAME.events.csv": "Its events, if the input asks for them.",
    "output/NAME.log": "The summary of a sweep.",
    "output/NAME.csv.part": "The rows of a run that has not ended.",
    "output/NAME.csv.journal": "Which of these rows are safely on the disk; --resume reads it.",
}
ENVIRONMENT = {
    "SPINTOP_LEVEL": "A lower level of the processor (v2, v3, v4) than the highest that it has.",
    "TMPDIR": "Folder for temporary files (default: /tmp).",
    "OMP_STACKSIZE": "Stack of each thread; at least 448 kB.",
    "NO_COLOR, TERM": "No colours if NO_COLOR is set, or TERM is dumb.",
}
SEE_ALSO = "The manual is the folder doc of the sources; its first page is doc/index.md."


def escaped(text: str) -> str:
    """A text for troff: a hyphen that is typed is a minus, a dot at a beginning is no request."""
    text = text.replace("\\", r"\e").replace("-", r"\-")
    return rf"\&{text}" if text.startswith((".", "'")) else text


def terms_of(lines: list[str]) -> list[tuple[str, str]]:
    """Terms and meanings of lines like `  --check    plan only`; a line without a term goes on."""
    found: list[tuple[str, str]] = []
    for line in lines:
        term, _, meaning = line.strip().partition("  ")
        if meaning:
            found.append((term, meaning.strip()))
        else:
            found[-1] = (found[-1][0], f"{found[-1][1]} {term}")
    return found


def section_of(block: list[str]) -> list[str]:
    """The lines of a section for a block of the text."""
    head, rest = block[0], block[1:]
    if head in HEADINGS:
        return terms(HEADINGS[head], dict(terms_of(rest)))
    name, _, text = head.partition(":")
    if name == "usage":
        lines = [".SH SYNOPSIS", ".nf"]
        lines += [*(escaped(line.strip()) for line in (text, *rest)), ".fi"]
        return [*lines, ".SH DESCRIPTION", escaped(DESCRIPTION)]
    return [f".SH {name.upper()}", *(escaped(line.strip()) for line in (text, *rest))]


def terms(heading: str, known: dict[str, str]) -> list[str]:
    """The lines of a section of terms with their meanings."""
    lines = [f".SH {heading}"]
    for term, meaning in known.items():
        lines += [".TP", rf"\fB{escaped(term)}\fR", escaped(meaning)]
    return lines


def man_page(text: str, version: str) -> str:
    """The page in troff."""
    first, *blocks = [block.split("\n") for block in re.split(r"\n\n+", text.strip("\n"))]
    name, _, what = first[0].partition(": ")
    lines = [f'.TH {name.upper()} 1 "" "{name} {version}" "User Commands"']
    lines += [".SH NAME", rf"{name} \- {escaped(what)}"]
    for block in blocks:
        lines += section_of(block)
    lines += [".SH EXAMPLES", "With top.nml", ".PP", ".nf", escaped(INPUT.rstrip()), ".fi", ".PP"]
    lines += terms("EXAMPLES", EXAMPLES)[1:] + terms("FILES", FILES)
    lines += [*terms("ENVIRONMENT", ENVIRONMENT), ".SH SEE ALSO", escaped(SEE_ALSO)]
    return "\n".join(lines) + "\n"


def output_of(program: Path, option: str) -> str:
    """What the program prints."""
    return subprocess.run([program, option], check=True, capture_output=True, text=True).stdout


if __name__ == "__main__":
    exe = Path(sys.argv[1])
    sys.stdout.write(man_page(output_of(exe, "--help"), output_of(exe, "--version").split()[1]))
