"""The wavy wall's response against multi-precision references, print, limits and identities."""

from functools import lru_cache

import mpmath as mp
import numpy as np
import pytest
from mpmath.calculus.quadrature import GaussLegendre

from stability.flows import wavy_wall
from stability.flows.wavy_wall import boundary_layer, response, shallow, short_wave

BOX = (-6, 3), (-4, 6), (-1, 4)  # log10 of k, Re, depth

# T = -R from the exact Airy integrals: k, Re, depth, T
PRINTED = [
    (0.01, 1, np.inf, "0.2071675407392294604801", "0.1146310767157079453923"),
    (1, 100, np.inf, "5.190678379511007508127", "2.423213487768535743844"),
    (10, 1, np.inf, "20.00043726374801432638", "0.04999157099198811850727"),
    (1, 10, 1, "4.294126620559937806775", "0.3381733070145952776819"),
    (0.1, 100, 5, "2.181002839902109282769", "1.135878208670128566388"),
]


def airy_size(k, Re, depth):
    return float((k * Re) ** (1 / 3) * depth)


def power_series(k, Re, depth):
    """R from the Taylor series about the bed of three solutions Psi = z, Psi'' = 1 and Psi''' = 1 there."""
    with mp.workdps(int(40 + 0.65 * airy_size(k, Re, depth) ** 1.5 + k * depth)):
        k, Re, depth = mp.mpf(k), mp.mpf(Re), mp.mpf(depth)
        K, F = (k * depth) ** 2, mp.mpc(0, k * Re * depth**3)
        ends = []
        for start in ((1, 0, 0), (0, 1, 0), (0, 0, 1)):
            psi, omega = [mp.mpc(0), mp.mpc(start[0])], [mp.mpc(start[1]), mp.mpc(start[2])]
            while len(psi) < 12 or max(abs(c) for c in psi[-4:]) > mp.eps / len(psi) ** 2:
                n = len(psi)
                before = omega[n - 3] if n > 2 else 0
                psi.append((K * psi[n - 2] + omega[n - 2]) / (n * (n - 1)))
                omega.append((K * omega[n - 2] + F * before) / (n * (n - 1)))
            ends.append((sum(psi), sum(n * c for n, c in enumerate(psi))))
        (a, da), (b, db), (c, dc) = ends
        return (da * c - a * dc) / (b * dc - db * c) / depth


@lru_cache
def gauss(digits):
    return GaussLegendre(mp.mp).calc_nodes(4, mp.mp.prec + 10)


def integrals(functions, start, stop):
    """Integrals of the list `functions(z)`, by two panels of 24 Gauss points."""
    half = (stop - start) / 4
    total = 0
    for middle in (start + half, stop - half):
        for x, weight in gauss(mp.mp.dps):
            total += half * weight * mp.matrix(functions(middle + half * x))
    return total


def airy_integrals(k, Re, depth):
    """R from integrals over z of Ai(x) and Ai(exp(2 i pi/3) x), each until it has fallen by 1e-17 or more."""
    digits = 24 + int(mp.log10(1 + k**2 / Re))
    with mp.workdps(digits):
        k, Re = mp.mpf(k), mp.mpf(Re)
        f = mp.cbrt(k * Re) * mp.expjpi(mp.mpf(1) / 6)
        turn = mp.expjpi(mp.mpf(2) / 3)
        bed = mp.airyai((k / f) ** 2)

        def at_bed(z):
            A = mp.airyai((k / f) ** 2 + f * z) / bed
            return [A * mp.exp(-k * z), 0 if depth is None else A * mp.sinh(k * z) / k]

        if depth is None:
            E, _ = integrals(at_bed, mp.mpf(0), 1 / (k / 30 + abs(f) / 22))
            return -1 / E
        depth = mp.mpf(depth)
        lid = mp.airyai(turn * ((k / f) ** 2 + f * depth))

        def at_lid(z):
            B = mp.airyai(turn * ((k / f) ** 2 + f * z)) / lid
            return [B * mp.exp(-k * z), B * mp.sinh(k * z) / k]

        E, S = integrals(at_bed, mp.mpf(0), min(depth, 20 / abs(f)))
        E_lid, S_lid = integrals(at_lid, depth - min(depth, 85 / abs(f) / mp.sqrt(abs(f) * depth)), depth)
        bed_of_lid = mp.airyai(turn * (k / f) ** 2) / lid
        return -(S_lid - bed_of_lid * S) / (E * S_lid - E_lid * S)


