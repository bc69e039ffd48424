"""Steady granular flows of the thesis's chapter 2: closed forms, quadrature and an initial-value problem."""

from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
import sympy as sp

from stability import flows, spectrum
from stability.errors import ParameterError
from stability.flows import Annulus, Chute, Dune, Linear, Pile, PlaneShear, Plate, PowerLaw, Regularised, Saturating
from stability.flows.rheology import well_posed_band
from stability.studies.base import base_flow

LAW = Saturating(0.4, 0.64, 0.3)
LAWS = (LAW, Linear(0.4, 1.5), Regularised(0.4, 0.64, 0.3))


def plate_velocity(lam, theta, Z):
    """U of (2.35), dU/dZ = (1/lam) (Z - Z1)/(Z2 - Z) sqrt(1 - Z), closed, y = sqrt(1 - Z), a^2 = theta/lam."""
    y, r, a = np.sqrt(1 - Z), np.sqrt(theta), np.sqrt(theta / lam)
    log = np.log((r - a) / (r + a)) - np.log((y - a) / (y + a))
    return 2 / lam * (-(r**3 - y**3) / 3 + (r**2 - a**2) * (r - y) + a / 2 * (r**2 - a**2) * log)


@pytest.mark.parametrize("theta", [1.1, 1.3, 1.5, *np.linspace(1.58, 1.599, 5)])  # up to 1.6, where none is steady
def test_the_plate_has_the_profile_of_the_thesis(theta):
    found = base_flow(Plate(shields=theta, law=LAW))
    exact = LAW.I0 * plate_velocity(1.6, theta, found.z)
    rounding = 1e-15 / (1.6 - theta)  # of theta
    np.testing.assert_allclose(found.U, exact, atol=max(1e-13, rounding) * exact.max())
    assert np.abs(found.U - LAW.I0 * plate_velocity(1.616, theta, found.z)).max() > 1e-3 * exact.max()


def test_the_bed_of_dunes_is_the_dragged_plate():
    """(4.52) and (2.35) from mu(I) (1 - z) = mu1 shields by algebra, and the same numbers of both scenes."""
    z, theta, mu1, b, lam, I0, number = sp.symbols("z theta mu1 b lambda I0 I", positive=True)
    linear, = sp.solve(sp.Eq(mu1 * (1 + b * number) * (1 - z), mu1 * theta), number)
    assert sp.simplify(linear * sp.sqrt(1 - z) - (theta - 1 + z) / (b * sp.sqrt(1 - z))) == 0
    friction = mu1 + (lam * mu1 - mu1) * number / (I0 + number)
    saturating, = sp.solve(sp.Eq(friction * (1 - z), mu1 * theta), number)
    thesis = (z - (1 - theta)) / (lam * ((1 - theta / lam) - z)) * sp.sqrt(1 - z)
    assert sp.simplify(saturating * sp.sqrt(1 - z) / I0 - thesis) == 0
    for law in LAWS:
        bed, plate = (base_flow(cls(shields=1.4, law=law)) for cls in (Dune, Plate))
        np.testing.assert_allclose(bed.U, plate.U, atol=1e-14)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_velocities_are_integrals_of_the_shear_rate(law):
    """Plug and surface velocity, flux: adaptive quadrature of I sqrt(p), from the law's own inverse."""
    chute, pile = Chute(plug=0.75, law=law), Pile(slope_deg=30, mu_wall=0.4, law=law)
    pressure = 0.75 / law.rest

    def rate(x):
        return float(law.beyond(max(x / pressure - law.start, 0))) * pressure**0.5

    breaks = sorted([chute.core, *(float(law.mu(one)) * pressure for one in law.breaks), 1.0])
    assert chute.core == 0.75 if law.yields else rate(chute.core) / rate(1.0) == pytest.approx(1e-6, rel=1e-9)
    assert chute.plug_velocity == pytest.approx(float(mp.quad(rate, breaks)), rel=1e-12)
    assert chute.flux == pytest.approx(2 * float(mp.quad(lambda x: x * rate(x), breaks)), rel=1e-12)
    breaks = sorted({0.0, *((pile.mu - float(law.mu(one))) / 0.4 for one in law.breaks), pile.depth})
    speed = mp.quad(lambda y: float(law.beyond(max(pile.mu - 0.4 * y - law.start, 0))) * y**0.5, breaks)
    assert base_flow(pile).U[-1] == pytest.approx(float(speed), rel=1e-9)


