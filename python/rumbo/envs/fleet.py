"""Several robots in one world, as a parallel environment of PettingZoo.

    import rumbo.envs.fleet
    env = rumbo.envs.fleet.FleetGoalEnv(robots=4)
    observations, infos = env.reset(seed=1)
    while env.agents:
        actions = {agent: env.action_space(agent).sample() for agent in env.agents}
        observations, rewards, terminations, truncations, infos = env.step(actions)

Spaces, seeds and infos are those of `rumbo.envs`.
"""

# The packages are looked for before they are imported.
# ruff: noqa: E402
from __future__ import annotations

import math
import secrets
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from .._extras import need

need("rumbo.envs.fleet", "pettingzoo", "pettingzoo", (1, 25))

import numpy as np
from gymnasium import error, spaces
from numpy.typing import NDArray
from pettingzoo import ParallelEnv

from .. import _rumbo
from .._setup import Parameters, Source, make_setup
from .._sim import OBSERVED, TRUE, Batch
from ._core import SCALE, STAND_S, action_space, checked_seed, observation_space
from ._tasks import ACTION_S, FAILURE, GOAL, collided, mix

#: Robots of the task: no more find room in a world.
MOST_ROBOTS = 32

_Array = NDArray[np.float32]


def across(robots: int) -> dict[str, Any]:
    """A scenario: so many robots on a circle, each with its goal on the other side.

    The circle has a radius of 1 m, or what 0.45 m between neighbours take; walls stand 0.6 m outside of it.
    """
    if not 2 <= robots <= MOST_ROBOTS:
        raise ValueError(f"robots = {robots}: must be 2 to {MOST_ROBOTS}")
    radius_m = max(1.0, 0.45 * robots / math.tau)
    wall_m = radius_m + 0.6

    def start(number: int) -> dict[str, float]:
        angle_rad = math.tau * number / robots
        back_deg = math.degrees(angle_rad) + 180.0
        return {
            "x_m": radius_m * math.cos(angle_rad),
            "y_m": radius_m * math.sin(angle_rad),
            "heading_deg": back_deg if back_deg <= 180.0 else back_deg - 360.0,
        }

    return {
        "title": "Robots on a circle, each on its way to the other side",
        "robot": "memoria",
        "rig": "final",
        "world": {
            "title": "A walled floor",
            "arena": {"from_m": [-wall_m, -wall_m], "to_m": [wall_m, wall_m], "walled": True},
        },
        "mode": "mission",
        "duration_s": 60.0,
        "command": [{"at_s": 0.4, "goal_m": [2.0 * radius_m, 0.0]}, {"at_s": 0.5, "arm": True}],
        "fleet": [{"name": f"robot_{number}", "start": start(number)} for number in range(robots)],
    }


@dataclass(frozen=True)
class FleetEnvSnapshot:
    """A parallel environment as it was at one moment."""

    _robots: _rumbo.Snapshot
    _state: tuple[int, int, int, list[str], NDArray[np.float64]] = field(repr=False)


