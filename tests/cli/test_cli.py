"""The command line as a user meets it: output, files, exit status, and one clear line for bad input."""

import csv
import io
import json
import os
import re
import signal
import subprocess
import sys
import time
from importlib.metadata import entry_points

import pytest
from scipy.io import netcdf_file

from stability import __version__, dispersion, flows
from stability.cli import main
from stability.cli.verbs import VERBS

FULL = "/dev/full"
COLUMNS = ["k", "growth_rate", "phase_speed", "error", "group_speed", "group_error", "degree", "status"]
SLOW = {"map", "compare", "explore"}  # verbs whose examples take long


def run(capsys, *arguments):
    status = main(list(arguments))
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def test_dispersion_as_json(capsys):
    status, out, err = run(capsys, "dispersion", "vortex", "--k", "0.5,2", "--Fr2", "0.2", "--json")
    result = json.loads(out)
    assert (status, err) == (0, "")
    assert {key: result[key] for key in ("flow", "parameters", "method", "version")} == {
        "flow": "vortex", "parameters": {"slope_deg": 30.0, "Fr2": 0.2}, "method": "collocation",
        "version": __version__}
    expected = dispersion(flows.Vortex(Fr2=0.2), [0.5, 2.0])
    assert [row["growth_rate"] for row in result["rows"]] == expected.growth_rate.tolist()  # floats round-trip
    assert list(result["rows"][0]) == COLUMNS


def test_csv_carries_the_parameters_in_comments(capsys):
    _, out, _ = run(capsys, "dispersion", "dune", "--k", "1:2:3:lin", "--depth", "5", "--csv")
    comments = [line for line in out.splitlines() if line.startswith("#")]
    assert "# flow: dune" in comments
    assert "# depth: 5.0" in comments
    rows = list(csv.DictReader(io.StringIO("\n".join(line for line in out.splitlines() if line not in comments))))
    assert [row["k"] for row in rows] == ["1.0", "1.5", "2.0"]
    assert {row["status"] for row in rows} == {"resolved"}


def test_tables_are_aligned(capsys):
    _, out, _ = run(capsys, "dispersion", "dune", "--k", "1,10")
    assert out.splitlines()[0].split() == COLUMNS
    assert len({line.index("resolved") for line in out.splitlines()[1:]}) == 1


def test_an_infinite_depth_is_a_string_in_json(capsys):
    _, out, _ = run(capsys, "spectrum", "dune", "--k", "1", "--modes", "1", "--json")
    assert json.loads(out, parse_constant=pytest.fail)["parameters"]["depth"] == "inf"


def test_kmax_lists_all_maxima(capsys):
    status, out, _ = run(capsys, "kmax", "dune", "--shields", "3", "--over", "Re=0.01,10", "--json")
    rows = json.loads(out)["rows"]
    assert status == 0
    assert [row["Re"] for row in rows] == [0.01, 10.0]
    assert len(rows[0]["maxima"]) == 2
    assert rows[0]["maxima"][0] == [rows[0]["k_max"], rows[0]["growth_rate"]]


def test_kmax_of_a_stable_flow_says_so(capsys):
    status, out, err = run(capsys, "kmax", "vortex", "--over", "slope-deg=20:40:2", "--json")
    assert (status, err) == (0, "")
    assert [row["k_max"] for row in json.loads(out)["rows"]] == [None, None]
    assert {row["status"] for row in json.loads(out)["rows"]} == {"stable: no waves grow for k up to 100"}


def test_collisions_are_reported(capsys):
    status, _, err = run(capsys, "dispersion", "vortex", "--Fr2", "5", "--k", "0.1:10:5")
    assert status == 0
    assert err.count("two modes collide at k = ") == 2


def test_flows_lists_parameters_ranges_and_scales(capsys):
    _, out, _ = run(capsys, "flows", "dune")
    assert "--shields  2.0" in out
    assert "(1, inf)" in out
    assert "length: grain diameter d" in out


# -- help -----------------------------------------------------------------------------------------------


