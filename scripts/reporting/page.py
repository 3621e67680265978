"""The page itself: the template, style and script of `page/` with a study put in.

The page fetches nothing, and its Content-Security-Policy forbids it to: only the style and the
script that stand in it, known by their hashes, and pictures that are part of it.
"""

import base64
import datetime
import hashlib
import json
import re
from collections import Counter
from pathlib import Path

import jinja2
from markupsafe import Markup, escape

from reporting.bundle import bundle, styles
from reporting.drawing import Glyphs
from reporting.errata import Erratum
from reporting.live_link import live_link
from reporting.packages import DICTIONARY, PAGE, PackageError
from reporting.pictures import THUMBNAIL, Picture, fit
from reporting.study import Section
from reporting.words import of_kind, typeset
from spintop_figures.moving.data import pack_all
from spintop_figures.moving.motion import facts_text
from spintop_figures.tables.names import raised

LARGEST, PER_TABLE = 3_500_000, 300_000
"""Bytes of a page, and what each of many tables has at least. Where there would be more, rows
become fewer and then pictures coarser."""

PICTURES = 0.75
"""The part of the room for pictures and data that pictures may take."""

ALL_CELLS = 20_000
"""Cells of all tables that are shown."""

BYTES_PER_CELL, BYTES_PER_TABLE = 24, 6_000
"""About what a shown cell takes in the page, and what stands around the tables."""

CODE = re.compile(r"`([^`]+)`")


def new_environment() -> jinja2.Environment:
    """What makes pages of templates; `texts` is the dictionary of the live top."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(PAGE),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.globals["texts"] = json.loads(DICTIONARY.read_text(encoding="utf-8"))
    return environment


def hash_of(text: str) -> str:
    """The hash by which the policy knows a style or a script."""
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def policy(style: str, script: str) -> str:
    """The Content-Security-Policy of the page."""
    sources = {
        "default-src": "'none'",
        "img-src": "data:",
        "style-src": f"'{hash_of(style)}'",
        "script-src": f"'{hash_of(script)}'" if script else "'none'",
        "base-uri": "'none'",
        "form-action": "'none'",
    }
    return "; ".join(f"{name} {value}" for name, value in sources.items())


def prose(text: str) -> Markup:
    """A paragraph of Markdown: what stands between backticks is a formula."""
    return Markup(CODE.sub(r"<code>\1</code>", str(escape(typeset(text)))))


def load_script(sections: list[Section]) -> tuple[str, str]:
    """The script that moves the tops, empty where there are none; or why it is not to be had."""
    if not any(section.moves for section in sections):
        return "", ""
    try:
        return bundle(), ""
    except PackageError as error:
        return "", str(error)


def anchored(sections: list[Section], errata: list[Erratum]) -> dict[str, Erratum]:
    """Those errata that concern any section, in their own order, by their anchors."""
    found = {erratum.heading for section in sections for erratum in section.errata}
    concerned = [erratum for erratum in errata if erratum.heading in found]
    return {f"erratum-{i}": erratum for i, erratum in enumerate(concerned, start=1)}


def take_in(sections: list[Section], rest: int) -> tuple[Markup, list[Picture]]:
    """Put pictures and data into a page in which the rest takes so many bytes.

    The pictures become elements of the page. Returns the letters that they share, and those that
    are coarse.
    """
    glyphs = Glyphs()
    pictures = [picture for section in sections for picture in section.pictures]
    for section in sections:
        section.cells = min(section.cells, ALL_CELLS // len(sections))
        rest += BYTES_PER_TABLE + BYTES_PER_CELL * min(section.table.rows.size, section.cells)
        for picture in section.pictures:
            picture.take_in(glyphs, f"{section.title}: {picture.what}")
            rest += picture.size_as(THUMBNAIL)
    limit = max(LARGEST, PER_TABLE * len(sections))
    room = max(0, limit - rest - len(glyphs.definitions()))
    coarse = fit(pictures, round(PICTURES * room))
    left = max(0, room - sum(picture.size for picture in pictures))
    packed = pack_all([section.table for section in sections], left)
    for section, data in zip(sections, packed, strict=True):
        section.data = data
    return glyphs.definitions(), coarse


def reductions(sections: list[Section], coarse: list[Picture]) -> list[str]:
    """What of a study the page shows with less than there is, in sentences."""
    found = [
        f"{section.name}: the page has {section.data.which}"
        for section in sections
        if not section.data.is_whole
    ]
    shown = [
        f"{section.name}: the figure {picture.name} has half its resolution"
        for section in sections
        for picture in section.pictures
        if any(picture is one for one in coarse)
    ]
    return found + shown


def facts_of(sections: list[Section], today: str) -> dict[str, str]:
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
        "Date of the report": today,
        "Date of the runs": " to ".join(dict.fromkeys((days[0], days[-1]))) if days else "",
        "Program": "; ".join(filter(None, programs)),
        "Tables": ", ".join(counts),
        "Failures": f"in {failed} of {len(sections)} tables" if failed else "none",
    }


def make_page(
    title: str, sections: list[Section], problems: list[str], errata: list[Erratum]
) -> tuple[str, list[str]]:
    """The page of a study, and what is lacking in it, in sentences."""
    script, lack = load_script(sections)
    style = styles()
    glyphs, coarse = take_in(sections, len(script) + len(style))
    reduced = reductions(sections, coarse)
    motions = {
        section.anchor: Markup(facts_text(section.table, section.data, f"{section.anchor}-data"))
        for section in sections
        if script and section.moves
    }
    lives = {s.anchor: live_link(s.table) for s in sections if s.anchor in motions}
    environment = new_environment()
    environment.filters |= {
        "prose": prose,
        "sentence": lambda text: text[:1].upper() + text[1:],
        "typeset": typeset,
        "unit": raised,
    }
    concerned = anchored(sections, errata)
    today = datetime.datetime.now(tz=datetime.UTC).date().isoformat()
    page = environment.get_template("page.html").render(
        title=title,
        facts=facts_of(sections, today),
        sections=sections,
        problems=problems,
        reduced=reduced,
        motions=motions,
        lives=lives,
        lack=lack,
        glyphs=glyphs,
        errata=concerned,
        anchors={erratum.heading: anchor for anchor, erratum in concerned.items()},
        policy=policy(style, script),
        style=Markup(style),
        script=Markup(script),
    )
    lacking = [f"the tops do not move in the page: {lack}"] if lack else []
    return page, lacking + reduced


def write_page(page: str, path: Path) -> None:
    """Write the page to a file, which is replaced when the new one is complete."""
    part = path.with_name(path.name + ".part")
    try:
        part.write_text(page, encoding="utf-8")
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
