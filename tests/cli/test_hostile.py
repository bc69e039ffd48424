"""Hostile input: a resolved result or one clear refusal, whatever is passed; and every failure the fuzz has found."""

import math
import warnings

import fuzz
import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stability import ParameterError, StabilityError, dispersion, flows, k_max, spectrum
from stability.checks import LARGEST, check_wavenumbers
from stability.cli.specs import parse_spec
from stability.flows import FLOWS
from stability.modes.accuracy import Accuracy
from stability.modes.solver import Solver
from stability.numerics.angles import cot_deg
from stability.studies.critical import critical

SEED, POINTS, TRUTH = 9, 30, 4
STEADY = {"pile", "annulus"}  # flows without waves
few = settings(max_examples=60, deadline=None, derandomize=True)


@pytest.mark.parametrize("flow", FLOWS)
def test_small_fuzz(flow):
    outcomes = [fuzz.attempt(point) for point in fuzz.points(flow, POINTS, SEED)]
    assert [str(outcome) for outcome in outcomes if outcome.failed] == []
    kinds = {outcome.kind for outcome in outcomes}
    assert {"ParameterError", *(() if flow in STEADY else ("resolved",))} <= kinds
    checked = list(fuzz.check_truth(outcomes, TRUTH, np.random.default_rng(SEED), 1.0))
    assert [found for found in checked if found[2].startswith("failure")] == []
    assert not hasattr(fuzz.references, flow) or "holds" in {found[2] for found in checked}


def test_small_fuzz_of_the_command_line():
    for line in fuzz.command_lines(30, SEED):
        outcome = fuzz.attempt(line, lambda line: fuzz.verdict(*fuzz.in_process(line)), fuzz.budget_of(line))
        assert not outcome.failed, (line, outcome.kind, outcome.reason)


# What the fuzz itself must notice.


def point(verb="dispersion", **arguments):
    return fuzz.Point("vortex", {}, verb, {"k": 1.0, **arguments})


def test_the_fuzz_sees_exceptions_warnings_hangs_and_long_messages():
    def warn(_):
        warnings.warn("overflow", RuntimeWarning, stacklevel=1)
        return []

    def spin(_):
        while True:
            pass

    def refuse(_):
        raise StabilityError("two\nlines")

    found = [fuzz.attempt(point(), question, 0.05).kind for question in (lambda _: 1 / 0, warn, spin, refuse)]
    assert found == ["failure: ZeroDivisionError", "failure: warning", "failure: hang",
                     "failure: refusal not one line"]
    assert fuzz.attempt(point()).kind == "resolved"
    assert fuzz.attempt(point(k=-1)).kind == "ParameterError"
    assert fuzz.attempt(point(max_degree=8, k=30.0, strict=False)).kind == "unresolved"


def test_the_fuzz_sees_wrong_eigenvalues():
    mode = dispersion(flows.Vortex(), 1.0).modes[0]
    assert fuzz.truth(mode)[0] == "holds"
    wrong = [fuzz.replace(mode, sigma=mode.sigma + shift) for shift in (2 * mode.error, 0.1)]
    assert [fuzz.truth(one)[0] for one in wrong] == ["failure: error bar", "failure: no eigenvalue there"]


@pytest.mark.parametrize("result", [
    (1, "", "Traceback (most recent call last):\nKeyError: 'k'"), (0, "data", "RuntimeWarning: overflow"), (0, "", ""),
    (2, "data", "stability: bad"), (2, "", "stability: bad\nstability: worse"), (7, "data", ""),
])
def test_the_fuzz_sees_bad_manners_of_the_command_line(result):
    with pytest.raises(AssertionError):
        fuzz.verdict(*result)


# Failures that the fuzz has found.