def reference(k, Re, depth=np.inf):
    """R to 17 digits or more, to which a lid beyond k depth = 60 is not felt."""
    if k * depth > 60:
        return airy_integrals(k, Re, None)
    return (power_series if airy_size(k, Re, depth) < 26 else airy_integrals)(k, Re, depth)


def distance(value, exact):
    return float(abs(mp.mpc(complex(value)) - exact))


def sample(seed, count, lid):
    """Points (k, Re, depth), log-uniform in the box; a lid, if any, is at most 60/k away, so that it matters."""
    draw = np.random.default_rng(seed)
    points = []
    while len(points) < count:
        k, Re, depth = (float(10 ** draw.uniform(*side)) for side in BOX)
        if not lid:
            points.append((k, Re, np.inf))
        elif k * depth < 60:
            points.append((k, Re, depth))
    return points


def corners():
    depths = [10.0**d for d in BOX[2]] + [np.inf]
    return [(10.0**k, 10.0**Re, depth) for k in BOX[0] for Re in BOX[1] for depth in depths]


def edges():
    """Points on either side of every change of method."""
    felt, part = wavy_wall.LID_FELT, wavy_wall.LAYERS_PART
    points = [(k, (side * part) ** 3 / k, 1.0) for k in (0.01, 1.0, 10.0, 0.99 * felt) for side in (0.999, 1.001)]
    return points + [(side * felt, Re, 1.0) for Re in (1e-3, 30.0, 1e6) for side in (0.999, 1.001)]


@pytest.fixture(scope="module")
def checked():
    """Every sampled point with its response and its true error."""
    points = corners() + edges() + sample(1, 60, lid=False) + sample(2, 160, lid=True)
    answers = [response(*point) for point in points]
    exact = [reference(*point) for point in points]
    return [(a, distance(a.value, r), float(abs(r))) for a, r in zip(answers, exact, strict=True)]


def test_accuracy_over_the_box(checked):
    worst = max(checked, key=lambda c: c[1] / c[2])
    assert worst[1] < 3e-13 * worst[2], worst[0]


def test_error_bar_holds_and_is_tight(checked):
    held = [true <= answer.error for answer, true, _ in checked]
    excess = [answer.error / max(true, 1e-16 * size) for answer, true, size in checked]
    assert np.mean(held) >= 0.995
    assert np.median(excess) < 30
    assert np.max([answer.error / size for answer, _, size in checked]) < 2e-12


def as_printed(k, Re, depth, real, imaginary):
    exact = -mp.mpc(real, imaginary)
    return distance(response(k, Re, depth).value, exact) < 1e-14 * abs(exact)


@pytest.mark.parametrize("row", PRINTED)
def test_printed_values(row):
    assert as_printed(*row)


@pytest.mark.parametrize(("k", "Re", "depth", "real", "imaginary"), PRINTED)
def test_one_percent_in_Re_is_caught(k, Re, depth, real, imaginary):
    assert not as_printed(k, 1.01 * Re, depth, real, imaginary)


def stencil(function, x):
    """x times the derivative of `function` at x, to about 1e-10 of the function."""
    x, step = mp.mpf(x), mp.mpf(10) ** -2.5
    at = [function(x * (1 + j * step)) for j in (-2, -1, 1, 2)]
    return (8 * (at[2] - at[1]) - at[3] + at[0]) / (12 * step)


def log_derivatives(k, Re, depth):
    yield stencil(lambda x: reference(x, Re, depth), k)
    yield stencil(lambda x: reference(k, x, depth), Re)
    yield stencil(lambda x: reference(k, Re, x), depth) if depth < np.inf else 0


@pytest.mark.parametrize(
    ("k", "Re", "depth"),
    [(1.0, 10.0, np.inf), (30.0, 0.1, np.inf), (0.1, 1e5, np.inf)]  # layer at the bed
    + [(0.1, 1e5, 2.0), (1.0, 8e3, 1.5), (12.0, 2e4, 1.0)]  # two layers
    + [(0.01, 3.0, 5.0), (1.0, 500.0, 1.5), (15.0, 10.0, 1.0), (3.0, 4e2, 1.0)],  # gap
)
def test_derivatives(k, Re, depth):
    r = response(k, Re, depth)
    ours = k * r.derivative, Re * r.d_Re, depth * r.d_depth if depth < np.inf else r.d_depth
    for mine, exact in zip(ours, log_derivatives(k, Re, depth), strict=True):
        assert distance(mine, exact) < 1e-8 * abs(r.value)


