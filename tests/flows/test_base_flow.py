"""Base flows that are no polynomials: series that end, error bars that hold, and profiles that are refused."""

import pickle
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np
import pytest
from scipy.interpolate import CubicSpline, make_interp_spline
from sheared import CASES, RANDOM, BoundaryLayer, Jet, RandomShear, ShearLayer
from twins import table

from stability import cli, flows, spectrum
from stability.bvp.problem import Problem
from stability.equations.forms import variable
from stability.equations.layer import Layer, Profile
from stability.equations.pencil import Pencil
from stability.equations.system import System
from stability.errors import NotSmooth, ParameterError
from stability.modes.energy import energy
from stability.modes.solver import Solver
from stability.numerics import chebyshev, smooth

# From power series in multi-precision: without lids and exact to all digits, but for the layer between lids at +-10.
EXACT = {"shear_layer": 0.4363266116899444088628j, "thick_shear_layer": 0.4366493344311722603j,
         "open_boundary_layer": 0.36412128993779585930 + 0.0079625053677670986j}
LID = 2 * np.exp(-2 * 0.4 * 40)  # what lids at +-40 change: the mode falls like exp(-k |z|)
REFERENCES = {row["flow"]: complex(float(row["c_real"]), float(row["c_imag"]))
              for row in table("recomputed_base_flows")}
SEEDS = range(RANDOM)
DEGREES = (24, 32, 48, 64, 96, 128, 192)


@dataclass(frozen=True)
class _Given(ShearLayer):
    """The shear layer between lids at +-10 with other coefficients: `changes` maps z to fields of the profile."""

    name: ClassVar[str] = "given"
    changes: Any = field(default=None, metadata={"meaning": "no number"})

    def __post_init__(self):
        pass

    def layers(self, names):
        def profile(s):
            z = self.low + (self.high - self.low) * s
            U, dU, _ = self.shape(z)
            values = {"dz": self.high - self.low, "U": U, "dU": dU, "eta": 1 / self.Re, "beta": 1 / self.Re}
            return Profile(**values | self.changes(z))

        return (Layer("fluid", profile),)


def given(**fields):
    """A flow whose profile has these fields, numbers or functions of z."""
    return _Given(changes=lambda z: {name: one(z) if callable(one) else one for name, one in fields.items()})


def solved(flow, k, c, degree):
    """The mode next to wave speed c at one degree."""
    return Solver(flow).solve(k, -1j * k * c, None, degree, glance=True)


# -- right numbers --------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "lid"), [("shear_layer", 0), ("thick_shear_layer", LID), ("open_boundary_layer", 0)])
def test_the_table_agrees_with_multi_precision(name, lid):
    assert abs(REFERENCES[name] - EXACT[name]) <= lid + 1e-16


@pytest.mark.parametrize("name", CASES)
def test_named_flows(name):
    """Error bars hold, and are far below the tolerance."""
    flow, k, *_ = CASES[name]
    c = REFERENCES[name]
    mode = solved(flow, k, c, 512) if name == "thick_shear_layer" else spectrum(flow, k, 1).modes[0]
    assert abs(mode.c - c) <= mode.error / k < 2e-12


def test_a_lid_far_above_a_boundary_layer_is_felt():
    """It changes the eleventh digit: exp(-2 k 40)."""
    assert 1e-12 < abs(REFERENCES["boundary_layer"] - REFERENCES["open_boundary_layer"]) < np.exp(-2 * 0.308 * 40)


@pytest.mark.parametrize("seed", SEEDS)
def test_error_bars_of_random_profiles_at_the_default(seed):
    flow, k = RandomShear.draw(seed)
    mode = spectrum(flow, k, 1).modes[0]
    assert abs(mode.c - REFERENCES[str(seed)]) <= mode.error / k < 1e-10


