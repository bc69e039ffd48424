"""Hostile input, seeded: random flows and questions over the whole admissible ranges, at their edges and beyond.

    python tests/fuzz.py [--points N] [--flows NAME ...] [--seed S] [--truth N] [--commands N] [--processes N]

Every point asks one question through the Python interface. It may be resolved, or refused by a StabilityError or by a
status; anything else is a failure: another exception, a warning, output of a library, over `BUDGET`
seconds of CPU, or `SEARCH_BUDGET` for a search over a parameter.
A sample of the resolved eigenvalues is compared with the multi-precision references: a true error above
its bar is a failure. `--commands` asks through the command line, in this process, `--processes` in new ones that
turn warnings into errors. Prints the counts and every failure; the exit status tells whether there were any.
"""

import argparse
import contextlib
import csv
import io
import math
import os
import re
import shlex
import signal
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from dataclasses import dataclass, fields, replace
from decimal import Decimal
from fractions import Fraction

import numpy as np
import references

from stability import NotResolved, ParameterError, StabilityError, dispersion, k_max, spectrum
from stability.cli import main as command
from stability.flows import FLOWS
from stability.flows.rules import numeric
from stability.studies.critical import critical

BUDGET = 20.0  # seconds of CPU that a point may take
SEARCHES = ("critical", "neutral")  # verbs that look over a whole range of a parameter, at each point
SEARCH_BUDGET = 120.0  # for those
REFERENCE_BUDGET = 10.0
COMMANDS = "dispersion", "spectrum", "kmax", "critical", "neutral", "wellposed", "flows"
REASONS = 40  # of refusals that are listed
SAMPLE = 300  # resolved eigenvalues compared with the references, over all flows

# usual and whole ranges of the parameters: log-uniform, or uniform where the lower end is not positive
RANGES = {
    "slope_deg": ((5, 60), (1e-6, 180)),
    "Fr2": ((1e-3, 50), (1e-12, 1e12)),
    "shields": ((1.05, 4), (1.0000001, 1e8)),
    "mu1": ((0.2, 0.7), (1e-8, 1e8)),
    "mu2": ((0.5, 0.9), (1e-8, 1e8)),
    "b": ((0.3, 3), (1e-8, 1e8)),
    "Re": ((0.05, 1e4), (1e-8, 1e12)),
    "depth": ((2, 20), (1e-8, 1e8)),
    "We": ((0.01, 10), (1e-12, 1e12)),
    "viscosity_ratio": ((0.1, 10), (1e-8, 1e8)),
    "depth_ratio": ((0.1, 10), (1e-8, 1e8)),
    "density_ratio": ((0.1, 10), (1e-8, 1e8)),
    "gravity": ((0.01, 10), (1e-12, 1e12)),
    "tension": ((0.01, 10), (1e-12, 1e12)),
}
WAVENUMBERS = (1e-3, 30), (1e-8, 1e6)
EDGES = (5e-324, 1e-310, 1e-300, 1e-160, 1e-20, 1e-8, 1e8, 1e20, 1e100, 1e160, 1e300, 1.7e308, 1, 2, 10)
NEAR_CRITICAL = (2.0**-52, 1e-15, 1e-12, 1e-9, 1e-6, 1e-4)
HOSTILE = ("abc", "", " ", "nan", "inf", "-inf", "1e999", "1_0", "0x10", "٣", "1e-400", None, math.nan, math.inf,
           -math.inf, 0, 0.0, -0.0, -1, -1e-300, True, False, 1j, complex(math.nan, 0), 10**400, -(10**400), b"3", [],
           [1.0], {}, (1, 2), object(), ..., Decimal("2.5"), Fraction(5, 2), np.float32(2), np.int64(2), np.bool_(True),
           np.float64("nan"), np.complex128(1j), np.array(2.0), np.array([2.0]), np.array([1.0, 2.0]), np.ma.masked,
           float, "closed-form")
SHARES = (("dispersion", 0.93), ("spectrum", 0.04), ("k_max", 0.02), ("critical", 0.01))


class Hang(BaseException):
    """The point has used up its time."""


@dataclass(frozen=True)
class Point:
    """One question: keyword arguments of a flow, the verb, and the arguments of the verb."""

    flow: str
    parameters: dict
    verb: str
    arguments: dict

    def __str__(self):
        shown = ", ".join(f"{name}={value!r}" for name, value in self.parameters.items())
        asked = ", ".join(f"{name}={value!r}" for name, value in self.arguments.items())
        return f"{self.verb}({self.flow}({shown}), {asked})"


