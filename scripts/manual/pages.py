"""The pages of the manual as data: fenced blocks, links, headings and equations."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent.parent

_FENCE = re.compile(r"^( *)```(.*)$")
_LINK = re.compile(r"(!?\[[^\]]*\])\(([^)\s]+)\)")
_HEADING = re.compile(r"^(#+) +(.*)$")
_MATHS = re.compile(r"\$\$(.+?)\$\$|(?<![\w$\\])\$([^$\s](?:[^$\n]*[^$\s])?)\$(?![\w$])", re.DOTALL)
_CODE = re.compile(r"`[^`\n]+`")


class Block(NamedTuple):
    """A fenced block: where it begins, the words behind its fence, and its lines."""

    page: Path
    line: int
    tags: tuple[str, ...]
    text: str

    def __str__(self) -> str:
        """Where it is."""
        return f"{self.page.relative_to(ROOT)}:{self.line}"


def manual_pages() -> list[Path]:
    """The front page and the pages of the manual."""
    return [ROOT / "README.md", *sorted((ROOT / "doc").glob("*.md"))]


def _parts(page: Path) -> tuple[list[Block], list[str]]:
    """The fenced blocks of a page, and its lines with those of blocks left empty."""
    blocks: list[Block] = []
    prose: list[str] = []
    begin, tags, inside = 0, "", []
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        fence = _FENCE.match(line)
        prose.append("" if fence or begin else line)
        if fence and not begin:
            begin, tags, inside = number, fence[2], []
        elif fence:
            blocks.append(Block(page, begin, tuple(tags.split()), "\n".join(inside) + "\n"))
            begin = 0
        elif begin:
            inside.append(line)
    if begin:
        raise ValueError(f"{page}:{begin}: a fence without its end")
    return blocks, prose


def blocks_of(page: Path) -> list[Block]:
    """All fenced blocks of a page."""
    return _parts(page)[0]


def prose_of(page: Path) -> list[str]:
    """The lines of a page, those of fenced blocks empty."""
    return _parts(page)[1]


def links_of(page: Path) -> list[tuple[int, str]]:
    """The targets of links and pictures, each with its line."""
    return [
        (number, target)
        for number, line in enumerate(prose_of(page), 1)
        for _, target in _LINK.findall(_CODE.sub("", line))
    ]


def anchor_of(heading: str) -> str:
    """The anchor that GitHub gives a heading."""
    kept = re.sub(r"[^\w\- ]", "", heading.strip().lower())
    return kept.replace(" ", "-")


def anchors_of(page: Path) -> set[str]:
    """All anchors of a page."""
    return {anchor_of(match[2]) for line in prose_of(page) if (match := _HEADING.match(line))}


def title_of(page: Path) -> str:
    """The first heading."""
    return next(match[2] for line in prose_of(page) if (match := _HEADING.match(line)))


def map_prose(text: str, change: Callable[[str], str]) -> str:
    """Change what is no fenced block and no code in a line; fences keep their first tag only."""
    done: list[str] = []
    for i, part in enumerate(re.split(r"^(```.*\n(?:.*\n)*?```)$", text, flags=re.MULTILINE)):
        if i % 2:
            done.append(re.sub(r"^```(\S*).*", r"```\1", part, count=1))
            continue
        codes: list[str] = []

        def keep(match: re.Match[str], codes: list[str] = codes) -> str:
            codes.append(match[0])
            return f"\0{len(codes) - 1}\0"

        changed = change(_CODE.sub(keep, part))
        done.append(re.sub(r"\0(\d+)\0", lambda match, codes=codes: codes[int(match[1])], changed))
    return "".join(done)


def map_links(text: str, change: Callable[[str], str]) -> str:
    """Change the targets of links and pictures."""
    return _LINK.sub(lambda match: f"{match[1]}({change(match[2])})", text)


def map_maths(text: str, change: Callable[[str, bool], str]) -> str:
    """Change equations; the function is told their TeX and whether they are displayed."""
    return _MATHS.sub(lambda m: change((m[1] or m[2]).strip(), m[1] is not None), text)
