"""What Ray costs a sweep, and what bounds a large cluster: `python python/benches/on_ray.py [runs]`, on two cores.

`RUMBO_COMMAND` names the `rumbo` command to compare with. Beside other work the figures vary: passes alternate, and the
best of each counts.
"""

from __future__ import annotations

import functools
import os
import pickle
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable

import rumbo
import rumbo.ray
from rumbo import _cluster, _setup

WORKERS = 2
PASSES = 3
POINTS = 100
EMPTY = 1_000
ROWS = 1_000
CORES = 1_000


def timed(act: Callable[[], object]) -> float:
    """How long it takes [s]."""
    began_s = time.perf_counter()
    act()
    return time.perf_counter() - began_s


def nothing(jobs: list[_cluster.Job]) -> None:
    """A piece without runs."""


def main() -> None:
    """Measures and prints."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 20_000
    each = max(1, runs // POINTS)
    axes = {"front_kp": f"1:20:{POINTS}"}
    command = [os.environ.get("RUMBO_COMMAND", ""), "sweep", "mode1", f"front_kp={axes['front_kp']}"]
    command += ["--runs", str(each), "--threads", str(WORKERS), "--force", "--out"]
    times: dict[str, list[float]] = {"rumbo sweep": [], "threads": [], "Ray": []}
    began_s = time.perf_counter()
    with rumbo.ray.Cluster("local", workers=WORKERS) as cluster:
        up_s = time.perf_counter() - began_s
        # Both processes are there.
        rumbo.sweep("mode1", axes, seeds=1, cluster=cluster)
        for _ in range(PASSES):
            if command[0]:
                with tempfile.TemporaryDirectory() as folder:
                    words = [*command, folder]
                    times["rumbo sweep"].append(
                        timed(functools.partial(subprocess.run, words, check=True, capture_output=True))
                    )
            times["threads"].append(
                timed(lambda: rumbo.sweep("mode1", axes, seeds=range(1, each + 1), threads=WORKERS))
            )
            times["Ray"].append(timed(lambda: rumbo.sweep("mode1", axes, seeds=range(1, each + 1), cluster=cluster)))
        cluster.submit(nothing, []).result()
        began_s = time.perf_counter()
        for future in [cluster.submit(nothing, []) for _ in range(EMPTY)]:
            future.result()
        dispatch_s = time.perf_counter() - began_s
    jobs: list[_cluster.Job] = [([5.0], seed) for seed in range(ROWS)]
    made_by = (rumbo.__version__, rumbo.MODEL)
    rows, run_s = _cluster.run_piece(made_by, _setup.make_setup("mode1"), ["front_kp"], jobs)
    sent, received = pickle.dumps(jobs), pickle.dumps(rows)
    kept: dict[int, _cluster.Row] = {}
    keep_s = min(timed(lambda: kept.update(enumerate(pickle.loads(received)))) for _ in range(PASSES))
    best = {name: min(found) for name, found in times.items() if found}
    each_s, row_s, piece_s = run_s / ROWS, keep_s / ROWS, dispatch_s / EMPTY
    print(f"{POINTS * each} runs of mode1, {WORKERS} cores, best of {PASSES}")
    for name, found_s in best.items():
        print(f"{name:<12} {found_s:6.2f} s, {100 * (found_s / best['threads'] - 1):+5.1f} % of the threads")
    print(f"cluster up in {up_s:.1f} s, once")
    print(f"a run {1e3 * each_s:.2f} ms; a piece {1e3 * piece_s:.2f} ms of the process that hands out")
    print(f"a job {len(sent) / ROWS:.0f} bytes, a row {len(received) / ROWS:.0f} bytes and {1e6 * row_s:.1f} us there")
    lasts_s = max(_cluster.PIECE_S, CORES / _cluster.PIECES_PER_S)
    rows_s = CORES / each_s
    share = CORES / lasts_s * piece_s + rows_s * row_s
    print(f"{CORES} cores: pieces of {lasts_s:.0f} s, {CORES / lasts_s:.0f} pieces and {rows_s:.0f} rows a second,")
    print(f"{rows_s * len(received) / ROWS / 1e6:.0f} MB/s: {100 * share:.0f} % of a core to hand out and collect")


if __name__ == "__main__":
    main()
