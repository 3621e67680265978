"""One top: its motion at any times, and its quantities. And many tops, from arrays to arrays."""

import ctypes
import warnings
from collections.abc import Mapping, Sequence
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spintop import inputs
from spintop.animation import Animation
from spintop.library import InputError, InputWarning, MotionError, ask, library, text_of
from spintop.results import Columns, Owner, Result, Texts, described
from spintop.runs import run, sweep

ANGLES = ("t", "phi", "theta", "psi", "phi_rate", "theta_rate", "psi_rate")
"""The columns of a motion for which nothing else is asked: s, rad and rad/s."""
QUANTITIES = (
    *("theta_min", "theta_max", "delta_u", "nutation_period", "precession_per_nutation"),
    *("precession_rate", "phi_rate_max", "motion_class"),
)
"""The quantities of a nutation for which nothing else is asked."""
Items = tuple[tuple[str, Any], ...]
"""The keys of a group with their values."""
Names = tuple[str, ...]


class Motion(Columns):
    """The motion at some times: `motion["theta"]` or `motion.theta` is a column.

    A column has the shape of the times; that of a single time is a number.
    """

    def __init__(
        self, t: ArrayLike, columns: dict[str, np.ndarray], units: Texts, meanings: Texts
    ) -> None:
        """Take columns at the times `t`, s."""
        super().__init__(columns, units, meanings)
        self._t = t

    def __getattr__(self, name: str) -> np.ndarray:
        """A column by its name."""
        if name.startswith("_") or name not in self._columns:
            raise AttributeError(f"there is no column {name}")
        return self._columns[name]

    def _dimensions(self) -> dict[str, np.ndarray]:
        """The dimensions of the columns and the values along them."""
        if np.ndim(self._t) == 1:
            return {"t": np.asarray(self._t, dtype=float)}
        return {f"axis{axis + 1}": np.arange(n) for axis, n in enumerate(np.shape(self._t))}

    def __repr__(self) -> str:
        """The columns."""
        return f"<spintop.Motion of {', '.join(self)}>"


class Handle(Owner):
    """A top of the library: one input, whose method and columns are chosen."""

    def __init__(self, groups: Mapping[str, inputs.Group]) -> None:
        """Read an input."""
        calls = library()
        with inputs.without_places(groups):
            super().__init__(ask("top_new", inputs.namelist(groups), None), "top_delete")
        count = calls.spintop_top_column_count(self.place)
        _, self.units, self.meanings = described(calls.spintop_top_columns(self.place), count)
        self.warnings = inputs.plain(text_of(calls.spintop_top_warnings(self.place)))

    def motion(self, t: ArrayLike) -> Motion:
        """The motion at some times."""
        times = np.ascontiguousarray(inputs.numbers(t, "times"))
        cells = np.empty((len(self.units), *np.shape(t)))
        given = times.__array_interface__["data"][0]  # they may be read-only
        ask("top_at", self.place, times.size, given, (ctypes.c_double * 0).from_buffer(cells))
        return Motion(t, dict(zip(self.units, cells, strict=True)), self.units, self.meanings)


class Body:
    """A rigid body with one fixed point, under gravity: the keys of the group `top` of an input.

    `Body(mass=1, inertia=(0.875, 0.875, 0.25), length=0.866)`, in kg, kg m^2 and m, or
    `Body(shape="spinning_wheel", radius=0.1, thickness=0.01, density=7800, rod_length=1)`;
    `spintop.registry("parameters")` describes all keys. A composed body has `parts`, each with the
    keys of a group `part`.
    """

    def __init__(self, *, parts: Sequence[Mapping[str, Any]] = (), **keys: Any) -> None:
        """Check and copy the keys: an InputError says what is wrong."""
        self._keys, self._parts = inputs.frozen(keys), inputs.frozen(parts)
        groups = {"part": self._parts} if self._parts else {}
        some = {"initial": {"theta": 1.0}, "span": {"t_end": 1.0}}
        Handle({"top": self._keys, **groups, **some})

    @property
    def keys(self) -> dict[str, Any]:
        """The keys of the group `top`."""
        return dict(self._keys)

    @property
    def parts(self) -> tuple[dict[str, Any], ...]:
        """The keys of each part; none for a body that is not composed."""
        return tuple(map(dict, self._parts))

    def __repr__(self) -> str:
        """The call that makes it."""
        parts = {"parts": self._parts} if self._parts else {}
        shown = (f"{key}={value!r}" for key, value in (self._keys | parts).items())
        return f"Body({', '.join(shown)})"


