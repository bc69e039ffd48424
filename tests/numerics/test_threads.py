"""One BLAS thread while we compute, whatever number the caller has set before and after."""

from threading import Barrier, Thread

import pytest
import scipy.linalg  # noqa: F401 - brings a BLAS of its own
from threadpoolctl import threadpool_info, threadpool_limits

from stability.numerics.threads import one_thread


def blas_threads():
    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}


pytestmark = pytest.mark.skipif(not blas_threads(), reason="threadpoolctl does not know this BLAS")


@one_thread
def inside(*wait):
    """The numbers of threads in the function, before and after it has waited."""
    before = blas_threads()
    for barrier in wait:
        barrier.wait(10)
    return before | blas_threads()


@one_thread
def nested():
    return inside() | blas_threads()


@pytest.mark.parametrize("function", [inside, nested])
def test_the_callers_number_is_restored(function):
    with threadpool_limits(2, user_api="blas"):
        assert function() == {1}
        assert blas_threads() == {2}


def test_an_error_restores_it_too():
    @one_thread
    def fail():
        raise ValueError

    with threadpool_limits(2, user_api="blas"):
        with pytest.raises(ValueError, match="^$"):
            fail()
        assert blas_threads() == {2}


def test_calls_that_overlap_in_two_threads():
    """The first to begin ends first: one thread until the other ends too, then the number of the caller."""
    both_in, first_out, seen = Barrier(2), Barrier(2), []

    def first():
        seen.append(inside(both_in))
        seen.append(blas_threads())
        first_out.wait(10)

    def second():
        seen.append(inside(both_in, first_out))

    with threadpool_limits(2, user_api="blas"):
        workers = [Thread(target=target) for target in (first, second)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        assert seen == [{1}] * 3
        assert blas_threads() == {2}
