"""Flows in files of their own reproduce what is published, through the command line."""

import json
from pathlib import Path

import numpy as np
import pytest

from stability import cli

FILES = Path(__file__).parents[1] / "own"


def ask(capsys, *words):
    status = cli.main([*map(str, words), "--json", "--quiet"])
    assert status == 0
    return json.loads(capsys.readouterr().out)["rows"]


def jet(capsys, *words):
    return ask(capsys, "critical", f"{FILES / 'jet.py'}:Bickley", "--vary", "Re", "--range", "3:6", "--search",
               "0.1:0.3", *words)[0]


def test_the_bickley_jet(capsys):
    """Re_c 4.02 and k_c 0.17, published to these digits; two heights of the cut agree within both bars."""
    found, higher = jet(capsys), jet(capsys, "--cut", "150")
    assert abs(found["Re"] - 4.02) < 0.005
    assert abs(found["k"] - 0.17) < 0.005
    assert abs(found["Re"] - higher["Re"]) < found["error"] + higher["error"] < 1e-9


def test_the_boundary_layer(capsys):
    """An eigenvalue recomputed in multi-precision, and the critical point near the 519.4 that is usually quoted."""
    name = f"{FILES / 'blasius.py'}:Blasius"
    (mode,) = ask(capsys, "spectrum", name, "--Re", "998", "--k", "0.308", "--modes", "1")
    error = abs(mode["phase_speed"] - 0.36412128993779585930) + abs(mode["growth_rate"] / 0.308 - 0.0079625053677670986)
    assert error < mode["error"] / 0.308 < 1e-10
    (point,) = ask(capsys, "critical", name, "--vary", "Re", "--range", "400:700", "--search", "0.2:0.4")
    assert abs(point["Re"] - 519.4) < 1e-3 * 519.4
    assert point["error"] < 1e-4


def test_the_shear_layer(capsys):
    """The inviscid maximum, growth 0.1897 at k 0.4449 (Michalke 1964), is approached like 1/Re."""
    name = f"{FILES / 'mixing.py'}:Tanh"
    reynolds = np.array([1e3, 2e3, 4e3])
    growth = [ask(capsys, "dispersion", name, "--Re", Re, "--k", "0.4449")[0]["growth_rate"] for Re in reynolds]
    slopes = np.diff(growth) / np.diff(1 / reynolds)
    assert slopes[0] / slopes[1] == pytest.approx(1, abs=0.01)
    assert 2 * growth[2] - growth[1] == pytest.approx(0.1897, abs=0.5e-4)


def test_a_channel_with_a_moving_wall(capsys):
    """At rest it is plane Poiseuille flow; a moving wall stabilises it."""
    name = f"{FILES / 'channel.py'}:CouettePoiseuille"
    rest, moving = (ask(capsys, "critical", name, "--vary", "Re", "--speed", speed, "--range", "3e3:3e4", "--search",
                        "0.5:1.5")[0] for speed in ("0", "0.3"))
    assert abs(rest["Re"] - 5772.22181620968) < rest["error"] < 1e-6
    assert moving["Re"] > 2 * rest["Re"]
