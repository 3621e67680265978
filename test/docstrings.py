"""Reads docstrings of Fortran sources: `!>` above an item, `!!` beside or below an argument."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

# A type before `function` may have nested parentheses, as `character(len(text))`.
KIND = r"\w+\s*\((?:[^()]|\([^()]*\))*\)"
WORDS = "pure|elemental|impure|recursive|module|integer|logical|complex|real|character"
PREFIX = rf"(?:(?:{WORDS}|{KIND})\s*)*"
PROCEDURE = re.compile(rf"(?:{PREFIX}\s)?\s*(subroutine|function)\s+(\w+)\s*(?:\((.*?)\))?", re.I)
END = re.compile(r"end\s+(?:subroutine|function|procedure)\b", re.I)
TYPE = re.compile(r"type\s*(?:,([^:]*))?::\s*(\w+)", re.I)
PUBLIC = re.compile(r"public\s*::\s*(.*)", re.I)
BINDING = re.compile(r"procedure\s*(?:\((\w+)\))?\s*((?:,[^:]*)?)(?:::)?\s*(.*)", re.I)
SPECIFIC = re.compile(r"(?:module\s+)?procedure\s*(?:::)?(.*)", re.I)
GENERIC = re.compile(r"(end\s+)?interface\b\s*(\w*)", re.I)
NO_DATA = r"type\s*[,:\w]|public\b|private\b|procedure\b"
DECLARATION = re.compile(rf"(?!{NO_DATA})(?:\([^()]*\)|[^:()])*::", re.I)


class Statement(NamedTuple):
    """A statement without comments, or a comment line with an empty `code`."""

    line: int
    code: str
    comment: str


def divide(line: str) -> tuple[str, str]:
    """The code of a line, and its comment."""
    quote = ""
    for i, character in enumerate(line):
        if quote:
            quote = "" if character == quote else quote
        elif character in "'\"":
            quote = character
        elif character == "!":
            return line[:i].rstrip(), line[i:]
    return line.rstrip(), ""


def statements(text: str) -> list[Statement]:
    """The statements and the comment lines of a source, with continued lines joined."""
    found = []
    code, first, comments = "", 0, ""
    for number, line in enumerate(text.splitlines(), 1):
        part, comment = divide(line)
        if part.startswith("#"):  # the preprocessor
            continue
        if not part.strip():
            if comment and not code:
                found.append(Statement(number, "", comment))
            continue
        first = first or number
        code += part.strip().lstrip("&").strip()
        comments += comment
        if code.endswith("&"):
            code = code[:-1] + " "
            continue
        found.append(Statement(first, code, comments))
        code, first, comments = "", 0, ""
    return found


def match_procedure(code: str) -> re.Match[str] | None:
    words = code.lower()
    if words.startswith("end") or not ("subroutine" in words or "function" in words):
        return None
    return PROCEDURE.match(code)


def names_in(text: str) -> list[str]:
    """The names in a list such as `a, b(3), c => null()`, in lower case."""
    while (shorter := re.sub(r"\([^()]*\)|\[[^][]*\]", "", text)) != text:
        text = shorter
    return [name.split("=")[0].strip().lower() for name in text.split(",") if name.strip()]


class Source:
    """One source, with its public items."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.statements = statements(path.read_text(encoding="utf-8"))
        self.public: set[str] = set()
        for statement in self.statements:
            if found := PUBLIC.match(statement.code):
                self.public.update(names_in(found[1]))
        self.bound = set(self.bindings())

    def bindings(self) -> Iterator[str]:
        """Procedures behind the bindings of types, and behind public generic names."""
        generic = ""
        for _, code, _ in self.statements:
            if found := GENERIC.match(code):
                generic = "" if found[1] else found[2].lower()
            elif generic in self.public and (found := SPECIFIC.match(code)):
                yield from names_in(found[1])
            elif (found := BINDING.match(code)) and "private" not in found[2].lower():
                yield from [found[1].lower()] if "deferred" in found[2].lower() else []
                for binding in found[3].split(","):
                    yield binding.split("=>")[-1].strip().lower()

    def is_documented(self, index: int) -> bool:
        """Whether there is a docstring beside a statement, or above it and the group before it."""
        if self.statements[index].comment:
            return True
        while index > 0:
            index -= 1
            _, code, comment = self.statements[index]
            if not code:
                return comment.startswith(("!>", "!!"))
            if not DECLARATION.match(code) and not code.lower().startswith("enum,"):
                return False
        return False

    def items(self) -> Iterator[tuple[str, int]]:
        """Public items, and procedures that are bound to types: their names and statements."""
        depth = 0
        for index, (_, code, _) in enumerate(self.statements):
            if END.match(code):
                depth -= 1
            elif found := match_procedure(code):
                if found[2].lower() in self.public | self.bound:
                    yield found[2], index
                depth += 1
            elif depth == 0 and (found := TYPE.match(code)) and found[2].lower() in self.public:
                yield found[2], index
            elif depth == 0 and "::" in code and DECLARATION.match(code):
                for name in names_in(code.split("::", 1)[1]):
                    if name in self.public:
                        yield name, index

    def components(self, types: set[str]) -> Iterator[tuple[str, int]]:
        """The components of types, but for private ones."""
        is_open = False
        for index, (_, code, _) in enumerate(self.statements):
            kind, _, names = code.partition("::")
            if found := TYPE.match(code):
                is_open = found[2].lower() in types
            elif re.match(r"(contains|private|end\s+type)\b", code, re.I):
                is_open = False
            elif is_open and names and "private" not in kind.lower():
                yield from ((name, index) for name in names_in(names))

    def undocumented_items(self) -> Iterator[str]:
        """Public items without a docstring, each with its line."""
        if not self.statements[0].comment and "module" in self.statements[0].code:
            yield f"{self.path.name}:1 the module"
        for name, index in self.items():
            if not self.is_documented(index):
                yield f"{self.path.name}:{self.statements[index].line} {name}"

    def dummy_arguments(self) -> Iterator[tuple[str, bool]]:
        """The dummy arguments of public procedures, without `self`; whether each is documented."""
        for name, index in self.items():
            header = match_procedure(self.statements[index].code)
            if not header:
                continue
            wanted = set(names_in(header[3] or ""))
            for place in range(index + 1, len(self.statements)):
                line, code, comment = self.statements[place]
                if END.match(code) or not wanted:
                    break
                if "::" not in code:
                    continue
                kind, declared = code.split("::", 1)
                below = self.statements[place + 1]
                documented = "!!" in comment or (not below.code and below.comment.startswith("!!"))
                for argument in names_in(declared):
                    if argument in wanted:
                        wanted.remove(argument)
                        if not (argument == "self" and kind.lower().startswith("class")):
                            yield f"{self.path.name}:{line} {argument} of {name}", documented
            for argument in sorted(wanted):
                yield f"{self.path.name}: {argument} of {name} is not declared", False
