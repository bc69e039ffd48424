"""Neutral curves and critical points, and the derivatives they rest on."""

import json
from dataclasses import replace
from math import exp
from types import SimpleNamespace

import numpy as np
import pytest

from stability import NotResolved, ParameterError, dispersion, flows, spectrum
from stability.cli import main
from stability.modes.accuracy import Accuracy
from stability.modes.energy import condition_numbers, energy
from stability.modes.solver import Solver
from stability.studies.critical import critical, critical_sweep
from stability.studies.neutral import neutral_curve
from stability.studies.plane import Plane
from stability.studies.ridges import may_turn
from stability.studies.sensitivity import parameter_slope

FLOWS = [
    (flows.Poiseuille(), 1.0, "Re"),
    (flows.RollWave(), 0.3, "slope_deg"),
    (flows.RollWave(), 0.3, "Fr2"),
    (flows.Film(We=0.1), 0.8, "We"),
    (flows.TwoLayerCouette(density_ratio=1.3, gravity=0.2), 1.0, "depth_ratio"),
    (flows.Dune(depth=3.0), 1.0, "Re"),
    (flows.Dune(), 1.0, "Re"),
    (flows.Dune(depth=3.0, fluid="layer"), 1.0, "shields"),
    (flows.Vortex(), 1.0, "slope_deg"),
]


def leading(flow, k):
    return spectrum(flow, k, 1).modes[0]


@pytest.mark.parametrize(("flow", "k", "name"), FLOWS, ids=lambda part: str(part)[:30])
def test_parameter_derivative(flow, k, name):
    """The formula from both vectors against differences of the eigenvalue itself (five points)."""
    mode, value = leading(flow, k), getattr(flow, name)
    step = 1e-3 * value
    sigma = [leading(replace(flow, **{name: value + i * step}), k).sigma for i in (-2, -1, 1, 2)]
    difference = np.dot(sigma, [1, -8, 8, -1]) / (12 * step)
    assert parameter_slope(Solver(mode.flow), mode, name) == pytest.approx(difference, rel=2e-7)


def test_parameter_derivative_at_the_end_of_the_range():
    flow = flows.Film(We=0.0)
    mode, ahead = leading(flow, 1.0), leading(flows.Film(We=1e-7), 1.0)
    assert parameter_slope(Solver(flow), mode, "We") == pytest.approx((ahead.sigma - mode.sigma) / 1e-7, rel=1e-5)


def test_a_parameter_without_effect():
    flow = flows.TwoLayerCouette(density_ratio=1.0)
    assert parameter_slope(Solver(flow), leading(flow, 1.0), "gravity") == 0


@pytest.mark.parametrize("start", [1000.0, 6000.0, 3e4])
def test_the_critical_point_does_not_depend_on_the_start(start):
    point = critical(flows.Poiseuille(Re=start), "Re")
    assert point.value == pytest.approx(5772.221816209698, rel=1e-11)
    assert point.k == pytest.approx(1.0205474492853335, rel=1e-11)


def test_both_branches_meet_at_the_nose():
    k = np.array([0.95, 1.0, 1.05, 1.0205474492853335])
    curve = neutral_curve(flows.Poiseuille(), "Re", k)
    assert [point.k for point in curve.points] == np.repeat(k, 2).tolist()
    for point in curve.points:
        mode = min(spectrum(point.flow, point.k, 3).modes, key=lambda mode: abs(mode.growth_rate))
        slope = parameter_slope(Solver(mode.flow), mode, "Re").real
        assert abs(mode.growth_rate / slope) <= point.error + mode.error / abs(slope)
    assert curve.points[6].value == pytest.approx(5772.221816209698, rel=1e-9)
    assert np.nanmin(curve.trace[:, 1]) == pytest.approx(5772.22, rel=1e-3)
    assert np.isnan(curve.trace[:, 0]).sum() == 1  # one curve through all eight
    assert len(curve.trace) < 80


def test_the_curve_turns_back_beyond_the_range_asked_for():
    """k 1.09 lies below the largest neutral wavenumber, 1.0967: two values of Re."""
    first, second = neutral_curve(flows.Poiseuille(), "Re", [1.09]).points
    assert first.value < 8000 < second.value


def test_wavenumbers_beyond_the_curve_say_so():
    (point,) = neutral_curve(flows.Poiseuille(), "Re", [1.2]).points
    assert point.value is None
    assert "does not reach k = 1.2" in point.status


