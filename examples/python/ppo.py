# %% [markdown]
# # A policy that reaches goals among boxes
#
# Proximal policy optimisation (Schulman et al., arXiv 1707.06347) in JAX, on the CPU: `rumbo/Goal-v0` in a vector,
# each episode with another robot, other boxes and another goal. The network is small and its neurons are clipped, so
# that the robot's 8-bit processor can evaluate it in integers: `rumbo export-policy` makes them of the file written
# here.
#
# Each `# %%` is a cell: Visual Studio Code, Spyder, PyCharm and Jupytext open this file as a notebook. It needs
# `pip install ".[gym]" jax optax`.

# %%
import json
import os
import time

# One thread for XLA: the other core steps the robots.
os.environ.setdefault("XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1")

import jax
import jax.numpy as jnp
import numpy as np
import optax

import rumbo
from rumbo.envs import GoalVectorEnv

# Tests of this file make it short.
SHORT = "RUMBO_SHORT" in os.environ
DECISIONS, WORLDS, ROBOTS, BATCH = (400_000, 50, 128, 1024) if SHORT else (12_000_000, 200, 512, 4096)
HORIZON, EPOCHS = 64, 4
LEARNING_RATE, DISCOUNT, LAMBDA, CLIP = 1e-3, 0.995, 0.95, 0.2
# A decision of 0.1 s costs a little, so that the robot does not dawdle.
HURRY = 0.005
HIDDEN = 32
# Seeds of episodes that learning does not see.
UNSEEN = 1_000_000

# %% [markdown]
# What the network is given: columns of the observation, each less `centre`, divided by `scale` and clipped to -1..1.
# What must be told apart near zero and far away is there at several scales.

# %%
INPUTS = [(goal, 0.0, scale) for goal in ("goal_ahead_m", "goal_left_m") for scale in (4.0, 1.0, 0.25)]
INPUTS += [(wheel, 0.0, 12.0) for wheel in ("left_rad_s", "right_rad_s")]
INPUTS += [(f"range_{side}_m", half, half) for side in ("left", "right", "front") for half in (0.25, 0.9)]
INPUTS += [("servo_rad", 0.0, 1.571), ("age_front_s", 0.0, 0.5)]
COLUMNS = np.array([rumbo.OBSERVED.index(name) for name, _, _ in INPUTS])
CENTRES, SCALES = (np.array(values, np.float32) for values in zip(*[(centre, scale) for _, centre, scale in INPUTS]))


def seen(observations):
    """Inputs of the networks, a row for each robot."""
    return np.clip((observations[:, COLUMNS] - CENTRES) / SCALES, -1, 1)


# %% [markdown]
# Two networks: the policy gives the mean of each action, a larger one the value of a state, for learning only.


# %%
def clipped(values):
    """The neurons of the policy."""
    return jnp.clip(values, -1, 1)


def layers(key, sizes, last):
    """Orthogonal weights; those of the last layer are small."""
    keys = jax.random.split(key, len(sizes) - 1)
    gains = [1.0] * (len(sizes) - 2) + [last]
    make = jax.nn.initializers.orthogonal
    return [
        {"weights": make(gain)(key, (rows, columns)), "biases": jnp.zeros(columns)}
        for key, gain, rows, columns in zip(keys, gains, sizes[:-1], sizes[1:])
    ]


def forward(network, inputs, neuron):
    for layer in network[:-1]:
        inputs = neuron(inputs @ layer["weights"] + layer["biases"])
    return inputs @ network[-1]["weights"] + network[-1]["biases"]


@jax.jit
def mean(parameters, inputs):
    return forward(parameters["policy"], inputs, clipped)


def value(parameters, inputs):
    return forward(parameters["value"], inputs, jnp.tanh)[:, 0]


def log_likelihood(means, log_deviation, actions):
    return jnp.sum(-0.5 * ((actions - means) / jnp.exp(log_deviation)) ** 2 - log_deviation, axis=-1)


