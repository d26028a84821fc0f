# %% [markdown]
# # How much gain is enough, and does the battery matter?
#
# Mode 1 drives to a distance from the wall ahead and stops there. Its gain, `front_kp`, decides how fast; an empty
# battery makes the motors weaker. A sweep over both, with many drawn robots at each point, shows where the robot is
# fast and still keeps its limits.
#
# Each `# %%` is a cell: Visual Studio Code, Spyder, PyCharm and Jupytext open this file as a notebook. It needs Rumbo
# and matplotlib.

# %%
import os

import matplotlib.pyplot as plt
import numpy as np

import rumbo

# Tests of this file make it short.
GAINS, ROBOTS = (6, 4) if "RUMBO_SHORT" in os.environ else (20, 50)

# %%
sweep = rumbo.sweep(
    "mode1",
    {"front_kp": f"0.5:20:{GAINS}:log", "battery.open_circuit_v": [6.8, 7.4, 8.2]},
    seeds=range(1, ROBOTS + 1),
    progress=True,
)
print(sweep)

# %% [markdown]
# The points are a grid, the last axis varies fastest, and each point was driven by the same robots. So every column has
# the shape gains x voltages x robots.

# %%
shape = (GAINS, 3, ROBOTS)
gain = sweep.points["front_kp"].reshape(GAINS, 3)[:, 0]
voltage = sweep.points["battery.open_circuit_v"].reshape(GAINS, 3)[0]
passed = sweep.passed.reshape(shape).mean(axis=2)
# The worse of both steps; a robot that never settles takes for ever.
steps = [sweep.metrics[f"{step}.settling_s"] for step in ("step1", "step2")]
settling_s = np.nan_to_num(np.maximum(*steps), nan=np.inf).reshape(shape)

# %% [markdown]
# ## Median and a band of nine robots in ten

# %%
figure, axes = plt.subplots()
low, median, high = np.quantile(settling_s, [0.05, 0.5, 0.95], axis=2, method="nearest")
for column, volts in enumerate(voltage):
    (line,) = axes.plot(gain, median[:, column], label=f"{volts} V")
    axes.fill_between(gain, low[:, column], np.minimum(high[:, column], 10.0), color=line.get_color(), alpha=0.2)
axes.set(xscale="log", xlabel="front_kp (1/s)", ylabel="settling time (s)", ylim=(0, 10))
axes.legend(title="battery")
plt.show()

# %% [markdown]
# ## Robots that keep all limits of the scenario

# %%
figure, axes = plt.subplots()
mesh = axes.pcolormesh(np.arange(GAINS), voltage, 100 * passed.T, vmin=0, vmax=100, cmap="viridis")
axes.set(xlabel="front_kp (1/s)", ylabel="battery (V)", yticks=voltage)
axes.set_xticks(np.arange(GAINS), [f"{value:.2g}" for value in gain], rotation=90)
figure.colorbar(mesh, label="passed (%)")
plt.show()

# %% [markdown]
# ## One robot with too little, the best and the most gain
#
# A run of the sweep is one of `rumbo.run` with the same seed and parameters: with `trace=True` it shows its ground
# truth.

# %%
figure, axes = plt.subplots()
for value in (gain[0], gain[int(median[:, 1].argmin())], gain[-1]):
    run = rumbo.run(
        "mode1",
        seeds=int(sweep.seeds[0]),
        parameters={"front_kp": value, "battery.open_circuit_v": 7.4},
        trace=True,
    )[0]
    axes.plot(run.trace["t_s"], run.trace["range_front_m"], label=f"front_kp = {value:.2g}")
axes.set(xlabel="time (s)", ylabel="true distance to the wall (m)")
axes.legend()
plt.show()
