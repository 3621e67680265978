"""The pages themselves: the templates, style and scripts of `page/` with a study put in, or alone.

A page fetches nothing, and its Content-Security-Policy forbids it to: only the style and the
script that stand in it, known by their hashes, and pictures that are part of it.
"""

import base64
import datetime
import hashlib
import re
from collections import Counter
from pathlib import Path

import jinja2
from markupsafe import Markup

from reporting.key_numbers import key_numbers
from reporting.live_link import live_link
from reporting.packages import PAGE, PackageError, bundle
from reporting.study import Section
from reporting.words import of_kind
from spintop_figures.moving.motion import facts_text, pack_all, refusal
from spintop_figures.style.numbers import write_count
from spintop_figures.tables.names import raised
from spintop_figures.tables.words import LANGUAGE, dictionary, say

LARGEST, PER_TABLE = 2_000_000, 100_000
"""Bytes of the data in a page, and what each of many tables has at least. Where there would be
more, the longest tables have fewer rows."""

ALL_CELLS = 20_000
"""Cells of all tables that are shown."""

COLUMNS_ON_PAPER = 8
"""Wider tables are printed across."""

PROVENANCE = ("program", "revision", "compiler", "date", "model", "method", "body")
"""What of the header of a table the report says, in its order."""

STYLES = ("page.css", "live.css")
ALONE = {"--live": ("live.html", "live_main.js"), "--viewer": ("viewer.html", "main.js")}
"""Pages without a study: the template and the script of the live top, and of the viewer in which
the Python package puts a motion."""


TEXTS = re.compile(r'(?<=[>}])[^<>{}]+(?=[<{])|(?<=aria-label=")[^"{]+')
"""Texts of a template between its tags, and those that are heard."""


class SpokenTemplates(jinja2.FileSystemLoader):
    """Templates with the texts between their tags in the language that is spoken."""

    def get_source(self, *asked: object) -> tuple:
        """A template, where it is, and whether it is still the same."""
        source, *known = super().get_source(*asked)
        return TEXTS.sub(lambda text: say(text[0]), source), *known


def render(template: str, script: str, **parts: object) -> str:
    """A template with style and script; `texts` is the dictionary of the live top."""
    environment = jinja2.Environment(
        loader=SpokenTemplates(PAGE), autoescape=True, trim_blocks=True,
        lstrip_blocks=True, undefined=jinja2.StrictUndefined,
    )  # fmt: skip
    environment.filters |= {"sentence": lambda text: text[:1].upper() + text[1:], "unit": raised}
    environment.filters |= {"say": say, "count": write_count}
    style = "\n".join((PAGE / name).read_text(encoding="utf-8") for name in STYLES)
    return environment.get_template(template).render(
        texts=dictionary(), language=LANGUAGE.get(),
        policy=policy(style, script), style=Markup(style), script=Markup(script), **parts,
    )  # fmt: skip


def make_alone(option: str) -> str:
    """A page without a study; raises a PackageError if what it takes is not to be had."""
    template, script = ALONE[option]
    return render(template, bundle(PAGE / script))


def policy(style: str, script: str) -> str:
    """The Content-Security-Policy of a page, which knows style and script by their hashes."""

    def hash_of(text: str) -> str:
        return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()

    sources = {
        "default-src": "'none'",
        "img-src": "data:",
        "style-src": f"'{hash_of(style)}'",
        "script-src": f"'{hash_of(script)}'" if script else "'none'",
        "base-uri": "'none'",
        "form-action": "'none'",
    }
    return "; ".join(f"{name} {value}" for name, value in sources.items())


def load_script(sections: list[Section]) -> tuple[str, str]:
    """The script that moves the tops, empty where there are none; or why it is not to be had."""
    if not any(section.moves for section in sections):
        return "", ""
    try:
        return bundle(PAGE / "main.js"), ""
    except PackageError as error:
        return "", str(error)


def pack_data(sections: list[Section]) -> list[str]:
    """Give the sections their data; return which have fewer rows than their tables, in words."""
    for section in sections:
        section.cells = min(section.cells, ALL_CELLS // len(sections))
    room = max(LARGEST, PER_TABLE * len(sections))
    for section, data in zip(sections, pack_all([s.table for s in sections], room), strict=True):
        section.data = data
    return [
        f"{section.name}: the page has {section.data.which}"
        for section in sections
        if not section.data.is_whole
    ]


def facts_of(sections: list[Section]) -> dict[str, str]:
    """What the page says first: dates, program, and how many there are of what."""
    headers = [section.table.header for section in sections]
    days = sorted({header["date"][:10] for header in headers if header.get("date")})
    programs = dict.fromkeys(
        " ".join(filter(None, (h.get("program"), h.get("revision") and f"({h['revision']})")))
        for h in headers
    )
    kinds = Counter(section.table.kind for section in sections)
    failed = sum(section.failed for section in sections)
    counts = [of_kind(kind, count) for kind, count in kinds.items()]
    return {
        "Date of the report": datetime.datetime.now(tz=datetime.UTC).date().isoformat(),
        "Date of the runs": " to ".join(dict.fromkeys((days[0], days[-1]))) if days else "",
        "Program": "; ".join(filter(None, programs)),
        "Tables": ", ".join(counts),
        "Failures": f"in {failed} of {len(sections)} tables" if failed else "none",
    }


def make_page(title: str, sections: list[Section], problems: list[str]) -> tuple[str, list[str]]:
    """The page of a study, and what is lacking in it, in sentences."""
    script, lack = load_script(sections)
    reduced = pack_data(sections)
    motions = {
        section.anchor: Markup(facts_text(section.table, section.data, f"{section.anchor}-data"))
        for section in sections
        if script and section.moves
    }
    page = render(
        "page.html", script, title=title, facts=facts_of(sections), sections=sections,
        problems=problems, reduced=reduced, motions=motions, lack=lack,
        lives={s.anchor: live_link(s.table) for s in sections if s.anchor in motions},
        key_numbers=key_numbers, refusal=refusal, columns_on_paper=COLUMNS_ON_PAPER,
        provenance=PROVENANCE,
    )  # fmt: skip
    return page, ([f"the tops do not move in the page: {lack}"] if lack else []) + reduced


def write_page(page: str, path: Path) -> None:
    """Write the page to a file, which is replaced when the new one is complete."""
    part = path.with_name(path.name + ".part")
    try:
        part.write_text(page, encoding="utf-8")
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
