"""Maps: point by point what the other verbs say, and the same file however often the work is interrupted."""

import csv
import json
import os
import re
import resource
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import active_children, get_context

import numpy as np
import pytest
from matplotlib.figure import Figure

from stability import ParameterError, dispersion, flows, k_max
from stability.cli import main
from stability.errors import WorkersLost
from stability.output.mapplots import branch_changes
from stability.studies import map as maps
from stability.studies import rounds
from stability.studies.critical import critical
from stability.studies.journal import Journal, _line
from stability.studies.map import parameter_map
from stability.studies.pieces import compute
from stability.studies.request import Request

SMALL = {"shields": [1.5, 3.0], "Re": [0.1, 10.0, 1e3]}
WIDE = {**SMALL, "Re": [0.1, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1e3]}
COMMAND = ["map", "dune", "--over", "shields=1.5:3:4", "--over", "Re=1:1e3:16"]


def run(capsys, *words):
    status = main(list(words))
    return status, *capsys.readouterr()


@pytest.fixture(scope="module")
def small():
    return parameter_map(flows.Dune(), SMALL)


@pytest.fixture(scope="module")
def wide():
    return parameter_map(flows.Dune(), WIDE)


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    target = tmp_path_factory.mktemp("map") / "whole.csv"
    assert main([*COMMAND, "--workers", "1", "-o", str(target)]) == 0
    return target.read_bytes()


def test_every_point_is_that_of_k_max(small):
    for row, (shields, Re) in zip(small.rows(), ((s, r) for s in SMALL["shields"] for r in SMALL["Re"]), strict=True):
        best = k_max(flows.Dune(shields=shields, Re=Re))
        second = best.maxima[1] if len(best.maxima) > 1 else None
        assert row == {
            "shields": shields, "Re": Re, "k_max": best.k_max, "growth_rate": best.growth_rate,
            "phase_speed": best.phase_speed, "error": best.error, "growth_error": best.best.mode.error,
            "maxima": len(best.maxima), "second_k_max": second and second.k,
            "second_growth_rate": second and second.growth_rate, "status": "resolved"}
    assert small["k_max"].shape == (2, 3)
    assert small["k_max"][1, 2] == k_max(flows.Dune(shields=3.0, Re=1e3)).k_max
    assert small["maxima"].tolist() == [[1, 1, 1], [2, 1, 1]]


def test_growth_rates_along_k_are_those_of_dispersion():
    k = [0.1, 1.0, 5.0]
    found = parameter_map(flows.Dune(), {"shields": [1.5, 3.0]}, k=k)
    assert list(found.axes) == ["shields", "k"]
    for i, shields in enumerate((1.5, 3.0)):
        relation = dispersion(flows.Dune(shields=shields), k)
        assert found["growth_rate"][i].tolist() == relation.growth_rate.tolist()
        assert found["error"][i].tolist() == relation.error.tolist()
    assert found.resolved.all()


def test_the_leading_mode_is_mapped_where_there_is_no_surface_mode():
    found = parameter_map(flows.Poiseuille(), {"Re": [5e3, 1e4]}, k=[1.0])
    assert np.sign(found["growth_rate"][:, 0]).tolist() == [-1, 1]


def test_neutral_values_are_those_of_critical():
    found = parameter_map(flows.Film(), {"slope_deg": [30.0, 45.0]}, "neutral", vary="Re")
    assert found["Re"][1] == pytest.approx(1.25, abs=1e-12)
    assert found["Re"][0] == pytest.approx(critical(flows.Film(slope_deg=30.0), "Re").value, abs=1e-11)
    assert found["k"].tolist() == [0, 0]
    assert found.table == parameter_map(flows.Film(), {"slope_deg": [30.0, 45.0]}, vary="Re").table


def test_the_header_says_what_was_mapped(tmp_path, capsys):
    target = tmp_path / "x.json"
    for words, said in ((("--vary", "Re"), {"quantity": "neutral", "vary": "Re", "parameters": {"We": 0.0}}),
                        (("--k", "1", "--tolerance", "1e-6"),
                         {"quantity": "growth_rate", "mode": "surface", "tolerance": 1e-6, "max_degree": 512,
                          "parameters": {"Re": 10.0, "We": 0.0}})):
        assert run(capsys, "map", "film", "--over", "slope_deg=30,45", *words, "-o", str(target))[0] == 0
        header = json.loads(target.read_text())
        assert {name: header[name] for name in said} == said


def test_an_infinite_depth_is_a_depth_like_any_other(tmp_path, capsys):
    target = tmp_path / "x.csv"
    assert run(capsys, "map", "dune", "--over", "depth=5,inf", "-o", str(target))[0] == 0
    rows = [line for line in target.read_text().splitlines() if not line.startswith("#")]
    assert [row.split(",")[:2] for row in rows[1:]] == [["5.0", str(k_max(flows.Dune(depth=5.0)).k_max)],
                                                        ["inf", str(k_max(flows.Dune()).k_max)]]


