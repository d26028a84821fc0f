"""What is to be simulated: names, paths or dictionaries, made into one checked setup."""

from __future__ import annotations

import copyreg
import json
import math
import operator
import os
import pathlib
import tempfile
import warnings
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal, TypeAlias

import numpy as np

from . import _rumbo

#: A built-in file by its name, a file by its path (with a ``/`` or ending in ``.toml``), or its content.
Source: TypeAlias = "str | os.PathLike[str] | Mapping[str, Any]"

Program: TypeAlias = Literal["rumbo", "baseline"]

#: Values of parameters by name; those of a switch or a choice by theirs: ``{"front_kp": 5, "rig": "front_pair"}``.
Parameters: TypeAlias = "Mapping[str, float | str]"


def to_toml(content: Mapping[str, Any], what: str) -> str:
    """A dictionary as TOML, a line for each of its keys: the line numbers of messages count them from 1."""
    return "".join(f"{_key(key, what)} = {_value(value, f'{what}.{key}')}\n" for key, value in content.items())


def _key(key: object, what: str) -> str:
    if not isinstance(key, str):
        raise TypeError(f"{what}: the key {key!r} is no text")
    return json.dumps(key, ensure_ascii=False)


def _value(value: object, what: str) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        number = float(value)
        if not math.isfinite(number):
            raise ValueError(f"{what} = {number}: must be a finite number")
        return repr(number)
    if isinstance(value, (str, os.PathLike)):
        text = os.fspath(value)
        if not isinstance(text, str):
            raise TypeError(f"{what} = {value!r}: must be text")
        return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(k, what)} = {_value(v, f'{what}.{k}')}" for k, v in value.items()) + "}"
    if isinstance(value, (Sequence, np.ndarray)):
        return "[" + ", ".join(_value(item, f"{what}[{index}]") for index, item in enumerate(value)) + "]"
    raise TypeError(f"{what} = {value!r}: must be a number, text, true or false, a list or a dictionary")


class _Held:
    """Names for what is given as a dictionary."""

    def __init__(self) -> None:
        self.files: list[tuple[str, str, str]] = []

    def name(self, kind: str, source: Source) -> str:
        if isinstance(source, Mapping):
            name = f"given {kind}"
            self.files.append((kind, name, to_toml(source, kind)))
            return name
        if isinstance(source, (str, os.PathLike)):
            name = os.fspath(source)
            if isinstance(name, str):
                return name
        raise TypeError(f"{kind} = {source!r}: must be a name, a path or a dictionary")


def hold(kind: str, source: Source) -> tuple[str, list[tuple[str, str, str]]]:
    """The name of a source, and the files that it needs: kind, name, TOML."""
    held = _Held()
    return held.name(kind, source), held.files


def make_setup(
    scenario: Source,
    *,
    robot: Source | None = None,
    world: Source | None = None,
    policy: Source | None = None,
    rig: str | None = None,
    parameters: Parameters | None = None,
    program: Program = "rumbo",
    firmware: str | os.PathLike[str] | None = None,
    sketch: str | os.PathLike[str] | None = None,
    libraries: Iterable[str | os.PathLike[str]] = (),
    randomize: bool | None = None,
) -> _rumbo.Setup:
    """The setup of these; errors as for `rumbo.run`."""
    if sketch is not None:
        firmware = image_of(sketch, firmware, scenario=scenario, robot=robot, libraries=libraries)
    held = _Held()
    if isinstance(scenario, Mapping):
        # Its robot, world and policy may be dictionaries, too.
        scenario = dict(scenario)
        for kind in ("robot", "world", "policy"):
            if isinstance(scenario.get(kind), Mapping):
                scenario[kind] = held.name(kind, scenario[kind])
    name = held.name("scenario", scenario)
    return _rumbo.Setup(
        name,
        robot=None if robot is None else held.name("robot", robot),
        world=None if world is None else held.name("world", world),
        policy=None if policy is None else held.name("policy", policy),
        rig=rig,
        parameters=[(key, _number(key, value)) for key, value in (parameters or {}).items()],
        program=program,
        firmware=None if firmware is None else os.fspath(firmware),
        randomize=randomize,
        held=held.files,
    )


