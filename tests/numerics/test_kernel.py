"""The compiled kernel: the same numbers as with numpy, judged by the same code; where it is kept and how it is made."""

import math
import os
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import numpy as np
import pytest

from stability import ModeLost, ParameterError, dispersion, flows
from stability.equations import pencil as pencils
from stability.modes.dense import finite_rates
from stability.modes.solver import Solver
from stability.numerics import refine as refinement
from stability.numerics.arithmetic import Arithmetic
from stability.numerics.bordered import Bordered, Factors, ManyFactors, Places
from stability.numerics.kernel import build, library, place
from stability.numerics.kernel.compiled import Compiled, Packed
from stability.numerics.refine import refine, refine_many
from stability.numerics.stack import Lines, Stack

EVERY = int(os.environ.get("STABILITY_BRUTE_FORCE", 0))
UNEVEN = flows.Dune(shields=9.14387521184334, mu1=992.7514530779238, b=2.846689817185222, Re=236117451046.43802,
                    depth=3.5815408193692813e-06, fluid="layer"), 8.714937674024775e-06


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """With a kernel in it, made by whatever compiler there is."""
    folder = tmp_path_factory.mktemp("kernel")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(place.SWITCH, str(folder))
        try:
            build.build_kernel()
        except build.NoKernel as failure:
            if str(failure).startswith("no compiler"):
                pytest.skip(str(failure))
            raise
    return folder


@pytest.fixture(scope="module")
def kernel(folder):
    return library.loaded(folder / place.kernel_name())


@pytest.fixture
def with_kernel(kernel, monkeypatch):
    """A function that has the kernel used from now on, or not."""
    return lambda used=True: monkeypatch.setattr(pencils, "library", lambda: kernel if used else None)


SIZES = [(30, 4, 3, 2), (1, 1, 0, 0), (9, 5, 14, 10), (40, 9, 1, 7), (65, 4, 26, 22), (37, 2, 0, 5), (33, 3, 6, 0)]


def pencil_of(full, interior, tail=None):
    """The pencil of A and the parts of -B, full matrices (parts, size, size), with rows beyond (parts, rows, size)."""
    def entries(matrices, first=0):
        part, *place = np.nonzero(matrices[first:])
        return (part + first, *place), matrices[first:][(part, *place)]

    def stack(matrices, first=0, sign=1):
        places, values = entries(matrices, first)
        return Stack(Lines(*places, len(matrices), matrices.shape[1:]), sign * values)

    parts, size, _ = full.shape
    places, values = entries(full)
    where = Places(*places, parts, interior, size - interior)
    bordered, rows = Bordered(where, values), stack(full)

    def factors(weights, rate):
        powers = np.array([np.ones_like(rate), *(parts - 1) * [rate]])
        return (ManyFactors if np.ndim(rate) else Factors)(bordered, weights * powers)

    pencil = SimpleNamespace(parts=range(parts), real=np.isrealobj(full), stack=rows, factors=factors,
                             b_products=stack(full, 1, -1).summed, packed=Packed(rows, where, parts, 1))
    if tail is not None:
        pencil.tail = stack(tail)
        pencil.packed_tail = Packed(pencil.tail, where, parts, 1)
    return pencil


def random_pencil(interior, border, lower, upper, seed, turned):
    """Three random matrices with a full border and a tail of six rows, in full and as a pencil."""
    rng, parts, size = np.random.default_rng(seed), 3, interior + border
    shift = np.arange(size)[:, None] - np.arange(size)
    places = (shift <= lower) & (shift >= -upper)
    places[interior:] = places[:, interior:] = True
    full = vectors(rng, (parts, size, size), turned)
    full *= places & (rng.random(places.shape) < 0.7) | np.eye(size, dtype=bool)
    full[0] += (lower + upper + border) * np.eye(size)
    tail = vectors(rng, (parts, 6, size), turned)
    return full, tail, pencil_of(full, interior, tail)


def vectors(rng, shape, turned):
    return rng.standard_normal(shape) + 1j * rng.standard_normal(shape) if turned else rng.standard_normal(shape)


