"""What the command line says to a slip: what was meant, and what would do."""

import subprocess
import sys

import pytest

from stability.cli import main


@pytest.mark.parametrize(("words", "said"), [
    ("dipersion dune --k 1", "unknown verb 'dipersion' (did you mean 'dispersion'?); verbs: flows, "),
    ("dispersion dune --K 1", "unknown option '--K' (did you mean '--k'?)"),
    ("dispersion dune --K=1", "unknown option '--K=1' (did you mean '--k'?)"),
    ("kmax dune --ovr Re=1,2", "unknown option '--ovr' (did you mean '--over'?)"),
    ("dispersion dune --k 1 --shield 2", "unknown option '--shield' (did you mean '--shields'?)"),
    ("dispersion dune --k 1 --re 2", "unknown option '--re' (did you mean '--Re'?)"),
    ("dispersion dune", "the following arguments are required: --k"),
    ("dispersion dune --k 0:10:5", "--k: a logarithmic range starts above 0 (got '0:10:5'); 0.01:10:5 would do"),
    ("dispersion dune --k 0:4:5:lin", "--k: a range of positive values starts above 0 (got '0:4:5:lin'); "
                                      "0.004:4:5:lin would do"),
    ("kmax film --over We=0:2:5", "--over We: a logarithmic range starts above 0 (got '0:2:5'); 0.002:2:5, or "
                                  "0:2:5:lin for equal steps would do"),
])
def test_a_slip_is_answered_with_what_is_meant(capsys, words, said):
    assert main(words.split()) == 2
    out, err = capsys.readouterr()
    assert (out, len(err.splitlines())) == ("", 1)
    assert said in err


@pytest.mark.parametrize(("slope", "hint"), [("0.5", "28.6479"), ("1.5", "85.9437"), ("1.7", None), ("30", None)])
def test_a_slope_that_may_be_in_radians_is_noted(capsys, slope, hint):
    for quiet in ([], ["--quiet"]):
        assert main(["dispersion", "vortex", "--k", "1", "--slope-deg", slope, *quiet]) == 0
        err = "".join(line for line in capsys.readouterr().err.splitlines(True) if "collide" not in line)
        expected = f"stability: slope_deg = {slope} is an angle in degrees; if it is meant in radians, give --slope-deg"
        assert err == ("" if quiet or hint is None else f"{expected} {hint}\n")


def test_what_grows_at_every_value_says_so(capsys):
    assert main(["critical", "film", "--vary", "Re", "--slope-deg", "120", "--range", "1:3"]) in (0, 3)
    out = capsys.readouterr().out
    assert "unstable at every Re from 1 to 3" in out


@pytest.mark.parametrize("words", [("--help",), ("--version",), ("dance",), (), ("flows",), ("flows", "dune"),
                                   ("flows", "fun"), ("dispersion", "--nonsense")], ids=str)
def test_what_needs_no_numerics_imports_none(words):
    code = ("import sys; from stability.cli import main\n"
            f"try: main({list(words)!r})\nexcept SystemExit: pass\n"
            "print('numpy' in sys.modules or 'scipy' in sys.modules, file=sys.stderr)")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = done.stderr.splitlines()[-1]
    assert loaded == str(words[:1] == ("dispersion",))
