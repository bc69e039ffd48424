"""Every expansion against `stability`: the difference falls at the order of the first term left out.

Twenty seeded random parameter sets for each; k over two decades, chosen from the scales of the problem so
that the series is in its asymptotic range and the difference above rounding. Twins: one coefficient 1 % wrong
in the series, or in `stability`, must fail.
"""

from dataclasses import replace
from math import inf, sqrt, tan

import mpmath as mp
import numpy as np
import pytest
import references
from scipy.integrate import quad

from asymptotics import expand, fluid
from asymptotics.flows import dune
from asymptotics.limits import OrderMismatch, assert_order
from stability import dispersion, flows
from stability.equations.layer import Layer
from stability.flows import wavy_wall
from stability.flows.vortex import profile as vortex_profile

SETS = 20
POINTS = 9
EPS = np.finfo(float).eps


def draws(seed, sets=SETS, **ranges):
    """Random parameter sets: (low, high) uniform in the logarithm."""
    rng = np.random.default_rng(seed)
    for _ in range(sets):
        yield {name: float(np.exp(rng.uniform(*np.log(limits)))) for name, limits in ranges.items()}


def two_decades(highest):
    return np.geomspace(highest / 100, highest, POINTS)


def over_two_decades(numeric, expansion, k, **options):
    """`assert_order`, with no point of the two decades lost to rounding."""
    comparison = assert_order(numeric, expansion, k, **options)
    assert len(comparison.k) == POINTS
    return comparison


def check(flow, expansion, k, **options):
    relation = dispersion(flow, k)
    return over_two_decades(relation.sigma, expansion, k, error=relation.error, **options)


def broken(expansion, power, factor=1.01):
    """The expansion with one coefficient 1 % wrong."""
    return replace(expansion, terms={p: c * (factor if p == power else 1) for p, c in expansion.terms.items()})


# -- vortices --------------------------------------------------------------------------------------------

def asymptotic(order, draw, regime="long-wave"):
    """Twenty parameter sets with two decades of k each, for a truncation after `order`.

    k begins where the first term left out is 100 roundings of sigma. Sets are passed over for which the
    term after that is not small at the end: the first one left out nearly vanishes there.
    """
    accepted = []
    for values in draw:
        longer = expand("vortex", regime, order=order + 4, **values)
        c = longer.values()
        k = two_decades(100 * (100 * EPS * abs(c[2] / c[order + 2])) ** (1 / order))
        if abs(c[order + 4] / c[order + 2]) * k[-1] ** 2 < 0.5:
            accepted.append((values, longer.truncated(order), k))
        if len(accepted) == SETS:
            return accepted
    raise AssertionError("too few parameter sets")


@pytest.mark.parametrize("order", [2, 4, 6])
def test_vortices(order):
    for values, expansion, k in asymptotic(order, draws(1, slope_deg=(10, 50), Fr2=(0.01, 2), sets=100)):
        assert check(flows.Vortex(**values), expansion, k, correction=2).expected == order + 2


class LoadedVortex(flows.Vortex):
    """The thesis's regularised problem (4.26)-(4.29), without (4.28)'s extra term, by stability's methods."""

    load = 0.1

    def layers(self, names):
        top, bottom = sqrt(self.load), sqrt(1 + self.load)

        def profile(s):
            ours = vortex_profile(1 - (bottom + s * (top - bottom)), tan(np.radians(self.slope_deg)), self.Fr2)
            return replace(ours, dz=ours.dz * (bottom - top))

        return (Layer("grains", profile),)

    def long_wave(self, k):
        """Lubrication theory: -(k^2/tan slope) times the integral of (1 - z)^2/sqrt(1 + delta - z)."""
        flux, _ = quad(lambda z: (1 - z) ** 2 / sqrt(1 + self.load - z), 0, 1)
        return -(k**2) * flux / tan(np.radians(self.slope_deg))


def test_vortices_under_a_load():
    """The k^2 coefficient (4.30), corrected."""
    draw = draws(2, slope_deg=(10, 50), Fr2=(0.01, 2), delta=(1e-3, 0.5), sets=100)
    for values, expansion, k in asymptotic(2, draw, "delta"):
        load = values.pop("delta")
        flow = type("Loaded", (LoadedVortex,), {"load": load})(**values)
        check(flow, expansion, k, correction=2)


# -- the fluid ---------------------------------------------------------------------------------------------


def response(k, Re, depth=inf):
    found = wavy_wall.response(k, Re, depth)
    return {"numeric": found.value, "error": found.error}


