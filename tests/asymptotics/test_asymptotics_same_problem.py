"""Both packages solve the same problem: `stability`'s equations, evaluated with symbols, minus ours, are zero.

`stability` codes the stress form by hand; `asymptotics` derives it from the nonlinear equations. In its scaling
(stability/layer.py)  u = i k^a g v,  w = k^(1+a) w^,  t = i k^a t^,  n = n^,  sigma = k^(1+a) rate.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from types import SimpleNamespace

import pytest
import sympy as sp

from asymptotics import fluid, linearise
from asymptotics.flows import dune, vortex
from stability import flows
from stability.equations.layer import Profile, residuals
from stability.flows import dune as stability_dune
from stability.flows import vortex as stability_vortex

zeta, rate, s0, height = sp.symbols("zeta rate s0 height", positive=True)
k, sigma = linearise.k, linearise.sigma
NAMES = ("v", "w", "t", "n")


@dataclass
class Case:
    """One layer: stability's profile at s(zeta), our system at z(zeta), the order a of the scaling."""

    profile: Profile
    linear: linearise.Linearisation
    z: sp.Expr
    s: sp.Expr
    order: int = 0
    steady: bool = False

    @cached_property
    def matrix(self):
        return self.linear.system(self.z).subs(sigma, k ** (1 + self.order) * rate)

    @property
    def stretch(self):
        """dz/ds."""
        return exact(sp.diff(self.z, zeta) / sp.diff(self.s, zeta))

    def residuals(self, profile=None):
        """stability's residuals with the slopes that our system gives; zero if both agree."""
        profile = profile or self.profile
        fields = sp.symbols("v w t n")
        scales = (k ** (1 + self.order), sp.I * k**self.order * profile.g,
                  sp.I * k**self.order * profile.stress, profile.stress)
        ours = [scale * field for scale, field in zip(scales, (fields[1], fields[0], *fields[2:]), strict=True)]
        dw, du, dt, dn = self.stretch * self.matrix * sp.Matrix(ours)
        dg = sp.diff(profile.g, zeta) / sp.diff(self.s, zeta)
        slopes = (du / scales[1] - dg / profile.g * fields[0], dw / scales[0], dt / scales[2], dn / scales[3])
        rows = residuals(profile, k, 0 if self.steady else rate, fields, slopes, self.order)
        return [exact(row) for row in rows]


def exact(expression):
    """Normal form of a rational function of symbols; 1j becomes I."""
    expression = sp.nsimplify(expression, rational=True)
    symbols = sorted(expression.free_symbols, key=str)
    return sp.QQ_I.frac_field(*symbols).from_sympy(expression).as_expr() if symbols else expression


def as_symbols(profile):
    return replace(profile, g=sp.sympify(profile.g))


def bed_case():
    s = (dune.r - zeta) / (dune.r - 1)
    profile = as_symbols(stability_dune.bed_profile(s, dune.r - 1, dune.mu1, dune.b))
    return Case(profile, dune.linear_bed(), 1 - zeta**2, s)


def vortex_case():
    s = 1 - zeta
    return Case(as_symbols(stability_vortex.profile(s, vortex.tan_slope, vortex.Fr2)), vortex.linear_flow(),
                1 - zeta**2, s, order=1)


def fluid_case():
    profile = as_symbols(stability_dune.fluid_profile(zeta / height, height, fluid.Re))
    return Case(profile, fluid.fluid(), zeta, zeta / height, steady=True)


CASES = {"vortex": vortex_case, "dune bed": bed_case, "dune fluid": fluid_case}


@pytest.mark.parametrize("name", CASES)
def test_the_equations_are_the_same(name):
    case = CASES[name]()
    assert exact(case.profile.dz - case.stretch) == 0
    assert case.residuals() == [0, 0, 0, 0]


@pytest.mark.parametrize(("name", "coefficient"), [
    *(("vortex", field) for field in ("dz", "eta", "beta", "rho")),
    *(("dune bed", field) for field in ("dz", "eta", "beta", "rho", "U", "dU", "alpha", "dg")),
    *(("dune fluid", field) for field in ("dz", "eta", "beta", "rho", "U", "dU", "stress")),
])
def test_one_percent_in_any_coefficient_is_seen(name, coefficient):
    case = CASES[name]()
    broken = replace(case.profile, **{coefficient: getattr(case.profile, coefficient) * sp.Rational(101, 100)})
    assert case.residuals(broken) != [0, 0, 0, 0]


# -- conditions --------------------------------------------------------------------------------------