def test_outgrown_and_inadmissible_points_say_so():
    found = parameter_map(flows.Dune(mu1=0.7), {"shields": [1.02, 2.0], "Re": [3e3]})
    assert found["status"].tolist() == [["resolved; outgrown"], ["resolved"]]
    found = parameter_map(flows.RollWave(), {"slope_deg": [15.0, 25.0], "Fr2": [5.0]})
    assert "slope_deg must lie between" in found["status"][0, 0]
    assert np.isnan(found["k_max"][0, 0])
    assert found.rows()[0]["k_max"] is None
    assert found.resolved.tolist() == [[False], [True]]


def test_the_jump_between_branches_is_found():
    found = parameter_map(flows.Dune(), {"shields": [3.0, 1.5, 2.0], "Re": [0.1, 10.0]})
    along_shields, along_Re = branch_changes(found)  # shields sorted
    assert along_shields.tolist() == [[False, False], [True, False]]
    assert not along_Re[:2].any()


@pytest.mark.parametrize(("first", "second", "jumps"), [
    ((0.1, 1.0), (None, 0.11), True), ((0.1, 1.0), (0.9, None), True), ((0.1, 0.12), (1.0, 1.1), False),
    ((0.1, 0.12), (None, None), False), ((0.1, None), (1.0, None), False),
])
def test_a_jump_is_where_a_maximum_continues_the_second_one(first, second, jumps):
    """Either neighbour may have two."""
    rows = tuple((k, 1.0, 1.0, 0.0, 0.0, 2, other, 0.5, "resolved") for k, other in zip(first, second, strict=True))
    (change,) = branch_changes(maps.Map(Request(flows.Dune(), {"Re": [1.0, 2.0]}, "k_max"), rows))
    assert change.tolist() == [jumps]


def test_three_axes_in_order():
    over = {"mu1": [0.3, 0.5], "shields": [1.5, 2.0], "b": [0.5, 1.0, 2.0, 2.5, 3.0]}  # more than a piece
    found = parameter_map(flows.Dune(), over)
    assert found["k_max"].shape == (2, 2, 5)
    assert found["k_max"][1, 0, 4] == k_max(flows.Dune(mu1=0.5, shields=1.5, b=3.0)).k_max


def test_any_executor_gives_the_same(small):
    with ThreadPoolExecutor(2) as executor:
        assert parameter_map(flows.Dune(), SMALL, executor=executor).table == small.table
    assert parameter_map(flows.Dune(), SMALL, workers=2).table == small.table
    assert active_children() == []


def _failing(piece, attempt):
    """As a worker that is lost the first time."""
    if attempt == 0 and piece.index == 1:
        raise RuntimeError("worker lost")
    return compute(piece)


def _always_failing(piece, attempt):
    raise RuntimeError(f"worker lost {attempt}")


def test_pieces_that_fail_are_submitted_again_a_few_times(small, monkeypatch):
    with ThreadPoolExecutor(2) as executor:
        monkeypatch.setattr(rounds, "compute", _failing)
        assert parameter_map(flows.Dune(), SMALL, executor=executor).table == small.table
        monkeypatch.setattr(rounds, "compute", _always_failing)
        with pytest.raises(RuntimeError, match="worker lost 2"):
            parameter_map(flows.Dune(), SMALL, executor=executor)


def test_a_killed_worker_of_our_own_loses_nothing(wide):
    killed = []

    def kill_one(done, total):
        if done and not killed:
            killed.append(active_children()[0].pid)
            os.kill(killed[0], signal.SIGKILL)

    assert parameter_map(flows.Dune(), WIDE, workers=2, report=kill_one).table == wide.table
    assert killed


def _dying_pool():
    return ProcessPoolExecutor(1, get_context("spawn"), os._exit, (1,))


def test_workers_that_keep_dying_are_given_up(monkeypatch):
    monkeypatch.setattr(rounds, "processes", lambda workers, may_fork: _dying_pool())
    with pytest.raises(WorkersLost, match="ended 3 times before they finished anything: a script needs"):
        parameter_map(flows.Dune(), SMALL, workers=2)


SCRIPT = """
from stability import flows
from stability.studies.map import parameter_map

parameter_map(flows.Dune(), {"Re": [float(Re) for Re in range(1, 9)]}, workers=2)
"""
GUARD = 'a script needs `if __name__ == "__main__":` around what it does, and cannot come from standard input'