@pytest.mark.parametrize("turned", [False, True], ids=["real", "complex"])
@pytest.mark.parametrize("points", [None, 3])
@pytest.mark.parametrize("sizes", SIZES, ids=str)
@pytest.mark.parametrize("carrier", [Arithmetic, Compiled])
def test_iterations_and_products_are_those_of_full_matrices(kernel, carrier, sizes, points, turned):
    full, tail, pencil = random_pencil(*sizes, 5, turned)
    rng, size, shape = np.random.default_rng(6), sum(sizes[:2]), () if points is None else (points,)
    weights, rate = vectors(rng, (3, *shape), turned), 0.1 * vectors(rng, shape, turned)
    weights[0] = 1 + 0.1 * weights[0]
    x, y, dx, dy = (vectors(rng, (size, *shape), turned) for _ in range(4))
    numbers = carrier(pencil, kernel) if carrier is Compiled else carrier(pencil)
    iterated = numbers.iterate(weights, rate, x, y, 0.0)
    assert not np.any(iterated.uneven)
    for index in np.ndindex(shape):
        point = (..., *index)
        a, *b = (weight * part for weight, part in zip(weights[point], full, strict=True))
        b = -sum(b)
        a = a - rate[index] * b
        for side, (start, step) in enumerate(((x, np.linalg.solve(a, b)), (y, np.linalg.solve(a.T, b.T)))):
            pivot = np.argmin(np.abs(iterated.vectors[side][point] - 1))  # the component that all is scaled by
            start, first, second = (vector / vector[pivot] for vector in (
                start[point], step @ start[point], step @ step @ start[point]))
            near = {"rtol": 1e-8, "atol": 1e-8 * np.abs(second).max()}
            np.testing.assert_allclose(iterated.vectors[side][point], second, **near)
            np.testing.assert_allclose(iterated.steps[side][point], second - first, **near)
            sizes = [np.linalg.norm(vector) for vector in (first - start, second - first, second)]
            np.testing.assert_allclose(iterated.sizes[(slice(None), side, *index)], sizes, rtol=1e-7)
    brackets, squares = numbers.changes(x, y, dx, dy)
    for found, pair in zip(brackets, ((y, x), (y, dx), (dy, x)), strict=True):
        np.testing.assert_allclose(found, np.einsum("r...,prc,c...->p...", pair[0], full, pair[1]), rtol=1e-10)
    np.testing.assert_allclose(numbers.brackets(x, y), brackets[0], rtol=1e-13)
    sums = np.einsum("r...,prc,c...->p...", *(np.abs(one) ** 2 for one in (y, full, x)))
    np.testing.assert_allclose(squares, sums, rtol=1e-12)
    beyond = np.einsum("p...,prc,c...->r...", weights, tail, x)
    np.testing.assert_allclose(numbers.beyond(weights, x), beyond, rtol=1e-10, atol=1e-12)


def questions(count, seed):
    """Random (flow, k, degree): real and complex pencils, one layer and two, closed forms and series that are cut."""
    rng = np.random.default_rng(seed)

    def log(low, high):
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    makers = [lambda: flows.Vortex(slope_deg=rng.uniform(5, 45), Fr2=log(1e-3, 50)),
              lambda: flows.Dune(shields=rng.uniform(1.05, 4), mu1=rng.uniform(0.2, 0.7), Re=log(0.05, 3e3)),
              lambda: flows.Dune(shields=rng.uniform(1.05, 1.4), Re=log(0.05, 3e3), depth=rng.uniform(2, 20),
                                 law=flows.Saturating(mu1=0.4, mu2=rng.uniform(0.6, 0.8), I0=0.3)),
              lambda: flows.RollWave(slope_deg=rng.uniform(22, 30), Fr2=log(0.1, 50)),
              lambda: flows.Film(Re=log(0.1, 1e3), slope_deg=rng.uniform(5, 80), We=log(0.01, 10)),
              lambda: flows.Poiseuille(Re=log(1, 1e5)), lambda: flows.Couette(Re=log(1, 1e4)),
              lambda: flows.TwoLayerCouette(viscosity_ratio=log(0.1, 10), depth_ratio=log(0.2, 5), Re=log(0.1, 1e3)),
              lambda: flows.Shear("bickley", Re=log(1, 100), z_low=-6.0, z_high=6.0)]
    for index in range(count):
        yield makers[index % len(makers)](), log(1e-2, 10), int(rng.choice([12, 16, 20, 28, 40, 64]))


