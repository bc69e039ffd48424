"""Creeping grains: three layers whatever the parameters, and nothing depends on where they are divided."""

import numpy as np
import pytest

from stability import dispersion
from stability.flows import Chute, Dune, Plate, Regularised, bed
from stability.flows.bed import divided

LAW = Regularised()


@pytest.mark.parametrize("flow", [
    Dune(shields=1.01, law=LAW), Dune(shields=1.1, law=LAW), Dune(shields=5.0, law=LAW), Dune(law=LAW, creep=1e-8),
    Plate(law=LAW), Chute(law=LAW), Chute(law=LAW, plug=0.3)], ids=str)
def test_three_layers(flow):
    layers = flow.layers(None)
    assert len(layers) == 3
    edges = [layer.base(np.array([0.0, 1.0])) for layer in layers]
    edges = edges[::-1] if isinstance(flow, Chute) and edges[0].U[0] > edges[-1].U[0] else edges
    for below, above in zip(edges, edges[1:], strict=False):
        np.testing.assert_allclose(below.U[1], above.U[0], rtol=1e-12)
        np.testing.assert_allclose(below.dU[1], above.dU[0], rtol=1e-9)


def test_breaks_stay_edges():
    assert divided([1e-6, 1e-2, 1.0]) == pytest.approx([1e-6, 1e-2, 1e-1, 1.0])
    assert divided([1e-3, 1.0]) == pytest.approx([1e-3, 1e-2, 1e-1, 1.0])
    assert divided([1e-6, 1e-3, 1e-2, 1.0]) == [1e-6, 1e-3, 1e-2, 1.0]


@pytest.mark.parametrize("k", [0.05, 2.0])
def test_nothing_depends_on_the_division(monkeypatch, k):
    flow = Dune(shields=1.7, law=LAW)
    (usual,) = dispersion(flow, k).modes
    limit = flow.long_wave(np.array([k]))[0]
    bed.pieces.cache_clear()
    bed.flux_slopes.cache_clear()
    monkeypatch.setattr(bed, "divided", lambda edges: [edges[0], *np.geomspace(edges[0], edges[1], 4)[1:], *edges[2:]])
    other = Dune(shields=1.7, law=LAW, Re=10.0 * (1 + 1e-15))  # another one, lest it be remembered
    try:
        (mode,) = dispersion(other, k).modes
        assert len(other.layers(None)) == 4
        assert abs(mode.sigma - usual.sigma) <= mode.error + usual.error
        np.testing.assert_allclose(other.long_wave(np.array([k]))[0], limit, rtol=1e-12)
        (off,) = dispersion(Dune(shields=1.01 * 1.7, law=LAW), k).modes
        assert abs(off.sigma - usual.sigma) > 1e-3 * abs(mode.sigma)
    finally:
        bed.pieces.cache_clear()
        bed.flux_slopes.cache_clear()
