# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work in a thread: progress often enough, cancelling soon enough, nothing left running."""

import _thread
import os
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from conftest import ROOT
from realmodel.core import BuildFailed, Cancelled, InputRefused
from realmodel.core.base.work import POLL_SECONDS, native_module, run, start

ENDLESS = 6000  # steps of 10 ms: a test that takes all of them has failed


class Steps:
    """Work in two phases of short steps, which counts them; it ends early once `enough()` holds."""

    def __init__(self, enough=lambda: False):
        self.done = 0
        self._enough = enough

    def __call__(self, work):
        for begin, text in ((0.0, "first half"), (0.5, "second half")):
            with work.phase(begin, begin + 0.5, text):
                for step in range(ENDLESS // 2):
                    if self._enough() and step > 0:
                        break
                    time.sleep(0.01)
                    self.done += 1
                    work.step(step / (ENDLESS // 2))
        return "done"


def working_threads():
    return [thread for thread in threading.enumerate() if thread.name == "realmodel work"]


def test_progress_while_the_work_goes_on_and_never_falling():
    caller = threading.get_ident()
    calls = []

    def progress(fraction, text):
        assert threading.get_ident() == caller
        calls.append((fraction, text))

    steps = Steps(lambda: len(calls) >= 20)
    assert run(steps, progress) == "done"
    assert POLL_SECONDS <= 0.1, "ten times a second"
    assert len(calls) >= 20
    assert steps.done < ENDLESS, "progress is not reported while the work goes on"
    fractions, texts = zip(*calls, strict=True)
    assert list(fractions) == sorted(fractions)
    assert fractions[0] >= 0.0
    assert fractions[-1] == 1.0
    assert list(texts) == sorted(texts)


def test_cancel_stops_at_the_next_step_and_leaves_no_thread():
    asked = []
    steps = Steps()

    def cancel():
        asked.append(steps.done)
        return len(asked) > 3

    with pytest.raises(Cancelled):
        run(steps, cancel=cancel)
    run(lambda _work: None)  # waits for what was stopped
    assert not working_threads()
    assert len(asked) == 4
    assert steps.done - asked[3] < ENDLESS / 10


def test_cancel_answers_before_all_is_torn_down():
    """Freeing what a large model has taken needs longer than a person waits; the next work waits for it."""
    may_leave, gone = threading.Event(), threading.Event()

    def slow_to_leave(work):
        try:
            Steps()(work)
        finally:
            may_leave.wait(60.0)
            gone.set()

    with pytest.raises(Cancelled):
        run(slow_to_leave, cancel=lambda: True)
    assert not gone.is_set()
    may_leave.set()
    assert run(lambda _work: gone.is_set()), "stopped work is gone before the next begins"
    assert not working_threads()


def test_what_progress_raises_stops_the_work():
    def progress(_fraction, _text):
        raise RuntimeError("the window is gone")

    with pytest.raises(RuntimeError, match="window"):
        run(Steps(), progress)
    run(lambda _work: None)
    assert not working_threads()


def test_ctrl_c_stops_the_work_and_passes_on():
    steps = Steps()
    timer = threading.Timer(0.2, _thread.interrupt_main)
    with pytest.raises(KeyboardInterrupt):
        timer.start()
        run(steps)
    run(lambda _work: None)
    assert not working_threads()
    assert steps.done < ENDLESS


def test_errors_of_the_work_reach_the_caller():
    def task(_work):
        raise InputRefused("so", file="f", line=3, item="here", advice="do that")

    with pytest.raises(InputRefused, match=r"^f:3: here: so; do that$"):
        run(task)


def test_a_defect_of_the_native_part_is_told_as_one():
    def broken(execution):
        raise RuntimeError("an edge has no end")  # as pybind11 has what C++ takes for impossible

    with pytest.raises(BuildFailed, match=r"defect: an edge has no end; please report it"):
        run(lambda work: work.native(broken))


@pytest.mark.parametrize(("has_steps", "text"), [(False, "the phase"), (True, "joining the compartments")])
def test_a_native_call_may_say_what_it_is_doing(has_steps, text):
    def call(execution):
        native_module().build_parts([], (0, []), np.empty((0, 0), np.uint8), execution=execution)
        return work_of_call[0].state()

    def task(work):
        work_of_call.append(work)
        with work.phase(0.0, 0.5, "the phase", has_steps):
            return work.native(call)

    work_of_call = []
    fraction, told = run(task)
    assert told == text
    assert fraction == pytest.approx(0.5)


def test_the_last_call_is_the_end():
    calls = []

    def task(work):
        with work.phase(0.0, 1.0, "quick"):
            pass

    run(task, lambda fraction, text: calls.append((fraction, text)))
    assert calls == [(1.0, "quick")]


def test_a_job_is_looked_after_by_its_handle():
    steps, enough = Steps(lambda: enough.is_set()), threading.Event()
    job = start(steps)
    assert not job.wait(0.05)
    assert not job.done
    assert not job.succeeded
    assert job.state()[1] == "first half"
    enough.set()
    assert job.result() == "done"
    assert job.done
    assert job.succeeded
    assert job.state() == (1.0, "second half")


def test_a_cancelled_job_is_done_at_once_though_its_thread_still_leaves():
    may_leave = threading.Event()
    job = start(lambda _work: may_leave.wait(60.0))
    job.cancel()
    began = time.monotonic()
    assert job.wait()
    assert time.monotonic() - began < 30.0
    with pytest.raises(Cancelled):
        job.result()
    assert not job.succeeded
    assert working_threads()
    may_leave.set()
    run(lambda _work: None)
    assert not working_threads()


def test_what_runs_within_a_job_is_a_part_of_it():
    threads, may_end = [], threading.Event()

    def inner(work):
        threads.append(threading.get_ident())
        with work.phase(0.0, 1.0, "inner"):
            work.step(0.5)
            may_end.wait(60.0)

    def outer(_work):
        threads.append(threading.get_ident())
        run(inner)

    job = start(outer)
    while len(threads) < 2:
        time.sleep(0.01)
    assert threads[0] == threads[1]
    while job.state() != (0.5, "inner"):
        time.sleep(0.01)
    job.cancel()
    may_end.set()
    with pytest.raises(Cancelled):
        job.result()


def test_a_part_of_a_job_has_the_threads_of_the_job_unless_it_says_how_many():
    def task(work):
        parts = [run(lambda part: part.threads, threads=threads) for threads in (0, 1)]
        return [*parts, work.threads]

    assert run(task, threads=3) == [3, 1, 3]


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_items_give_their_results_in_order_on_any_number_of_threads(threads):
    def square(work, number):
        assert work.threads >= 1
        with work.phase(0.0, 1.0, f"item {number}"):
            work.step(0.5)
            return run(lambda inner: inner is work), number**2

    def task(work):
        with work.phase(0.2, 0.8, "items"):
            return work.each(square, range(7))

    assert run(task, threads=threads) == [(True, number**2) for number in range(7)]


@pytest.mark.parametrize("threads", [1, 4])
def test_the_error_is_that_of_the_first_item_that_fails(threads):
    def fail(work, number):
        with work.phase(0.0, 1.0, "failing"):
            if number > 1:
                time.sleep(0.01 * (5 - number))
                raise InputRefused(f"item {number}")

    with pytest.raises(InputRefused, match="item 2"):
        run(lambda work: work.each(fail, range(5)), threads=threads)


@pytest.mark.parametrize("threads", [1, 3])
def test_cancelling_and_progress_reach_all_items(threads):
    calls, ended = [], []

    def endless(work, number):
        try:
            with work.phase(0.0, 1.0, f"item {number}"):
                for step in range(ENDLESS):
                    time.sleep(0.01)
                    work.step(step / 20)
        finally:
            ended.append(number)

    with pytest.raises(Cancelled):
        run(
            lambda work: work.each(endless, range(3)),
            progress=lambda fraction, text: calls.append((fraction, text)),
            cancel=lambda: bool(calls) and calls[-1][0] > 0.15,
            threads=threads,
        )
    run(lambda _work: None)  # waits for what was stopped
    assert sorted(ended) == list(range(min(3, threads)))
    assert [fraction for fraction, _ in calls] == sorted(fraction for fraction, _ in calls)
    assert "item 0" in {text for _, text in calls}


def test_where_memory_ends_is_said():
    def grows(execution):
        raise MemoryError

    def task(work):
        with work.phase(0, 1, "cutting the blocks"):
            work.native(grows)

    with pytest.raises(BuildFailed, match=r"for this model \(cutting the blocks\); use fewer"):
        run(task)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="of GNU's OpenMP library on Linux")
@pytest.mark.parametrize(("before", "policy", "asleep"), [(True, "", 2), (True, "active", 0), (False, "", 0)])
def test_threads_that_wait_sleep_where_openmp_was_loaded_before(before, policy, asleep):
    """It has read its environment then, as in Debian's Blender: two threads that sleep for ever keep others
    from spinning. They do not keep the process from ending."""
    script = (
        "import ctypes, os, time\n"
        + ('ctypes.CDLL("libgomp.so.1")\n' if before else "")
        + "from realmodel.core.base.work import native_module\n"
        "count = len(os.listdir('/proc/self/task'))\n"
        "native_module(); time.sleep(0.2); print(len(os.listdir('/proc/self/task')) - count)\n"
    )
    environment = {key: value for key, value in os.environ.items() if key != "OMP_WAIT_POLICY"}
    environment |= {"PYTHONPATH": str(ROOT / "addon")} | ({"OMP_WAIT_POLICY": policy} if policy else {})
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False, timeout=60)
    assert (done.returncode, done.stdout) == (0, f"{asleep}\n"), done.stderr
