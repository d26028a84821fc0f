"""Logs: what a session or a run recorded, as arrays."""

from __future__ import annotations

import errno
import json
import os
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from . import _display, _rumbo


@dataclass(frozen=True)
class Log:
    """A log in memory. Times are in s since its start."""

    #: The telemetry, with ground truth beside it (``true_x_m``) where the robot was simulated: an array for each signal
    #: that is known at any time, units in the names. NaN where unknown, inf where a range is clear.
    signals: dict[str, NDArray[Any]]
    #: Signals beside the telemetry by their source, each with a ``t_s`` of its own: ``loops`` for what the control
    #: loops of a simulated robot add up, ``truth`` for the pins of an emulated one, ``usart0`` for the numbers that its
    #: program printed there.
    readings: dict[str, dict[str, NDArray[Any]]]
    #: What happened: time [s], level, text.
    events: list[tuple[float, str, str]]
    #: The parameters as known at the end, by name.
    parameters: dict[str, float]
    #: What ran: scenario, robot, world, seed, version, and the files themselves; ``None`` where not recorded.
    manifest: dict[str, Any] | None
    #: ``passed``, ``metrics`` and ``failures``; ``None`` where it was not judged.
    outcome: dict[str, Any] | None
    #: Why the log ends early, if it does, such as that of a killed session.
    cut: str | None
    #: What its reader should know.
    notes: tuple[str, ...]

    def __repr__(self) -> str:
        count = len(next(iter(self.signals.values()))) if self.signals else 0
        what = (self.manifest or {}).get("scenario") or "no scenario"
        last_s = float(self.signals["t_s"][-1]) if count else 0.0
        return (
            f"<log of {what}: {count} rows of {len(self.signals)} signals, {last_s:.1f} s, {len(self.events)} events>"
        )

    def _repr_html_(self) -> str:
        return _display.log(self)

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """The signals as `pandas.DataFrame` and `pyarrow.table` take them."""
        return dict(self.signals)


def read_log(path: str | os.PathLike[str]) -> Log:
    """Reads a log (``.mcap``) of a session or a run, whole or cut off.

    Raises:
        FileNotFoundError, OSError: The file is not there, or cannot be read.
        ValueError: It is no log.
    """
    parts = _rumbo.read_log(os.fspath(path))
    if parts["manifest"] is not None:
        parts["manifest"] = json.loads(parts["manifest"])
    parts["notes"] = tuple(parts["notes"])
    return Log(**parts)


def write_file(path: str | os.PathLike[str], content: bytes, *, overwrite: bool) -> None:
    """Writes a file; one that is there stays as it is, unless `overwrite` is true."""
    try:
        with open(path, "wb" if overwrite else "xb") as file:
            file.write(content)
    except FileExistsError:
        raise is_there(path) from None


def is_there(path: str | os.PathLike[str]) -> FileExistsError:
    """A file that stands where another one is to be written."""
    return FileExistsError(errno.EEXIST, "a file is there already, and overwrite=True replaces it", os.fspath(path))
