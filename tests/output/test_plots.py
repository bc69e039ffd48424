"""Figures: what records give to be drawn, families of curves, the look of a figure, fonts that stay text."""

import json
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from scipy.io import netcdf_file

from stability import ParameterError, dispersion, flows, load
from stability.cli import main
from stability.output.look import Look
from stability.output.overlay import read_overlay
from stability.output.panels import Axis, Curve, Panel, scale_found, scale_of
from stability.output.plots import draw, plot
from stability.output.sheet import parse_size, read_style
from stability.output.style import COLOURS, STYLE
from stability.output.symbols import assigned, symbol, symbol_of, title_of, value_text

DEPTHS = (2.0, 5.0, np.inf)


@pytest.fixture(scope="module")
def relation():
    return dispersion(flows.Dune(), np.geomspace(0.1, 10, 12))


def figures(monkeypatch):
    """The figures that are written from now on."""
    seen = []
    save = Figure.savefig
    monkeypatch.setattr(Figure, "savefig", lambda self, *args, **more: seen.append(self) or save(self, *args, **more))
    return seen


def run(capsys, *words):
    status = main(list(words))
    return status, *capsys.readouterr()


def test_symbols_of_print():
    bed = flows.Dune()
    assert [symbol_of(bed, name) for name in ("shields", "mu1", "b", "Re", "depth")] == [
        r"$\theta$", r"$\mu_1$", "$b$", r"$\mathrm{Re}$", "$h$"]
    assert symbol("I0") == "$I_0$"
    assert symbol("kappa12") == r"$\kappa_{12}$"
    assert symbol("viscosity_ratio") == "viscosity ratio"
    assert assigned(bed, "depth") == r"$h$ = $\infty$"
    assert assigned(flows.Film(), "slope_deg", 45.0) == r"$\alpha$ = 45" + "\N{DEGREE SIGN}"
    assert [value_text(value) for value in (1e6, 2.5e-7, 2, "layer")] == ["$10^{6}$", r"2.5$\times$$10^{-7}$", "2",
                                                                          "layer"]
    assert title_of(bed, ["Re"]) == r"dune: $\theta$ = 2, $\mu_1$ = 0.4, $b$ = 1, $h$ = $\infty$"
    assert "fluid layer" in title_of(replace(bed, fluid="layer"))


def test_scales_follow_the_spacing():
    assert scale_of(np.geomspace(0.01, 10, 9)) == "log"
    assert scale_of(np.linspace(0.04, 4, 100)) == "linear"
    assert scale_of([1.0, 100.0]) == "log"
    assert scale_of([2.0, 5.0, np.inf]) == scale_of([]) == scale_of([0.0, 1.0, 100.0]) == "linear"


def test_successive_results_take_successive_colours(relation):
    """Those of the axes, whatever their style; the label and the options are those of the line."""
    axis = Figure().subplots()
    relation.plot(axis, label="one", linewidth=3)
    relation.plot(axis, label="two")
    zero, one, two = axis.lines
    assert [line.get_label() for line in (one, two)] == [text.get_text() for text in axis.get_legend().get_texts()] == \
        ["one", "two"]
    assert (one.get_linewidth(), zero.get_label()) == (3, "_zero")
    assert one.get_color() != two.get_color()
    relation.plot(axis, "phase_speed", color="k", linestyle=":")
    assert (axis.lines[-1].get_color(), axis.lines[-1].get_linestyle()) == ("k", ":")


def test_error_bars_do_not_use_up_colours():
    """A curve with error bars that are seen, then another: the next colour, not the one after."""
    import matplotlib

    bed = flows.Dune()
    points = dispersion(bed, [1.0, 2.0])
    rough = replace(points, modes=tuple(replace(mode, error=0.1) for mode in points.modes))
    with matplotlib.rc_context(STYLE):
        axis = Figure().subplots()
        for one in (rough, points):
            one.plot(axis)
    assert [to_hex(line.get_color()) for line in axis.lines if line.get_label() != "_zero"][:1] == \
        [COLOURS[0]]
    assert to_hex(axis.lines[-1].get_color()) == COLOURS[1]
    assert axis.containers


