"""What results can do: print themselves, write themselves as the command line does, draw themselves."""

import json
import re
import subprocess
import sys
from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from results import BED, COMMANDS, OTHERS, RECORDS, made
from scipy.io import netcdf_file

import stability
from stability import ParameterError, __version__, dispersion, flows, k_max
from stability.cli import main
from stability.modes.short_waves import well_posedness
from stability.studies.critical import NeutralPoint, NeutralSweep, critical
from stability.studies.kmax import Optima, k_max_sweep
from stability.studies.map import parameter_map
from stability.studies.wellposed import growth_with_degree


@pytest.fixture(scope="module")
def record():
    """The records by name, each made once."""
    return made


@pytest.mark.parametrize("name", COMMANDS)
@pytest.mark.parametrize("form", ["csv", "json"])
def test_files_are_those_of_the_command_line(tmp_path, capsys, record, name, form):
    target = tmp_path / f"a b é {name}.{form}"
    getattr(record(name), f"to_{form}")(target)
    main([*COMMANDS[name].split(), f"--{form}", "--quiet"])
    assert target.read_text(encoding="utf-8") == capsys.readouterr().out
    assert list(tmp_path.iterdir()) == [target]


class BytesPath:
    def __fspath__(self):
        return b"x"

    def __repr__(self):
        return "BytesPath()"


@pytest.mark.parametrize("path", [None, b"x.csv", 5, ["x"], "", "a\0b", "\ud800", BytesPath(), 1.5, True], ids=repr)
@pytest.mark.parametrize("method", ["to_csv", "to_json", "to_netcdf"])
def test_what_is_no_name_of_a_file_is_refused(tmp_path, monkeypatch, record, method, path):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ParameterError, match=rf"^{method}: path must be the name of a file \(got ") as refusal:
        getattr(record("dispersion"), method)(path)
    assert str(refusal.value).endswith(f"(got {path!r})")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("method", ["to_csv", "to_json", "to_netcdf"])
def test_a_file_that_cannot_be_written_is_named(tmp_path, record, method):
    for path, why in ((tmp_path, "it is a directory"), (tmp_path / "x" / "y", "No such file or directory"),
                      (tmp_path / ("x" * 300), "File name too long")):
        with pytest.raises(ParameterError, match=re.escape(f"{method}: cannot write {str(path)!r}: {why}")):
            getattr(record("dispersion"), method)(path)


@pytest.mark.parametrize("name", RECORDS)
def test_netcdf_holds_every_number_of_the_rows(tmp_path, record, name):
    target, one = tmp_path / "é ü.nc", record(name)
    one.to_netcdf(str(target))
    with netcdf_file(target, mmap=False) as file:
        assert file.flow.decode() == one.flow.name
        assert file.version.decode() == __version__
        assert b"exp(i k x + sigma t)" in file.convention
        for parameter, value in one.header()["parameters"].items():
            stored = getattr(file, parameter)
            assert (stored.decode() if isinstance(value, str) else float(stored)) == value
        assert not any(hasattr(file, name) for name in one.swept if name)
        for setting, value in one.settings.items():
            stored = getattr(file, {"mode": "mode_followed"}.get(setting, setting))
            assert (stored.decode() if isinstance(value, str) else float(stored)) == value
        assert {"tolerance", "max_degree"} <= one.settings.keys()
        for column in one.rows()[0].keys() - {"maxima"}:
            variable = file.variables[column]
            assert variable.long_name
            assert variable.dimensions[0] == one.dimension
            values = [row[column] for row in one.rows()]
            if isinstance(values[0], str):
                assert [b"".join(text).rstrip(b"\0").decode() for text in variable[:]] == values
            else:
                assert variable.units == b"1"
                np.testing.assert_array_equal(variable[:], [np.nan if value is None else value for value in values])


def test_netcdf_of_a_dispersion_relation_has_complex_numbers_in_two_parts(tmp_path, record):
    one = record("dispersion")
    one.to_netcdf(tmp_path / "x.nc")
    with netcdf_file(tmp_path / "x.nc", mmap=False) as file:
        assert file.variables["k"].dimensions == ("k",)
        assert file.mode_followed == b"surface"
        for name in ("sigma", "slope"):
            parts = [file.variables[f"{name}_{part}"][:] for part in ("real", "imag")]
            np.testing.assert_array_equal(parts[0] + 1j * parts[1], getattr(one, name))


