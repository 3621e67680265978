"""The pictures of a film: top, path of its axis, arrows, and the inclination against time."""

import re
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from filming.solids import surface
from filming.take import Take

AZIMUTH, ELEVATION = -1.05, 0.32
"""Where the eye is, rad."""

DPI = 100
LIGHT = np.array([0.4, -0.6, 0.9]) / np.linalg.norm([0.4, -0.6, 0.9])
LONGEST = 0.8
"""Of the way from the pivot to the tip: the longest arrow of each kind."""

JOINED = np.radians(15)
"""Rows that are farther apart are not joined to a path."""

FADES_IN, FAINTEST = 0.12, 0.2
"""Part of the film after which most of a path's strength is gone, and what is left of it."""

SHEET = Path(__file__).resolve().parent.parent / "reporting" / "page" / "page.css"
"""The style sheet of the report, whose stage has the colours of a film."""

NAMES = {
    "momentum": "angular momentum",
    "omega": "angular velocity",
    "force": "support force",
}
ORDER = {"far": 1, "rod behind": 2, "body": 3, "rod before": 4, "near": 5, "arrows": 6}


def palette(dark: bool) -> dict[str, str]:
    """The colours of the page by their names, light or dark."""
    light, night = SHEET.read_text(encoding="utf-8").split("prefers-color-scheme: dark", 1)
    sheet = night.partition("}")[0] if dark else light
    return dict(re.findall(r"--(?:body-)?([a-z]+): (#\w+);", sheet))


def project(points: np.ndarray) -> np.ndarray:
    """Points of space as seen from far away: to the right, upward, and towards the eye."""
    ca, sa, ce, se = np.cos(AZIMUTH), np.sin(AZIMUTH), np.cos(ELEVATION), np.sin(ELEVATION)
    x, y, z = np.moveaxis(points, -1, 0)
    towards = ca * x + sa * y
    return np.stack((ca * y - sa * x, ce * z - se * towards, ce * towards + se * z), axis=-1)


