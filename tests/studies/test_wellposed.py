"""Ill-posed strips and the internal modes that live there."""

import json

import numpy as np
import pytest

from stability import NotResolved, dispersion, flows, k_max, spectrum
from stability.cli import main
from stability.flows import Linear, PowerLaw, Regularised, Saturating
from stability.flows.rheology import well_posed_band
from stability.modes.short_waves import well_posedness
from stability.studies.dispersion import DispersionRelation
from stability.studies.outgrown import outgrown
from stability.studies.wellposed import growth_with_degree

ILL = flows.Dune(shields=1.05, mu1=0.7, b=1.0, Re=10.0)
INTERNAL = 7327.0151706242 + 24715.4910767460j  # power series in 30-digit arithmetic


def run(capsys, *words):
    status = main(list(words))
    return status, *capsys.readouterr()


@pytest.mark.parametrize("flow", [flows.Vortex(), flows.Film(), flows.Poiseuille(), flows.RollWave(slope_deg=28.0)])
def test_well_posed_flows_have_no_strip(flow):
    assert well_posedness(flow).strips == ()


@pytest.mark.parametrize("slope_deg", [21.1, 21.74, 30.07, 32.6])
def test_roll_waves_outside_the_band_are_ill_posed_everywhere(slope_deg):
    (strip,) = well_posedness(flows.RollWave(slope_deg=slope_deg)).strips
    assert strip.low == 0
    assert strip.high == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("slope_deg", [21.75, 30.06])
def test_roll_waves_inside_the_band_are_well_posed(slope_deg):
    assert not well_posedness(flows.RollWave(slope_deg=slope_deg)).ill_posed


@pytest.mark.parametrize("mu1", [0.2, 0.4, 0.7])
def test_every_dune_is_ill_posed_next_to_its_yield_surface(mu1):
    """b I = shields/(1 - z) - 1 rises from 0 there to shields - 1: the strip ends where C(I) = 0."""
    flow = flows.Dune(shields=1.7, mu1=mu1)
    (strip,) = well_posedness(flow).strips
    low, _ = well_posed_band(Linear(mu1, 1.0))
    z = 1 - flow.shields / (1 + low)
    assert strip.low == 0
    assert strip.high == pytest.approx(z - (1 - flow.shields), rel=1e-9)


SCENES = {  # with the height above its lower edge at which friction is mu, and where that is largest
    "dune": (lambda law: flows.Dune(shields=1.4, law=law),
             lambda flow, mu: flow.shields * (1 - flow.law.rest / mu), lambda flow: flow.law.rest * flow.shields),
    "plate": (lambda law: flows.Plate(shields=1.3, law=law),
              lambda flow, mu: flow.shields * (1 - flow.law.rest / mu), lambda flow: flow.law.rest * flow.shields),
    "chute": (lambda law: flows.Chute(plug=0.72, law=law),
              lambda flow, mu: 1 - flow.plug * mu / flow.law.rest, lambda flow: flow.law.rest / flow.plug),
    "pile": (lambda law: flows.Pile(slope_deg=29.0, law=law),
             lambda flow, mu: flow.depth - (flow.mu - mu) / flow.mu_wall, lambda flow: flow.mu),
}


@pytest.mark.parametrize("law", [Linear(0.4, 1.5), Saturating(0.4, 0.6, 0.3), PowerLaw(0.4, 1.5, 1.0)], ids=str)
@pytest.mark.parametrize("scene", SCENES)
def test_the_strip_is_where_the_condition_of_the_law_fails(scene, law):
    """C depends on I alone: slow grains next to yield are ill posed up to where C(I) = 0, rapid ones of a saturating
    law beyond the other zero."""
    make, height, largest = SCENES[scene]
    flow = make(law)
    low, high = well_posed_band(law)
    top = largest(flow)
    frictions = [law.mu1, float(law.mu(low))]
    if isinstance(law, Saturating) and law.mu(high) < top:
        frictions += [float(law.mu(high)), top]
    found = sorted(end for strip in well_posedness(flow).strips for end in (strip.low, strip.high))
    np.testing.assert_allclose(found, sorted(height(flow, mu) for mu in frictions), atol=1e-9)
    assert np.abs(np.array(found) - height(flow, float(law.mu(1.01 * low)))).min() > 1e-6


