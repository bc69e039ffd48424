"""Following a mode: the same mode from either side, collisions met and named, jumps refused."""

from dataclasses import replace
from math import exp, log
from types import SimpleNamespace

import numpy as np
import pytest
import references

from stability import ModeLost, dispersion, flows, spectrum
from stability.modes import branch, crest, memory, tracking
from stability.modes.accuracy import Accuracy
from stability.modes.solver import Solver
from stability.modes.surface import surface_branch, surface_mode
from stability.modes.tracking import Walk


def followed(solver, start, wavenumbers):
    """The mode `start` at one wavenumber after the other."""
    walk = Walk(solver, start)
    return [walk.to(float(k)) for k in wavenumbers]


def test_forwards_and_backwards_meet():
    solver = Solver(flows.Dune(shields=3.0))
    k = np.geomspace(1e-3, 8, 40)
    forwards = followed(solver, surface_mode(solver, k[0]), k)
    backwards = followed(solver, forwards[-1], k[::-1])
    there = np.array([mode.sigma for mode in forwards])
    back = np.array([mode.sigma for mode in backwards])[::-1]
    bars = np.array([mode.error for mode in forwards])
    assert np.all(np.abs(there - back) <= 2 * bars)


def test_the_mode_does_not_depend_on_the_wavenumbers_on_the_way():
    far = dispersion(flows.Dune(shields=2.5, Re=300.0), 6.0)
    fine = dispersion(flows.Dune(shields=2.5, Re=300.0), np.geomspace(1e-3, 6.0, 300))
    assert abs(far.sigma[0] - fine.sigma[-1]) <= far.error[0] + fine.error[-1]


def test_the_surface_mode_obeys_its_limit_in_value_and_slope():
    """At k = 3.986 a damped mode lies by chance within 2 % of the long-wave law of this flow."""
    flow = flows.Vortex(slope_deg=15.494955741733616, Fr2=2.169558244519395)
    solver = Solver(flow)
    chance = solver.solve(3.986, flow.long_wave(3.986) / solver.width(3.986))
    assert abs(chance.sigma / flow.long_wave(3.986) - 1) < 0.03
    mode = surface_mode(solver, 3.986)
    assert mode.k < 0.3
    assert abs(dispersion(flow, 3.986).sigma[0]) < 0.2 * abs(chance.sigma)


def test_a_collision_of_real_modes_is_found_where_the_reference_has_it():
    """Below it the reference finds two real roots, above it a complex pair."""
    flow = flows.Vortex(Fr2=5.0)
    relation = dispersion(flow, [0.1, 1.0, 8.0])
    first, second = relation.collisions
    assert (first.becomes, second.becomes) == ("pair", "real")
    assert "become a complex pair" in str(first)
    for collision, step in ((first, 1e-6), (second, -1e-6)):
        paired = references.vortex(flow.slope_deg, flow.Fr2, collision.k * (1 + step),
                                   complex(collision.sigma, 1e-3 * abs(collision.sigma)), radius=0.5)
        real = references.vortex(flow.slope_deg, flow.Fr2, collision.k * (1 - step), 1.002 * collision.sigma,
                                 radius=0.5)
        assert abs(paired.imag) > 1e-5
        assert real.imag == 0
    assert relation.sigma[0].imag == 0 == relation.sigma[2].imag
    assert relation.phase_speed[1] > 0  # of the pair, the one that travels downstream


def test_between_its_collisions_the_pair_is_the_reference():
    flow = flows.Vortex(Fr2=50.0)
    relation = dispersion(flow, np.geomspace(0.12, 10, 5))
    for k, sigma, error in zip(relation.k, relation.sigma, relation.error, strict=True):
        assert abs(references.vortex(flow.slope_deg, flow.Fr2, k, sigma) - sigma) <= error


@pytest.mark.parametrize("seed", range(5))
def test_random_vortices_are_followed_through_their_collisions(seed):
    rng = np.random.default_rng(seed)
    for _ in range(10):
        flow = flows.Vortex(slope_deg=rng.uniform(5, 45), Fr2=float(np.exp(rng.uniform(0, np.log(50)))))
        assert not dispersion(flow, [30.0], strict=False).lost