def helped(capsys, *arguments):
    with pytest.raises(SystemExit) as ended:
        main([*arguments, "--help"])
    assert ended.value.code == 0
    return capsys.readouterr().out


@pytest.mark.parametrize("verb", VERBS)
def test_help_has_an_example_that_works(tmp_path, capsys, monkeypatch, verb):
    text = helped(capsys, verb)
    options, _, columns = text.partition("columns:\n")
    assert len(options.splitlines()) < 50
    assert len(columns.splitlines()) < 20
    (example,) = re.findall("^example: stability (.*)$", text, re.MULTILINE)
    assert example.split()[0] == verb
    monkeypatch.chdir(tmp_path)
    if verb not in SLOW:
        assert run(capsys, *example.split())[0] in (0, 3)


def test_help_lists_the_parameters_of_the_flow_that_is_named(capsys):
    general, dune, film = (helped(capsys, "kmax", *flow) for flow in ((), ("dune",), ("film",)))
    assert "--shields" not in general
    assert "stability kmax FLOW --help" in general
    assert "--shields" in dune
    assert "Reynolds number of the fluid on the grain scale" in " ".join(dune.split())
    assert "--shields" not in film
    assert "Reynolds number of depth and surface speed" in " ".join(film.split())


def test_parameters_are_spelled_either_way(capsys):
    for spelling in ("--slope-deg", "--slope_deg"):
        status, out, _ = run(capsys, "dispersion", "vortex", "--k", "1", spelling, "25", "--csv")
        assert (status, "# slope_deg: 25.0" in out) == (0, True)
    assert "slope_deg" not in helped(capsys, "dispersion", "vortex")


def test_flags_may_be_repeated(capsys):
    assert run(capsys, "dispersion", "vortex", "--k", "1", "--csv", "--csv", "--quiet", "--quiet")[0] == 0


def test_a_nearby_parameter_is_suggested(capsys):
    status, _, err = run(capsys, "dispersion", "dune", "--k", "1", "--shield=3")
    assert status == 2
    assert "unknown option '--shield=3' (did you mean '--shields'?)" in err


# -- bad input ------------------------------------------------------------------------------------------