@jax.jit
def act(parameters, inputs, key):
    """Actions drawn around the means, their likelihoods, and the value of each state."""
    means, log_deviation = mean(parameters, inputs), parameters["log_deviation"]
    actions = means + jnp.exp(log_deviation) * jax.random.normal(key, means.shape)
    return actions, log_likelihood(means, log_deviation, actions), value(parameters, inputs)


# %% [markdown]
# The network works for 0.1 s on a decision, on the robot's processor: what it makes of an observation drives the robot
# from the next one on. So it is here.


# %%
class Robots:
    """A vector of robots, driven a decision late."""

    def __init__(self, count, seed, mode="SameStep", **settings):
        self.vector = GoalVectorEnv(count, autoreset_mode=mode, **settings)
        self.observations, _ = self.vector.reset(seed=seed)
        self.waiting = np.zeros((count, 3), np.float32)

    def step(self, actions):
        self.observations, rewards, ended, cut, _ = self.vector.step(self.waiting)
        over = ended | cut
        self.waiting = np.where(over[:, None], 0, actions)
        return rewards, ended, over


def success(choose, seed=UNSEEN, count=WORLDS, **settings):
    """Shares of unseen worlds in which the robot arrives in 60 s, and in which it meets something or has a fault."""
    robots = Robots(count, seed, mode="NextStep", **settings)
    arrived, failed, over = (np.zeros(count, bool) for _ in range(3))
    while not over.all():
        rewards, ended, now = robots.step(choose(robots.observations))
        first = ended & ~over
        # Rewards tell both ends apart: 10 or -10 besides centimetres.
        arrived |= first & (rewards > 5)
        failed |= first & (rewards < -5)
        over |= now
    robots.vector.close()
    return arrived.mean(), failed.mean()


# %% [markdown]
# Learning: play for a while, estimate how much better each action was than expected, and make the better ones likelier,
# but none by much.


# %%
@jax.jit
def advantages(rewards, over, values, last):
    """Generalised advantage estimates (arXiv 1506.02438), rows are decisions."""

    def backward(following, row):
        reward, end, now, after = row
        error = reward + DISCOUNT * (1 - end) * after - now
        estimate = error + DISCOUNT * LAMBDA * (1 - end) * following
        return estimate, estimate

    after = jnp.concatenate([values[1:], last[None]])
    return jax.lax.scan(backward, jnp.zeros_like(last), (rewards, over, values, after), reverse=True)[1]


def loss(parameters, inputs, actions, likelihoods, better, returns):
    means = mean(parameters, inputs)
    ratio = jnp.exp(log_likelihood(means, parameters["log_deviation"], actions) - likelihoods)
    gained = jnp.minimum(ratio * better, jnp.clip(ratio, 1 - CLIP, 1 + CLIP) * better)
    missed = (value(parameters, inputs) - returns) ** 2
    # The environment clips actions, beyond it nothing is learned.
    beyond = jnp.maximum(jnp.abs(means) - 1, 0) ** 2
    return jnp.mean(-gained + 0.05 * missed) + 0.01 * jnp.mean(beyond) - 1e-3 * jnp.sum(parameters["log_deviation"])


UPDATES = DECISIONS // (ROBOTS * HORIZON)
STEPS = EPOCHS * ROBOTS * HORIZON // BATCH
optimizer = optax.chain(
    optax.clip_by_global_norm(0.5), optax.adam(optax.linear_schedule(LEARNING_RATE, 0.0, UPDATES * STEPS))
)


@jax.jit
def learn(parameters, state, played, better, order):
    played = [rows.reshape(-1, *rows.shape[2:]) for rows in played]
    better = (better - better.mean()) / (better.std() + 1e-8)

    def step(carry, chosen):
        parameters, state = carry
        inputs, actions, likelihoods, returns = (rows[chosen] for rows in played)
        gradient = jax.grad(loss)(parameters, inputs, actions, likelihoods, better.reshape(-1)[chosen], returns)
        change, state = optimizer.update(gradient, state, parameters)
        return (optax.apply_updates(parameters, change), state), None

    return jax.lax.scan(step, (parameters, state), order)[0]


