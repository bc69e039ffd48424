"""The response of an unbounded fluid: the series of its integral against quadrature."""

import mpmath as mp
import pytest

from asymptotics.fluid import _integral_taylor


def integral(q):
    return mp.quad(lambda s: mp.airyai(q**2 + s) * mp.exp(-q * s), [0, 4, 12, 30])


def test_the_series_of_the_integral_is_that_of_quadrature():
    q = mp.mpf("0.05")
    series = sum(mp.mpf(str(_integral_taylor(n).evalf(20))) * q**n for n in range(7))
    assert float(series) == pytest.approx(float(integral(q)), rel=1e-8)
    wrong = series - mp.mpf(str(_integral_taylor(3).evalf(20))) * q**3 / 2
    assert abs(wrong / integral(q) - 1) > 1e-6