def misses(flow, k):
    """How many error bars there are at degrees from poor to good, and those degrees at which they do not hold."""
    solver = Solver(flow)
    mode = spectrum(flow, k, 1).modes[0]
    count, missed = 0, []
    for degree in DEGREES:
        found = solver.solve(k, mode.rate, (mode.degree, mode.x, mode.y), degree, glance=True)
        if abs(found.sigma - mode.sigma) < 0.05 * abs(mode.sigma):  # else it is another mode
            count += 1
            missed += [degree] * (abs(found.sigma - mode.sigma) > found.error + mode.error)
    return count, missed


@pytest.mark.parametrize("seed", range(0, RANDOM, 5))
def test_error_bars_hold_where_the_series_of_the_profile_are_longer_than_the_degree(seed):
    count, missed = misses(*RandomShear.draw(seed))
    assert count > 2
    assert not missed


@dataclass(frozen=True)
class _Rippled(RandomShear):
    """U = z with a ripple T_60(z): one term far beyond many a degree."""

    name: ClassVar[str] = "rippled"

    def shape(self, z):
        ripple = np.polynomial.chebyshev.Chebyshev.basis(60) * 0.02
        return z + z**2 + ripple(z), 1 + 2 * z + ripple.deriv()(z), None


def test_error_bars_hold_where_one_term_lies_far_beyond_the_degree():
    count, missed = misses(_Rippled(Re=50.0), 1.0)
    assert count > 5
    assert not missed


def test_a_short_tail_is_seen(monkeypatch):
    """With 8 rows beyond the degree, enough for short series, the ripple goes unnoticed below degree 60."""
    monkeypatch.setattr(System, "longest", 8)
    assert misses(_Rippled(Re=50.0), 1.0)[1]


@pytest.mark.parametrize("seed", range(0, RANDOM, 6))
def test_twice_the_samples_change_nothing_beyond_the_error_bar(seed, monkeypatch):
    flow, k = RandomShear.draw(seed)
    mode = spectrum(flow, k, 1).modes[0]
    first = 2 * System(flow).longest
    monkeypatch.setattr(smooth, "_FIRST", 1 << int(first).bit_length())
    again = Solver(flow).solve(k, mode.rate, (mode.degree, mode.x, mode.y), min(2 * mode.degree, 512))
    assert abs(again.sigma - mode.sigma) <= again.error + mode.error


@pytest.mark.parametrize("name", ["shear_layer", "jet"])
def test_too_few_samples_are_seen(name, monkeypatch):
    """The guard of the tests above: with 96 terms at all events the values are wrong by far more than their bars."""
    flow, k, *_ = CASES[name]

    monkeypatch.setattr("stability.equations.layer.fit", _ninety_six)
    monkeypatch.setattr("stability.flows.base.verify", lambda flow: None)  # it misses the slope of U
    mode = solved(flow, k, REFERENCES[name], 320)
    assert abs(mode.c - REFERENCES[name]) > 100 * mode.error / k


JET = 0.13977801929317265523511123167308 - 0.45507837165153112336417107187673j  # sigma; Taylor series, 90 digits


def test_a_jet_in_thirty_digits(monkeypatch):
    """The sinuous mode of U = sech^2 z between lids without stress at +-10, Re 100, k 1; with 96 samples 7e-8 off."""
    given, derived = Jet(), flows.find(f"{Path(__file__).parents[1] / 'own' / 'lids.py'}:Jet")()
    for flow in (given, derived):
        mode = spectrum(flow, 1.0, 1).modes[0]
        finer = Solver(flow).solve(1.0, mode.rate, (mode.degree, mode.x, mode.y), 2 * mode.degree, glance=True)
        assert abs(mode.sigma - JET) < mode.error < 1e-11
        assert abs(finer.sigma - JET) < finer.error
    monkeypatch.setattr("stability.equations.layer.fit", _ninety_six)
    monkeypatch.setattr("stability.flows.base.verify", lambda flow: None)
    coarse = Solver(Jet()).solve(1.0, mode.rate, None, 192, glance=True)
    assert abs(coarse.sigma - JET) > max(1e-9, 100 * coarse.error)


