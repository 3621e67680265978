"""Pictures as SVG elements of the page: without what only a file of its own needs.

Letters and marks stand once in the page, whatever the number of pictures that show them. Only what
matplotlib draws with is taken over: an element or an attribute that could do anything else makes a
picture one that is shown as a PNG.
"""

import re
import xml.etree.ElementTree as ET
from dataclasses import dataclass, field

from markupsafe import Markup, escape

SVG, LINK = "{http://www.w3.org/2000/svg}", "{http://www.w3.org/1999/xlink}"
SKIPPED = frozenset({"metadata", "title", "style"})
SHAPES = frozenset({"g", "path", "use", "rect", "image", "clipPath"})
STYLES = frozenset(
    (
        *("fill", "fill-opacity", "fill-rule", "opacity", "stroke", "stroke-dasharray"),
        *("stroke-dashoffset", "stroke-linecap", "stroke-linejoin", "stroke-miterlimit"),
        *("stroke-opacity", "stroke-width"),
    )
)
PLACES = frozenset(("x", "y", "width", "height", "transform", "clip-path", "clip-rule"))
PLAIN = re.compile(r"[-\w#.,%() +]*")
"""Values of styles; no address is among them."""

PICTURE = re.compile(r"data:image/png;base64,[\w+/=\s]+")
NUMBER = re.compile(r"-?\d+\.\d+(?:e-?\d+)?")
BOX = re.compile(r"0 0 (\d+(?:\.\d+)?) (\d+(?:\.\d+)?)")
REFERENCE = re.compile(r"url\(#([\w-]+)\)")
DECIMALS = 2
"""Of places in points: a seventieth of a millimetre at most."""

UNIT = 10**DECIMALS
STRAIGHT = re.compile(r"\s*M -?[\d.]+ -?[\d.]+\s*(?:[ML] -?[\d.]+ -?[\d.]+\s*|[zZ]\s*)*")
"""Paths as matplotlib writes them, of straight lines only."""

SHIFT = re.compile(r"translate\((-?[\d.]+) (-?[\d.]+)\)")

PIXELS = 4 / 3
"""Of a point."""

JOINS = 'stroke-linejoin="round" stroke-linecap="butt"'
"""What the style sheet of matplotlib's files says."""


class NotDrawnError(Exception):
    """A picture has something in it that is not taken over."""


@dataclass
class Glyphs:
    """Letters and marks of all pictures of a page, once each."""

    names: dict[str, str] = field(default_factory=dict)
    clips: int = 0
    """How many regions that pictures are cut to have a name."""

    def name_of(self, shape: str) -> str:
        """The name of a path by which it is used."""
        return self.names.setdefault(shape, f"g{len(self.names) + 1}")

    def definitions(self) -> Markup:
        """The elements that define them."""
        paths = (f'<path id="{name}" {shape}/>' for shape, name in self.names.items())
        return Markup("".join(paths))


def shorten(text: str) -> str:
    """Numbers with the decimals that can be seen; white space once."""

    def shortened(match: re.Match[str]) -> str:
        short = f"{float(match[0]):.{DECIMALS}f}".rstrip("0").rstrip(".")
        return "0" if short == "-0" else short

    if "scale" in text or "matrix" in text:
        return " ".join(text.split())  # factors, not places
    return " ".join(NUMBER.sub(shortened, text).split())


def shorten_path(text: str) -> str:
    """A path with the decimals that can be seen; straight lines as steps from point to point."""
    tokens = text.split()
    if not STRAIGHT.fullmatch(text):
        return shorten(text)
    parts: list[str] = []
    here = start = (0, 0)
    i = 0
    while i < len(tokens):
        command = tokens[i]
        if command in "zZ":
            parts.append("z")
            here, i = start, i + 1
            continue
        there = tuple(round(UNIT * float(x)) for x in tokens[i + 1 : i + 3])
        steps = [f"{(b - a) / UNIT:g}" for a, b in zip(here, there, strict=True)]
        mark = "m" if command == "M" else "l"
        parts.append(mark + steps[0] + ("" if steps[1].startswith("-") else " ") + steps[1])
        start = there if command == "M" else start
        here, i = there, i + 3
    return "".join(parts)


def tag_of(element: ET.Element) -> str:
    """The name of an element of SVG; empty for any other."""
    return element.tag.removeprefix(SVG) if element.tag.startswith(SVG) else ""