def test_netcdf_of_a_sweep_has_all_maxima(tmp_path):
    flow = flows.Dune(shields=3.0, Re=0.01)
    found = Optima(flow, "Re", tuple(k_max_sweep([flow, replace(flow, Re=10.0)])))
    found.to_netcdf(tmp_path / "x.nc")
    with netcdf_file(tmp_path / "x.nc", mmap=False) as file:
        assert file.variables["maxima_k"].dimensions == ("Re", "maximum")
        first, second = file.variables["maxima_k"][:]
    assert first.tolist() == [one.k for one in found.optima[0].maxima]
    assert (second[0], np.isnan(second[1])) == (found.optima[1].k_max, True)


def test_netcdf_opens_in_xarray(tmp_path, record):
    xarray = pytest.importorskip("xarray")
    one = record("dispersion")
    one.to_netcdf(tmp_path / "x.nc")
    with xarray.open_dataset(tmp_path / "x.nc", engine="scipy") as data:
        assert data.growth_rate.sel(k=3.0) == one.growth_rate[2]
        assert data.status.values.tolist() == ["resolved"] * 3
        assert float(data.attrs["mu1"]) == 0.4
        assert data.k.attrs == {"long_name": "wavenumber", "units": "1"}


@pytest.mark.parametrize("form", ["csv", "json", "netcdf"])
def test_what_cannot_be_written_says_so_and_leaves_nothing(tmp_path, record, form):
    with pytest.raises(ParameterError, match=f"to_{form}: cannot write .*nowhere"):
        getattr(record("optimum"), f"to_{form}")(tmp_path / "nowhere" / "x")
    (tmp_path / "taken").mkdir()
    with pytest.raises(ParameterError, match="it is a directory"):
        getattr(record("optimum"), f"to_{form}")(tmp_path / "taken")
    assert [path.name for path in tmp_path.iterdir()] == ["taken"]


def test_repr_is_a_short_table():
    lines = repr(dispersion(BED, np.geomspace(0.01, 10, 200))).splitlines()
    assert lines[0] == f"DispersionRelation of {BED}, mode surface: 200 of 200 resolved"
    assert lines[1].split() == ["k", "growth_rate", "phase_speed", "error", "group_speed", "group_error", "degree",
                                             "status"]
    assert [line.split()[0] for line in lines[2:]] == ["0.01", "0.01035321843", "0.01071891319", "0.01109752496", "...",
                                                       "9.658832241", "10"]


@pytest.mark.parametrize("name", RECORDS)
def test_repr_counts_what_is_resolved(record, name):
    text, rows = repr(record(name)), record(name).rows()
    good, stable = (sum(row["status"].startswith(start) for row in rows) for start in ("resolved", "stable"))
    assert text.splitlines()[0].endswith(f": {good} of {len(rows)} resolved" + (f", {stable} stable" if stable else ""))
    assert len(text.splitlines()) == 2 + len(rows)


@pytest.mark.parametrize("name", RECORDS)
def test_every_record_draws_into_given_axes_or_new_ones(record, name):
    from matplotlib import pyplot

    axis = Figure().subplots()
    assert record(name).plot(axis) is axis
    new = record(name).plot()
    assert new.figure.number in pyplot.get_fignums()
    pyplot.close(new.figure)
    assert new.get_ylabel() == axis.get_ylabel()


def test_a_relation_is_drawn_in_the_order_of_k(record):
    axis = Figure().subplots()
    one = record("dispersion")
    one.plot(axis, "phase_speed")
    k, speed = axis.lines[-1].get_data()
    assert k.tolist() == [0.01, 1.0, 3.0]
    assert speed.tolist() == [one.phase_speed[i] for i in (1, 0, 2)]
    with pytest.raises(ParameterError, match="quantity must be one of growth_rate, phase_speed"):
        one.plot(axis, "colour")


@pytest.mark.parametrize(("name", "words"), [("critical", "critical film --slope-deg 45 --vary Re --json"),
                                            ("no critical", "critical vortex --vary slope_deg --json")])
def test_a_neutral_point_has_the_row_of_the_verb_critical(tmp_path, capsys, record, name, words):
    main(words.split())
    target = tmp_path / "x.json"
    record(name).to_json(target)
    assert json.loads(capsys.readouterr().out)["rows"] == json.loads(target.read_text())["rows"]


def test_a_neutral_point_is_marked_on_its_curve(record):
    axis = record("neutral").plot(Figure().subplots())
    before = axis.get_xlabel(), axis.get_ylabel()
    point = critical(flows.Poiseuille(), "Re")
    assert point.plot(axis) is axis
    assert (axis.get_xlabel(), axis.get_ylabel()) == before
    (x,), (y,) = axis.lines[-1].get_data()
    assert (x, y) == (point.k, point.value)


