"""What is listed of the flows without importing them is what they declare."""

from dataclasses import dataclass

import pytest

from stability import flows
from stability.flows import declared as listing
from stability.flows.catalogue import FLOWS, offers
from stability.flows.declaration import declaration_of, declared, written


@pytest.mark.parametrize("name", FLOWS)
def test_the_listing_is_what_the_class_declares(name):
    assert declared(name) == declaration_of(FLOWS[name]), "run: python -m stability.flows.declaration"


def test_the_listing_lacks_no_flow_and_has_no_other():
    assert list(listing.DECLARED) == list(FLOWS)


def test_what_is_written_is_read():
    scope: dict[str, dict] = {}
    exec(written(FLOWS.values()), scope)
    assert scope["DECLARED"] == listing.DECLARED


def test_a_flow_in_the_place_of_a_shipped_one_is_asked_itself(monkeypatch):
    @dataclass(frozen=True)
    class Film(flows.Film):
        title = "another film"

    monkeypatch.setitem(FLOWS._known, "film", Film)
    assert declared("film").title == "another film"


def test_offers_are_seen_without_reading_all_that_is_installed(tmp_path, monkeypatch):
    package = tmp_path / "jets-1.0.dist-info"
    package.mkdir()
    (package / "METADATA").write_text("Metadata-Version: 2.1\nName: jets\nVersion: 1.0\n")
    (package / "entry_points.txt").write_text("[stability.flows]\njet = jets:Jet\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    assert offers()["jet"] == "jets:Jet"
