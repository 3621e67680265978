"""Many short texts, such as the cells of a table, drawn fast.

Matplotlib takes milliseconds for each text. Here the outline of a character is made once, and then
set at all its places.
"""

from collections import defaultdict
from collections.abc import Callable

import numpy as np
from matplotlib.artist import Artist, allow_rasterization
from matplotlib.backend_bases import RendererBase
from matplotlib.colors import to_rgba
from matplotlib.font_manager import FontProperties
from matplotlib.path import Path
from matplotlib.textpath import TextPath, text_to_path
from matplotlib.transforms import Affine2D

SIZE = 10
"""Of the characters, in points."""

Place = tuple[float, float]


class Cells(Artist):
    """Texts that end at given places of the axes, in its data coordinates."""

    def __init__(self) -> None:
        super().__init__()
        self.font = FontProperties(size=SIZE)
        self.widths: dict[str, float] = {}
        """Of the characters, in points."""
        self.places: dict[tuple[str, str], list[tuple[Place, float]]] = defaultdict(list)
        """By colour and character: the ends of its texts, and how far left of them it is."""
        self.set_in_layout(False)

    def get_fontsize(self) -> float:
        """The size of the characters, in points."""
        return self.font.get_size_in_points()

    def set_fontsize(self, size: float) -> None:
        """Set the size of the characters, and the distances between them with it."""
        factor = size / self.get_fontsize()
        self.font.set_size(size)
        self.widths.clear()
        self.places = {
            key: [(end, left * factor) for end, left in places]
            for key, places in self.places.items()
        }

    def rewrite(
        self,
        character: Callable[[str], str] = lambda character: character,
        colour: Callable[[object], object] = lambda colour: colour,
    ) -> None:
        """Write other characters, or in other colours."""
        self.places = {
            (colour(key[0]), character(key[1])): places for key, places in self.places.items()
        }

    def write(self, end: Place, text: str, room: str = "", colour: str = "black") -> None:
        """Write a text; between it and its end there is room for other characters."""
        left = sum(map(self.width, text + room))
        for character in text:
            self.places[colour, character].append((end, left))
            left -= self.width(character)

    def width(self, character: str) -> float:
        """The distance from a character to the next one, in points."""
        if character not in self.widths:
            size = text_to_path.get_text_width_height_descent(character, self.font, ismath=False)
            self.widths[character] = size[0]
        return self.widths[character]

    @allow_rasterization
    def draw(self, renderer: RendererBase) -> None:
        """Draw all texts, the middles of their digits on the height of their ends."""
        point = renderer.points_to_pixels(1)
        middle = TextPath((0, 0), "0", prop=self.font).get_extents().height / 2
        gc = renderer.new_gc()
        gc.set_linewidth(0)
        for (colour, character), places in self.places.items():
            ends = self.axes.transData.transform([end for end, _ in places])
            starts = ends - np.array([(left, middle) for _, left in places]) * point
            outline = TextPath((0, 0), character, prop=self.font)
            scale = Affine2D().scale(point)
            renderer.draw_markers(gc, outline, scale, Path(starts), Affine2D(), to_rgba(colour))
        gc.restore()
