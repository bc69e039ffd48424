"""Eigenfunctions in physical units: the four equations, the conditions at the edges, and closed forms.

Base flows and conditions are written out here in z, independent of the flows' own in s.
"""

from math import cos, radians, sin, tan

import numpy as np
import pytest
from numpy.polynomial import chebyshev as C

from stability import ParameterError, dispersion, flows, spectrum
from stability.modes.solver import Solver

ROLL, VORTEX, FILM = flows.RollWave(), flows.Vortex(Fr2=2.0), flows.Film(We=0.1)
TWO = flows.TwoLayerCouette(viscosity_ratio=3.0, depth_ratio=1.5, density_ratio=1.3, gravity=0.2, tension=0.1)
DUNE, LID = flows.Dune(shields=1.7, mu1=0.5, b=1.3), flows.Dune(shields=1.7, depth=3.0, fluid="layer")
FLOWS = [ROLL, VORTEX, FILM, TWO, DUNE, LID, flows.Poiseuille(Re=3000.0), flows.Couette(Re=200.0)]
K = 0.7


def newtonian(U, dU, viscosity, rho=1.0):
    return {"rho": rho, "U": U, "dU": dU, "eta": lambda z: viscosity, "beta": lambda z: viscosity, "alpha": lambda z: 0}


def bed(flow):
    """Thesis (4.48)-(4.52), pressure 1 - z."""
    theta, mu1, b = flow.shields, flow.mu1, flow.b
    r = np.sqrt(theta)
    return {"rho": 1.0, "U": lambda z: (4 / 3 * r**3 - 2 * theta * np.sqrt(1 - z) + 2 / 3 * (1 - z) ** 1.5) / b,
            "dU": lambda z: (theta - 1 + z) / (b * np.sqrt(1 - z)),
            "eta": lambda z: mu1 * theta * b * np.sqrt(1 - z) / (theta - 1 + z),
            "beta": lambda z: mu1 * b * np.sqrt(1 - z), "alpha": lambda z: mu1 * (theta + 1 - z) / (2 * (1 - z))}


def layers(flow):
    """[(low, high, base flow as functions of z)] of every layer."""
    if flow is ROLL:
        mu, e0 = tan(radians(28)), flow.e0
        return [(0, 1, {"rho": flow.Fr2, "U": lambda z: 2 / 3 * (1 - (1 - z) ** 1.5), "dU": lambda z: np.sqrt(1 - z),
                        "eta": lambda z: mu * np.sqrt(1 - z), "beta": lambda z: e0 * np.sqrt(1 - z),
                        "alpha": lambda z: mu - e0 / 2})]
    if flow is VORTEX:
        mu = tan(radians(30))
        viscosity = {name: lambda z: mu * np.sqrt(1 - z) for name in ("eta", "beta")}
        return [(0, 1, {**newtonian(lambda z: 0, lambda z: 0, 1.0, flow.Fr2), **viscosity})]
    if flow is FILM:
        return [(0, 1, newtonian(lambda z: 2 * z - z**2, lambda z: 2 - 2 * z, 1 / flow.Re))]
    if flow is TWO:
        m, n = flow.viscosity_ratio, flow.depth_ratio
        return [(-n, 0, newtonian(lambda z: (z + n) / (m + n), lambda z: 1 / (m + n), m / flow.Re, flow.density_ratio)),
                (0, 1, newtonian(lambda z: (n + m * z) / (m + n), lambda z: m / (m + n), 1 / flow.Re))]
    if flow is DUNE:
        return [(1 - flow.shields, 0, bed(flow))]
    if flow is LID:
        fluid = newtonian(lambda z: z, lambda z: 1, 1 / flow.Re)
        return [(1 - flow.shields, 0, bed(flow)), (0, 3, {**fluid, "steady": True})]
    if flow.name == "couette":
        return [(-1, 1, newtonian(lambda z: z, lambda z: 1, 1 / flow.Re))]
    return [(-1, 1, newtonian(lambda z: 1 - z**2, lambda z: -2 * z, 1 / flow.Re))]


@pytest.mark.parametrize("flow", FLOWS, ids=["rollwave", "vortex", "film", "two_layer", "dune", "lid", "poiseuille",
                                             "couette"])
def test_the_four_equations_hold_in_physical_units(flow):
    mode = dispersion(flow, K).modes[0]
    for low, high, base in layers(flow):
        x, z, slope = heights(low, high, granular=flow in (ROLL, VORTEX, DUNE, LID) and high < 3)
        found = mode.fields(z)
        values = {name: getattr(found, name) for name in ("u", "w", "t", "n", "p")}
        values.update({f"d{name}": derivative(x, values[name]) / slope for name in ("u", "w", "t", "n")})
        for residual, scale in equations(base, mode, z, values):
            assert np.max(np.abs(residual * slope)) < 1e-10 * np.max(np.abs(scale * slope))


