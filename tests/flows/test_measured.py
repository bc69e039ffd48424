"""Tables of a velocity: fits, standard errors of what follows from them, and what is refused."""

import json
import os
import pickle
from dataclasses import replace

import numpy as np
import pytest
import sheared
from scipy.io import netcdf_file

from stability import dispersion, flows, k_max, spectrum
from stability.cli import main
from stability.errors import ParameterError
from stability.studies.critical import critical

OPEN = {"bottom": "decay", "top": "decay"}
BRUTE_FORCE = bool(os.environ.get("STABILITY_BRUTE_FORCE"))
CRITICAL = 5772.22181620968  # of plane Poiseuille flow
BLASIUS_CRITICAL = 519.0601174518


def written(path, z, U, errors=None, head="z,U"):
    columns = (z, U) if errors is None else (z, U, errors)
    lines = [",".join(f"{value:.10g}" for value in row) for row in zip(*columns, strict=True)]
    path.write_text("\n".join(["# a table", head + (",U_error" if errors is not None else ""), *lines]) + "\n")
    return str(path)


def noisy(seed, points=1001, noise=0.01, **errors):
    """Plane Poiseuille flow with noise."""
    z = np.linspace(-1, 1, points)
    U = 1 - z**2 + noise * np.random.default_rng([5772, seed]).standard_normal(points)
    return flows.Shear((z, U, np.full(points, noise)) if errors.get("given") else (z, U))


def run(capsys, *arguments):
    status = main([*arguments, "--json"])
    out, err = capsys.readouterr()
    found = json.loads(out) if out else {"rows": []}
    return status, found.pop("rows"), found, err


# -- exact tables ----------------------------------------------------------------------------------------


def test_critical_point_of_the_boundary_layer_from_41_points(capsys, tmp_path):
    z = np.linspace(0, 8, 41)
    path = written(tmp_path / "blasius.csv", z, sheared.blasius(z)[0])
    status, (row,), header, err = run(capsys, "critical", "shear", "--profile", path, "--top", "decay", "--vary", "Re",
                                      "--range", "450:600", "--search", "0.25:0.36")
    assert (status, err) == (0, "")
    assert abs(row["Re"] - BLASIUS_CRITICAL) < 2 * row["data_error"] < 2e-3
    assert header["parameters"]["profile"].startswith(f"{path} (sha256 ")


def test_a_table_of_a_parabola_is_one():
    z = np.linspace(-1, 1, 21)
    mode = spectrum(flows.Shear((z, 1 - z**2), Re=1e4), 1.0, 1).modes[0]
    exact = spectrum(flows.Poiseuille(Re=1e4), 1.0, 1).modes[0]
    assert abs(mode.sigma - exact.sigma) <= mode.error + exact.error
    assert mode.data_error < 1e-15


@pytest.mark.parametrize("edges", [OPEN, {"bottom": "wall", "top": "decay"}])
def test_tables_of_a_jet(edges, tmp_path, capsys):
    z = np.linspace(-6, 6, 61)
    path = written(tmp_path / "jet.csv", z, 1 / np.cosh(z) ** 2)
    flags = [word for name, kind in edges.items() for word in (f"--{name}", kind)]
    status, rows, _, err = run(capsys, "dispersion", "shear", "--profile", path, *flags, "--Re", "100", "--k",
                               "0.1:1.5:50")
    assert (status, err, len(rows)) == (0, "", 50)
    named = flows.Shear("bickley", Re=100.0, **(edges if edges == OPEN else {**OPEN}))
    if edges == OPEN:
        exact = dispersion(named, [row["k"] for row in rows[::10]])
        for row, growth in zip(rows[::10], exact.growth_rate, strict=True):
            assert abs(row["growth_rate"] - growth) < 10 * row["data_error"] + row["error"] < 1e-9


def test_falling_heights_and_comments(tmp_path):
    z = np.linspace(-1, 1, 21)
    up = flows.Shear(written(tmp_path / "up.csv", z, 1 - z**2))
    path = tmp_path / "down.csv"
    rows = "\n".join(f"{b:.10g}, {a:.10g} ,x # here" for a, b in zip(z[::-1], 1 - z[::-1] ** 2, strict=True))
    path.write_text(f"\ufeff# from above\n\nU , z,remark\n{rows}\n")
    assert up.profile.z == flows.Shear(str(path)).profile.z


# -- noise -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("given", [True, False])
def test_the_error_of_growth_is_its_scatter(given):
    exact = spectrum(flows.Poiseuille(Re=3000.0), 1.0, 1).modes[0].growth_rate
    deviations = []
    for seed in range(200 if BRUTE_FORCE else 12):
        mode = spectrum(replace(noisy(seed, 1001, given=given), Re=3000.0), 1.0, 1).modes[0]
        deviations.append((mode.growth_rate - exact) / mode.data_error)
    assert 0.6 < np.sqrt(np.mean(np.square(deviations))) < 1.5