def _ninety_six(sample, together=False):
    values = sample(chebyshev.points(96))
    series = [one if np.any(one) else one[:1] for one in chebyshev.transform(values)]
    return smooth.Fit(tuple(series), np.zeros(len(values)))


# -- what is cut off ------------------------------------------------------------------------------------


def tabulated(points, degree):
    """The shear layer from a spline through a table."""
    z = np.linspace(-10, 10, points)
    spline = CubicSpline(z, np.tanh(z)) if degree == 3 else make_interp_spline(z, np.tanh(z), degree)
    return given(U=spline, dU=spline.derivative())


@pytest.mark.parametrize(("points", "degree", "accuracy"), [(801, 7, 1e-11), (2001, 3, 1e-6)])
def test_a_tabulated_profile_has_an_honest_bar(points, degree, accuracy):
    mode = solved(tabulated(points, degree), 0.4, REFERENCES["shear_layer"], 192)
    error = abs(mode.c - REFERENCES["shear_layer"])
    assert error <= mode.error / 0.4 < accuracy


def noisy(amplitude):
    rng = np.random.default_rng(7)
    return given(U=lambda z: np.tanh(z) + amplitude * rng.standard_normal(z.shape))


@pytest.mark.parametrize("amplitude", [1e-13, 1e-12, 1e-11, 1e-10])
def test_noise_widens_the_bar(amplitude):
    modes = [solved(noisy(amplitude), 0.4, REFERENCES["shear_layer"], 192) for _ in range(3)]
    for mode in modes:
        assert abs(mode.c - REFERENCES["shear_layer"]) <= mode.error / 0.4 < 100 * amplitude


def test_noise_without_its_share_of_the_bar_is_seen(monkeypatch):
    monkeypatch.setattr(Pencil, "cut", lambda self, weights, y, x: 0.0)
    mode = solved(noisy(1e-10), 0.4, REFERENCES["shear_layer"], 192)
    assert abs(mode.c - REFERENCES["shear_layer"]) > 10 * mode.error / 0.4


def test_a_perturbation_of_known_effect_is_within_its_bound(monkeypatch):
    """The bound on what a cut does, against the change that a ripple of the same size makes: of U alone."""
    monkeypatch.setattr("stability.flows.base.verify", lambda flow: None)  # it would miss the slope of the ripple
    plain, size = ShearLayer(), 1e-7
    rippled = given(U=lambda z: np.tanh(z) + size / np.cosh(z) ** 2)
    mode = solved(plain, 0.4, REFERENCES["shear_layer"], 192)
    change = abs(solved(rippled, 0.4, REFERENCES["shear_layer"], 192).sigma - mode.sigma)
    solver = Solver(plain)
    pencil = solver.pencil(192)
    part = {monomial: index for index, monomial in enumerate(pencil.parts)}
    pencil.cuts = [(part[monomial], unknown, pencil.rows[equation.name], 20 * size)
                   for equation in solver.assembly.system.equations for unknown, monomial, _ in equation.cuts
                   if monomial[-1] != "rate"]
    weights = solver.weights([0.4]).value
    bound = 0.4 * pencil.cut(weights * pencil.powers(mode.rate)[:, None], mode.y.conj()[:, None], mode.x[:, None])[0]
    assert change < bound < 300 * change


@pytest.mark.parametrize("flow", [flows.Dune(), flows.Dune(fluid="layer"), flows.Vortex(), flows.RollWave(),
                                  flows.Poiseuille(), flows.Film(), flows.TwoLayerCouette()], ids=str)
def test_polynomials_leave_nothing_out(flow, monkeypatch):
    """And one look is enough for them, and no bound is computed."""
    looks = []
    points = chebyshev.points
    monkeypatch.setattr(chebyshev, "points", lambda count: looks.append(count) or points(count))
    monkeypatch.setattr(Pencil, "cut", None)
    system = System(flow)
    assert len(looks) == len(system.fields) // 4
    assert system.longest <= 8
    assert not any(equation.cuts for equation in system.equations)
    spectrum(flow, 1.0, 1, strict=False)


# -- series of functions --------------------------------------------------------------------------------