@pytest.mark.parametrize("scene", SCENES)
def test_the_regularised_law_leaves_no_strip(scene):
    make, *_ = SCENES[scene]
    assert well_posedness(make(Saturating(0.4, 0.66, 0.3))).strips
    for law in (Regularised(0.4, 0.66, 0.3), Regularised(0.4, 0.7, 0.2), Regularised()):  # C(I1) = 0 but for rounding
        assert not well_posedness(make(law)).strips


def test_roll_wave_growth_rises_with_degree_exactly_where_ill_posed():
    (steep,) = growth_with_degree(flows.RollWave(slope_deg=32.6), [10.0])
    assert not steep.settled
    assert np.all(np.diff(steep.rates) > 0)
    assert steep.rates[-1] > 10 * steep.rates[0]
    (middle,) = growth_with_degree(flows.RollWave(slope_deg=28.0), [10.0])
    assert middle.settled
    assert middle.rates[-1] < 0


def test_internal_mode_of_a_dune_is_resolved():
    (mode,) = spectrum(ILL, 10.0, 1).modes
    assert abs(mode.sigma - INTERNAL) < 1e-12 * abs(INTERNAL)
    (growth,) = growth_with_degree(ILL, [10.0], degrees=(24, 32))
    assert growth.rates[1] == pytest.approx(growth.rates[0], rel=1e-6)


def test_surface_mode_is_still_the_default_and_is_flagged():
    relation = dispersion(ILL, [3.0, 10.0])
    assert relation.sigma[1] == pytest.approx(-0.1005653813435554 - 0.1330376213445740j, abs=1e-13)
    found = outgrown(relation)
    assert found.k == 10
    assert found.rate == pytest.approx(INTERNAL.real, rel=1e-6)


def test_onset_is_found_among_many_wavenumbers():
    k = np.geomspace(1, 30, 40)
    found = outgrown(dispersion(ILL, k))
    every = [outgrown(dispersion(ILL, value)) is not None for value in k]
    assert found.k == k[every.index(True)]
    assert all(every[every.index(True):])


@pytest.mark.parametrize("flow", [flows.Dune(shields=2.0, mu1=0.4), flows.RollWave(slope_deg=28.0)])
def test_nothing_is_flagged_where_the_surface_mode_leads(flow):
    assert outgrown(dispersion(flow, [0.3, 1.0])) is None


def test_no_surface_mode_no_flag():
    assert outgrown(DispersionRelation(ILL, "most-unstable", (), {}, ())) is None


@pytest.mark.parametrize("mode", ["leading", "most-unstable"])
def test_other_modes_of_an_ill_posed_flow_carry_a_note(mode):
    """That of roll waves at k = 10 is resolved at degree 512 only: it still moves at the degrees that are compared."""
    flow = flows.RollWave(slope_deg=32.6)
    relation = dispersion(flow, 10.0, mode, strict=mode == "leading")
    assert relation.status[0].startswith("resolved" if mode == "leading" else "others may be missing")
    assert relation.notes() == [f"{flow}: grains is ill posed between heights 0 and 1 above its lower edge"]
    assert dispersion(flows.RollWave(slope_deg=28.0), 10.0, mode, strict=False).notes() == []
    surface = dispersion(flow, 10.0, strict=False, rivals=True)
    assert "that degrees 96 and 160 do not resolve outgrows" in surface.notes()[0]


