"""What became of a question, as a kind with a message and asides; and read back from its text."""

import json
import pickle

import numpy as np
import pytest

from stability import dispersion, flows
from stability.status import (
    INTERRUPTED,
    LOST,
    RESOLVED,
    STABLE,
    Aside,
    Kind,
    Status,
    as_inside,
    as_outgrown,
    doubtful,
    is_interrupted,
    is_outgrown,
    is_resolved,
    is_settled,
    is_stable,
    status_of,
    unresolved,
)

TEXTS = {
    "resolved": RESOLVED, "stable": STABLE, "interrupted": INTERRUPTED, "lost": LOST,
    "resolved; outgrown": as_outgrown(RESOLVED), "resolved; inside": as_inside(RESOLVED),
    "stable: no waves grow for k up to 100": Status(Kind.STABLE, "no waves grow for k up to 100"),
    "no derivative: depth is infinite": Status(Kind.NO_DERIVATIVE, "depth is infinite"),
    "lost: two modes; collide": Status(Kind.LOST, "two modes; collide"),
    "error 1.0e-02 exceeds tolerance; outgrown": as_outgrown(unresolved("error 1.0e-02 exceeds tolerance")),
    "others may be missing: why; inside": as_inside(doubtful("why")),
    "resolvedly not": unresolved("resolvedly not"), "": unresolved(""),
}


@pytest.mark.parametrize("text", TEXTS)
def test_text_and_status_are_one(text):
    status = TEXTS[text]
    again = status_of(text)
    assert status == again == text
    assert (again.kind, again.message, again.asides) == (status.kind, status.message, status.asides)
    assert status_of(status) is status


@pytest.mark.parametrize("status", TEXTS.values(), ids=repr)
def test_a_status_is_written_as_its_text_and_comes_back_whole(status):
    assert json.dumps([status]) == json.dumps([str(status)])
    assert np.array([status]).dtype.kind == "U"
    again = pickle.loads(pickle.dumps(status))
    assert (again, again.kind, again.message, again.asides) == (status, status.kind, status.message, status.asides)


def test_what_follows_from_a_status():
    tests = is_resolved, is_stable, is_settled, is_interrupted, is_outgrown
    told = {text: [test(status) for test in tests] for text, status in TEXTS.items()}
    assert told["resolved"] == [True, False, True, False, False]
    assert told["resolved; outgrown"] == [True, False, True, False, True]
    assert told["resolved; inside"] == [True, False, True, False, False]
    assert told["stable: no waves grow for k up to 100"] == [False, True, True, False, False]
    assert told["no derivative: depth is infinite"] == [False, False, True, False, False]
    assert told["interrupted"] == [False, False, False, True, False]
    assert told["lost"] == told["resolvedly not"] == told[""] == [False] * 5
    assert told["error 1.0e-02 exceeds tolerance; outgrown"] == [False] * 4 + [True]


def test_asides_add_up():
    assert status_of("lost; inside; outgrown").asides == (Aside.INSIDE, Aside.OUTGROWN)
    assert status_of("lost; inside; outgrown") == as_outgrown(as_inside(LOST))


def test_a_relation_that_was_not_asked_says_so():
    """The numbers are the same; whether an internal mode is ahead takes dense spectra, and is told when asked for."""
    bed = flows.Dune(shields=1.05, mu1=0.7)
    plain, asked = dispersion(bed, [3.0, 10.0]), dispersion(bed, [3.0, 10.0], rivals=True)
    assert plain == asked
    assert (plain.rival, asked.rival.k) == (None, 10.0)
    assert plain.status == ("resolved", "resolved")
    assert asked.status == ("resolved", "resolved; outgrown")
    assert plain.notes()[0].endswith("is told with rivals=True")
    assert "(7327.02) outgrows the surface mode from k = 10 on" in asked.notes()[0]
    assert dispersion(flows.Vortex(), 1.0).notes() == []
