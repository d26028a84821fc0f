"""How much of something is done, on stderr or by a caller's function."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterator


class Bar:
    """A line on stderr that tells how much is done, how fast, and how long the rest may take."""

    def __init__(self, what: str = "", total: int | None = None, first: float = 0.0) -> None:
        """``total`` runs are to be done, of which ``first`` were done before; without it, shares are shown."""
        self._what, self._total = what, total
        self._began_s = self._shown_s = time.monotonic()
        #: What was done before, which tells nothing of how fast the rest is.
        self._first = first
        self._width = 0

    def show(self, done: float) -> None:
        """Shows the number of finished runs, or the share; at most ten times a second, but always the last."""
        now_s = time.monotonic()
        of = 1.0 if self._total is None else float(self._total)
        if now_s - self._shown_s < 0.1 and done < of:
            return
        self._shown_s = now_s
        gone_s = now_s - self._began_s
        rate = (done - self._first) / gone_s if gone_s > 0 else 0.0
        text = f"{100 * done:.0f} %{self._what}" if self._total is None else f"{done:.0f} of {self._total} runs"
        if self._total is not None and rate > 0:
            text += f", {rate:.3g} a second"
        if rate > 0 and done < of:
            text += f", {_duration((of - done) / rate)} left"
        elif done >= of:
            text += f", {_duration(gone_s)}"
        print("\r" + text.ljust(self._width), end="", file=sys.stderr, flush=True)
        self._width = len(text)

    def end(self) -> None:
        """Leaves the line."""
        if self._width:
            print(file=sys.stderr)
            self._width = 0


def _duration(seconds: float) -> str:
    if seconds < 60:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 60 else f"{minutes // 60} h {minutes % 60} min"


@contextlib.contextmanager
def shown(progress: bool | Callable[[float], object], what: str = "") -> Iterator[Callable[[float], object] | None]:
    """What to call with the share that is done: the caller's function, or one that shows it."""
    if callable(progress) or not progress:
        yield progress if callable(progress) else None
        return
    bar = Bar(what)
    try:
        yield bar.show
    finally:
        bar.end()


@contextlib.contextmanager
def counted(
    progress: bool | Callable[[int, int], object], total: int, done: int = 0
) -> Iterator[Callable[[int], object] | None]:
    """What to call with the number of finished runs of ``total``, of which ``done`` were done before."""
    if callable(progress):
        report = progress
        yield lambda finished: report(finished, total)
        return
    if not progress:
        yield None
        return
    bar = Bar(total=total, first=done)
    try:
        yield bar.show
    finally:
        bar.end()
