"""Long work: callbacks, their exceptions, Ctrl-C, threads."""

from __future__ import annotations

import gc
import signal
import threading
import time
import weakref
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import stick_slip as ss

LAW = ss.Polynomial(0.4, 0.25, 0.5)
ORBIT = ss.settle(ss.MassOnBelt(LAW, 0.2, damping=0.05), (0.0, 0.0), 60.0, estimate=6.8)


def family(belt_velocity: float) -> ss.MassOnBelt:
    return ss.MassOnBelt(LAW, belt_velocity, damping=0.05)


def test_progress_is_reported_and_may_stop() -> None:
    seen: list[ss.Progress] = []
    # What a function returns is ignored but for False: bar.update of tqdm returns True or None.
    whole = ss.follow(family, 0.2, ORBIT, 0.1, 0.3, progress=lambda p: seen.append(p))
    assert seen[-1].points >= len(whole) - 2 and seen[-1].steps > 100
    assert all(0.05 < p.value < 0.35 for p in seen) and "Progress(" in repr(seen[0])
    part = ss.follow(family, 0.2, ORBIT, 0.1, 0.3, progress=lambda p: p.points < 5)
    assert part.ends[1].kind == "stopped" and 5 <= len(part) < len(whole)
    assert set(part.parameters) <= set(whole.parameters)
    again = ss.follow(family, 0.2, ORBIT, 0.1, 0.3, progress=lambda p: True)
    assert np.array_equal(again.parameters, whole.parameters)


@pytest.mark.parametrize("exception", [KeyError("mine"), KeyboardInterrupt(), SystemExit(3)])
def test_an_exception_of_a_family_keeps_what_was_found(exception: BaseException) -> None:
    calls = 0

    def failing(belt_velocity: float) -> ss.MassOnBelt:
        nonlocal calls
        if belt_velocity > 0.25:
            calls += 1
            raise exception
        return family(belt_velocity)

    with pytest.raises(type(exception)) as caught:
        ss.follow(failing, 0.2, ORBIT, 0.1, 0.3)
    assert caught.value is exception and calls == 1
    found = caught.value.found  # type: ignore[union-attr]
    assert isinstance(found, ss.Branch) and len(found) > 3


def test_an_error_of_the_package_ends_a_branch() -> None:
    def ends(belt_velocity: float) -> ss.MassOnBelt:
        return ss.MassOnBelt(LAW, belt_velocity, damping=0.05 if belt_velocity < 0.25 else -1.0)

    branch = ss.follow(ends, 0.2, ORBIT, 0.1, 0.3)
    end = branch.ends[1]
    assert end.kind == "lost" and end.parameter == pytest.approx(0.25, abs=1e-6)
    assert "damping" in end.reason


def test_an_exception_of_a_callback_is_raised() -> None:
    def broken(progress: ss.Progress) -> None:
        raise RuntimeError("broken bar")

    for call in (
        lambda: ss.follow(family, 0.2, ORBIT, 0.1, 0.3, progress=broken),
        lambda: ss.grazing_velocities(family(0.2), 0.1, 0.5, progress=broken),
        lambda: ss.diagram(family(0.2), [0.1, 0.2], progress=broken),
    ):
        with pytest.raises(RuntimeError, match="broken bar"):
            call()


def test_a_family_must_return_a_system() -> None:
    with pytest.raises(TypeError):
        ss.follow(lambda v: v, 0.2, ORBIT, 0.1, 0.3)  # type: ignore[arg-type, return-value]
    with pytest.raises(TypeError, match="family is a function"):
        ss.vibration_ranges(7, 0.1, 0.3)  # type: ignore[arg-type]


def interrupted(work: Callable[[], Any]) -> tuple[Any, float]:
    """What Ctrl-C after 0.2 s leaves of the work, and how long it took to end."""
    if threading.current_thread() is not threading.main_thread() or not hasattr(signal, "SIGALRM"):
        pytest.skip("signals reach the main thread of Unix")
    sent = 0.0

    def interrupt(*_: Any) -> None:
        nonlocal sent
        sent = time.perf_counter()
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, 0.2)
    try:
        with pytest.raises(KeyboardInterrupt) as caught:
            work()
        return getattr(caught.value, "found", None), time.perf_counter() - sent
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def chain(belt_velocity: float) -> ss.Structure:
    built = ss.Structure([1.0] * 4)
    for i in range(4):
        contact = ss.Contact(i, LAW, 1.0 + 0.1 * i, belt_velocity=belt_velocity)
        built = built.with_ground_spring(i, 1.0).with_ground_damper(i, 0.1).with_contact(contact)
    for i in range(3):
        built = built.with_spring(i, i + 1, 0.7)
    return built


def test_ctrl_c_ends_work_and_keeps_what_was_found() -> None:
    start = ([0.0] * 4, [0.0, 0.1, -0.1, 0.0])
    motion, delay = interrupted(lambda: chain(0.2).simulate(start, 1e7, max_steps=10**8))
    assert isinstance(motion, ss.Motion) and motion.duration > 100 and delay < 1.0
    _, delay = interrupted(
        lambda: ss.settle(chain(0.2), start, 1e7, estimate=7.0, max_steps=10**9)
    )
    assert delay < 1.0
    points, delay = interrupted(lambda: ss.diagram(family(0.2), np.linspace(0.05, 0.43, 10**6)))
    assert isinstance(points, ss.Diagram) and len(points) > 10 and delay < 1.0
    (q, _), delay = interrupted(lambda: ss.section(chain(0.2), start, 7.0, 10**7))
    assert q.shape[1] == 4 and delay < 1.0
    samples, delay = interrupted(lambda: motion.samples(motion.duration / 8e6))
    assert isinstance(samples, ss.Samples) and len(samples) > 100 and delay < 1.0


def test_the_lock_is_released() -> None:
    """A thread of Python works while another one simulates."""
    ticks = 0
    done = threading.Event()

    def tick() -> None:
        nonlocal ticks
        while not done.is_set():
            ticks += 1
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.perf_counter()
    while time.perf_counter() - begin < 0.3:
        family(0.2).simulate((0.0, 0.0), 50_000.0, max_steps=10**8)
    done.set()
    thread.join()
    assert ticks > 20


def test_a_family_that_holds_its_own_search_is_collected() -> None:
    class Family:
        search: ss.Along

        def __call__(self, belt_velocity: float) -> ss.MassOnBelt:
            return family(belt_velocity)

    held = Family()
    held.search = ss.along(held, 0.1, 0.3)
    alive = weakref.ref(held)
    del held
    gc.collect()
    assert alive() is None


def test_results_of_threads_are_the_same_bits() -> None:
    found: list[Any] = [None] * 4

    def work(i: int) -> None:
        found[i] = ss.follow(family, 0.2, ORBIT, 0.1, 0.45).periods

    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(found[0], other) for other in found)