@dataclass(frozen=True)
class Outcome:
    """`kind` is "resolved", "unresolved" (a status), the name of the refusing error, or "failure: ..."."""

    point: object
    kind: str
    reason: str
    seconds: float
    modes: tuple = ()

    @property
    def failed(self):
        return self.kind.startswith("failure")


class Draw:
    """Random input for one flow."""

    def __init__(self, flow, rng):
        self.flow, self.rng = flow, rng

    def point(self):
        """A question; one in twelve carries something hostile, the others are admissible or nearly so."""
        manner = self.rng.choice(["usual", "whole", "mixed", "edge"], p=[0.35, 0.3, 0.2, 0.15])
        parameters = {item.name: self._parameter(item, manner) for item in fields(FLOWS[self.flow])}
        self._make_consistent(parameters)
        verb = self.rng.choice([name for name, _ in SHARES], p=[share for _, share in SHARES])
        arguments = getattr(self, f"_{verb}")(manner)
        if self._chance(1 / 12):
            target = self._one_of([parameters, arguments])
            target[self._one_of(list(target))] = self._one_of(HOSTILE)
        return Point(self.flow, parameters, str(verb), arguments)

    def _parameter(self, item, manner):
        rule = item.metadata
        if "options" in rule:
            return self._one_of(rule["options"])
        if "table" in rule:
            return self._one_of(rule["kinds"].split("|"))
        if (rule["unbounded"] or rule["closed"]) and self._chance(0.3):
            return math.inf if rule["unbounded"] else 0
        usual, whole = RANGES.get(item.name, ((0.1, 10), (1e-8, 1e8)))
        if manner == "edge" and self._chance(0.4):
            return self._edge(rule)
        low, high = whole if manner in ("whole", "edge") or manner == "mixed" and self._chance(0.3) else usual
        return self._log(low, min(high, rule["high"] or high))

    def _edge(self, rule):
        ends = [end for end in (rule["low"], rule["high"]) if end]
        if ends and self._chance(0.6):
            end, distance = self._one_of(ends), self._one_of(NEAR_CRITICAL)
            return end * (1 + distance) if end == rule["low"] else end * (1 - distance)
        return self._one_of(EDGES)

    def _make_consistent(self, parameters):
        """Put the slope of roll waves between the angles of mu1 and mu2, mostly; next to one of them at times.

        Give a velocity the edges that it has, mostly.
        """
        if "profile" in parameters and not self._chance(0.15):
            parameters.update(self._one_of([*[{"profile": "poiseuille", "bottom": "wall", "top": "wall"}] * 6,
                                            {"profile": "blasius", "bottom": "wall", "top": "decay"},
                                            {"profile": "tanh", "bottom": "decay", "top": "decay"}]),
                              z_low=-math.inf, z_high=math.inf)
        if "mu2" not in parameters or self._chance(0.1):
            return
        low, high = sorted((parameters["mu1"], parameters["mu2"]))
        share = self._one_of([self.rng.uniform(0.02, 0.98), *((x, 1 - x) for x in NEAR_CRITICAL)][:4])
        share = self._one_of(share) if isinstance(share, tuple) else share
        parameters.update(mu1=low, mu2=high)
        if "slope_deg" in parameters:
            parameters["slope_deg"] = math.degrees(math.atan(low + share * (high - low)))

    def _k(self, manner):
        usual, whole = WAVENUMBERS
        if manner == "edge" and self._chance(0.1):
            return self._one_of(EDGES)
        return self._log(*(whole if manner != "usual" and self._chance(0.5) else usual))

    def _dispersion(self, manner):
        modes = [None, "surface", "leading", "most-unstable"]
        k = self._k(manner)
        if self._chance(0.15):
            k = [self._k(manner) for _ in range(self.rng.integers(1, 5))]
        return {"k": k, "mode": modes[self.rng.choice(4, p=[0.5, 0.2, 0.15, 0.15])], **self._options()}

    def _spectrum(self, manner):
        return {"k": self._k(manner), "modes": int(self.rng.integers(1, 12)), **self._options()}

    def _k_max(self, manner):
        return self._options()

    def _critical(self, manner):
        names = [item.name for item in fields(FLOWS[self.flow]) if numeric(item)]
        return {"vary": self._one_of(names), "long_wave": self._chance(0.2), **self._options()}

    def _options(self):
        options = {"strict": self._chance(0.3)}
        if self._chance(0.1):
            options["tolerance"] = self._log(1e-15, 0.1)
        if self._chance(0.1):
            options["max_degree"] = int(self.rng.integers(8, 513))
        return options

    def _log(self, low, high):
        return float(np.exp(self.rng.uniform(math.log(low), math.log(high))))

    def _one_of(self, options):
        return options[self.rng.integers(len(options))]

    def _chance(self, share):
        return bool(self.rng.random() < share)


