"""Where methods fail, how badly, and that this package does not: the table "where each method fails" of the README.

Every failure is measured against an exact value, and so is what replaces the method that fails.
"""

import warnings
from math import radians, tan

import competitors
import numpy as np
import pytest
import references
from scipy.integrate import solve_bvp
from scipy.linalg import eig

from stability import dispersion, flows, k_max, spectrum
from stability.bvp import continuation
from stability.bvp.continuation import bounded_maximum, continue_in_k
from stability.bvp.problem import Problem
from stability.bvp.thesis import thesis_setting
from stability.equations.layer import Layer, Profile
from stability.errors import NotSmooth
from stability.flows.wavy_wall import response
from stability.modes.accuracy import DEGREES
from stability.modes.dense import finite_rates
from stability.modes.solver import Solver
from stability.numerics import chebyshev, smooth

VORTEX, DUNE = flows.Vortex(slope_deg=30.0, Fr2=0.1), flows.Dune(shields=2.0, mu1=0.4, b=1.0, Re=10.0)
VORTEX_2 = -0.45293027274004386  # k = 2, power series in 30-digit arithmetic
DUNE_1 = 0.2343399716339302 - 1.009151053991398j  # k = 1, the same
POISEUILLE = -1j * (0.237526488820470107446579 + 0.00373967062297940993222j)  # Re 1e4, k 1, recomputed to 24 digits


def nearest(values, exact):
    return values[np.argmin(np.abs(values - exact))]


def order(n, error):
    """p of error ~ n^-p, by least squares."""
    return -np.polyfit(np.log(n), np.log(error), 1)[0]


class InZ(flows.Vortex):
    """The same flow and equations without the map zeta = sqrt(1 - z): s is z itself."""

    def layers(self, names):
        mu = tan(radians(self.slope_deg))

        def profile(s):
            root = np.sqrt(1 - s)
            return Profile(dz=1.0, rho=self.Fr2, eta=mu * root, beta=mu * root)

        return (Layer("grains", profile),)


def at_degree(flow, k, degree, exact):
    solver = Solver(flow)
    rates = finite_rates(solver, degree, solver.symbols(k))
    return abs(nearest(solver.width(k) * rates, exact) - exact)


# Free surface: W ~ (1-z)^{5/2}


def test_textbook_collocation_in_z_converges_like_1_over_n():
    n = np.array([24, 32, 48, 64, 96])
    error = [abs(nearest(competitors.vortex(30.0, 0.1, 2.0, m), VORTEX_2) - VORTEX_2) for m in n]
    assert 0.8 < order(n, error) < 1.3
    assert error[-1] > 1e-3


def test_without_the_map_vortices_are_refused():
    with pytest.raises(NotSmooth, match="vortex: layer grains: eta is not smooth near z = 1:"):
        spectrum(InZ(), 2.0)


def test_the_map_is_what_makes_vortices_converge(monkeypatch):
    """In z the same equations gain a factor per doubling, in zeta they are exact at degree 20."""
    def sampled(sample, together=False):
        series = [one if np.any(one) else one[:1] for one in chebyshev.transform(sample(chebyshev.points(96)))]
        return smooth.Fit(tuple(series), np.zeros(len(series)))

    assert at_degree(VORTEX, 2.0, 20, VORTEX_2) < 1e-14
    monkeypatch.setattr("stability.equations.layer.fit", sampled)  # at 96 points at all events
    degrees = np.array([8, 16, 32])
    in_z = [at_degree(InZ(slope_deg=30.0, Fr2=0.1), 2.0, degree, VORTEX_2) for degree in degrees]
    assert order(degrees, in_z) < 5
    assert in_z[-1] > 1e-8


# delta-regularisation


def test_delta_bias_is_five_sixths_of_delta():
    """Lubrication: sigma/sigma_0 = 1 - (5/6) delta + O(delta^2)."""
    k = 1e-3
    exact = dispersion(VORTEX, k).sigma[0].real
    for delta in (1e-2, 1e-3):
        (point,) = continue_in_k(VORTEX, [k], setting=thesis_setting(VORTEX, delta)).points
        bias = point.sigma.real / exact - 1
        assert bias / delta == pytest.approx(-5 / 6, rel=3 * delta)
    assert exact == pytest.approx(VORTEX.long_wave(k), rel=2e-6)