def test_a_step_onto_another_mode_is_refused():
    """Started on one mode, told to expect another, the walk shortens its steps and stays on the first."""
    solver = Solver(flows.Dune())
    start = solver.solve(1.0, -4.615 + 0.954j)
    mode = Walk(solver, start).to(2.0)
    surface = dispersion(flows.Dune(), 2.0).sigma[0]
    assert abs(mode.sigma - surface) > 1
    back = Walk(solver, mode).to(1.0)
    assert abs(back.sigma - start.sigma) <= back.error + start.error


def test_without_a_long_wave_limit_the_surface_mode_is_lost(monkeypatch):
    monkeypatch.setattr(flows.Vortex, "long_wave", lambda self, k: 3.0 + 0 * k)
    with pytest.raises(ModeLost, match="no mode obeys the long-wave limit"):
        dispersion(flows.Vortex(), 1.0)


@pytest.mark.parametrize(("shields", "k"), [(12.0, 8.1366), (10.0, 8.1), (20.0, 8.0)])
def test_a_thick_ill_posed_bed_is_followed_without_jumps(shields, k):
    """Internal modes crowd around the surface mode there; loose step control lands on one of them."""
    flow = flows.Dune(shields=shields, Re=0.3)
    alone = dispersion(flow, [k])
    for grid in (np.geomspace(1e-3, k, 60), np.geomspace(1e-2, k, 7)):
        among = dispersion(flow, grid)
        assert abs(among.sigma[-1] - alone.sigma[0]) <= among.error[-1] + alone.error[0]


def test_without_the_check_of_slopes_it_would_jump(monkeypatch):
    flow = flows.Dune(shields=9.5, Re=0.3)
    right = dispersion(flow, 8.1).sigma[0]
    monkeypatch.setattr("stability.modes.tracking._BEND", 10.0)
    assert abs(dispersion(flow, 8.1).sigma[0] - right) > 100


class Paced(Walk):
    """A walk whose attempts all succeed with a given step in log k, at the largest degree."""

    def __init__(self, solver, pace):
        super().__init__(solver, SimpleNamespace(k=1.0, sigma=1.0, error=0.0, degree=512, truncation=0.0))
        self.pace, self.attempts = pace, 0

    def _advance(self, k):
        self.attempts += 1
        step = self.pace(self.attempts)
        self.now = SimpleNamespace(**{**vars(self.now), "k": min(k, self.now.k * exp(step))})


def test_a_walk_that_cannot_arrive_gives_up_early():
    flow = flows.Dune(shields=126.0, b=1e-7)
    slow = Paced(Solver(flow), lambda attempt: 0.005)
    with pytest.raises(ModeLost, match="1000 steps do not reach k = 1000"):
        slow.to(1e3)
    assert slow.attempts == 100
    stopped = Paced(Solver(flow), lambda attempt: 0.01 if attempt < 150 else 1e-9)
    with pytest.raises(ModeLost, match="do not reach"):
        stopped.to(1e3)
    assert stopped.attempts == 200
    steady = Paced(Solver(flow), lambda attempt: 0.007)
    assert steady.to(1e3).k == 1e3
    assert steady.attempts > 900


def test_a_walk_ends_where_the_largest_degree_does_not_suffice():
    walk = Paced(Solver(flows.Dune()), lambda attempt: 0.05)
    walk.now.truncation = 1e-6
    with pytest.raises(ModeLost, match="degree 512 does not resolve it any more"):
        walk.to(1e3)
    assert walk.attempts == 100
    rough = Paced(Solver(flows.Dune(), Accuracy(1e-5)), lambda attempt: 0.05)
    rough.now.truncation = 1e-6
    assert rough.to(1e3).k == 1e3


def test_a_walk_without_an_end_gives_up_where_it_hardly_moves():
    walk = Paced(Solver(flows.Dune()), lambda attempt: 0.05 if attempt <= 100 else 1e-4)
    with pytest.raises(ModeLost, match="100 steps took it from k = .* no further"):
        walk.beyond(1e3)
    assert walk.attempts == 200