def test_a_script_without_a_guard_is_told_so_after_one_round(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    err = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=60, cwd=tmp_path).stderr
    assert err.endswith(f"stability.errors.WorkersLost: no worker process began: {GUARD}\n")
    assert err.count("RuntimeError: ") <= 2  # a traceback of each worker, once


def test_a_script_from_standard_input_is_refused_before_workers_start():
    done = subprocess.run([sys.executable, "-"], input=SCRIPT, capture_output=True, text=True, timeout=60)
    line = f"stability.errors.ParameterError: workers: each process runs the script anew: {GUARD}\n"
    assert done.stderr.endswith(line)
    assert done.stderr.count("Traceback") == 1


FORKED = """
from stability.studies.pool import processes, without_threads
without_threads()
import fcntl, os, threading
import scipy.linalg
from stability.studies.journal import Journal

def locked():
    with open("journal", "rb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return True

with Journal("journal", {}) as journal, processes(2, True) as pool:
    print(pool.submit(os.getppid).result() == os.getpid(), locked())
    journal._file.close()
    print(locked())
stop = threading.Event()
threading.Thread(target=stop.wait).start()
try:
    with processes(2, True):
        pass
except ValueError as reason:
    print(reason)
stop.set()
"""


@pytest.mark.skipif(sys.platform != "linux", reason="only there are threads counted")
def test_workers_are_forked_from_a_process_of_one_thread_and_hold_none_of_its_locks(tmp_path):
    """A script from standard input cannot start fresh processes."""
    for may_fork, said in (("True", ["True True", "None"]), ("False", [])):
        script = FORKED.replace("processes(2, True) as", f"processes(2, {may_fork}) as")
        done = subprocess.run([sys.executable, "-"], input=script, capture_output=True, text=True, timeout=60,
                              cwd=tmp_path)
        refusal = f"workers: each process runs the script anew: {GUARD}"
        assert done.stdout.splitlines() == [*said, refusal][:len(said) and 3]
        assert (refusal in done.stderr) == (not said)


def test_a_broken_executor_of_somebody_else_is_reported():
    executor = _dying_pool()
    with pytest.raises(BrokenProcessPool):
        executor.submit(int).result()
    with pytest.raises(WorkersLost):
        parameter_map(flows.Dune(), SMALL, executor=executor)


def test_a_dask_worker_killed_on_the_way_loses_nothing(wide):
    distributed = pytest.importorskip("distributed")
    cluster = distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50)
    with cluster, distributed.Client(cluster) as client:
        killed = []

        def kill_one(done, total):
            if done and not killed:
                killed.extend(client.run(os.getpid).values())
                os.kill(killed[0], signal.SIGKILL)

        found = parameter_map(flows.Dune(), WIDE, executor=client.get_executor(), report=kill_one)
    assert killed
    assert found.table == wide.table


def start(target, *more, **options):
    command = [sys.executable, "-m", "stability", *COMMAND, "-o", str(target), *more]
    return subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True, **options)


def stop(process, partial, kill, pieces=2):
    """Send a signal once some pieces are kept; return what was said and the pieces."""
    limit = time.monotonic() + 60
    while not partial.exists() or partial.read_bytes().count(b"\n") < pieces + 1:
        assert process.poll() is None
        assert time.monotonic() < limit
        time.sleep(0.01)
    kill()
    err = process.communicate(timeout=20)[1]
    return err, partial.read_bytes().count(b"\n") - 1


def test_ctrl_c_and_kill_lose_nothing(tmp_path, uninterrupted):
    """Once by Ctrl-C, which reaches the workers too, once by kill -9: in the end the file of one run."""
    target, partial = tmp_path / "a b é.csv", tmp_path / "a b é.csv.partial"
    process = start(target, "--workers", "2")
    err, pieces = stop(process, partial, lambda: os.killpg(process.pid, signal.SIGINT))
    assert process.returncode == 130
    assert err == (f"stability: interrupted: {4 * pieces} of 64 points are kept in {str(partial)!r}; "
                   "the same command resumes\n")
    process = start(target, "--workers", "2")
    _, more = stop(process, partial, lambda: os.kill(process.pid, signal.SIGKILL), pieces + 1)
    assert more > pieces
    _wait_until_nobody_is_left(process.pid)
    assert not target.exists()
    partial.write_bytes(partial.read_bytes() + b'[15, [[1.5, 2')  # torn by the kill
    process = start(target, "--workers", "1")
    assert process.communicate(timeout=60)[1] == ""
    assert target.read_bytes() == uninterrupted
    assert [path.name for path in tmp_path.iterdir()] == [target.name]


