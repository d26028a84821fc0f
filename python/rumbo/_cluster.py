"""Work cut into pieces for other processes, here or on other machines, and put together again.

::

    jobs ─► pieces of about two seconds ─► workers ─► results in any order, by the number of their job

A job is a point and a seed, and a run depends on nothing else: whichever worker does it, and however often.
"""

from __future__ import annotations

import contextlib
import functools
import queue
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from typing import Any, Protocol, TypeAlias

from . import _rumbo

#: The values of the parameters that vary, and a seed.
Job: TypeAlias = tuple[list[float], int]
#: Whether a run passed, and its metrics.
Row: TypeAlias = tuple[bool, dict[str, float]]

#: How long a piece is to take [s]: what a worker that dies costs, and a thousand times what a piece costs besides.
PIECE_S = 2.0
#: At most so many pieces a second are handed out [1/s]: Ray takes about 1 ms for each.
PIECES_PER_S = 100
#: Pieces handed out for each worker, so that none waits for its next one.
AHEAD = 3


class Cluster(Protocol):
    """Workers that call functions."""

    #: How many pieces are worked on at once.
    workers: int

    def submit(self, work: Callable[[Any], Any], argument: Any) -> Future[Any]:
        """Has a worker call ``work(argument)``; ``work`` is the same for many calls."""
        ...

    def cancel(self, future: Future[Any]) -> None:
        """Ends a call, whether it has begun or not."""
        ...


@contextlib.contextmanager
def connected(cluster: str | Cluster, threads: int | None) -> Iterator[Cluster]:
    """The cluster of a sweep, which is given up at the end if it was only named."""
    if not isinstance(cluster, str):
        if threads is not None:
            raise ValueError(f"threads = {threads}: a cluster has its own workers; leave it out")
        yield cluster
        return
    from . import ray

    with ray.Cluster(cluster, workers=threads) as workers:
        yield workers


def run_on(
    cluster: Cluster,
    setup: _rumbo.Setup,
    names: list[str],
    jobs: Sequence[Job],
    handle: Callable[[int, Row], None],
) -> None:
    """Has the workers run all jobs; ``handle`` gets the number of each job and its row, in any order.

    The first error, Ctrl-C included, ends what the workers do.
    """
    work = functools.partial(run_piece, (_rumbo.VERSION, _rumbo.MODEL), setup, names)
    done: queue.SimpleQueue[Future[Any]] = queue.SimpleQueue()
    pending: dict[Future[Any], range] = {}
    piece_s = max(PIECE_S, cluster.workers / PIECES_PER_S)
    begun, finished, busy_s = 0, 0, 0.0
    try:
        while begun < len(jobs) or pending:
            while begun < len(jobs) and len(pending) < AHEAD * cluster.workers:
                # One run each at first, to see how long it takes; small ones at the end, so that all end at once.
                lasting = piece_s * finished / busy_s if busy_s > 0 else 1
                fair = (len(jobs) - begun) / (AHEAD * cluster.workers)
                size = max(1, int(min(lasting, fair)))
                piece = range(begun, min(begun + size, len(jobs)))
                future = cluster.submit(work, [jobs[index] for index in piece])
                begun = piece.stop
                pending[future] = piece
                future.add_done_callback(done.put)
            future = done.get()
            rows, took_s = future.result()
            piece = pending.pop(future)
            finished, busy_s = finished + len(piece), busy_s + took_s
            for index, row in zip(piece, rows):
                handle(index, row)
    finally:
        for future in pending:
            cluster.cancel(future)


def run_piece(
    made_by: tuple[str, int], setup: _rumbo.Setup, names: list[str], jobs: list[Job]
) -> tuple[list[Row], float]:
    """What a worker does: the rows of the jobs, and how long they took [s]."""
    own = (_rumbo.VERSION, _rumbo.MODEL)
    if own != made_by:
        raise RuntimeError(
            f"a worker has Rumbo {own[0]}, model {own[1]}, and this process Rumbo {made_by[0]}, model {made_by[1]}: "
            "install the same one everywhere"
        )
    began_s = time.perf_counter()
    rows: list[Row] = []
    _rumbo.run_jobs(setup, names, jobs, threads=1, handle=lambda passed, metrics: rows.append((passed, metrics)))
    return rows, time.perf_counter() - began_s