def test_what_belongs_to_infinity_is_a_level_beside_the_line():
    beds = [replace(BED, depth=depth) for depth in (2.0, np.inf, 20.0)]
    points = tuple(NeutralPoint(bed, "Re", 0.2, value, 0.1, 0.0, 0.0, "resolved")
                   for bed, value in zip(beds, (1.0, 3.0, 2.0), strict=True))
    for found, levels in ((NeutralSweep(BED, "Re", "depth", points), [3.0]),
                          (NeutralSweep(BED, "Re", "depth", points[::2]), []),
                          (NeutralSweep(BED, "Re", "depth", points[1:2]), [3.0]),
                          (Optima(BED, "depth", tuple(k_max_sweep(beds))), [k_max(BED).k_max])):
        axis = found.plot(Figure().subplots())
        lines = [line for line in axis.lines if len(line.get_xdata()) and list(line.get_xdata()) != [0, 1]]
        assert [line.get_ydata()[0] for line in axis.lines if list(line.get_xdata()) == [0, 1]] == levels
        assert all(np.isfinite(line.get_xdata()).all() for line in lines)
        assert bool(axis.get_legend()) == bool(levels)


@pytest.mark.parametrize("k", [1.0, [1.0], (1,), np.array([1.0]), np.float64(1.0)])
def test_wavenumbers_of_any_kind(k):
    assert dispersion(flows.Vortex(), k).k.tolist() == [1.0]


def test_lost_wavenumbers_keep_their_place_among_the_rows(record, tmp_path):
    one = record("dispersion")
    part = replace(one, modes=one.modes[1:], lost={1.0: "why"})
    assert [(row["k"], row["growth_rate"] is None, row["status"]) for row in part.rows()] == [
        (1.0, True, "lost"), (0.01, False, "resolved"), (3.0, False, "resolved")]
    assert part.notes() == ["why"]
    assert np.isnan(part.columns()["sigma"]).tolist() == [True, False, False]
    part.to_netcdf(tmp_path / "x.nc")


def test_no_wavenumber_is_refused():
    with pytest.raises(ParameterError, match="k: give at least one wavenumber"):
        dispersion(flows.Vortex(), [])


def test_results_do_without_heavy_packages():
    heavy = ["sympy", "matplotlib", "scipy.special", "scipy.integrate", "scipy.io"]
    code = ("import sys; from stability import dispersion, flows; m = dispersion(flows.Vortex(), 1.0); repr(m); "
            f"m.modes[0].fields(0.5); m.modes[0].sensitivity(); "
            f"print([name for name in {heavy} if name in sys.modules])")
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"


@pytest.mark.parametrize("name", [*RECORDS, *OTHERS])
def test_records_of_the_same_numbers_are_equal(record, name):
    one = record(name)
    again = deepcopy(one)
    assert one == again
    assert {one: 1}[again] == 1


@pytest.mark.parametrize(("name", "change"), [("mode", {"error": 1.0}), ("dispersion", {"lost": {1.0: "why"}}),
                                              ("neutral", {"points": ()}), ("spectrum", {"k": 3.0}),
                                              ("continuation", {"lost": {}}), ("map", {"table": ()})])
def test_records_of_other_numbers_are_not(record, name, change):
    assert record(name) != replace(record(name), **change)


def test_records_of_arrays_alone_are_equal_to_themselves():
    fields = dispersion(BED, 1.0).modes[0].fields([-0.5, 0.0])
    for one in (fields, well_posedness(BED), growth_with_degree(BED, [1.0])[0]):
        assert one == one  # noqa: PLR0124
        assert one != deepcopy(one)
        assert {one: 1}[one] == 1


@pytest.mark.parametrize("name", ["dispersion", "spectrum"])
def test_columns_of_the_table_are_attributes(record, name):
    one = record(name)
    for column in ("growth_rate", "phase_speed", "error", "status"):
        assert list(getattr(one, column)) == [row[column] for row in one.rows()]


def test_the_package_offers_what_it_lists():
    """Some of it is imported only when asked for, so that the rest starts sooner."""
    late = ["stability.studies.map", "stability.studies.critical", "stability.studies.sensitivity", "multiprocessing"]
    code = (f"import sys, stability; print([name for name in {late} if name in sys.modules]); "
            "print(all(callable(getattr(stability, name)) for name in stability.__all__ if name != 'flows'))")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\nTrue\n"
    assert set(stability.__all__) <= set(dir(stability))
    assert stability.parameter_map is parameter_map
    with pytest.raises(AttributeError, match="^module 'stability' has no attribute 'speed'$"):
        stability.speed  # noqa: B018


def test_rows_are_json(record):
    for name in RECORDS:
        json.dumps(record(name).rows())
