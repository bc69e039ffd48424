"""What is remembered of flows asked about before changes no answer, whatever the order of the questions."""

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from test_tracking import random_flows

from stability import dispersion, flows, k_max
from stability.modes import memory

FLOWS = int(os.environ.get("STABILITY_MEMORY_FLOWS", 14))  # 3000 for the full sample


@pytest.fixture
def remembered():
    memory.forget()
    yield
    memory.forget()


def cold(flow, k, **options):
    memory.forget()
    return dispersion(flow, k, strict=False, **options)


def alike(one, other):
    """Whether two relations have the same modes within their bars, lost the same and met the same."""
    there = {mode.k: mode for mode in other.modes}
    return one.lost == other.lost and one.notes() == other.notes() and \
        all(abs(mode.sigma - there[mode.k].sigma) <= mode.error + there[mode.k].error for mode in one.modes)


def test_no_order_of_questions_changes_an_answer(remembered):
    rng = np.random.default_rng(8)
    for flow, wavenumbers in random_flows(FLOWS, 11):
        questions = [[k] for k in wavenumbers.tolist()] + [wavenumbers, np.geomspace(0.01, 9.0, 12)]
        answers = [cold(flow, k) for k in questions]
        memory.forget()
        for index in rng.permutation(len(questions)).tolist():
            assert alike(answers[index], dispersion(flow, questions[index], strict=False)), (flow, questions[index])


@pytest.mark.parametrize("flow", [flows.Dune(), flows.Dune(shields=3.0, Re=0.01), flows.Film(Re=20.0)], ids=str)
def test_a_fastest_wave_is_the_same_before_and_after_a_sweep(flow, remembered):
    first = k_max(flow)
    assert alike(cold(flow, [0.5, 2.0]), dispersion(flow, [0.5, 2.0]))
    again = k_max(flow)
    assert len(again.maxima) == len(first.maxima)
    for one, other in zip(first.maxima, again.maxima, strict=True):
        assert abs(one.k - other.k) <= one.error + other.error


def test_a_flow_asked_about_again_is_not_walked_anew(remembered, monkeypatch):
    dispersion(flows.Dune(), 1.0)
    monkeypatch.setattr("stability.modes.tracking.Walk._advance", None)
    assert dispersion(flows.Dune(), 0.7).status == ("resolved",)
    with pytest.raises(TypeError):
        dispersion(flows.Dune(shields=2.5), 0.7)


def test_collisions_are_told_by_every_call_that_meets_them_and_no_other(remembered):
    flow = flows.Vortex(Fr2=5.0)
    assert len(dispersion(flow, [0.1, 8.0]).collisions) == 2
    assert len(dispersion(flow, 0.2).collisions) == 0
    assert len(dispersion(flow, [0.1, 8.0]).collisions) == 2


def test_little_is_kept(remembered):
    for shields in np.linspace(1.5, 3.0, memory.KEPT + 3):
        dispersion(flows.Dune(shields=shields), 0.1)
    assert len(memory._branches) == memory.KEPT


def test_threads_do_not_share_a_branch(remembered):
    k = np.random.default_rng(3).permutation(np.geomspace(0.01, 9.0, 24)).tolist()
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda one: dispersion(flows.Dune(), one).modes[0], k))
    alone = {mode.k: mode for mode in cold(flows.Dune(), k).modes}
    assert all(abs(mode.sigma - alone[mode.k].sigma) <= mode.error + alone[mode.k].error for mode in found)