FOUND = {
    "overflow in the equations": fuzz.Point("vortex", {"slope_deg": 1e-310, "Fr2": 5.7e11}, "dispersion", {"k": 2e-3}),
    "overflow of a power": fuzz.Point("two_layer_couette", {"depth_ratio": 1e160}, "dispersion", {"k": 1.0}),
    "overflow of long text": fuzz.Point("dune", {"Re": 10**400}, "dispersion", {"k": 1.0}),
    "no finite eigenvalue": fuzz.Point("dune", {"shields": 1e8, "mu1": 2.8e6, "b": 5e-324, "Re": 5e6, "depth": 4e-8},
                                       "dispersion", {"k": 2e-3, "mode": "leading"}),
    "complex parameter": fuzz.Point("rollwave", {"Fr2": np.complex128(1j)}, "k_max", {}),
    "masked parameter": fuzz.Point("film", {"Re": np.ma.masked}, "dispersion", {"k": 1.0}),
    "complex wavenumber": fuzz.Point("vortex", {}, "dispersion", {"k": 1j}),
    "huge wavenumber": fuzz.Point("vortex", {}, "spectrum", {"k": 10**400}),
    "no wavenumber": fuzz.Point("vortex", {}, "dispersion", {"k": []}),
    "degree as text": fuzz.Point("dune", {}, "dispersion", {"k": 1.0, "max_degree": "1e999"}),
    "negative degree": fuzz.Point("two_layer_couette", {}, "k_max", {"max_degree": -1}),
    "tolerance": fuzz.Point("dune", {}, "spectrum", {"k": 1.0, "tolerance": math.nan}),
    "modes": fuzz.Point("dune", {}, "spectrum", {"k": 1.0, "modes": 10**9}),
    "name": fuzz.Point("dune", {}, "critical", {"vary": []}),
    "strict": fuzz.Point("couette", {}, "dispersion", {"k": 1.0, "strict": np.array([1.0, 2.0])}),
    "long wave": fuzz.Point("film", {}, "critical", {"vary": "Re", "long_wave": np.array([1.0, 2.0])}),
}


@pytest.mark.parametrize("found", FOUND.values(), ids=FOUND)
def test_what_failed_is_refused_as_bad_input(found):
    outcome = fuzz.attempt(found)
    assert (outcome.kind, outcome.seconds < 1) == ("ParameterError", True), outcome.reason


LONG = {
    "modes that never settle": fuzz.Point(
        "dune", {"shields": 24676.8, "mu1": 23.6, "b": 1.4e-3, "Re": 4.9e10, "fluid": "layer"},
        "dispersion", {"k": 16101.7, "mode": "leading", "strict": False}),
    "ill-posed at every value": fuzz.Point(
        "rollwave", {"slope_deg": 14.2186, "Fr2": 0.0165, "mu1": 0.25338, "mu2": 0.68674}, "critical",
        {"vary": "mu1", "strict": False}),
    "a walk on unresolved modes": fuzz.Point(
        "rollwave", {"slope_deg": 89.77200581649878, "Fr2": 1539.6, "mu1": 1.13e-3, "mu2": 287.8}, "dispersion",
        {"k": 1.62, "strict": False, "max_degree": 64}),
    "a walk beyond the largest degree": fuzz.Point(
        "dune", {"shields": 104.1472, "mu1": 77.75874, "b": 8.514796e-06, "Re": 0.0107196, "fluid": "layer"},
        "dispersion", {"k": 0.0073959939, "strict": False}),
}


@pytest.mark.parametrize("found", LONG.values(), ids=LONG)
def test_what_took_for_ever_ends(found):
    outcome = fuzz.attempt(found)
    assert not outcome.failed
    assert outcome.kind != "resolved"


@pytest.mark.parametrize("flow", [
    flows.Vortex(slope_deg=89.99999991, Fr2=457000.841699105),
    flows.Film(slope_deg=90.0), flows.Film(slope_deg=179.9999999, Re=0.1), flows.RollWave(slope_deg=21.5),
])
def test_slopes_next_to_a_critical_one_keep_their_digits(flow):
    mode = dispersion(flow, 0.17).modes[0]
    kind, reason, _ = fuzz.truth(mode)
    assert kind == "holds", reason


@pytest.mark.parametrize(("flow", "k"), [(flows.Couette(Re=1e-8), 109.27100157846834), (flows.Couette(Re=1e-6), 30.0),
                                         (flows.Film(Re=1e-8, slope_deg=99.0, We=0.02), 3.0)])
def test_modes_of_very_viscous_flows_keep_their_digits(flow, k):
    """Stresses are 1/Re times as large as velocities, which must not lose their digits to them."""
    for mode in spectrum(flow, k, 3).modes:
        kind, reason, _ = fuzz.truth(mode)
        assert kind == "holds", reason


def test_uneven_matrices_keep_the_digits_or_tell():
    """Pressures of 1e30 in a film of depth 4e-6 beside a bed of thickness 8: the bar was exceeded 2e5 times."""
    flow = flows.Dune(shields=9.14387521184334, mu1=992.7514530779238, b=2.846689817185222, Re=236117451046.43802,
                      depth=3.5815408193692813e-06, fluid="layer")
    (mode,) = dispersion(flow, 8.714937674024775e-06, mode="most-unstable", strict=False).modes
    assert fuzz.truth(mode)[0] == "holds"