def test_what_is_written_counts_as_kept_whenever_ctrl_c_comes(tmp_path, capsys, monkeypatch):
    """Even between the writing of a piece and all that follows from it."""
    add, written = Journal._append, []

    def append(journal, line):
        add(journal, line)
        written.append(line)
        if len(written) == 4:  # the request and three pieces
            raise KeyboardInterrupt

    monkeypatch.setattr(Journal, "_append", append)
    assert main([*COMMAND, "-o", str(tmp_path / "x.csv"), "--workers", "1"]) == 130
    assert "interrupted: 12 of 64 points are kept" in capsys.readouterr().err


def _wait_until_nobody_is_left(group):
    """Workers end with their parent, soon."""
    limit = time.monotonic() + 5
    while _running(group):
        assert time.monotonic() < limit
        time.sleep(0.05)


def _running(group):
    found = subprocess.run(["ps", "-eo", "pgid=,stat=,args="], capture_output=True, text=True, check=True).stdout
    lines = [line.split(None, 2) for line in found.splitlines()]
    return [line for line in lines if line[0] == str(group) and not line[1].startswith("Z")]


def test_a_resumed_map_computes_only_what_is_missing(tmp_path, small, monkeypatch):
    partial = tmp_path / "map.partial"
    parameter_map(flows.Dune(), SMALL, journal=partial)
    monkeypatch.setattr(rounds, "compute", None)
    assert parameter_map(flows.Dune(), SMALL, journal=partial).table == small.table


def test_the_journal_of_another_request_is_refused(tmp_path, capsys):
    target = tmp_path / "x.csv"
    partial = tmp_path / "x.csv.partial"
    parameter_map(flows.Dune(), {"Re": [1.0, 2.0]}, journal=partial)
    before = partial.read_bytes()
    status, out, err = run(capsys, "map", "dune", "--over", "Re=1,3", "--mu1", "0.5", "-o", str(target))
    assert (status, out) == (2, "")
    assert err == (f"stability: {str(partial)!r} keeps the unfinished map of another request (differs in parameters, "
                   "over): repeat that one, give another file, or delete it\n")
    assert partial.read_bytes() == before
    partial.write_text("my own notes\n")
    assert run(capsys, "map", "dune", "--over", "Re=1,3", "-o", str(target))[0] == 2
    assert partial.read_text() == "my own notes\n"


def test_a_journal_torn_anywhere_goes_on_from_its_last_whole_line(tmp_path):
    path, request = tmp_path / "j", {"flow": "dune"}
    with Journal(path, request) as journal:
        for index in range(2):
            journal.add(index, [[1.5, None, "resolved"]])
    whole = path.read_bytes()
    for length in range(len(whole) + 1):
        path.write_bytes(whole[:length])
        with Journal(path, request) as journal:
            for index in {0, 1} - set(journal.done):
                journal.add(index, [[1.5, None, "resolved"]])
        assert path.read_bytes() == whole


FILM = {"Re": [1.0, 2.0, 3.0, 5.0, 8.0, 13.0]}
FILM_COMMAND = ["map", "film", "--over", "Re=1,2,3,5,8,13", "--k", "0.1,0.2", "--workers", "1", "-o"]


@pytest.fixture(scope="module")
def film(tmp_path_factory):
    """The file of a map, the lines of its journal, and a line of the journal of another map."""
    folder = tmp_path_factory.mktemp("film")
    assert main([*FILM_COMMAND, str(folder / "whole.csv")]) == 0
    for name, flow in (("ours", flows.Film()), ("theirs", flows.Film(We=1.0))):
        parameter_map(flow, FILM, k=[0.1, 0.2], journal=folder / name)
    lines, others = ((folder / name).read_bytes().splitlines(keepends=True) for name in ("ours", "theirs"))
    return (folder / "whole.csv").read_bytes(), lines, others[2]


def flip(line, rng):
    """Another byte somewhere, not the newline."""
    changed = bytearray(line)
    changed[rng.integers(len(line) - 1)] ^= 1 << rng.integers(7)
    return bytes(changed)


def another_digit(line, rng):
    """One digit of the numbers is another one."""
    places = [place for place in range(30, len(line)) if line[place:place + 1].isdigit()]
    place = places[rng.integers(len(places))]
    return line[:place] + str((int(line[place:place + 1]) + rng.integers(1, 10)) % 10).encode() + line[place + 1:]


def shortened(line, rng):
    """The first row lacks its last value."""
    head, _, rest = line.partition(b', "resolved"]')
    return head + b"]" + rest


