"""Robots that the caller steps: one, or many together."""

from __future__ import annotations

import copy
import copyreg
import math
import os
from collections.abc import Callable, Iterable, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _rumbo
from ._board import TICK_S, Pin, Serial, wait
from ._log import write_file
from ._progress import shown
from ._setup import (
    MADE_BY,
    Parameters,
    Program,
    Source,
    check_version,
    image_of,
    make_index,
    make_seeds,
    make_setup,
    to_ticks,
    to_toml,
)

#: Names of what a robot's program knows, in the order of the columns of `Batch.observe_rows`.
OBSERVED: tuple[str, ...] = tuple(_rumbo.OBSERVED)
#: Names of the ground truth, in the order of the columns of `Batch.truth_rows`.
TRUE: tuple[str, ...] = tuple(_rumbo.TRUE)

Driver = Literal["scenario", "caller"] | Sequence[str]
#: How long a button is pressed, and a key of a remote control stays down; how often one that is held is pressed [s].
PRESSED_S, AGAIN_S = 0.2, 0.1


def _callers(driver: Driver, names: Sequence[str]) -> list[bool]:
    """Which of the robots of a world the caller drives."""
    if driver in ("scenario", "caller"):
        return [driver == "caller"] * len(names)
    if isinstance(driver, str):
        raise ValueError(f'driver = {driver!r}: must be "scenario", "caller", or names of robots in a list')
    for name in driver:
        if name not in names:
            raise ValueError(f"driver: no robot {name!r}; the scenario has {', '.join(names)}")
    return [name in driver for name in names]