def test_long_sums_leave_internal_modes_their_digits():
    """At degree 320 the quotient is a sum of thousands of products; added up in one go it was wrong by 1.3 bars."""
    flow = flows.RollWave(slope_deg=31.117309425315025, Fr2=0.9250494279606364, mu1=0.5915795474741232,
                          mu2=0.631643876678133)
    mode = spectrum(flow, 7.0128666564288356, 8).modes[-1]
    assert fuzz.truth(mode)[0] == "holds"


@pytest.mark.parametrize(("flow", "k"), [
    (flows.Dune(shields=1.000000001, mu1=10, b=0.0082227, Re=1e-20, depth=6.20134631797298e-06, fluid="layer"), 0.0574),
    (flows.Dune(shields=1.5, depth=6e-6, Re=1e-20, fluid="layer"), 0.05739280704188924),
    (flows.Dune(Re=2e-10, fluid="layer"), 0.5),
    (flows.Film(Re=2.6286467749671453e-16, slope_deg=7.435635610302282, We=1.4286771755755823e+19), 0.6473836077634917),
    (flows.TwoLayerCouette(viscosity_ratio=1600.0, depth_ratio=300.0, density_ratio=174.0, Re=2e-12, tension=1e3), 0.2),
    (flows.Dune(shields=1.0000000237088233, mu1=0.4, Re=218777395140.42657, fluid="layer"), 0.8282769073829681),
], ids=str)
def test_stresses_of_very_viscous_layers_leave_the_other_unknowns_their_digits(flow, k):
    """They are enormous beside the velocities, unless measured in viscous units: bars were exceeded a million times."""
    (mode,) = dispersion(flow, k).modes
    assert fuzz.truth(mode)[0] == "holds"


@pytest.mark.parametrize("degree", [16, 24, 32, 40])
def test_truncation_errors_of_short_waves_hold(degree):
    """Near the truncation the left vector is itself wrong: the rows before must bound what lies beyond."""
    solver = Solver(flows.Couette(Re=2.91229110201458e-08), Accuracy(1.0, degree))
    solver.degrees = (degree,)
    mode = solver.solve(40.69240602656987, -1.39945e9, None, degree)
    exact = -56947093381.57407447  # power series
    assert abs(mode.sigma - exact) < mode.error < 3 * abs(mode.sigma - exact)


@pytest.mark.parametrize("slope", [20.9 * (1 + 1e-12), 20.9001, 28.0, 32.76 * (1 - 1e-12)])
def test_friction_next_to_its_limits_keeps_its_digits(slope):
    flow = flows.RollWave(slope_deg=slope)
    with mp.workdps(40):
        mu, mu1, mu2 = mp.tan(mp.radians(mp.mpf(slope))), mp.mpf(flow.mu1), mp.mpf(flow.mu2)
        exact = (mu2 - mu) * (mu - mu1) / (mu2 - mu1)
        assert abs(flow.e0 / exact - 1) < 2.3e-16


def test_a_liquid_without_mass_carries_no_modes_of_its_own():
    """Its infinite eigenvalues must not pass for modes."""
    found = spectrum(flows.TwoLayerCouette(density_ratio=0.0), 1.0, 3).modes
    assert [fuzz.truth(mode)[0] for mode in found] == ["holds"] * 3
    layers = flows.TwoLayerCouette(density_ratio=0.0).layers(None)
    assert [layer.steady for layer in layers] == [True, False]


def test_a_massless_liquid_gives_no_warning_on_the_command_line():
    line = ["spectrum", "two_layer_couette", "--k=0.1", "--modes=3", "--density-ratio=0"]
    assert not fuzz.attempt(line, lambda line: fuzz.verdict(*fuzz.in_process(line))).failed


@pytest.mark.parametrize("flow", [None, "dune", flows.Dune])
def test_what_is_no_flow_is_refused(flow):
    with pytest.raises(ParameterError, match="flow must be an object of a class in stability.flows"):
        dispersion(flow, 1.0)


def test_a_class_instead_of_a_flow_gets_a_hint():
    with pytest.raises(ParameterError, match=r"did you mean Dune\(\)\?"):
        k_max(flows.Dune)


