"""A body that a vertical vibration holds upright: swept motions agree with the multipliers."""

import numpy as np

SPAN = 4.0
ONE = ("sweep.count(1)=1", "sweep.count(2)=1", "output.columns=upright_multiplier")


def test_map(spin):
    """Bodies fall where deviations grow fast enough, and stay where all multipliers are 1."""
    rows = spin("kapitza_map", "sweep.count(1)=4", "sweep.count(2)=4").rows
    growth = np.log(rows.upright_multiplier) * rows["effects.vibration_rate"] / (2 * np.pi)
    falls, stays = growth * SPAN > 6, growth < 1e-6
    assert (rows.t_end[falls] < SPAN).all()
    assert (rows.t_end[stays] == SPAN).all()
    assert min(falls.sum(), stays.sum()) >= 3
    assert (falls | stays).sum() >= 13


def test_boundary(spin):
    """The least rate that holds the body of the input is a limit of Mathieu's equation."""
    rates = ("sweep.from(1)=39.6781155", "sweep.to(1)=39.6781157", "sweep.count(1)=2")
    run = spin("kapitza_map", *ONE, *rates, "sweep.from(2)=0.15", "sweep.to(2)=0.15")
    below, above = run.rows.upright_multiplier
    assert below > 1 + 1e-6
    assert abs(above - 1) < 1e-9


def test_notes(spin):
    """Other bodies have no such multiplier, and the note says why."""
    rows = spin("kapitza_map", *ONE, "effects.drag_force=0.1").rows
    assert np.isnan(rows.upright_multiplier[0])
    assert "the only effect must be a vertical vibration" in rows.notes[0]