class Batch:
    """Robots of one setup, a seed for each world, stepped together on all cores.

    Driven by the scenario (``driver="scenario"``), each robot is bit for bit the one that `rumbo.run` simulates for its
    seed. Driven by the caller, it has no link: it starts disarmed in the scenario's mode, with the parameters of the
    files (a scenario's calibration is left out), gets commands at once, and never misses its heartbeat. A world is the
    same in every batch and on any number of threads.

    A scenario with ``[[fleet]]`` has several robots in each world: robot 0 to n - 1 are those of the first seed, in the
    order of `names`, and so on. Each goes for its world's goal, else for the first one of its commands.

    >>> batch = rumbo.Batch("examples/fleet/corners.toml", seeds=7)
    >>> batch.step(10)
    >>> batch.truth()["x_m"]

    Where the scenario has the robots calibrate themselves (all that drive by odometry do, such as ``mode8-random``),
    each is calibrated as it is made: some 30 ms of one core for each robot, a hundred times what it takes without, or
    with ``driver="caller"``. Ctrl-C ends it at once.

    Batches can be pickled and copied. A copy goes on by itself. A pickle holds the setup with its files, the seeds and
    what was done to each robot, which is done again where it is loaded: that takes what it took, 0.1 to 0.3 ms of one
    core for each second of a robot's time, and its making. It is read by the same version and model only.

    Args:
        scenario, robot, world, policy, rig, parameters, program, firmware, randomize: As for `rumbo.run`.
        seeds: A robot for each, or the robots of the scenario.
        driver: Who commands the robots: ``"scenario"``, ``"caller"``, or the caller those of these names and the
            scenario the others.
        threads: One on each core by default.
        progress: ``True`` shows the share of the robots that are made on stderr, and the time left; a function is
            called with it, 0 to 1.

    Raises:
        ValueError, OSError: As `rumbo.run`.
        IndexError: From any method, for the number of a robot that is not there; they begin at 0.
        KeyboardInterrupt: Ctrl-C, at once, also from `step`, `drive` and `renew`.
        RuntimeError: From any method, in a process that was forked after threads were used (begin workers by
            ``multiprocessing.get_context("spawn")``), or while another thread is stepping the same robots.
    """

    def __init__(
        self,
        scenario: Source,
        *,
        seeds: int | Iterable[int],
        driver: Driver = "scenario",
        robot: Source | None = None,
        world: Source | None = None,
        policy: Source | None = None,
        rig: str | None = None,
        parameters: Parameters | None = None,
        program: Program = "rumbo",
        firmware: str | os.PathLike[str] | None = None,
        randomize: bool | None = None,
        threads: int | None = None,
        progress: bool | Callable[[float], object] = False,
    ) -> None:
        setup = make_setup(
            scenario,
            robot=robot,
            world=world,
            policy=policy,
            rig=rig,
            parameters=parameters,
            program=program,
            firmware=firmware,
            randomize=randomize,
        )
        #: How long the scenario lasts [s]; the robots can be stepped beyond.
        self.duration_s: float = setup.duration_s
        #: The names of the robots of a world, in the order of the rows of all arrays.
        self.names: tuple[str, ...] = tuple(setup.robots)
        self._callers = _callers(driver, self.names)
        numbers = make_seeds(seeds)
        with shown(progress, " of the robots") as show:
            self._batch = _rumbo.Batch(setup, numbers, callers=self._callers, threads=threads, progress=show)
        self._is_known = program == "rumbo" and firmware is None
        self._name = setup.name

    def __repr__(self) -> str:
        callers = [name for name, caller in zip(self.names, self._callers) if caller]
        driver = "the scenario" if not callers else "the caller" if all(self._callers) else ", ".join(callers)
        return f"<{len(self)} robots of {self._name}, driven by {driver}>"

    def __copy__(self) -> Batch:
        return copy.deepcopy(self)

    def __len__(self) -> int:
        return len(self._batch)

    @property
    def seeds(self) -> NDArray[np.uint64]:
        """The robots' seeds, shape (robots,)."""
        return self._batch.seeds()

    def step(self, duration_s: float = 0.01) -> None:
        """Advances every robot by `duration_s` [s], a multiple of the control tick of 0.01 s.

        Ctrl-C ends it at once, with every robot at the same time.
        """
        self._batch.advance(to_ticks(duration_s))

    def drive(
        self, actions: ArrayLike, duration_s: float = 0.1, *, active: ArrayLike | None = None, pwm: bool = False
    ) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
        """Sets wheel speeds and servo of the robots that the caller drives, advances all, and gives what `rows` does.

        They must be in mode ``wheel_speed`` and armed: see `begin_wheel_speed`. Rows of the scenario's robots are of no
        effect.

        Args:
            actions: Shape (robots, 3): left and right wheel [rad/s, -20 to 20], servo [rad, -pi/2 to pi/2, left is
                positive].
            duration_s: A multiple of 0.01 s.
            active: Shape (robots,); a world stands still in time where it is false for all that the caller drives. In
                one that goes on, those of which it is false are disarmed: their wheels roll out, and stay so.
            pwm: The first two columns are shares of the full PWM, -1 to 1, which the motors get as they are, in place
                of the robot's own control of the wheel speeds.

        Raises:
            ValueError: A wrong shape, or a value that is out of range or not a number, with its index.
        """
        self._check_caller()
        rows = np.ascontiguousarray(actions, dtype=np.float32)
        if rows.shape != (len(self), 3):
            raise ValueError(f"actions has the shape {rows.shape}: must be ({len(self)}, 3)")
        chosen = np.ones(len(self), np.bool_) if active is None else np.ascontiguousarray(active, dtype=np.bool_)
        if chosen.shape != (len(self),):
            raise ValueError(f"active has the shape {chosen.shape}: must be ({len(self)},)")
        known, truth = self._empty()
        self._batch.drive(rows, chosen, to_ticks(duration_s), known, truth, pwm=pwm)
        return known, truth

    def begin_wheel_speed(self, indices: Sequence[int] | None = None, duration_s: float = 0.5) -> None:
        """Selects mode ``wheel_speed`` and arms these robots, all by default, that the caller drives.

        Their worlds then go on for `duration_s` [s], in which they stand, so that every sonar has answered.
        """
        self._check_caller()
        self._batch.begin(self._numbers(indices), to_ticks(duration_s))

    def renew(self, indices: Sequence[int], seeds: Iterable[int]) -> None:
        """Puts new worlds of these seeds, their robots at their start, in place of those of these numbers.

        Each takes the memory of the one before. Ctrl-C or an error leaves some of them new and others as they were.
        """
        numbers = [make_index(index, len(self) // len(self.names)) for index in indices]
        of_them = make_seeds(seeds) if numbers else []
        if len(of_them) != len(numbers):
            raise ValueError(f"{len(numbers)} worlds need as many seeds, not {len(of_them)}")
        self._batch.renew(numbers, of_them)

    def command(self, index: int, **keys: Any) -> None:
        """Applies a command to one robot, in the words of a scenario's ``[[command]]``: see `Sim.command`."""
        index = make_index(index, len(self))
        servo = "servo_rad" in keys
        if servo:
            angle = keys.pop("servo_rad")
            self._batch.aim(index, None if angle is None else float(angle))
        if keys or not servo:
            self._batch.instruct(index, to_toml(keys, "command"))

    def observe_rows(self) -> NDArray[np.float32]:
        """What the robots' programs know after the last tick, shape (robots, 14), in the order of `rumbo.OBSERVED`.

        Wheel speeds [rad/s]; ranges [m], the front one in the servo's direction: `rumbo.REACH_M` where nothing is
        within reach, 0 before the first reading and of a sonar that is faulty or not there; their ages [s, at most 1];
        the servo's angle [rad]; the pose by odometry from the start [m, rad]; the goal of a random world as seen from
        there [m ahead, m to the left], otherwise 0.

        Raises:
            ValueError: The robots run another program.
        """
        if not self._is_known:
            raise ValueError("only Rumbo's own program shows what it knows; truth() is there for every one")
        return self.rows()[0]

    def truth_rows(self) -> NDArray[np.float64]:
        """Ground truth now, shape (robots, 20), in the order of `rumbo.TRUE`.

        Time [s]; pose [m, rad]; wheel speeds [rad/s]; body velocities [m/s, rad/s]; ranges [m, inf where nothing is
        within reach, NaN without such a sonar]; servo [rad]; battery [V]; whether the body touches something, the
        number of contacts and the fastest of them [m/s]; whether the robot is armed and the number of its latched
        fault, 0 for none; the goal of a random world [m], else NaN.
        """
        return self.rows()[1]

    def observe(self) -> dict[str, NDArray[np.float32]]:
        """The columns of `observe_rows` by name, shape (robots,) each, without a copy."""
        rows = self.observe_rows()
        return {name: rows[:, column] for column, name in enumerate(OBSERVED)}

    def truth(self) -> dict[str, NDArray[np.float64]]:
        """The columns of `truth_rows` by name, shape (robots,) each, without a copy."""
        rows = self.truth_rows()
        return {name: rows[:, column] for column, name in enumerate(TRUE)}

    def record(self, indices: Sequence[int] | None = None) -> None:
        """Records these robots from now on, all by default, in place of what was recorded of them: see `write_log`.

        They go on bit for bit as without. A recorded one takes 16 KB for each second of its time, and is advanced tick
        by tick. `renew` ends it for the robots that it replaces; snapshots have it with them.
        """
        for index in self._numbers(indices):
            self._batch.record(index)

    def write_log(self, index: int, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Writes what was recorded of one robot since `record` as a log, an ``.mcap``.

        ``rumbo replay`` shows it on the dashboard, `rumbo.read_log` reads it, ``rumbo export`` makes tables of it: the
        telemetry that the robot would send, ground truth beside it, the goal of its world, and commands as events. The
        setpoints of its wheels are among the telemetry. The robot stays recorded.

        Raises:
            ValueError: Nothing is recorded of this robot.
            FileExistsError: There is a file at `path`, which stays as it is without `overwrite`.
            OSError: It cannot be written there.
        """
        write_file(path, self._batch.log(make_index(index, len(self))), overwrite=overwrite)

    def obstacles(self, index: int) -> list[NDArray[np.float64]]:
        """The corners of each wall and box in the world of one robot, shape (corners, 2) each [m]."""
        return [np.array(corners) for corners in self._batch.obstacles(make_index(index, len(self)))]

    def fault(self, index: int) -> str | None:
        """The fault that one robot has latched, in words."""
        return self._batch.fault(make_index(index, len(self)))

    def snapshot(self) -> _rumbo.Snapshot:
        """The robots as they are now: `restore` puts them back, any number of times.

        It can be pickled, and so kept in a file, as a batch can.
        """
        return self._batch.snapshot()

    def restore(self, snapshot: _rumbo.Snapshot) -> None:
        """Puts the robots back to a snapshot; from there on they are bit for bit the same.

        Raises:
            ValueError: The snapshot is of another number of robots.
        """
        self._batch.restore(snapshot)

    def rows(self) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
        """`observe_rows` and `truth_rows` at once."""
        known, truth = self._empty()
        self._batch.observe(known, truth)
        return known, truth

    def _check_caller(self) -> None:
        if not any(self._callers):
            raise ValueError('the scenario commands these robots; make the batch with driver="caller"')

    def _numbers(self, indices: Iterable[int] | None) -> list[int]:
        count = len(self)
        return [make_index(index, count) for index in (range(count) if indices is None else indices)]

    def _empty(self) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
        return np.empty((len(self), len(OBSERVED)), np.float32), np.empty((len(self), len(TRUE)), np.float64)


class Sim:
    """One robot that the caller steps; what is said of `Batch` holds for it.

    >>> sim = rumbo.Sim("mode1", seed=7, driver="caller")
    >>> sim.step(0.5)
    >>> sim.command(reference_m=0.4)
    >>> sim.command(arm=True)
    >>> sim.step(3)
    >>> sim.truth()["range_front_m"]

    With a sketch, an Arduino program drives it, on the emulated board of its robot, with pins and serial ports at hand:

    >>> sim = rumbo.Sim(sketch="my_sketch", robot="uno")
    >>> sim.serial.expect("ready", within_s=1)
    >>> sim.pin(13).pulses()

    Args:
        scenario: As for `rumbo.run`; with a sketch or an image ``free`` by default, a room with boxes.
        sketch: Folder of the sketch, its ``.ino``, or an example as ``example:wall``. It is compiled if it has changed,
            as `compile_sketch` does.
        libraries: Folders with a folder for each library, beside those of the Arduino IDE.
        seed, driver, robot, world, policy, rig, parameters, program, firmware, randomize: As for `Batch`.
    """

    def __init__(
        self,
        scenario: Source | None = None,
        *,
        sketch: str | os.PathLike[str] | None = None,
        libraries: Iterable[str | os.PathLike[str]] = (),
        seed: int = 1,
        driver: Driver = "scenario",
        robot: Source | None = None,
        world: Source | None = None,
        policy: Source | None = None,
        rig: str | None = None,
        parameters: Parameters | None = None,
        program: Program = "rumbo",
        firmware: str | os.PathLike[str] | None = None,
        randomize: bool | None = None,
    ) -> None:
        if scenario is None and sketch is None and firmware is None:
            raise TypeError("what is it to drive? Give a scenario, or the sketch= or firmware= of an emulated board")
        scenario = "free" if scenario is None else scenario
        if sketch is not None:
            firmware = image_of(sketch, firmware, scenario=scenario, robot=robot, libraries=libraries)
        self._batch = Batch(
            scenario,
            seeds=[seed],
            driver=driver,
            robot=robot,
            world=world,
            policy=policy,
            rig=rig,
            parameters=parameters,
            program=program,
            firmware=firmware,
            randomize=randomize,
            threads=1,
        )
        if len(self._batch) != 1:
            raise ValueError(f"scenario {self._batch._name}: has several robots; take rumbo.Batch")
        self._serials: dict[str, Serial] = {}
        #: A board is emulated, with pins and ports.
        self.is_emulated: bool = _rumbo.probe(self._batch._batch)

    def __repr__(self) -> str:
        driver = "you" if all(self._batch._callers) else "the scenario"
        return f"<robot of {self._batch._name}, seed {self.seed}, driven by {driver}: {self.t_s:.2f} s>"

    def __copy__(self) -> Sim:
        return copy.deepcopy(self)

    @property
    def seed(self) -> int:
        """The robot's seed."""
        return int(self._batch.seeds[0])

    @property
    def t_s(self) -> float:
        """Simulated time since the start [s]."""
        return self.truth()["t_s"]

    @property
    def fault(self) -> str | None:
        """The fault that the robot has latched, in words; `command(clear_fault=True)` clears it."""
        return self._batch.fault(0)

    def step(self, duration_s: float = 0.01) -> None:
        """Advances by `duration_s` [s], a multiple of the control tick of 0.01 s."""
        self._batch.step(duration_s)

    def advance(self, until: float | Callable[[Sim], object], within_s: float = 60.0) -> None:
        """Advances to a time since the start [s], or tick by tick until ``until(sim)`` is true.

        Raises:
            ExpectationError: That did not come true within `within_s` [s].
            ValueError: The time is over.
        """
        if callable(until):
            began_s = self.t_s
            what = getattr(until, "__name__", repr(until))
            wait(
                self._batch._batch,
                within_s,
                lambda: bool(until(self)),
                lambda: f"{what} did not come true from {began_s:.2f} s on",
            )
            return
        left_s = until - self.t_s
        if left_s < -1e-9:
            raise ValueError(f"until = {until}: it is {self.t_s:.2f} s already")
        if round(left_s / TICK_S) > 0:
            self.step(round(left_s / TICK_S) * TICK_S)

    @property
    def serial(self) -> Serial:
        """The USB port of an emulated board, ``Serial`` in a sketch."""
        return self._port("usb", "Serial (USB)")

    @property
    def bluetooth(self) -> Serial:
        """The Bluetooth module of an emulated board, wherever its wiring has it: what it passes on."""
        return self._port("link", "the Bluetooth module")

    def usart(self, number: int) -> Serial:
        """A USART of an emulated board by its number, ``Serial1`` as 1, as a terminal at its pins has it."""
        if number not in range(4):
            raise ValueError(f"usart {number!r}: must be 0 to 3")
        return self._port(str(number), f"Serial{number or ''}")

    def _port(self, port: str, title: str) -> Serial:
        if port not in self._serials:
            self._serials[port] = Serial(self._batch._batch, port, title)
        return self._serials[port]

    def pin(self, name: int | str) -> Pin:
        """A pin of an emulated board by its number or name (``7``, ``"A0"``), what is wired to it, or the part at it.

        Raises:
            ValueError: There is none, with the near ones; or no board is emulated.
        """
        return Pin(self._batch._batch, name)

    def press(self, part: str, value: float | str | None = None, *, for_s: float | None = None) -> None:
        """Presses a button of the robot's file for 0.2 s, or puts a switch or a potentiometer to a value, 0 to 1.

        A key of a remote control is pressed by its name, ``press("remote", "ok")``; it repeats while it is held,
        ``for_s=2``, or if it is pressed again within 0.2 s.

        Raises:
            ValueError: There is no such part or key, with those that there are.
        """
        known = _rumbo.parts(self._batch._batch)
        if part not in known:
            there = ", ".join(known) or "none; the robot's file names them, as parts.start = { button = 8 }"
            raise ValueError(f"unknown part {part!r}: there are {there}")
        if keys := known[part]:
            if str(value) not in keys:
                raise ValueError(f"{part} is a remote control, and {value!r} none of its keys: {', '.join(keys)}")
        elif value is not None and (isinstance(value, str) or not 0 <= value <= 1):
            raise ValueError(f"{part} = {value!r}: must be 0 to 1")
        line = f"{part}={1.0 if value is None else value}\n".encode()
        _rumbo.type_in(self._batch._batch, "parts", line)
        if value is None:
            self.step(PRESSED_S if for_s is None else for_s)
            _rumbo.type_in(self._batch._batch, "parts", f"{part}=0\n".encode())
        elif for_s is not None:
            for _ in range(math.ceil(max(for_s - PRESSED_S, 0) / AGAIN_S - 1e-9)):
                self.step(AGAIN_S)
                _rumbo.type_in(self._batch._batch, "parts", line)

    @property
    def ended(self) -> str | None:
        """How the program of an emulated board ended, if it could not go on: what, where, when."""
        return _rumbo.ended(self._batch._batch)

    def write_vcd(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Writes all pins of an emulated board over time, which GTKWave and other viewers of waveforms show.

        Raises:
            ValueError: No board is emulated.
            FileExistsError: There is a file at `path`, which stays as it is without `overwrite`.
        """
        write_file(path, _rumbo.vcd(self._batch._batch), overwrite=overwrite)

    def command(self, **keys: Any) -> None:
        """Applies a command at once, in the words of a scenario's ``[[command]]``, without its time.

        ``arm=True``, ``disarm=True``, ``stop=True``, ``clear_fault=True``, ``reset_pose=True``, ``mode="wheel_speed"``
        (while disarmed), ``reference_m=0.3``, ``speed_rpm=60``, ``left_rpm=60, right_rpm=50``, ``goal_m=[1, 0.5]``,
        ``goal="world"``, ``route_m=[[1, 0], [1, 1, 90]]``, ``lane=True``, ``move="turn_left", duty=0.4``,
        ``parameter="front_kp", value=5``; and ``servo_rad=0.5`` [rad, left is positive], which points the servo
        whatever the mode requests, until ``servo_rad=None``.

        Raises:
            ValueError: An unknown key, with the near ones; a value out of range; a command that the robot refuses, with
                its reason; a robot that its scenario commands.
        """
        self._batch.command(0, **keys)

    def observe(self) -> dict[str, float]:
        """What the robot's program knows after its last tick: see `Batch.observe_rows`."""
        return {name: float(value) for name, value in zip(OBSERVED, self._batch.observe_rows()[0])}

    def truth(self) -> dict[str, float]:
        """Ground truth now: see `Batch.truth_rows`; of an emulated robot the other sonars too, as ``range_rear_m``."""
        known = {name: float(value) for name, value in zip(TRUE, self._batch.truth_rows()[0])}
        return known | dict(_rumbo.other_ranges(self._batch._batch))

    def record(self) -> None:
        """Records the robot from now on: see `Batch.record`."""
        self._batch.record()

    def write_log(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Writes what was recorded as a log, which ``rumbo replay`` shows: see `Batch.write_log`."""
        self._batch.write_log(0, path, overwrite=overwrite)

    def obstacles(self) -> list[NDArray[np.float64]]:
        """The corners of each wall and box, shape (corners, 2) each [m]."""
        return self._batch.obstacles(0)

    def snapshot(self) -> _rumbo.Snapshot:
        """The robot as it is now: see `Batch.snapshot`."""
        return self._batch.snapshot()

    def restore(self, snapshot: _rumbo.Snapshot) -> None:
        """Puts the robot back to a snapshot: see `Batch.restore`."""
        self._batch.restore(snapshot)


_Made = tuple[str, int]


def _pickled(batch: _rumbo.Batch) -> tuple[Any, ...]:
    return _batch, (MADE_BY, *batch.snapshot().parts(), batch.threads)


def _batch(
    made_by: _Made,
    setup: _rumbo.Setup,
    callers: list[bool],
    seeds: list[int],
    histories: list[list[bytes]],
    threads: int | None,
) -> _rumbo.Batch:
    check_version("robots", made_by)
    return _rumbo.Batch(setup, seeds, callers=callers, threads=threads, histories=histories)


def _snapshot(
    made_by: _Made, setup: _rumbo.Setup, callers: list[bool], seeds: list[int], histories: list[list[bytes]]
) -> _rumbo.Snapshot:
    check_version("a snapshot", made_by)
    return _rumbo.Batch(setup, seeds, callers=callers, threads=None, histories=histories).snapshot()


copyreg.pickle(_rumbo.Batch, _pickled)
copyreg.pickle(_rumbo.Snapshot, lambda snapshot: (_snapshot, (MADE_BY, *snapshot.parts())))