def train(seed=0):
    """The parameters after `UPDATES` of `HORIZON` decisions of each robot."""
    key, policy, critic = jax.random.split(jax.random.PRNGKey(seed), 3)
    parameters = {
        "policy": layers(policy, [len(INPUTS), HIDDEN, HIDDEN, 3], 0.05),
        "value": layers(critic, [len(INPUTS), 128, 128, 1], 1.0),
        "log_deviation": jnp.full(3, -0.7),
    }
    state, generator, robots = optimizer.init(parameters), np.random.default_rng(seed), Robots(ROBOTS, seed)
    begun = time.monotonic()
    for update in range(1, UPDATES + 1):
        rows, arrived, ends = [], 0, 0
        for _ in range(HORIZON):
            key, drawn = jax.random.split(key)
            inputs = seen(robots.observations)
            actions, likelihoods, values = (np.asarray(part) for part in act(parameters, inputs, drawn))
            rewards, ended, over = robots.step(actions)
            rows.append((inputs, actions, likelihoods, values, np.float32(rewards - HURRY), np.float32(over)))
            arrived, ends = arrived + (ended & (rewards > 5)).sum(), ends + over.sum()
        inputs, actions, likelihoods, values, rewards, over = (np.stack(column) for column in zip(*rows))
        better = advantages(rewards, over, values, value(parameters, seen(robots.observations)))
        order = [generator.permutation(ROBOTS * HORIZON).reshape(-1, BATCH) for _ in range(EPOCHS)]
        played = (inputs, actions, likelihoods, better + values)
        parameters, state = learn(parameters, state, played, better, np.concatenate(order))
        if update % 20 == 0 or update == UPDATES:
            minutes, share = (time.monotonic() - begun) / 60, arrived / max(ends, 1)
            print(
                f"{update * ROBOTS * HORIZON / 1e6:5.1f} M decisions, {minutes:4.1f} min: {share:.0%} arrive",
                flush=True,
            )
    robots.vector.close()
    return parameters


# %%
parameters = train()
arrived, failed = success(lambda observations: np.asarray(mean(parameters, seen(observations))))
print(f"{WORLDS} unseen worlds: {arrived:.1%} arrive in time, {failed:.1%} meet something or stop with a fault")

# %% [markdown]
# The network as a file for `rumbo export-policy`: inputs, and of each layer the weights of each neuron.

# %%
network = {
    "activation": "clip",
    "inputs": [{"of": name, "centre": centre, "scale": scale} for name, centre, scale in INPUTS],
    "layers": [
        {"weights": np.asarray(layer["weights"]).T.tolist(), "biases": np.asarray(layer["biases"]).tolist()}
        for layer in parameters["policy"]
    ],
}
with open("goal.json", "w") as file:
    json.dump(network, file)

# %% [markdown]
# Beside it: the same network in worlds with two to six groups of boxes, and mode 8 of the control core in both.

# %%
if not SHORT:
    many = rumbo.load("world", "random")
    many["random"]["unreachable"] = 0.0
    for name, world in [("one to three groups", "boxes"), ("two to six groups", many)]:
        learned, _ = success(lambda observations: np.asarray(mean(parameters, seen(observations))), world=world)
        runs = rumbo.run("mode8-random", world=world, seeds=range(UNSEEN, UNSEEN + WORLDS))
        known = [runs.metrics[key] for key in ("reached", "time_s", "contact_speed_m_s")]
        own = np.mean((known[0] == 1) & (known[1] <= 60) & (known[2] <= 0.1))
        print(f"{name}: {learned:.1%} by the network, {own:.1%} by mode 8")
    assert arrived >= 0.85
