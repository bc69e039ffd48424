"""Results are sequences of their rows, become tables of other packages, and come back from every file."""

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from test_record import RECORDS

from stability import ParameterError, dispersion, flows, load
from stability.cli import main
from stability.output.csv_text import read_csv
from stability.studies.map import parameter_map

MAPS = {"map": lambda: parameter_map(flows.Dune(), {"depth": [2.0, np.inf], "Re": [1.0, 10.0]}),
        "map of growth": lambda: parameter_map(flows.Dune(), {"Re": [1.0, 10.0]}, k=[0.5, 1.0, 2.0])}
MADE = {}


@pytest.fixture(params=[*RECORDS, *MAPS])
def record(request):
    name = request.param
    if name not in MADE:
        MADE[name] = {**RECORDS, **MAPS}[name]()
    return MADE[name]


@pytest.mark.parametrize("form", ["csv", "json", "netcdf"])
def test_what_is_written_comes_back(tmp_path, record, form):
    path = tmp_path / "result"  # known by its content
    getattr(record, f"to_{form}")(path)
    stored = load(path)
    assert stored == record
    assert record == stored
    assert stored.rows() == [{key: [list(pair) for pair in value] if isinstance(value, list) else value
                              for key, value in row.items()} for row in record.rows()]
    assert stored.header()["parameters"] == record.header()["parameters"]
    assert hash(stored) == hash(load(path))
    stored.to_csv(tmp_path / "again.csv")
    record.to_csv(tmp_path / "first.csv")
    assert load(tmp_path / "again.csv") == record
    assert repr(stored).startswith("Stored ")
    assert "<table>" in stored._repr_html_()


def test_a_last_digit_makes_another_result(tmp_path, record):
    """The twin that must differ: one number in the last place, a row less, another parameter."""
    record.to_json(tmp_path / "x.json")
    content = json.loads((tmp_path / "x.json").read_text())
    numbers = [(key, value) for key, value in content["rows"][0].items() if isinstance(value, float) and value]
    name, value = (numbers or [(None, None)])[0]
    twins = [{**content, "rows": content["rows"][1:] + content["rows"][:1] * 2}, {**content, "flow": "film2"}]
    if name:
        twins.append({**content, "rows": [{**content["rows"][0], name: np.nextafter(value, 9e99)},
                                          *content["rows"][1:]]})
    for twin in twins:
        (tmp_path / "y.json").write_text(json.dumps(twin))
        assert load(tmp_path / "y.json") != record


def test_a_stored_result_is_drawn_like_the_first(tmp_path, record):
    record.to_csv(tmp_path / "x.csv")
    axis, first = load(tmp_path / "x.csv").plot(Figure().subplots()), record.plot(Figure().subplots())
    if len(record) > 1:
        assert axis.get_xlabel() == first.get_xlabel()
        assert axis.get_ylabel() == first.get_ylabel()


def test_a_result_is_a_sequence_of_its_rows(record):
    rows = record.rows()
    assert (len(record), bool(record), list(record)) == (len(rows), True, rows)
    assert (record[0], record[-1], record[:1]) == (rows[0], rows[-1], rows[:1])
    name, values = next(iter(record.columns().items()))
    np.testing.assert_array_equal(record[name], values)
    with pytest.raises(KeyError, match="colour"):
        record["colour"]
    with pytest.raises(IndexError):
        record[len(rows)]
    html = record._repr_html_()
    assert html.count("<tr>") <= 1 + len(rows)
    assert f"<th>{next(iter(rows[0]))}</th>" in html


def test_a_long_table_is_short_in_a_notebook_and_its_texts_are_escaped():
    relation = dispersion(flows.Vortex(), np.geomspace(0.1, 1, 30))
    assert relation._repr_html_().count("<tr>") == 8
    lost = replace(relation, modes=(), lost=dict.fromkeys(relation.k.tolist(), "<why>"))
    assert "<why>" not in lost._repr_html_()


def test_pandas_and_xarray(record):
    pytest.importorskip("pandas")
    frame = record.to_pandas()
    assert list(frame) == list(record.rows()[0])
    assert frame["status"].tolist() == [row["status"] for row in record]
    assert frame.attrs["flow"] == record.flow.name
    pytest.importorskip("xarray")
    data = record.to_xarray()
    assert data.attrs["flow"] == record.flow.name
    assert data["status"].values.ravel().tolist() == [row["status"] for row in record]


@pytest.mark.parametrize("package", ["pandas", "xarray"])
def test_a_missing_package_is_named(monkeypatch, package):
    monkeypatch.setitem(sys.modules, package, None)
    relation = dispersion(flows.Vortex(), 1.0)
    with pytest.raises(ModuleNotFoundError, match=f"^to_{package}: {package} is not installed; install it with: pip "
                                                  f"install {package}$"):
        getattr(relation, f"to_{package}")()


def test_neither_is_imported_unasked():
    code = "import sys; from stability import *; print({'pandas', 'xarray', 'matplotlib'} & set(sys.modules))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True,
                          check=True).stdout == "set()\n"


@pytest.mark.parametrize("k", [np.ones((2, 2)), [[1.0, 2.0]], [[1.0], [2.0]]])
def test_wavenumbers_of_more_dimensions_are_refused(k):
    with pytest.raises(ParameterError, match=r"^k must be a number or a sequence of numbers \(got shape \(\d, \d\)\)"):
        dispersion(flows.Vortex(), k)


@pytest.mark.parametrize(("content", "complaint"), [
    (b"", "has no rows below the names"), (b"k,growth_rate\n1,2\n", "is no result: it has no lines `# flow"),
    (b"{}", "is no result: it has no flow and rows"), (b"{", "is no JSON"), (b"\xff\xfe", "neither text nor netCDF 3"),
])
def test_what_is_no_result_is_refused(tmp_path, content, complaint):
    path = tmp_path / "x"
    path.write_bytes(content)
    with pytest.raises(ParameterError, match=f"^load: .*{complaint}"):
        load(path)
    with pytest.raises(ParameterError, match="^load: cannot read .*No such file"):
        load(tmp_path / "nowhere")


def test_cells_become_what_all_of_a_column_are(tmp_path):
    path = tmp_path / "x.csv"
    path.write_text('# a: 1\n# b: inf\n# c: x: y\n\na, b ,c,d\n1,2,x,"[[1, 2]]"\n3,nan,,[]\n', encoding="utf-8-sig")
    assert read_csv(path, "x") == ({"a": 1, "b": float("inf"), "c": "x: y"},
                                   {"a": [1, 3], "b": [2.0, None], "c": ["x", ""], "d": [[[1, 2]], []]})


@pytest.mark.parametrize("ending", [".dat", ".5", ".png", ".xlsx", ".csv.gz", ".TSV"])
def test_endings_that_are_not_known_are_refused(tmp_path, capsys, ending):
    assert main(["dispersion", "vortex", "--k", "1", "-o", str(tmp_path / f"x{ending}")]) == 2
    assert "cannot be written; .csv, .json, .nc are known, .txt and no ending give a table" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_whole_numbers_stay_whole(tmp_path):
    path = tmp_path / "whole.csv"
    path.write_text("k,degree\n1.5,12\n2.5,14\n")
    assert [type(one) for one in read_csv(path, "x")[1]["degree"]] == [int, int]