DAMAGE = {
    "cut": lambda line, rng, other: line[: rng.integers(1, len(line) - 1)] + b"\n",
    "cut with its end": lambda line, rng, other: line[: rng.integers(1, len(line) - 1)],
    "flipped": lambda line, rng, other: flip(line, rng),
    "doubled": lambda line, rng, other: line + line,
    "foreign": lambda line, rng, other: line + b"my own notes\n",
    "of another map": lambda line, rng, other: other,
    "shortened": lambda line, rng, other: shortened(line, rng),
    "a number": lambda line, rng, other: b"5\n",
    "another digit": lambda line, rng, other: another_digit(line, rng),
    "empty": lambda line, rng, other: b"\n" + line,
}


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("kind", DAMAGE)
def test_a_damaged_line_is_computed_again_and_that_is_said(tmp_path, capsys, film, kind, seed):
    whole, lines, other = film
    rng = np.random.default_rng([seed, *kind.encode()])
    place = rng.integers(1, len(lines) - 1)  # the last one, without its end, would be taken for one torn by a kill
    target, partial = tmp_path / "x.csv", tmp_path / "x.csv.partial"
    partial.write_bytes(b"".join(DAMAGE[kind](line, rng, other) if index == place else line
                                 for index, line in enumerate(lines)))
    status, out, err = run(capsys, *FILM_COMMAND, str(target))
    assert (status, out) == (0, "")
    assert err == (f"stability: damaged lines of {str(partial)!r} left out: 1; the points that no other line holds "
                   "were computed again\n")
    assert target.read_bytes() == whole
    assert [path.name for path in tmp_path.iterdir()] == ["x.csv"]


@pytest.mark.parametrize("kind", sorted(DAMAGE.keys() - {"doubled", "foreign", "shortened"}))  # those leave it as it is
def test_a_damaged_first_line_is_named_before_any_work(tmp_path, capsys, monkeypatch, film, kind):
    _, (header, *lines), other = film
    target, partial = tmp_path / "x.csv", tmp_path / "x.csv.partial"
    damaged = b"".join([DAMAGE[kind](header, np.random.default_rng(1), other), *lines])
    partial.write_bytes(damaged)
    monkeypatch.setattr(rounds, "compute", None)
    status, out, err = run(capsys, *FILM_COMMAND, str(target))
    assert (status, out) == (2, "")
    assert err == (f"stability: {str(partial)!r} is not the journal of a map, or its first line is damaged: give "
                   "another file, or delete it to compute the map anew\n")
    assert partial.read_bytes() == damaged


def test_a_map_says_how_many_lines_were_damaged(tmp_path, film):
    _, lines, other = film
    (tmp_path / "j").write_bytes(b"".join([lines[0], b"5\n", other, *lines[1:-1], lines[-1][:-9]]))
    found = parameter_map(flows.Film(), FILM, k=[0.1, 0.2], journal=tmp_path / "j")
    assert found.damaged == 2
    assert found == parameter_map(flows.Film(), FILM, k=[0.1, 0.2])
    assert parameter_map(flows.Film(), FILM, k=[0.1, 0.2]).damaged == 0


@pytest.mark.parametrize("content", [5, [], [0], ["0", []], [0, 5], [-1, [[1.0, 2.0]]], [2, [[1.0, 2.0]]], [0, [[1.0]]],
                                     [0, [[1.0, 2.0]] * 2], [0, [1.0]]], ids=str)
def test_a_line_must_have_the_shape_of_its_piece(tmp_path, content):
    """Even where its checksum is right."""
    path, shapes = tmp_path / "j", [(1, 2), (1, 2)]
    with Journal(path, {"flow": "dune"}, shapes) as journal:
        text = json.dumps(content).encode()
        journal._append(_line(journal._request + text, text))
        journal.add(1, [[3.0, 4.0]])
    with Journal(path, {"flow": "dune"}, shapes) as journal:
        assert (journal.done, journal.damaged) == ({1: [[3.0, 4.0]]}, 1)


def test_a_journal_without_checksums_is_refused(tmp_path, capsys):
    target, partial = tmp_path / "x.csv", tmp_path / "x.csv.partial"
    request = Request(flows.Film(), FILM, "growth_rate", k=[0.1, 0.2])
    partial.write_text(json.dumps(request.description()) + "\n[0, [[1, 2, 3, 4, 5], [1, 2, 3, 4, 5]]]\n")
    status, _, err = run(capsys, *FILM_COMMAND, str(target))
    assert status == 2
    assert err == (f"stability: {str(partial)!r} keeps a map without checksums, of an earlier version: give another "
                   "file, or delete it to compute the map anew\n")


def test_two_runs_do_not_share_a_journal(tmp_path):
    request = Request(flows.Dune(), {"Re": [1.0]}, "k_max").description()
    with Journal(tmp_path / "j", request), pytest.raises(ParameterError, match="in use"):
        Journal(tmp_path / "j", request)


