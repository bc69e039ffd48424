"""The README does what it says: its commands and Python blocks run, and print what it shows.

Of what is printed every word and every digit must agree; error bars, numbers such as 7.2e-17 of two digits and a
negative exponent, only within a factor of 30: they move with the last bits of the machine.
"""

import io
import os
import re
import stat
import subprocess
import sys
from contextlib import redirect_stdout
from pathlib import Path

import pytest

from asymptotics.cli import main as asymptotics
from stability import flows, spectrum

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = [(found[1], found[2], README[: found.start()].count("\n") + 1)  # language, text, line
          for found in re.finditer(r"```(\w*)\n(.*?)```", README, re.S)]
(CHANNEL,) = [text for language, text, _ in BLOCKS if language == "python" and "(Flow)" in text]
BAR = re.compile(r"\d\.\de-\d\d")
FACTOR = 30
ENVIRONMENT = "python3 -m venv"  # commands that build one are not run here


def blocks(language):
    """Blocks of a language as parameters (text, what the README shows as its output, or None)."""
    following = [*BLOCKS[1:], ("end", "", 0)]
    return [pytest.param(text, after[1] if after[0] == "" else None, id=f"line {line}")
            for (name, text, line), after in zip(BLOCKS, following, strict=True)
            if name == language and not text.startswith(ENVIRONMENT)]


def agrees(printed, shown):
    """Whether two texts agree word by word, error bars within a factor."""
    words, expected = printed.split(), shown.split()
    return len(words) == len(expected) and all(_same(*pair) for pair in zip(words, expected, strict=True))


def _same(word, other):
    if BAR.fullmatch(word) and BAR.fullmatch(other):
        return 1 / FACTOR < float(word) / float(other) < FACTOR
    return word == other


@pytest.fixture
def programs(tmp_path, monkeypatch):
    """Both programs on the path, and a folder of our own to work in, with the flow of one's own."""
    for name in ("stability", "asymptotics"):
        script = tmp_path / "bin" / name
        script.parent.mkdir(exist_ok=True)
        script.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m {name} "$@"\n')
        script.chmod(script.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.chdir(tmp_path)
    (tmp_path / "channel.py").write_text(CHANNEL)


def test_there_are_blocks_of_every_kind():
    assert len(blocks("sh")) >= 2
    assert len(blocks("python")) >= 3
    assert sum(shown.values[1] is not None for shown in [*blocks("sh"), *blocks("python")]) >= 3
    assert sum(text.startswith(ENVIRONMENT) for _, text, _ in BLOCKS) == 2


def test_agreement_means_digits():
    assert agrees("1  0.23  4.6e-15\n", "1 0.23 4.1e-15")
    assert not agrees("1 0.23 4.6e-15", "1 0.24 4.6e-15")
    assert not agrees("1 0.23 4.6e-15", "1 0.23 4.6e-13")
    assert not agrees("1 0.23", "1 0.23 resolved")


@pytest.mark.parametrize(("command", "shown"), blocks("sh"))
def test_commands(programs, command, shown):
    done = subprocess.run(["bash", "-euo", "pipefail", "-c", command], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert shown is None or agrees(done.stdout, shown), done.stdout


@pytest.mark.parametrize(("code", "shown"), blocks("python"))
def test_python(tmp_path, monkeypatch, code, shown):
    monkeypatch.chdir(tmp_path)
    printed = io.StringIO()
    with redirect_stdout(printed):
        exec(compile(code, "README.md", "exec"), {"__name__": "readme"})
    assert agrees(printed.getvalue(), shown or ""), printed.getvalue()


def test_the_flow_of_ones_own(tmp_path):
    """Without slip it has Orszag's eigenvalue (1971); slip stabilises, Lauga & Cossu (2005)."""
    (tmp_path / "channel.py").write_text(CHANNEL)
    channel = flows.find(f"{tmp_path / 'channel.py'}:Channel")
    assert abs(spectrum(channel(), 1.0, 1).modes[0].c - (0.23752649 + 0.00373967j)) < 1e-8
    growth = [spectrum(channel(slip=slip), 1.0, 1).modes[0].growth_rate for slip in (0.0, 0.01, 0.02, 0.05)]
    assert growth == sorted(growth, reverse=True)
    assert growth[-1] < 0


@pytest.mark.parametrize("command", sorted(set(re.findall("`(asymptotics expand [^`]*)`", README))))
def test_expansions_that_are_mentioned(capsys, command):
    assert asymptotics(command.split()[1:]) == 0
    assert capsys.readouterr().out


def test_the_first_command_draws(tmp_path):
    (command,) = [text for _, text, _ in BLOCKS if text.startswith(ENVIRONMENT) and "figures/" in text]
    script = re.search(r"python (figures/\w+\.py) --out \.$", command.strip())[1]
    done = subprocess.run([sys.executable, ROOT / script, "--fast", "--out", tmp_path], capture_output=True, text=True,
                          check=True, env={**os.environ, "PYTHONPATH": str(ROOT)})
    picture = tmp_path / f"{Path(script).stem}.png"
    assert done.stdout.strip() == str(picture)
    assert picture.stat().st_size > 20_000
    assert f"figures/{picture.name})" in README
    assert f"`{picture.name}`" in README


def test_the_test_command_is_what_ci_runs():
    (shown,) = [text for _, text, _ in BLOCKS if text.startswith(ENVIRONMENT) and "pytest" in text]
    (extracted,) = re.findall(r'^eval "\$\((.*)\)"$', (ROOT / ".ci" / "run").read_text(), re.M)
    ran = subprocess.run(["bash", "-c", extracted], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert ran == shown