BAD = [
    (("kmax", "dune", "--over", "Re=1,2", "--over", "shields=2"),
     "--over: given twice, with 'Re=1,2' and 'shields=2'; join values with commas, and sweep several parameters with: "
     "stability map"),
    (("dispersion", "dune", "--k", "1", "--k", "2"), "--k: given twice, with '1' and '2'; join values with commas"),
    (("kmax", "dune", "--Re", "5", "--Re", "50"),
     "--Re: given twice, with '5' and '50'; sweep it with: --over Re=5,50"),
    (("dispersion", "vortex", "--k", "1", "--slope_deg", "20", "--slope-deg=30"),
     "--slope-deg: given twice, with '20' and '30'; sweep it with: --each slope_deg=20,30"),
    (("dispersion", "dune", "--k", "1", "--fluid", "layer", "--fluid", "layer"),
     "--fluid: given twice, with 'layer' and 'layer'; give it once"),
    (("compare", "vortex", "--k", "1", "--k", "2"), "--k: given twice, with '1' and '2'; give it once"),
    *(((*question, option, "1", option, "2"), f"{option}: given twice, with '1' and '2'; give it once")
      for question, options in ((("dispersion", "dune", "--k", "1"), ("-o", "--plot", "--mode", "--tolerance")),
                                (("critical", "film"), ("--vary", "--max-degree")),
                                (("map", "film", "--over", "We=1"), ("--workers", "--quantity")))
      for option in options),
    (("compare", "vortex", "--k", "1", "--tolerance", "1e-9"), "unknown option '--tolerance'"),
    (("wellposed", "dune", "--max-degree", "64"), "unknown option '--max-degree'"),
    (("dispersion", "dune", "--k", "1", "--method", "bvp", "--max-degree", "512"),
     "--max-degree: --method bvp does not use it"),
    (("kmax", "vortex", "--method", "bvp-thesis", "--tolerance", "1e-10"),
     "--tolerance: --method bvp-thesis does not use it"),
    (("dispersion", "vortex", "--k", "1", "--method", "bvp-thesis", "--delta", "0.01,0.02"),
     "--delta: one value at a time (got 2)"),
    (("dispersion", "dune", "--k", "1", "-o", "x.png", "--plot", "./x.png"), "--plot: './x.png' is the file of -o too"),
    (("dispersion", "dune", "--k", "1", "--csv", "-o", "x.json"), "-o: --csv contradicts the ending of 'x.json'"),
    (("spectrum", "dune", "--k", "1", "--json", "-o", "x.nc"), "-o: --json contradicts the ending of 'x.nc'"),
    (("kmax", "poiseuille", "--mode", "surface"), "poiseuille has no slow surface mode"),
    (("kmax", "poiseuille", "--mode", "fastest"), "--mode: must be one of surface, leading (got 'fastest')"),
    (("kmax", "dune", "--search", "1"), "--search: give a range (low, high)"),
    (("kmax", "dune", "--search", "1:2", "--method", "bvp"), "--search: --method bvp does not use it"),
    (("critical", "film", "--vary", "Re", "--range", "5:1"), "--range: give a range (low, high)"),
    (("kmax", "couette", "--method", "bvp"), "couette has no slow surface mode, the one that is continued"),
    (("critical", "dune", "--vary", "depth"), "dune: depth = inf cannot be varied; start from a finite depth"),
    (("neutral", "dune", "--vary", "depth", "--over", "Re=1,2"), "dune: depth = inf cannot be varied"),
    (("kmax", "dune", "--over", "Re=1,inf"), "--over Re: not a finite number: 'inf'"),
    (("flows", "vrtex"), "unknown flow 'vrtex' (did you mean 'vortex'?)"),
    (("dispersion", "vrtex", "--k", "1"), "unknown flow 'vrtex'"),
    (("dispersion", "dune", "--Rex", "3", "--k", "1"), "unknown option '--Rex'"),
    (("dispersion", "vortex", "--shields", "2", "--k", "1"),
     "unknown option '--shields'"),
    (("dispersion", "dune", "--shields", "0.8", "--k", "1"),
     "shields must lie in (1, inf): at or below 1 the bed does not yield (got 0.8)"),
    (("dispersion", "dune", "--Re", "-1", "--k", "1"), "Re must lie in (0, inf) (got -1)"),
    (("dispersion", "dune", "--Re", "nan", "--k", "1"), "Re must lie in (0, inf) (got nan)"),
    (("dispersion", "dune", "--Re", "many", "--k", "1"), "Re must be a number in (0, inf) (got 'many')"),
    (("dispersion", "dune", "--fluid", "water", "--k", "1"), "fluid must be one of closed-form, layer (got 'water')"),
    (("dispersion", "vortex", "--slope-deg", "95", "--k", "1"), "slope_deg must lie in (0, 90) (got 95)"),
    (("dispersion", "dune", "--k", "0"), "--k: values must be positive (got 0)"),
    (("dispersion", "dune", "--k", "1:0:5"), "--k: a range must rise, a < b (got '1:0:5')"),
    (("dispersion", "dune", "--k", "0:1:5"), "a logarithmic range starts above 0"),
    (("dispersion", "dune", "--k", "1:2:1"), "number of points must be an integer from 2"),
    (("dispersion", "dune", "--k", "1:2:3:log"), "a range is a:b:n or a:b:n:lin"),
    (("dispersion", "dune", "--k", "abc"), "--k: not a finite number: 'abc'"),
    (("dispersion", "dune", "--k", "nan"), "--k: not a finite number: 'nan'"),
    (("dispersion", "dune"), "required: --k"),
    (("dispersion", "dune", "--k", "1", "--mode", "fast"), "--mode: must be one of surface, leading, most-unstable"),
    (("dispersion", "dune", "--k", "1", "--tolerance", "2"), "--tolerance: must lie in [1e-15, 0.1] (got 2)"),
    (("dispersion", "dune", "--k", "1", "--max-degree", "3"), "--max-degree: must be an integer from 8"),
    (("spectrum", "dune", "--k", "1", "--modes", "0"), "--modes: must be an integer from 1"),
    (("kmax", "dune", "--over", "Rex=1:2:3"), "--over: dune has no parameter 'Rex' (did you mean 'Re'?)"),
    (("kmax", "dune", "--over", "shields=0.5:2:3"), "shields must lie in (1, inf)"),
    (("dispersion", "dune", "--k", "1", "--plot", "x.gif"), "--plot: the file must end in .png, .pdf, .svg"),
    (("dispersion", "dune", "--k", "1", "-o", "/nowhere/x.csv"), "-o: cannot write '/nowhere/x.csv'"),
    (("dispersion", "dune", "--k", "1", "--plot", "/nowhere/x.png"), "--plot: cannot write '/nowhere/x.png'"),
    (("dispersion", "dune", "--k", "1", "-o", ""), "-o: path must be the name of a file (got '')"),
    (("dispersion", "dune", "--k", "1", "-o", "a\0b"), "-o: path must be the name of a file (got 'a\\x00b')"),
    (("dispersion", "dune", "--k", "1", "-o", "/"), "-o: cannot write '/': it is a directory"),
    (("dispersion", "dune", "--k", "1", "-o", "x" * 300), "File name too long"),
    (("dispersion", "dune", "--k", "1", "--plot", ""), "--plot: the file must end in .png, .pdf, .svg (got '')"),
    (("dispersion", "dune", "--k", "1", "--plot", "\0.png"), "--plot: path must be the name of a file (got "),
    (("map", "dune", "--over", "Re=1,2", "-o", "a\0.csv"), "-o: path must be the name of a file"),
    (("map", "dune", "--over", "Re=1,2", "-o", ""), "-o: the file must end in .csv, .json, .nc"),
    *((("dispersion", "dune", "--k", "1", *form, "-o", f"x{ending}"), f"-o: {ending.lower()} cannot be written; .csv, "
       f".json, .nc are known, .txt and no ending give a table (got 'x{ending}')")
      for form, ending in (([], ".xlsx"), ([], ".h5"), ([], ".npz"), ([], ".PNG"), (["--csv"], ".parquet"))),
    ((), "required: VERB"),
    (("dance",), "unknown verb 'dance'"),
]