def test_what_is_lost_beyond_takes_nothing_along(monkeypatch):
    """Wavenumbers below the one at which the walk ends keep their mode, those above get the reason."""
    flow = flows.Dune(Re=0.3)
    alone = dispersion(flow, 1.0)

    def advance(self, k, usual=Walk._advance):
        if self.now.k > 2:
            raise self._lost("it is too far")
        usual(self, k)

    monkeypatch.setattr(Walk, "_advance", advance)
    found = dispersion(flow, [1.0, 5.0], strict=False)
    assert abs(found.sigma[0] - alone.sigma[0]) <= found.error[0] + alone.error[0]
    assert list(found.lost) == [5.0]
    assert "it is too far" in found.lost[5.0]


TWO_LAYERS = [(0.2, 5.0, 1000.0, 5.0, -0.128570090578 - 4.778148706551j), (0.1, 2.0, 1000.0, 5.0, None),
              (0.5, 5.0, 1000.0, 2.0, None), (0.5, 5.0, 1000.0, 5.0, None), (0.2, 10.0, 1000.0, 2.0, None),
              (0.2, 10.0, 1000.0, 5.0, None)]


@pytest.mark.parametrize(("viscosity_ratio", "depth_ratio", "Re", "k", "sigma"), TWO_LAYERS)
def test_a_wavenumber_alone_has_the_mode_that_it_has_in_company(viscosity_ratio, depth_ratio, Re, k, sigma):
    """At these k another mode lies within 3 % of the long-wave law by chance; the value by 280 steps from k = 1e-5."""
    flow = flows.TwoLayerCouette(viscosity_ratio=viscosity_ratio, depth_ratio=depth_ratio, Re=Re)
    alone, among = dispersion(flow, k), dispersion(flow, [1e-5, 0.1, 0.5, 1.0, k])
    assert abs(alone.sigma[0] - among.sigma[-1]) <= alone.error[0] + among.error[-1]
    if sigma:
        assert alone.sigma[0] == pytest.approx(sigma, abs=1e-11)


def test_a_sweep_loses_nothing_that_is_found_alone():
    """An ill-posed roll wave that is followed in thousands of small steps."""
    flow = flows.RollWave(slope_deg=39.192999851735976, Fr2=0.2724877178938599, mu1=0.7146392435132589,
                          mu2=0.8238277485284187)
    alone, among = dispersion(flow, 2.498), dispersion(flow, [0.1, 2.498, 30.0], strict=False)
    assert abs(alone.sigma[0] - among.sigma[1]) <= alone.error[0] + among.error[1]
    assert any("two modes nearly meet" in note for note in alone.notes())


@pytest.mark.parametrize("flow", [flows.Dune(), flows.Vortex(Fr2=5.0), flows.Film(), flows.TwoLayerCouette()], ids=str)
def test_where_nothing_is_near_nothing_is_said(flow):
    """Collisions are told as such."""
    assert not any("nearly meet" in note for note in dispersion(flow, [0.1, 1.0, 8.0]).notes())


def random_flows(count, seed):
    """(flow, wavenumbers) over all scenes, far into the ranges where modes meet."""
    rng = np.random.default_rng(seed)

    def log(low, high):
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    makers = (lambda: flows.Vortex(slope_deg=rng.uniform(5, 45), Fr2=log(1e-2, 50)),
              lambda: flows.Dune(shields=rng.uniform(1.02, 5), mu1=rng.uniform(0.2, 0.7), Re=log(1e-2, 1e4),
                                 depth=rng.choice([np.inf, 2.0, 10.0])),
              lambda: flows.RollWave(slope_deg=rng.uniform(21.2, 32.4), Fr2=log(0.01, 50)),
              lambda: flows.Film(Re=log(0.1, 1e4), slope_deg=log(0.01, 100), We=rng.choice([0.0, 0.1])),
              lambda: flows.TwoLayerCouette(viscosity_ratio=log(0.05, 20), depth_ratio=log(0.1, 10), Re=log(1, 2e3),
                                            density_ratio=rng.uniform(1, 5), tension=rng.choice([0.0, 0.1])),
              lambda: flows.Poiseuille(Re=log(10, 2e4)), lambda: flows.Couette(Re=log(10, 2e3)))
    for index in range(count):
        yield makers[index % len(makers)](), np.exp(rng.uniform(np.log(0.01), np.log(8), 3))


