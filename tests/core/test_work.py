# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work in a thread: progress often enough, cancelling soon enough, nothing left running."""

import _thread
import threading
import time

import pytest
from conftest import least_of, unevenness
from realmodel.core import Cancelled, InputRefused
from realmodel.core.work import run


def in_steps(work, seconds=1.0, steps=200):
    with work.phase(0.0, 0.5, "first half"):
        for step in range(steps // 2):
            time.sleep(seconds / steps)
            work.step(step / (steps // 2))
    with work.phase(0.5, 1.0, "second half"):
        for step in range(steps // 2):
            time.sleep(seconds / steps)
            work.step(step / (steps // 2))
    return "done"


def working_threads():
    return [thread for thread in threading.enumerate() if thread.name == "realmodel work"]


def test_progress_ten_times_a_second_and_never_falling():
    caller = threading.get_ident()

    def watched():
        calls = []

        def progress(fraction, text):
            assert threading.get_ident() == caller
            calls.append((time.perf_counter(), fraction, text))

        assert run(in_steps, progress) == "done"
        times, fractions, texts = zip(*calls, strict=True)
        assert list(fractions) == sorted(fractions)
        assert fractions[0] >= 0.0
        assert fractions[-1] == 1.0
        assert list(texts) == sorted(texts)
        return max(unevenness(times), fractions[0] / 0.2)

    assert least_of(watched, 1.0) < 1.0


def test_cancel_stops_soon_and_leaves_no_thread():
    def seconds_to_stop():
        asked = []

        def cancel():
            asked.append(time.perf_counter())
            return len(asked) > 3

        with pytest.raises(Cancelled):
            run(lambda work: in_steps(work, 60.0, 6000), cancel=cancel)
        assert not working_threads()
        return time.perf_counter() - asked[3]

    assert least_of(seconds_to_stop, 0.2) < 0.2


def test_cancel_answers_before_all_is_torn_down():
    """Freeing what a large model has taken needs longer than a person waits; the next work waits for it."""
    gone = threading.Event()

    def slow_to_leave(work):
        try:
            in_steps(work, 60.0, 6000)
        finally:
            time.sleep(1.0)
            gone.set()

    asked = []

    def cancel():
        asked.append(time.perf_counter())
        return True

    with pytest.raises(Cancelled):
        run(slow_to_leave, cancel=cancel)
    assert time.perf_counter() - asked[0] < 0.5
    assert not gone.is_set()
    assert run(lambda _work: gone.is_set()), "stopped work is gone before the next begins"
    assert not working_threads()


def test_what_progress_raises_stops_the_work():
    def progress(_fraction, _text):
        raise RuntimeError("the window is gone")

    with pytest.raises(RuntimeError, match="window"):
        run(lambda work: in_steps(work, 60.0, 6000), progress)
    assert not working_threads()


def test_ctrl_c_stops_the_work_and_passes_on():
    def seconds_to_stop():
        pressed = []

        def press():
            pressed.append(time.perf_counter())
            _thread.interrupt_main()

        timer = threading.Timer(0.2, press)
        with pytest.raises(KeyboardInterrupt):
            timer.start()
            run(lambda work: in_steps(work, 60.0, 6000))
        assert not working_threads()
        return time.perf_counter() - pressed[0]

    assert least_of(seconds_to_stop, 0.3) < 0.3


def test_errors_of_the_work_reach_the_caller():
    def task(_work):
        raise InputRefused("so", file="f", line=3, item="here", advice="do that")

    with pytest.raises(InputRefused, match=r"^f:3: here: so; do that$"):
        run(task)


def test_the_last_call_tells_the_end():
    calls = []

    def task(work):
        with work.phase(0.0, 1.0, "quick"):
            pass

    run(task, lambda fraction, text: calls.append((fraction, text)))
    assert calls == [(1.0, "quick")]
