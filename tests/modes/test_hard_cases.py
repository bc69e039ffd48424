"""Where branches of the spectrum cross, eigenvalues are ill-conditioned: the error bars say which digits are real.

References: `tests/references.py` at 30 digits, kept in a table because each value takes seconds.
"""

from functools import cache

import numpy as np
import pytest
import references
from twins import table

from stability import flows, spectrum
from stability.modes.energy import condition_numbers

ROWS = table("recomputed_branch_crossing")
CASES = {"poiseuille": (flows.Poiseuille(Re=1e6), 40), "couette": (flows.Couette(Re=13000), 30)}


@pytest.fixture(params=CASES)
def crossing(request):
    return compared(request.param)


@cache
def compared(name):
    """Modes of a flow, their bars, which of them the table has, their true errors, and all condition numbers."""
    flow, count = CASES[name]
    modes = spectrum(flow, 1.0, count, strict=False).modes
    exact = np.array([complex(float(row["c_r"]), float(row["c_i"])) for row in ROWS if row["flow"] == name])
    c, error = np.array([mode.c for mode in modes]), np.array([mode.error for mode in modes])
    nearest = np.abs(c[:, None] - exact).argmin(axis=0)
    return modes, error, nearest, np.abs(c[nearest] - exact), condition_numbers(modes)


def test_bars_hold_and_are_not_wide(crossing):
    """Over eight orders of magnitude of the error, from where 15 digits are real to where 6 are."""
    _, error, nearest, true, _ = crossing
    assert len(set(nearest)) == len(nearest) >= 13
    assert true.max() > 1e8 * true.min()
    assert np.all(true < error[nearest])
    assert np.median(error[nearest] / true) < 20


def test_ill_conditioned_modes_are_not_called_resolved(crossing):
    modes, error, _, _, conditions = crossing
    for mode, bar, condition in zip(modes, error, conditions, strict=True):
        assert (mode.status == "resolved") == (bar <= 1e-10 * abs(mode.sigma))
        if condition > 1e7:
            assert mode.status.startswith("error ")


def test_the_bar_grows_with_the_condition_number(crossing):
    _, error, _, _, conditions = crossing
    slope = np.polyfit(np.log(conditions), np.log(error), 1)[0]
    assert slope == pytest.approx(1.0, abs=0.15)


def test_couette_modes_come_in_pairs_within_their_bars():
    """c and -conj(c); rounding does not respect that, and the bars must say so."""
    modes = spectrum(flows.Couette(Re=13000), 1.0, 20, strict=False).modes
    for mode in modes:
        partner = min(modes, key=lambda other: abs(other.c + mode.c.conjugate()))
        assert abs(partner.c + mode.c.conjugate()) <= partner.error + mode.error


def test_the_table_is_what_the_reference_gives():
    row = next(row for row in ROWS if row["flow"] == "couette")
    c = complex(float(row["c_r"]), float(row["c_i"]))
    value = references.couette(Re=float(row["Re"]), k=float(row["k"]), guess=-1j * c)
    assert abs(complex(value) + 1j * c) < 3e-16


def test_poiseuille_at_ten_million():
    """Beyond the degrees that we have for most of the spectrum: bars hold, and say what is not resolved."""
    modes = spectrum(flows.Poiseuille(Re=1e7), 1.0, 24, strict=False).modes
    for row in table("recomputed_branch_crossing_1e7"):
        c = complex(float(row["c_r"]), float(row["c_i"]))
        mode = min(modes, key=lambda mode, c=c: abs(mode.c - c))
        assert abs(mode.c - c) < mode.error
        assert (mode.status == "resolved") == (mode.error <= 1e-10 * abs(mode.sigma))
    assert any(mode.status.startswith("error ") for mode in modes)