def starts(count, seed):
    """Pencils and weights with a rate near one of their eigenvalues: (flow, pencil, weights, rate)."""
    rng = np.random.default_rng(seed)
    for flow, k, degree in questions(count, seed):
        solver = Solver(flow)
        pencil, rates = solver.pencil(degree), finite_rates(solver, degree, solver.symbols(k))
        rate = rates[rng.integers(4)]
        real = pencil.real and abs(rate.imag) < 1e-10 * abs(rate)
        yield flow, pencil, solver.weights(k), (rate.real if real else rate) * (1 + 10.0 ** rng.uniform(-9, -2))


def answer(pencil, weights, rate, *more):
    try:
        return refine(pencil, weights, rate, *more)
    except ModeLost:
        return None


def differing(one, other):
    """In what two answers to one question differ: rates by more than rounding, all else by what matters."""
    if one is None or other is None:
        return [] if one is other else ["lost"]
    bars = 4 * (one.rounding + other.rounding) + 1e-15 * np.abs(one.rate)
    slope = 1e-8 * (np.abs(one.rate) + np.abs(one.slope))
    allowed = {"rate": bars, "slope": slope, "scatter": 0.1 * one.scatter + slope, "rounding": 1e-6 * one.rounding,
               "truncation": 1e-6 * one.truncation + bars, "spread": 1e-6 * one.spread + bars, "settled": 0, "x": 1e-6,
               "y": 1e-6}  # vectors of modes whose rates nearly agree turn with rounding

    def least(name):
        a, b = (np.asarray(getattr(answer, name)) for answer in (one, other))
        if name in "xy":
            a, b = (v / np.take_along_axis(v, np.abs(a).argmax(axis=-1)[..., None], -1) for v in (a, b))
        return np.abs(a.astype(complex) - b)

    return [name for name, most in allowed.items() if not np.all(least(name) <= most)]


def test_both_give_the_same_numbers(with_kernel):
    different = []
    for flow, *question in starts(EVERY or 36, 3):
        with_kernel(False)
        expected = answer(*question)
        with_kernel()
        assert type(question[0].arithmetic) is Compiled
        if found := differing(expected, answer(*question)):
            different.append((flow, question[-1], found))
    assert not different


def test_they_do_not_where_an_entry_is_wrong_by_a_hundredth(with_kernel):
    noticed = []
    for _, pencil, weights, rate in starts(9, 4):
        with_kernel(False)
        expected = answer(pencil, weights, rate)
        with_kernel()
        pencil.packed.values["re"][np.argmax(np.abs(pencil.packed.values["re"]))] *= 1.01
        noticed.append(differing(expected, answer(pencil, weights, rate)))
    assert all(noticed)


def test_many_points_are_each_of_them(with_kernel):
    with_kernel()
    for flow in (flows.Vortex(), flows.Dune(), flows.Poiseuille()):
        (mode,) = dispersion(flow, 1.0, "leading" if isinstance(flow, flows.Poiseuille) else "surface").modes
        solver, ks = Solver(mode.flow), list(np.linspace(1.001, 1.02, 7))
        pencil = solver.pencil(mode.degree)
        x, y = (np.tile(vector, (7, 1)) for vector in (mode.x, mode.y))
        many = refine_many(pencil, solver.weights(ks), None, x, y)
        with_kernel(False)
        assert many.settled.all()
        assert not differing(many, refine_many(pencil, solver.weights(ks), None, x, y))
        with_kernel()
        for k, one in zip(ks, many.split(), strict=True):
            alone = refine(pencil, solver.weights(k), one.rate, one.x, one.y)
            assert abs(alone.rate - one.rate) <= 4 * (alone.rounding + one.rounding)
            assert abs(alone.slope - one.slope) <= one.left + one.scatter + 1e-12 * abs(one.slope)


