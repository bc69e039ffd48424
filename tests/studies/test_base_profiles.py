"""Profiles of base flows: closed forms, friction laws, slopes that follow, and the command."""

import json
from pathlib import Path

import numpy as np
import pytest

from stability import cli, flows
from stability.studies.base import base_flow

JET = f"{Path(__file__).parents[1] / 'own' / 'jet.py'}:Bickley"


def test_fluxes_in_closed_form():
    """Film 2/3, Bagnold profile 2/5; dunes from (4.52): the integral of 2 y^2 (3 r - y) / (3 b) over the bed."""
    r = np.sqrt(3.0)
    y = np.polynomial.Polynomial([0, 1])
    speed, height = 2 * y**2 * (3 * r - y) / (3 * 0.5), 2 * (r - y)  # dz = 2 zeta dy
    bed = (speed * height).integ()(r - 1)
    for flow, layer, flux in ((flows.Film(), "liquid", 2 / 3), (flows.RollWave(), "grains", 0.4),
                              (flows.Vortex(), "grains", 0.4), (flows.Poiseuille(), "fluid", 4 / 3),
                              (flows.Dune(shields=3.0, b=0.5), "bed", bed)):
        assert base_flow(flow).flux[layer] == pytest.approx(flux, rel=1e-14)


def test_the_bed_obeys_its_friction_law():
    """tau = mu1 (1 + b I) p and U' = I sqrt(p), thesis (4.48) and (4.52); at rest at the yield surface."""
    bed = flows.Dune(shields=2.5, mu1=0.3, b=0.7)
    found = base_flow(bed, 21)
    assert found.z[[0, -1]] == pytest.approx([-1.5, 0], abs=1e-14)
    number, pressure = found.inertial_number, found.pressure
    assert found.shear_stress == pytest.approx(0.3 * (1 + 0.7 * number) * pressure, rel=1e-13)
    assert found.dU == pytest.approx(number * np.sqrt(pressure), rel=1e-13, abs=1e-14)
    assert (number[0], found.U[0]) == (pytest.approx(0, abs=1e-14), 0)
    assert "yield surface at z = -1.5: no flow below" in found.notes()


def test_roll_waves_obey_their_friction_law():
    flow = flows.RollWave(slope_deg=27.0)
    found = base_flow(flow, 11)
    friction = flow.mu1 + (flow.mu2 - flow.mu1) / (1 + 1 / found.inertial_number)
    assert found.shear_stress == pytest.approx(friction * found.pressure, rel=1e-13, abs=1e-15)


def test_pressure_of_two_liquids_is_hydrostatic():
    found = base_flow(flows.TwoLayerCouette(gravity=2.0, density_ratio=3.0), 3)
    assert found.pressure == pytest.approx([8, 5, 2, 2, 1, 0], abs=1e-14)


def test_a_slope_that_follows_has_a_bound():
    found = base_flow(flows.find(JET)(), 201)
    exact = -2 * np.tanh(found.z) / np.cosh(found.z) ** 2
    assert (np.abs(found.dU - exact) <= found.error).all()
    assert np.median(found.error) < 1e-11
    assert not base_flow(flows.Film()).error.any()


def test_the_command(capsys):
    assert cli.main(["base", "dune", "--points", "5", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert len(result["rows"]) == 5
    assert result["rows"][0]["viscosity"] is None
    assert any(note.startswith("scales: length: grain diameter") for note in result["notes"])
    assert cli.main(["base", "dune", "--points", "1"]) == 2
    assert "--points: must be an integer from 2" in capsys.readouterr().err