VERBS = {"dispersion": dispersion, "spectrum": spectrum, "k_max": k_max, "critical": critical}


def ask(point):
    """The result of a point as a list of (status, mode or None)."""
    flow = FLOWS[point.flow](**point.parameters)
    result = VERBS[point.verb](flow, **point.arguments)
    if point.verb == "dispersion":
        return [(mode.status, mode) for mode in result.modes] + [(why, None) for why in result.lost.values()]
    if point.verb == "spectrum":
        return [(mode.status, mode) for mode in result.modes]
    if point.verb == "k_max":
        return [(result.status, None), *((one.mode.status, one.mode) for one in result.maxima)]
    return [(result.status, None)]


def attempt(point, question=ask, budget=BUDGET):
    """The `Outcome` of a point: what it answers, or what goes wrong."""
    start, found, kind, reason = time.process_time(), [], "", ""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            with limit(budget):
                found = question(point)
        except StabilityError as refusal:
            kind, reason = type(refusal).__name__, str(refusal)
            if not reason or "\n" in reason:
                kind = "failure: refusal not one line"
        except Hang:
            kind = "failure: hang"
        except Exception as error:
            place = traceback.extract_tb(error.__traceback__)[-1]
            kind, reason = f"failure: {type(error).__name__}", f"{error} ({place.filename}:{place.lineno})"
    seconds = time.process_time() - start
    if caught and not kind.startswith("failure"):
        first = caught[0]
        kind, reason = "failure: warning", f"{first.message} ({first.filename}:{first.lineno})"
    if not kind:
        bad = [status for status, _ in found if status != "resolved"]
        kind, reason = ("unresolved", bad[0]) if bad else ("resolved", "")
    modes = tuple(mode for status, mode in found if mode is not None and status == "resolved")
    return Outcome(point, kind, reason, seconds, modes)


@contextlib.contextmanager
def limit(seconds):
    """Raise Hang in the block after so many seconds of CPU."""
    def stop(signum, frame):
        raise Hang

    before = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds, 1.0)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)


def points(flow, count, seed):
    """Yield `count` points of a flow."""
    draw = Draw(flow, np.random.default_rng([seed, *flow.encode()]))
    for _ in range(count):
        yield draw.point()


def budget_of(line):
    """What a command line may take, in CPU seconds: so much for each value of a list that is swept."""
    values = max((word.count(",") + 1 for word in line if str(word).startswith("--over=")), default=1)
    return values * (SEARCH_BUDGET if any(verb in line for verb in SEARCHES) else BUDGET)


def truth(mode, budget=REFERENCE_BUDGET):
    """(kind, reason, true error over error bar) of a resolved mode against its multi-precision reference."""
    series = getattr(references, mode.flow.name, None)
    if series is None:
        return "no reference", "", 0.0
    flow = mode.flow
    parameters = {item.name: getattr(flow, item.name) for item in fields(flow) if item.name != "fluid"}
    try:
        with limit(budget):
            radius = min(max(1e-3, 10 * mode.error / abs(mode.sigma)), 0.5)
            exact = series(**parameters, k=mode.k, guess=mode.sigma, radius=radius)
    except Hang:
        return "no reference", "reference takes too long", 0.0
    except (ArithmeticError, ValueError) as reason:
        lost = "no root within" in str(reason)
        return "failure: no eigenvalue there" if lost else "no reference", str(reason), 0.0
    error = float(abs(exact - mode.sigma))
    ratio = error / mode.error if mode.error else math.inf
    if ratio > 1:
        return "failure: error bar", f"error {error:.2e} is {ratio:.3g} bars of {mode.error:.2e}", ratio
    return "holds", "", ratio


