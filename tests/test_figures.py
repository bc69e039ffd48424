"""The laws that the first figure draws beside the computed curves."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from stability import flows
from stability.optimum import k_max_sweep

FIGURES = Path(__file__).parents[1] / "figures"


@pytest.fixture
def figure(monkeypatch):
    """The script figures/k_max.py as a module."""
    monkeypatch.syspath_prepend(str(FIGURES))
    import k_max

    yield k_max
    for name in ("k_max", "style"):
        del sys.modules[name]


def remainders(law, bed, Re):
    """Relative differences (quantities, Re) of k_max and its growth rate from a law."""
    found = k_max_sweep(replace(bed, Re=value) for value in Re)
    return np.array([[optimum.k_max, optimum.growth_rate] for optimum in found]).T / np.array(law(np.array(Re))) - 1


@pytest.mark.parametrize("bed", [flows.Dune(), flows.Dune(shields=3.0)], ids=["shields 2", "shields 3"])
def test_large_Re(figure, bed):
    """k_max ~ Re^(1/8), growth ~ Re^(1/4), with the coefficients of the half-space and a remainder ~ Re^(-1/8)."""
    near, far = remainders(figure.large_Re(bed), bed, [1e12, 1e16]).T
    assert np.all(np.abs(far) < 0.01)
    np.testing.assert_allclose(np.log10(near / far), 4 / 8, atol=0.1)


def test_small_Re(figure):
    """k_max ~ Re^(1/2), growth ~ Re, with a remainder that falls at least like Re^(1/2)."""
    near, far = remainders(figure.small_Re(flows.Dune()), flows.Dune(), [1e-4, 1e-6]).T
    assert np.all(np.abs(far) < 1e-3)
    assert np.all(np.log10(near / far) > 0.9)
