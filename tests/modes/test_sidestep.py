"""Modes of flows that are all but the same, stepped to in the parameters, are those of a walk."""

import os
from dataclasses import replace

import numpy as np
import pytest
from test_foresight import chain
from test_memory import alike, cold, remembered  # noqa: F401
from test_tracking import random_flows

from stability import dispersion, flows
from stability.modes import memory, sidestep
from stability.modes.accuracy import TOLERANCE, check_accuracy
from stability.modes.solver import Solver
from stability.modes.tracking import Walk
from stability.numerics.refine import quotient
from stability.status import is_resolved

CHAINS = int(os.environ.get("STABILITY_SIDESTEP_CHAINS", 14))  # 600 for 3000 answers
CROWD, ASIDE, K = flows.Dune(Re=0.3, shields=10.75), flows.Dune(Re=0.3, shields=10.35), 8.1  # in a crowd of modes


@pytest.fixture
def walks(monkeypatch):
    """The flows that are walked for."""
    walked, beyond = [], Walk.beyond
    monkeypatch.setattr(Walk, "beyond", lambda walk, k: walked.append(walk.solver.flow) or beyond(walk, k))
    return walked


def test_random_flows_close_together(remembered, monkeypatch):  # noqa: F811
    """In chains of flows that differ by at most 10 % in a parameter each answer is that of its flow alone."""
    steps, stepped = [], memory.sidestepped
    monkeypatch.setattr(memory, "sidestepped", lambda *given: steps.append(stepped(*given)) or steps[-1])
    rng = np.random.default_rng(4)
    for flow, wavenumbers in random_flows(CHAINS, 31):
        memory.forget()
        loop = chain(flow, rng, steps=4, far=0.1)
        warm = [dispersion(one, wavenumbers[:1], strict=False) for one in loop]
        for one, relation in zip(loop, warm, strict=True):
            assert alike(cold(one, wavenumbers[:1]), relation), (one, wavenumbers[0])
    assert sum(found is not None for found in steps) > CHAINS


def test_a_loop_walks_for_few_of_its_flows(remembered, walks):  # noqa: F811
    loop = [flows.Dune(shields=float(shields)) for shields in np.linspace(1.5, 2.5, 41)]
    warm = [dispersion(flow, [0.9, 1.0]) for flow in loop]
    assert len(set(walks)) < 20
    for flow, relation in zip(loop[::5], warm[::5], strict=True):
        assert alike(cold(flow, [0.9, 1.0]), relation)


@pytest.mark.parametrize("second", [
    flows.Dune(shields=2.3), flows.Dune(shields=2.01, depth=10.0), flows.Dune(shields=2.01, fluid="layer")], ids=str)
def test_what_is_farther_off_is_walked_for(second, remembered, walks):  # noqa: F811
    dispersion(flows.Dune(shields=2.0), 1.0)
    dispersion(second, 1.0)
    assert second in walks


def test_other_questions_are_walked_for(remembered, walks):  # noqa: F811
    for k, options in ((1.01, {}), ([1.0, 1.01], {}), (1.0, {"tolerance": 1e-9})):
        memory.forget()
        dispersion(flows.Dune(shields=2.0), 1.0)
        walks.clear()
        dispersion(flows.Dune(shields=2.01), k, strict=False, **options)
        assert walks, (k, options)


def test_one_steps_from_flows_that_were_walked_for_alone(remembered, walks):  # noqa: F811
    """Many small steps in a row would go as far as one that is too large."""
    for Re in (10.0, 10.5, 11.0, 11.3):
        dispersion(flows.Dune(Re=Re), 1.0)
    assert [flow.Re for flow in walks] == [10.0, 11.3]


def test_flows_from_elsewhere_are_walked_for(remembered, walks):  # noqa: F811
    """Their long-wave laws are checked on the way."""
    class Own(flows.Dune):
        name = "own"

    dispersion(Own(shields=2.0), 1.0)
    walks.clear()
    dispersion(Own(shields=2.01), 1.0)
    assert walks


def test_real_modes_are_walked_for(remembered, walks):  # noqa: F811
    dispersion(flows.Vortex(Fr2=0.1), 1.0)
    walks.clear()
    dispersion(flows.Vortex(Fr2=0.101), 1.0)
    assert walks


def test_nobody_steps_from_a_walk_of_short_steps():
    assert sidestep.near_enough(0.1, 0.55)
    assert not sidestep.near_enough(0.12, 0.55)
    assert not sidestep.near_enough(1e-4, 0.05)


def taken(start, flow, k=K):
    """The step from the mode of a flow to that of another, or None."""
    return sidestep.sidestepped(Solver(flow), [cold(start, k).modes[0]])


@pytest.mark.parametrize("guard", ["small", "straight", "overlapping"])
def test_each_check_refuses_another_mode_by_itself(guard, remembered, monkeypatch):  # noqa: F811
    for other in {"small", "straight", "overlapping"} - {guard}:
        monkeypatch.setattr(sidestep, other, lambda *given: True)
    assert taken(CROWD, ASIDE) is None


def test_without_the_checks_another_mode_would_be_taken(remembered, monkeypatch):  # noqa: F811
    for guard in ("small", "straight", "overlapping"):
        monkeypatch.setattr(sidestep, guard, lambda *given: True)
    wrong, right = taken(CROWD, ASIDE)[K], cold(ASIDE, K).modes[0]
    assert abs(wrong.sigma - right.sigma) > 0.1 * abs(right.sigma)


def test_what_is_not_resolved_is_walked_for(remembered):  # noqa: F811
    accuracy = check_accuracy(TOLERANCE, 12)
    (mode,) = cold(flows.Dune(shields=2.0), 3.0, max_degree=12).modes
    assert not is_resolved(mode.status)
    assert sidestep.sidestepped(Solver(flows.Dune(shields=2.01), accuracy), [mode]) is None


def test_the_quotient_of_a_neighbours_vectors_is_the_rate_to_first_order():
    flow = flows.Dune()
    (mode,), misses = dispersion(flow, 1.0).modes, []
    for change in (1e-2, 1e-3):
        other = replace(flow, shields=flow.shields * (1 + change))
        solver = Solver(other)
        guess = quotient(solver.pencil(mode.degree), solver.weights(1.0), mode.x, mode.y)
        misses.append(abs(guess - dispersion(other, 1.0).modes[0].rate))
    assert misses[0] / misses[1] == pytest.approx(100, rel=0.1)