def test_uneven_matrices_are_left_to_numpy(with_kernel):
    flow, k = UNEVEN
    (mode,) = dispersion(flow, k, mode="most-unstable", strict=False).modes
    solver, found = Solver(flow), []
    for used in (False, True):
        with_kernel(used)
        found.append(answer(solver.pencil(mode.degree), solver.weights(k), mode.rate, mode.x, mode.y))
        many = refine_many(solver.pencil(mode.degree), solver.weights([k]), None, mode.x[None], mode.y[None])
        assert not many.settled[0]
    one, other = found
    assert abs(one.rate - other.rate) <= 4 * (one.rounding + other.rounding) + one.spread + other.spread
    assert min(one.spread, other.spread) > 0.1 * max(one.spread, other.spread)  # of two ways: numpy's again


@pytest.mark.parametrize("used", [False, True])
@pytest.mark.parametrize("kind", [float, complex])
def test_what_does_not_settle_is_lost(with_kernel, monkeypatch, used, kind):
    with_kernel(used)
    solver = Solver(flows.Vortex())
    pencil, weights = solver.pencil(16), solver.weights(2.0)
    rate = kind(dispersion(solver.flow, 2.0).modes[0].rate.real)
    for start, reason in ((np.nan, "did not settle"), (1e200, "did not settle"), (np.inf, "singular")):
        with np.errstate(all="ignore"), pytest.raises(ModeLost, match=reason):
            refine(pencil, weights, kind(start))
    assert refine(pencil, weights, 1.1 * rate).rate == pytest.approx(rate, rel=1e-12)
    monkeypatch.setattr(refinement, "_FACTORISATIONS", 1)
    with pytest.raises(ModeLost, match="did not settle"):
        refine(pencil, weights, 1.1 * rate)


@pytest.mark.parametrize("part", ["interior", "border"])
def test_a_singular_factor_is_left_to_numpy_and_spoils_no_other(kernel, part):
    value = np.ones((2, 8))
    value[1, 0 if part == "interior" else -1] = -1.0  # A - rate B is singular at 1 there
    pencil = pencil_of(np.array([np.diag(row) for row in value]), 6)
    x, y = np.random.default_rng(3).standard_normal((2, 8))
    one, other = (numbers.iterate(np.ones(2), 1.0, x, y, 0.0)
                  for numbers in (Compiled(pencil, kernel), Arithmetic(pencil)))
    np.testing.assert_array_equal(one.vectors, other.vectors)
    both = (np.tile(vector[:, None], 2) for vector in (x, y))
    many = Compiled(pencil, kernel).iterate(np.ones((2, 2)), np.array([1.0, 0.5]), *both, 0.0)
    assert np.isnan(many.sizes[..., 0]).all()
    assert np.isfinite(many.sizes[..., 1]).all()
    np.testing.assert_array_equal(many.vectors[0][:, 0], x)
    with pytest.raises(ModeLost, match="singular"):
        Compiled(pencil, kernel).iterate(np.zeros(2), 1.0, x, y, 0.0)


@pytest.mark.parametrize("carrier", [Arithmetic, Compiled])
@pytest.mark.parametrize("points", [[0], [1], [2], [0, 1, 2], [1, 1, 1]], ids=str)
@pytest.mark.parametrize("exact", [[], [0], [1]], ids=str)
def test_a_factorisation_serves_four_iterations_where_those_will_do(kernel, carrier, points, exact):
    """The error of either side, unless it is `exact`, shrinks by the distance of the rate to the eigenvalue 1 over that
    to the next one, 2."""
    pencil = pencil_of(np.array([np.diag(np.arange(1.0, 9.0)), -np.eye(8)]), 6)
    rates, taken = 1 - np.array([1e-5, 3e-2, 0.9])[points], np.array([2, 4, 2])[points]  # settled, nearly, far from it
    start = np.random.default_rng(3).uniform(0.1, 0.2, (2, 8, len(points)))
    start[:, 0], start[exact, 1:] = 1.0, 0.0
    numbers = carrier(*([pencil, kernel] if carrier is Compiled else [pencil]))
    alone = len(points) == 1
    x, y = start[..., 0] if alone else start
    found = numbers.iterate(np.ones(2 if alone else (2, len(points))), rates[0] if alone else rates, x, y, 1e-6)
    vectors, steps = (np.reshape(part, start.shape) for part in (found.vectors, found.steps))
    sizes = np.reshape(found.sizes, (3, 2, len(points)))
    shrinks = (1 - rates) / (np.arange(1.0, 9.0)[:, None] - rates)
    last, before, first = (start * shrinks**power for power in (taken, taken - 1, taken - 2))
    np.testing.assert_allclose(vectors, last, rtol=1e-12)
    np.testing.assert_allclose(steps, last - before, rtol=1e-9, atol=1e-14)
    lengths = [np.linalg.norm(step, axis=1) for step in (before - first, last - before, last)]
    np.testing.assert_allclose(sizes, lengths, rtol=1e-9, atol=1e-14)


