"""Constants of motions over thousands of nutations, as exact as the arithmetic allows."""

import math

import pytest

NUTATIONS, STEPS_A_NUTATION = 2000, 11
SCENE = """\
&study kind = 'trajectory' /
&top mass = 1  inertia = {first}, {first}, 0.25  length = 0.8660254037844387 /
&initial theta = {theta}  psi_rate = {rate} /
&span t_end = {end}  samples = 2 /
&integration formulation = '{formulation}'  method = 'taylor'  max_steps = 10000000 /
&output columns = 't', 'energy_error', 'lz', 'norm_error' /
"""
TOPS, I3 = 24, 0.25
CHI_SQUARE = 91.0
"""So large is the sum of squares of 24 standard normal numbers in one case of 10^9."""
SIZES = {"energy": 0.8, "momentum": 2.0, "norm": 0.25}
"""The standard deviation after n steps in 1e-16 sqrt(n): of the walk, not of one drawing of it."""


def scene_of(formulation, k, nutations):
    """The input of the k-th top. Its momentum about the axis is the same in each step."""
    share = k / (TOPS - 1)
    data = {"first": 0.895 + 0.04 * share, "theta": 0.49 + 0.68 * share, "rate": rate_of(k)}
    return SCENE.format(formulation=formulation, end=1.5 * nutations, **data)


def rate_of(k):
    """The spin of the k-th top."""
    return 4.94 - 1.13 * k / (TOPS - 1)


@pytest.mark.parametrize("formulation", ["space_frame", "rigid_body"])
def test_constants(spin, formulation):
    """Energy, momentum about the vertical and norm wander by the root of steps.

    Errors of independent walks of n steps are normal with a variance of n, so that the sum of
    their squares scatters as chi-square.
    """
    unit = 1e-16 * math.sqrt(NUTATIONS * STEPS_A_NUTATION)
    sums = dict.fromkeys(SIZES, 0.0)
    for k in range(TOPS):
        scene = scene_of(formulation, k, NUTATIONS)
        start, end = spin(scene, "integration.relative_tolerance=0").rows.iloc[[0, -1]].itertuples()
        ends = {
            "energy": end.energy_error,
            "momentum": (end.lz - start.lz) / (I3 * rate_of(k)),
            "norm": end.norm_error,
        }
        for name, error in ends.items():
            sums[name] += (error / (SIZES[name] * unit)) ** 2
    assert all(total < CHI_SQUARE for total in sums.values()), sums


def test_zero(spin):
    """Zero is the finest tolerance of the method, and a tolerance below it is refused."""
    scene = scene_of("rigid_body", 0, 10)
    zero, finest = (spin(scene, f"integration.relative_tolerance={x}").texts for x in (0, "1e-20"))
    assert zero.lz.equals(finest.lz)
    # Sweeps in lanes reach it as well.
    sweep = ("study.kind=sweep", "sweep.parameter=initial.theta", "sweep.values(1,:)=0.3,0.9")
    columns = "output.columns=energy_error_max"
    rows = spin(scene, "integration.relative_tolerance=0", *sweep, columns).rows
    assert (rows.energy_error_max < 1e-14).all()
    error = spin.refuse(scene, "integration.relative_tolerance=1e-21")
    assert "cannot reach a tolerance below 1e-20" in error
