"""The thesis's linearised equations, term by term, and what it has wrong; (4.x) are its equation numbers.

The thesis writes exp(i k (x + c t)), i.e. sigma = i k c, and eliminates the cross-slope velocity by
continuity, V = i W'/k. Each comparison has a twin: the same equation with one coefficient changed by 1 %.
"""

import pytest
import sympy as sp

from asymptotics import fluid
from asymptotics.flows import dune, vortex
from asymptotics.linearise import Linearisation, NotASteadyState, amplitude, eta, k, p, sigma, u, v, w, x, z

c = sp.Symbol("c")
zeta = sp.Symbol("zeta", positive=True)
W, P = sp.Function("W")(z), sp.Function("P")(z)
T, Fr2 = vortex.tan_slope, vortex.Fr2
root = sp.sqrt(1 - z)
e0 = (vortex.mu2 - T) * (T - vortex.mu1) / (vortex.mu2 - vortex.mu1)


def difference(ours, printed, height=1 - zeta**2):
    """The terms in which two linear expressions differ, {derivative: coefficient}, at z = height."""
    rest = sp.expand((ours - printed).doit())
    jets = sorted(rest.atoms(sp.Derivative) | rest.atoms(sp.core.function.AppliedUndef), key=sp.default_sort_key)
    names = [sp.Dummy() for _ in jets]
    rest = rest.subs(dict(sorted(zip(jets, names, strict=True), key=lambda pair: -pair[0].count_ops())))
    terms = {}
    for jet, name in [*zip(jets, names, strict=True), (1, None)]:
        part = sp.diff(rest, name) if name else rest.subs(dict.fromkeys(names, 0))
        part = sp.cancel(sp.together(part.subs(z, height)))
        if part != 0:
            terms[jet] = part
    return terms


def across(expression):
    """Vortex notation: W, P, c; V eliminated."""
    return expression.subs({v: sp.I * sp.diff(W, z) / k, w: W, p: P, sigma: sp.I * k * c}).doit()


# -- vortices: (4.13)-(4.20) -----------------------------------------------------------------------

U_HAT = u
VORTEX = {
    "(4.13)": (0, 1,
               Fr2 * (sp.I * k * c * U_HAT + root * W)
               - (-(k**2) * T * root * U_HAT
                  + sp.diff(e0 * root * sp.diff(U_HAT, z) + (T - e0 / 2) * P, z))),
    "(4.14)": (1, -sp.I * k,
               sp.I * k * c * Fr2 * sp.diff(W, z)
               + k**2 * P + 2 * k**2 * T * root * sp.diff(W, z)
               - T * sp.diff(root * (sp.diff(W, z, 2) + k**2 * W), z)),
    "(4.15)": (2, 1,
               sp.I * k * c * Fr2 * W + sp.diff(P, z)
               + T * root * (sp.diff(W, z, 2) + k**2 * W) - 2 * T * sp.diff(root * sp.diff(W, z), z)),
}


def test_the_vortex_equations_are_those_of_the_thesis():
    equations = vortex.linear_flow().equations()
    for row, factor, printed in VORTEX.values():
        assert difference(across(equations[row] * factor), printed) == {}
    assert across(equations[3]) == 0


@pytest.mark.parametrize("name", VORTEX)
def test_a_broken_coefficient_in_a_vortex_equation_shows(name):
    row, factor, printed = VORTEX[name]
    ours = across(vortex.linear_flow().equations()[row] * factor)
    broken = printed + sp.Rational(1, 100) * T * root * sp.diff(W, z, 2)
    assert set(difference(ours, broken)) == {sp.diff(W, z, 2)}


def test_equation_4_14_needs_k_squared_times_the_pressure():
    """Erratum, if the text is as extracted: (4.14) shows `kp` where the y-momentum equation has k^2 P."""
    row, factor, printed = VORTEX["(4.14)"]
    ours = across(vortex.linear_flow().equations()[row] * factor)
    assert difference(ours, printed - k**2 * P + k * P) == {P: k**2 - k}


def test_the_friction_law_enters_through_e0_only():
    """(4.16): e0 = I mu'(I) at the base state."""
    number = sp.Symbol("number", positive=True)
    law = vortex.friction(number)
    assert sp.simplify(law.subs(number, 1) - T) == 0
    assert sp.simplify(sp.diff(law, number).subs(number, 1) - e0) == 0


def vortex_surface(component):
    flow = vortex.linear_flow()
    return flow, flow.concrete(flow.on_surface(vortex_tractions(flow)[component], 1))


