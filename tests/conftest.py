"""One BLAS thread, no compiled kernel, and tests in an order of their own: a seed shown in the header, fixed by
STABILITY_TEST_SEED. With STABILITY_KERNEL=FOLDER all tests use the kernel that is there.

Ctrl-C works in the processes that tests start, even where the tests themselves run in the background of a shell.
"""

import os
import random
import signal
import time

import pytest

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("STABILITY_KERNEL", "off")
signal.signal(signal.SIGINT, signal.default_int_handler)
SEED = int(os.environ.setdefault("STABILITY_TEST_SEED", str(time.time_ns() % 10**6)))  # the same in all processes


def pytest_report_header():
    return f"order shuffled with STABILITY_TEST_SEED={SEED}"


def pytest_collection_modifyitems(items):
    """Shuffle within each file, so that module-wide fixtures are made once."""
    generator = random.Random(SEED)
    order = {name: generator.random() for name in sorted({item.nodeid for item in items})}
    items.sort(key=lambda item: (item.nodeid.partition("::")[0], order[item.nodeid]))


@pytest.fixture(autouse=True)
def without_memory(request, monkeypatch):
    """Each question of a test is answered anew, but where the test is about what is remembered."""
    if "remembered" not in request.fixturenames:
        monkeypatch.setattr("stability.modes.memory.KEPT", 0)