def test_limits_at_the_edges_of_a_layer():
    """At the yield surface the viscosity is infinite and r = 0: C = alpha^2 = mu1^2, short waves grow without bound."""
    found = well_posedness(flows.Dune(mu1=0.4), 3)
    assert found.C[0] == pytest.approx(0.16, abs=1e-15)
    assert found.short_waves[0] == np.inf
    assert np.all(np.isfinite(found.short_waves[1:]))
    surface = well_posedness(flows.RollWave(slope_deg=32.6), 3).short_waves[-1]
    assert (surface, np.signbit(surface)) == (0, False)


def test_unresolved_mode_is_refused():
    with pytest.raises(NotResolved, match="exceeds tolerance"):
        dispersion(flows.RollWave(slope_deg=21.1), 30.0, mode="most-unstable", max_degree=48)


def test_command_flags_the_surface_mode(capsys):
    words = ("dispersion", "dune", "--shields", "1.05", "--mu1", "0.7", "--k", "3,10", "--json")
    status, out, err = run(capsys, *words)
    rows = json.loads(out)["rows"]
    assert status == 0
    assert [row["status"] for row in rows] == ["resolved", "resolved; outgrown"]
    assert "an internal mode (7327.02) outgrows the surface mode from k = 10 on" in err


def test_command_prints_no_unresolved_number(capsys):
    status, out, _ = run(capsys, "dispersion", "rollwave", "--slope-deg", "21.1", "--k", "30", "--mode",
                         "most-unstable", "--max-degree", "48", "--json")
    (row,) = json.loads(out)["rows"]
    assert status == 3
    assert row["growth_rate"] is None
    assert "exceeds tolerance" in row["status"]


def test_spectrum_says_that_it_does_not_converge(capsys):
    status, _, err = run(capsys, "spectrum", "rollwave", "--slope-deg", "21.1", "--k", "30", "--modes", "1",
                         "--max-degree", "48")
    assert status == 3
    assert "the spectrum does not converge; grains is ill posed between heights 0 and 1" in err


def test_command_prints_and_draws_the_condition(capsys, tmp_path):
    picture = tmp_path / "strip.png"
    status, out, err = run(capsys, "wellposed", "dune", "--points", "5", "--json", "--plot", str(picture))
    rows = json.loads(out)["rows"]
    assert status == 0
    assert [row["ill_posed"] for row in rows] == ["yes", "no", "no", "no", "no"]
    assert "bed is ill posed between heights 0 and 0.08753 above its lower edge" in err
    assert picture.stat().st_size > 10_000


def test_command_reports_growth_by_degree(capsys):
    status, out, _ = run(capsys, "wellposed", "rollwave", "--slope-deg", "21.1", "--k", "0.1,10", "--json")
    first, second = json.loads(out)["rows"]
    assert status == 3
    assert first["status"] == "resolved"
    assert second["status"] == "unresolved: still moves at degree 64"


@pytest.mark.parametrize(("shields", "mu1", "Re", "overtaken"), [
    (1.02, 0.7, 3e3, True), (1.02, 0.7, 10.0, False), (2.0, 0.4, 10.0, False),
    (2.604, 0.7, 0.1, True),  # the surface mode needs degree 56 there, and below 24 its rival is not seen
])
def test_an_internal_mode_ahead_at_k_max_is_noticed(shields, mu1, Re, overtaken):
    flow = flows.Dune(shields=shields, mu1=mu1, Re=Re)
    optimum = k_max(flow)
    leading = spectrum(flow, optimum.k_max, 1).modes[0]
    assert optimum.status.endswith("outgrown") == overtaken == (leading.growth_rate > optimum.growth_rate + 1e-6)


def test_kmax_says_which_points_are_outgrown(capsys):
    status, out, err = run(capsys, "kmax", "dune", "--shields", "1.02", "--mu1", "0.7", "--over", "Re=10,3e3", "--json")
    assert status == 0
    assert "an internal mode outgrows the surface mode at k_max at 1 of 2 values of Re, first here: bed is ill" in err
    assert [row["status"] for row in json.loads(out)["rows"]] == ["resolved", "resolved; outgrown"]