@pytest.mark.parametrize(("arguments", "line"), BAD, ids=[" ".join(arguments) or "nothing" for arguments, _ in BAD])
def test_bad_input_gets_one_clear_line(capsys, arguments, line):
    status, out, err = run(capsys, *arguments)
    assert (status, out) == (2, "")
    assert err.count("\n") == 1
    assert line in err


def test_unresolved_rows_are_marked_and_the_exit_status_tells(capsys):
    status, out, err = run(capsys, "dispersion", "dune", "--shields", "3", "--k", "0.01,8", "--max-degree", "14",
                           "--json")
    assert status == 3
    assert [row["status"] == "resolved" for row in json.loads(out)["rows"]] == [True, False]
    assert "1 of 2 rows are not resolved" in err


def test_files_are_written_whole(tmp_path, capsys):
    target, picture = tmp_path / "a b é.json", tmp_path / "p.svg"
    status, out, _ = run(capsys, "dispersion", "vortex", "--k", "1:2:3", "--json", "-o", str(target),
                         "--plot", str(picture))
    assert (status, out) == (0, "")
    assert len(json.loads(target.read_text())["rows"]) == 3
    assert picture.read_text().rstrip().endswith("</svg>")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a b é.json", "p.svg"]


def test_the_ending_of_a_file_gives_its_form(tmp_path, capsys):
    for name, start in (("a.csv", "# flow: vortex"), ("a.json", "{"), ("a.txt", "k  "), ("a", "k  "),
                        ("A.CSV", "# flow: vortex")):
        assert run(capsys, "dispersion", "vortex", "--k", "1", "-o", str(tmp_path / name))[0] == 0
        assert (tmp_path / name).read_text().startswith(start)
    assert run(capsys, "dispersion", "vortex", "--k", "1", "--json", "-o", str(tmp_path / "a.txt"))[0] == 0
    assert (tmp_path / "a.txt").read_text().startswith("{")