def fitted(function):
    return smooth.fit(lambda s: function(s)[None])


@pytest.mark.parametrize("count", [64, 128, 1024])
def test_transforms_are_inverse(count):
    series = np.random.default_rng(2).standard_normal((3, count))
    x = 2 * chebyshev.points(count) - 1
    expected = np.polynomial.chebyshev.chebvander(x, count - 1) @ series.T
    np.testing.assert_allclose(chebyshev.values(series), expected.T, atol=1e-8)
    np.testing.assert_allclose(chebyshev.transform(chebyshev.values(series)), series, atol=1e-14)
    np.testing.assert_allclose(chebyshev.transform(1j * chebyshev.values(series)), 1j * series, atol=1e-14)


@pytest.mark.parametrize("width", [1.0, 0.1, 0.01, 0.003])
def test_what_is_cut_bounds_the_error_everywhere(width):
    def bump(s):
        return np.tanh((s - 0.3) / width)

    fit = fitted(bump)
    s = np.random.default_rng(4).uniform(0, 1, 2000)
    assert np.max(np.abs(fit.at(s)[0] - bump(s))) <= max(fit.cut[0], 1e-14) < 1e-11


def test_a_feature_that_all_sample_points_miss_is_seen_by_the_probes(monkeypatch):
    """A narrow peak on a probe, 0 at the sample points."""
    at = smooth._probes()[0][3]
    assert np.min(np.abs(chebyshev.points(64) - at)) > 2e-4

    def peak(s):
        return s + np.exp(-(((s - at) / 2e-5) ** 2))

    with pytest.raises(smooth.Rough) as rough:
        fitted(peak)
    assert rough.value.s == pytest.approx(at, abs=1e-3)
    monkeypatch.setattr(smooth, "_ROUNDING", np.inf)  # the guard: blind to the probes, it is taken for s
    assert len(fitted(peak).series[0]) == 2


def test_probes_are_no_sample_points():
    probes = smooth._probes()[0]
    for count in 2 ** np.arange(6, 13):
        assert np.min(np.abs(chebyshev.points(count)[:, None] - probes)) > 1e-9


def test_parity_is_kept():
    """Every other coefficient of an odd function is exactly 0, in long series too."""
    (series,) = fitted(lambda s: np.tanh(20 * (2 * s - 1))).series
    assert len(series) > 100
    assert not np.any(series[::2])


# -- refusals -------------------------------------------------------------------------------------------