def vortex_tractions(flow):
    return [*flow.traction(), flow.kinematic]


def test_the_vortex_surface_conditions_are_those_of_the_thesis():
    """(4.18)-(4.20) with s0 = W/(i k c) by (4.21); coefficients are those of the limit z -> 1."""
    for component, factor, printed in (
        (0, -sp.I * k * c, T * W - sp.I * k * c * (e0 * root * sp.diff(u, z) + (T - e0 / 2) * P)),
        (1, -sp.I * k, T * root * (sp.diff(W, z, 2) + k**2 * W)),
        (2, sp.I * k * c, W - sp.I * k * c * (P - 2 * T * root * sp.diff(W, z))),
    ):
        _, ours = vortex_surface(component)
        ours = across(ours * factor).subs(amplitude, W / (sp.I * k * c))
        assert difference(sp.expand(ours), printed) == {}
    _, kinematic = vortex_surface(3)
    assert sp.expand(across(kinematic)) == sp.expand(sp.I * k * c * amplitude - W)


def test_a_pressure_on_the_surface_adds_no_shear():
    """Erratum (4.28): its term i k c delta W is not there; (4.29) holds."""
    delta = vortex.delta
    flow = vortex.linear_flow(delta)
    _, shear, normal, _ = [None, *vortex.surface_conditions(delta)]
    viscosity = T * sp.sqrt(1 + delta - z)
    ours = across(flow.concrete(flow.on_surface(shear, 1)) * -sp.I * k)
    assert difference(ours, viscosity * (sp.diff(W, z, 2) + k**2 * W), 1 + delta - zeta**2) == {}
    ours = across(flow.concrete(flow.on_surface(normal, 1)))
    assert difference(ours, amplitude - P + 2 * viscosity * sp.diff(W, z), 1 + delta - zeta**2) == {}


def test_without_a_stress_on_the_displaced_normal_the_load_would_add_shear():
    """The twin: a load that does not turn with the surface gives i k delta s0, not nothing."""
    delta = vortex.delta
    flow = vortex.linear_flow(delta)
    dead_load = flow.surface_condition(flow.traction()[1], 1)
    assert sp.expand(dead_load - vortex.FIELDS[2]) == sp.I * k * delta * amplitude


# -- dunes: fluid (4.59)-(4.63) --------------------------------------------------------------------

Psi = sp.Function("Psi")(z)
psi, phi = sp.Function("psi")(z), sp.Function("phi")(z)


def stream(expression, function, pressure):
    """u = -psi', w = i k psi (4.56), (4.57)."""
    return expression.subs({u: -sp.diff(function, z), w: sp.I * k * function, p: pressure,
                            sigma: sp.I * k * c}).doit()


def test_the_fluid_obeys_an_orr_sommerfeld_equation():
    """(4.59) is the curl of the momentum equations; no time derivative (the limit epsilon -> 0)."""
    along, _, normal, continuity = fluid.fluid().equations()
    curl = stream(sp.diff(along, z) - sp.I * k * normal, Psi, p)
    vorticity = sp.diff(Psi, z, 2) - k**2 * Psi
    printed = -sp.I * k * z * vorticity + (sp.diff(Psi, z, 4) - 2 * k**2 * sp.diff(Psi, z, 2) + k**4 * Psi) / fluid.Re
    assert difference(curl, printed, z) == {}
    assert stream(continuity, Psi, p) == 0


def test_the_fluid_sees_a_rigid_wavy_wall():
    """(4.60), (4.61): Psi = 0, Psi' = s0; the shear of the fluid on the wall is -Psi''."""
    flow = fluid.fluid()
    no_slip = [stream(flow.concrete(flow.on_surface(flow.full_velocity[i], 0)), Psi, p) for i in (0, 2)]
    assert sp.expand(no_slip[0]) == amplitude - sp.diff(Psi, z)
    assert sp.expand(no_slip[1]) == sp.I * k * Psi
    traction = flow.traction()
    tangential = fluid.Re * (traction[0] + sp.diff(flow.surface, x) * traction[2]) - 1
    shear = stream(flow.concrete(flow.on_surface(tangential, 0)), Psi, p)
    assert difference(shear, -sp.diff(Psi, z, 2) - k**2 * Psi, z) == {}


# -- dunes: bed (4.64)-(4.70) ----------------------------------------------------------------------