class SymbolicDune(flows.Dune):
    """The flow with symbols for its parameters: no validation, no conversion to floats."""

    _excess = dune.r - 1

    def __post_init__(self):
        pass


class SymbolicVortex(flows.Vortex):
    def __post_init__(self):
        pass


def edge(name):
    return SimpleNamespace(**{field: sp.Symbol(f"{name}_{field}") for field in NAMES})


def names(*functions):
    return SimpleNamespace(k=k, rate=rate, s0=s0, **{name: sp.Symbol(name) for name in functions})


def in_stability_fields(condition, fields, g=1, order=0, stress=1):
    """Our condition on w, u, t, n as one on stability's v, w, t, n."""
    scaled = (k ** (1 + order) * fields.w, sp.I * k**order * g * fields.v, sp.I * k**order * stress * fields.t,
              stress * fields.n)
    condition = condition.subs({sigma: k ** (1 + order) * rate, linearise.amplitude: s0})
    return condition.subs(dict(zip(linearise.FIELDS, scaled, strict=True)), simultaneous=True)


def same(theirs, ours):
    """Two linear conditions are proportional."""
    theirs, ours = (sp.expand(sp.nsimplify(condition, rational=True)) for condition in (theirs, ours))
    unknowns = [symbol for symbol in theirs.free_symbols | ours.free_symbols if "_" in symbol.name or symbol == s0]
    ratio = exact(theirs / ours)
    return not any(ratio.has(unknown) for unknown in unknowns) and ratio != 0


def test_the_vortex_conditions_are_the_same():
    wall, surface = edge("wall"), edge("surface")
    theirs = SymbolicVortex().conditions(SimpleNamespace(grains=(wall, surface)), names())
    w, u, *_ = linearise.FIELDS
    flow = vortex.linear_flow()
    shear, normal, kinematic = (in_stability_fields(flow.surface_condition(condition, 1), surface, order=1)
                                for condition in vortex.surface_conditions())
    ours = [in_stability_fields(u, wall, order=1), in_stability_fields(w, wall, order=1), shear, normal, kinematic]
    assert len(theirs) == len(ours)
    assert all(map(same, theirs, ours))
    assert not same(theirs[4], kinematic + s0 / 100)


def bed_conditions(yielding, surface):
    """Ours, in stability's order. g = 0 at the yield surface makes u = 0 there: bounded v is their condition."""
    profile = stability_dune.bed_profile(sp.Integer(1), dune.r - 1, dune.mu1, dune.b)
    assert stability_dune.bed_profile(sp.Integer(0), dune.r - 1, dune.mu1, dune.b).g == 0
    bed = dune.linear_bed()
    pressure, stress, kinematic = (in_stability_fields(bed.surface_condition(condition, 0), surface, profile.g)
                                   for condition in dune.interface_conditions())
    return [in_stability_fields(linearise.FIELDS[0], yielding), pressure, kinematic, stress]


def test_the_dune_conditions_are_the_same():
    yielding, surface = edge("yield"), edge("surface")
    flow = SymbolicDune(shields=dune.r**2, mu1=dune.mu1, b=dune.b, Re=fluid.Re)
    theirs = flow.conditions(SimpleNamespace(bed=(yielding, surface)), names("R"))
    ours = bed_conditions(yielding, surface)
    assert len(theirs) == len(ours)
    assert all(map(same, theirs, ours))
    broken = theirs[3].subs(names("R").R, names("R").R * sp.Rational(101, 100))
    assert not same(broken, ours[3])


def test_the_conditions_between_bed_and_fluid_are_the_same():
    yielding, surface, wall, lid = (edge(name) for name in ("yield", "surface", "wall", "lid"))
    flow = SymbolicDune(shields=dune.r**2, mu1=dune.mu1, b=dune.b, Re=fluid.Re, depth=7, fluid="layer")
    theirs = flow.conditions(SimpleNamespace(bed=(yielding, surface), fluid=(wall, lid)), names())
    # the shear of the fluid on the wall is -R s0
    shear = in_stability_fields(fluid.wall_shear(), wall, stress=1 / fluid.Re)
    ours = bed_conditions(yielding, surface)
    ours[3] = ours[3].subs(dune.R, -shear / s0)
    ours += [in_stability_fields(condition, wall) for condition in fluid.wall_conditions()]
    ours += [in_stability_fields(field, lid) for field in (linearise.FIELDS[1], linearise.FIELDS[0])]
    assert len(theirs) == len(ours)
    assert all(map(same, theirs, ours))
