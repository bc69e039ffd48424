"""`linearise` and `hierarchy` on flows they were not written for, against closed forms from the literature."""

import sympy as sp

from asymptotics.flows.vortex import friction, mu1, mu2, tan_slope
from asymptotics.hierarchy import Hierarchy, Layer, long_wave
from asymptotics.linearise import FIELDS, Linearisation, amplitude, z

Re, cot, Fr2, m, depth = sp.symbols("Re cot Fr2 m depth", positive=True)
half = sp.Rational(1, 2)


def free_surface(flow, layer, bottom, top):
    """No stress on z = 1, no slip on z = 0, in the layer's coordinate."""
    traction = flow.traction()
    conditions = [layer.at(top, long_wave(flow.surface_condition(condition, 1)))
                  for condition in (traction[0], traction[2], flow.kinematic)]
    return Hierarchy([layer], [*conditions, layer.at(bottom, FIELDS[0]), layer.at(bottom, FIELDS[1])])


def test_falling_film():
    """Yih 1963, Benjamin 1957: c = 2 + i k (8/15) (Re - (5/4) cot slope), and c = -speed."""
    flow = Linearisation(2 * z - z**2, 2 * cot / Re * (1 - z), lambda rate, p: 1 / Re,
                         force=(2 / Re, sp.Integer(0), -2 * cot / Re))
    hierarchy = free_surface(flow, Layer("film", z, long_wave(flow.system())), sp.Integer(0), sp.Integer(1))
    assert hierarchy.speed(0) == -2
    assert sp.simplify(hierarchy.speed(1) + sp.Rational(8, 15) * (Re - 5 * cot / 4)) == 0


def test_roll_waves():
    """sigma = -i k + k^2 ([Fr2/10 - 2/5 + (3/5) t^2]/e0 - (3/10) t), t = tan(slope): full mu(I)."""
    zeta = sp.Symbol("zeta", positive=True)
    flow = Linearisation(sp.Rational(2, 3) * (1 - (1 - z) ** (3 * half)), 1 - z,
                         lambda rate, p: friction(rate / sp.sqrt(p)) * p / rate, inertia=Fr2,
                         force=(tan_slope, sp.Integer(0), sp.Integer(-1)))
    matrix = long_wave(flow.system(1 - zeta**2)) * -2 * zeta
    hierarchy = free_surface(flow, Layer("grains", zeta, matrix), sp.Integer(1), sp.Integer(0))
    e0 = (mu2 - tan_slope) * (tan_slope - mu1) / (mu2 - mu1)
    published = (Fr2 / 10 - sp.Rational(2, 5) + sp.Rational(3, 5) * tan_slope**2) / e0 - 3 * tan_slope / 10
    assert hierarchy.speed(0) == -1
    assert sp.simplify(hierarchy.speed(1) + published) == 0


def test_two_layer_couette():
    """Yih 1967: the wave on the interface, relative to it; two layers, eight fields."""
    shears = {"upper": m / (m + depth), "lower": 1 / (m + depth)}
    viscosities = {"upper": sp.Integer(1), "lower": m}
    scale = {"n": -1}
    flows = {name: Linearisation(shear * z, sp.Integer(0), lambda rate, p, name=name: viscosities[name], inertia=Re)
             for name, shear in shears.items()}
    layers = {name: Layer(name, z, long_wave(flow.system(), scale)) for name, flow in flows.items()}
    W, U, T, N = FIELDS

    def jump(field):
        return layers["upper"].at(0, long_wave(field, scale)) - layers["lower"].at(0, long_wave(field, scale))

    conditions = [
        jump(W), jump(U) + (shears["upper"] - shears["lower"]) * amplitude, jump(T), jump(N),
        layers["upper"].at(0, long_wave(flows["upper"].surface_condition(flows["upper"].kinematic, 0), scale)),
        *(layers[name].at(wall, field) for name, wall in (("upper", 1), ("lower", -depth)) for field in (W, U)),
    ]
    hierarchy = Hierarchy(list(layers.values()), conditions)
    n = depth
    leading = 2 * m * n**2 * (m - 1) * (n + 1) / ((m + n) * (m**2 + 4 * m * n**3 + 6 * m * n**2 + 4 * m * n + n**4))
    assert sp.simplify(hierarchy.speed(0) + leading) == 0
    equal_depths = hierarchy.speed(1).subs(depth, 1)
    next_order = Re * (m - 1) ** 4 * (5 * m**2 + 6 * m + 5) / (60 * (m + 1) * (m**2 + 14 * m + 1) ** 3)
    assert sp.simplify(equal_depths + next_order) == 0
