"""Published tables, digit by digit, and the multi-precision numbers behind them; each with a twin that must fail."""

import numpy as np
import pytest
from twins import table, wrong_coefficient

from stability import flows, spectrum
from stability.modes.solver import Solver
from stability.studies.critical import critical

MISPRINTED = {12, 25, 27, 32}  # modes of Orszag's Table 5 with an error of up to a unit in the last digit


@pytest.fixture(scope="module")
def modes():
    return spectrum(flows.Poiseuille(Re=1e4), 1.0, 36, strict=False).modes


def recomputed(name="recomputed_poiseuille"):
    return np.array([complex(float(row["c_r"]), float(row["c_i"])) for row in table(name)])


def disagreement(c, row):
    """Largest difference of a part of c from the printed one, in units of its last digit."""
    return max(abs(value - float(row[key])) * 10 ** len(row[key].partition(".")[2])
               for value, key in ((c.real, "c_r"), (c.imag, "c_i")))


def units(modes):
    """Disagreement of every row of Orszag's Table 5 with the nearest mode, in units of the last digit."""
    c = np.array([mode.c for mode in modes])
    return np.array([disagreement(c[np.argmin(np.abs(c - complex(float(row["c_r"]), float(row["c_i"]))))], row)
                     for row in table("orszag1971_table5")])


def test_orszag_table_5(modes):
    found = units(modes)
    assert len(found) == 32
    wrong = set(np.flatnonzero(found > 0.5) + 1)
    assert wrong == MISPRINTED
    assert found.max() < 1


def test_orszag_table_5_twin():
    wrong = spectrum(wrong_coefficient(flows.Poiseuille(Re=1e4), "beta"), 1.0, 36, strict=False)
    assert np.sum(units(wrong.modes) > 1) > 20


def test_the_misprints_are_orszags():
    """The multi-precision values differ from his digits at the same modes."""
    rows = table("orszag1971_table5")
    printed = np.array([complex(float(row["c_r"]), float(row["c_i"])) for row in rows])
    nearest = recomputed()[np.abs(recomputed()[:, None] - printed).argmin(axis=0)]
    wrong = {i for i, (c, row) in enumerate(zip(nearest, rows, strict=True), 1) if disagreement(c, row) > 0.5}
    assert wrong == MISPRINTED


def test_every_mode_of_the_spectrum_and_no_other(modes):
    """All 36 least stable modes are found, the one missing from Orszag's table too, each within its error bar."""
    c, error = np.array([mode.c for mode in modes]), np.array([mode.error for mode in modes])
    nearest = np.abs(c[:, None] - recomputed()).argmin(axis=1)
    assert sorted(nearest) == list(range(36))
    assert np.all(np.abs(c - recomputed()[nearest]) < error)
    assert np.median(np.abs(c - recomputed()[nearest]) / error) < 1


def test_error_bars_are_not_wide(modes):
    """A bar that says little would pass any test."""
    c, error = np.array([mode.c for mode in modes]), np.array([mode.error for mode in modes])
    true = np.abs(c[:, None] - recomputed()).min(axis=1)
    assert np.median(error / np.maximum(true, 1e-16)) < 20


def test_least_stable_mode_to_fourteen_digits(modes):
    assert abs(modes[0].c - (0.237526488820470 + 0.003739670622979j)) < 1e-15 + 0.5e-15 * np.sqrt(2)


@pytest.mark.parametrize("row", table("recomputed_shear_flows"), ids=lambda row: f"{row['flow']}-{row['Re']}")
def test_modes_of_shear_flows(row):
    exact = complex(float(row["c_r"]), float(row["c_i"]))
    flow = flows.FLOWS[row["flow"]](Re=float(row["Re"]))
    solver = Solver(flow)
    mode = solver.solve(float(row["k"]), -1j * exact, degree=128)
    assert abs(mode.c - exact) < mode.error < 1e-9
    found = spectrum(flow, float(row["k"]), 16, strict=False)
    assert min(abs(other.c - exact) - other.error for other in found.modes) < 0


@pytest.mark.parametrize("coefficient", ["U", "eta", "beta", "dU"])
def test_modes_of_shear_flows_twin(coefficient):
    for row in table("recomputed_shear_flows")[:1]:
        exact = complex(float(row["c_r"]), float(row["c_i"]))
        wrong = wrong_coefficient(flows.Poiseuille(Re=1e4), coefficient)
        mode = Solver(wrong).solve(1.0, -1j * exact, degree=96)
        assert abs(mode.c - exact) > 1e-6


def test_critical_point_of_poiseuille_flow():
    exact = {row["quantity"]: float(row["value"]) for row in table("recomputed_poiseuille_critical")}
    point = critical(flows.Poiseuille(), "Re")
    assert abs(point.value - exact["Re"]) < point.error < 1e-10 * exact["Re"]
    assert abs(point.k - exact["k"]) < point.k_error < 1e-10
    assert point.phase_speed == pytest.approx(exact["c"], abs=1e-12)
    assert abs(point.value - 5772.22) < 0.005
    assert abs(point.phase_speed - 0.26400) < 0.5e-5


def test_critical_point_twin():
    assert critical(wrong_coefficient(flows.Poiseuille(), "dU"), "Re").value != pytest.approx(5772.22, abs=1)


def test_rounding_floor_of_poiseuille_flow():
    """Below 1e-13 from degree 80 to 192."""
    exact = 0.237526488820470107446579 + 0.00373967062297940993222j
    for degree in (80, 96, 128, 160, 192):
        assert abs(Solver(flows.Poiseuille()).solve(1.0, -1j * exact, degree=degree).c - exact) < 1e-13
