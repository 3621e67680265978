"""The tables of the manual that the program tells: parameters, methods, columns and the like.

A table stands between the lines `<!-- spintop list TOPIC PART -->` and `<!-- end of list -->` of
a page, and `<!-- spintop --help -->` is such a line, too. PART is a group of parameters or the kind
of study of columns.
"""

import json
import re
import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path

END = "<!-- end of list -->"
_BEGIN = re.compile(r"^<!-- spintop (list \w+|--help)(?: (\w+))? -->$")

Entry = dict[str, object]
"""An item of a registry, as `spintop list --json` has it."""


@cache
def registries(program: Path) -> dict[str, list[Entry]]:
    """All registries of the program."""
    result = subprocess.run([program, "list", "--json"], capture_output=True, check=True)
    return json.loads(result.stdout)


def _code(text: object) -> str:
    return f"`{text}`" if text else ""


def _escape(text: object) -> str:
    """Text as it is, though it has signs that mean something in Markdown."""
    return re.sub(r"([*_<])", r"\\\1", str(text)).replace("|", "&#124;")


def _cell(member: str, form: Callable[[object], str] = _escape) -> Callable[[Entry], str]:
    """A cell that shows a member, which may be null."""
    return lambda entry: "" if entry[member] is None else form(entry[member])


def _steps(entry: Entry) -> str:
    return {"exact": "", "both": "fixed, adaptive"}.get(str(entry["kind"]), str(entry["kind"]))


def _needs(entry: Entry) -> str:
    keys = ", ".join(map(_code, entry["needs"]))
    if entry["name"] == "inertia":
        return f"`mass`, {keys}, and `length` or `centre_of_mass`"
    return f"`mass` or `density`, {keys}"


def _values(entry: Entry) -> str:
    """What a parameter may be."""
    return ", ".join(map(_code, entry["choices"])) or _escape(entry["range"])


def _meaning(entry: Entry) -> str:
    """What a parameter is, with its default in parentheses, as descriptions have theirs."""
    default = f" ({_code(entry['default'])})" if entry["default"] else ""
    return _escape(entry["description"]) + default


def _key(entry: Entry) -> str:
    return _code(str(entry["full_name"]).partition(".")[2])


_NAME, _WHAT = _cell("name", _code), _cell("description")
_TABLES: dict[str, dict[str, Callable[[Entry], str]]] = {
    "methods": {
        "method": _NAME, "family": _cell("family"), "order": _cell("order"), "step size": _steps,
        "what it is": _WHAT,
    },
    "formulations": {"formulation": _NAME, "what it is": _WHAT},
    "columns": {"column": _NAME, "unit": _cell("unit"), "what it is": _WHAT},
    "events": {"event": _NAME, "what it is": _WHAT},
    "shapes": {"shape": _NAME, "what it is": _WHAT, "needs": _needs},
    "parts": {
        "part": _NAME, "what it is": _WHAT,
        "needs": lambda entry: ", ".join(map(_code, ["mass", *entry["needs"]])),
        "may have": lambda entry: ", ".join(map(_code, entry["takes"])),
    },
    "parameters": {
        "key": _key, "unit": _cell("unit", str), "meaning": _meaning, "values": _values,
    },
    "benchmarks": {"benchmark": _NAME, "what it is": _WHAT, "source": _cell("source")},
    "cases": {"case": _NAME, "what it is, and why it is hard": _WHAT},
    "studies": {"kind": _NAME, "what it computes": _WHAT},
    "exit_codes": {"code": _cell("code"), "meaning": _WHAT},
}  # fmt: skip
"""The heads of the tables, and what fills a cell."""

_PARTS = {"columns": "study", "parameters": "group"}
"""The member that a part of a table goes by."""


def _table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> list[str]:
    """A table in Markdown."""
    lines = ["| " + " | ".join(line) + " |" for line in (head, *rows)]
    return [lines[0], "|" + "---|" * len(head), *lines[1:]]


def _joined(rows: list[tuple[str, ...]]) -> list[tuple[str, ...]]:
    """Rows of which neighbours that differ in one word of their meaning, as x, y and z, are one."""
    done: list[tuple[list[str], list[str], list[list[str]]]] = []
    for name, *between, meaning in rows:
        words = [[word] for word in re.split(r"([^\w\\]+)", meaning)]
        if done and done[-1][1] == between and len(done[-1][2]) == len(words):
            names, _, known = done[-1]
            other = [i for i, word in enumerate(words) if word[0] not in known[i]]
            wide = [i for i, word in enumerate(known) if len(word) > 1]
            if len(other) == 1 and wide in ([], other):
                names.append(name)
                known[other[0]] += words[other[0]]
                continue
        done.append(([name], between, words))
    return [
        (", ".join(names), *between, "".join(map(", ".join, words)))
        for names, between, words in done
    ]


def _listed(program: Path, topic: str, part: str) -> list[str]:
    """A table of a topic, or of a part of it, without columns that are empty; a source that is
    that of the row above stands there once."""
    cells = _TABLES[topic]
    entries = registries(program)[topic]
    if part:
        entries = [entry for entry in entries if entry[_PARTS[topic]] == part]
    filled = {
        name: column
        for name, cell in cells.items()
        if any(column := [cell(entry) for entry in entries])
    }
    if sources := filled.get("source"):
        above = ["", *sources]
        filled["source"] = [
            "as above" if source == above[i] else source for i, source in enumerate(sources)
        ]
    rows = list(zip(*filled.values(), strict=True))
    return _table(tuple(filled), _joined(rows) if topic == "columns" else rows)


def _options(program: Path) -> list[str]:
    """The options of the command line."""
    result = subprocess.run([program, "--help"], capture_output=True, text=True, check=True)
    lines = result.stdout.splitlines()
    rows = []
    for line in lines[lines.index("options") + 1 :]:
        if not line.startswith("  "):
            break
        rows.append((_code(line[2:26].strip()), _escape(line[26:])))
    return _table(("option", "meaning"), rows)


def _made(program: Path, command: str, part: str) -> list[str]:
    """The lines of a table."""
    if command == "--help":
        return _options(program)
    return _listed(program, command.split()[1], part)


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