NETCDF = {
    "dispersion vortex --k 1,2": ("k", 2), "spectrum vortex --k 1 --modes 3": ("mode", 3),
    "spectrum vortex --k 1,2 --modes 3": ("mode", 6), "kmax dune --over depth=2,inf": ("depth", 2),
    "neutral film --vary Re --over We=0,1": ("We", 2), "neutral film --vary Re --k 0.1,0.2": ("point", 2),
    "critical film --vary Re": ("point", 2), "sensitivity vortex --k 1": ("parameter", 3),
    "wellposed vortex --points 5": ("point", 5), "wellposed vortex --k 1,2": ("k", 2),
}


@pytest.mark.parametrize("question", NETCDF)
def test_every_verb_writes_netcdf(tmp_path, capsys, question):
    target, (dimension, length) = tmp_path / "x.nc", NETCDF[question]
    assert run(capsys, *question.split(), "-o", str(target), "--quiet")[0] == 0
    rows = json.loads(run(capsys, *question.split(), "--json", "--quiet")[1])["rows"]
    with netcdf_file(target, mmap=False) as file:
        assert file.dimensions[dimension] == length == len(rows)
        name = next(name for name, value in rows[0].items() if isinstance(value, float))
        assert file.variables[name][:].tolist() == [float(row[name]) for row in rows]


FIXED = {"shields": 2.0, "mu1": 0.4, "b": 1.0, "depth": "inf", "fluid": "closed-form"}
USUAL = {"tolerance": 1e-10, "max_degree": 512}
PROVENANCE = {
    "dispersion vortex --k 1": {"mode": "surface", **USUAL},
    "dispersion vortex --k 1 --mode most-unstable --tolerance 1e-6 --max-degree 64": {
        "mode": "most-unstable", "tolerance": 1e-6, "max_degree": 64},
    "dispersion poiseuille --k 1": {"mode": "leading", **USUAL},
    "dispersion vortex --k 1 --method bvp --tolerance 1e-6": {"method": "bvp", "tolerance": 1e-6, "max_degree": None},
    "dispersion vortex --k 1 --method bvp-thesis": {"residual": 1e-3, "delta": 0.01, "tolerance": None},
    "dispersion vortex --k 1 --method bvp-thesis --delta 0.02": {"residual": 1e-3, "delta": 0.02},
    "kmax dune --over Re=1,2": {"parameters": FIXED, "over": "Re", **USUAL},
    "kmax dune --method bvp-thesis --depth 5": {"residual": 1e-3, "delta": None},
    "spectrum vortex --k 1,2 --modes 1 --max-degree 64": {"tolerance": 1e-10, "max_degree": 64},
    "critical film --vary Re": {"parameters": {"slope_deg": 30.0, "We": 0.0}, "vary": "Re", "long_wave": None, **USUAL},
    "critical film --vary Re --long-wave": {"long_wave": "yes"},
    "neutral poiseuille --vary Re --k 1": {"parameters": {}, "vary": "Re", **USUAL},
    "neutral film --vary Re --over We=1,2": {"parameters": {"slope_deg": 30.0}, "vary": "Re", "over": "We", **USUAL},
    "sensitivity vortex --k 1 --tolerance 1e-8": {"k": 1.0, "mode": "surface", "tolerance": 1e-8, "max_degree": 512},
}


@pytest.mark.parametrize("question", PROVENANCE)
def test_headers_say_how_a_result_came_about(tmp_path, capsys, question):
    """In every form; None stands for what is not there."""
    said = PROVENANCE[question]
    header = json.loads(run(capsys, *question.split(), "--json", "--quiet")[1])
    assert {name: header.get(name) for name in said} == said
    lines = [line for line in run(capsys, *question.split(), "--csv", "--quiet")[1].splitlines() if line[0] == "#"]
    comments = dict(line[2:].split(": ") for line in lines)
    assert len(comments) == len(lines)
    del header["rows"]
    expected = {**header, **header.pop("parameters")}
    assert comments == {name: str(value) for name, value in expected.items() if name not in ("notes", "parameters")}


