"""The tables of the manual that the program tells: parameters, methods, columns and the like.

A table stands between the lines `<!-- spintop list TOPIC PART -->` and `<!-- end of list -->` of
a page, and `<!-- spintop --help -->` is such a line, too. PART is a group of parameters or the kind
of a table.
"""

import re
import subprocess
from pathlib import Path

END = "<!-- end of list -->"
_BEGIN = re.compile(r"^<!-- spintop (list \w+|--help)(?: (\w+))? -->$")
_NAME, _SECOND = 28, 24
"""Widths of the first columns of `spintop list`."""

_HEADS = {
    "methods": ("method", "order and steps", "what it is"),
    "formulations": ("formulation", "", "what it is"),
    "columns": ("column", "unit", "what it is"),
    "events": ("event", "", "what it is"),
    "shapes": ("shape", "", "what it is"),
    "cases": ("case", "", "what it is, and why it is hard"),
}


def _ask(program: Path, *arguments: str) -> list[str]:
    """The lines that the program prints."""
    result = subprocess.run([program, *arguments], capture_output=True, text=True, check=True)
    return result.stdout.splitlines()


def _table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> list[str]:
    """A table in Markdown, without columns that have no head."""
    wanted = [i for i, name in enumerate(head) if name]
    lines = [head, tuple("---" for _ in head), *rows]
    return ["| " + " | ".join(line[i] for i in wanted) + " |" for line in lines]


def _code(text: str) -> str:
    return f"`{text}`" if text else ""


def _escape(text: str) -> str:
    """Text as it is, though it has signs that mean something in Markdown."""
    return re.sub(r"([*_<])", r"\\\1", text).replace("|", "&#124;")


def _split(line: str) -> tuple[str, str, str]:
    """The columns of a line of `spintop list`; the second may be missing."""
    name, rest = line[2 : 2 + _NAME].strip(), line[2 + _NAME :]
    second, last = rest[:_SECOND], rest[_SECOND:]
    if last and second.endswith("  "):
        return name, second.strip(), last
    return name, "", rest


def _listed(lines: list[str], topic: str, part: str) -> list[str]:
    """A table of a topic; of the columns, only those of a kind of table."""
    if part:
        start = re.compile(f"columns of an? {part.replace('_', '[-_]')}\\b")
        first = next(i for i, line in enumerate(lines) if start.match(line))
        lines = lines[first + 1 :]
        lines = lines[: lines.index("")] if "" in lines else lines
    rows = []
    for line in lines:
        if line.startswith("  ") and len(line) > 2 + _NAME and line[1 + _NAME] == " ":
            name, second, what = _split(line)
            if " " not in name:  # or it is a line of its own
                rows.append((_code(name), _escape(second), _escape(what)))
    return _table(_HEADS[topic], rows)


def _parameters(lines: list[str], group: str) -> list[str]:
    """The keys of a group, with units, defaults, and what they may be."""
    starts = [lines[0].index(word) for word in ("parameter", "unit", "default", "range", "meaning")]
    rows: list[list[str]] = []
    for line in lines[1:]:
        if line.startswith(" "):
            words = line.replace("one of:", "").strip()
            rows[-1][3] += (" " if rows[-1][3] else "one of ") + words
        else:
            ends = [*starts[1:], len(line)]
            rows.append([line[a:b].strip() for a, b in zip(starts, ends, strict=True)])
    found = []
    for name, unit, default, values, what in rows:
        if name.startswith(group + "."):
            words = re.sub(r"[a-z]\w*", r"`\g<0>`", values.removeprefix("one of "))
            allowed = words if values.startswith("one of ") else _escape(values)
            key = _code(name.removeprefix(group + "."))
            found.append((key, unit, _code(default), _escape(what), allowed))
    return _table(("key", "unit", "default", "meaning", "values"), found)


def _options(lines: list[str]) -> list[str]:
    """The options of the command line."""
    rows = []
    for line in lines[lines.index("options") + 1 :]:
        if not line.startswith("  "):
            break
        rows.append((_code(line[2:26].strip()), _escape(line[26:])))
    return _table(("option", "meaning"), rows)


def _made(program: Path, command: str, part: str) -> list[str]:
    """The lines of a table."""
    lines = _ask(program, *command.split())
    if command == "--help":
        return _options(lines)
    topic = command.split()[1]
    return _parameters(lines, part) if topic == "parameters" else _listed(lines, topic, part)


def renewed(page: Path, program: Path) -> str:
    """The text of a page, its tables as the program tells them now."""
    done: list[str] = []
    skipping = False
    for line in page.read_text(encoding="utf-8").splitlines():
        if not skipping or line == END:
            skipping = False
            done.append(line)
        if begin := _BEGIN.match(line):
            done += ["", *_made(program, begin[1], begin[2] or ""), ""]
            skipping = True
    if skipping:
        raise ValueError(f"{page}: a table without its end, {END}")
    return "\n".join(done) + "\n"