@pytest.mark.parametrize("carrier", [Arithmetic, Compiled])
def test_rows_with_small_pivots_are_exchanged(kernel, carrier):
    """Else all digits were lost."""
    block = np.array([[1e-17, 1.0], [1.0, 2.0]])
    full = np.zeros((2, 4, 4))
    full[0, :2, :2] = full[0, 2:, 2:] = block
    full[1] = -np.eye(4)
    pencil = pencil_of(full, 2)
    x, y = np.random.default_rng(4).standard_normal((2, 4))
    found = carrier(*([pencil, kernel] if carrier is Compiled else [pencil])).iterate(np.ones(2), 0.0, x, y, 0.0)
    for vector, start in zip(found.vectors, (x, y), strict=True):  # the block is symmetric
        exact = np.linalg.solve(full[0], np.linalg.solve(full[0], start))
        np.testing.assert_allclose(vector, exact / exact[np.argmin(abs(vector - 1))], rtol=1e-13)


def test_sums_of_many_lines_are_rounded_like_short_ones(kernel):
    """Of 50000 products of one part: added one after the other, they lose five times as much to rounding."""
    count, errors = 50_000, []
    line, one = np.arange(count), np.ones(count)
    where = SimpleNamespace(interior=count, border=0, lower=0, upper=0)
    for value in np.random.default_rng(4).uniform(0.5, 1.0, (10, count)):
        stack = Stack(Lines(np.zeros(count, int), line, line, 1, (count, count)), value)
        pencil = SimpleNamespace(parts=range(1), real=True, packed=Packed(stack, where, 1, 1))
        exact = math.fsum(value)
        errors.append([abs(Compiled(pencil, kernel).brackets(one, one)[0] - exact), abs(np.cumsum(value)[-1] - exact)])
    ours, in_turn = np.sqrt(np.mean(np.square(errors), axis=0))
    assert ours < 0.3 * in_turn


def test_threads_do_not_meet(with_kernel):
    with_kernel()
    questions_of_all = [question[1:] for question in starts(8, 7)]
    alone = [answer(*question) for question in questions_of_all]
    with ThreadPoolExecutor(4) as pool:
        for _ in range(5):
            for one, other in zip(alone, pool.map(lambda question: answer(*question), questions_of_all), strict=True):
                np.testing.assert_array_equal(one.x, other.x)
                assert one.rate == other.rate


@pytest.fixture
def elsewhere(tmp_path, monkeypatch):
    """An empty folder for the kernel, and nothing loaded yet."""
    monkeypatch.setenv(place.SWITCH, str(tmp_path))
    library.library.cache_clear()
    yield tmp_path
    library.library.cache_clear()


def test_it_is_used_where_it_is_found(elsewhere, folder):
    shutil.copy(folder / place.kernel_name(), elsewhere)
    assert library.library() is library.library()
    assert type(Solver(flows.Vortex()).pencil(12).arithmetic) is Compiled


def test_it_is_not_where_it_is_switched_off(elsewhere, folder, monkeypatch):
    shutil.copy(folder / place.kernel_name(), elsewhere)
    monkeypatch.setenv(place.SWITCH, place.OFF)
    assert library.library() is None
    assert type(Solver(flows.Vortex()).pencil(12).arithmetic) is Arithmetic


def test_a_file_that_cannot_be_loaded_is_as_none(elsewhere):
    (elsewhere / place.kernel_name()).write_bytes(b"no library")
    assert library.library() is None


def test_the_switch_says_what_it_can_be(elsewhere, monkeypatch):
    monkeypatch.setenv(place.SWITCH, "no")
    with pytest.raises(ParameterError, match="STABILITY_KERNEL must be off or an absolute path.*got 'no'"):
        library.library()