class Top:
    """A body and its start: the keys of the group `initial` of an input.

    `Top(body, theta_deg=11.25, psi_rate=1.0)`, in rad, rad/s, or degrees where a name says so;
    `effects={"drag_force": 1e-3}` has the keys of that group. The top does not change; several
    threads may share it.
    """

    def __init__(
        self, body: Body, *, effects: Mapping[str, Any] | None = None, **start: Any
    ) -> None:
        """Check body and start: an InputError says what is wrong, an InputWarning what is odd."""
        if not isinstance(body, Body):
            raise InputError(f"body: a Body is wanted, not {type(body).__name__}", code=2)
        inputs.check_groups(effects or {}, "effects")
        self.body = body
        self._start, self._effects = inputs.frozen(start), inputs.frozen(effects or {})
        given = self.input()

        @lru_cache(maxsize=16)  # more methods and columns are not kept
        def made(integration: Items, span: Items, columns: Names, events: Names) -> Handle:
            output = {"columns": columns, "events": events or None}
            more = {"integration": dict(integration), "span": dict(span), "output": output}
            return Handle({**given, **more})

        self._made = made
        told = self._handle({}, {"t_end": 1.0}, ANGLES).warnings
        if told:
            warnings.warn(told, InputWarning, stacklevel=2)

    def __repr__(self) -> str:
        """The call that makes it."""
        effects = {"effects": self._effects} if self._effects else {}
        given = "".join(f", {key}={value!r}" for key, value in (effects | self._start).items())
        return f"Top({self.body!r}{given})"

    def __reduce__(self) -> tuple[Any, ...]:
        """The call that makes it again, in another process too."""
        return partial(Top, self.body, effects=self._effects, **self._start), ()

    @property
    def start(self) -> dict[str, Any]:
        """The keys of the group `initial`."""
        return dict(self._start)

    @property
    def effects(self) -> dict[str, Any]:
        """The keys of the group `effects`."""
        return dict(self._effects)

    def input(self, **groups: inputs.Group) -> dict[str, inputs.Group]:
        """The input of this top as a dictionary, with more groups, for `spintop.run`."""
        own = {"part": self.body.parts, "effects": self.effects}
        given = {name: keys for name, keys in own.items() if keys}
        return {"top": self.body.keys, **given, "initial": self.start, **groups}

    def _handle(
        self,
        integration: Mapping[str, Any],
        span: Mapping[str, Any],
        columns: str | Sequence[str],
        events: str | Sequence[str] = (),
    ) -> Handle:
        """The top of the library with a method, columns and events, made once."""
        keys, until = tuple(integration.items()), tuple(span.items())
        return self._made(keys, until, inputs.names_in(columns), inputs.names_in(events))

    def exact(self, t: ArrayLike, columns: str | Sequence[str] = ANGLES) -> Motion:
        """The exact solution at times `t`, s from the start, of any shape and order.

        `columns` are those of a trajectory (`spintop.registry("columns")`), or derivatives:
        `theta__top.mass` comes with the estimate of its error, `theta__top.mass_error`. An
        InputError says that the body has no closed form, or that there is no such column.
        """
        return self._handle({"method": "exact"}, {"t_end": 1.0}, columns).motion(t)

    def integrate(
        self, t: ArrayLike, columns: str | Sequence[str] = ANGLES, **integration: Any
    ) -> Motion:
        """Integrate step by step, and give the motion at increasing times `t` from 0, s.

        `integration` are keys of that group of an input: `method="dop853"`,
        `relative_tolerance=1e-12`, or `method="rk4", steps=1000` up to the last time, where
        only the times of steps can be given. Without a method it uses Taylor series; if steps or a
        formulation are given, the program chooses one for them. A MotionError says why the last
        time was not reached.
        """
        span = {"t_end": 1.0}
        if "steps" in integration or "step" in integration:
            span = {"t_end": float(np.max(inputs.numbers(t, "times"), initial=0)) or 1.0}
        if not integration.keys() & {"method", "formulation", "table", "steps", "step"}:
            integration = {"method": "taylor", **integration}
        return self._handle(inputs.frozen(integration), span, columns).motion(t)

    def events(
        self,
        events: str | Sequence[str],
        t_end: float,
        columns: str | Sequence[str] = ANGLES,
        **keys: Any,
    ) -> Result:
        """Look for events up to `t_end` s: `["lower_turning_points", "phi = 1.5 rising"]`.

        The table `events` of the result has a row for each: its name, its number and the columns at
        that instant. `keys` are those of the group `integration`, or `stop_at="..."` and
        `stop_after=n`: the n-th of these events ends the motion.
        """
        stop = {key: keys.pop(key) for key in ("stop_at", "stop_after") if key in keys}
        span = inputs.frozen({"t_end": t_end, **stop})
        handle = self._handle(inputs.frozen(keys), span, columns, events)
        return Result(ask("top_events", handle.place))

    def animate(self, t_end: float, samples: int = 1001, **integration: Any) -> Animation:
        """Show the motion up to `t_end` s in a notebook or a file: the viewer of a report.

        `integration` are keys of that group of an input; without any the program chooses.
        """
        from spintop_figures.moving.motion import GROUPS

        span = {"t_end": t_end, "samples": samples}
        output = {"columns": [name for group in GROUPS for name in group]}
        groups = self.input(integration=integration, span=span, output=output)
        return run({"study": {"title": "The top in motion"}, **groups}).animate()

    def quantities(
        self, columns: str | Sequence[str] = QUANTITIES, t_end: float = 1.0, **keys: Any
    ) -> dict[str, Any]:
        """Quantities of the motion by name: columns of a sweep (`spintop.registry("columns")`).

        Angles of the nutation in rad, its period in s and so on. Those of the end of a span are
        of `t_end` s; `keys` are those of the group `integration`.
        """
        columns = inputs.names_in(columns)
        groups = self.input(integration=keys, span={"t_end": t_end}, output={"columns": columns})
        found = sweep(groups, {}, threads=1)
        table = found.rows
        if not found.ok:
            status, note = str(table["status"][0]), table["notes"][0]
            raise MotionError(f"{status}: {note}", code=3, status=status)
        wanted = columns if all(name in table for name in columns) else tuple(table)
        return {name: table[name][0].item() for name in wanted}


