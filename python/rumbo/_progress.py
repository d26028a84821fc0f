"""How much of something is done, on stderr or by a caller's function."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator


@contextlib.contextmanager
def shown(progress: bool | Callable[[float], object], what: str = "") -> Iterator[Callable[[float], object] | None]:
    """What to call with the share that is done: the caller's function, or one that shows it."""

    def show(share: float) -> None:
        print(f"\r{100 * share:.0f} %{what}", end="", file=sys.stderr, flush=True)

    yield progress if callable(progress) else show if progress else None
    if progress is True:
        print(file=sys.stderr)