r, mu1, b = dune.r, dune.mu1, dune.b
theta = r**2
base = sp.Rational(2, 3) / b * (2 * r**3 - 3 * r**2 * root + root**3)
shear = sp.diff(base, z)
SHEAR_STRESS = mu1 * b * root * (sp.diff(psi, z, 2) + k**2 * psi - sp.diff(base, z, 2) * phi)
BED = {
    "(4.64)": (0, -1,
               sp.I * k * ((c + base) * sp.diff(psi, z) - shear * psi)
               - (sp.I * k * phi - 2 * mu1 * theta * k**2 * sp.diff(psi, z) / shear + sp.diff(SHEAR_STRESS, z))),
    "(4.65)": (2, -1,
               k**2 * (c + base) * psi
               - (sp.diff(phi, z) + sp.I * k * SHEAR_STRESS
                  - 2 * sp.I * k * mu1 * theta * sp.diff(sp.diff(psi, z) / shear, z))),
}


def test_the_bed_equations_are_those_of_the_thesis():
    equations = dune.linear_bed().equations()
    for row, factor, printed in BED.values():
        assert difference(stream(equations[row] * factor, psi, phi), printed) == {}
    assert stream(equations[3], psi, phi) == 0


@pytest.mark.parametrize("name", BED)
@pytest.mark.parametrize("factor", [mu1, theta, b])
def test_a_broken_coefficient_in_a_bed_equation_shows(name, factor):
    row, sign, printed = BED[name]
    ours = stream(dune.linear_bed().equations()[row] * sign, psi, phi)
    assert difference(ours, printed.subs(factor, factor * sp.Rational(101, 100))) != {}


def test_the_interface_conditions_are_those_of_the_thesis():
    """(4.66)-(4.68) with the fluid's stress -R s0 = -Psi''(0)."""
    bed = dune.linear_bed()
    pressure, stress, kinematic = [sp.expand(stream(bed.concrete(bed.on_surface(condition, 0)), psi, phi))
                                   for condition in dune.interface_conditions()]
    assert difference(pressure, phi - amplitude, 0) == {}
    printed = b * (sp.diff(psi, z, 2) + k**2 * psi) - (theta + 1) * phi / 2 - theta * dune.R * amplitude
    assert difference(stress, -mu1 * printed, 0) == {}
    assert difference(kinematic, sp.I * k * ((c + base) * amplitude - psi), 0) == {}


def test_the_base_states_are_those_of_the_thesis():
    """(4.10), (4.52): the yield surface is at z = 1 - theta, where velocity and shear rate vanish."""
    at_yield = {z: 1 - theta}
    assert sp.simplify(base.subs(at_yield)) == 0
    assert sp.simplify(shear.subs(at_yield)) == 0
    assert sp.simplify(shear - (theta - 1 + z) / (b * root)) == 0


def test_a_base_flow_that_is_not_steady_is_refused():
    with pytest.raises(NotASteadyState, match="body force"):
        Linearisation(velocity=z, pressure=1 - z, viscosity=lambda rate, pressure: pressure / rate)
    flow = vortex.linear_flow()
    with pytest.raises(NotASteadyState, match="at z = 1"):
        flow.on_surface(flow.full_pressure - 1, 1)


def test_stress_form_and_primitive_form_agree():
    """The first-order system implies the momentum equations it came from: check by elimination at random points."""
    bed = dune.linear_bed()
    matrix = bed.system()
    fields = [sp.Function(name)(z) for name in ("ww", "uu", "tt", "nn")]
    slopes = list(matrix * sp.Matrix(fields))
    viscosity = bed.base[eta]
    pressure = -fields[3] - 2 * sp.I * k * viscosity * fields[1]
    forward = {w: fields[0], u: fields[1], p: pressure}
    replace = dict(zip([sp.diff(f, z) for f in fields], slopes, strict=True))
    values = {r: sp.Rational(3, 2), b: sp.Rational(4, 5), mu1: sp.Rational(1, 3), k: 2, sigma: sp.Rational(1, 7) + sp.I}
    for row in (0, 2, 3):
        expression = bed.equations()[row].subs(forward).doit()
        for _ in range(2):
            second = {sp.diff(f, z, 2): sp.diff(slope, z) for f, slope in zip(fields, slopes, strict=True)}
            expression = expression.subs(second).doit().subs(replace)
        letters = dict(zip(fields, sp.symbols("a0:4"), strict=True))
        expression = expression.subs(letters).subs(values).subs(z, sp.Rational(-1, 2))
        assert sp.simplify(sp.expand(expression)) == 0
