"""Long waves of dunes under the saturating friction law: the flux of the bed in closed form."""

from functools import partial

import mpmath as mp
import numpy as np
import pytest
import sympy as sp

from asymptotics import assert_order, bed, expand, thin
from asymptotics.cli import main as asymptotics
from asymptotics.errors import BadParameter
from asymptotics.flows.dune import b, leading_flux, saturating_flux
from asymptotics.limits import OrderMismatch
from stability import dispersion, flows
from stability.cli import main as stability

VALUES = {"shields": 1.4, "mu1": 0.4, "mu2": 0.6, "I0": 0.3}
BED = flows.Dune(shields=1.4, law=flows.Saturating(0.4, 0.6, 0.3))


def flux(**values):
    """shields dQ/d(shields) as a number of 30 digits."""
    names = {symbol.name: symbol for symbol in saturating_flux().free_symbols}
    return saturating_flux().evalf(30, subs={names[name]: sp.Rational(str(value)) for name, value in values.items()})


def test_the_linear_law_gives_what_the_order_by_order_expansion_gives():
    """Two derivations: volume and equilibrium here, the system of perturbations there."""
    found = bed.shields * bed.flux_slope(lambda mu: (mu / thin.mu1 - 1) / b)
    expected = leading_flux().subs({symbol: bed.shields for symbol in leading_flux().free_symbols
                                    if symbol.name == "shields"})
    assert sp.simplify(found - expected) == 0


@pytest.mark.parametrize("values", [VALUES, {"shields": 1.05, "mu1": 0.3, "mu2": 0.7, "I0": 0.1},
                                    {"shields": 1.49, "mu1": 0.5, "mu2": 0.75, "I0": 2.0}])
def test_the_flux_is_its_integral(values):
    theta, mu1, mu2, I0 = (mp.mpf(str(value)) for value in values.values())
    with mp.workdps(40):
        def Q(stress):
            return mp.quad(lambda p: (p - 1) * mp.sqrt(p) * I0 * mu1 * (stress - p) / (mu2 * p - mu1 * stress),
                           (1, stress))

        expected = theta * mp.diff(Q, theta)
    assert abs(mp.mpf(flux(**values)) / expected - 1) < 1e-13
    assert abs(mp.mpf(flux(**{**values, "mu2": values["mu2"] * 1.01})) / expected - 1) > 1e-3


def test_a_large_I0_is_the_linear_law():
    """At fixed (mu2 - mu1)/(mu1 I0) = 1.5 the flux tends to that of b = 1.5 like 1/I0."""
    linear = leading_flux().subs({symbol: {"shields": sp.Rational(9, 5), "b": sp.Rational(3, 2)}[symbol.name]
                                  for symbol in leading_flux().free_symbols})
    off = [abs(float(flux(shields=1.8, mu1=0.4, mu2=0.4 + 0.6 * I0, I0=I0) / linear - 1)) for I0 in (1e2, 1e3, 1e4)]
    np.testing.assert_allclose(-np.diff(np.log10(off)), 1, atol=0.02)


@pytest.mark.parametrize(("depth", "span"), [(np.inf, (1e-7, 1e-5)), (5.0, (1e-5, 1e-3))], ids=["unbounded", "lid"])
def test_dunes_approach_the_closed_form(depth, span):
    k = np.geomspace(*span, 7)
    bed_of = partial(flows.Dune, shields=1.4, Re=20.0, depth=depth)
    found = dispersion(bed_of(law=BED.law), k)
    values = VALUES | ({"Re": 20, "depth": "inf"} if np.isinf(depth) else {"Re": 20, "depth": 5})
    assert_order(found.sigma, expand("dune", **values), k, error=found.error)
    wrong = dispersion(bed_of(law=flows.Saturating(0.4, 0.602, 0.3)), k)  # mu2 - mu1 is 1 % off
    with pytest.raises(OrderMismatch):
        assert_order(wrong.sigma, expand("dune", **values), k, error=wrong.error)


def test_on_the_command_line(capsys, tmp_path):
    file = str(tmp_path / "bed.csv")
    words = ["--shields", "1.4", "--law", "saturating", "--mu1", "0.4", "--mu2", "0.6", "--I0", "0.3"]
    assert stability(["dispersion", "dune", *words, "--k", "1e-7:1e-5:7", "-o", file]) == 0
    assert asymptotics(["check", "dune", file]) == 0
    assert "agrees with the expected 2.0000" in capsys.readouterr().out
    assert asymptotics(["check", "dune", file, "--I0", "0.303"]) == 3
    assert asymptotics(["evaluate", "dune", "--regime", "saturating", "--shields", "1.4", "--k", "1e-4"]) == 0
    assert asymptotics(["expand", "dune", "--regime", "saturating", "--numbers"]) == 2  # shields is 2
    assert "shields must be less than mu2/mu1" in capsys.readouterr().err


@pytest.mark.parametrize(("values", "message"), [
    ({"shields": 1.6, "mu1": 0.4, "mu2": 0.6, "I0": 0.3, "Re": 10}, "shields must be less than mu2/mu1 = 3/2"),
    ({"shields": 1.2, "mu1": 0.6, "mu2": 0.4, "I0": 0.3, "Re": 10}, "mu2 must exceed mu1"),
])
def test_refusals(values, message):
    with pytest.raises(BadParameter, match=message):
        expand("dune", "saturating", **values)
