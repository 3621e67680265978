"""The stage of a film: a top in space with the path of its axis and its arrows, or two of them."""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb

from filming.solids import surface
from filming.take import Take
from spintop_figures.tables.words import say

LIGHT = np.array([0.4, -0.6, 0.9]) / np.linalg.norm([0.4, -0.6, 0.9])
LONGEST = 0.8
"""Of the way from the pivot to the tip: the longest arrow of each kind."""

JOINED = np.radians(15)
"""Rows that are farther apart are not joined to a path."""

FADES_IN, FAINTEST = 0.12, 0.2
"""Part of the film after which most of a path's strength is gone, and what is left of it."""

OPAQUE, GHOSTLY = 0.5, 0.16
"""How opaque a body is: path, rod and arrows are seen through it; and the ghost of a second one."""

NAMES = {"momentum": "angular momentum", "omega": "angular velocity", "force": "support force"}
ORDER = {"far": 1, "rod behind": 2, "body": 3, "rod before": 4, "near": 5, "arrows": 6}


@dataclass(frozen=True)
class View:
    """Where the eye is, degrees: azimuth about the vertical, and elevation over the horizon."""

    azimuth: float = -60.0
    elevation: float = 18.0


FROM_ASIDE = View()


@dataclass(frozen=True)
class Look:
    """How tops are drawn: with which colours and arrows, seen from where, how thick and large."""

    colours: dict[str, str]
    arrows: list[str]
    view: View
    scale: float
    letters: float
    """In points."""


def project(points: np.ndarray, view: View = FROM_ASIDE) -> np.ndarray:
    """Points of space as seen from far away: to the right, upward, and towards the eye."""
    azimuth, elevation = np.radians([view.azimuth, view.elevation])
    ca, sa, ce, se = np.cos(azimuth), np.sin(azimuth), np.cos(elevation), np.sin(elevation)
    x, y, z = np.moveaxis(points, -1, 0)
    towards = ca * x + sa * y
    return np.stack((ca * y - sa * x, ce * z - se * towards, ce * towards + se * z), axis=-1)


class Shape:
    """The polygons of the body of a take, in body axes, and what they take up."""

    def __init__(self, take: Take) -> None:
        made = [surface(solid) for solid in take.solids]
        empty = [(np.zeros((0, 4, 3)), np.zeros(0, int))]
        polygons, kinds = zip(*(made or empty), strict=True)
        self.polygons, self.kinds = np.concatenate(polygons), np.concatenate(kinds)
        corners = self.polygons.reshape(-1, 3)
        height = (corners @ take.body.axis()).max(initial=0.0)
        self.tip = 1.06 * max(height, np.linalg.norm(take.body.centre)) or 1.0
        self.reach = max(np.linalg.norm(corners, axis=1).max(initial=0.0), self.tip)


class Stage:
    """Draws tops in space on axes without a frame: the first is solid, a second one its ghost."""

    def __init__(
        self, axes: Axes, takes: list[Take], look: Look, reach: float, aspect: float
    ) -> None:
        """Prepare all that is the same in every picture."""
        self.axes, self.look, self.reach = axes, look, reach
        shapes = [Shape(take) for take in takes]
        self.tip = shapes[0].tip
        self.add_space(aspect)
        self.actors = [
            Actor(self, take, shape, arrows=[] if i else look.arrows, is_ghost=i > 0)
            for i, (take, shape) in enumerate(zip(takes, shapes, strict=True))
        ]

    def add_space(self, aspect: float) -> None:
        """The sphere of the tip and its circles: the far half fainter; the vertical."""
        space, look = self.axes, self.look
        space.set_axis_off()
        room = 1.04 * self.reach
        space.set_xlim(-room * aspect, room * aspect)
        space.set_ylim(-room, room)
        angle = np.linspace(0, 2 * np.pi, 121)
        c, s, o = np.cos(angle), np.sin(angle), np.zeros_like(angle)
        faint = {"color": look.colours["faint"], "lw": 1.1 * look.scale, "zorder": ORDER["far"]}
        for circle in ((c, s, o), (c, o, s), (o, c, s)):
            points = project(self.tip * np.stack(circle, axis=-1), look.view)
            for side, alpha in ((points[:, 2] >= 0, 1.0), (points[:, 2] <= 0, 0.5)):
                shown = side | np.roll(side, 1)  # no gaps where it passes the edge
                x, y = (np.where(shown, points[:, i], np.nan) for i in (0, 1))
                space.plot(x, y, alpha=alpha, **faint)
        quiet = {"color": look.colours["quiet"], "zorder": ORDER["far"]}
        small = quiet | {"size": look.letters, "ha": "center", "va": "center", "style": "italic"}
        for axis, letter in zip(np.eye(3), "xyz", strict=True):
            x, y, _ = project(0.34 * self.reach * axis, look.view)
            space.plot([0, x], [0, y], lw=1.2 * look.scale, **quiet)
            space.text(1.15 * x, 1.15 * y, letter, **small)

    def show(self, picture: int) -> None:
        """Bring all tops to a picture of the film."""
        for actor in self.actors:
            actor.show(actor.take.rows[picture])