def test_what_is_not_resolved_is_marked(relation):
    modes = tuple(replace(mode, status="error too large") if mode.k > 5 else mode for mode in relation.modes)
    axis = replace(relation, modes=modes).plot(Figure().subplots())
    marked = next(line for line in axis.lines if line.get_label() == "not resolved")
    assert marked.get_xdata().tolist() == [k for k in relation.k.tolist() if k > 5]


FAMILIES = {
    "kmax dune --over Re=0.3:100:3": "depth=2,5,inf", "dispersion dune --k 0.1,1,3": "depth=2,5,inf",
    "neutral film --vary Re --k 0.1,0.2 --range 0.3:10": "slope_deg=45,60",
}


@pytest.mark.parametrize("question", [name for name, each in FAMILIES.items() if each])
def test_a_family_is_one_table_and_a_curve_for_each_value(tmp_path, capsys, monkeypatch, question):
    each = FAMILIES[question]
    name, values = each.split("=")
    drawn, picture = figures(monkeypatch), tmp_path / "x.png"
    status, out, err = run(capsys, *question.split(), "--each", each, "--json", "--plot", str(picture))
    assert (status, err) == (0, "")
    found = json.loads(out)
    assert found["each"] == name
    assert name not in found["parameters"]
    singles = []
    for value in values.split(","):
        assert main([*question.split(), f"--{name}", value, "--json"]) == 0
        rows = json.loads(capsys.readouterr().out)["rows"]
        singles += [{name: value if value == "inf" else float(value), **row} for row in rows]
    assert found["rows"] == singles
    (figure,) = drawn
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == [assigned(flows.FLOWS[question.split()[1]](), name, float(value)) for value in values.split(",")]
    for axis in figure.axes:
        lines = [line for line in axis.lines if line.get_label() in labels]
        assert len({(line.get_color(), str(line.get_linestyle())) for line in lines}) == len(labels)
        assert len({(str(line.get_linestyle()), line.get_marker()) for line in lines}) == len(labels)  # in grey print


@pytest.mark.parametrize("ending", ["csv", "json", "nc"])
@pytest.mark.parametrize("question", [name for name, each in FAMILIES.items() if each])
def test_a_family_is_one_file(tmp_path, capsys, question, ending):
    target = tmp_path / f"x.{ending}"
    assert run(capsys, *question.split(), "--each", FAMILIES[question], "-o", str(target))[0] == 0
    _, out, _ = run(capsys, *question.split(), "--each", FAMILIES[question], "--json")
    stored = load(target)
    rows = json.loads(out)["rows"]
    assert [{key: float("inf") if value == "inf" else value for key, value in row.items()} for row in rows] == \
        stored.rows()
    panel, *_ = stored.panels()
    assert len(panel.curves) >= FAMILIES[question].count(",") + 1
    if ending == "nc":
        with netcdf_file(target, mmap=False) as file:
            assert {len(variable.data) for variable in file.variables.values()} == {len(rows)}