@pytest.mark.parametrize("name", ["a b \u00e9.csv", "\u6c99" * 83 + ".csv", "x" * 251 + ".csv", "\u6c99" * 80])
def test_any_name_that_the_system_takes(tmp_path, capsys, name):
    folder = tmp_path / "\u6c99 dunes"
    folder.mkdir()
    picture = folder / (name.partition(".")[0][:60] + ".png")
    status, _, err = run(capsys, "dispersion", "vortex", "--k", "1,2", "-o", str(folder / name), "--plot", str(picture))
    assert (status, err) == (0, "")
    dispersion(flows.Vortex(), [1.0]).to_netcdf(folder / name)
    assert not [path for path in folder.iterdir() if path.name.startswith(".")]
    assert picture.stat().st_size > 4000


def test_a_link_stays_a_link(tmp_path, capsys):
    (tmp_path / "far").mkdir()
    target, link = tmp_path / "far" / "target.csv", tmp_path / "link.csv"
    link.symlink_to(target)
    assert run(capsys, "dispersion", "vortex", "--k", "1", "-o", str(link))[0] == 0
    assert link.is_symlink()
    assert target.read_text().startswith("# flow: vortex")


def test_a_device_is_written_to_and_not_replaced(tmp_path, capsys):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)  # a test that fails must not wait
    process = stability("dispersion", "vortex", "--k", "1", "-o", str(pipe))
    assert process.communicate(timeout=60)[1] == ""
    assert process.returncode == 0
    assert pipe.is_fifo()
    assert os.read(reader, 1000).startswith(b"k ")
    os.close(reader)


@pytest.mark.skipif(not os.path.exists(FULL), reason="needs /dev/full")
def test_a_result_that_fits_in_no_file_goes_to_standard_output(capsys):
    status, out, err = run(capsys, "dispersion", "vortex", "--k", "1", "-o", FULL)
    assert status == 2
    assert out.splitlines()[1].endswith("resolved")
    assert err == f"stability: -o: cannot write '{FULL}': No space left on device\n"


def test_a_failing_picture_does_not_take_the_numbers_with_it(tmp_path, capsys, monkeypatch):
    def no_space(result, path, look):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("stability.output.plots.draw", no_space)
    target, picture = tmp_path / "a.csv", tmp_path / "a.png"
    status, _, err = run(capsys, "dispersion", "vortex", "--k", "1", "-o", str(target), "--plot", str(picture))
    assert (status, err) == (2, f"stability: --plot: cannot write '{picture}': No space left on device\n")
    assert [path.name for path in tmp_path.iterdir()] == ["a.csv"]
    assert "resolved" in target.read_text()


@pytest.mark.parametrize("ending", ["png", "pdf", "svg"])
@pytest.mark.parametrize("question", [("dispersion", "dune", "--k", "0.1:3:5"), ("spectrum", "vortex", "--k", "1,2"),
                                      ("kmax", "dune", "--over", "Re=1:100:3"),
                                      ("kmax", "dune", "--over", "depth=2,20,inf"), ("kmax", "dune", "--depth", "inf"),
                                      ("kmax", "dune", "--over", "depth=inf"), ("critical", "film", "--vary", "Re"),
                                      ("neutral", "film", "--vary", "Re", "--over", "We=0,1")])
def test_every_verb_draws(tmp_path, capsys, question, ending):
    picture = tmp_path / f"figure.{ending}"
    assert run(capsys, *question, "--plot", str(picture), "--quiet")[0] == 0
    assert picture.stat().st_size > 4000