@pytest.mark.parametrize("seed", range(4))
def test_a_mode_does_not_depend_on_how_it_is_asked_for(seed):
    """Each k alone, in sweeps of other spacings and reversed: the same mode, or the same refusal."""
    for flow, wavenumbers in random_flows(14, seed):
        sweeps = (wavenumbers, wavenumbers[::-1], np.concatenate((wavenumbers, np.geomspace(5e-3, 9.0, 12))),
                  np.concatenate((wavenumbers, np.linspace(0.02, 12.0, 40))))
        for k in wavenumbers.tolist():
            alone = dispersion(flow, k, strict=False)
            for sweep in sweeps:
                among = dispersion(flow, sweep, strict=False)
                assert (k in among.lost) == (k in alone.lost), (flow, k)
                for mode in (mode for mode in among.modes if mode.k == k):
                    assert abs(mode.sigma - alone.sigma[0]) <= mode.error + alone.error[0], (flow, k)


def test_the_surface_mode_starts_where_its_law_has_held_for_long():
    branch = surface_branch(Solver(flows.Film()))
    ratios = [abs(branch.at([k])[0][k].sigma / flows.Film().long_wave(k) - 1)
              for k in (branch.start.k, branch.start.k / 5)]
    assert ratios[1] < 0.8 * ratios[0] < 0.03


def test_what_lands_on_another_mode_is_refined_alone(monkeypatch):
    """In a batch nothing but the distance from the interpolation tells: here all land on the second mode."""
    flow, wavenumbers = flows.Film(Re=200.0), np.geomspace(0.98, 1.02, 9)
    right = dispersion(flow, wavenumbers).sigma
    others = {k: min(spectrum(flow, k, 3).modes, key=lambda mode: -abs(mode.sigma - one))
              for k, one in zip(wavenumbers.tolist(), right, strict=True)}
    memory.forget()
    taken = []

    def astray(solver, ks, *question):
        taken.extend(ks)
        return [others.get(k) for k in ks]

    monkeypatch.setattr(Solver, "solve_many", astray)
    assert dispersion(flow, wavenumbers).sigma == pytest.approx(right, rel=1e-12)
    assert set(taken) & set(others)
    memory.forget()


@pytest.mark.parametrize("flow", [flows.Chute(), flows.PlaneShear(), flows.Plate()], ids=str)
def test_steps_are_as_long_as_vectors_let_them(monkeypatch, flow):
    """Where vectors turn faster than rates bend, no step is tried in vain; by the rates alone many are."""
    tried, stride = [], Walk.stride

    def watched(walk, to, length):
        tried.append(stride(walk, to, length))
        return tried[-1]

    monkeypatch.setattr(Walk, "stride", watched)
    counts = []
    for turn in (tracking._TURN, 1e9):
        monkeypatch.setattr(tracking, "_TURN", turn)
        memory.forget()
        tried.clear()
        dispersion(flow, [0.05, 1.0], mode="leading", strict=False)
        counts.append((len(tried), tried.count(False)))
    memory.forget()
    (now, failed), (before, in_vain) = counts
    assert failed == 0 < in_vain
    assert now < before


CROWDED, CROSSING = (flows.Dune(shields=9.5, Re=0.3), 8.1), (flows.Vortex(slope_deg=23.2376, Fr2=0.9492), 3.11)
OTHERS = {check: tuple(other for other in Walk.checks if other != check) for check in Walk.checks}


@pytest.mark.parametrize(("question", "checks", "keeps"), [
    (CROWDED, (), False), (CROWDED, ("smooth",), True), (CROWDED, OTHERS["smooth"], False),
    (CROSSING, (), False), (CROSSING, ("overlaps",), True), (CROSSING, OTHERS["overlaps"], False)])
