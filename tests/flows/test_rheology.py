"""Friction laws and the condition for well-posed equations."""

from math import atan, degrees, inf, radians, tan

import numpy as np
import pytest

from stability.errors import ParameterError
from stability.flows import Linear, Saturating
from stability.flows.rheology import (
    condition,
    ill_posed,
    law_condition,
    short_wave_growth,
    well_posed_band,
)

BEADS = Saturating(mu1=tan(radians(20.9)), mu2=tan(radians(32.76)), I0=0.279)
LAWS = (BEADS, Linear(mu1=0.4, b=1.3))


@pytest.mark.parametrize("law", LAWS)
def test_inverse_undoes_friction_and_slope_is_its_derivative(law):
    inertia = np.geomspace(1e-3, 10, 9)
    np.testing.assert_allclose(law.inverse(law.mu(inertia)), inertia, rtol=1e-12)
    step = 1e-4 * inertia
    difference = (law.mu(inertia + step) - law.mu(inertia - step)) / (2 * step)
    np.testing.assert_allclose(law.slope(inertia), difference, rtol=1e-7)


@pytest.mark.parametrize("law", LAWS)
def test_friction_stays_in_its_range(law):
    low, high = law.range
    assert low < law.mu(1e-9) < law.mu(1e9) < high
    with pytest.raises(ParameterError, match="no steady flow"):
        law.inverse(low)


@pytest.mark.parametrize(("law", "parameters"), [(Saturating, (0.5, 0.4, 0.3)), (Saturating, (0.3, 0.4, 0)),
                                                 (Linear, (0.4, inf))])
def test_bad_parameters_are_refused(law, parameters):
    with pytest.raises(ParameterError, match="got"):
        law(*parameters)


def test_band_of_glass_beads_is_the_published_one():
    """Barker et al. (2015); digits recomputed."""
    low, high = well_posed_band(BEADS)
    assert low == pytest.approx(0.0193500918873711, rel=1e-12)
    assert high == pytest.approx(0.852265814865770, rel=1e-12)
    slopes = [degrees(atan(BEADS.mu(value))) for value in (low, high)]
    np.testing.assert_allclose(slopes, [21.7435874, 30.0686769], atol=5e-8)


def test_linear_law_has_no_band_for_strong_friction():
    """mu1 (1 + x)(1 + x/2) = 2 sqrt(x), x = b I, has no root if mu1 exceeds its maximum over x."""
    x = np.linspace(1e-3, 3, 20001)
    largest = np.max(2 * np.sqrt(x) / ((1 + x) * (1 + x / 2)))
    assert well_posed_band(Linear(1.001 * largest, 1.0)) is None
    low, high = well_posed_band(Linear(0.999 * largest, 1.0))
    assert low < x[np.argmax(2 * np.sqrt(x) / ((1 + x) * (1 + x / 2)))] < high


def test_condition_is_the_discriminant():
    rng = np.random.default_rng(5)
    r, mu = rng.uniform(0, 1, 50), rng.uniform(0, 1, 50)
    alpha = mu * (1 - r / 2)
    np.testing.assert_allclose(condition(r, alpha), alpha**2 - 4 * (1 - r) * r, atol=1e-14)


def test_short_waves_grow_exactly_where_ill_posed():
    rng = np.random.default_rng(6)
    r, alpha = rng.uniform(0, 1, 3000), rng.uniform(0, 1.3, 3000)
    growth = short_wave_growth(np.ones_like(r), r, alpha)
    clear = np.abs(condition(r, alpha)) > 1e-3  # the angles are sampled
    np.testing.assert_array_equal((growth > 0)[clear], ill_posed(r, alpha)[clear])
    assert 0 < np.count_nonzero(ill_posed(r, alpha)) < 3000


def test_saturating_law_is_ill_posed_exactly_where_its_condition_is_positive():
    inertia = np.geomspace(1e-4, 1e3, 500)
    mu = BEADS.mu(inertia)
    r = inertia * BEADS.slope(inertia) / mu
    np.testing.assert_array_equal(ill_posed(r, mu * (1 - r / 2)), law_condition(BEADS, inertia) > 0)


def test_newtonian_layers_are_well_posed():
    assert not ill_posed(1.0, 0.0)
    assert short_wave_growth(0.3, 1.0, 0.0, rho=2.0) == pytest.approx(-0.15)
