"""The falling film: Yih's long waves, Benjamin's threshold, surface tension."""

import numpy as np
import pytest
from twins import wrong_coefficient, wrong_condition

from stability import ParameterError, dispersion, flows, spectrum
from stability.studies.critical import critical

SLOPES = (5.0, 20.0, 45.0, 70.0, 88.0)


def yih(flow):
    """c = 2 + i k (8/15)(Re - (5/4) cot slope) + O(k^2)."""
    return 2.0, 8 / 15 * (flow.Re - 1.25 * flow.cot_slope)


def long_wave_errors(flow, k):
    """Errors of the wave speed and of the growth rate over k^2 against Yih's expansion."""
    relation = dispersion(flow, k)
    c, growth = yih(flow)
    return np.abs(relation.phase_speed - c), np.abs(relation.growth_rate / relation.k**2 - growth)


@pytest.mark.parametrize("flow", [flows.Film(Re=3.0, slope_deg=60.0), flows.Film(Re=20.0, slope_deg=10.0, We=5.0),
                                  flows.Film(Re=1.0, slope_deg=120.0)], ids=str)
def test_long_waves(flow):
    """The next terms are real in c and even: errors fall like k^2."""
    k = np.array([1e-3, 2e-3, 4e-3])
    for error in long_wave_errors(flow, k):
        assert np.all(error < 1e4 * k**2)
        assert np.diff(np.log(error)) / np.log(2) == pytest.approx([2, 2], abs=0.05)


@pytest.mark.parametrize("twin", [wrong_coefficient(flows.Film(Re=3.0), "beta"), wrong_coefficient(flows.Film(), "dU"),
                                  wrong_condition(flows.Film(), 2), wrong_condition(flows.Film(), 3)])
def test_long_waves_twin(twin):
    k = np.array([1e-3])
    speed, growth = long_wave_errors(twin, k)
    assert max(speed[0] / 2, growth[0]) > 1e-3


def test_surface_tension_steadies_long_waves_at_fourth_order():
    """Tension adds k^2 We to the pressure 2 cot/Re: -(2/3)(Re/2)(k^2 We) k^2 = -(1/3) Re We k^4 of growth."""
    k = np.array([1e-2])
    plain, tense = (dispersion(flows.Film(Re=2.0, We=We), k).growth_rate for We in (0.0, 1.0))
    assert (tense - plain) / k**4 == pytest.approx(-2 / 3, rel=1e-2)


@pytest.mark.parametrize("slope", SLOPES)
def test_threshold(slope):
    """Re = (5/4) cot slope (Benjamin 1957, Yih 1963), to 10 digits and within the error bar."""
    flow = flows.Film(slope_deg=slope)
    point = critical(flow, "Re")
    exact = 1.25 * flow.cot_slope
    assert point.k == 0
    assert point.value == pytest.approx(exact, rel=1e-11)
    assert abs(point.value - exact) <= point.error
    assert point.phase_speed == pytest.approx(2, abs=1e-12)


def test_threshold_twin():
    twin = wrong_condition(flows.Film(), 3)
    assert critical(twin, "Re").value != pytest.approx(1.25 * twin.cot_slope, rel=1e-3)


def test_slope_at_the_threshold():
    """The same curve, solved for the other parameter."""
    point = critical(flows.Film(Re=2.0), "slope_deg")
    assert point.value == pytest.approx(np.degrees(np.arctan(1.25 / 2.0)), rel=1e-11)


def test_a_hanging_film_without_flow_is_rayleigh_taylor():
    """Slow flow driven by G = -2 cot/Re: sigma = Re G (sinh 2k - 2k) / (2k (cosh 2k + 1 + 2 k^2))."""
    flow = flows.Film(Re=1e-5, slope_deg=179.0)
    k = 2.0
    sigma = spectrum(flow, k, 1).sigma[0]
    exact = -2 * flow.cot_slope * (np.sinh(2 * k) - 2 * k) / (2 * k * (np.cosh(2 * k) + 1 + 2 * k**2))
    assert sigma.real == pytest.approx(exact, rel=1e-4)


@pytest.mark.parametrize(("name", "value"), [("Re", 0.0), ("slope_deg", 180.0), ("slope_deg", 0.0), ("We", -1.0)])
def test_ranges(name, value):
    with pytest.raises(ParameterError, match=f"film: {name} must lie in"):
        flows.Film(**{name: value})


def test_no_surface_tension_is_allowed():
    assert flows.Film(We=0.0).We == 0