class Drawing:
    """An SVG file that becomes an element of the page."""

    def __init__(self, svg: bytes, glyphs: Glyphs, label: str) -> None:
        """Take over a file, or raise a NotDrawnError."""
        text = svg.decode("utf-8", errors="replace")
        if "<!ENTITY" in text:
            raise NotDrawnError
        try:
            root = ET.fromstring(text)
        except ET.ParseError as error:
            raise NotDrawnError from error
        self.glyphs = glyphs
        self.label = label
        self.shared: dict[str, str] = {}
        self.clips: dict[str, str] = {}
        self.clip_elements: list[str] = []
        self.box = BOX.fullmatch(root.get("viewBox", ""))
        if tag_of(root) != "svg" or not self.box:
            raise NotDrawnError
        self.gather(root)
        self.body = "".join(self.render(child) for child in root)

    def gather(self, root: ET.Element) -> None:
        """Give what is defined in the file the names that it has in the page."""
        for definitions in root.iter(f"{SVG}defs"):
            for element in definitions:
                name = element.get("id", "")
                if tag_of(element) == "path":
                    self.shared[name] = self.glyphs.name_of(self.attributes(element))
                elif tag_of(element) == "clipPath":
                    self.glyphs.clips += 1
                    self.clips[name] = f"c{self.glyphs.clips}"
        for element in root.iter(f"{SVG}clipPath"):
            inner = "".join(self.render(child) for child in element)
            name = self.clips[element.get("id", "")]
            self.clip_elements.append(f'<clipPath id="{name}">{inner}</clipPath>')

    def attributes(self, element: ET.Element) -> str:
        """The attributes of an element; styles are attributes too, as the page's policy needs."""
        parts = []
        for name, value in element.attrib.items():
            if name == "style":
                parts += [
                    self.style(*item.split(":", 1)) for item in value.split(";") if item.strip()
                ]
            elif name == f"{LINK}href":
                parts.append(self.reference(element, value))
            elif name == "clip-path":
                match = REFERENCE.fullmatch(value)
                if not match or match[1] not in self.clips:
                    raise NotDrawnError
                parts.append(f'clip-path="url(#{self.clips[match[1]]})"')
            elif name == "d":
                parts.append(f'd="{escape(shorten_path(value))}"')
            elif name == "transform" and tag_of(element) == "use" and SHIFT.fullmatch(value):
                x, y = (shorten(text) for text in SHIFT.fullmatch(value).groups())
                parts.append(f'x="{x}"' + (f' y="{y}"' if y != "0" else ""))
            elif name in STYLES or name in PLACES:
                parts.append(f'{name}="{escape(shorten(value))}"')
            elif name != "id":
                raise NotDrawnError
        return " ".join(parts)

    @staticmethod
    def style(name: str, value: str = "") -> str:
        """A style as an attribute."""
        name, value = name.strip(), value.strip()
        if name == "image-rendering":
            return ""
        if name not in STYLES or not PLAIN.fullmatch(value):
            raise NotDrawnError
        return f'{name}="{shorten(value)}"'

    def reference(self, element: ET.Element, address: str) -> str:
        """What an element uses: a glyph, or a picture within the picture."""
        if tag_of(element) == "image":
            if not PICTURE.fullmatch(address):
                raise NotDrawnError
            return f'href="{"".join(address.split())}"'
        if address[1:] not in self.shared:
            raise NotDrawnError
        return f'href="#{self.shared[address[1:]]}"'

    def render(self, element: ET.Element) -> str:
        """An element and what is in it, as text."""
        tag = tag_of(element)
        if tag in SKIPPED or tag == "defs":
            return ""
        if tag not in SHAPES:
            raise NotDrawnError
        attributes = self.attributes(element)
        inner = "".join(self.render(child) for child in element)
        if tag == "g" and (not attributes or not inner):
            return inner
        start = f"<{tag} {attributes}".rstrip()
        return f"{start}>{inner}</{tag}>" if inner else f"{start}/>"

    def element(self) -> str:
        """The picture as an element of the page."""
        width, height = (round(float(x) * PIXELS) for x in self.box.groups())
        clips = f"<defs>{''.join(self.clip_elements)}</defs>" if self.clip_elements else ""
        return (
            f'<svg class="drawing" role="img" aria-label="{escape(self.label)}" '
            f'viewBox="{self.box[0]}" width="{width}" height="{height}" {JOINS}>'
            f"{clips}{self.body}</svg>"
        )