def check_truth(outcomes, count, rng, budget=REFERENCE_BUDGET):
    """Yield (outcome, mode, kind, reason, ratio) until `count` resolved eigenvalues have met their references."""
    modes = [(outcome, mode) for outcome in outcomes for mode in outcome.modes]
    checked = 0
    for index in rng.permutation(len(modes)):
        if checked == count:
            return
        outcome, mode = modes[index]
        found = truth(mode, budget)
        checked += found[0] != "no reference"
        yield outcome, mode, *found


# The command line.


def command_lines(count, seed):
    """Yield argument lists: the questions of random points, spoiled at times."""
    rng = np.random.default_rng([seed, 1])
    draws = [Draw(name, rng) for name in FLOWS]
    for index in range(count):
        yield _arguments(draws[index % len(draws)], rng)


def _arguments(draw, rng):
    point = draw.point()
    flags = [f"--{name.replace('_', '-')}={_text(value)}" for name, value in point.parameters.items()
             if draw._chance(0.7)]
    k = _text(point.arguments.get("k", draw._k("usual")))
    k = draw._one_of([k, k, f"{k}:{draw._k('usual')}:3", f"{draw._k('mixed')},{k}"])
    names = [item.name for item in fields(FLOWS[point.flow]) if numeric(item)]
    over = f"--over={draw._one_of(names)}={draw._k('usual')},{draw._k('mixed')}"
    vary = f"--vary={draw._one_of(names)}"
    asked = draw._one_of([
        ["dispersion", f"--k={k}"], ["dispersion", f"--k={k}", "--mode=most-unstable"], ["spectrum", f"--k={k}"],
        ["spectrum", f"--k={k}", "--modes=3"], ["kmax"], ["kmax", over], ["critical", vary],
        ["neutral", vary, over], ["neutral", vary, f"--k={k}"], ["wellposed"], ["wellposed", f"--k={k}"], ["flows"],
    ])
    line = [asked[0], point.flow, *asked[1:], *([] if asked[0] == "flows" else flags)]
    line += draw._one_of([[], [], ["--csv"], ["--json"], ["--quiet"], ["--max-degree=64"], ["--tolerance=1e-6"]])
    if draw._chance(0.15):
        place = rng.integers(len(line))
        line[place] = draw._one_of([*map(_text, HOSTILE), "--", "-h", "--version", "-o", "@x", "--k", "ü"])
    return line


def _text(value):
    text = value if isinstance(value, str) else repr(value)
    return re.sub(r"[\n\0]", "", text)