def heights(low, high, granular):
    """Chebyshev points x, their heights z and dz/dx; in sqrt(1 - z), where granular flows are smooth."""
    x = C.chebpts1(40 if granular else 100)
    ends = np.sqrt([1 - low, 1 - high]) if granular else np.array([low, high])
    half = (ends[1] - ends[0]) / 2
    y = ends.mean() + half * x
    return x, 1 - y**2 if granular else y, -2 * y * half if granular else half


def derivative(x, values):
    series = C.chebfit(x, values, len(x) - 1)
    series[np.abs(series) < 1e-14 * np.abs(series).max()] = 0  # rounding, that the derivative would amplify
    return C.chebval(x, C.chebder(series))


def equations(base, mode, z, f):
    """(residual, size of its terms) of the equations of `equations.layer`."""
    U, dU, eta, beta, alpha = (base[name](z) for name in ("U", "dU", "eta", "beta", "alpha"))
    k, along = mode.k, (0 if base.get("steady") else mode.sigma) + 1j * mode.k * U
    terms = ((f["dw"], 1j * k * f["u"]),
             (f["du"], -(f["t"] - alpha * f["p"]) / beta, 1j * k * f["w"]),
             (f["dt"], -base["rho"] * along * f["u"], -base["rho"] * dU * f["w"], 1j * k * f["n"],
              -4 * k**2 * eta * f["u"]),
             (f["dn"], -base["rho"] * along * f["w"], 1j * k * f["t"]),
             (f["p"], f["n"], 2j * k * eta * f["u"]))
    for parts in terms:
        yield sum(parts), sum(np.abs(part) for part in parts)


def test_edges_of_an_inclined_layer():
    for flow, load in ((ROLL, tan(radians(28))), (VORTEX, 0.0)):
        mode = dispersion(flow, K).modes[0]
        wall, surface = mode.fields(0.0), mode.fields(1.0)
        speed = 2 / 3 if flow is ROLL else 0
        assert surface.surfaces["s0"] == pytest.approx(1)
        for value, expected in ((wall.u, 0), (wall.w, 0), (surface.n, -1), (surface.t, load),
                                (surface.w, mode.sigma + 1j * K * speed)):
            assert value == pytest.approx(expected, abs=1e-12)


def test_edges_of_a_film():
    mode = dispersion(FILM, K).modes[0]
    wall, surface = mode.fields(0.0), mode.fields(1.0)
    gravity = 2 * cos(radians(30)) / sin(radians(30)) / FILM.Re
    for value, expected in ((wall.u, 0), (wall.w, 0), (surface.t, 2 / FILM.Re), (surface.n, -gravity - 0.1 * K**2),
                            (surface.w, mode.sigma + 1j * K)):
        assert value == pytest.approx(expected, abs=1e-12)


def test_edges_of_two_liquids():
    """The total velocity is continuous on the displaced interface: u jumps by minus the jump of the shear rate."""
    mode = dispersion(TWO, K).modes[0]
    below, above = mode.fields(0.0), mode.fields(1e-9)
    m, n = TWO.viscosity_ratio, TWO.depth_ratio
    assert above.u - below.u == pytest.approx((1 - m) / (m + n), abs=1e-8)
    assert above.t - below.t == pytest.approx(0, abs=1e-8)
    assert above.w == pytest.approx(mode.sigma + 1j * K * n / (m + n), abs=1e-8)
    assert above.n - below.n == pytest.approx(0.3 * 0.2 + 0.1 * K**2, abs=1e-8)
    assert np.abs(mode.fields([-n, 1.0]).u) == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("flow", [DUNE, LID], ids=["closed form", "layer"])
def test_edges_of_a_bed(flow):
    mode = dispersion(flow, K).modes[0]
    r = np.sqrt(1.7)
    speed = 2 / 3 * (r - 1) ** 2 * (2 * r + 1) / flow.b
    yielding, surface = mode.fields(1 - flow.shields), mode.fields(0.0)
    response = flows.Dune(depth=flow.depth).evaluate(np.array([K]))["R"][0][0]
    for value, expected in ((yielding.u, 0), (yielding.w, 0), (surface.p, 1), (surface.w, mode.sigma + 1j * K * speed),
                            (surface.t, -flow.mu1 * flow.shields * response)):
        assert value == pytest.approx(expected, abs=1e-11)


def test_a_long_wave_on_a_film_moves_like_a_deeper_film():
    """k -> 0: u = s0 (d/dh of the velocity profile of depth h) = 2 z, w = -i k z^2, t = 2 / Re."""
    z = np.linspace(0, 1, 11)
    found = dispersion(flows.Film(), 1e-6).modes[0].fields(z)
    np.testing.assert_allclose(found.u, 2 * z, atol=1e-4)
    np.testing.assert_allclose(found.w, -1e-6j * z**2, atol=1e-10)
    np.testing.assert_allclose(found.t, 0.2, atol=1e-5)


