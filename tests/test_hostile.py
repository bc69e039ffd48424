"""Hostile input: a resolved result or one clear refusal, whatever is passed; and every failure the fuzz has found."""

import math
import warnings

import fuzz
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stability import ParameterError, StabilityError, dispersion, flows
from stability.checks import LARGEST, check_wavenumbers
from stability.flows import FLOWS
from stability.specs import parse_spec

SEED, POINTS, TRUTH = 7, 30, 35
few = settings(max_examples=60, deadline=None, derandomize=True)


@pytest.mark.parametrize("flow", FLOWS)
def test_small_fuzz(flow):
    outcomes = [fuzz.attempt(point) for point in fuzz.points(flow, POINTS, SEED)]
    assert [str(outcome) for outcome in outcomes if outcome.failed] == []
    kinds = {outcome.kind for outcome in outcomes}
    assert {"resolved", "ParameterError"} <= kinds
    checked = list(fuzz.check_truth(outcomes, TRUTH // len(FLOWS), np.random.default_rng(SEED), 1.0))
    assert [found for found in checked if found[2].startswith("failure")] == []
    assert "holds" in {found[2] for found in checked}


def test_small_fuzz_of_the_command_line():
    for line in fuzz.command_lines(30, SEED):
        outcome = fuzz.attempt(line, lambda line: fuzz.verdict(*fuzz.in_process(line)))
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


# Properties.

anything = st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.complex_numbers(), st.text(),
                     st.binary(), st.decimals(), st.fractions(), st.lists(st.floats(), max_size=3),
                     st.sampled_from(fuzz.HOSTILE))
text = st.text(st.characters(exclude_characters="\0", exclude_categories=("Cs",)), max_size=12)
names = st.sampled_from(sorted(FLOWS))


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
    assert number in ("closed-form", "layer", 0.0, math.inf) or 1 / LARGEST <= number <= LARGEST


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