@pytest.mark.parametrize("search", [1.0, (1.0,), (2.0, 1.0), (0.0, 1.0), "wide", [[]]])
def test_bad_search_ranges_are_refused(search):
    with pytest.raises(ParameterError, match="search"):
        k_max(flows.Dune(), search)


def test_angles_are_exact_far_beyond_double_precision():
    with mp.workdps(60):
        for degrees in (1e-20, 20.9, 45.0, 89.99998447, 90 * (1 - 2.0**-53), 120.0, 179.999):
            exact = mp.cot(mp.radians(mp.mpf(degrees)))
            cot = cot_deg(degrees)
            assert abs(mp.mpf(cot.numerator) / cot.denominator - exact) < mp.mpf("1e-50") * (1 + abs(exact))


# Properties.

anything = st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.complex_numbers(), st.text(),
                     st.binary(), st.decimals(), st.fractions(), st.lists(st.floats(), max_size=3),
                     st.sampled_from(fuzz.HOSTILE))
text = st.text(st.characters(exclude_characters="\0", exclude_categories=("Cs",)), max_size=12)
names = st.sampled_from(sorted(FLOWS))
EDGES = "wall", "free", "decay"


def accepted(function, *arguments, **options):
    """(result, "") or (None, the refusal), which is one short line; without any warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            return function(*arguments, **options), ""
        except ParameterError as refusal:
            reason = str(refusal)
    assert reason
    assert "\n" not in reason
    assert len(reason) < 400
    return None, reason


@few
@given(names, st.data())
def test_any_parameter_is_a_number_in_range_or_refused_in_one_line(name, data):
    item = data.draw(st.sampled_from(fuzz.fields(FLOWS[name])))
    value = data.draw(anything)
    flow, refusal = accepted(FLOWS[name], **{item.name: value})
    if refusal:
        assert item.name in refusal or "slope_deg must lie between" in refusal
        return
    number = getattr(flow, item.name)
    assert type(number) is (str if "options" in item.metadata else float)
    assert number in ("closed-form", "layer", 0.0, math.inf, -math.inf, *EDGES) \
        or 1 / LARGEST <= abs(number) <= LARGEST


@few
@given(anything)
def test_any_wavenumber_is_positive_or_refused_in_one_line(k):
    wavenumbers, refusal = accepted(check_wavenumbers, k)
    if not refusal:
        assert wavenumbers.dtype == float
        assert np.all((wavenumbers >= 1 / LARGEST) & (wavenumbers <= LARGEST))


@few
@given(text)
def test_any_text_as_spec_gives_finite_numbers_or_one_line(words):
    values, refusal = accepted(parse_spec, words, "--k")
    assert refusal or np.all(np.isfinite(values) & (values > 0))


@few
@given(names, st.lists(text, max_size=3), st.sampled_from(["--k", "--Re", "--over", "--mode", "--tolerance", "-o", ""]))
def test_any_words_on_the_command_line_give_no_traceback(name, words, flag):
    line = ["dispersion", name, *([f"{flag}={words[0]}"] if flag and words and flag != "-o" else []), *words]
    status, out, err = fuzz.in_process([*line, "--k=1", "--quiet"] if len(words) < 2 else line)
    assert status in (0, 2, 3)
    assert status != 2 or (err.count("\n") == 1 and not out)


@few
@given(st.sampled_from(["vortex", "dune", "rollwave", "film", "two_layer_couette"]), st.integers(0, 10**6))
def test_growth_rates_belong_to_their_wavenumbers_whatever_the_order(name, seed):
    """A sequence of wavenumbers in any order, with repetitions, gives what each one gives alone."""
    k = np.exp(np.random.default_rng(seed).uniform(-3, 1, 3))[[0, 1, 2, 1]]
    together = dispersion(FLOWS[name](), k)
    alone = dispersion(FLOWS[name](), k[2]).modes[0]
    assert together.k.tolist() == k.tolist()
    assert together.sigma[1] == together.sigma[3]
    assert abs(alone.sigma - together.sigma[2]) <= alone.error + together.error[2]


@pytest.mark.parametrize("compute", [lambda strict: dispersion(flows.Couette(), 1.0, strict=strict),
                                     lambda strict: spectrum(flows.Couette(), 1.0, strict=strict),
                                     lambda strict: k_max(flows.Dune(), strict=strict),
                                     lambda strict: critical(flows.Film(), "Re", strict=strict)])
def test_strict_is_a_flag(compute):
    for value in (np.array([1.0, 2.0]), "yes", None):
        with pytest.raises(ParameterError, match="strict must be True or False"):
            compute(value)
