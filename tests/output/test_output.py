"""Tables: aligned, and within the width of a terminal that is too narrow for every digit."""

import os
import subprocess
import sys

import pytest

from stability import dispersion, flows
from stability.output.text import table
from stability.studies.kmax import k_max

ROWS = dispersion(flows.Dune(), [10**-1.5, 1.0, 3.0]).rows()


def test_without_a_width_every_digit_is_shown():
    assert table(ROWS) == table(ROWS, 200)
    assert f"{ROWS[1]['growth_rate']:.10g}" in table(ROWS)


@pytest.mark.parametrize(("rows", "width"), [
    (ROWS, 80), (ROWS, 84), (k_max(flows.Dune()).rows(), 60), (k_max(flows.Dune()).rows(), 62)])
def test_digits_give_way_to_the_width(rows, width):
    lines = table(rows, width).splitlines()
    assert max(map(len, lines)) <= width < max(map(len, table(rows).splitlines()))
    assert lines[0].split() == list(rows[0])
    assert len({len(line) for line in lines[1:]}) == 1


def test_what_no_layout_fits_is_split_into_blocks():
    """Every column once, the first ones again in each block, no line beyond the width."""
    rows = [dict(zip(("parameter", "value", *(f"column_{i}" for i in range(9))), (name, *range(10)), strict=True))
            for name in ("shields", "depth")]
    for width in (34, 60, 80):
        blocks = table(rows, width).split("\n\n")
        assert max(map(len, table(rows, width).splitlines())) <= width
        heads = [block.split("\n")[0].split() for block in blocks]
        assert len(heads) > 1
        assert all(head[:2] == ["parameter", "value"] for head in heads)
        assert [name for head in heads for name in head[2:]] == list(rows[0])[2:]


def test_errors_and_times_take_two_digits():
    assert table([{"seconds": 1.23456e-5, "reported": 0.1234, "growth_rate": 0.1234}]).split()[3:] == \
        ["1.2e-05", "1.2e-01", "0.1234"]


def test_a_long_status_is_shown_in_full():
    rows = [*ROWS, {**ROWS[0], "status": "error 1.1e-04 exceeds tolerance at degree 14"}]
    assert table(rows, 60).splitlines()[-1].endswith("tolerance at degree 14")
    assert table(rows, 60).splitlines()[1] == table(ROWS, 60).splitlines()[1]


@pytest.mark.skipif(sys.platform == "win32", reason="needs a pseudo-terminal")
def test_only_a_terminal_is_narrow():
    command = [sys.executable, "-m", "stability", "dispersion", "dune", "--k", f"{10**-1.5},1,3"]
    environment = {**os.environ, "COLUMNS": "60"}
    piped = subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout
    assert piped == table(ROWS)
    assert "\033" not in piped
    import pty

    near, far = pty.openpty()
    subprocess.run(command, env=environment, stdout=far, check=True)
    assert os.read(near, 10_000).decode().replace("\r", "") == table(ROWS, 60)