def tops(
    quantities: str | Sequence[str],
    *,
    inertia1: ArrayLike,
    inertia3: ArrayLike,
    mgl: ArrayLike,
    theta: ArrayLike,
    threads: int = 1,
    **data: ArrayLike,
) -> dict[str, np.ndarray]:
    """Many undamped symmetric tops in closed form: arrays in, an array per quantity out.

    Data: moments of inertia about the pivot across and along the axis (kg m^2), m g l (N m),
    `theta` (rad), and with default 0 `phi_rate`, `theta_rate`, `omega3` (rad/s), `phi`, `psi`
    (rad), `t_end` (s); they are broadcast together. Quantities: `theta_min`, `theta_max`,
    `delta_u`, `nutation_period`, `precession_per_nutation`, `precession_rate`, `phi_rate_max`,
    and at `t_end` `theta_end`, `phi_end`, `psi_end`, `theta_rate_end`, `energy_error`. A top that
    cannot be computed has NaN in all of them. `threads` 0 takes all cores.
    """
    data = {"inertia1": inertia1, "inertia3": inertia3, "mgl": mgl, "theta": theta, **data}
    arrays = {name: inputs.numbers(values, name) for name, values in data.items()}
    try:
        shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
    except ValueError as error:
        raise InputError(f"the arrays have different shapes: {error}", code=2) from error
    columns, strides = {}, []
    for name, array in arrays.items():
        one = array.size == 1
        column = array if one else np.broadcast_to(array, shape).reshape(-1)
        if not one and (column.strides[0] < 0 or column.strides[0] % 8):
            column = column.copy()
        columns[name] = column
        strides.append(0 if one else column.strides[0] // 8)
    found = {name: np.empty(shape) for name in inputs.names_in(quantities)}
    count, steps = int(np.prod(shape, dtype=np.int64)), (ctypes.c_longlong * len(strides))(*strides)
    ask("tops", count, columns, steps, found, None, inputs.thread_count(threads))
    return found