def test_a_full_disk_keeps_what_is_done(tmp_path):
    target, partial = tmp_path / "full.csv", tmp_path / "full.csv.partial"
    limit = 3000  # bytes of any file

    def little_room():
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    process = start(target, "--workers", "1", preexec_fn=little_room)
    err = process.communicate(timeout=60)[1]
    assert process.returncode == 2
    assert err == (f"stability: cannot write {str(partial)!r}: File too large; what is done is kept, the same command "
                   "resumes\n")
    lines = partial.read_bytes().splitlines(keepends=True)
    assert all(json.loads(line) and line.endswith(b"\n") for line in lines)
    assert len(lines) > 1


def test_forms_by_ending_and_what_exists_is_replaced(tmp_path, capsys):
    from scipy.io import netcdf_file

    words = ("map", "dune", "--over", "shields=1.5,3", "--over", "Re=0.1,10", "--workers", "1", "-o")
    for ending in ("csv", "json", "nc"):
        target = tmp_path / f"map.{ending}"
        target.write_text("old")
        assert run(capsys, *words, str(target)) == (0, "", "")
    rows = json.loads((tmp_path / "map.json").read_text())["rows"]
    lines = [line for line in (tmp_path / "map.csv").read_text().splitlines() if not line.startswith("#")]
    assert [float(row["k_max"]) for row in csv.DictReader(lines)] == [row["k_max"] for row in rows]
    with netcdf_file(tmp_path / "map.nc", mmap=False) as file:
        assert file.variables["k_max"][:].ravel().tolist() == [row["k_max"] for row in rows]
        assert file.variables["status"].dimensions == ("shields", "Re", "status_length")
        assert file.variables["status"][:].tobytes() == b"resolved" * 4
        assert file.variables["shields"].dimensions == ("shields",)
        assert (file.flow, file.mu1, hasattr(file, "Re")) == (b"dune", 0.4, False)
    assert len(list(tmp_path.iterdir())) == 3


def test_the_record_prints_writes_and_draws_itself(tmp_path, small, capsys):
    assert repr(small).startswith("Map of Dune(shields=2.0")
    assert "quantity k_max, over shields, Re: 6 of 6 resolved\n" in repr(small)
    words = "map", "dune", "--over", "shields=1.5,3", "--over", "Re=0.1,10,1e3", "-o"
    for ending, write in (("csv", small.to_csv), ("json", small.to_json), ("nc", small.to_netcdf)):
        ours, theirs = tmp_path / f"ours.{ending}", tmp_path / f"theirs.{ending}"
        write(ours)
        assert run(capsys, *words, str(theirs), "--workers", "1")[0] == 0
        assert ours.read_bytes() == theirs.read_bytes()
    axis = Figure().subplots()
    assert small.plot(axis, "phase_speed") is axis
    assert (axis.get_xlabel(), axis.get_ylabel()) == (r"$\mathrm{Re}$", r"$\theta$")


@pytest.mark.parametrize("words", [("--over", "Re=0.1:100:3"), ("--over", "shields=1.02,2", "--over", "Re=10,3e3"),
                                   ("--over", "shields=1.5:2:3", "--k", "0.1:3:4")])
def test_maps_are_drawn(tmp_path, capsys, words):
    picture = tmp_path / "map.svg"
    status, _, err = run(capsys, "map", "dune", "--mu1", "0.7", *words, "--workers", "1", "-o",
                         str(tmp_path / "map.csv"), "--plot", str(picture))
    assert (status, err) == (0, "")
    assert ("outgrown" in picture.read_text()) == ("outgrown" in (tmp_path / "map.csv").read_text())
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.parametrize("over", [{"depth": [np.inf, 1.0, 5.0]}, {"shields": [1.5, 2.0], "depth": [1.0, 10.0, np.inf]},
                                  {"depth": [np.inf, 2.0], "shields": [1.5, 2.0]}, {"depth": [np.inf]}])
def test_infinity_is_drawn_as_one_more_cell(over):
    found = _with_k_max(over)
    axis = found.plot(Figure().subplots())
    which = axis.yaxis if list(over)[0] == "depth" and len(over) == 2 else axis.xaxis
    low, high = which.get_view_interval()
    *ticks, last = which.get_ticklocs()
    *labels, name = [label.get_text() for label in which.get_ticklabels()]
    assert name == "$\\infty$"
    assert not any("infty" in label for label in labels)
    assert low < last < high
    assert all(low <= tick < last for tick in ticks)
    if len(over) == 2:
        order = np.ix_(*(np.argsort(values) for values in over.values()))
        assert axis.collections[0].get_array().tolist() == found["k_max"][order].tolist()
    else:
        x, y = axis.lines[0].get_data()
        assert x[-1] == last
        assert y[-1] == found["k_max"][0]
        assert np.isnan(y[-2:-1]).all()  # apart from the line of finite values


def _with_k_max(over):
    """A map of k_max with made-up values."""
    request = Request(flows.Dune(), over, "k_max")
    rows = [(1.0 + index, 1.0, 1.0, 0.0, 0.0, 1, None, None, "resolved") for index in range(request.size)]
    return maps.Map(request, tuple(rows))


