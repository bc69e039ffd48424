"""Full blocks along a diagonal with a border: solves from either side, and where they are taken for a band."""

import numpy as np
import pytest

from stability.numerics.blocks import Blocks, placed, whole
from stability.numerics.bordered import Bordered, Factors, ManyFactors, Places

SIZES, BORDER, PARTS = (5, 9, 7), 4, 2
INTERIOR = sum(SIZES)
SIZE = INTERIOR + BORDER


@pytest.fixture(params=[False, True], ids=["real", "complex"])
def matrices(request):
    """Two matrices with full blocks and a border that meets each block in one column, in full and as entries."""
    rng = np.random.default_rng(3)
    full = rng.standard_normal((PARTS, SIZE, SIZE)) + (1j * rng.standard_normal((PARTS, SIZE, SIZE)) * request.param)
    full = full if request.param else full.real
    inside, first = np.zeros((SIZE, SIZE), bool), 0
    for number, size in enumerate(SIZES):
        inside[first: first + size, first: first + size] = True
        inside[first: first + size, INTERIOR + number] = True
        first += size
    inside[INTERIOR:] = True
    full = (full + 3 * np.eye(SIZE)) * inside
    part, row, column = np.nonzero(full)
    order = rng.permutation(len(part))
    return full, tuple(index[order] for index in (part, row, column)), full[part, row, column][order]


def columns(count, real):
    rng = np.random.default_rng(4)
    found = rng.standard_normal((SIZE, count)) + 1j * rng.standard_normal((SIZE, count))
    return found.real if real else found


def test_solves_from_either_side(matrices):
    full, places, value = matrices
    bordered = Bordered(placed(*places, PARTS, INTERIOR, BORDER), value)
    assert isinstance(bordered.places, Blocks)
    weights = np.array([1.0, -0.5])
    matrix, x = np.tensordot(weights, full, 1), columns(3, np.isrealobj(full))
    factors = Factors(bordered, weights)
    np.testing.assert_allclose(factors.solve(matrix @ x), x, atol=1e-11)
    np.testing.assert_allclose(factors.solve_left(matrix.T @ x), x, atol=1e-11)
    np.testing.assert_allclose(factors.phase(), np.linalg.slogdet(matrix)[0], atol=1e-12)
    with pytest.raises(AssertionError):
        np.testing.assert_allclose(factors.solve(1.01 * matrix @ x), x, atol=1e-11)


def test_solves_at_many_points_are_those_of_each(matrices):
    full, places, value = matrices
    bordered = Bordered(placed(*places, PARTS, INTERIOR, BORDER), value)
    weights, f = np.array([[1.0, 0.5, 2.0], [-0.5, 0.1, 1e9]]), columns(3, np.isrealobj(full))
    many = ManyFactors(bordered, weights)
    assert many.uneven.tolist() == [False, False, True]
    for index in range(2):
        alone = Factors(bordered, weights[:, index])
        np.testing.assert_allclose(many.solve(f)[:, index], alone.solve(f[:, index]), atol=1e-12)
        np.testing.assert_allclose(many.solve_left(f)[:, index], alone.solve_left(f[:, index]), atol=1e-12)
        np.testing.assert_allclose(many.phases()[index], alone.phase(), atol=1e-12)


def test_a_narrow_band_stays_a_band():
    row = np.arange(40)
    entries = [np.concatenate(one) for one in ((row, row[1:], row[:-1]), (row, row[:-1], row[1:]))]
    assert type(placed(np.zeros(len(entries[0]), int), *entries, 1, 40, 0)) is Places


def test_a_singular_block_is_refused(matrices):
    full, places, value = matrices
    bordered = Bordered(placed(*places, PARTS, INTERIOR, BORDER), value * (places[1] != 6))
    with pytest.raises(np.linalg.LinAlgError, match="singular interior"):
        Factors(bordered, np.array([1.0, -0.5]))


def test_one_block_takes_its_border_in(matrices):
    """What is full but for its border is one full block; several blocks keep theirs."""
    full, places, value = matrices
    assert whole(*places, PARTS, INTERIOR, BORDER).border == BORDER
    inside = (places[1] < SIZES[0]) & (places[2] < SIZES[0])
    inside |= (places[1] >= INTERIOR) & ((places[2] < SIZES[0]) | (places[2] >= INTERIOR))
    inside |= (places[1] < SIZES[0]) & (places[2] >= INTERIOR)
    shift = INTERIOR - SIZES[0]
    part, row, column = (index[inside] for index in places)
    row, column = (np.where(index < SIZES[0], index, index - shift) for index in (row, column))
    bordered = Bordered(whole(part, row, column, PARTS, SIZES[0], BORDER), value[inside])
    assert (bordered.places.interior, bordered.places.border) == (SIZES[0] + BORDER, 0)
    kept = np.r_[: SIZES[0], INTERIOR: SIZE]
    weights, x = np.array([[1.0, 0.5], [-0.5, 0.1]]), columns(2, np.isrealobj(full))[kept]
    many = ManyFactors(bordered, weights)
    for index in range(2):
        matrix = np.tensordot(weights[:, index], full, 1)[np.ix_(kept, kept)]
        np.testing.assert_allclose(many.solve(matrix @ x)[:, index], x[:, index], atol=1e-11)
        np.testing.assert_allclose(many.solve_left(matrix.T @ x)[:, index], x[:, index], atol=1e-11)
        np.testing.assert_allclose(Factors(bordered, weights[:, index]).solve(matrix @ x), x, atol=1e-11)
        np.testing.assert_allclose(many.phases()[index], np.linalg.slogdet(matrix)[0], atol=1e-12)


@pytest.mark.parametrize("kind", [Places, placed])
def test_many_rates_on_a_line(matrices, kind):
    """Weights that are linear in a rate: the same factors, and the same ones are uneven."""
    full, places, value = matrices
    bordered = Bordered(kind(*places, PARTS, INTERIOR, BORDER), value)
    weights, rates = np.array([[1.0, 0.0], [0.2, -0.5]]), np.array([0.5, 2.0, 1e9])
    line = ManyFactors(bordered, weights, rates)
    each = ManyFactors(bordered, weights[:, :1] + weights[:, 1:] * rates)
    assert line.uneven.tolist() == each.uneven.tolist() == [False, False, True]
    np.testing.assert_allclose(line.phases(), each.phases(), atol=1e-12)
    f = columns(3, np.isrealobj(full))
    np.testing.assert_allclose(line.solve(f)[:, :2], each.solve(f)[:, :2], atol=1e-12)
