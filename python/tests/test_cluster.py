"""Sweeps in pieces, on whatever workers: the bytes of a sweep on one machine. Ray's own tests are in test_ray.py."""

from __future__ import annotations

import concurrent.futures
import importlib.util
import multiprocessing
import pathlib
import pickle
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from typing import Any

import numpy as np
import pytest

import rumbo
from rumbo import _cluster, _rumbo, _setup

AXES = {"front_kp": "2:10:5", "battery.open_circuit_v": [7.0, 8.0]}
#: Seeds beyond the largest begin again.
WRAPPING = [(2**64 - 3 + number) % 2**64 for number in range(20)]


class Processes:
    """Two processes that share nothing with this one."""

    workers = 2

    def __init__(self) -> None:
        spawn = multiprocessing.get_context("spawn")
        self.pool = concurrent.futures.ProcessPoolExecutor(self.workers, mp_context=spawn)
        self.sizes: list[int] = []
        self.cancelled = 0

    def submit(self, work: Callable[[Any], Any], argument: Any) -> Future[Any]:
        self.sizes.append(len(argument))
        return self.pool.submit(work, argument)

    def cancel(self, future: Future[Any]) -> None:
        self.cancelled += 1
        future.cancel()


@pytest.fixture(scope="module")
def processes() -> Iterator[Processes]:
    workers = Processes()
    with workers.pool:
        yield workers


def assert_same(one: rumbo.Sweep, other: rumbo.Sweep) -> None:
    """To the last bit, and in the same order."""
    columns, others = one.to_dict(), other.to_dict()
    assert list(columns) == list(others)
    for name, column in columns.items():
        assert column.dtype == others[name].dtype and column.tobytes() == others[name].tobytes(), name
    assert one.fingerprint == other.fingerprint


def test_a_sweep_in_pieces_has_the_bytes_of_one_in_a_piece(processes: Processes) -> None:
    processes.sizes.clear()
    counts: list[tuple[int, int]] = []
    here = rumbo.sweep("mode1", AXES, seeds=WRAPPING)
    there = rumbo.sweep("mode1", AXES, seeds=WRAPPING, cluster=processes, progress=lambda *count: counts.append(count))
    assert_same(here, there)
    assert counts == [(done, 200) for done in range(1, 201)]
    assert len(processes.sizes) > 6 and max(processes.sizes) > 1 and sum(processes.sizes) == 200


def test_a_setup_takes_its_files_with_it(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    robot = rumbo.load("robot", "memoria")
    world = rumbo.load("world", "room")
    (tmp_path / "own.toml").write_text(_setup.to_toml(robot, "robot"), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    ways: list[dict[str, Any]] = [
        {"robot": "own.toml", "parameters": {"front_kp": 3.0}},
        {"program": "baseline", "randomize": False},
        {"world": world},
    ]
    setups = [_setup.make_setup("mode1", **ways[0]), _setup.make_setup("mode1", **ways[1])]
    setups.append(_setup.make_setup("mode8-goals", **ways[2]))
    packed = [pickle.dumps(setup) for setup in setups]
    (tmp_path / "own.toml").unlink()

    def runs(setup: _rumbo.Setup) -> str:
        return repr(_rumbo.run(setup, [1, 2], threads=1, trace=False, progress=None))

    assert [runs(pickle.loads(text)) for text in packed] == [runs(setup) for setup in setups]
    assert len({runs(setup) for setup in setups}) == 3


@pytest.mark.parametrize("where", ["here", "processes"])
def test_what_is_done_at_ctrl_c_is_kept_and_the_rest_added(where: str, processes: Processes) -> None:
    def stop(done: int, _: int) -> None:
        if done == 50:
            signal.raise_signal(signal.SIGINT)

    processes.cancelled = 0
    cluster = processes if where == "processes" else None
    with pytest.raises(rumbo.Interrupted, match="50 runs are done") as stopped:
        rumbo.sweep("mode1", AXES, seeds=range(1, 21), cluster=cluster, progress=stop)
    assert (processes.cancelled > 0) == (where == "processes")
    done = pickle.loads(pickle.dumps(stopped.value.done))
    assert len(done) == 50 and len(done.points["front_kp"]) == 10
    counts: list[int] = []
    whole = rumbo.sweep("mode1", AXES, seeds=range(1, 21), resume=done, progress=lambda count, _: counts.append(count))
    assert counts == list(range(51, 201))
    assert_same(whole, rumbo.sweep("mode1", AXES, seeds=range(1, 21)))
    with pytest.raises(ValueError, match="is of another sweep"):
        rumbo.sweep("mode1", AXES, seeds=range(1, 20), resume=done)
    with pytest.raises(ValueError, match="is of another sweep"):
        rumbo.sweep("mode1", AXES, seeds=range(1, 21), resume=done, parameters={"front_brake_m_s2": 0.3})


class Inline:
    """A worker of this process, done when it is asked, with which a test does as it likes."""

    workers = 1

    def __init__(self, change: Callable[[Any], Any]) -> None:
        self.change = change
        self.cancelled: list[Future[Any]] = []

    def submit(self, work: Callable[[Any], Any], argument: Any) -> Future[Any]:
        future: Future[Any] = Future()
        try:
            future.set_result(self.change(work(argument)))
        except Exception as error:
            future.set_exception(error)
        return future

    def cancel(self, future: Future[Any]) -> None:
        self.cancelled.append(future)


def test_an_error_of_a_worker_ends_the_sweep() -> None:
    def broken(_: Any) -> None:
        raise OSError("the disk is gone")

    workers = Inline(broken)
    with pytest.raises(OSError, match="the disk is gone"):
        rumbo.sweep("mode1", AXES, cluster=workers)
    assert len(workers.cancelled) == _cluster.AHEAD


def test_a_worker_with_another_rumbo_is_refused() -> None:
    setup = _setup.make_setup("mode1")
    with pytest.raises(RuntimeError, match="Rumbo 0.0.1, model 7: install the same one everywhere"):
        _cluster.run_piece(("0.0.1", 7), setup, ["front_kp"], [([5.0], 1)])


def test_threads_are_not_for_a_cluster_that_runs() -> None:
    with pytest.raises(ValueError, match="has its own workers"):
        rumbo.sweep("mode1", AXES, cluster=Inline(lambda done: done), threads=2)


def test_pieces_last_about_two_seconds_and_the_last_ones_end_together() -> None:
    # A run of a tenth of a second, by the clock of the worker.
    sizes: list[int] = []

    def slowly(done: tuple[list[Any], float]) -> tuple[list[Any], float]:
        sizes.append(len(done[0]))
        return done[0], 0.1 * len(done[0])

    rumbo.sweep("mode1", {"front_kp": [5.0]}, seeds=range(200), cluster=Inline(slowly))
    assert max(sizes) == 20 and sizes[-1] == 1
    assert np.sum(sizes) == 200


@pytest.mark.skipif(importlib.util.find_spec("ray") is not None, reason="Ray is installed")
def test_a_cluster_without_ray_says_what_to_install() -> None:
    with pytest.raises(ModuleNotFoundError, match=r"pip install 'rumbo\[ray\]'"):
        rumbo.sweep("mode1", AXES, cluster="local")