@pytest.mark.parametrize("lid", [False, True])
def test_derivatives_obey_the_scaling_of_lengths(lid):
    for k, Re, depth in sample(3, 300, lid):
        r = response(k, Re, depth)
        by_depth = depth * r.d_depth if lid else 0
        assert abs(k * r.derivative + 2 * Re * r.d_Re - by_depth - r.value) < 1e-12 * abs(r.value)


@pytest.mark.parametrize("lid", [False, True])
def test_lengths_scale(lid):
    for k, Re, depth in sample(4, 200, lid):
        scaled = response(3 * k, 9 * Re, depth / 3).value / 3
        assert abs(scaled - response(k, Re, depth).value) < 1e-12 * abs(scaled)


def test_short_waves_keep_the_digits_of_the_derivative_in_Re():
    k, Re = 1e3, 1e-4
    assert abs(response(k, Re).d_Re / (-0.5j / k) - 1) < 1e-9


def test_a_distant_lid_is_not_felt():
    k = np.geomspace(0.01, 1e3, 100)
    assert np.all(response(k, 50.0, 1e4).value == response(k, 50.0).value)


def order(error, x):
    """Slope of log |error| against log x, between neighbours; shape (x.size - 1,)."""
    return np.diff(np.log(abs(error))) / np.diff(np.log(x))


# each limit: its error as x -> 0, that error's first term, its order
LIMITS = {
    "boundary layer": (
        np.geomspace(1e-6, 1e-4, 5),
        lambda k, factor=1: response(k, 100.0).value - factor * boundary_layer(k, 100.0),
        lambda k: -9 * k / (2 * np.pi * 3**0.5),
        1,
    ),
    "shallow": (
        np.geomspace(1e-4, 1e-2, 5),
        lambda k, factor=1: response(k, 2.0, 3.0).value - factor * shallow(k, 2.0, 3.0),
        lambda k: -4 / 15 * 3 * k**2 + (1j * k * 2) ** 2 * 3**5 / 4200,
        2,
    ),
    "short wave": (
        np.geomspace(0.005, 0.05, 5),
        lambda x, factor=1: response(1 / x, 2.0).value - factor * short_wave(1 / x, 2.0),
        lambda x: -7 / 16 * 4 * x**3,
        3,
    ),
}


@pytest.mark.parametrize("name", LIMITS)
def test_limit_with_its_next_term(name):
    x, error, next_term, expected = LIMITS[name]
    assert np.all(abs(order(error(x), x) - expected) < 0.05)
    assert abs(error(x[0]) / next_term(x[0]) - 1) < 0.02


@pytest.mark.parametrize("name", LIMITS)
def test_one_percent_in_a_limit_is_caught(name):
    x, error, _, expected = LIMITS[name]
    assert np.all(abs(order(error(x, factor=1.01), x) - expected) > 0.5)


def test_arrays_agree_with_scalars_across_methods_and_blocks():
    k = np.geomspace(1e-3, 1e2, 700)
    whole = response(k, 40.0, 4.0)
    some = slice(3, None, 97)
    single = [response(x, 40.0, 4.0) for x in k[some]]
    for field in ("value", "derivative", "d_Re", "d_depth", "error"):
        together = getattr(whole, field)
        assert together.shape == k.shape
        alone = np.array([getattr(r, field) for r in single])
        assert np.all(abs(together[some] - alone) <= 1e-11 * abs(alone) + 1e-14 * abs(whole.value[some]))


def test_no_overflow_or_invalid_operation_in_the_box():
    k = np.geomspace(1e-6, 1e3, 60)
    with np.errstate(all="raise", under="ignore"):
        for Re in 10.0 ** np.arange(-4, 7):
            for depth in (*10.0 ** np.arange(-1, 5), np.inf):
                r = response(k, Re, depth)
                assert all(np.all(np.isfinite(x)) for x in (r.value, r.derivative, r.d_Re, r.d_depth, r.error))
                assert np.all(r.value.real < 0)


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ((0, 1), "k"),
        (([1, -2], 1), "k"),
        ((np.nan, 1), "k"),
        ((np.inf, 1), "k"),
        (([[1.0]], 1), "k"),
        ((1, 0), "Re"),
        ((1, np.nan), "Re"),
        ((1, -1, 2), "Re"),
        ((1, 1, 0), "depth"),
        ((1, 1, np.nan), "depth"),
    ],
)
def test_arguments_outside_their_range(arguments, named):
    with pytest.raises(ValueError, match=rf"^{named} must be .*\(got .*\)$"):
        response(*arguments)