def test_curve_from_a_long_wave_threshold():
    """The neutral curve of a film leaves Re = (5/4) cot slope at k = 0 with a k^2 correction."""
    curve = neutral_curve(flows.Film(slope_deg=30.0), "Re", [0.01, 0.02, 0.3])
    shift = [point.value - 1.25 * point.flow.cot_slope for point in curve.points]
    assert shift[1] / shift[0] == pytest.approx(4, rel=1e-3)
    assert shift[2] > 0


def test_long_wave_thresholds_need_no_waves_of_finite_length(monkeypatch):
    monkeypatch.setattr("stability.studies.ridges.Landscape.column", None)
    point = critical(flows.Film(slope_deg=30.0), "Re", long_wave=True)
    assert point.value == pytest.approx(1.25 * point.flow.cot_slope, rel=1e-12)
    with pytest.raises(NotResolved, match="no long-wave threshold in slope_deg from 21.062 to 32.5514"):
        critical(flows.RollWave(Fr2=5.0), "slope_deg", long_wave=True)


def test_a_neutral_curve_is_drawn_on_the_scale_of_the_wavenumbers_asked_for():
    curve = neutral_curve(flows.Film(), "Re", np.geomspace(0.01, 1.0, 3), span=(2.0, 100.0))
    evenly = zip(curve.points, (0.01, 0.5, 0.99), strict=True)
    even = replace(curve, points=tuple(replace(point, k=k) for point, k in evenly))
    assert [panel.x.scale for result in (curve, even) for panel in result.panels()] == ["log"] * 2 + ["linear"] * 2


def test_a_sweep_finds_what_each_flow_has():
    films = [flows.Film(Re=1.0, slope_deg=slope) for slope in (80, 40, 10, 2, 0.5)]
    values = [point.value for point in critical_sweep(films, "Re")]
    assert values == pytest.approx([1.25 * film.cot_slope for film in films], rel=1e-11)


def test_dunes_have_a_stable_window():
    """At small Re and under a lid no dune grows: the nose of that window, on its own curve."""
    point = critical(flows.Dune(depth=10.0, shields=1.5), "Re")
    below, above = (spectrum(replace(point.flow, Re=factor * point.value), point.k, 1).sigma[0].real
                    for factor in (0.99, 1.01))
    assert below < 0 < above
    assert point.k > 0


@pytest.mark.parametrize("flow", [flows.Couette(), flows.Vortex()], ids=str)
def test_always_stable(flow):
    name = "Re" if flow.name == "couette" else "Fr2"
    with pytest.raises(NotResolved, match=f"stable at every {name} from .* to .*, k from 0.01 to 100, all modes"):
        critical(flow, name)


def test_unknown_parameter():
    with pytest.raises(ParameterError, match="no numeric parameter 'Fr' to vary; it has Re"):
        critical(flows.Poiseuille(), "Fr")
    with pytest.raises(ParameterError, match="no numeric parameter 'fluid'"):
        critical(flows.Dune(), "fluid")


@pytest.mark.parametrize(("flow", "k"), [
    (flows.Poiseuille(), 1.0), (flows.Vortex(), 2.0), (flows.Film(), 1.0), (flows.RollWave(), 0.5),
    (flows.TwoLayerCouette(density_ratio=1.5), 1.0), (flows.Dune(), 1.0), (flows.Dune(fluid="layer"), 1.0)], ids=str)
def test_energy_product_is_that_of_the_pencil(flow, k):
    """(adjoint, state) = y^H B x, and Cauchy-Schwarz bounds the condition number from below by 1."""
    for mode in spectrum(flow, k, 4).modes:
        norm = energy(Solver(mode.flow), k, mode.degree)
        product = norm.width * np.vdot(norm.adjoint @ mode.y, norm.state @ mode.x)
        assert product == pytest.approx(1, abs=1e-9)
        assert condition_numbers([mode])[0] >= 1 - 1e-12


def test_creeping_flow_is_normal():
    """Stokes flow is self-adjoint in the energy norm; inertia at Re 1e4 is not."""
    assert condition_numbers(spectrum(flows.Poiseuille(Re=1e-4), 1.0, 6).modes) == pytest.approx(np.ones(6), abs=1e-6)
    assert condition_numbers(spectrum(flows.Poiseuille(), 1.0, 12).modes).max() > 300


def test_conditions_predict_the_loss_of_digits():
    """The error bars of the spectrum follow the condition numbers."""
    modes = spectrum(flows.Poiseuille(), 1.0, 30, strict=False).modes
    digits = np.log10([mode.error for mode in modes])
    assert np.corrcoef(digits, np.log10(condition_numbers(modes)))[0, 1] > 0.9