class FleetGoalEnv(ParallelEnv[str, NDArray[np.float32], NDArray[np.float32]]):
    """Every robot has a goal to reach, and the others in its way: the task of `rumbo.envs.GoalEnv`, for each.

    The last two numbers of an observation are the robot's goal as seen by its odometry: ahead, to the left [m]. The
    reward is how much nearer it came to it [m]. At less than 0.1 m it has arrived: 10, and the end for this robot. A
    contact above 0.1 m/s, with a robot or anything else, or a fault costs 10 and ends it too. Whose episode has ended
    is disarmed and stays where it is. At the end of the scenario's time all are truncated.

    Args:
        scenario: One with ``[[fleet]]``, a path or a dictionary. Each robot's goal is the first one of its commands, or
            that of the world. `across` with `robots` if left out.
        robots: How many, where `scenario` is left out: 2 to 32.
        agents: Names of the robots that are agents, all by default; the scenario commands the others.
        robot, world, parameters, randomize: As for `rumbo.run`.

    Raises:
        ValueError: Whatever is wrong with the scenario, a name in `agents` that no robot has, or a robot without a
            goal; in a step, a missing or unknown agent, an action of a wrong shape or that is not a number.
        gymnasium.error.ResetNeeded: A step before the first reset.
        gymnasium.error.ClosedEnvironmentError: Use after `close`.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012
        "name": "rumbo_fleet_goal_v0",
        "render_modes": [],
        "render_fps": 10,
        "is_parallelizable": True,
    }

    def __init__(
        self,
        scenario: Source | None = None,
        *,
        robots: int | None = None,
        agents: Sequence[str] | None = None,
        robot: Source | None = None,
        world: Source | None = None,
        parameters: Parameters | None = None,
        randomize: bool | None = None,
    ) -> None:
        """Robots that begin with the first reset."""
        if scenario is not None and robots is not None:
            raise ValueError(f"robots = {robots}: the scenario has robots of its own; leave one of both out")
        source = across(4 if robots is None else robots) if scenario is None else scenario
        #: What PettingZoo's own wrappers and SuperSuit look for: no frames are drawn.
        self.render_mode: str | None = None
        self._settings: dict[str, Any] = {
            "robot": robot,
            "world": world,
            "parameters": parameters,
            "randomize": randomize,
        }
        setup = make_setup(source, **self._settings)
        if len(setup.robots) == 1:
            raise ValueError(f"scenario {setup.name}: has one robot; give a scenario with [[fleet]]")
        chosen = setup.robots if agents is None else list(agents)
        for name in chosen:
            if name not in setup.robots:
                raise ValueError(f"agents: no robot {name!r}; the scenario has {', '.join(setup.robots)}")
        if not chosen:
            raise ValueError("agents is empty: give at least one robot")
        self._source = source
        self._steps = max(1, round(setup.duration_s / ACTION_S))
        self.possible_agents: list[str] = [name for name in setup.robots if name in chosen]
        self.agents: list[str] = []
        self._rows = {name: row for row, name in enumerate(setup.robots) if name in chosen}
        self.observation_spaces = {name: observation_space() for name in self.possible_agents}
        self.action_spaces = {name: action_space() for name in self.possible_agents}
        bounds = observation_space()
        self._low, self._high = bounds.low, bounds.high
        #: The names of the numbers of an observation.
        self.observation_names: tuple[str, ...] = OBSERVED
        self._batch: Batch | None = None
        self._closed = False
        #: The seed given, how many of its episodes were begun, and the actions of this one.
        self._base, self._begun, self._taken = 0, 0, 0
        self._truth = np.zeros((0, len(TRUE)))

    def observation_space(self, agent: str) -> spaces.Box:
        """Of one robot: by the names of `rumbo.OBSERVED`."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> spaces.Box:
        """Of one robot: left wheel, right wheel, servo."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, _Array], dict[str, dict[str, Any]]]:
        """Begins the episode of `seed`, or the next one."""
        self._check_open()
        if seed is None and self._batch is None:
            seed = secrets.randbits(63)
        if seed is not None:
            self._base, self._begun = checked_seed(seed), 0
        number = self._base if self._begun == 0 else mix(self._base ^ mix(self._begun)) >> 1
        self._begun += 1
        if self._batch is None:
            self._batch = self._make(number)
        else:
            self._batch.renew([0], [number])
        self._batch.begin_wheel_speed(duration_s=STAND_S)
        known, self._truth = self._batch.rows()
        for name, row in self._rows.items():
            if np.isnan(self._truth[row, TRUE.index("goal_x_m")]):
                raise ValueError(f"robot {name}: has no goal; give it a command with goal_m, or the world a goal_m")
        self.agents = list(self.possible_agents)
        self._taken = 0
        return self._observations(known), self._infos()

    def step(
        self, actions: Mapping[str, _Array]
    ) -> tuple[dict[str, _Array], dict[str, float], dict[str, bool], dict[str, bool], dict[str, dict[str, Any]]]:
        """Acts for 0.1 s."""
        self._check_open()
        if self._batch is None:
            raise error.ResetNeeded("reset() comes first")
        rows = self._checked_actions(actions)
        if not self.agents:
            return {}, {}, {}, {}, {}
        before = self._truth
        active = np.zeros(len(self._batch), np.bool_)
        active[[self._rows[agent] for agent in self.agents]] = True
        known, self._truth = self._batch.drive(rows, ACTION_S, active=active)
        self._taken += 1
        reward, arrived = GOAL.judge(before, self._truth, np.zeros((len(self._batch), 2)))
        failed = collided(self._truth) & ~arrived
        reward = np.where(failed, reward + FAILURE, reward)
        over = failed | arrived
        is_late = self._taken >= self._steps
        observations, infos = self._observations(known), self._infos()
        row_of = {agent: self._rows[agent] for agent in self.agents}
        rewards = {agent: float(reward[row]) for agent, row in row_of.items()}
        terminations = {agent: bool(over[row]) for agent, row in row_of.items()}
        truncations = {agent: is_late and not terminations[agent] for agent in row_of}
        self.agents = [agent for agent in self.agents if not (terminations[agent] or truncations[agent])]
        return observations, rewards, terminations, truncations, infos

    def snapshot(self) -> FleetEnvSnapshot:
        """The episode as it is now: `restore` puts it back, any number of times, and it can be pickled."""
        self._check_open()
        if self._batch is None:
            raise error.ResetNeeded("reset() comes first")
        state = (self._base, self._begun, self._taken, list(self.agents), self._truth.copy())
        return FleetEnvSnapshot(self._batch.snapshot(), state)

    def restore(self, snapshot: FleetEnvSnapshot) -> tuple[dict[str, _Array], dict[str, dict[str, Any]]]:
        """Puts the environment back to a snapshot of the same robots; gives the observations and infos of then.

        Raises:
            ValueError: The snapshot is of other robots.
        """
        self._check_open()
        if self._batch is None:
            self._batch = self._make(1)
        self._batch.restore(snapshot._robots)
        self._base, self._begun, self._taken, agents, truth = snapshot._state
        self.agents, self._truth = list(agents), truth.copy()
        return self._observations(self._batch.rows()[0]), self._infos()

    def close(self) -> None:
        """Lets go of the robots."""
        self._closed = True
        self._batch = None
        self.agents = []

    def _make(self, seed: int) -> Batch:
        return Batch(self._source, seeds=seed, driver=self.possible_agents, threads=1, **self._settings)

    def _check_open(self) -> None:
        if self._closed:
            raise error.ClosedEnvironmentError("this environment was closed; make a new one")

    def _checked_actions(self, actions: Mapping[str, _Array]) -> _Array:
        for agent in actions:
            if agent not in self.agents:
                why = "its episode has ended" if agent in self.possible_agents else "it is no agent"
                raise ValueError(f"action of {agent!r}: {why}; there are {', '.join(self.agents) or 'none'}")
        rows = np.zeros((len(self._batch or ()), 3), np.float32)
        for agent in self.agents:
            if agent not in actions:
                raise ValueError(f"no action of {agent!r}")
            one = np.asarray(actions[agent], dtype=np.float32)
            if one.shape != (3,):
                raise ValueError(f"action of {agent!r} has the shape {one.shape}: must be (3,)")
            if np.isnan(one).any():
                raise ValueError(f"action of {agent!r}: number {int(np.argmax(np.isnan(one)))} is not a number")
            rows[self._rows[agent]] = np.clip(one, np.float32(-1), np.float32(1)) * SCALE
        return rows

    def _observations(self, known: _Array) -> dict[str, _Array]:
        clipped = np.clip(known, self._low, self._high)
        return {agent: clipped[self._rows[agent]].copy() for agent in self.agents}

    def _infos(self) -> dict[str, dict[str, Any]]:
        """Ground truth of each robot, by name, and the seed."""
        seed = 0 if self._batch is None else int(self._batch.seeds[0])
        infos: dict[str, dict[str, Any]] = {}
        for agent in self.agents:
            row = self._truth[self._rows[agent]]
            known = {name: float(value) for name, value in zip(TRUE, row) if not np.isnan(value)}
            infos[agent] = known | {"seed": seed}
        return infos
