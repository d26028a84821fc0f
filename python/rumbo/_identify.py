"""The plant's parameters from recorded runs."""

from __future__ import annotations

import datetime
import json
import os
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from . import _rumbo
from ._progress import shown
from ._setup import Source, hold


@dataclass(frozen=True)
class Identified:
    """A parameter of the plant, and how sure it is."""

    #: Its dotted keys in a robot's ``"plant"``: several where both wheels share the value.
    keys: tuple[str, ...]
    value: float
    #: One standard deviation, in the unit of the value.
    uncertainty: float
    unit: str
    #: Share of the knowledge that came from the runs, 0 to 1; the rest was believed beforehand.
    from_runs: float
    #: The experiment that shows it.
    shown_by: str


@dataclass(frozen=True)
class Identification:
    """A robot's parameters as its recorded runs show them."""

    #: The robot with what was found: for the ``robot=`` of `run`, `Sim` and others.
    robot: dict[str, Any]
    #: The same as the text of a robot file, with the comments of the one it was made of.
    toml: str
    #: By the first of its keys; empty where nothing was fitted.
    parameters: dict[str, Identified]
    #: How well the plant repeats each run: a dictionary as in the JSON of ``rumbo identify``, RMSE in rpm and m.
    runs: tuple[dict[str, Any], ...]
    #: Noise, outliers and losses of each sonar, measured and simulated.
    sonars: tuple[dict[str, Any], ...]
    #: What was left out of the recordings, or is missing in them.
    notes: tuple[str, ...]

    def __repr__(self) -> str:
        known = sum(one.from_runs >= 0.5 for one in self.parameters.values())
        return f"<{len(self.runs)} runs: {known} of {len(self.parameters)} parameters shown by them>"


def identify(
    logs: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    robot: Source = "memoria",
    *,
    fit: bool = True,
    threads: int | None = None,
    progress: bool | Callable[[float], object] = False,
) -> Identification:
    """Fits the plant of a robot to recorded runs, as ``rumbo identify`` does.

    Args:
        logs: One path or several: CSVs of the original program, logs that carry one, or logs of Rumbo's own program on
            a robot (``rumbo identify --drive`` makes one that shows most).
        robot: Where the fit starts: a name, a path or a dictionary.
        fit: ``False`` repeats the runs on the robot as it is, and fits nothing but the battery and floor of each.
        threads: All cores by default; the result does not depend on it.
        progress: ``True`` shows the share that is done on stderr; a function is called with it, 0 to 1.

    Raises:
        FileNotFoundError, OSError: A file that cannot be read.
        ValueError: A file that shows nothing, with the remedy; runs that no common robot explains.
        KeyboardInterrupt: Ctrl-C, within about a second.
    """
    paths = [logs] if isinstance(logs, (str, os.PathLike)) else list(logs)
    if not paths:
        raise ValueError("logs is empty: give at least one")
    for path in paths:
        # The system's own error for one that is not there.
        open(path, "rb").close()
    name, held = hold("robot", robot)
    with shown(progress) as show:
        found = json.loads(
            _rumbo.identify(
                [os.fspath(path) for path in paths],
                name,
                held=held,
                fit=fit,
                date=datetime.datetime.now(datetime.timezone.utc).date().isoformat(),
                threads=threads,
                progress=show,
            )
        )
    parameters = [
        Identified(
            keys=tuple(one["keys"]),
            value=one["value"],
            uncertainty=one["uncertainty"],
            unit="" if one["unit"] == "1" else one["unit"],
            from_runs=one["from_runs"],
            shown_by=one["shown_by"],
        )
        for one in found.get("parameters", [])
    ]
    return Identification(
        robot=found["robot"],
        toml=found["toml"],
        parameters={one.keys[0]: one for one in parameters},
        runs=tuple(found["runs"]),
        sonars=tuple(found["sonars"]),
        notes=tuple(found["notes"]),
    )
