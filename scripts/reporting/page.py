"""The page itself: the template, style and script of `page/` with a study put in.

The page fetches nothing, and its Content-Security-Policy forbids it to: only the style and the
script that stand in it, known by their hashes, and pictures that are part of it.
"""

import base64
import hashlib
import json
import re
from pathlib import Path

import jinja2
from markupsafe import Markup, escape

from reporting.bundle import bundle
from reporting.errata import Erratum
from reporting.motion import motion_data
from reporting.packages import PAGE, PackageError
from reporting.pictures import fit
from reporting.study import Section

LARGEST = 5_000_000
"""Bytes of a page; pictures make room for the rest."""

MOST_TIMES, ALL_TIMES = 4_001, 24_000
"""Rows of a trajectory for the moving top, and of all trajectories of a page together."""

CODE = re.compile(r"`([^`]+)`")


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


def as_json(data: object) -> Markup:
    """Data for a script element: no text in it can end the element."""
    text = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return Markup(text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e"))


def prose(text: str) -> Markup:
    """A paragraph of Markdown: what stands between backticks is code."""
    return Markup(CODE.sub(r"<code>\1</code>", str(escape(text))))


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


def make_page(
    name: str, sections: list[Section], problems: list[str], errata: list[Erratum]
) -> tuple[str, str]:
    """The page of a study, and why its tops do not move if they should."""
    script, lack = load_script(sections)
    moving = sum(section.moves for section in sections) if script else 0
    most_rows = min(MOST_TIMES, ALL_TIMES // moving) if moving else 0
    motions = {
        section.anchor: as_json(motion_data(section.table, most_rows))
        for section in sections
        if moving and section.moves
    }
    style = (PAGE / "page.css").read_text(encoding="utf-8")
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(PAGE),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters |= {"prose": prose, "sentence": lambda text: text[:1].upper() + text[1:]}
    template = environment.get_template("page.html")
    concerned = anchored(sections, errata)

    def render() -> str:
        return template.render(
            name=name,
            sections=sections,
            problems=problems,
            motions=motions,
            lack=lack,
            errata=concerned,
            anchors={erratum.heading: anchor for anchor, erratum in concerned.items()},
            policy=policy(style, script),
            style=Markup(style),
            script=Markup(script),
        )

    pictures = [picture for section in sections for picture in section.pictures]
    page = render()
    taken = len(page.encode()) - sum(picture.size for picture in pictures)
    if len(page.encode()) > LARGEST:
        fit(pictures, LARGEST - taken)
        page = render()
    return page, lack


def write_page(page: str, path: Path) -> None:
    """Write the page to a file, which is replaced when the new one is complete."""
    part = path.with_name(path.name + ".part")
    try:
        part.write_text(page, encoding="utf-8")
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
