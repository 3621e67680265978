"""The manual page of the program in section 1, from the text of `spintop --help`.

usage: python -m manual.man_page PROGRAM >spintop.1        with scripts/ in PYTHONPATH
"""

import re
import subprocess
import sys
from pathlib import Path

HEADINGS = {"options": "OPTIONS", "exit codes": "EXIT STATUS"}
"""The headings of the text whose lines have a term and its meaning, as manual pages name them."""


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
        lines = [f".SH {HEADINGS[head]}"]
        for term, meaning in terms_of(rest):
            lines += [".TP", rf"\fB{escaped(term)}\fR", escaped(meaning)]
        return lines
    name, _, text = head.partition(":")
    if name == "usage":
        lines = [".SH SYNOPSIS", ".nf"]
        return [*lines, *(escaped(line.strip()) for line in (text, *rest)), ".fi"]
    return [f".SH {name.upper()}", *(escaped(line.strip()) for line in (text, *rest))]


def man_page(text: str, version: str) -> str:
    """The page in troff."""
    first, *blocks = [block.split("\n") for block in re.split(r"\n\n+", text.strip("\n"))]
    name, _, what = first[0].partition(": ")
    lines = [f'.TH {name.upper()} 1 "" "{name} {version}" "User Commands"']
    lines += [".SH NAME", rf"{name} \- {escaped(what)}"]
    for block in blocks:
        lines += section_of(block)
    return "\n".join(lines) + "\n"


def output_of(program: Path, option: str) -> str:
    """What the program prints."""
    return subprocess.run([program, option], check=True, capture_output=True, text=True).stdout


if __name__ == "__main__":
    exe = Path(sys.argv[1])
    sys.stdout.write(man_page(output_of(exe, "--help"), output_of(exe, "--version").split()[1]))
