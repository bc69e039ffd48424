"""The window to explore a flow: moved and clicked by synthetic events, and in a real browser where there is one."""

import asyncio
import base64
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from urllib.request import urlopen

import matplotlib
import numpy as np
import pytest
from matplotlib.backend_bases import MouseButton, MouseEvent

from stability import cli, dispersion, flows, k_max
from stability.cli.specs import parse_spec
from stability.studies.explore import FRAME, _spec_of, explore

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")


@pytest.fixture
def window():
    from matplotlib import pyplot

    with matplotlib.rc_context({"backend": "agg"}):
        pyplot.switch_backend("agg")
        made = explore(flows.Dune(), source="dune")
        made.figure.canvas.draw()
        yield made
        pyplot.close("all")


def click(window, axis, x, y):
    """Press and release the mouse at a point of the axes, in their data."""
    place = axis.transData.transform((x, y))
    for name in ("button_press_event", "button_release_event"):
        event = MouseEvent(name, window.figure.canvas, *place, MouseButton.LEFT)
        window.figure.canvas.callbacks.process(name, event)


def test_it_opens_with_the_dispersion_relation(window):
    relation = dispersion(flows.Dune(), window.k)
    assert len(window.k) == 80
    assert np.array_equal(window._lines["growth_rate"].get_ydata(), relation.growth_rate)
    assert np.array_equal(window._lines["phase_speed"].get_ydata(), relation.phase_speed)
    assert window.best.k_max == pytest.approx(k_max(flows.Dune()).k_max, rel=1e-12)
    limit = window._limit.get_data()
    assert limit[1] == pytest.approx(flows.Dune().long_wave(limit[0]).real)


def test_a_slider_moves_a_parameter(window):
    slider = window.sliders["shields"]
    x = slider.valmin + 0.4 * (slider.valmax - slider.valmin)
    click(window, slider.ax, x, 0.5)
    assert window.flow.shields == pytest.approx(x)
    assert slider.valtext.get_text() == f"{x:.5g}"
    shown = np.array(window._lines["growth_rate"].get_data())
    assert shown[1] == pytest.approx(dispersion(window.flow, shown[0]).growth_rate, abs=1e-12)
    assert not len(window._peak.get_xdata())
    window.rest()
    assert len(window._lines["growth_rate"].get_xdata()) == 80
    assert window._peak.get_xdata()[0] == pytest.approx(k_max(window.flow).k_max)


def test_ranges_over_decades_are_logarithmic(window):
    slider = window.sliders["Re"]
    slider.set_val(2.0)
    assert window.flow.Re == pytest.approx(100.0)
    assert window.flow.depth == np.inf
    window.sliders["depth"].set_val(1.0)
    assert window.flow.depth == pytest.approx(10.0)
    window.sliders["depth"].set_val(window.sliders["depth"].valmax)
    assert window.flow.depth == np.inf


def test_points_are_dropped_while_it_moves(window, monkeypatch):
    clock = iter(np.arange(100) * 10 * FRAME)
    monkeypatch.setattr("stability.studies.explore.perf_counter", lambda: next(clock))
    window.sliders["mu1"].set_val(0.0)
    window.sliders["mu1"].set_val(-0.1)
    assert len(window._lines["growth_rate"].get_xdata()) == 8
    window.rest()
    assert len(window._lines["growth_rate"].get_xdata()) == 80


def test_a_click_shows_the_spectrum_and_another_a_mode(window):
    click(window, window.growth, 1.0, 0.1)
    assert window.spectrum.k == pytest.approx(1.0)
    first = window.spectrum.modes[0]
    click(window, window.modes, first.phase_speed, first.growth_rate)
    assert window.mode is first
    u, z = window.fields.lines[0].get_data()
    assert z[[0, -1]] == pytest.approx([-1, 0], abs=1e-12)
    assert u == pytest.approx(np.abs(first.fields(z).u), abs=1e-12)
    click(window, window.modes, first.phase_speed, first.growth_rate + 1e4)
    assert window.mode is first


def test_what_is_refused_is_said(window):
    window.moved("shields", 0.5)
    assert "shields must lie in (1, inf)" in window._text.get_text()
    assert window.flow.shields == 2.0


