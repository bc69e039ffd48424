"""Two-layer Couette flow: Yih's long waves, equal liquids, gravity and surface tension."""

import numpy as np
import pytest
from twins import wrong_coefficient, wrong_condition

from stability import dispersion, flows, spectrum

VISCOSITIES = [0.2, 0.7, 2.0, 5.0, 30.0]


def yih_c0(m, n):
    """Wave speed relative to the interface as k -> 0; Yih (1967), recomputed."""
    return 2 * m * n**2 * (m - 1) * (n + 1) / ((m + n) * (m**2 + 4 * m * n**3 + 6 * m * n**2 + 4 * m * n + n**4))


def yih_c1(m):
    """Im c / (k Re) as k -> 0 for equal depths; Yih (1967), recomputed."""
    return (m - 1) ** 4 * (5 * m**2 + 6 * m + 5) / (60 * (m + 1) * (m**2 + 14 * m + 1) ** 3)


def relative_speed(flow, k):
    return dispersion(flow, [k]).modes[0].c - flow.interface_speed


@pytest.mark.parametrize("m", VISCOSITIES)
def test_long_waves_at_equal_depths(m):
    flow = flows.TwoLayerCouette(viscosity_ratio=m, Re=7.0)
    c = relative_speed(flow, 1e-4)
    assert c.real == pytest.approx(yih_c0(m, 1.0), rel=1e-5)
    assert c.imag / (1e-4 * 7.0) == pytest.approx(yih_c1(m), rel=1e-5)


@pytest.mark.parametrize(("m", "n"), [(2.0, 0.5), (0.3, 3.0), (10.0, 2.0)])
def test_wave_speed_at_any_depths(m, n):
    flow = flows.TwoLayerCouette(viscosity_ratio=m, depth_ratio=n)
    assert relative_speed(flow, 1e-5).real == pytest.approx(yih_c0(m, n), rel=1e-7)


@pytest.mark.parametrize("twin", [wrong_coefficient(flows.TwoLayerCouette(Re=7.0), "beta"),
                                  wrong_coefficient(flows.TwoLayerCouette(Re=7.0), "dU"),
                                  wrong_condition(flows.TwoLayerCouette(Re=7.0), 2)])
def test_long_waves_twin(twin):
    c = relative_speed(twin, 1e-4)
    assert abs(c.real / yih_c0(2.0, 1.0) - 1) > 3e-3 or abs(c.imag / (1e-4 * 7.0) / yih_c1(2.0) - 1) > 3e-3


def test_equal_liquids_are_one():
    """Without a jump the interface is passive, of speed U, beside the spectrum of plane Couette flow.

    Both layers have depth 1 and the plate speed 1: half-width 1, half the speed difference 1/2.
    """
    k, Re = 1.0, 100.0
    found = spectrum(flows.TwoLayerCouette(viscosity_ratio=1.0, Re=Re), k, 7).sigma
    couette = spectrum(flows.Couette(Re=Re / 2), k, 6).sigma
    assert found[0] == pytest.approx(-0.5j * k, abs=1e-13)
    assert np.sort_complex(found[1:]) == pytest.approx(np.sort_complex(couette / 2 - 0.5j * k), abs=1e-11)


def test_mirror_image():
    """Upside down, seen from the upper plate, in the scales of the lower liquid: the same waves."""
    m, n, r, Re, k = 3.0, 0.6, 1.4, 20.0, 1.3
    one = spectrum(flows.TwoLayerCouette(m, n, r, Re, tension=0.2), k, 3)
    other = spectrum(flows.TwoLayerCouette(1 / m, 1 / n, 1 / r, Re * r * n / m, tension=0.2 / (r * n)), k * n, 3)
    assert one.sigma.real == pytest.approx(other.sigma.real / n, rel=1e-9)
    speeds = [[mode.phase_speed for mode in found.modes] for found in (one, other)]
    assert speeds[0] == pytest.approx([1 - speed for speed in speeds[1]], rel=1e-9)


def test_gravity_and_tension_act_alike_at_one_wavenumber():
    """(r - 1) gravity + tension k^2 is what enters."""
    k, r = 0.7, 1.5
    one = spectrum(flows.TwoLayerCouette(density_ratio=r, gravity=0.4), k, 2)
    other = spectrum(flows.TwoLayerCouette(density_ratio=r, tension=(r - 1) * 0.4 / k**2), k, 2)
    assert one.sigma == pytest.approx(other.sigma, rel=1e-12)


def test_short_waves_grow_without_surface_tension_and_decay_with_it():
    """Hooper and Boyd (1983): viscosity stratification alone makes short waves unstable."""
    k = 8.0
    assert spectrum(flows.TwoLayerCouette(Re=10.0), k, 1).sigma[0].real > 0
    assert spectrum(flows.TwoLayerCouette(Re=10.0, tension=0.1), k, 1).sigma[0].real < 0