def test_an_interrupted_run_leaves_the_old_file(tmp_path, capsys, monkeypatch):
    target = tmp_path / "kept.csv"
    target.write_text("old")

    def interrupt(*arguments, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr("stability.modes.branch.Branch.at", interrupt)
    status, _, err = run(capsys, "dispersion", "vortex", "--k", "1", "-o", str(target))
    assert (status, err) == (130, "stability: interrupted\n")
    assert [path.read_text() for path in tmp_path.iterdir()] == ["old"]


SWEEPS = [
    ("dispersion", "dune", "--k", "4,1,2,3"),
    ("dispersion", "vortex", "--k", "1,2,3,4", "--mode", "most-unstable"),
    ("dispersion", "vortex", "--k", "1,2,3,4", "--method", "bvp"),
    ("spectrum", "vortex", "--k", "1,2,3,4", "--modes", "1"),
    ("kmax", "dune", "--over", "Re=1,2,3,4"),
    ("neutral", "film", "--vary", "Re", "--over", "We=1,2,3,4"),
    ("neutral", "film", "--vary", "Re", "--slope-deg", "45", "--k", "0.1,0.2,0.3,0.4"),
    ("wellposed", "vortex", "--k", "1,2,3,4"),
]


@pytest.mark.parametrize("question", SWEEPS, ids=" ".join)
def test_an_interrupted_sweep_keeps_what_is_done(capsys, monkeypatch, question):
    def press_ctrl_c(bar, done, total):
        if done == 2:
            raise KeyboardInterrupt

    monkeypatch.setattr("stability.studies.dispersion._PORTION", 2)
    whole = json.loads(run(capsys, *question, "--json")[1])["rows"]
    monkeypatch.setattr("stability.cli.progress.Bar.__call__", press_ctrl_c)
    status, out, err = run(capsys, *question, "--json")
    rows = json.loads(out)["rows"]
    done = [row for row in rows if row["status"] != "interrupted"]
    assert status == 130
    assert err == "stability: interrupted: 2 of 4 rows are not computed\n"
    assert len(rows) == 4
    assert done == [one for one, row in zip(whole, rows, strict=True) if row in done]
    assert [row["status"] for row in done] == ["resolved"] * 2
    swept = "k" if "--k" in question else question[-1].partition("=")[0]
    assert [row[swept] for row in rows] == [row[swept] for row in whole]
    assert all(value is None for row in rows if row not in done for name, value in row.items()
               if name not in (swept, "status", "maxima"))


def stability(*arguments, **options):
    command = [sys.executable, "-m", "stability", *arguments]
    return subprocess.Popen(command, stderr=subprocess.PIPE, text=True, **options)


def test_a_closed_pipe_is_quiet():
    reader, writer = os.pipe()
    os.close(reader)
    process = stability("flows", stdout=writer)
    os.close(writer)
    assert process.communicate()[1] == ""
    assert process.returncode == 141


QUESTIONS = ["stability --help", "stability --version", "stability flows", "stability dispersion vortex --k 1",
             "stability kmax dune --help", "stability spectrum vortex --k 1 --json", "asymptotics --help",
             "asymptotics --version", "asymptotics flows", "asymptotics expand vortex",
             "asymptotics expand dune --help"]


def shell(question, streams):
    """Run a command with the redirections `streams` of a shell."""
    line = f"exec {sys.executable} -m {question} {streams}"
    return subprocess.run(["bash", "-c", line], capture_output=True, text=True, check=False, timeout=60)


@pytest.mark.parametrize("question", QUESTIONS)
def test_closed_standard_streams(question):
    """Without standard output one line says so, without standard error the exit status alone tells."""
    program = question.split()[0]
    done = shell(question, ">&-")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert done.stderr.startswith(f"{program}: cannot write to standard output: it is closed")
    whole = shell(question, "")
    assert shell(question, "2>&-").stdout == shell(question, "2>&- <&-").stdout == whole.stdout != ""
    done = shell(question, ">&- 2>&- <&-")
    assert (done.returncode, done.stdout, done.stderr) == (2, "", "")


@pytest.mark.parametrize("question", ["stability dispersion vortex --k 0", "asymptotics expand dune --Re 0",
                                      "asymptotics check dune /nowhere"])
@pytest.mark.parametrize("streams", ["2>&-", ">&- 2>&-", "<&- >&- 2>&-"])
def test_bad_input_without_standard_error_is_an_exit_status(question, streams):
    done = shell(question, streams)
    assert (done.returncode, done.stdout, done.stderr) == (2, "", "")


def test_files_are_written_without_standard_streams(tmp_path):
    """And none of them gets what is meant for a stream."""
    for number, streams in enumerate(("", ">&-", "2>&-", "<&- >&- 2>&-")):
        target = tmp_path / f"{number}.csv"
        command = "stability dispersion vortex --Fr2 5 --k 0.1,1"  # has a note
        done = shell(f"{command} -o {target}", streams)
        assert (done.returncode, done.stdout) == (0, "")
        assert target.read_text() == (tmp_path / "0.csv").read_text()


@pytest.mark.skipif(not os.path.exists(FULL), reason="needs /dev/full")
@pytest.mark.parametrize(("question", "status"), [("stability dispersion vortex --Fr2 5 --k 0.1,1", 0),
                                                  ("stability dispersion vortex --k 0", 2),
                                                  ("asymptotics expand dune --Re 0", 2)])
def test_what_standard_error_cannot_take_changes_nothing(question, status):
    done, usual = shell(question, f"2>{FULL}"), shell(question, "")
    assert usual.stderr
    assert (done.returncode, done.stdout) == (usual.returncode, usual.stdout)
    assert done.returncode == status


def test_a_closed_standard_input_is_one_line():
    done = shell("asymptotics check dune", "<&-")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert done.stderr.startswith("asymptotics: cannot read standard input: it is closed")


@pytest.mark.skipif(not os.path.exists(FULL), reason="needs /dev/full")
def test_a_full_disk_is_one_line():
    with open(FULL, "w") as full:
        process = stability("dispersion", "vortex", "--k", "1", stdout=full)
        err = process.communicate()[1]
    assert process.returncode == 2
    assert err == "stability: cannot write to standard output: No space left on device\n"


def test_ctrl_c_stops_a_sweep_at_once():
    process = stability("kmax", "dune", "--over", "shields=1.1:4:2000", stdout=subprocess.PIPE)
    time.sleep(3)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=20)
    assert process.returncode == 130
    assert "Traceback" not in err
    assert {line.split()[-1] for line in out.splitlines()[1:]} <= {"resolved", "interrupted"}  # what was done is kept


