"""Waves under random friction laws against 30-digit power series of the laws themselves, flow by flow and law by law.

STABILITY_LAWS=60 takes 60 cases of each kind instead of a few, STABILITY_LAWS_DIGITS=20 references of 20 digits.
"""

import os
from dataclasses import replace
from math import atan, degrees

import bed_references
import law_series
import mpmath as mp
import numpy as np
import pytest
import uniform_references

from stability import dispersion, spectrum
from stability.flows import Chute, Dune, Linear, PlaneShear, Plate, PowerLaw, Regularised, RollWave, Saturating

COUNT = int(os.environ.get("STABILITY_LAWS", "0"))
DIGITS = int(os.environ.get("STABILITY_LAWS_DIGITS", "30"))
ACCURACY = 1e-11
BEDS = (Linear, Saturating, Regularised)  # friction that rises linearly from rest, or has no yield stress
LAWS = (*BEDS, PowerLaw)


def laws(kind, rng):
    mu1 = rng.uniform(0.25, 0.5)
    if kind in (Linear, PowerLaw):
        b = 10 ** rng.uniform(-0.5, 0.5)
        return Linear(mu1, b) if kind is Linear else PowerLaw(mu1, b, rng.uniform(0.3, 1.5))
    mu2, I0 = mu1 * rng.uniform(1.3, 2.0), rng.uniform(0.1, 0.5)
    return Saturating(mu1, mu2, I0) if kind is Saturating else Regularised(mu1, mu2, I0, mu_inf=rng.uniform(0.03, 0.1))


def shields(law, rng):
    """Of a bed that yields, and whose friction is not at its end."""
    top = {Linear: 3.0, Regularised: 1.7}.get(type(law)) or 0.97 * law.mu2 / law.mu1
    return 1 + (top - 1) * rng.uniform(0.1, 1)


def creeping(flow):
    return replace(flow, creep=1e-5) if isinstance(flow.law, Regularised) else flow


def dunes(kind, rng):
    law = laws(kind, rng)
    depth = float(rng.uniform(2, 15)) if rng.random() < 0.5 else np.inf
    return creeping(Dune(shields=shields(law, rng), law=law, Re=10 ** rng.uniform(-1, 3), depth=depth))


def plates(kind, rng):
    law = laws(kind, rng)
    return creeping(Plate(shields=shields(law, rng), law=law, grains=10 ** rng.uniform(0, 1.5)))


def chutes(kind, rng):
    law = laws(kind, rng)
    return creeping(Chute(plug=1 / shields(law, rng), law=law, grains=10 ** rng.uniform(0, 1.5)))


def roll_waves(kind, rng):
    law = laws(kind, rng)
    low = 0.8 * law.mu1 if kind is Regularised else law.mu1
    high = law.mu2 if kind in (Saturating, Regularised) else 1.8 * law.mu1
    slope = degrees(atan(low + (high - low) * rng.uniform(0.05, 0.95)))
    return RollWave(slope_deg=slope, law=law, Fr2=10 ** rng.uniform(-1, 1.5))


def plane_shears(kind, rng):
    return PlaneShear(law=laws(kind, rng), inertial=10 ** rng.uniform(-2, 0.3), inertia=10 ** rng.uniform(-1, 2))


def reference(flow, k, guess, digits):
    """The multi-precision eigenvalue next to a guess."""
    name = type(flow.law).__name__
    bed = (getattr(law_series, name, None), *flow.law.values.values())
    uniform, creep = (flow.law.name, *bed[1:]), getattr(flow, "creep", None)
    if isinstance(flow, RollWave):
        return uniform_references.rollwave(uniform, flow.slope_deg, flow.Fr2, k, guess, digits)
    if isinstance(flow, PlaneShear):
        return uniform_references.plane_shear(uniform, flow.inertial, flow.inertia, k, guess, digits)
    if isinstance(flow, Chute):
        return bed_references.chute(bed, flow.plug, flow.grains**2, k, guess, creep, digits)
    if isinstance(flow, Plate):
        return bed_references.plate(bed, flow.shields, flow.grains**2, k, guess, creep, digits)
    return bed_references.dune(bed, flow.shields, flow.Re, flow.depth, k, guess, creep, digits)


def mode_of(flow, k):
    """The surface mode, or the leading one of those that are resolved."""
    if flow.has_surface_mode():
        return dispersion(flow, k).modes[0]
    return next((mode for mode in spectrum(flow, k, 2, strict=False).modes if mode.status == "resolved"), None)


CASES = [(make, kind) for make in (dunes, plates, roll_waves, plane_shears, chutes) for kind in LAWS
         if make in (roll_waves, plane_shears) or kind in BEDS]


@pytest.mark.parametrize(("make", "kind"), CASES, ids=lambda one: one.__name__)
def test_flows_under_laws(make, kind):
    """All within the accuracy, and nearly all within their error bars."""
    rng = np.random.default_rng([5, CASES.index((make, kind))])
    outside, worst, unresolved, done = 0, 0.0, 0, 0
    few, digits = (1, 20) if make in (dunes, plates, chutes) else (2, 30)
    while done < (COUNT or few):
        flow, k = make(kind, rng), 10 ** rng.uniform(-2, 0.8)
        mode = mode_of(flow, k)
        if mode is None:
            unresolved += 1
            continue
        exact = complex(reference(flow, k, mode.sigma, DIGITS if COUNT else digits))
        error, size = abs(exact - mode.sigma), abs(mode.sigma)
        assert error < ACCURACY * size, (flow, k)
        outside += error > mode.error + 1e-16 * size
        worst, done = max(worst, error / size), done + 1
    print(f"{make.__name__} {kind.__name__}: {done} cases, {outside} outside their bars, largest relative error "
          f"{worst:.1e}; {unresolved} without a mode that is resolved")
    assert outside <= 0.005 * done
    assert unresolved <= done


def test_a_law_one_percent_off_fails():
    law = Saturating(0.4, 0.6, 0.3)
    bed = (law_series.Saturating, *law.values.values())
    sigma = dispersion(Dune(shields=1.4, law=replace(law, I0=0.303)), 1.0).modes[0].sigma
    exact = bed_references.dune(bed, 1.4, 10.0, mp.inf, 1.0, sigma, digits=12, radius=0.1)
    assert abs(complex(exact) - sigma) > 1e-4 * abs(sigma)
    uniform = ("saturating", *law.values.values())
    sigma = spectrum(PlaneShear(law=replace(law, mu2=0.606)), 1.0, 1).modes[0].sigma
    exact = uniform_references.plane_shear(uniform, 0.1, 1.0, 1.0, sigma, digits=12, radius=0.1)
    assert abs(complex(exact) - sigma) > 1e-4 * abs(sigma)
