"""The assertion on orders: what it accepts, what it refuses, what it says."""

import numpy as np
import pytest

from asymptotics import expand
from asymptotics.limits import OrderMismatch, TooFewPoints, assert_order, compare

K = np.geomspace(1e-3, 1e-1, 9)


def cosine(k):
    return np.cos(k)


def test_it_accepts_the_right_series():
    comparison = assert_order(cosine, lambda k: 1 - k**2 / 2, K, expected=4)
    assert comparison.agrees
    assert comparison.observed == pytest.approx(4, abs=1e-3)
    assert comparison.slope.shape == (8,)


@pytest.mark.parametrize("factor", [0.99, 1.01])
def test_it_refuses_one_percent(factor):
    with pytest.raises(OrderMismatch) as failure:
        assert_order(cosine, lambda k: 1 - factor * k**2 / 2, K, expected=4)
    message = str(failure.value)
    assert float(message.split()[2]) == pytest.approx(2, abs=0.05)
    assert "expected 4.0" in message
    assert len(message.splitlines()) == 2 + len(K)
    assert all(word in message.splitlines()[1] for word in ("k", "numeric", "series", "error", "slope"))


def test_it_refuses_an_order_too_high():
    """A series better than claimed is a wrong claim."""
    with pytest.raises(OrderMismatch):
        assert_order(cosine, lambda k: 1 - k**2 / 2, K, expected=3)


def test_arrays_functions_and_order_of_k():
    backwards = K[::-1]
    assert assert_order(cosine, lambda k: 1 - k**2 / 2, backwards, expected=4).k[0] == K[0]
    shuffled = np.random.default_rng(0).permutation(K)
    comparison = assert_order(np.cos(shuffled), 1 - shuffled**2 / 2, shuffled, expected=4)
    assert comparison.observed == pytest.approx(4, abs=1e-3)


def test_points_below_the_error_are_left_out():
    error = np.full_like(K, 1e-10)
    comparison = compare(cosine, lambda k: 1 - k**2 / 2, K, 4, error=error)
    assert 4 <= len(comparison.k) < len(K)
    with pytest.raises(TooFewPoints, match="take larger k"):
        compare(cosine, lambda k: 1 - k**2 / 2, K, 4, error=1.0)


def test_the_correction_removes_a_drift():
    k = np.geomspace(1e-2, 1, 9)
    with_drift = compare(lambda k: k**2 * np.exp(0.5 * k ** (1 / 3)), 0 * k, k, 2)
    without = compare(lambda k: k**2 * np.exp(0.5 * k ** (1 / 3)), 0 * k, k, 2, correction=1 / 3)
    assert not with_drift.agrees
    assert without.observed == pytest.approx(2)


def test_an_expansion_knows_its_order():
    law = expand("vortex", order=2, slope_deg=45, Fr2="1/10")
    longer = expand("vortex", order=4, slope_deg=45, Fr2="1/10")
    assert assert_order(longer.function(), law, K).expected == 4
    with pytest.raises(TypeError, match="expected"):
        assert_order(cosine, cosine, K)