@pytest.mark.parametrize(("program", "words"), [("stability", ["base", "dune"]), ("asymptotics", ["flows"])])
def test_ctrl_c_while_importing_is_one_line(program, words):
    """As if it came with the first heavy package."""
    code = f"""
import sys
class Interrupt:
    def find_spec(name, path=None, target=None):
        if name in ("numpy", "sympy"):
            raise KeyboardInterrupt
sys.meta_path.insert(0, Interrupt)
sys.argv = ["{program}", *{words}]
from {program}.cli import main
sys.exit(main())
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", f"{program}: interrupted\n")


def test_light_verbs_import_no_heavy_packages():
    """Beyond what scipy.linalg imports itself: in older versions scipy.sparse.linalg."""
    heavy = ["sympy", "matplotlib", "scipy.special", "scipy.integrate", "scipy.sparse.linalg"]
    code = ("import sys, scipy.linalg; before = set(sys.modules); "
            "from stability.cli import main; main(['dispersion', 'vortex', '--k', '1', '--quiet']); "
            f"print([name for name in {heavy} if name in set(sys.modules) - before])")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.endswith("[]\n")


@pytest.mark.parametrize("package", ["stability", "asymptotics"])
def test_the_command_that_is_installed_is_the_module(package, monkeypatch):
    """It ends with the status of `main`, and what is left then is not looked through."""
    (script,) = (one for one in entry_points(group="console_scripts") if one.name == package)
    frozen = []
    monkeypatch.setattr("gc.freeze", lambda: frozen.append(True))
    monkeypatch.setattr(f"{package}.__main__.main", lambda: 3)
    with pytest.raises(SystemExit) as end:
        script.load()()
    assert (end.value.code, frozen) == (3, [True])
