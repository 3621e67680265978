"""What is wrong with a figure, as a reader would see it: found from its texts, not drawn."""

import itertools
import re
from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Annotation, Text
from matplotlib.transforms import Bbox

from spintop_figures.style.look import DEFAULT, the_look
from spintop_figures.style.page import lay_out

FORMULA = re.compile(r"\$[^$]*\$")
RAW = re.compile(r"\b[a-z]\w*_\w+|\b[a-z]\w*\.[a-z]\w*|\b[a-z]\w+\(\d\)|e[-+]\d\d\b|\d-\d|\^", re.I)
"""Keys such as `at_rest`, `top.mass`, `omega(1)`; numbers and powers as programs write them."""

SLACK = 0.02
"""Texts may touch each other or the edge, in inches."""

LETTERS = 6.5
"""The smallest letters that can be read, in points."""


def texts(figure: Figure) -> list[str]:
    return sorted(text.get_text() for text in figure.findobj(Text))


def problems_of(figure: Figure) -> list[str]:
    """What is wrong with a figure; its line below is the title of a table, and may say anything."""
    with the_look(getattr(figure, "options", DEFAULT)):
        return problems_in_look(figure)


def problems_in_look(figure: Figure) -> list[str]:
    """The same, in the look that the figure is drawn in."""
    lay_out(figure)
    renderer = FigureCanvasAgg(figure).get_renderer()
    figure.draw_without_rendering()  # it places labels and legends
    problems: list[str] = []
    texts = []
    for axes, _, axis in axes_of(figure):
        if axes.get_visible() and axes.axison:
            labels, wrong = look_at_axis(axis)
            texts += labels
            problems += wrong
    texts += list(other_texts(figure))
    boxes = [box_of(text, renderer) for text in texts]
    problems += look_at_places(figure, texts, boxes)
    for text in texts:
        words = FORMULA.sub("", text.get_text())
        if text is not figure._supxlabel and (raw := RAW.search(words)):
            problems.append(f"{raw[0]!r} in {words!r}")
        if round(text.get_fontsize(), 2) < LETTERS:
            problems.append(f"{text.get_fontsize():.1f} points of {words!r}")
    return problems


def axes_of(figure: Figure) -> list[tuple[Axes, str, Axis]]:
    """Every axis of a figure, also within and beside panels, with its panel and its letter."""
    panels = [each for axes in figure.axes for each in (axes, *axes.child_axes)]
    return [(panel, name, axis) for panel in panels for name, axis in panel._axis_map.items()]


def look_at_axis(axis: Axis) -> tuple[list[Text], list[str]]:
    low, high = sorted(axis.get_view_interval())
    ticks = [tick for tick in axis._update_ticks() if low <= tick.get_loc() <= high]
    shown = [tick for tick in ticks if tick.label1.get_visible() or tick.label2.get_visible()]
    pairs = [
        (tick.get_loc(), label)
        for tick in shown
        for label in (tick.label1, tick.label2)
        if label.get_visible() and label.get_text().strip()
    ]
    problems = []
    name = axis.get_label_text() or axis.axes._left_title.get_text() or str(axis)
    if axis.get_offset_text().get_text():
        problems.append(f"{axis.get_offset_text().get_text()!r} beside {name!r}")
    if shown and not pairs:
        problems.append(f"no numbers at {name!r}")
    words = [label.get_text() for _, label in pairs]
    if len(set(words)) < len(words):
        problems.append(f"equal numbers at {name!r}: {words}")
    return [label for _, label in pairs], problems


def other_texts(figure: Figure) -> Iterator[Text]:
    ticks = set()
    for axes, _, axis in axes_of(figure):
        ticks |= set(axis.findobj(Text)) - ({axis.label} if axes.axison else set())
    for text in figure.findobj(Text):
        if text not in ticks and text.get_visible() and text.get_text().strip():
            yield text


def box_of(text: Text, renderer: object) -> Bbox:
    """Where a text is; of an annotation without its arrow."""
    if isinstance(text, Annotation):
        text.update_positions(renderer)
        return Text.get_window_extent(text, renderer)
    return text.get_window_extent(renderer)


def look_at_places(figure: Figure, texts: list[Text], boxes: list[Bbox]) -> list[str]:
    """Texts that leave the page, and pairs that lie over each other."""
    problems = []
    slack = SLACK * figure.dpi
    page = np.array([[-slack, -slack], figure.bbox.max + slack])
    for text, box in zip(texts, boxes, strict=True):
        if not ((box.min >= page[0]).all() and (box.max <= page[1]).all()):
            problems.append(f"{text.get_text()!r} leaves the page")
    upright = [i for i, text in enumerate(texts) if text.get_rotation() % 90 == 0]
    for i, j in itertools.combinations(upright, 2):
        low = np.maximum(boxes[i].min, boxes[j].min)
        high = np.minimum(boxes[i].max, boxes[j].max)
        if (high - low > slack).all():
            problems.append(f"{texts[i].get_text()!r} lies over {texts[j].get_text()!r}")
    return problems