def run(capsys, *arguments):
    status = main([*arguments, "--quiet"])
    out, err = capsys.readouterr()
    return status, out, err


def test_critical_on_the_command_line(capsys):
    status, out, _ = run(capsys, "critical", "film", "--vary", "Re", "--slope-deg", "45", "--json")
    row, inner = json.loads(out)["rows"]
    assert status == 0
    assert inner["status"] == "resolved; inside"  # the shear mode, Re 5768.34
    assert list(row) == ["k", "Re", "phase_speed", "error", "k_error", "status"]
    assert row["Re"] == pytest.approx(1.25, abs=1e-11)


def test_neutral_on_the_command_line(capsys, tmp_path):
    picture = tmp_path / "neutral.svg"
    status, out, _ = run(capsys, "neutral", "rollwave", "--vary", "Fr2", "--over", "slope_deg=26,28", "--long-wave",
                         "--json", "--plot", str(picture))
    rows = json.loads(out)["rows"]
    assert status == 0
    assert picture.stat().st_size > 1000
    assert list(rows[0]) == ["slope_deg", "k", "Fr2", "phase_speed", "error", "status"]
    assert [0.4 * np.sqrt(row["Fr2"]) for row in rows] == pytest.approx([0.652983267151, 0.62042859109], abs=1e-11)


def test_neutral_curve_on_the_command_line(capsys, tmp_path):
    status, out, _ = run(capsys, "neutral", "film", "--vary", "Re", "--k", "0.1,0.2", "--json",
                         "--plot", str(tmp_path / "curve.png"))
    assert status == 0
    assert [row["k"] for row in json.loads(out)["rows"]] == [0.1, 0.2]


def test_nothing_found_is_exit_3(capsys):
    status, out, _ = run(capsys, "critical", "vortex", "--vary", "Fr2", "--json")
    assert status == 3
    assert "stable at every Fr2" in json.loads(out)["rows"][0]["status"]


@pytest.mark.parametrize(("arguments", "message"), [
    (["critical", "film"], "--vary"),
    (["critical", "film", "--vary", "theta"], "no numeric parameter 'theta' to vary; it has Re, slope_deg, We"),
    (["neutral", "film", "--vary", "Re"], "one of the arguments --over --k is required"),
    (["neutral", "film", "--vary", "Re", "--over", "Re=1,2"], "Re is the parameter to solve for"),
    (["neutral", "film", "--vary", "Re", "--k", "1", "--long-wave"], "--long-wave: has no meaning with --k"),
    (["neutral", "film", "--vary", "Re", "--k", "-1"], "--k"),
])
def test_bad_usage_is_exit_2(capsys, arguments, message):
    status, out, err = run(capsys, *arguments)
    assert status == 2
    assert out == ""
    assert message in err
    assert err.count("\n") == 1


@pytest.mark.parametrize(("growth", "slope", "turns"), [
    (lambda t: t**2 - 0.01, lambda t: 2 * t, True), (lambda t: 0.01 - t**2, lambda t: -2 * t, True),
    (lambda t: t**2 + 0.5, lambda t: 2 * t, False), (lambda t: 0.3 + t, lambda t: 1.0, False),
])
def test_growth_of_one_sign_at_both_ends_that_may_change_it_in_between(growth, slope, turns):
    """Parabolas with and without zeros between their ends, and a straight line."""
    ends = (SimpleNamespace(value=exp(t), growth=growth(t), trend=slope(t)) for t in (-0.2, 0.3))
    assert bool(may_turn(*ends)) is turns


@pytest.mark.parametrize(("checks", "keeps"), [(("overlaps",), True), ((), False)])
def test_a_move_over_the_plane_keeps_the_mode_by_its_vectors(monkeypatch, checks, keeps):
    """Near k = 1 two real modes of this flow pass within 7 % of each other: one long step lands on the other one."""
    flow = flows.Vortex(slope_deg=21.215735, Fr2=0.77673)
    start, end = dispersion(flow, [0.8, 2.0]).modes
    walked = Plane(flow, "Fr2", Accuracy())
    monkeypatch.setattr("stability.studies.plane._Move.checks", checks)
    found = walked.move(walked.point(start.k, flow.Fr2, start), 2.0, flow.Fr2)
    assert (abs(found.mode.sigma - end.sigma) < 1e-8 * abs(end.sigma)) == keeps