def test_noisy_jets_in_an_unbounded_fluid():
    rng, z = np.random.default_rng(5), np.linspace(-5, 5, 101)
    exact = spectrum(flows.Shear("bickley", Re=50.0, **OPEN), 0.6, 1).modes[0]
    for _ in range(3 if BRUTE_FORCE else 1):
        U = 1 / np.cosh(z) ** 2 + 0.002 * rng.standard_normal(len(z))
        mode = spectrum(flows.Shear((z, U), Re=50.0, **OPEN), 0.6, 1).modes[0]
        assert abs(mode.growth_rate - exact.growth_rate) < 3 * mode.data_error < 0.01


@pytest.mark.parametrize("quantity", ["k_max", "growth", *(["critical"] if BRUTE_FORCE else [])])
def test_errors_are_those_of_repeated_solutions(quantity):
    """Against differences along every principal direction of the fit."""
    flow = replace(noisy(3, 201), Re=9000.0)

    def value(one):
        if quantity == "growth":
            return spectrum(one, 1.0, 1).modes[0].growth_rate
        if quantity == "k_max":
            return k_max(one, search=(0.85, 1.05)).k_max
        return critical(one, "Re", span=(5500, 6300), search=(0.98, 1.06)).value

    data = flow.data
    sizes, directions = np.linalg.eigh(data.covariance)
    z, total = np.array(flow.profile.z), 0.0
    for size, direction in zip(sizes, directions.T, strict=True):
        step = 0.03 * np.sqrt(size)
        two = [value(replace(flow, profile=(z, data.U(z) + sign * step * (data.basis(z) @ direction))))
               for sign in (1, -1)]
        total += ((two[0] - two[1]) / (2 * step)) ** 2 * size
    smooth = replace(flow, profile=(z, data.U(z), np.full(len(z), data.scatter)))
    found = {"growth": lambda: spectrum(smooth, 1.0, 1).modes[0].data_error,
             "k_max": lambda: k_max(smooth, search=(0.85, 1.05)).data_error,
             "critical": lambda: critical(smooth, "Re", span=(5500, 6300), search=(0.98, 1.06)).data_error}[quantity]()
    assert found == pytest.approx(np.sqrt(total), rel=2e-3)


def test_critical_points_of_noisy_tables():
    """One per cent of noise at 1001 points; growth sets in later in any flow that is not even: of 101 points that
    shifts the critical value by as much as its error."""
    deviations = []
    for seed in range(200 if BRUTE_FORCE else 4):
        point = critical(noisy(seed), "Re", span=(5500, 6000), search=(0.98, 1.06))
        deviations.append(abs(point.value - CRITICAL) / point.data_error)
    within = [np.mean(np.array(deviations) < size) for size in (1, 2)]
    assert within[1] >= (0.92 if BRUTE_FORCE else 0.75)
    assert 0.60 <= within[0] <= 0.76 or not BRUTE_FORCE and within[0] >= 0.25


def test_errors_too_small_by_half_are_seen():
    deviations = [(spectrum(noisy(seed, 101), 1.0, 1).modes[0].growth_rate, noisy(seed, 101)) for seed in range(12)]
    exact = spectrum(flows.Poiseuille(Re=100.0), 1.0, 1).modes[0].growth_rate
    sizes = [abs(growth - exact) / spectrum(flow, 1.0, 1).modes[0].data_error for growth, flow in deviations]
    assert np.sqrt(np.mean(np.square(sizes))) < 1.7
    assert np.sqrt(np.mean(np.square(sizes))) * 3 > 1.7


# -- columns, files --------------------------------------------------------------------------------------


def test_columns(capsys, tmp_path):
    z = np.linspace(-1, 1, 41)
    path = written(tmp_path / "table.csv", z, 1 - z**2, np.full(41, 1e-3))
    base = ["--profile", path]
    _, rows, header, _ = run(capsys, "dispersion", "shear", *base, "--k", "1")
    assert list(rows[0]) == ["k", "growth_rate", "phase_speed", "error", "group_speed", "group_error", "data_error",
                             "degree", "status"]
    assert "sha256" in header["parameters"]["profile"]
    _, rows, _, _ = run(capsys, "spectrum", "shear", *base, "--k", "1", "--modes", "2")
    assert rows[0]["data_error"] > 0
    _, rows, _, _ = run(capsys, "kmax", "shear", *base, "--Re", "9e3", "--search", "0.8:1.1")
    assert rows[0]["data_error"] > 0
    assert rows[0]["growth_data_error"] > 0
    _, rows, _, _ = run(capsys, "neutral", "shear", *base, "--k", "1", "--vary", "Re", "--range", "3e3:9e3")
    assert rows[0]["data_error"] > 0
    _, rows, _, _ = run(capsys, "sensitivity", "shear", *base, "--k", "1")
    assert [row["parameter"] for row in rows] == ["k", "Re", "z_low", "z_high"]
    main(["dispersion", "shear", *base, "--k", "1", "-o", str(tmp_path / "one.nc")])
    with netcdf_file(tmp_path / "one.nc", mmap=False) as file:
        assert b"sha256" in file.profile
        assert b"standard error of the growth rate" in file.variables["data_error"].long_name


