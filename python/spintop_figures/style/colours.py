"""Other colours for a drawn figure: those of a style sheet, or light ones on dark ground."""

from collections.abc import Callable, Mapping

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import Collection, QuadMesh
from matplotlib.colors import to_hex, to_rgb, to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Text

from spintop_figures.style.cells import Cells
from spintop_figures.style.log_axes import axes_of

DARK = "#1a1a1a"
"""The ground of dark figures."""

LIGHT_INK = 0.95
"""Lightness of what is black on white, on dark ground."""

LEAST_LIGHT, COLOURED = 0.7, 0.04
"""Least lightness of colours on dark ground, and the chroma from which one is a colour."""

TO_CONE = np.array(
    [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ]
)
TO_OKLAB = np.array(
    [
        [0.2104542553, 0.7936177850, -0.0040720468],
        [1.9779984951, -2.4285922050, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.8086757660],
    ]
)
"""Oklab of B. Ottosson (2020): linear light to cones, their cube roots to lightness and hue."""

Recolouring = Callable[[object], object]


def to_linear(colour: object) -> np.ndarray:
    """Linear light of a colour of screens."""
    rgb = np.array(to_rgb(colour))
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)


def to_oklab(colour: object) -> np.ndarray:
    """Lightness, from 0 to 1, and the two coordinates of hue."""
    return TO_OKLAB @ np.cbrt(TO_CONE @ to_linear(colour))


def from_oklab(lab: np.ndarray) -> tuple[float, ...]:
    """A colour of screens; less vivid where there is none of this lightness and hue."""
    for chroma in np.linspace(1, 0, 21):
        cones = np.linalg.solve(TO_OKLAB, lab * [1, chroma, chroma]) ** 3
        linear = np.linalg.solve(TO_CONE, cones)
        if linear.min() > -1e-3 and linear.max() < 1 + 1e-3:
            break
    linear = np.clip(linear, 0, 1)
    screen = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return tuple(np.clip(screen, 0, 1))


def is_dark(sheet: Mapping[str, object]) -> bool:
    """Whether a style sheet has dark ground."""
    ground = sheet.get("figure.facecolor", "white")
    return bool(to_oklab(ground)[0] < 0.5)


def for_dark(ground: object) -> Recolouring:
    """What makes the colours of a white figure those of one with this ground: hues stay."""
    low = to_oklab(ground)[0]

    def turn_over(colour: object) -> object:
        *rgb, alpha = to_rgba(colour)
        lab = to_oklab(rgb)
        light = LIGHT_INK - (LIGHT_INK - low) * lab[0]
        if np.hypot(*lab[1:]) > COLOURED and lab[0] < 0.8:
            light = max(light, LEAST_LIGHT)
        return (*from_oklab(np.array([light, *lab[1:]])), alpha)

    return turn_over


def replaced(by: Mapping[str, object], other: Recolouring | None = None) -> Recolouring:
    """What replaces some colours, given as hexadecimal numbers, and changes the others."""
    return lambda colour: by.get(to_hex(colour)) or (other(colour) if other else colour)


def recolour(figure: Figure, change: Recolouring) -> None:
    """Change the colours of all that a figure shows, but for those that stand for numbers."""
    outlines: dict[int, dict[str, object]] = {}
    for artist in figure.findobj(lambda artist: not lies_on_map(artist)):
        recolour_artist(artist, change)
        for effect in artist.get_path_effects() or ():
            if "foreground" in (settings := getattr(effect, "_gc", {})):
                outlines[id(settings)] = settings
    for settings in outlines.values():  # several texts may have the same
        settings["foreground"] = change(settings["foreground"])
    for _, _, axis in axes_of(figure):
        if line := getattr(axis, "line", None):  # in space
            recolour_artist(line, change)
        for which in ("major", "minor"):
            colours = axis.get_tick_params(which)
            names = ("color", "labelcolor")
            axis.set_tick_params(which, **{n: change(colours.get(n, "black")) for n in names})


def lies_on_map(artist: Artist) -> bool:
    """Whether an artist is drawn over colours that stand for numbers, or stands for one that is."""
    axes = artist.axes
    if not isinstance(axes, Axes) or not any(
        isinstance(mesh, QuadMesh) for mesh in axes.collections
    ):
        return False
    handles = legend.legend_handles if (legend := axes.get_legend()) else []
    return any(artist in each for each in (axes.texts, axes.lines, axes.collections, handles))


def recolour_artist(artist: Artist, change: Recolouring) -> None:
    """Change the colours of one artist."""
    if isinstance(artist, Text):
        artist.set_color(change(artist.get_color()))
    elif isinstance(artist, Cells):
        artist.rewrite(colour=change)
    elif isinstance(artist, Line2D):
        parts = ("color", "markerfacecolor", "markeredgecolor", "markerfacecoloralt")
        colours = {part: getattr(artist, f"get_{part}")() for part in parts}  # some are the first
        known = {part: colour for part, colour in colours.items() if str(colour) != "none"}
        artist.set(**{part: change(colour) for part, colour in known.items()})
    elif isinstance(artist, Patch):
        face, edge = artist.get_facecolor(), artist.get_edgecolor()
        artist.set(facecolor=change(face), edgecolor=change(edge))
    elif isinstance(artist, Collection) and artist.get_array() is None:
        for part in ("facecolor", "edgecolor"):
            colours = getattr(artist, f"get_{part}")()
            getattr(artist, f"set_{part}")([change(colour) for colour in colours])
