"""Throughput of batches and environments, beside the bare batch in the same process.

`python python/benches/throughput.py [robots]`. Best of three, as on a machine that does other things too.
"""

from __future__ import annotations

import os
import resource
import sys
import time
from collections.abc import Callable

import gymnasium
import numpy as np

import rumbo
import rumbo.envs


def best(count: int, act: Callable[[], object], times: int = 3, rounds: int = 5) -> float:
    """The best rate of `count` things done by `act`, per second."""
    rates = []
    for _ in range(times):
        begun = time.perf_counter()
        for _ in range(rounds):
            act()
        rates.append(rounds * count / (time.perf_counter() - begun))
    return max(rates)


def memory_kb() -> float:
    """The most memory that this process has had."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def of_threads(robots: int, threads: int) -> None:
    """The rates of one number of threads."""
    before = memory_kb()
    batch = rumbo.Batch("mode5", seeds=range(robots), driver="caller", threads=threads)
    each_kb = (memory_kb() - before) / robots
    batch.begin_wheel_speed()
    actions = np.tile(np.array([6.0, 5.0, 0.0], np.float32), (robots, 1))
    batch.drive(actions)
    bare = best(robots, lambda: batch.step(0.1))
    driven = best(robots, lambda: batch.drive(actions))
    print(f"{threads} threads, {robots} robots, {each_kb:.1f} KB each; steps of 0.1 s in a second:")
    print(f"  batch, only advanced             {bare:12,.0f}   ({10 * bare:,.0f} control ticks)")
    print(f"  Batch.drive, with both rows      {driven:12,.0f}   {driven / bare:6.1%}")
    for name in ("WheelSpeed", "Goal"):
        of_environment(name, robots, threads)


def of_environment(name: str, robots: int, threads: int) -> None:
    """The rate of a vector of these, beside that of the same robots on the same way, only advanced."""
    envs = gymnasium.make_vec(f"rumbo/{name}-v0", num_envs=robots, threads=threads)
    actions = np.tile(np.array([0.5, 0.42, 0.0], np.float32), (robots, 1))
    resets_s = []

    def begin() -> None:
        begun = time.perf_counter()
        envs.reset(seed=1)
        resets_s.append(time.perf_counter() - begun)
        envs.step(actions)

    def rate_of(act: Callable[[], object]) -> float:
        rates = []
        for _ in range(3):
            begin()
            rates.append(best(robots, act, times=1, rounds=8))
        return max(rates)

    bare = rate_of(lambda: envs.unwrapped._core.batch.step(0.1))
    rate = rate_of(lambda: envs.step(actions))
    print(
        f"  vector of {name:<12}           {rate:12,.0f}   {rate / bare:6.1%} of {bare:,.0f}, only advanced;", end=" "
    )
    print(f"reset of all {min(resets_s):.2f} s")
    envs.close()


def main() -> None:
    """Prints the figures."""
    robots = int(sys.argv[1]) if len(sys.argv) > 1 else 4096
    print(f"rumbo {rumbo.__version__}, NumPy {np.__version__}, {os.cpu_count()} cores")
    for threads in sorted({1, os.cpu_count() or 1}):
        of_threads(robots, threads)
    env = gymnasium.make("rumbo/WheelSpeed-v0").unwrapped
    env.reset(seed=1)
    action = np.array([0.5, 0.42, 0.0], np.float32)

    def one_episode() -> None:
        env.reset()
        for _ in range(50):
            env.step(action)

    print(f"one environment: {best(50, one_episode):,.0f} steps in a second, resets included")
    begun = time.perf_counter()
    rumbo.run("mode1", seeds=range(500))
    print(f"rumbo.run: 500 runs of mode1 (9 s each) in {time.perf_counter() - begun:.2f} s")


if __name__ == "__main__":
    main()