def test_maps_and_their_journals(capsys, tmp_path):
    z = np.linspace(-1, 1, 41)
    path = written(tmp_path / "table.csv", z, 1 - z**2, np.full(41, 1e-3))
    out = str(tmp_path / "map.json")
    base = ["shear", "--profile", path, "-o", out, "--quiet"]
    assert main(["map", *base, "--over", "Re=5e3,1e4", "--k", "1"]) == 0
    capsys.readouterr()
    found = json.loads((tmp_path / "map.json").read_text())
    assert all(row["data_error"] > 0 for row in found["rows"])
    flow = flows.Shear(path)
    first = flow.stated()
    written(tmp_path / "table.csv", z, 1.001 - z**2)
    assert flows.Shear(path).stated() != first
    assert flows.Shear(path) != flow
    assert flow.stated() == first  # read once
    capsys.readouterr()


def test_tables_are_values():
    flow = noisy(1, 41)
    again = pickle.loads(pickle.dumps(flow))
    assert (again, hash(again), repr(again)) == (flow, hash(flow), repr(flow))
    assert "sha256" in repr(flow)
    assert flow != noisy(2, 41)


@pytest.mark.parametrize(("text", "message"), [
    ("", "needs one column z in its header row"),
    ("z,V\n1,2\n", "needs one column U"),
    ("z,U,U\n1,2,3\n", "needs one column U"),
    ("z,U\n1,2\n3,4\n", r"a table needs 8 to 100000 points \(got 2\)"),
    ("z,U\n1,2\n3\n", "line 3: has 1 cells under 2 columns"),
    ("z,U\n1,two\n", r"line 2: U must be a number \(got 'two'\)"),
    ("z,U\n" + "1,2\n" * 9, r"line 3: z must rise \(or fall\) from row to row \(z = 1 is repeated\)"),
    ("z,U\n" + "".join(f"{z},{z}\n" for z in (0, 1, 2, 3, 2.5, 5, 6, 7)), r"line 6: z must .* \(z = 2.5 follows 3\)"),
    ("z,U\n" + "".join(f"{z},{'nan' if z == 4 else z}\n" for z in range(9)), "line 6: U must be a finite number"),
    ("z,U,U_error\n" + "".join(f"{z},{z},{-z}\n" for z in range(9)), "line 3: U_error must not be negative"),
    ("z,U,U_error\n" + "".join(f"{z},{z},{z}\n" for z in range(9)), "line 2: U_error is 0 here and not elsewhere"),
    ("z,U\n" + "".join(f"{z},1\n" for z in range(9)), "U is 1 at every z: there is no shear"),
    ("z;U\n1;2\n", "needs one column z"),
])
def test_tables_that_are_refused(text, message, tmp_path, capsys):
    path = tmp_path / "table.csv"
    path.write_text(text)
    with pytest.raises(ParameterError, match=message) as refusal:
        flows.Shear(str(path))
    assert "\n" not in str(refusal.value)
    assert main(["dispersion", "shear", "--profile", str(path), "--k", "1"]) == 2
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)


def test_other_files_and_arrays_that_are_refused(tmp_path):
    (tmp_path / "binary.csv").write_bytes(b"z,U\n\xff\xfe\x00")
    z = np.linspace(0, 1, 9)
    for given, message in ((str(tmp_path / "binary.csv"), "is no text in UTF-8"), (str(tmp_path), "cannot be read"),
                           (str(tmp_path / "none.csv"), "No such file"), ("\0", "must be the name of a file"),
                           ((z, z[:-1]), "arrays of one length"), ((z, ["a"] * 9), "U must be numbers")):
        with pytest.raises(ParameterError, match=message):
            flows.Shear(given)


@pytest.mark.parametrize(("arguments", "message"), [
    ({"z_low": -0.5}, "z_low = -0.5, but the table ends at -1; leave it out"),
    ({"top": "decay", "profile": "ramp"}, "far from where it seems to go .* a longer table is needed"),
])
def test_tables_that_do_not_fit_the_edges(arguments, message):
    z = np.linspace(-1, 1, 41)
    with pytest.raises(ParameterError, match=message):
        flows.Shear(**{"profile": (z, 1 - z**2), **arguments, **({"profile": (z, z)} if "top" in arguments else {})})
