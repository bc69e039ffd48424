"""What is foreseen from a flow that is nearly the same saves work and decides nothing."""

import os
from dataclasses import fields, replace
from types import SimpleNamespace

import numpy as np
import pytest
from test_memory import alike, cold, remembered  # noqa: F401
from test_tracking import random_flows

from stability import dispersion, flows, k_max, parameter_map, spectrum
from stability.errors import ParameterError
from stability.modes import foresight, memory
from stability.modes.branch import rough_solver
from stability.modes.solver import Solver
from stability.modes.surface import surface_branch
from stability.numerics import refine as refinement
from stability.numerics.threads import one_thread

CHAINS = int(os.environ.get("STABILITY_FORESIGHT_CHAINS", 7))  # 750 for 3000 answers


def chain(flow, rng, steps=3, far=0.3):
    """Flows that differ in one parameter, each by a random factor from the one before."""
    names = [item.name for item in fields(flow) if isinstance(getattr(flow, item.name), float)
             and 0 < getattr(flow, item.name) < np.inf and item.name not in ("mu1", "mu2")]
    name, found = names[rng.integers(len(names))], [flow]
    for _ in range(steps):
        try:
            found.append(replace(found[-1], **{name: getattr(found[-1], name) * np.exp(rng.uniform(-far, far))}))
        except ParameterError:
            continue
    return found


def test_a_loop_over_a_parameter_gives_what_each_flow_gives_alone(remembered):  # noqa: F811
    """Modes, losses, collisions and encounters alike, far into the ranges where modes meet."""
    rng = np.random.default_rng(2)
    for flow, wavenumbers in random_flows(CHAINS, 21):
        memory.forget()
        flows_ = chain(flow, rng)
        warm = [dispersion(one, wavenumbers[:1], strict=False) for one in flows_]
        for one, relation in zip(flows_, warm, strict=True):
            assert alike(cold(one, wavenumbers[:1]), relation), (one, wavenumbers[0])


@pytest.mark.parametrize(("flow", "name", "values", "k"), [
    (flows.Vortex(), "Fr2", np.linspace(1.0, 4.0, 7), 8.0),  # real modes begin to collide on the way
    (flows.Dune(Re=0.3), "shields", np.linspace(9.0, 12.0, 4), 8.1),  # internal modes crowd around it
    (flows.TwoLayerCouette(depth_ratio=5.0, Re=1000.0), "viscosity_ratio", np.linspace(0.15, 0.5, 4), 5.0),
    (flows.RollWave(Fr2=0.27), "slope_deg", np.linspace(24.0, 32.0, 5), 6.0)], ids=lambda value: str(value)[:12])
def test_where_modes_meet_between_two_flows_the_branch_is_that_of_each_alone(flow, name, values, k, remembered):  # noqa: F811
    for order in (values, values[::-1]):
        memory.forget()
        loop = [replace(flow, **{name: float(value)}) for value in order]
        warm = [dispersion(one, k, strict=False) for one in loop]
        assert all(alike(cold(one, k), relation) for one, relation in zip(loop, warm, strict=True))


def lies(flow, k):
    """What another flow might have known: at each wavenumber a mode of this flow that is not on its branch."""
    branch = surface_branch(Solver(flow))
    branch.reach(k)
    found = {}
    for node in branch.known.values():
        others = spectrum(flow, node.k, 4, strict=False).modes
        other = min((mode for mode in others if abs(mode.rate - node.rate) > 1e-3 * abs(node.rate)),
                    key=lambda mode: abs(mode.rate - node.rate))
        found[node.k] = other
    return branch.at([k])[0][k], found


@pytest.mark.parametrize("flow", [flows.Film(Re=20.0), flows.RollWave(slope_deg=26.0)], ids=str)
def test_other_modes_that_are_foreseen_are_not_taken(flow):
    right, wrong = lies(flow, 2.0)
    mode = surface_branch(Solver(flow), wrong).at([2.0])[0][2.0]
    assert abs(mode.sigma - right.sigma) <= mode.error + right.error


def test_the_walk_takes_what_is_foreseen(remembered, monkeypatch):  # noqa: F811
    """Next to a flow that was followed no step is solved for, nor any look for the long-wave limit."""
    dispersion(flows.Dune(shields=2.0), 1.0)
    alone, count = cold(flows.Dune(shields=2.05), 1.0), []
    memory.forget()
    dispersion(flows.Dune(shields=2.0), 1.0)
    monkeypatch.setattr("stability.modes.solver.refine", lambda *given: count.append(1) or refinement.refine(*given))
    found = dispersion(flows.Dune(shields=2.05), 1.0)
    assert alike(alone, found)
    assert len(count) < 4


def test_what_is_far_or_of_another_kind_is_not_asked():
    bed = flows.Dune()
    assert memory._distance(bed, replace(bed, shields=2.2, Re=11.0)) == pytest.approx(2 * np.log(1.1))
    assert memory._distance(bed, replace(bed, depth=10.0)) == np.inf
    assert memory._distance(bed, replace(bed, fluid="layer")) == np.inf
    assert memory._distance(flows.Film(We=0.0), flows.Film(We=0.1)) == np.inf


@one_thread
def test_foresight_that_misses_is_no_harm():
    solver = Solver(flows.Dune())
    other = surface_branch(Solver(flows.TwoLayerCouette()))
    other.reach(1.0)
    assert 1.0 in other.known  # but two layers have more unknowns than one
    assert foresight.Foresight(solver.rough(1e-4), other.known).at(1.0, 1.0, np.inf) is None
    nothing = SimpleNamespace(k=1.0, degree=12, x=np.zeros(solver.pencil(12).size), y=np.zeros(solver.pencil(12).size))
    assert rough_solver(solver, {1.0: nothing}).foresight.at(1.0, 1.0, np.inf) is None


def test_a_loop_over_fastest_waves_gives_what_each_flow_gives_alone(remembered):  # noqa: F811
    loop = [flows.Dune(Re=Re, shields=3.0) for Re in np.geomspace(0.05, 5.0, 9)]  # a second maximum comes and leads
    warm = [k_max(flow) for flow in loop]
    for flow, found in zip(loop, warm, strict=True):
        memory.forget()
        alone = k_max(flow)
        assert len(alone.maxima) == len(found.maxima)
        for one, other in zip(alone.maxima, found.maxima, strict=True):
            assert abs(one.k - other.k) <= one.error + other.error
            assert abs(one.growth_rate - other.growth_rate) <= one.mode.error + other.mode.error


def test_a_map_does_not_depend_on_what_was_asked_before(remembered):  # noqa: F811
    """Byte for byte, whoever computes which piece after which."""
    over = {"shields": [1.5, 2.0], "Re": [9.0, 10.0, 11.0]}
    first = parameter_map(flows.Dune(), over)
    k_max(flows.Dune(shields=1.55, Re=9.5))
    assert memory._branches
    assert parameter_map(flows.Dune(), over).table == first.table
    assert len(memory._branches) == 1
