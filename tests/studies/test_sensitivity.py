"""Derivatives of a mode in every parameter: against differences of the dispersion relation itself."""

import json
from dataclasses import fields, replace
from math import inf

import numpy as np
import pytest

from stability import dispersion, flows, spectrum
from stability.cli import main
from stability.modes.eigenfunction import sharpened
from stability.modes.solver import Solver
from stability.studies.sensitivity import parameter_slope, sensitivities

FLOWS = [flows.Vortex(), flows.Dune(depth=3.0), flows.Dune(depth=3.0, fluid="layer"), flows.RollWave(),
         flows.Film(We=0.1), flows.TwoLayerCouette(density_ratio=1.3, gravity=0.2, tension=0.1),
         flows.Poiseuille(Re=3000.0), flows.Couette(Re=200.0)]
K = 0.7


@pytest.mark.parametrize("flow", FLOWS, ids=lambda flow: flow.name)
def test_every_derivative_is_that_of_the_dispersion_relation(flow):
    """Fourth-order differences: within the error bar and what the differences can tell."""
    mode = dispersion(flow, K).modes[0]
    found = sensitivities(mode).slopes
    assert [one.parameter for one in found] == ["k", *(item.name for item in fields(flow) if item.name != "fluid")]
    for one in found:
        step = 2e-3 * one.value
        sigma = [sigma_at(mode, one.parameter, one.value + i * step) for i in (-2, -1, 1, 2)]
        difference = np.dot(sigma, [1, -8, 8, -1]) / (12 * step)
        scale = abs(one.slope) + abs(mode.sigma) / one.value
        assert one.status == "resolved"
        assert abs(difference - one.slope) <= one.error + 3e-9 * scale
        assert one.error < 1e-8 * scale
    assert mode.sensitivity() == {one.parameter: one.slope for one in found}


def sigma_at(mode, name, value):
    """Eigenvalue of the same mode; where two lead with opposite speeds, the one nearby."""
    flow, k = (mode.flow, value) if name == "k" else (replace(mode.flow, **{name: value}), K)
    if flow.has_surface_mode():
        return dispersion(flow, k).sigma[0]
    return min(spectrum(flow, k, 2).sigma, key=lambda sigma: abs(sigma - mode.sigma))


def test_reynolds_number_and_wavenumber_of_a_critical_point():
    """On the neutral curve's nose growth has no slope in k."""
    flow = flows.Poiseuille(Re=5772.221816209698)
    found = dispersion(flow, 1.0205474492853335).modes[0].sensitivity()
    assert found["k"].real == pytest.approx(0, abs=1e-9)
    assert found["Re"].real > 0


def test_an_infinite_parameter_has_no_derivative():
    found = sensitivities(dispersion(flows.Dune(), K).modes[0])
    assert found.mode.sensitivity()["depth"] is None
    assert (found.slopes[-1].value, found.slopes[-1].status) == (inf, "no derivative: depth is infinite")


@pytest.mark.parametrize("flow", [flows.Film(We=0.0), flows.Dune(shields=1 + 3e-6), flows.Film(slope_deg=179.9999)])
def test_near_the_ends_of_their_range_derivatives_are_one_sided_or_refused(flow):
    slopes = sensitivities(dispersion(flow, 0.1).modes[0]).slopes
    for one in slopes:
        assert one.slope is None or np.isfinite(one.error)


def test_an_unresolved_mode_has_no_resolved_slope():
    mode = dispersion(flows.Dune(shields=3.0), 5.0, max_degree=8, strict=False).modes[0]
    assert all("exceeds tolerance" in one.status for one in sensitivities(mode).slopes[:-1])


def test_the_command_line(capsys):
    assert main(["sensitivity", "dune", "--k", "0.7", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    rows = {row["parameter"]: row for row in result["rows"]}
    assert list(rows) == ["k", "shields", "mu1", "b", "Re", "depth"]
    assert list(rows["k"]) == ["parameter", "value", "d_growth_rate", "d_phase_speed", "elasticity", "error", "status"]
    mode = dispersion(flows.Dune(), 0.7).modes[0]
    assert rows["Re"]["d_growth_rate"] == mode.sensitivity()["Re"].real
    assert rows["Re"]["elasticity"] == pytest.approx(10 * rows["Re"]["d_growth_rate"] / mode.growth_rate)
    assert (rows["depth"]["value"], rows["depth"]["elasticity"]) == ("inf", None)
    speed = dispersion(flows.Dune(), [0.7 - 1e-4, 0.7 + 1e-4]).phase_speed
    assert rows["k"]["d_phase_speed"] == pytest.approx((speed[1] - speed[0]) / 2e-4, rel=1e-6)
    speed = [dispersion(flows.Dune(Re=Re), 0.7).phase_speed[0] for Re in (9.999, 10.001)]
    assert rows["Re"]["d_phase_speed"] == pytest.approx((speed[1] - speed[0]) / 2e-3, rel=1e-6)


def test_the_command_line_draws_and_follows_other_modes(capsys, tmp_path):
    picture = tmp_path / "bars.png"
    assert main(["sensitivity", "couette", "--k", "1", "--mode", "leading", "--plot", str(picture)]) == 0
    assert capsys.readouterr().out.splitlines()[0].split()[0] == "parameter"
    assert picture.stat().st_size > 4000


@pytest.mark.parametrize(("arguments", "line"), [
    (("dune", "--k", "1,2"), "--k: one wavenumber at a time (got 2)"),
    (("dune", "--k", "1", "--mode", "most-unstable"), "--mode: must be one of surface, leading (got 'most-unstable')"),
    (("couette", "--k", "1", "--mode", "surface"), "couette has no slow surface mode"),
])
def test_bad_input(capsys, arguments, line):
    assert main(["sensitivity", *arguments]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert line in captured.err


def test_the_bar_covers_the_rounding_of_differenced_coefficients(monkeypatch):
    """Slopes from steps so large that rounding does not count, their own error extrapolated away."""
    off, bars = [], []
    for ratio in 0.15, 0.4, 1.5, 3.2, 6.0:
        flow = flows.TwoLayerCouette(viscosity_ratio=ratio, density_ratio=1.3, gravity=0.2, tension=0.1)
        mode, solver = dispersion(flow, K).modes[0], Solver(flow)
        refined = sharpened(solver, mode)
        for name in "density_ratio", "gravity", "tension":
            a, b, c = (parameter_slope(solver, refined, name, step) for step in (5e-4, 1e-3, 2e-3))
            best = (16 * (4 * a - b) - (4 * b - c)) / 45
            for term in 1.0, 0.0:
                monkeypatch.setattr("stability.studies.sensitivity._ROUNDING", term)
                found = next(one for one in sensitivities(mode).slopes if one.parameter == name)
                off.append(abs(found.slope - best))
                bars.append(found.error)
    wrong = (np.array(off) > np.array(bars)).reshape(-1, 2).sum(axis=0)
    assert wrong[0] == 0
    assert wrong[1] > 2
