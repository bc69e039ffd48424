"""Closed forms and numbers: the thesis's leading orders, their corrections, and what it leaves out."""

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from scipy.integrate import quad

from asymptotics import expand, fluid
from asymptotics.flows import dune, vortex
from asymptotics.hierarchy import ConditionsMiscounted, Hierarchy, NotTriangular, OrderNotKnown
from asymptotics.series import StillSymbolic

shields, mu1, b, Re, depth, k = sp.symbols("shields mu1 b Re depth k", positive=True)
r = sp.sqrt(shields)
slope = sp.tan(sp.pi * sp.Symbol("slope_deg", positive=True) / 180)
Fr2, delta = sp.symbols("Fr2 delta", positive=True)


def equal(first, second):
    return sp.simplify(first - second) == 0


# -- vortices ------------------------------------------------------------------------------------------


def test_vortices_to_sixth_order():
    """(4.25) and the two orders after it; phase speed zero."""
    law = expand("vortex")
    T = slope
    assert equal(law.coefficient(2), -2 / (5 * T))
    assert equal(law.coefficient(4), (950 * T**2 - 162 * Fr2) / (2025 * T**3))
    assert equal(law.coefficient(6), -2 * (62937 * Fr2**2 - 524425 * Fr2 * T**2 + 1052150 * T**4) / (3898125 * T**5))
    assert law.phase_speed == 0
    assert law.next_power == 8


def test_the_load_on_the_surface():
    """(4.30) with -4 delta^{5/2} where the thesis prints delta^{3/2}(1 - 5 delta); its other terms hold."""
    q = 1 + delta
    half = sp.Rational(1, 2)
    rest = 5 * q ** (3 * half) / 2 - 15 * delta * q**half / 2 + 5 * delta * q ** (3 * half) - q ** (5 * half)
    ours = expand("vortex", "delta").coefficient(2)
    assert equal(sp.expand(ours + 4 / (15 * slope) * (-4 * delta ** (5 * half) + rest)), 0)
    printed = -4 / (15 * slope) * (delta ** (3 * half) * (1 - 5 * delta) + rest)
    for load in (0.01, 0.1, 0.5):
        values = {delta: load, sp.Symbol("slope_deg", positive=True): 45}
        flux, _ = quad(lambda z, load=load: (1 - z) ** 2 / np.sqrt(1 + load - z), 0, 1)
        assert float(ours.subs(values)) == pytest.approx(-flux, rel=1e-10)
        assert float(printed.subs(values)) != pytest.approx(-flux, rel=1e-4)


def test_without_a_load_the_regularised_law_is_the_other():
    law = expand("vortex", "delta", order=4)
    for power in (2, 4):
        assert equal(sp.limit(law.coefficient(power), delta, 0), expand("vortex").coefficient(power))


# -- the fluid -----------------------------------------------------------------------------------------


def test_response_boundary_layer():
    """(4.71) and its next two orders; those in (i k)^{2/3}, (i k)^{4/3} vanish."""
    first, second, third = (fluid.boundary_layer_coefficient(m) for m in (1, 3, 5))
    Ai, slope = 1 / (3 ** sp.Rational(2, 3) * sp.gamma(sp.Rational(2, 3))), -1 / (
        3 ** sp.Rational(1, 3) * sp.gamma(sp.Rational(1, 3)))
    assert equal(first, -(sp.cbrt(3) / sp.gamma(sp.Rational(2, 3))) * sp.cbrt(fluid.Re))
    assert equal(second, 9 * sp.I / (2 * sp.pi * sp.sqrt(3)))
    # with q = k/f: -f Ai(q^2)/J(q), J = 1/3 + Ai'(0) q - Ai(0) q^2/2 + ..., by parts
    q = sp.Symbol("q")
    expansion = sp.series((Ai + slope * q**2) / (sp.Rational(1, 3) + slope * q - Ai * q**2 / 2), q, 0, 3).removeO()
    assert abs(complex((third - expansion.coeff(q, 2) / sp.cbrt(fluid.Re)).subs(fluid.Re, 2).evalf())) < 1e-14
    assert fluid.boundary_layer_coefficient(2) == fluid.boundary_layer_coefficient(4) == 0


def test_response_shallow():
    """(4.83) and its next two orders."""
    h, Re = fluid.depth, fluid.Re
    found = [fluid.shallow_coefficient(m) for m in range(4)]
    assert found[:2] == [-4 / h, -Re * h**2 / 30]
    assert equal(found[2], 4 * h / 15 + Re**2 * h**5 / 4200)
    assert equal(found[3], Re * h**4 * (47520 - 119 * Re**2 * h**4) / 49896000)


def test_response_short_waves():
    assert [fluid.short_wave_coefficient(n) for n in range(2)] == [-2, -sp.I / 2]


