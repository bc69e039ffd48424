"""The brute-force solver against multi-precision references and known values, and its tables against itself."""

import bruteforce
import numpy as np
import pytest
import references
from twins import table

MU = bruteforce.RollWave.mu1, bruteforce.RollWave.mu2
CASES = [
    ("poiseuille", (1e4,), 1.0),
    ("poiseuille", (100.0,), 0.01),
    ("couette", (1000.0,), 1.0),
    ("couette", (10.0,), 3.0),
    ("film", (10.0, 30.0, 0.0), 1e-3),
    ("film", (8500.0, 1 / 120, 0.0), 2.8),
    ("film", (500.0, 0.5, 0.1), 0.3),
    ("two_layer_couette", (0.3, 0.6, 3.0, 200.0, 0.0, 0.1), 1e-3),
    ("two_layer_couette", (5.0, 3.0, 2.0, 50.0, 0.1, 0.01), 9.0),
    ("two_layer_couette", (0.1, 8.0, 2.0, 100.0, 0.5, 0.01), 1.0),
    ("vortex", (30.0, 0.1), 2.0),
    ("vortex", (45.0, 5.0), 20.0),
    ("rollwave", (28.0, 4.0), 0.5),
    ("rollwave", (30.0, 30.0), 5.0),
    ("dune", (2.0, 0.4, 1.0, 10.0), 1.0),
    ("dune", (1.3, 0.3, 2.0, 100.0), 0.1),
]


@pytest.mark.parametrize(("flow", "parameters", "k"), CASES)
def test_references(flow, parameters, k):
    problem = bruteforce.MAKE[flow](*parameters)
    sigma, _, error = bruteforce.exact(problem, k, bruteforce.leading(problem, k)[0][0])
    more = {"rollwave": MU, "dune": (np.inf,)}.get(flow, ())
    exact = complex(getattr(references, flow)(*parameters, *more, k, sigma, digits=15))
    assert error < 1e-11 * abs(sigma)
    assert abs(sigma - exact) < 1e-12 * abs(exact)


@pytest.mark.parametrize(("flow", "parameters", "k", "growth"), [
    ("film", (8500, 1 / 120), 2.86080312333323103, 1.66972369613340542e-4),
    ("film", (1e4, 1), 0.9694334387601672, 0.0042986799494699),
    ("two_layer_couette", (0.3, 0.6, 3, 200, 0, 0.1), 1.44251169302539820, 0.0163795545896191067),
])
def test_fastest(flow, parameters, k, growth):
    status, k_max, sigma, _, missed = bruteforce.fastest(bruteforce.MAKE[flow](*parameters))
    assert (status, missed) == ("maximum", [])
    assert k_max == pytest.approx(k, rel=1e-8)
    assert sigma.real == pytest.approx(growth, rel=1e-11)


@pytest.mark.parametrize(("fixed", "Re", "k"), [
    ({"slope_deg": 1 / 120, "We": 0.0}, 8370.097174989859180, 2.892371613947937515),
    ({"slope_deg": 0.1, "We": 0.0}, 716.1812609, 0.00276429675),
    ({"slope_deg": 30.0, "We": 0.0}, 1.25 * np.sqrt(3), 0.0),
])
def test_critical(fixed, Re, k):
    found, unstable = bruteforce.Critical(bruteforce.Film, "Re", Re / 1.3, Re * 1.4, fixed, 4).run()
    assert not unstable
    assert found[0][:2] == (pytest.approx(Re, rel=1e-10), pytest.approx(k, rel=1e-7, abs=1e-12))
    assert len(found) == 1


@pytest.mark.parametrize("row", [row for row in table("bruteforce_kmax") if row["status"] == "maximum"][::8],
                         ids=lambda row: f"{row['flow']}-{row['case']}")
def test_maxima_of_the_table(row):
    """The growth rate is there at other degrees, and lower on both sides."""
    names = [name for name in bruteforce.PARAMETERS if row[name]]
    problem = bruteforce.MAKE[row["flow"]](**{name: float(row[name]) for name in names})
    k, sigma = float(row["k_max"]), complex(float(row["growth_rate"]), float(row["frequency"]))
    again, slope, _ = bruteforce.polish(problem, k, problem.degree(k, 3), sigma)
    assert abs(again - sigma) <= 3 * float(row["error"]) + 1e-14 * abs(sigma)
    for side in 0.995, 1.005:
        beside, _, _ = bruteforce.exact(problem, k * side, sigma + slope * k * (side - 1))
        assert beside.real < sigma.real