def test_delta_bias_at_moderate_k_is_proportional_to_delta():
    delta = np.array([1e-1, 1e-2, 1e-3])
    bias = [abs(nearest(competitors.vortex(30.0, 0.1, 2.0, 96, value), VORTEX_2) / VORTEX_2 - 1) for value in delta]
    assert -order(delta, bias) == pytest.approx(1, abs=0.1)
    assert bias[1] > 0.01


# Fluid cut at h = 100 / k


def test_cut_fluid_needs_a_grid_that_grows_with_its_inertia():
    """At 64 points and h = 100/k the error of R rises to 0.4 with k Re; the closed form keeps 13 digits."""
    k, error = 1.0, []
    for Re in (0.1, 1.0, 10.0, 1000.0):
        exact = complex(references.wall_response(k, Re))
        error.append(abs(competitors.cut_response(k, Re, 100 / k, 64) / exact - 1))
        assert abs(complex(response(k, Re).value) / exact - 1) < 1e-13
    assert error[0] < 1e-10
    assert error[1] > 1e-5
    assert error[2] > 1e-2
    assert error[3] > 0.2


def test_lid_is_felt_like_exp_minus_2_k_h():
    """A lid at h = 3 / k changes R by about (2 k h)^2 exp(-2 k h) where inertia is weak."""
    k, Re = 1.0, 0.01
    free = complex(response(k, Re).value)
    for height in (3.0, 5.0):
        change = abs(competitors.cut_response(k, Re, height, 40) / free - 1)
        assert 0.3 < change / ((2 * k * height) ** 2 * np.exp(-2 * k * height)) < 3
        exact = complex(references.wall_response(k, Re, height))
        assert abs(complex(response(k, Re, height).value) / exact - 1) < 1e-13


# solve_bvp


def test_complex_branch_of_solve_bvp_does_not_converge():
    """The real split converges from the same guess."""
    problem = Problem(flows.RollWave(), 0.5)
    exact = dispersion(flows.RollWave(), 0.5)
    rate = 1.05 * exact.modes[0].rate
    constant, linear = problem.conditions

    def slopes(x, y, p):
        matrices = problem.matrices(x)
        return np.einsum("ijm,jm->im", matrices[0] + p[0] * matrices[1], y)

    def conditions(ya, yb, p):
        return (constant + p[0] * linear) @ np.concatenate((ya, yb, [1]))

    mesh = np.linspace(0, 1, 17)
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = solve_bvp(slopes, conditions, mesh, np.ones((4, 17), complex), p=[rate], tol=1e-6, max_nodes=500)
    assert not found.success
    (point,) = continue_in_k(flows.RollWave(), [0.5], tolerance=1e-9).points
    assert abs(point.sigma - exact.sigma[0]) < 1e-8 * abs(exact.sigma[0])


def test_yield_surface_needs_the_singular_term(monkeypatch):
    """Left in the right-hand side, S y / s makes solve_bvp fail or settle on a wrong solution."""
    evaluate = Problem._evaluate

    def unsplit(self, s):
        matrices = evaluate(self, s)
        matrices[0] += self._kept[..., None] / np.maximum(s, 1e-10)
        return matrices

    class Unsplit(Problem):
        def __init__(self, *arguments):
            self._kept = 0 * np.zeros((4, 4))
            super().__init__(*arguments)
            self._kept, self.singular = self.singular, 0 * self.singular
            self._seen = {}

    (point,) = continue_in_k(DUNE, [1.0], tolerance=1e-9).points
    assert abs(point.sigma - DUNE_1) < 1e-8
    monkeypatch.setattr(Unsplit, "_evaluate", unsplit)
    monkeypatch.setattr(continuation, "Problem", Unsplit)
    found = continue_in_k(DUNE, [1.0], residual=1e-5, guess=DUNE_1)
    assert found.lost or abs(found.sigma[0] - DUNE_1) > 1e-4