def in_process(line):
    """Status, standard output and standard error of a command line."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            status = command(line)
        except SystemExit as end:  # --help, --version
            status = end.code
    return status, out.getvalue(), err.getvalue()


def in_new_process(line):
    done = subprocess.run([sys.executable, "-W", "error", "-m", "stability", *line], capture_output=True, text=True,
                          timeout=10 * BUDGET, stdin=subprocess.DEVNULL)
    return done.returncode, done.stdout, done.stderr


def verdict(status, out, err):
    """List of (status, mode) like `ask`, or raise AssertionError: what a command line must do."""
    lines = err.splitlines()
    assert status in (0, 2, 3), f"exit status {status}: {err[-300:]}"
    assert all(line.startswith("stability: ") for line in lines), f"unexpected on standard error: {err[-300:]}"
    assert "Traceback" not in err, err[-300:]
    if status == 2:
        assert len(lines) == 1, f"{len(lines)} lines for bad input: {err[-300:]}"
        assert not out, "output although the input is bad"
        raise ParameterError(lines[0])
    if status == 3 and not out:
        raise NotResolved(lines[-1])
    assert out, "no output"
    return [("resolved" if status == 0 else lines[-1] if lines else "unresolved", None)]


# The report.


def grouped(reason):
    """A reason without its numbers and its flow."""
    reason = re.sub(r"\w+\([^()]*\)", "FLOW", reason, count=1)
    reason = re.sub(r"\(got .*", "(got ...)", reason, flags=re.DOTALL)
    return re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?j?", "#", reason)[:110]


def run(flows, count, seed, show):
    """Outcomes of all points of the flows; `show` is told of each."""
    outcomes = []
    for flow in flows:
        for point in points(flow, count, seed):
            outcome = attempt(point)
            outcomes.append(outcome)
            show(outcome)
    return outcomes


def table(outcomes, group):
    """Rows of counts: one per group, a column per kind."""
    kinds = sorted({outcome.kind for outcome in outcomes})
    rows = [["", *kinds, "all", "CPU s", "slowest"]]
    for name in dict.fromkeys(map(group, outcomes)):
        own = [outcome for outcome in outcomes if group(outcome) == name]
        counts = Counter(outcome.kind for outcome in own)
        rows.append([name, *(counts[kind] for kind in kinds), len(own), f"{sum(o.seconds for o in own):.0f}",
                     f"{max(o.seconds for o in own):.1f}"])
    return rows


def _verb(outcome):
    first = outcome.point.split()[0]
    return first if first.isalpha() and first in COMMANDS else "spoiled"


def text(rows):
    widths = [max(len(str(row[i])) for row in rows) for i in range(len(rows[0]))]
    return "\n".join("  ".join(str(cell).rjust(width) for cell, width in zip(row, widths, strict=True)) for row in rows)


def reasons(outcomes):
    """Rows of the grouped reasons of refusals, most frequent first."""
    counts = Counter((outcome.kind, grouped(outcome.reason)) for outcome in outcomes if outcome.kind != "resolved")
    first = counts.most_common(REASONS)
    rest = sum(counts.values()) - sum(count for _, count in first)
    return [["count", "refusal", "reason"], *([count, *key] for key, count in first),
            *([[rest, "", f"{len(counts) - REASONS} other reasons"]] if rest else [])]


@contextlib.contextmanager
def quiet_library():
    """Catch what compiled libraries write to the standard streams; yields a function that returns its size."""
    with tempfile.TemporaryFile() as file:
        saved = [os.dup(fd) for fd in (1, 2)]
        sys.stdout.flush()
        for fd in (1, 2):
            os.dup2(file.fileno(), fd)
        stdout, sys.stdout = sys.stdout, os.fdopen(saved[0], "w", closefd=False)
        try:
            yield lambda: os.fstat(file.fileno()).st_size
        finally:
            sys.stdout.flush()
            sys.stdout = stdout
            for fd, old in zip((1, 2), saved, strict=True):
                os.dup2(old, fd)
                os.close(old)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=200, help="per flow")
    parser.add_argument("--flows", nargs="*", default=list(FLOWS))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--truth", type=int, default=SAMPLE, help="eigenvalues to compare, over all flows")
    parser.add_argument("--commands", type=int, default=0)
    parser.add_argument("--processes", type=int, default=0)
    parser.add_argument("--csv", metavar="FILE", help="write the counts there as well")
    options = parser.parse_args()

    failures = []
    with quiet_library() as written:
        size = 0

        def show(outcome):
            nonlocal size
            if written() != size:
                size = written()
                outcome = replace(outcome, kind="failure: output of a library")
            if outcome.failed:
                failures.append(outcome)
                print(f"{outcome.kind}: {outcome.reason}\n    {outcome.point}", flush=True)

        outcomes = run(options.flows, options.points, options.seed, show)
        ratios, counts = [], Counter()
        rng = np.random.default_rng([options.seed, 2])
        for flow in options.flows:
            own = [outcome for outcome in outcomes if outcome.point.flow == flow]
            for outcome, mode, kind, reason, ratio in check_truth(own, -(-options.truth // len(options.flows)), rng):
                counts[flow, kind] += 1
                ratios += [ratio] if kind != "no reference" else []
                if kind.startswith("failure"):
                    show(replace(outcome, kind=kind, reason=f"k={mode.k!r}, sigma={mode.sigma!r}: {reason}"))
        lines = []
        for question, number in (in_process, options.commands), (in_new_process, options.processes):
            for line in command_lines(number, options.seed):
                outcome = attempt(shlex.join(line), lambda _, q=question, a=line: verdict(*q(a)), 5 * budget_of(line))
                lines.append(outcome)
                show(outcome)

    rows = table(outcomes, lambda outcome: outcome.point.flow) if outcomes else []
    for part in (rows, table(outcomes, lambda outcome: outcome.point.verb) if outcomes else [],
                 table(lines, _verb) if lines else [], reasons(outcomes + lines)):
        if part:
            print("\n" + text(part))
    print(f"\nagainst references: {dict(counts)}")
    if ratios:
        print(f"true error over error bar: median {np.median(ratios):.2g}, largest {max(ratios):.3g}, of {len(ratios)}")
    print(f"{len(failures)} failures")
    if options.csv:
        with open(options.csv, "w", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows(rows)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