def test_each_check_of_a_step_keeps_the_mode_by_itself(monkeypatch, question, checks, keeps):
    """Where modes crowd slopes tell them apart, where two cross closely vectors do; all other checks do not."""
    flow, k = question
    right = dispersion(flow, k).sigma[0]
    memory.forget()
    monkeypatch.setattr(Walk, "checks", checks)
    found = dispersion(flow, k, strict=False).sigma
    memory.forget()
    assert (abs(found[0] - right) < 1e-8 * abs(right)) == keeps


@pytest.mark.parametrize(("error", "taken"), [(0.009, True), (0.011, False)])
def test_a_mode_that_is_not_resolved_is_not_followed(monkeypatch, error, taken):
    """With all other checks off."""
    solver = Solver(flows.Dune())
    walk = Walk(solver, solver.solve(1.0, dispersion(flows.Dune(), 1.0).modes[0].rate))
    solve = solver.solve
    monkeypatch.setattr(Walk, "checks", ("trusted",))

    def solved(*args):
        mode = solve(*args)
        return replace(mode, error=error * abs(mode.sigma))

    monkeypatch.setattr(solver, "solve", solved)
    assert walk.stride(1.1, log(1.1)) == taken


def test_a_real_mode_stays_real_where_no_collision_is_found(monkeypatch):
    """With all other checks off: just above the first collision a pair is next to the real mode below it."""
    flow = flows.Vortex(Fr2=5.0)
    relation = dispersion(flow, [0.1, 1.0])
    (collision, *_), (below, _) = relation.collisions, relation.modes
    solver = Solver(flow)
    real = Walk(solver, below).to(0.99 * collision.k)
    pair = solver.solve(1.01 * collision.k, complex(real.rate, 0.2 * abs(real.rate)), (real.degree, real.x, real.y))
    assert (real.rate.imag, abs(pair.rate.imag) > 1e-3 * abs(pair.rate)) == (0, True)
    walk = Walk(solver, real)
    monkeypatch.setattr(walk, "correct", lambda to, guess: pair)
    for checks, taken in (("same_kind",), False), ((), True):
        monkeypatch.setattr(Walk, "checks", checks)
        assert walk.stride(pair.k, log(pair.k / real.k)) == taken
    assert Walk(Solver(flows.Dune()), real).same_kind(pair, None)  # of complex matrices no mode is real


def impostor(k):
    """The surface mode of a film at k, and another mode there."""
    film = flows.Film(Re=200.0)
    right = dispersion(film, k).modes[0]
    return film, right, max(spectrum(film, k, 3).modes, key=lambda mode: abs(mode.sigma - right.sigma))


@pytest.mark.parametrize(("near", "overlap", "keeps"), [
    (True, True, True), (False, True, True), (True, False, True), (False, False, False)])
def test_a_wavenumber_alone_that_lands_on_another_mode_is_walked_to(monkeypatch, near, overlap, keeps):
    """Either check does, and without both the other mode is taken."""
    film, right, other = impostor(1.013)
    memory.forget()
    solved, first = branch.Branch._solved, [other]
    monkeypatch.setattr(branch.Branch, "_solved", lambda *question: first.pop() if first else solved(*question))
    if not near:
        monkeypatch.setattr(branch, "_near", lambda *_: True)
    if not overlap:
        monkeypatch.setattr(branch, "_ASTRAY", np.inf)
    (found,) = dispersion(film, right.k).modes
    memory.forget()
    assert not first
    assert (abs(found.sigma - right.sigma) < 1e-10) == keeps


@pytest.mark.parametrize(("overlap", "keeps"), [(0.3, True), (np.inf, False)])
def test_a_step_towards_a_crest_that_lands_on_another_mode_is_walked(monkeypatch, overlap, keeps):
    film, right, other = impostor(1.013)
    solver = Solver(film)
    solve, first = solver.solve, [other]
    monkeypatch.setattr(solver, "solve", lambda *question: first.pop() if first else solve(*question))
    monkeypatch.setattr(crest, "_OVERLAP", overlap)
    near = dispersion(film, 1.0).modes[0]
    found, _ = crest._moved(solver, near, right.k)
    assert not first
    assert (abs(found.sigma - right.sigma) < 1e-10) == keeps