@pytest.mark.parametrize(("words", "complaint"), [
    ("--each depth=2,2", "--each depth: a value is given twice"),
    ("--each Re=1,2", "--each: Re is the parameter of --over; take another one"),
    ("--depth 2 --each depth=2,3", "--each: depth is given as --depth too; leave one of them out"),
    ("--each dept=2", "--each: dune has no parameter 'dept' (did you mean 'depth'?)"),
    ("--each shields=0.5,2", "shields must lie in (1, inf)"),
    ("--each shields=2:3:43 --plot x.png", "--each shields: a figure has up to 42 curves (got 43 values)"),
    ("--size 3x2", "--size: says how a figure looks; add --plot FILE"),
    ("--overlay x.csv", "--overlay: says how a figure looks; add --plot FILE"),
    ("--plot x.png --size 3", "--size: give width and height as WxH"),
    ("--plot x.png --size 3x1000mmm", "--size: give width and height as WxH"),
    ("--plot x.png --log z", "--log: must be x, y or xy (got 'z')"),
    ("--plot x.png --style nowhere", "--style: no file 'nowhere', and no style of matplotlib of that name"),
    ("--plot x.png --overlay nowhere.csv", "--overlay: cannot read 'nowhere.csv': No such file or directory"),
    ("--plot x.png --panel speed", "--panel: must be one of k_max, growth_rate (got 'speed')"),
])
def test_bad_looks_are_refused_in_one_line(tmp_path, monkeypatch, capsys, words, complaint):
    monkeypatch.chdir(tmp_path)
    status, _, err = run(capsys, "kmax", "dune", "--over", "Re=1,10", *words.split())
    assert status == 2
    assert err.startswith("stability: ")
    assert complaint in err
    assert len(err.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


def test_ctrl_c_keeps_the_values_that_are_done(capsys, monkeypatch):
    from stability.studies import kmax

    done = []

    def sweep(beds, **options):
        for bed in beds:
            if len(done) == 3:
                raise KeyboardInterrupt
            done.append(bed)
            yield next(original([bed], **options))

    original = kmax.k_max_sweep
    monkeypatch.setattr(kmax, "k_max_sweep", sweep)
    status, out, err = run(capsys, "kmax", "dune", "--over", "Re=1,10", "--each", "depth=2,5,inf", "--csv")
    rows = [line.split(",") for line in out.splitlines() if line[0] in "25i"]
    assert status == 130
    assert [(row[0], row[-1]) for row in rows] == [("2.0", "resolved")] * 2 + [("5.0", "resolved"),
                                                                               ("5.0", "interrupted"),
                                                                               ("inf", "interrupted")]
    assert "interrupted: 2 of 5 rows are not computed" in err


def test_size_style_title_and_log(tmp_path, capsys, monkeypatch):
    drawn, style = figures(monkeypatch), tmp_path / "mine.mplstyle"
    style.write_text("axes.linewidth: 3\nlines.linewidth: 4\npdf.fonttype: 3\n")
    status, _, err = run(capsys, "dispersion", "dune", "--k", "0.1:10:9", "--plot", str(tmp_path / "x.pdf"), "--size",
                         "86x60mm", "--style", str(style), "--title", "dunes", "--log", "y", "--panel", "growth_rate")
    (figure,), (axis,) = drawn, drawn[0].axes
    assert status == 0
    assert err == "stability: --log y: 3 of 9 values of growth_rate are not positive, and not drawn\n"
    assert tuple(25.4 * figure.get_size_inches()) == pytest.approx((86, 60))
    assert figure.get_suptitle() == "dunes"
    assert (axis.get_xscale(), axis.get_yscale()) == ("log", "log")
    assert (axis.spines["left"].get_linewidth(), axis.lines[-1].get_linewidth()) == (3, 4)
    assert parse_size("6.4x2.8") == parse_size("6.4x2.8in") == (6.4, 2.8)
    assert read_style("ggplot")["axes.grid"] is True


@pytest.mark.parametrize("text", ["axes.linewidth\n", "axes.linewdth: 3\n", "axes.linewidth: thick\n", ""])
def test_a_style_that_matplotlib_would_pass_over_is_refused(tmp_path, text):
    path = tmp_path / "x.mplstyle"
    path.write_text(text)
    with pytest.raises(ParameterError, match="--style: .*is no style sheet of matplotlib: "):
        read_style(str(path))


def test_nothing_positive_has_no_logarithm(tmp_path, relation):
    with pytest.raises(ParameterError, match="--log y: no value of growth_rate is positive"):
        draw(dispersion(flows.Vortex(), [1.0, 2.0]), tmp_path / "x.png", Look(log="y"))


def test_overlays_are_points_with_errors_or_computed_curves(tmp_path, relation):
    measured, theory = tmp_path / "measured.csv", tmp_path / "a:b.csv"
    measured.write_text("k , growth_rate,growth_rate_error, k_error\n1,0.2,0.05,0.1\n0.5,0.15,0.03,0.1\n2,,,\n")
    relation.to_csv(theory)
    panel, speeds, _ = relation.panels()
    points = read_overlay(f"{measured}:experiments: 2024")
    curve = points.curve(panel)
    assert points.label == "experiments: 2024"
    assert not points.fits(speeds)
    assert (curve.kind, curve.x.tolist(), curve.y.tolist()) == ("points", [0.5, 1.0], [0.15, 0.2])
    assert (curve.x_error.tolist(), curve.y_error.tolist()) == ([0.1, 0.1], [0.03, 0.05])
    line = read_overlay(str(theory))
    assert (line.label, line.curve(panel).kind, line.fits(speeds)) == ("a:b", "line", True)
    assert line.curve(panel).y_error.tolist() == [row["error"] for row in relation]
    assert line.curve(speeds).y_error is None
    target = tmp_path / "x.svg"
    assert draw(relation, target, Look(overlays=(points, line))) == []
    assert "experiments: 2024" in target.read_text()


@pytest.mark.parametrize(("text", "complaint"), [
    ("k,speed\n1,2\n", "has no columns k and growth_rate or k and phase_speed or k and "
     "group_speed; it has k, speed"),
    ("k\n", "has no rows below the names of its columns"),
    ("k,growth_rate\n1\n", "row 1 has 1 cells, and there are 2 columns"),
    ("k,k\n1,2\n", "has two columns of the same name"),
    ("k,growth_rate\nx,y\n", "has no column of numbers"),
    ("k,growth_rate\n1,\n", "has no row with numbers in k and growth_rate"),
])
def test_overlays_that_cannot_be_drawn_say_why(tmp_path, relation, text, complaint):
    path = tmp_path / "x.csv"
    path.write_text(text)
    with pytest.raises(ParameterError, match=complaint):
        draw(relation, tmp_path / "x.png", Look(overlays=(read_overlay(str(path)),)))


@pytest.mark.skipif(not shutil.which("pdffonts"), reason="needs pdffonts of poppler")
def test_fonts_of_a_pdf_stay_text(tmp_path, capsys):
    for number, words in enumerate((("kmax", "dune", "--over", "Re=1,10", "--each", "depth=2,inf"),
                                    ("map", "dune", "--over", "Re=1,10", "--over", "shields=1.5,2", "--workers", "1",
                                     "-o", str(tmp_path / "x.csv")))):
        path = tmp_path / f"{number}.pdf"
        assert run(capsys, *words, "--plot", str(path))[0] == 0
        fonts = subprocess.run(["pdffonts", path], capture_output=True, text=True, check=True).stdout
        assert "TrueType" in fonts
        assert "Type 3" not in fonts


def test_text_of_an_svg_stays_text(tmp_path, relation):
    draw(relation, tmp_path / "x.svg")
    content = (tmp_path / "x.svg").read_text()
    assert "<text" in content
    assert "DejaVuSans-" not in content  # outlines of letters are named so


def test_values_that_were_found_are_drawn_in_logarithms_where_they_span_decades():
    """Two neutral curves of a film: of its surface at Re ~ 1, of its shear at Re ~ 10^4."""
    assert scale_found([1.2, 1.3, 1.5, 9e3, 2e4]) == "log"
    assert scale_found([1.2, 1.3, 1.5]) == scale_found([-1.0, 100.0]) == scale_found([]) == "linear"


def test_error_bars_lie_along_their_axes():
    curve = Curve(np.array([1.0, 2.0]), np.array([1.0, 3.0]), x_error=np.full(2, 0.3), y_error=np.full(2, 0.1))
    axes = plot((Panel(Axis("k", "k"), Axis("y", "y"), (curve,)),), Figure().add_subplot())
    across, along = (np.ptp(np.array(bars.get_segments()), axis=1).mean(axis=0) for bars in axes.collections)
    assert across == pytest.approx([0.6, 0.0])
    assert along == pytest.approx([0.0, 0.2])