def test_the_zero_of_growth_is_not_drawn_into_the_cell_of_infinity():
    found = parameter_map(flows.Dune(), {"depth": [0.3, 1.0, 3.0, np.inf]}, k=[0.5, 1.5, 2.5, 3.5])
    axis = found.plot(Figure().subplots())
    (contour,) = (path for one in axis.collections[1:] for path in one.get_paths())
    assert 0.3 <= contour.vertices[:, 1].min() < contour.vertices[:, 1].max() <= 3 * (1 + 1e-12)


@pytest.mark.parametrize("quantity", ["status", "speed", "shields", 3])
def test_what_cannot_be_drawn_is_refused(small, quantity):
    columns = "k_max, growth_rate, phase_speed, error, growth_error, maxima, second_k_max, second_growth_rate"
    with pytest.raises(ParameterError, match=rf"^quantity must be one of {columns} \(got {quantity!r}\)$"):
        small.plot(Figure().subplots(), quantity)


def test_progress_shows_the_time_left():
    from stability.cli.progress import bar

    assert bar(25, 100, 75.0, 59) == "[" + "#" * 8 + "." * 25 + "] 25/100, 25 %, 1:15 left"
    assert len(bar(25, 100, 3700.0, 59)) == 59
    assert bar(0, 3600, None, 17) == "0/3600, 0 %"


BAD = [
    (("--over", "Rex=1:2:3"), "--over: dune has no parameter 'Rex' (did you mean 'Re'?)"),
    (("--over", "Re"), "--over Re: not a finite number: ''"),
    (("--over", "fluid=layer"), "--over: dune has no parameter 'fluid'"),
    ((), "--over: give at least one parameter to sweep"),
    (("--over", "Re=1,2", "--over", "Re=3,4"), "--over: Re is swept twice"),
    (("--over", "Re=1", "--over", "b=1", "--over", "mu1=1", "--over", "depth=1"),
     "a map has one to 3 swept parameters (got 4)"),
    (("--over", "shields=0.5:2:3"), "shields must lie in (1, inf)"),
    (("--over", "Re=1:2:2000", "--over", "b=1:2:2000"), "a map has 1 to 1000000 points (got 4000000)"),
    (("--over", "Re=1,2", "--quantity", "speed"), "quantity must be one of k_max, growth_rate, neutral (got 'speed')"),
    (("--over", "Re=1,2", "--quantity", "growth_rate"), "k: quantity growth_rate needs wavenumbers"),
    (("--over", "Re=1,2", "--quantity", "k_max", "--k", "1"), "k: quantity k_max takes none, only growth_rate does"),
    (("--over", "Re=1,2", "--quantity", "neutral"), "vary: quantity neutral needs a parameter to solve for"),
    (("--over", "Re=1,2", "--quantity", "k_max", "--vary", "b"), "vary: quantity k_max takes none, only neutral does"),
    (("--over", "Re=1,2", "--vary", "b", "--k", "1"), "k: quantity neutral takes none, only growth_rate does"),
    (("--over", "Re=1,inf"), "--over Re: not a finite number: 'inf'"),
    (("--over", "depth=1:inf:3"), "--over depth: not a finite number: 'inf'"),
    (("--over", "depth=-inf"), "--over depth: not a finite number: '-inf'"),
    (("--over", "Re=1,2", "--json"), "-o: --json contradicts the ending of 'x.csv'"),
    (("--over", "Re=1,2", "--quantity", "neutral", "--vary", "Re"), "vary: Re is the parameter to solve for"),
    (("--over", "Re=1,2", "--quantity", "neutral", "--vary", "R"), "dune has no numeric parameter 'R'"),
    (("--over", "Re=1,2", "--k", "0,1"), "--k: values must be positive (got 0)"),
    (("--over", "Re=1,2", "--workers", "0"), "--workers: must be an integer from 1 to 1000 (got 0)"),
    (("--over", "Re=1,2", "--workers", "-1"), "--workers"),
    (("--over", "Re=1,2", "--plot", "x.gif"), "--plot: the file must end in .png, .pdf, .svg"),
    (("--over", "Re=1,2", "--plot", "/nowhere/x.png"), "--plot: cannot write '/nowhere/x.png'"),
    (("--over", "Re=1", "--over", "b=1", "--k", "1", "--plot", "x.png"), "--plot: draws maps over one or two axes"),
]


