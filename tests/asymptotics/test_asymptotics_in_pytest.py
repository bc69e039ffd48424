"""What pytest shows of a user's own test: the line that asserts, which coefficient is wrong, or k that is too large."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MINE = '''import numpy as np
from asymptotics import assert_order, expand
from stability import dispersion, flows

LAW = expand("film", order=2, slope_deg=45, Re=10, We=0)
def mine(k, error=0.0):
    return dispersion(flows.Film(slope_deg=45.0), k).sigma + error * LAW.values()[2] * np.asarray(k) ** 2
def test_wrong(): assert_order(lambda k: mine(k, 0.005), LAW, np.geomspace(0.01, 0.3, 15), part="real")
def test_large(): assert_order(mine, LAW, np.geomspace(1, 30, 12), part="real")
def test_scalar(): assert_order(lambda k: complex(mine(float(k), 0.005)[0]), LAW, np.geomspace(0.01, 0.3, 15))
def test_right(): assert_order(lambda k: complex(mine(float(k))[0]), LAW, np.geomspace(0.01, 0.3, 15))
'''


@pytest.fixture(scope="module")
def shown(tmp_path_factory):
    """What is shown of each test, {name: text}."""
    path = tmp_path_factory.mktemp("mine") / "test_mine.py"
    path.write_text(MINE)
    command = [sys.executable, "-m", "pytest", path, "-q", "-p", "no:cacheprovider", "--rootdir", path.parent]
    done = subprocess.run(command, capture_output=True, text=True, check=False,
                          env={**os.environ, "PYTHONPATH": str(ROOT)})
    assert re.search("3 failed, 1 passed", done.stdout), done.stdout + done.stderr
    parts = re.split(r"^_+ (test_\w+) _+$", done.stdout, flags=re.M)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def test_only_the_users_own_lines_are_shown(shown):
    for text in shown.values():
        assert "limits.py:" not in text.partition("short test summary")[0]
        assert len(re.findall("^>", text, re.M)) == 1


@pytest.mark.parametrize("name", ["test_wrong", "test_scalar"])
def test_a_coefficient_that_is_wrong_is_named_with_its_error(shown, name):
    found = re.search(r"of the real part differs from the expected 4.0000: the coefficient of k\^2 differs by (\S+) "
                      r"\+- (\S+), that is (\S+) % of it", shown[name])
    value, error, percent = map(float, found.groups())
    assert abs(value - 0.005 * 14 / 3) < 3 * error  # (8/15) (Re - 5/4 cot slope) = 14/3
    assert percent == pytest.approx(0.5, abs=0.05)


def test_k_that_is_too_large_is_no_wrong_coefficient(shown):
    assert "k is too large for this expansion: the numerics do not even rise like its first term, k^2" in \
        shown["test_large"]
    assert "differs by" not in shown["test_large"]