@pytest.mark.parametrize("law", [*LAWS, PowerLaw(0.4, 1.0, 0.7), PowerLaw(0.4, 1.0, 1.6)], ids=str)
def test_the_annulus_solves_its_initial_value_problem(law):
    """(2.2), (2.3) by Runge-Kutta steps from where the grains are at rest, or held by the outer cylinder."""
    from scipy.integrate import solve_ivp

    flow = Annulus(thickness=0.2, gamma=4.0, law=law)
    outer, torque = flow._solved[-1].ring.outer, law.rest * 1.2**2

    def slopes(R, state):
        P, spin = state
        number = float(law.beyond(max(torque / (R**2 * P) - law.start, 0.0)))
        return [R * spin**2, -4.0 * number * P**0.5 / R]

    state, start = [1.0, 0.0], outer
    for end in (*(part.ring.inner for part in reversed(flow._solved[1:])), 1.0):  # not across jumps of the slope
        state = solve_ivp(slopes, (start, end), state, method="DOP853", rtol=1e-12, atol=1e-15).y[:, -1]
        start = end
    assert flow.rotation == pytest.approx(state[1], rel=1e-11)
    assert base_flow(flow).pressure[0] == pytest.approx(state[0], rel=1e-12)
    assert replace(flow, gamma=4.04).rotation != pytest.approx(state[1], rel=1e-3)
    if law is LAW:  # the thesis's form of the law
        assert number_of_the_thesis(1.1, 1.2, 0.99) == pytest.approx(float(law.inverse(torque / (1.1**2 * 0.99))))
    if not law.yields:
        rates = base_flow(flow)
        creep = (rates.inertial_number * np.sqrt(rates.pressure))[[0, -1]]
        assert creep[1] / creep[0] == pytest.approx(1e-6, rel=1e-9)


def number_of_the_thesis(R, Ry, P):
    return 0.3 * (Ry**2 - R**2 * P) / (1.6 * R**2 * P - Ry**2)


@pytest.mark.parametrize("n", [0.3, 0.7, 1.5])
def test_powers_of_the_inertial_number_that_are_not_whole(n):
    """The shear rate is the power 1/n of the distance from the yield surface: integrals in u, its fourth root."""
    law = PowerLaw(0.4, 1.0, n)
    chute, pile = Chute(plug=0.75, law=law), Pile(slope_deg=30, mu_wall=0.4, law=law)
    p, depth = mp.mpf(0.75) / mp.mpf(0.4), mp.mpf(pile.depth)
    speed = mp.quad(lambda u: (u**4 / p / mp.mpf(0.4)) ** (1 / mp.mpf(n)) * mp.sqrt(p) * 4 * u**3, (0, 0.25**0.25))
    assert chute.plug_velocity == pytest.approx(float(speed), rel=1e-13)
    speed = mp.quad(lambda u: u ** (4 / mp.mpf(n)) * mp.sqrt(depth - u**4) * 4 * u**3,
                    (0, depth**0.25 / 2, depth**0.25))
    assert base_flow(pile).U[-1] == pytest.approx(float(speed), rel=1e-13)


def test_plane_shear_is_ill_posed_where_its_inertial_number_is():
    """U = z, uniform I: grows without bound outside the band of Barker et al., decays inside."""
    low, high = well_posed_band(Saturating())
    for number, grows in ((0.5 * low, True), (1.1 * low, False), (0.5 * high, False)):
        shear = PlaneShear(inertial=number, inertia=0.1)
        leading = spectrum(shear, 30.0, 1, strict=False).modes[0].growth_rate
        assert (leading > 0) == grows


def test_waves_under_a_plate_are_resolved_under_every_law():
    for law in LAWS:
        modes = spectrum(Plate(law=law, grains=5.0), 1.0, 3).modes
        assert all(mode.status == "resolved" for mode in modes)
    one, other = (spectrum(Plate(law=law, grains=3.0), 1.0, 1).modes[0] for law in
                  (Linear(0.4, 1.5), PowerLaw(0.4, 1.5, 1.0)))
    assert abs(one.sigma - other.sigma) <= one.error + other.error


@pytest.mark.parametrize(("make", "message"), [
    (lambda: Chute(plug=0.5, law=LAW), r"plug must lie in \(0.625, 1\)"),
    (lambda: Pile(slope_deg=33, law=LAW), "slope_deg must lie in"),
    (lambda: Plate(shields=1.7, law=LAW), "shields must lie in"),
    (lambda: Annulus(thickness=0.5, law=LAW), "no steady flow found"),
    (lambda: spectrum(Chute(law=PowerLaw(0.4, 1.0, 0.5)), 1.0), "friction must rise linearly with I from rest"),
    (lambda: spectrum(Pile(), 1.0), "ask for stability base pile"),
    (lambda: spectrum(flows.Annulus(), 1.0), "ask for stability base annulus"),
])
def test_refusals(make, message):
    with pytest.raises(ParameterError, match=message):
        make()