@pytest.mark.parametrize(("words", "line"), BAD, ids=[" ".join(words) or "nothing" for words, _ in BAD])
def test_bad_input_gets_one_clear_line(tmp_path, monkeypatch, capsys, words, line):
    monkeypatch.chdir(tmp_path)
    status, out, err = run(capsys, "map", "dune", *words, "-o", "x.csv")
    assert (status, out) == (2, "")
    assert err.count("\n") == 1
    assert line in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("words", "line"), [
    ((), "-o FILE is needed, .csv, .json or .nc"),
    (("-o", "x.txt"), "-o: the file must end in .csv, .json, .nc, or add --csv or --json (got 'x.txt')"),
    (("-o", "/nowhere/x.csv"), "-o: cannot write '/nowhere/x.csv'"),
    (("-o", "folder.csv"), "-o: cannot write 'folder.csv': it is a directory"),
])
def test_bad_files_get_one_clear_line(tmp_path, monkeypatch, capsys, words, line):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder.csv").mkdir()
    status, out, err = run(capsys, "map", "dune", "--over", "Re=1,2", *words)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert line in err


BED, RE = flows.Dune(), {"Re": [1.0, 2.0]}


@pytest.mark.parametrize(("arguments", "line"), [
    ({"tolerance": 5}, r"tolerance: must lie in \[1e-15, 0.1\] \(got 5\)"),
    ({"tolerance": "x"}, r"tolerance: must lie in \[1e-15, 0.1\] \(got 'x'\)"),
    ({"max_degree": 3}, r"max_degree: must be an integer from 8 to 512 \(got 3\)"),
    ({"max_degree": 64.5}, r"max_degree: must be an integer from 8 to 512 \(got 64.5\)"),
    ({"flow": flows.Dune}, r"flow must be an object of a class in stability.flows; did you mean Dune\(\)\?"),
    ({"flow": None}, "flow must be an object of a class in stability.flows"),
    ({"over": "Re"}, r"over must be a dict \{parameter: values\} \(got 'Re'\)"),
    ({"over": [("Re", [1.0, 2.0])]}, r"over must be a dict \{parameter: values\} \(got \[\('Re', \["),
    ({"over": None}, r"over must be a dict \{parameter: values\} \(got None\)"),
    ({"over": {"Re": [1.0, [2.0, 3.0]]}}, r"Re must be a number in \(0, inf\) \(got \[2.0, 3.0\]\)"),
    ({"over": {"Re": "fast"}}, r"Re must be a number in \(0, inf\) \(got 'fast'\)"),
    ({"over": {0: [1.0]}}, "dune has no numeric parameter 0 to vary"),
    ({"quantity": ["k_max"]}, "quantity must be one of k_max, growth_rate, neutral"),
    ({"quantity": ""}, "quantity must be one of k_max, growth_rate, neutral"),
    ({"quantity": "neutral", "vary": ["b"]}, r"dune has no numeric parameter \['b'\] to vary"),
    ({"workers": 0}, r"workers: must be an integer from 1 to 1000 \(got 0\)"),
    ({"workers": -1}, r"workers: must be an integer from 1 to 1000 \(got -1\)"),
    ({"workers": None}, r"workers: must be an integer from 1 to 1000 \(got None\)"),
    ({"workers": "two"}, r"workers: must be an integer from 1 to 1000 \(got 'two'\)"),
    ({"executor": 2}, r"executor must be a concurrent.futures.Executor \(got 2\)"),
])
def test_bad_arguments_are_refused_before_any_file_is_touched(tmp_path, arguments, line):
    given = {"flow": BED, "over": RE, "journal": tmp_path / "kept", **arguments}
    with pytest.raises(ParameterError, match=f"^{line}|^dune: {line}|^{re.escape(str(BED))}: {line}") as refusal:
        parameter_map(**given)
    assert "\n" not in str(refusal.value)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("journal", [5, b"kept", "", "a\0b"])
def test_a_journal_is_the_name_of_a_file(journal):
    with pytest.raises(ParameterError, match=r"^journal must be the name of a file \(got "):
        parameter_map(BED, RE, journal=journal)


def test_numbers_of_any_kind_are_kept_in_a_journal(tmp_path):
    given = {"tolerance": np.float32(1e-8), "max_degree": np.int64(64), "workers": "1", "quantity": np.str_("k_max")}
    over = {"Re": np.array([1, 2])}
    found = parameter_map(BED, over, journal=tmp_path / "kept", **given)
    assert found["k_max"] == pytest.approx([k_max(flows.Dune(Re=Re)).k_max for Re in (1.0, 2.0)], rel=1e-7)
    assert parameter_map(BED, over, journal=tmp_path / "kept", **given).table == found.table


def test_a_flow_without_a_surface_mode_is_mapped_by_its_fastest_mode():
    found = parameter_map(flows.Poiseuille(), {"Re": [5000.0, 1e4]})
    assert found["status"][0].startswith("stable: no waves grow")
    assert found["k_max"][1] == k_max(flows.Poiseuille()).k_max
