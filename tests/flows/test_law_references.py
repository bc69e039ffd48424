"""Dunes and roll waves under random friction laws against 30-digit power series of the laws themselves.

STABILITY_LAWS=60 takes 60 cases of each kind instead of a few.
"""

import os
from dataclasses import replace
from math import atan, degrees

import bed_references as references
import mpmath as mp
import numpy as np
import pytest

from stability import dispersion
from stability.flows import Dune, Regularised, RollWave, Saturating

COUNT = int(os.environ.get("STABILITY_LAWS", "0"))
ACCURACY = 1e-11


def laws(kind, rng):
    mu1 = rng.uniform(0.25, 0.5)
    mu2, I0 = mu1 * rng.uniform(1.3, 2.0), rng.uniform(0.1, 0.5)
    return Saturating(mu1, mu2, I0) if kind is Saturating else Regularised(mu1, mu2, I0, mu_inf=rng.uniform(0.03, 0.1))


def reference_of(law):
    return (getattr(references, type(law).__name__), *law.values.values())


def dunes(kind, count, seed):
    rng = np.random.default_rng(seed)
    for index in range(count):
        law = laws(kind, rng)
        top = 0.97 * law.mu2 / law.mu1 if kind is Saturating else 1.7
        bed = Dune(shields=1 + (top - 1) * rng.uniform(0.1, 1), law=law, Re=10 ** rng.uniform(-1, 3),
                   depth=float(rng.uniform(2, 15)) if index % 2 else np.inf)
        yield (replace(bed, creep=1e-5) if kind is Regularised else bed), 10 ** rng.uniform(-2, 0.8)


def check(cases, solve, share=0.005):
    """All within the accuracy, and nearly all within their error bars."""
    outside, worst, count = 0, 0.0, 0
    for flow, k in cases:
        mode = dispersion(flow, k).modes[0]
        error = abs(complex(solve(flow, k, mode.sigma)) - mode.sigma)
        assert error < ACCURACY * abs(mode.sigma), (flow, k)
        outside += error > mode.error + 1e-16 * abs(mode.sigma)
        worst, count = max(worst, error / abs(mode.sigma)), count + 1
    print(f"{count} cases, {outside} outside their bars, largest relative error {worst:.1e}")
    assert outside <= share * count


def solve_dune(flow, k, guess):
    return references.dune(reference_of(flow.law), flow.shields, flow.Re, flow.depth, k, guess,
                           creep=getattr(flow, "creep", None), digits=30 if COUNT else 20)


_SLOW = pytest.mark.skipif(not COUNT, reason="minutes for each reference: with STABILITY_LAWS")


@pytest.mark.parametrize(("kind", "few", "seed"), [(Saturating, 2, 5), pytest.param(Regularised, 1, 6, marks=_SLOW)])
def test_dunes(kind, few, seed):
    check(dunes(kind, COUNT or few, seed), solve_dune)


@pytest.mark.parametrize("kind", [Saturating, Regularised])
def test_roll_waves(kind):
    rng = np.random.default_rng(8)

    def cases():
        for _ in range(COUNT or 4):
            law = laws(kind, rng)
            low = law.mu1 if kind is Saturating else 0.8 * law.mu1
            slope = degrees(atan(low + (law.mu2 - low) * rng.uniform(0.05, 0.95)))
            yield RollWave(slope_deg=slope, law=law, Fr2=10 ** rng.uniform(-1, 1.5)), 10 ** rng.uniform(-2, 0.8)

    check(cases(), lambda flow, k, guess: references.rollwave(reference_of(flow.law), flow.slope_deg, flow.Fr2, k,
                                                             guess))


def test_a_law_one_percent_off_fails():
    law = Saturating(0.4, 0.6, 0.3)
    flow = Dune(shields=1.4, law=law)
    sigma = dispersion(replace(flow, I0=0.303), 1.0).modes[0].sigma
    exact = references.dune(reference_of(law), 1.4, 10.0, mp.inf, 1.0, sigma, digits=12, radius=0.1)
    assert abs(complex(exact) - sigma) > 1e-4 * abs(sigma)