def test_bvp_gives_up_at_a_collision_that_collocation_crosses():
    flow = flows.Vortex(slope_deg=30.0, Fr2=2.0)
    found = continue_in_k(flow, [0.1, 1.0], tolerance=1e-8)
    exact = dispersion(flow, [0.1, 1.0])
    (collision,) = exact.collisions
    assert list(found.lost) == [1.0]
    stopped = float(found.lost[1.0].partition("after k = ")[2].partition(",")[0])
    assert 0.95 * collision.k < stopped < collision.k
    known = complex(references.vortex(30.0, 2.0, 1.0, guess=exact.sigma[1]))
    assert known.imag != 0
    assert abs(exact.sigma[1] - known) < 1e-13


# Dense eigenvalues


def test_raw_pencil_has_spurious_growing_modes():
    """QZ of the undeflated matrices: infinite eigenvalues come out finite, at half of the degrees with huge growth
    rates; at which ones is a matter of rounding."""
    solver = Solver(VORTEX)
    largest = []
    for degree in DEGREES[4:11]:
        pencil = solver.pencil(degree)
        values = eig(*pencil.pair(pencil.weights(solver.symbols(2.0))), right=False)
        largest.append(values[np.isfinite(values)].real.max())
        rates = finite_rates(solver, degree, solver.symbols(2.0))
        assert rates[0].real == pytest.approx(VORTEX_2 / 4, rel=1e-9)
        assert np.all(rates.real < 0)
    assert max(largest) > 1e3


def test_leading_mode_is_not_the_surface_mode():
    """Roll waves, k = 30: an internal mode leads; following from k -> 0 returns the surface mode still."""
    flow = flows.RollWave(slope_deg=28.0)
    surface, leading = dispersion(flow, 30.0), dispersion(flow, 30.0, mode="most-unstable")
    assert leading.growth_rate[0] > surface.growth_rate[0] + 1
    k = np.geomspace(1e-3, 30, 200)
    path = dispersion(flow, k)
    steps = np.diff(path.phase_speed)
    assert abs(path.phase_speed[0] - 1) < 1e-4
    assert np.max(np.abs(steps)) < 0.05


# Long-wave expansion


@pytest.mark.parametrize(("flow", "power"), [(VORTEX, 2), (DUNE, 2 / 3)])
def test_long_wave_limit_is_useless_at_k_of_order_one(flow, power):
    k = np.array([1e-4, 1e-3]) if power < 1 else np.array([1e-3, 1e-2])
    error = np.abs(flow.long_wave(k) / dispersion(flow, k).sigma - 1)
    assert -order(k, error) == pytest.approx(power, abs=0.1)
    assert abs(flow.long_wave(np.array([1.0]))[0] / dispersion(flow, 1.0).sigma[0] - 1) > 0.5


# One maximum


def test_first_maximum_is_not_the_largest():
    """Bounded minimisation from the long waves stops at k = 0.048, a fiftieth of the growth at k = 1.5."""
    flow = flows.Dune(shields=3.0, mu1=0.4, b=1.0, Re=0.1)
    best, other = k_max(flow).maxima
    found = bounded_maximum(flow)
    assert abs(found.k - other.k) < found.error
    assert best.k > 30 * found.k
    assert best.growth_rate > 50 * found.growth_rate


# Fourth-order differentiation


def test_fourth_derivative_loses_digits_as_n_grows():
    n = np.array([96, 128, 192])
    error = [abs(nearest(competitors.poiseuille(1e4, 1.0, m), POISEUILLE) - POISEUILLE) for m in n]
    assert order(n, error) < -2
    assert min(error) > 1e-11
    for degree in (96, 128, 192):
        assert at_degree(flows.Poiseuille(Re=1e4), 1.0, degree, POISEUILLE) < 1e-13


def test_fourth_derivative_in_a_bed():
    R = complex(response(1.0, 10.0).value)
    error = [abs(nearest(competitors.dune(2.0, 0.4, 1.0, 10.0, 1.0, n, R=R), DUNE_1) - DUNE_1) for n in (16, 32, 64)]
    assert error[0] < error[1] < error[2]
    assert error[2] > 1e-8
    assert at_degree(DUNE, 1.0, 64, DUNE_1) < 1e-14