class Camera:
    """Draws the pictures of a take, one after the other, on one figure."""

    def __init__(self, take: Take, size: tuple[int, int], arrows: list[str], dark: bool) -> None:
        """Prepare all that is the same in every picture."""
        self.take = take
        self.colours = palette(dark)
        self.scale = size[1] / 720
        self.polygons, kinds = self.body()
        self.paints = np.array([to_rgb(self.colours[k]) for k in ("mark", "even", "odd")])[kinds]
        reach = np.linalg.norm(self.polygons.reshape(-1, 3), axis=1).max(initial=0.0)
        height = self.polygons.reshape(-1, 3) @ take.body.axis()
        self.tip = 1.06 * max(height.max(initial=0.0), np.linalg.norm(take.body.centre)) or 1.0
        self.reach = max(reach, self.tip)
        self.path = project(self.tip * take.axis)
        self.is_joined = take.steps() <= JOINED
        self.arrows = arrows
        self.figure = Figure(
            figsize=(size[0] / DPI, size[1] / DPI), dpi=DPI, facecolor=self.colours["stage"]
        )
        self.canvas = FigureCanvasAgg(self.figure)
        self.space = self.figure.add_axes((0, 0.14, 1, 0.86))
        self.add_space()
        self.add_chart()
        self.moving = self.add_moving()

    def body(self) -> tuple[np.ndarray, np.ndarray]:
        """All polygons of the body, in body axes, and the kinds of their colours."""
        made = [surface(solid) for solid in self.take.solids]
        if not made:
            return np.zeros((0, 4, 3)), np.zeros(0, int)
        polygons, kinds = zip(*made, strict=True)
        return np.concatenate(polygons), np.concatenate(kinds)

    def add_space(self) -> None:
        """The sphere of the tip and its circles: the far half fainter; the vertical."""
        space, colours = self.space, self.colours
        space.set_axis_off()
        room = 1.04 * self.reach
        aspect = self.figure.get_figwidth() / (0.86 * self.figure.get_figheight())
        space.set_xlim(-room * aspect, room * aspect)
        space.set_ylim(-room, room)
        angle = np.linspace(0, 2 * np.pi, 121)
        c, s, o = np.cos(angle), np.sin(angle), np.zeros_like(angle)
        for circle in ((c, s, o), (c, o, s), (o, c, s)):
            points = project(self.tip * np.stack(circle, axis=-1))
            for side, alpha in ((points[:, 2] >= 0, 1.0), (points[:, 2] <= 0, 0.5)):
                shown = side | np.roll(side, 1)  # no gaps where it passes the edge
                x, y = (np.where(shown, points[:, i], np.nan) for i in (0, 1))
                width = 1.1 * self.scale
                space.plot(x, y, color=colours["faint"], lw=width, alpha=alpha, zorder=ORDER["far"])
        quiet = {"color": colours["quiet"], "zorder": ORDER["far"]}
        small = quiet | {"size": 12 * self.scale, "ha": "center", "va": "center", "style": "italic"}
        for axis, letter in zip(np.eye(3), "xyz", strict=True):
            x, y, _ = project(0.34 * self.reach * axis)
            space.plot([0, x], [0, y], lw=1.2 * self.scale, **quiet)
            space.text(1.15 * x, 1.15 * y, letter, **small)
        large = {"color": colours["ink"], "size": 15 * self.scale, "va": "center"}
        self.figure.text(0.02, 0.955, self.take.title, **large)
        for i, name in enumerate(self.arrows):
            style = {"size": 11 * self.scale, "ha": "right", "va": "center"}
            words = f"{NAMES[name]} \N{EM DASH}"
            self.figure.text(0.98, 0.955 - 0.04 * i, words, color=colours[name], **style)

    def add_chart(self) -> None:
        """The inclination against time."""
        take, colours = self.take, self.colours
        chart = self.figure.add_axes((0.075, 0.062, 0.9, 0.1))
        chart.patch.set_alpha(0)
        chart.plot(take.times, np.degrees(take.theta), color=colours["quiet"], lw=1.1 * self.scale)
        chart.set_xlim(take.times[0], take.times[-1])
        for side in ("top", "right"):
            chart.spines[side].set_visible(False)
        for spine in chart.spines.values():
            spine.set_color(colours["faint"])
        chart.tick_params(colors=colours["quiet"], labelsize=9 * self.scale, length=3 * self.scale)
        chart.yaxis.set_major_locator(MaxNLocator(3))
        chart.set_ylabel("θ, degrees", color=colours["quiet"], size=9 * self.scale)
        chart.set_xlabel("time, s", color=colours["quiet"], size=9 * self.scale, labelpad=1)
        self.chart = chart

    def add_moving(self) -> dict[str, object]:
        """What differs from picture to picture."""
        space, colours, scale = self.space, self.colours, self.scale
        paths = {
            name: LineCollection([], linewidths=width * scale, capstyle="butt", zorder=ORDER[name])
            for name, width in (("far", 1.6), ("near", 2.6))
        }
        body = PolyCollection([], zorder=ORDER["body"], linewidths=0.4 * scale)
        for collection in (*paths.values(), body):
            space.add_collection(collection, autolim=False)
        (rod,) = space.plot([], [], color=colours["rod"], lw=3 * scale, solid_capstyle="butt")
        (knob,) = space.plot([], [], "o", color=colours["rod"], ms=6 * scale)
        arrows = {}
        for name in self.arrows:
            (shaft,) = space.plot([], [], color=colours[name], lw=3 * scale, zorder=ORDER["arrows"])
            (head,) = space.fill([0, 0, 0], [0, 0, 0], color=colours[name], zorder=ORDER["arrows"])
            arrows[name] = (shaft, head)
        cursor = self.chart.axvline(self.take.times[0], color=colours["mark"], lw=1.8 * scale)
        style = {"size": 12 * scale, "va": "center", "family": "DejaVu Sans Mono"}
        clock = self.figure.text(0.02, 0.91, "", color=colours["quiet"], **style)
        lines = {"rod": rod, "knob": knob, "arrows": arrows, "cursor": cursor, "clock": clock}
        return paths | lines | {"body": body}

    def shoot(self, picture: int) -> bytes:
        """A picture, three bytes a pixel."""
        take, row = self.take, self.take.rows[picture]
        self.show_path(row)
        self.show_body(take.rotations[row])
        for name in self.arrows:
            self.show_arrow(name, take.vectors[name][row])
        time = take.times[row]
        self.moving["cursor"].set_xdata([time, time])
        self.moving["clock"].set_text(f"t = {time:.3f} s   θ = {np.degrees(take.theta[row]):.2f}°")
        self.canvas.draw()
        return np.ascontiguousarray(np.asarray(self.canvas.buffer_rgba())[:, :, :3]).tobytes()

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
        colours = np.column_stack((np.tile(to_rgb(self.colours["trace"]), (len(age), 1)), strength))
        for name, chosen, part in (("near", near & joined, 1.0), ("far", ~near & joined, 0.55)):
            self.moving[name].set_segments(pieces[chosen])
            self.moving[name].set_color(colours[chosen] * [1, 1, 1, part])

    def show_body(self, rotation: np.ndarray) -> None:
        """Rod and solids; the polygons from the farthest to the nearest, lit from above."""
        tip = project(rotation @ (self.tip * self.take.body.axis()))
        before = ORDER["rod behind" if tip[2] > 0 else "rod before"]
        for name, points in (("rod", [np.zeros(3), tip]), ("knob", [tip])):
            self.moving[name].set_data(*np.array(points).T[:2])
            self.moving[name].set_zorder(before)
        if not len(self.polygons):
            return
        corners = self.polygons @ rotation.T
        normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
        seen = project(corners)
        facing = np.sign(project(normals)[:, 2])[:, None] * normals
        shade = 0.62 + 0.38 * np.clip(facing @ LIGHT, 0, 1)
        order = np.argsort(seen[:, :, 2].mean(axis=1))
        paints = np.column_stack((self.paints * shade[:, None], np.full(len(order), 0.93)))[order]
        body = self.moving["body"]
        body.set_verts(seen[order, :, :2])
        body.set_facecolor(paints)
        body.set_edgecolor(paints)

    def show_arrow(self, name: str, vector: np.ndarray) -> None:
        """A vector from the pivot; the longest of its kind has the same length in every film."""
        largest = np.linalg.norm(self.take.vectors[name], axis=1).max() or 1.0
        end = project(LONGEST * self.tip * vector / largest)[:2]
        length = np.hypot(*end)
        shaft, head = self.moving["arrows"][name]
        size = min(0.07 * self.tip, length)
        along = end / length if length > 0 else np.array([0.0, 1.0])
        across = np.array([-along[1], along[0]])
        base = end - size * along
        shaft.set_data([0, base[0]], [0, base[1]])
        head.set_xy([end, base + 0.4 * size * across, base - 0.4 * size * across])