def test_fluid_boundary_layer():
    for values in draws(3, Re=(1e-3, 1e3)):
        k = two_decades(1e-2 * sqrt(values["Re"]))
        series = fluid.boundary_layer().with_parameters(**values)
        comparison = over_two_decades(k=k, expansion=series, correction=2 / 3, **response(k, **values))
        assert comparison.expected == pytest.approx(7 / 3)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_fluid_shallow(order):
    for values in draws(4, Re=(1e-2, 1e2), depth=(0.3, 20)):
        depth = values["depth"]
        k = two_decades(0.2 / max(depth, values["Re"] * depth**3 / 30))
        series = fluid.shallow(order).with_parameters(**values)
        over_two_decades(k=k, expansion=series, correction=1, **response(k, **values))


def test_fluid_short_waves():
    for values in draws(5, Re=(1e-2, 1e2)):
        k = two_decades(500 * sqrt(values["Re"]))
        over_two_decades(k=k, expansion=fluid.short_waves().with_parameters(**values), **response(k, **values))


# -- dunes -------------------------------------------------------------------------------------------------

BED = {"shields": (1.1, 4), "mu1": (0.2, 0.8), "b": (0.3, 3)}


def shallow_scale(shields, mu1, b, Re, depth):
    return min(1 / depth, 30 / (Re * depth**3), 1 / (mu1 * shields), b * mu1 / shields**2)


def test_dunes_shallow():
    for values in draws(6, **BED, Re=(0.01, 30), depth=(1, 20)):
        expansion = expand("dune", "shallow", **values)
        k = two_decades(1e-2 * shallow_scale(**values))
        assert check(flows.Dune(**values), expansion, k).expected == 3
        check(flows.Dune(**values), expansion.truncated(1), k)


@pytest.mark.parametrize("order", ["4/3", "5/3", "2", "7/3"])
def test_dunes_boundary_layer(order):
    """Up to 5/3 the error is of order 2: the coefficient of k^{5/3} vanishes."""
    for values in draws(7, **BED, Re=(0.1, 100)):
        expansion = expand("dune", "boundary-layer", order=order, **values)
        k = two_decades({"7/3": 1e-5}.get(order, 1e-6) * min(1.0, values["Re"]))
        check(flows.Dune(**values), expansion, k, correction=1 / 3)


def test_the_last_boundary_layer_term_in_multiple_precision():
    """Powers of k^{1/3} separate slowly: the power 8/3 needs k far below what 16 digits resolve."""
    for values in draws(7, **BED, Re=(0.1, 100)):
        expansion = expand("dune", "boundary-layer", order="8/3", **values)
        differences = []
        with mp.workdps(50):
            exact = {name: mp.mpf(str(value)) for name, value in values.items()}
            for k in (mp.mpf("1e-13"), mp.mpf("1e-15")):
                series = sum((mp.mpmathify(c.evalf(50)) * k ** (mp.mpf(p.p) / p.q)
                              for p, c in expansion.terms.items()), mp.mpf(0))
                sigma = references.dune(**exact, depth=mp.inf, k=k, guess=series, digits=40)
                differences.append(abs(sigma - series))
            observed = mp.log10(differences[1] / differences[0]) / -2
        assert abs(observed - expansion.next_power) < 0.05


def test_dunes_as_Re_vanishes():
    for values in draws(8, **BED, kappa=(0.05, 2)):
        kappa = values.pop("kappa")
        expansion = expand("dune", "small-Re", kappa=kappa, **values)
        Re = two_decades(1e-5)
        found = [dispersion(flows.Dune(Re=one, **values), kappa * sqrt(one)) for one in Re]
        over_two_decades(np.array([one.sigma[0] for one in found]), expansion, Re,
                     error=np.array([one.error[0] for one in found]))


def test_dunes_just_above_yield():
    for values in draws(9, mu1=(0.2, 0.8), b=(0.3, 3), Re=(0.1, 100), depth=(0.5, 20), k=(0.1, 3)):
        k, mu1 = values.pop("k"), values.pop("mu1")
        delta = two_decades(1e-3)
        flow = flows.Dune(mu1=mu1, **values)
        found = [dispersion(replace(flow, shields=1 + one), k) for one in delta]
        over_two_decades(np.array([one.sigma[0] for one in found]), expand("dune", "near-yield", k=k, **values), delta,
                     error=np.array([one.error[0] for one in found]))


def test_the_fastest_wave_as_Re_vanishes():
    """k_max/sqrt(Re) and growth/Re at small Re, by stability; the law's own error is of order sqrt(Re)."""
    for shields in (1.2, 1.5, 2.0):
        kappa = float(dune.small_Re_maximum(shields, 0.4))
        for Re in (1e-6, 1e-8):
            k = kappa * sqrt(Re) * np.array([0.999, 1, 1.001])
            growth = dispersion(flows.Dune(shields=shields, Re=Re), k).growth_rate
            bend = growth[0] - 2 * growth[1] + growth[2]
            shift = 0.001 * (growth[0] - growth[2]) / 2 / bend
            assert bend < 0
            assert abs(shift) < 3 * sqrt(Re)