def test_the_command_and_the_figure(window, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    window.sliders["mu1"].set_val(np.log10(0.5))
    window.rest()
    command = window.copy()
    assert command.startswith("stability dispersion dune --mu1 0.5")
    assert cli.main([*command.split()[1:], "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["rows"]
    assert [row["growth_rate"] for row in rows] == pytest.approx(window.relation.growth_rate, abs=1e-12)
    assert window.save() == "dune-1.pdf"
    assert window.save() == "dune-2.pdf"
    assert (tmp_path / "dune-1.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.parametrize("flow", [flows.Vortex(), flows.Poiseuille(), flows.RollWave()], ids=str)
def test_other_flows(flow):
    from matplotlib import pyplot

    pyplot.switch_backend("agg")
    made = explore(flow, np.geomspace(0.1, 5, 12))
    made.figure.canvas.draw()
    for slider in made.sliders.values():
        slider.set_val(slider.val + 0.01 * (slider.valmax - slider.valmin))
    assert made.flow != flow
    pyplot.close("all")


def test_without_a_display_it_says_so():
    environment = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    done = subprocess.run([sys.executable, "-m", "stability", "explore", "dune"], capture_output=True, text=True,
                          env={**environment, "MPLBACKEND": "agg"}, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == ("stability: explore: there is no display to open a window on; try: stability explore FLOW "
                           "--web\n")


def test_a_port_belongs_to_the_page(capsys):
    assert cli.main(["explore", "dune", "--port", "9000"]) == 2
    assert "--port: belongs to --web" in capsys.readouterr().err


# -- a browser ------------------------------------------------------------------------------------------


async def driven(address, picture):
    """Open the page in the browser, wait for the figure, click a slider's middle; return a screenshot of each."""
    from tornado.websocket import websocket_connect

    page = await websocket_connect(address, max_message_size=2**26)
    count = 0

    async def call(method, **parameters):
        nonlocal count
        count += 1
        await page.write_message(json.dumps({"id": count, "method": method, "params": parameters}))
        while True:
            answer = json.loads(await page.read_message())
            if answer.get("id") == count:
                return answer["result"]

    async def shot():
        return base64.b64decode((await call("Page.captureScreenshot"))["data"])

    for _ in range(120):
        await asyncio.sleep(0.5)
        found = await call("Runtime.evaluate", returnByValue=True, expression=(
            "(() => {const c = document.querySelector('canvas'); if (!c) return null;"
            "const p = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
            "return p.some((v, i) => i % 4 != 3 && v > 0 && v < 200) ? c.getBoundingClientRect().toJSON() : null})()"))
        if found["result"].get("value"):
            break
    box, before = found["result"]["value"], await shot()
    place = {"x": box["x"] + 0.45 * box["width"], "y": box["y"] + 0.74 * box["height"], "button": "left",
             "clickCount": 1}
    for kind in ("mousePressed", "mouseReleased"):
        await call("Input.dispatchMouseEvent", type=kind, **place)
    frames = [before]
    while len(frames) < 60 and (len(frames) < 8 or frames[-1] != frames[-4]):
        await asyncio.sleep(1)
        frames.append(await shot())
    page.close()
    picture.write_bytes(frames[-1])
    return before, frames[-1]


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # sockets of the browser
@pytest.mark.skipif(CHROMIUM is None, reason="no browser here")
def test_in_a_browser(tmp_path):
    pytest.importorskip("tornado")
    pictures = Path(os.environ.get("STABILITY_PICTURES", tmp_path))
    server = subprocess.Popen([sys.executable, "-m", "stability", "explore", "dune", "--web", "--port", "8899"],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env={**os.environ, "BROWSER": "true"})
    browser = subprocess.Popen([CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--window-size=1200,900",
                                f"--user-data-dir={tmp_path}", "--remote-debugging-port=9333", "about:blank"],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        for _ in range(120):
            time.sleep(0.5)
            try:
                urlopen("http://127.0.0.1:8899/1", timeout=5).read()
                pages = json.loads(urlopen("http://127.0.0.1:9333/json", timeout=5).read())
                break
            except OSError:
                continue
        (page, *_) = (one for one in pages if one["type"] == "page")
        from tornado.websocket import websocket_connect

        async def all_of_it():
            control = await websocket_connect(page["webSocketDebuggerUrl"])
            await control.write_message(json.dumps({"id": 1, "method": "Page.navigate",
                                                    "params": {"url": "http://127.0.0.1:8899/1"}}))
            await control.read_message()
            control.close()
            return await driven(page["webSocketDebuggerUrl"], pictures / "page.png")

        before, after = asyncio.run(all_of_it())
        assert len(after) > 10_000
        assert before != after
    finally:
        browser.kill()
        browser.wait()
        server.terminate()
        server.communicate()


@pytest.mark.parametrize("k", [[0.5], [0.1, 1.0], [0.1, 0.3, 1.0], [1.0, 2.0, 3.0, 4.0], [0.1, 1 / 3, 7.0]], ids=str)
def test_the_command_has_the_wavenumbers_that_are_shown(k):
    np.testing.assert_allclose(parse_spec(_spec_of(np.array(k)), "--k"), k, rtol=1e-15)