@pytest.mark.parametrize(("arguments", "published"), [
    ((0.01, 1), "0.2071675407392294604801 + 0.1146310767157079453923j"),
    ((1, 100), "5.190678379511007508127 + 2.423213487768535743844j"),
    ((10, 1), "20.00043726374801432638 + 0.04999157099198811850727j"),
    ((1, 10, 1), "4.294126620559937806775 + 0.3381733070145952776819j"),
    ((0.1, 100, 5), "2.181002839902109282769 + 1.135878208670128566388j"),
])
def test_response_numbers(arguments, published):
    real, imaginary = published.rstrip("j").split(" + ")
    with mp.workdps(25):
        exact = [mp.mpf(str(value)) for value in arguments]
        ours = -fluid.response(*exact, digits=22)
        assert abs(ours - mp.mpc(real, imaginary)) < mp.mpf("1e-19")


def test_response_in_formulas():
    symbolic = fluid.WallResponse(k, Re, sp.oo)
    assert str(symbolic) == "R(k, Re, oo)"
    assert symbolic.evalf() == symbolic
    number = complex(symbolic.subs({k: 1, Re: 100}).evalf())
    assert number == pytest.approx(-5.190678379511007 - 2.423213487768536j)


# -- dunes ---------------------------------------------------------------------------------------------


def test_phase_speed_of_the_shallow_regime():
    """(4.84) c_0 = -8 r^2 (r - 1)^2 (r + 2)/(3 b h) in the thesis's convention: downstream here."""
    law = expand("dune", "shallow", order=1)
    assert equal(law.phase_speed, 8 * r**2 * (r - 1) ** 2 * (r + 2) / (3 * b * depth))
    assert law.growth_rate == 0


@pytest.mark.parametrize(("values", "published", "tolerance"), [
    ({"shields": 1.5, "depth": 10, "Re": 0.1}, -0.0207561449, 5e-11),
    ({"shields": 1.5, "depth": 10, "Re": 1}, 0.4679, 5e-5),
    ({"shields": 1.5, "depth": 10, "Re": 1}, 0.4678919338, 5e-11),
    ({"shields": 2, "depth": 10, "Re": 1}, 2.094435158, 5e-10),
    ({"shields": 1.1, "depth": 2, "Re": 0.001}, -3.6434724e-4, 5e-12),
])
def test_the_coefficient_A(values, published, tolerance):
    A = expand("dune", "shallow", mu1=0.4, b=1, **values).values()[2]
    assert A.imag == 0
    assert abs(A.real - published) < tolerance


def test_the_coefficient_A_in_closed_form():
    """Written for a reader; each line is one effect."""
    log = sp.log
    A = (
        Re * depth**2 * r**2 * (r - 1) ** 2 * (r + 2) / (45 * b)
        - 2 * (r - 1) ** 3 * (3 * r**2 + 9 * r + 8) / (15 * b * mu1)
        + 8 * mu1 * r**2 / (b * depth) * (
            4 * r**3 * (r**2 - 1) * log((1 + r) / (2 * r)) - 2 * r**3 * log(r)
            + (r - 1) * (59 * r**5 + 18 * r**4 - 17 * r**3 - 12 * r**2 + 8 * r + 4) / (15 * (r + 1)))
        - 4 * r**2 * (r - 1) ** 6 * (65 * r**3 + 390 * r**2 + 609 * r + 196) / (189 * b**3 * depth * mu1)
        + 64 * r**4 * (r - 1) ** 6 * (r + 2) * (8 * r**2 + 32 * r + 35) / (135 * b**3 * depth**2 * mu1)
    )
    found = expand("dune", "shallow").coefficient(2)
    root = sp.Symbol("root", positive=True)
    difference = sp.expand_log((found - A).subs(shields, root**2), force=True)
    difference = difference.subs(log(sp.Rational(1, 2) + 1 / (2 * root)), log(1 + root) - log(2) - log(root))
    assert sp.simplify(sp.expand(difference)) == 0


def test_there_is_a_stable_window():
    """Contrary to the text after (4.85): below the curve A = 0, long waves decay above yield."""
    curve = sp.lambdify((shields, depth, mu1, b), dune.neutral_Re())
    law = expand("dune", "shallow")
    for values in ({"shields": 1.5, "depth": 10, "mu1": 0.4, "b": 1}, {"shields": 3, "depth": 10, "mu1": 0.6, "b": 2}):
        neutral = curve(**values)
        assert neutral > 0
        below, on, above = (law.with_parameters(Re=factor * neutral, **values).values()[2].real
                            for factor in (0.9, 1, 1.1))
        assert below < 0 < above
        assert abs(on) < 1e-9 * above
    assert curve(1.5, 10, 0.4, 1) == pytest.approx(0.1 + 0.9 * 0.0207561449 / (0.0207561449 + 0.4678919338), rel=1e-8)
    # the bed's own damping vanishes faster than the driving as shields -> 1
    assert abs(curve(1.0001, 10, 0.4, 1)) < 1e-2 * abs(curve(1.5, 10, 0.4, 1))