def test_without_the_extra_nothing_is_made(elsewhere, monkeypatch):
    monkeypatch.setattr(library, "compiler_installed", lambda: False)
    assert library.library() is None
    assert not list(elsewhere.iterdir())


@pytest.fixture
def begun(elsewhere, monkeypatch):
    """The commands that were started to make the kernel, none of which runs; the extra is there."""
    commands = []
    monkeypatch.setattr(library, "compiler_installed", lambda: True)
    monkeypatch.setattr(build, "Popen", lambda command, **_: commands.append(command) or SimpleNamespace())
    return commands


def wanted_again():
    library.library.cache_clear()
    assert library.library() is None


def test_one_process_makes_it_for_all(begun, elsewhere):
    for _ in range(3):
        wanted_again()
    assert begun == [[sys.executable, "-P", "-m", "stability.numerics.kernel", "--meanwhile"]]
    (mark,) = elsewhere.iterdir()
    os.utime(mark, (0, 0))  # who wanted it long ago has not come to an end
    wanted_again()
    assert len(begun) == 2


def test_what_has_failed_is_not_tried_again(begun, elsewhere, monkeypatch, capsys):
    wanted_again()
    monkeypatch.setattr(build, "compiler_installed", lambda: False)
    monkeypatch.setenv("CC", "false")
    monkeypatch.setattr(build.os, "nice", lambda by: None)
    build.built_meanwhile()
    (mark,) = elsewhere.iterdir()
    assert "false" in mark.read_text()
    assert "failed: no output" in mark.read_text()
    os.utime(mark, (0, 0))
    wanted_again()
    assert len(begun) == 1
    assert capsys.readouterr() == ("", "")


def test_a_process_begun_meanwhile_makes_it(elsewhere, folder, monkeypatch, tmp_path_factory):
    """Whatever lies in the folder from which the question was asked."""
    here = tmp_path_factory.mktemp("here")
    (here / "stability").mkdir()
    (here / "stability" / "__init__.py").write_text("raise SystemExit(1)")
    monkeypatch.chdir(here)
    monkeypatch.setattr(library, "compiler_installed", lambda: True)
    assert library.library() is None
    assert list(elsewhere.glob("*.wanted"))
    for _ in range(600):
        if list(elsewhere.iterdir()) == [elsewhere / place.kernel_name()]:
            break
        time.sleep(0.1)
    else:
        pytest.fail("it was not made in a minute")
    assert library.library() is None  # not in this process any more
    library.library.cache_clear()
    assert library.library() is not None


def command(**environment):
    return subprocess.run([sys.executable, "-m", "stability.numerics.kernel"], capture_output=True, text=True,
                          env=os.environ | environment)


def test_a_command_makes_it_now(elsewhere, folder):
    for _ in range(2):  # one that is there is made anew
        done = command()
        assert (done.returncode, done.stdout, done.stderr) == (0, f"{elsewhere / place.kernel_name()}\n", "")
    assert [path.name for path in elsewhere.iterdir()] == [place.kernel_name()]


def test_a_command_that_cannot_says_why(elsewhere, monkeypatch):
    full = elsewhere / "file"
    full.write_text("")
    done = command(STABILITY_KERNEL=str(full))
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"kernel: none of its folders can be written ({full}): {place.SWITCH}=FOLDER names another\n"


@pytest.mark.skipif(place.compiler_installed(), reason="the extra `fast` is installed: CC is of no use")
def test_without_a_compiler_the_command_says_which_would_do(elsewhere):
    done = command(CC="no-such-compiler")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "pip install 'granular-stability[fast]'" in done.stderr
    assert not list(elsewhere.iterdir())


def test_another_source_is_another_file(monkeypatch, tmp_path):
    names = {place.kernel_name()}
    copies = tuple(tmp_path / path.name for path in place.SOURCES)
    for source, copy in zip(place.SOURCES, copies, strict=True):
        shutil.copy(source, copy)
    monkeypatch.setattr(place, "SOURCES", copies)
    for copy in (None, *copies):
        if copy:
            copy.write_text(copy.read_text() + "\n")
        place.kernel_name.cache_clear()
        names.add(place.kernel_name())
    place.kernel_name.cache_clear()
    assert len(names) == 1 + len(copies)