def compile_sketch(
    sketch: str | os.PathLike[str],
    *,
    scenario: Source = "free",
    robot: Source | None = None,
    libraries: Iterable[str | os.PathLike[str]] = (),
) -> pathlib.Path:
    """Compiles an Arduino sketch for the board of a robot, unless it has not changed, and gives the path of its image.

    It takes the compiler and the core of arduino-cli or the Arduino IDE, else Debian's (``apt install gcc-avr avr-libc
    arduino-core-avr``). The compiler's warnings are Python's.

    Args:
        sketch: Folder of the sketch, its ``.ino``, or an example as ``example:wall``.
        scenario, robot: The robot is that of the scenario, unless another one is given.
        libraries: Folders with a folder for each library, beside those of the Arduino IDE.

    Raises:
        ValueError: There is no such sketch, no compiler, or it rejects the sketch: a line for each error.
    """
    held = _Held()
    if isinstance(scenario, Mapping) and robot is None:
        robot = scenario.get("robot")
    if isinstance(scenario, Mapping):
        scenario = "free"
    image, said = _rumbo.compile(
        os.fspath(sketch),
        held.name("scenario", scenario),
        robot=None if robot is None else held.name("robot", robot),
        libraries=[os.fspath(pathlib.Path(folder).absolute()) for folder in libraries],
        held=held.files,
    )
    if said:
        warnings.warn("\n".join(said), stacklevel=2)
    return pathlib.Path(image)


def image_of(
    sketch: str | os.PathLike[str],
    firmware: str | os.PathLike[str] | None,
    *,
    scenario: Source,
    robot: Source | None,
    libraries: Iterable[str | os.PathLike[str]],
) -> pathlib.Path:
    """The image of a sketch that is a robot's only program."""
    if firmware is not None:
        raise ValueError("a robot has one program: give sketch= or firmware=, not both")
    return compile_sketch(sketch, scenario=scenario, robot=robot, libraries=libraries)


def pack_setup(setup: _rumbo.Setup) -> tuple[dict[str, Any], bytes | None]:
    """A setup with its files, for another process or machine: arguments, and the image if there is one."""
    arguments = setup.arguments()
    path = arguments["firmware"]
    return arguments, None if path is None else pathlib.Path(path).read_bytes()


def _unpack_setup(arguments: dict[str, Any], image: bytes | None) -> _rumbo.Setup:
    if image is None:
        return _rumbo.Setup(**arguments)
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder, pathlib.Path(arguments["firmware"]).name)
        path.write_bytes(image)
        return _rumbo.Setup(**{**arguments, "firmware": os.fspath(path)})


copyreg.pickle(_rumbo.Setup, lambda setup: (_unpack_setup, pack_setup(setup)))


def _number(name: str, value: object) -> float | str:
    if isinstance(value, str):
        return value
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise ValueError(f"parameter {name} = {value!r}: must be a number, or the name of a choice") from None


#: What is pickled is read again by the same package and model only.
MADE_BY: tuple[str, int] = (_rumbo.VERSION, _rumbo.MODEL)


def check_version(what: str, made_by: tuple[str, int]) -> None:
    """Refuses what another package or model has pickled: robots would not be the same."""
    if tuple(made_by) != MADE_BY:
        raise ValueError(
            f"{what}: was pickled by Rumbo {made_by[0]}, model {made_by[1]}, and this is Rumbo {MADE_BY[0]}, model "
            f"{MADE_BY[1]}: make it again, or install that one"
        )


def make_seeds(seeds: int | Iterable[int]) -> list[int]:
    """The seeds as a list; a single number is one seed."""
    try:
        numbers: list[Any] = [operator.index(seeds)]  # type: ignore[arg-type]
    except TypeError:
        try:
            numbers = list(seeds)  # type: ignore[arg-type]
        except TypeError:
            raise TypeError(f"seeds = {seeds!r}: must be a whole number, or several such as range(1, 11)") from None
    checked = []
    for index, seed in enumerate(numbers):
        try:
            number = operator.index(seed)
        except TypeError:
            raise TypeError(f"seeds[{index}] = {seed!r}: must be a whole number") from None
        if not 0 <= number < 2**64:
            raise ValueError(f"seeds[{index}] = {number}: must be 0 or more and below 2**64")
        checked.append(number)
    if not checked:
        raise ValueError("seeds is empty: give at least one")
    return checked


def make_index(index: int, count: int) -> int:
    """The number of one of so many robots."""
    try:
        number = operator.index(index)
    except TypeError:
        raise TypeError(f"robot {index!r}: must be a whole number") from None
    if not 0 <= number < count:
        raise IndexError(f"robot {number}: there are {count}, numbered from 0")
    return number


def to_ticks(duration_s: float) -> int:
    """A duration as a number of control ticks of 10 ms."""
    ticks = round(duration_s * 100) if math.isfinite(duration_s) else 0
    if not (1 <= ticks < 2**31) or abs(ticks - duration_s * 100) > 1e-6:
        raise ValueError(f"duration_s = {duration_s}: must be a multiple of 0.01 s, the control tick")
    return ticks
