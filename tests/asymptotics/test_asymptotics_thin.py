"""Thin-layer laws of steady granular flows: the thesis's leading terms, and the base flows of the other package."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

from asymptotics import assert_order, expand
from asymptotics.limits import OrderMismatch
from stability.flows import Annulus, Chute, Plate, RollWave, Saturating
from stability.studies.base import base_flow

mu1, mu2, I0, gamma, ratio = sp.symbols("mu1 mu2 I0 gamma lambda", positive=True)
DELTA = np.geomspace(2e-4, 2e-2, 9)
LAW = Saturating(mu1=0.4, mu2=0.64, I0=0.3)
NUMBERS = {"mu1": "2/5", "mu2": "16/25", "I0": "3/10"}
CASES = {
    "plate": (I0 / (2 * (ratio - 1)), {}, lambda d: base_flow(Plate(shields=1 + d, law=LAW), 2).U[-1]),  # (2.38)
    "chute": (I0 / (sp.sqrt(mu1) * (ratio - 1)), {}, lambda d: Chute(plug=1 - d, law=LAW).flux),  # (2.22)
    "annulus": (I0 * gamma / (ratio - 1), {"gamma": 5},
                lambda d: Annulus(thickness=d, gamma=5.0, law=LAW).rotation),  # (2.11)
}


@pytest.mark.parametrize("flow", CASES)
def test_the_leading_term_is_that_of_the_thesis(flow):
    found = expand(flow).coefficient(2).subs(mu2, ratio * mu1)
    assert sp.simplify(found - CASES[flow][0]) == 0


@pytest.mark.parametrize("order", [2, 3, 4])
@pytest.mark.parametrize("flow", CASES)
def test_base_flows_tend_to_the_law(flow, order):
    """Order of the remainder over two decades; each coefficient 1 % off makes it fail."""
    _, more, numeric = CASES[flow]
    law = expand(flow, order=order, **NUMBERS, **more)
    values = np.array([numeric(delta) for delta in DELTA])
    error = 3e-15 * DELTA  # shields, plug and thickness are rounded before their distance from yield is taken
    assert assert_order(values, law, DELTA, error=error, part="real").expected == order + 1
    power = max(law.terms)
    wrong = replace(law, terms={**law.terms, power: law.terms[power] * sp.Rational(101, 100)})
    with pytest.raises(OrderMismatch):
        assert_order(values, wrong, DELTA, error=error, part="real")


def test_the_flux_on_a_plane_is_a_power_of_the_depth():
    """(2.47): flux (2/5) in units of the scene, I(tan slope) times that in those of the grain."""
    law = expand("incline", **{**NUMBERS, "slope_deg": 28})
    flow = RollWave(law=LAW, slope_deg=28.0)
    number = flow.inertial_number
    assert base_flow(flow).flux["grains"] == pytest.approx(0.4, rel=1e-14)
    assert float(law.coefficient("5/2")) == pytest.approx(0.4 * number, rel=1e-13)
    assert law.coefficient("7/2") == law.coefficient("9/2") == 0