KINKED, VALUES = "take a smooth profile", "must be finite real numbers"
REFUSED = {
    "kink": ({"U": np.abs}, r"U is not smooth near z = -?0\.0"),
    "step": ({"U": lambda z: np.tanh(z) + (z > 2.2)}, r"U is not smooth near z = 2\.[12]"),
    "noise": ({"U": lambda z: np.tanh(z) + 1e-3 * np.random.default_rng(1).standard_normal(z.shape)},
              r"U is not smooth near z = "),
    "curvature": ({"U": lambda z: z * np.abs(z)}, r"U is not smooth near z = -?0\.0"),
    "slope": ({"dU": lambda z: np.abs(z - 1)}, r"dU is not smooth near z = (1\.0|0\.9)"),
    "eta": ({"eta": lambda z: 1 + np.abs(z)}, r"eta is not smooth near z = -?0\.0"),
    "dz": ({"dz": lambda z: 20 + np.abs(z)}, r"dz is not smooth near s = 0\.[45]"),
    "beta": ({"beta": lambda z: z**2}, r"the coefficients of the equations are not smooth near z = -?0\.0"),
    "nan": ({"U": lambda z: np.where(np.abs(z) < 1, np.nan, z)}, r"U is nan near z = -?0\."),
    "inf": ({"dU": lambda z: np.where(z > 9, np.inf, z)}, r"dU is inf near z = 9\."),
    "constant": ({"beta": np.inf}, "beta is inf:"),
    "complex": ({"U": lambda z: z + 1j}, "U is complex:"),
    "short": ({"U": lambda z: z[:3]}, r"U has the shape \(3,\) at points of the shape \("),
    "column": ({"dU": lambda z: z[:, None]}, r"dU has the shape \(\d+, 1\)"),
    "none": ({"alpha": None}, "alpha is no number:"),
    "words": ({"alpha": "0.1"}, "alpha is no number:"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_rough_profiles_are_refused_in_one_line(case):
    fields, message = REFUSED[case]
    with pytest.raises(NotSmooth, match="given: layer fluid: " + message) as refusal:
        System(given(**fields))
    assert ("\n" in str(refusal.value), KINKED in str(refusal.value) or VALUES in str(refusal.value)) == (False, True)


@pytest.mark.parametrize("case", ["constant", "complex"])
def test_without_the_check_of_values_they_pass(case, monkeypatch):
    monkeypatch.setattr(Layer, "_checked", lambda self, s: self.profile(s))
    System(given(**REFUSED[case][0]))


@pytest.mark.parametrize("case", ["kink", "step", "noise", "eta"])
def test_without_a_limit_on_the_plateau_rough_profiles_pass(case, monkeypatch):
    monkeypatch.setattr(smooth, "_PLATEAU", 1e9)
    monkeypatch.setattr(smooth, "_FLAT", 1e9)
    monkeypatch.setattr(smooth, "_STRAY", 1e9)
    System(given(**REFUSED[case][0]))


def test_refusals_are_bad_input_and_survive_pickling():
    with pytest.raises(ParameterError) as refusal:
        spectrum(given(U=np.abs), 1.0)
    assert str(pickle.loads(pickle.dumps(refusal.value))) == str(refusal.value)


def test_heights_of_an_upper_layer_are_those_in_the_flow(monkeypatch):
    flow = flows.TwoLayerCouette(depth_ratio=3.0)
    lower, upper = flow.layers(None)
    rough = replace(upper, profile=lambda s: replace(upper.profile(s), U=np.abs(s - 0.25)))
    monkeypatch.setattr(flows.TwoLayerCouette, "layers", lambda self, names: (lower, rough))
    with pytest.raises(NotSmooth, match=r"two_layer_couette: layer upper: U is not smooth near z = 0\.2[45]"):
        System(flow)


def test_a_height_that_depends_on_a_symbol_is_given_in_the_layer():
    layer = Layer("fluid", lambda s: Profile(dz=variable("H"), U=np.abs(s - 0.5), dU=0.0, eta=1.0, beta=1.0))
    with pytest.raises(NotSmooth, match=r"layer fluid: U is not smooth near s = 0\.[45]"):
        layer.resolved(lambda base, s: [base.U])


def test_the_height_of_a_rough_map_is_refused():
    with pytest.raises(NotSmooth, match="layer fluid: dz is not smooth"):
        Layer("fluid", lambda s: Profile(dz=1 + np.abs(s - 0.3), eta=1.0, beta=1.0)).height(np.array([0.5]))


def test_the_command_line_refuses_with_status_2(monkeypatch, capsys):
    couette = flows.Couette().layers(None)[0]
    rough = replace(couette, profile=lambda s: replace(couette.profile(s), U=np.abs(s - 0.5)))
    monkeypatch.setattr(flows.Couette, "layers", lambda self, names: (rough,))
    assert cli.main(["spectrum", "couette", "--k", "1"]) == 2
    assert "couette: layer fluid: U is not smooth near z = " in capsys.readouterr().err


# -- the same series everywhere -------------------------------------------------------------------------


@dataclass(frozen=True)
class _Stretched(BoundaryLayer):
    """Flow on a plate in heights that crowd at z = 4: a map with a long series, and U = z^2 / 100."""

    name: ClassVar[str] = "stretched"
    low: ClassVar[float] = 0.0
    high: ClassVar[float] = 10.0

    def layers(self, names):
        def profile(s):
            z = self.height(s)
            return Profile(dz=self.slope(s), U=z**2 / 100, dU=z / 50, eta=1 / self.Re, beta=1 / self.Re)

        return (Layer("fluid", profile),)

    @staticmethod
    def height(s):
        return 10 * s + 0.5 * (np.tanh(30 * (s - 0.4)) - np.tanh(-12.0) - s * (np.tanh(18.0) - np.tanh(-12.0)))

    @staticmethod
    def slope(s):
        return 10 + 15 / np.cosh(30 * (s - 0.4)) ** 2 - 0.5 * (np.tanh(18.0) - np.tanh(-12.0))


@dataclass(frozen=True)
class _Even(_Stretched):
    """The same flow in even heights."""

    def layers(self, names):
        return (Layer("fluid", lambda s: Profile(dz=10.0, U=s**2, dU=s / 5, eta=1 / self.Re, beta=1 / self.Re)),)


def test_heights_of_a_steep_map():
    flow = _Stretched()
    s = np.linspace(0, 1, 301)
    np.testing.assert_allclose(flow.layers(None)[0].height(s), flow.height(s), atol=1e-12)


def test_a_map_changes_neither_eigenvalues_nor_fields_nor_condition_numbers():
    modes = [spectrum(flow(Re=200.0), 0.7, 1).modes[0] for flow in (_Stretched, _Even)]
    assert abs(modes[0].sigma - modes[1].sigma) <= modes[0].error + modes[1].error
    z = np.linspace(0, 10, 41)
    one, two = (mode.fields(z) for mode in modes)
    for name in ("w", "t", "n", "p"):
        ours, theirs = getattr(one, name) / one.w[20], getattr(two, name) / two.w[20]
        np.testing.assert_allclose(ours, theirs, atol=1e-9 * np.max(np.abs(theirs)))
    numbers = [spectrum(mode.flow, 0.7, 1).rows()[0]["condition"] for mode in modes]
    assert numbers[0] == pytest.approx(numbers[1], rel=1e-9)


def energy_error():
    """Largest error of the energies of pairs of low T_j on a steep map, against many nodes, relative to the largest."""
    solver, degree = Solver(_Stretched()), 8
    nodes, weights = np.polynomial.legendre.leggauss(600)
    s = (1 + nodes) / 2
    states = energy(solver, 0.7, degree).state[:, solver.pencil(degree).columns["fluid.v"]]
    v = chebyshev.at(s, degree)
    expected = v.T @ ((weights / 2 * _Stretched.slope(s))[:, None] * v)
    return np.max(np.abs((states.conj().T @ states).real - expected)) / np.max(np.abs(expected))


def test_energy_takes_enough_nodes_for_a_long_density(monkeypatch):
    assert energy_error() < 1e-11
    monkeypatch.setattr(smooth.Fit, "length", 0)  # the guard: nodes for polynomials are too few
    assert energy_error() > 1e-9


def test_viscous_stress_of_a_mode_in_a_steep_viscosity():
    """n = -p + 2 eta dw/dz with an eta whose series is long."""
    viscosity = SimpleNamespace(at=lambda z: 0.01 * (2 + np.tanh(8 * z)))
    flow = given(eta=viscosity.at, beta=viscosity.at)
    mode = spectrum(flow, 0.4, 1, strict=False).modes[0]
    z = np.linspace(-5, 5, 23)
    fields = mode.fields(z)
    expected = -fields.p - 2j * 0.4 * viscosity.at(z) * fields.u  # dw/dz = -i k u
    np.testing.assert_allclose(fields.n, expected, atol=1e-12 * np.max(np.abs(fields.n)))


def test_the_limit_of_0_by_0_in_the_boundary_value_problem():
    """Entries that solve_bvp needs at an edge where the profile gives 0/0 come from the same series."""
    flow = given(U=lambda z: np.where(z == 10, np.nan, np.tanh(z)))
    problem = Problem(flow, 0.4)
    at_edge, near = problem.matrices(np.array([1.0]))[..., 0], problem.matrices(np.array([1 - 1e-9]))[..., 0]
    assert np.all(np.isfinite(at_edge))
    np.testing.assert_allclose(at_edge, near, atol=1e-6)
