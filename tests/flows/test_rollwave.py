"""Roll waves: long waves, threshold and cutoff of the mu(I) model, beside the depth-averaged theory."""

import numpy as np
import pytest
from twins import table, wrong_coefficient, wrong_condition

from stability import ParameterError, dispersion, flows, spectrum
from stability.studies.critical import critical
from stability.studies.neutral import neutral_curve

WELL_POSED = (22.0, 24.0, 26.0, 28.0, 30.0)


def long_wave_growth(flow):
    """Coefficient of k^2 in sigma = -i k + k^2 (...)."""
    t = flow.mu
    return (flow.Fr2 / 10 - 2 / 5 + 3 / 5 * t**2) / flow.e0 - 3 / 10 * t


def closed_threshold(flow):
    """F_c from F_c^2 = (4/25)(4 - 6 t^2 + 3 e0 t)."""
    return np.sqrt(4 / 25 * (4 - 6 * flow.mu**2 + 3 * flow.e0 * flow.mu))


@pytest.mark.parametrize("slope", WELL_POSED)
def test_long_waves(slope):
    flow = flows.RollWave(slope_deg=slope, Fr2=3.0)
    relation = dispersion(flow, [1e-5, 2e-5])
    error = np.abs(relation.growth_rate / relation.k**2 - long_wave_growth(flow))
    assert relation.phase_speed == pytest.approx(1, abs=1e-6)
    assert np.all(error < 1e-4)
    assert error[1] / error[0] == pytest.approx(4, rel=0.02)


@pytest.mark.parametrize("twin", [wrong_coefficient(flows.RollWave(), name) for name in ("beta", "alpha", "rho", "dU")]
                         + [wrong_condition(flows.RollWave(), index) for index in (2, 3)])
def test_long_waves_twin(twin):
    relation = dispersion(twin, [1e-5], strict=False)  # without a mode where nothing obeys the long-wave limit
    assert not relation.modes or abs(relation.growth_rate[0] / 1e-10 / long_wave_growth(twin) - 1) > 2e-3 \
        or abs(relation.phase_speed[0] - 1) > 2e-3


@pytest.mark.parametrize("row", table("recomputed_rollwave_thresholds"), ids=lambda row: row["slope_deg"])
def test_long_wave_threshold(row):
    point = critical(flows.RollWave(slope_deg=float(row["slope_deg"])), "Fr2", long_wave=True)
    assert point.k == 0
    assert point.flow.froude == pytest.approx(closed_threshold(point.flow), rel=1e-12)
    assert point.flow.froude == pytest.approx(float(row["F"]), abs=1e-12)
    assert abs((closed_threshold(point.flow) / 0.4) ** 2 - point.value) <= point.error


def test_threshold_twin():
    twin = wrong_coefficient(flows.RollWave(), "rho")
    assert critical(twin, "Fr2", long_wave=True).flow.froude != pytest.approx(closed_threshold(twin), rel=1e-4)


def test_finite_waves_grow_first_at_some_slopes():
    """Growth at the long-wave threshold is b k^4 + ...: where b > 0 the flow is unstable already below it."""
    for slope, first in ((22.0, True), (24.0, True), (26.0, False), (28.0, False), (30.0, True)):
        flow = flows.RollWave(slope_deg=slope)
        at = critical(flow, "Fr2", long_wave=True).flow
        assert (dispersion(at, [0.02]).growth_rate[0] > 0) == first
        point = critical(flow, "Fr2")
        assert (point.k > 0) == first
        assert (point.value < at.Fr2) == first
        growth = dispersion(point.flow, np.geomspace(1e-2, 20, 40)).growth_rate
        assert growth.max() < 1e-7


def test_published_cutoff():
    """29 degrees, F 1.02: k h 0.55184942, c over the mean speed 2.072010."""
    flow = flows.RollWave(slope_deg=29.0)
    (point,) = neutral_curve(flow, "Fr2", [0.55184942]).points
    assert point.flow.froude == pytest.approx(1.02, abs=1e-8)
    assert point.phase_speed / 0.4 == pytest.approx(2.072010, abs=5e-7)


@pytest.mark.parametrize("slope", [22.0, 28.0])
def test_every_wavenumber_converges_where_the_model_is_well_posed(slope):
    flow = flows.RollWave(slope_deg=slope)
    relation = dispersion(flow, np.geomspace(1e-3, 400, 12))
    assert set(relation.status) == {"resolved"}
    assert np.all(relation.growth_rate[relation.k > 1] < 0)


@pytest.mark.parametrize("slope", [21.1, 32.6])
def test_short_waves_are_unresolved_where_it_is_not(slope):
    modes = spectrum(flows.RollWave(slope_deg=slope), 100.0, 1, strict=False, max_degree=128).modes
    assert all(mode.status != "resolved" for mode in modes)


@pytest.mark.parametrize("slope", [20.9, 32.8, 10.0])
def test_no_flow_outside_the_friction_angles(slope):
    with pytest.raises(ParameterError, match="slope_deg must lie between"):
        flows.RollWave(slope_deg=slope)
