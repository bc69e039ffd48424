"""Neutral curves drawn through zeros: each once and whole, on surfaces of known shape and for flows."""

from dataclasses import dataclass
from math import exp, log
from types import SimpleNamespace

import numpy as np
import pytest

from stability import flows
from stability.studies.contour import Line, lines_through
from stability.studies.neutral import neutral_curve

SPAN = 1e-2, 1e2


@dataclass(frozen=True, eq=False)
class Known:
    """A mode of known growth rate over (log k, log value), and its slopes there."""

    growth: object
    slopes: object
    flow: str = "whole"


def hill(x, y, size):
    """Growth inside a circle about (x, y)."""
    return Known(lambda a, b: size**2 - (a - x) ** 2 - (b - y) ** 2, lambda a, b: (-2 * (a - x), -2 * (b - y)))


def slope(x, y, height=0.0):
    """Growth over a straight line."""
    return Known(lambda a, b: x * a + y * b - height, lambda a, b: (x, y))


class Sheet:
    """A plane of modes that are known."""

    half = 0

    def flow_at(self, value):
        return SimpleNamespace(halves=lambda: ["whole"])

    def rough(self, tolerance):
        return self

    def adopt(self, point):
        return point

    def point(self, k, value, mode):
        x, y = log(k), log(value)
        along, across = mode.slopes(x, y)
        return SimpleNamespace(plane=self, k=k, value=value, mode=mode, growth=mode.growth(x, y),
                               gradient=np.array([along, across / value]))

    def move(self, start, k, value):
        return self.point(k, value, start.mode)

    def solver(self, value):
        return SimpleNamespace(overlap=lambda old, mode: float(old is mode))


LAND = SimpleNamespace(planes=[Sheet()], span=SPAN)


def zero(x, y, mode):
    return SimpleNamespace(k=exp(x), value=exp(y), mode=mode)


def drawn(zeros, low=0.01, high=100.0, before=()):
    return lines_through(LAND, zeros, list(before), low, high)


@pytest.mark.parametrize("size", [0.05, 0.5, 2.0])
def test_an_island_is_drawn_once_and_closed(size):
    island = hill(0.3, -0.2, size)
    angles = np.linspace(0.1, 6.2, 12)
    zeros = [zero(0.3 + size * np.cos(angle), -0.2 + size * np.sin(angle), island) for angle in angles]
    (line,) = drawn(zeros)
    assert line.points[0] is line.points[-1]
    places = np.log(line.trace[:-1])
    assert np.hypot(places[:, 0] - 0.3, places[:, 1] + 0.2) == pytest.approx(np.full(len(places), size), rel=1e-3)
    steps = np.hypot(*np.diff(places, axis=0).T)
    assert steps.sum() == pytest.approx(2 * np.pi * size, rel=0.01)
    assert len(places) < 250


def test_zeros_between_the_points_of_a_line_lie_on_it():
    mode = slope(1.0, -2.0)
    (line,) = drawn([zero(0.0, 0.0, mode)])
    plane = LAND.planes[0]
    assert all(line.passes(plane.point(exp(x), exp(x / 2), mode)) for x in np.linspace(-4, 4, 333))
    assert not line.passes(plane.point(1.0, exp(0.1), mode))
    assert not line.passes(SimpleNamespace(plane=SimpleNamespace(half=1), k=1.0, value=1.0))


def test_curves_of_two_modes_that_cross_are_both_drawn():
    """Even where the zeros that are known are those of the crossing itself."""
    lines = drawn([zero(0.0, 0.0, slope(1.0, -1.0)), zero(0.0, 0.0, slope(1.0, 1.0))])
    ends = sorted(log(line.points[-1].value) for line in lines)
    assert ends == pytest.approx([-log(100), log(100)], abs=0.2)


def test_two_curves_of_one_mode_are_both_drawn():
    ridge = Known(lambda x, y: y**2 - 0.01, lambda x, y: (0.0, 2 * y))
    assert len(drawn([zero(x, y, ridge) for x in (-1.0, 1.0) for y in (-0.1, 0.1)])) == 2


def test_a_line_ends_where_another_one_is_drawn():
    mode = slope(0.0, 1.0)
    (first,) = drawn([zero(0.0, 0.0, mode)], 0.5, 1.0)
    (second,) = drawn([zero(2.0, 0.0, mode)], 0.5, exp(2.0), [first])
    (alone,) = drawn([zero(2.0, 0.0, mode)], 0.5, exp(2.0))
    assert second.points[0].k > 0.9
    assert alone.points[0].k < 0.5


def test_a_line_of_one_point():
    line = Line([LAND.planes[0].point(1.0, 1.0, mode := slope(0.0, 1.0))])
    assert line.passes(LAND.planes[0].point(1.01, 1.0, mode))
    assert not line.passes(LAND.planes[0].point(1.1, 1.0, mode))


def test_two_curves_of_a_flow_with_several_zeros_on_each():
    """Roll waves: the surface mode's curve, k 0.02 and 1.3, and the tongue of the next mode, crossed twice at 1.3."""
    curve = neutral_curve(flows.RollWave(slope_deg=24.0), "Fr2", [0.02, 1.3])
    assert sum(point.value is not None for point in curve.points) == 4
    ends = np.flatnonzero(np.isnan(curve.trace[:, 0]))
    assert len(ends) == 2
    assert 40 < ends[0] < 80
    assert 40 < ends[1] - ends[0] < 80
    surface, tongue = curve.trace[:ends[0]], curve.trace[ends[0] + 1:-1]
    assert surface[:, 1].min() == pytest.approx(2.857968, rel=1e-3)  # its nose, stability critical
    assert tongue[:, 1].min() == pytest.approx(74.8146, rel=1e-3)