@pytest.mark.parametrize(("shields", "sign"), [(2.0, -1), (2.25, -1), (2.35, 1), (3.0, 1)])
def test_where_the_fastest_wave_does_not_follow_the_law(shields, sign):
    """Above shields = 2.29 (mu1 = 0.4, b = 1) waves of k = O(1) grow as Re -> 0, at a rate that stays finite.

    The maximum at kappa sqrt(Re) is still there, but no longer the highest.
    """
    k = np.geomspace(0.4, 4, 24)
    growth = [dispersion(flows.Dune(shields=shields, Re=Re), k).growth_rate.max() for Re in (1e-6, 1e-8)]
    assert np.sign(growth[0]) == sign
    if sign > 0:
        assert growth[1] == pytest.approx(growth[0], rel=1e-3)


# -- what must fail ----------------------------------------------------------------------------------------

BED_CASE = {"shields": 1.5, "mu1": 0.4, "b": 1.0, "Re": 1.0}
CASES = {
    "vortex": ("vortex", None, {"slope_deg": 30.0, "Fr2": 0.1}, two_decades(0.5), 2),
    "shallow": ("dune", "shallow", {**BED_CASE, "depth": 10.0}, two_decades(1e-4), 1),
    "boundary-layer": ("dune", "boundary-layer", BED_CASE, two_decades(1e-6), 1 / 3),
}


def test_one_percent_in_the_laws_for_small_Re_and_near_yield_fails():
    Re = two_decades(1e-5)
    sigma = np.array([dispersion(flows.Dune(shields=1.5, Re=one), sqrt(one)).sigma[0] for one in Re])
    law = expand("dune", "small-Re", shields=1.5, mu1=0.4, b=1, kappa=1)
    assert_order(sigma, law, Re)
    with pytest.raises(OrderMismatch):
        assert_order(sigma, broken(law, 1), Re)
    delta = two_decades(1e-3)
    sigma = np.array([dispersion(flows.Dune(shields=1 + one, Re=1), 1).sigma[0] for one in delta])
    law = expand("dune", "near-yield", b=1, Re=1, k=1, depth="inf")
    assert_order(sigma, law, delta)
    with pytest.raises(OrderMismatch):
        assert_order(sigma, broken(law, 2), delta)


@pytest.mark.parametrize("name", CASES)
def test_one_percent_in_any_coefficient_of_the_series_fails(name):
    flow_name, regime, values, k, gap = CASES[name]
    expansion = expand(flow_name, regime, **values)
    flow = {"vortex": flows.Vortex, "dune": flows.Dune}[flow_name](**values)
    check(flow, expansion, k, correction=gap)
    for power in (p for p, c in expansion.terms.items() if c != 0):
        with pytest.raises(OrderMismatch, match="differs from the expected"):
            check(flow, broken(expansion, power), k, correction=gap)


class HeavierVortex(flows.Vortex):
    """One coefficient of `stability` 1 % wrong."""

    coefficient = "eta"

    def layers(self, names):
        (layer,) = super().layers(names)

        def profile(s):
            ours = layer.profile(s)
            return replace(ours, **{self.coefficient: 1.01 * getattr(ours, self.coefficient)})

        return (replace(layer, profile=profile),)


@pytest.mark.parametrize("coefficient", ["eta", "beta", "rho"])
def test_one_percent_in_stability_fails(coefficient):
    ours = {"coefficient": coefficient, "__module__": flows.Vortex.__module__}  # or it would be refused at once
    flow = type("Broken", (HeavierVortex,), ours)(slope_deg=30.0, Fr2=0.1)
    with pytest.raises(OrderMismatch):
        check(flow, expand("vortex", slope_deg=30, Fr2=0.1), two_decades(0.5), correction=2)


@pytest.mark.parametrize("coefficient", ["eta", "beta", "alpha", "rho", "dU"])
def test_one_percent_in_the_bed_of_stability_fails(coefficient):
    class Broken(flows.Dune):
        def layers(self, names):
            (layer,) = super().layers(names)

            def profile(s):
                ours = layer.profile(s)
                return replace(ours, **{coefficient: 1.01 * getattr(ours, coefficient)})

            return (replace(layer, profile=profile),)

    Broken.__module__ = flows.Dune.__module__  # a flow from elsewhere is compared with its own limit: too early here
    _, regime, values, k, _ = CASES["shallow"]
    with pytest.raises(OrderMismatch):
        check(Broken(**values), expand("dune", regime, **values), k)