def test_a_long_vortex():
    """k -> 0: n = -1 everywhere drives t = -i k (1 - z), and u' = t / (tan(slope) sqrt(1 - z))."""
    z, k = np.linspace(0, 1, 11), 1e-5
    found = dispersion(flows.Vortex(), k).modes[0].fields(z)
    np.testing.assert_allclose(found.n, -1, rtol=1e-8)
    np.testing.assert_allclose(found.t, -1j * k * (1 - z), atol=1e-12)
    np.testing.assert_allclose(found.u, -2j / 3 * k * (1 - (1 - z) ** 1.5) / tan(radians(30)), atol=1e-12)


def test_a_decaying_mode_of_couette_flow_without_inertia():
    """Re -> 0: w is a Stokes mode cos(m z) / cos m - cosh(k z) / cosh k, and u = i w' / k has its maximum 1."""
    mode = spectrum(flows.Couette(Re=1e-6), 1.0, 1).modes[0]
    m = np.sqrt(-mode.sigma.real * 1e-6 - 1)
    z = np.linspace(-1, 1, 201)
    found = mode.fields(z)
    exact = np.cos(m * z) / np.cos(m) - np.cosh(z) / np.cosh(1)
    factor = found.w[100] / exact[100]
    np.testing.assert_allclose(found.w, factor * exact, atol=1e-6)
    assert np.max(np.abs(found.u)) == pytest.approx(1, abs=1e-3)


def test_half_a_mode_is_continued_by_its_symmetry():
    """The leading mode of plane Poiseuille flow, followed on half the domain, and found on the whole."""
    z = np.linspace(-1, 1, 21)
    half = dispersion(flows.Poiseuille(), 1.0).modes[0]
    whole = Solver(flows.Poiseuille()).solve(1.0, half.rate)
    assert half.flow != whole.flow
    ours, theirs = half.fields(z), whole.fields(z)
    factor = theirs.w[10] / ours.w[10]
    for name in ("u", "w", "t", "n", "p"):
        np.testing.assert_allclose(factor * getattr(ours, name), getattr(theirs, name), atol=1e-10)


def test_an_odd_half_mode_is_continued_too():
    odd = spectrum(flows.Poiseuille().halves()[1], 1.0, 1).modes[0].fields([-0.4, 0.4])
    assert odd.w[0] == pytest.approx(-odd.w[1])
    assert odd.u[0] == pytest.approx(odd.u[1])
    assert odd.n[0] == pytest.approx(odd.n[1])


def test_any_shape_of_z():
    mode = dispersion(DUNE, K).modes[0]
    assert mode.fields(-0.2).u.shape == ()
    assert mode.fields([]).u.shape == (0,)
    assert mode.fields([[-0.2, 0.0], [-0.1, -0.7]]).p.shape == (2, 2)


@pytest.mark.parametrize(("flow", "z", "interval"), [(DUNE, 0.1, r"\[-0.7, 0\]"), (FILM, -0.1, r"\[0, 1\]"),
                                                      (FILM, np.nan, r"\[0, 1\]"), (LID, 3.1, r"\[-0.7, 3\]"),
                                                      (flows.Poiseuille(), -1.1, r"\[-1, 1\]")])
def test_heights_outside_are_refused(flow, z, interval):
    mode = dispersion(flow, K).modes[0]
    with pytest.raises(ParameterError, match=rf"z must lie in the layers of the flow, {interval} \(got {z:g}\)"):
        mode.fields([0.0, z])


@pytest.mark.parametrize(("z", "got"), [(None, "None"), ("a", "'a'"), (0.1j, "0.1j"), ([0.0, [0.1]], r"\[0.1\]"),
                                        ([0.0, np.complex128(0.1)], r".*0.1\+0j.*"), (np.array([0.1j]), "0.1j")])
def test_heights_that_are_no_numbers_are_refused(z, got):
    with pytest.raises(ParameterError, match=rf"^z must be a number or an array of numbers \(got {got}\)$"):
        dispersion(FILM, K).modes[0].fields(z)


@pytest.mark.parametrize("flow", [TWO, flows.Poiseuille()])
def test_a_mode_is_drawn(flow):
    from matplotlib.figure import Figure

    axis = Figure().subplots()
    mode = dispersion(flow, K).modes[0]
    assert mode.plot(axis) is axis
    heights = np.concatenate([line.get_ydata() for line in axis.lines])
    assert (heights.min(), heights.max()) == pytest.approx((-1.5, 1) if flow is TWO else (-1, 1))
    assert len(axis.get_legend().get_texts()) == 2
