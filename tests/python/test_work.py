"""Long work: progress, cancelling, Ctrl-C, threads, workers."""

import logging
import os
import pathlib
import signal
import sys
import threading
import time
import types

import numpy
import pytest

import hemi


@pytest.fixture(scope="module")
def large_box(make_box):
    """Takes many seconds, which no test waits for."""
    return make_box(patches_per_face=1600)


def workers():
    """Processes of the worker program that this process has started."""
    found = []
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            parent = int((process / "stat").read_text().rsplit(")", 1)[1].split()[1])
            program = os.readlink(process / "exe")
        except OSError:
            continue # ended meanwhile
        if parent == os.getpid() and program == os.path.realpath(hemi.worker_program()):
            found.append(process.name)
    return found


def test_the_worker_program_is_that_of_the_build():
    program = pathlib.Path(hemi.worker_program())
    assert program.name == "hemi-hemicube-worker" and os.access(program, os.X_OK)


@pytest.mark.parametrize("jobs", [1, 2])
def test_rows_come_from_as_many_workers_as_are_asked_for(make_box, jobs):
    seen = set()
    factors = hemi.form_factors(make_box(patches_per_face=100), "plain", device="osmesa", jobs=jobs, estimate=False,
                                progress=lambda *_: seen.update(workers()))
    assert len(seen) == jobs and factors.known.all()
    assert workers() == []


def test_workers_do_not_change_a_bit(small_box):
    one = hemi.form_factors(small_box, device="osmesa", jobs=1)
    two = hemi.form_factors(small_box, device="osmesa", jobs=2)
    assert one.matrix.data.tobytes() == two.matrix.data.tobytes()


def test_progress_tells_phases_and_their_ends(small_box):
    calls = []
    factors = hemi.form_factors(small_box, device="osmesa", progress=lambda *call: calls.append(call))
    phases = list(dict.fromkeys(phase for phase, _, _ in calls))
    assert phases == ["visibility", "combining pairs", "form factors", "comparing rows", "closing rows"]
    for phase in phases[:3]:
        done = [done for name, done, _ in calls if name == phase]
        assert done == sorted(done) and done[-1] == 54
        assert {total for name, _, total in calls if name == phase} == {54}
    calls.clear()
    factors.solve(progress=lambda *call: calls.append(call))
    assert {phase for phase, _, _ in calls} == {"solving", "estimating the error"}


def test_false_cancels(large_box):
    calls = []

    def stop(*call):
        calls.append(call)
        return len(calls) < 3

    started = time.monotonic()
    with pytest.raises(hemi.Cancelled, match="interrupted"):
        hemi.form_factors(large_box, device="osmesa", progress=stop)
    assert len(calls) == 3 and time.monotonic() - started < 20
    assert workers() == []


def test_an_exception_of_the_callback_comes_out(large_box):
    def fail(*_):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        hemi.form_factors(large_box, device="osmesa", progress=fail)
    assert workers() == []


def test_ctrl_c_raises_keyboard_interrupt(large_box):
    timer = threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    started = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        hemi.form_factors(large_box, device="osmesa")
    assert 0.9 < time.monotonic() - started < 20
    assert workers() == []


def test_ctrl_c_stops_baseline_methods(make_box):
    scene = make_box(patches_per_face=625)
    timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    started = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        hemi.form_factors(scene, method="montecarlo", rays=32768)
    assert 0.4 < time.monotonic() - started < 20


def test_other_threads_run_meanwhile(make_box):
    ticks = []
    stop = threading.Event()

    def tick():
        while not stop.wait(0.01):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=tick)
    thread.start()
    started = time.monotonic()
    hemi.form_factors(make_box(patches_per_face=100), device="osmesa")
    taken = time.monotonic() - started
    stop.set()
    thread.join()
    assert len(ticks) > 20 * taken


def test_two_threads_take_turns(small_box, small_factors):
    results = []
    threads = [threading.Thread(target=lambda: results.append(hemi.form_factors(small_box, "fast", device="osmesa")))
               for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [result.matrix.data.tobytes() for result in results] == [small_factors.matrix.data.tobytes()] * 3


def test_a_callback_cannot_start_more_work(small_box):
    with pytest.raises(hemi.Error, match="callback of its own work"):
        hemi.form_factors(small_box, device="osmesa",
                          progress=lambda *_: hemi.form_factors(small_box, device="osmesa"))
    assert len(hemi.form_factors(small_box, "plain", device="osmesa")) == 54


def test_true_shows_bars_by_tqdm(small_box, monkeypatch):
    bars = []

    class Tqdm:
        def __init__(self, total, desc):
            self.total, self.desc, self.n, self.closed = total, desc, 0, False
            bars.append(self)

        def update(self, count):
            self.n += count

        def close(self):
            self.closed = True

    module = types.ModuleType("tqdm.auto")
    module.tqdm = Tqdm
    monkeypatch.setitem(sys.modules, "tqdm", types.ModuleType("tqdm"))
    monkeypatch.setitem(sys.modules, "tqdm.auto", module)
    hemi.form_factors(small_box, device="osmesa", progress=True)
    assert [bar.desc for bar in bars] == ["visibility", "combining pairs", "form factors", "comparing rows", "closing rows"]
    assert all(bar.closed and bar.n == bar.total for bar in bars)


def test_true_without_tqdm_says_what_to_do(small_box, monkeypatch):
    monkeypatch.setitem(sys.modules, "tqdm", None)
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    with pytest.raises(ImportError, match="tqdm"):
        hemi.form_factors(small_box, progress=True)
    with pytest.raises(TypeError, match="progress"):
        hemi.form_factors(small_box, progress=3)


def test_notes_and_warnings_are_pythons(make_box, caplog):
    caplog.set_level(logging.DEBUG, "hemi")
    hemi.form_factors(make_box(), method="direct", estimate=False)
    assert "unoccluded" in caplog.text
    scene = make_box(patches_per_face=64)
    with pytest.warns(hemi.HemiWarning, match="see max_memory"):
        factors = hemi.form_factors(scene, device="osmesa", max_memory=1_400_000)
    assert factors.visibility is None and numpy.isclose(factors.row_sums, 1).all()


@pytest.mark.filterwarnings("error::hemi.HemiWarning")
def test_a_warning_that_is_an_error_stops_the_work(make_box):
    with pytest.raises(hemi.HemiWarning, match="max_memory"):
        hemi.form_factors(make_box(patches_per_face=64), device="osmesa", max_memory=1_400_000)