class Actor:
    """A top on a stage."""

    def __init__(
        self, stage: Stage, take: Take, shape: Shape, *, arrows: list[str], is_ghost: bool
    ) -> None:
        """Put it on the stage."""
        self.stage, self.take, self.shape, self.is_ghost = stage, take, shape, is_ghost
        axes, colours, scale = stage.axes, stage.look.colours, stage.look.scale
        names = ("ghost",) * 3 if is_ghost else ("mark", "even", "odd")
        self.paints = np.array([to_rgb(colours[name]) for name in names])[shape.kinds]
        self.path = project(stage.tip * take.axis, stage.look.view)
        self.is_joined = take.steps() <= JOINED
        self.paths = {
            name: LineCollection([], linewidths=width * scale, capstyle="butt", zorder=ORDER[name])
            for name, width in (("far", 1.6), ("near", 2.6))
        }
        self.body = PolyCollection([], zorder=ORDER["body"], linewidths=0)
        for collection in (*self.paths.values(), self.body):
            axes.add_collection(collection, autolim=False)
        rod = colours["ghost" if is_ghost else "rod"]
        (self.rod,) = axes.plot([], [], color=rod, lw=3 * scale, solid_capstyle="butt")
        (self.knob,) = axes.plot([], [], "o", color=rod, ms=6 * scale)
        self.arrows = {name: self.add_arrow(name) for name in arrows}

    def add_arrow(self, name: str) -> tuple:
        """Shaft, head and name of an arrow."""
        axes, look = self.stage.axes, self.stage.look
        style = {"zorder": ORDER["arrows"], "color": look.colours[name]}
        (shaft,) = axes.plot([], [], lw=3 * look.scale, **style)
        (head,) = axes.fill([0, 0, 0], [0, 0, 0], **style)
        words = axes.text(0, 0, f" {say(NAMES[name])} ", size=look.letters, va="center", **style)
        return shaft, head, words

    def show(self, row: int) -> None:
        """Bring it to a row of its motion."""
        self.show_path(row)
        self.show_body(self.take.rotations[row])
        for name in self.arrows:
            self.show_arrow(name, self.take.vectors[name][row])

    def show_path(self, row: int) -> None:
        """The past of the tip: the older, the fainter; its far half is thinner."""
        take = self.take
        points, times = self.path[: row + 1], take.times[: row + 1]
        if row == 0:
            return
        age = (times[-1] - times[1:]) / (take.times[-1] - take.times[0])
        strength = FAINTEST + (1 - FAINTEST) * np.exp(-age / FADES_IN)
        pieces = np.stack((points[:-1, :2], points[1:, :2]), axis=1)
        near, joined = points[1:, 2] >= 0, self.is_joined[:row]
        paint = to_rgb(self.stage.look.colours["ghost" if self.is_ghost else "trace"])
        colours = np.column_stack((np.tile(paint, (len(age), 1)), strength))
        for name, chosen, part in (("near", near & joined, 1.0), ("far", ~near & joined, 0.55)):
            self.paths[name].set_segments(pieces[chosen])
            self.paths[name].set_color(colours[chosen] * [1, 1, 1, part])

    def show_body(self, rotation: np.ndarray) -> None:
        """Rod and solids; the polygons from the farthest to the nearest, lit from above."""
        view, length = self.stage.look.view, self.stage.tip
        tip = project(rotation @ (length * self.take.body.axis()), view)
        before = ORDER["rod behind" if tip[2] > 0 else "rod before"]
        for line, points in ((self.rod, [np.zeros(3), tip]), (self.knob, [tip])):
            line.set_data(*np.array(points).T[:2])
            line.set_zorder(before)
        if not len(self.shape.polygons):
            return
        corners = self.shape.polygons @ rotation.T
        normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
        seen = project(corners, view)
        facing = np.sign(project(normals, view)[:, 2])[:, None] * normals
        shade = 0.62 + 0.38 * np.clip(facing @ LIGHT, 0, 1)
        order = np.argsort(seen[:, :, 2].mean(axis=1))
        opacity = np.full(len(order), GHOSTLY if self.is_ghost else OPAQUE)
        self.body.set_verts(seen[order, :, :2])
        self.body.set_facecolor(np.column_stack((self.paints * shade[:, None], opacity))[order])

    def show_arrow(self, name: str, vector: np.ndarray) -> None:
        """A vector from the pivot; the longest of its kind has the same length in every film."""
        largest = np.linalg.norm(self.take.vectors[name], axis=1).max() or 1.0
        end = project(LONGEST * self.stage.tip * vector / largest, self.stage.look.view)[:2]
        length = np.hypot(*end)
        shaft, head, words = self.arrows[name]
        size = min(0.07 * self.stage.tip, length)
        along = end / length if length > 0 else np.array([0.0, 1.0])
        across = np.array([-along[1], along[0]])
        base = end - size * along
        shaft.set_data([0, base[0]], [0, base[1]])
        head.set_xy([end, base + 0.4 * size * across, base - 0.4 * size * across])
        words.set_position(end)
        words.set_ha("left" if end[0] >= 0 else "right")