def test_boundary_layer_law():
    """(4.81), (4.82), the missing k^{5/3}, and the first correction."""
    M = sp.cbrt(3) / sp.gamma(sp.Rational(2, 3)) * sp.cbrt(Re)
    law = expand("dune", "boundary-layer")
    flux = shields * (shields ** sp.Rational(3, 2) - 3 * r + 2)
    leading = law.truncated("4/3")
    assert equal(leading.growth_rate, flux * M / (3 * b) * k ** sp.Rational(4, 3))
    assert equal(leading.phase_speed, flux * M / (sp.sqrt(3) * b) * sp.cbrt(k))
    assert law.coefficient("5/3") == 0
    assert leading.next_power == 2
    damping = 2 * (r - 1) ** 3 * (3 * r**2 + 9 * r + 8) / (15 * b * mu1)
    assert equal(sp.re(law.coefficient(2)), -damping)
    assert equal(sp.im(law.coefficient(2)), -sp.sqrt(3) * flux / (sp.pi * b))


def test_the_reduced_problem_for_small_Re():
    """kappa depends on shields and mu1 only, through B/a; it exists for every shields > 1."""
    ratio = sp.cancel(dune.bed_damping() * b / (dune.leading_flux() * b))
    assert equal(ratio, (r - 1) * (3 * r**2 + 9 * r + 8) / (5 * mu1 * r**2 * (r + 2)))
    found = [float(dune.small_Re_maximum(value, 0.4)) for value in (1.2, 1.5, 2)]
    assert found == pytest.approx([0.636345641305, 0.362362096411, 0.236947955623], rel=1e-11)
    # the pull of the fluid per kappa^2 falls monotonically, from infinity to zero: one maximum
    kappa = [mp.mpf(10) ** (n / 4) for n in range(-12, 5)]
    pull = [mp.diff(lambda q: -q * fluid.response(q, 1, digits=50).imag, one) / one for one in kappa]
    assert all(first > second > 0 for first, second in zip(pull, pull[1:], strict=False))
    assert pull[0] > 1000 * pull[-1]


def test_just_above_yield():
    law = expand("dune", "near-yield", b=2, Re=1, depth="inf", k=1)
    response = complex(fluid.response(1, 1))
    assert law.values()[2] == pytest.approx(1j * response / 4)
    assert law.next_power == 3
    one = {law.gauge: 1}
    assert complex(law.growth_rate.subs(one).evalf()) == pytest.approx(-response.imag / 4)
    assert complex(law.phase_speed.subs(one).evalf()) == pytest.approx(-response.real / 4)
    # the same leading coefficient as of a, and B is smaller
    small = sp.Symbol("small", positive=True)
    assert sp.limit(dune.leading_flux().subs(shields, 1 + small) / small**2, small, 0) == 1 / (2 * b)
    assert sp.limit(dune.bed_damping().subs(shields, 1 + small) / small**3, small, 0) == sp.Rational(1, 3) / (b * mu1)


# -- expansions as objects -----------------------------------------------------------------------------


def test_partly_numeric_expansions():
    law = expand("dune", "shallow", depth=10, b=1)
    assert law.parameters == {"shields": None, "mu1": None, "b": 1, "Re": None, "depth": 10}
    assert law.values() == {1: None, 2: None}
    with pytest.raises(StillSymbolic, match="shields, mu1, Re"):
        law.function()
    with pytest.raises(StillSymbolic, match="no parameter Fr2"):
        law.with_parameters(Fr2=1)
    sigma = law.function(shields=1.5, mu1=0.4, Re=0.1)
    assert sigma(np.array([[1e-3, 2e-3]])).shape == (1, 2)
    assert sigma(1e-3) == pytest.approx(-6.515307716504658e-5j - 2.0756144948276063e-8)


def test_orders_are_computed_once():
    hierarchy = dune.hierarchy(sp.symbols("R_0 R_1"), 1)
    first = hierarchy.speed(1)
    before = list(hierarchy._speed)
    assert hierarchy.speed(1) == first
    assert all(a is b for a, b in zip(before, hierarchy._speed, strict=True))
    with pytest.raises(OrderNotKnown, match="order 2"):
        hierarchy.speed(2)


def test_ill_posed_hierarchies_are_refused():
    layer, conditions = dune.layer(), dune.conditions()
    with pytest.raises(ConditionsMiscounted, match="expected 5"):
        Hierarchy([layer], conditions[:4], given={dune.R: (1, 0)})
    from dataclasses import replace

    circular = layer.matrix.copy()
    circular[2, 1] += 1
    with pytest.raises(NotTriangular, match="circle"):
        Hierarchy([replace(layer, matrix=circular)], conditions, given={dune.R: (1, 0)})
    assert vortex.FIELDS == dune.FIELDS
