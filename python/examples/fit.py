"""Identification: a friction law of one's own from noisy displacements, by scipy.optimize."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import least_squares

import stick_slip as ss

TIMES = np.linspace(0.0, 30.0, 301)
TRUE = np.array([0.45, 0.25, 0.15])  # static and least coefficient, decay speed
NOISE = 0.01


def motion(p: np.ndarray) -> ss.Motion:
    static, least, speed = p
    law = ss.Law(lambda s: least + (static - least) * np.exp(-s / speed), static=static)
    return ss.MassOnBelt(law, 0.1, damping=0.03).simulate((0.0, 0.1), TIMES[-1])


measured = motion(TRUE).sample(TIMES)[0] + NOISE * np.random.default_rng(1).normal(size=TIMES.size)
fit = least_squares(
    lambda p: (motion(p).sample(TIMES)[0] - measured) / NOISE,
    x0=[0.43, 0.28, 0.1],
    bounds=([0.3, 0.05, 0.01], [0.6, 0.29, 1.0]),
)
spread = np.sqrt(np.diag(np.linalg.inv(fit.jac.T @ fit.jac)))
for name, true, found, error in zip(("static", "least", "speed"), TRUE, fit.x, spread):
    print(f"{name:6}  true {true:.3f}  found {found:.4f} +- {error:.4f}")

figure, axes = plt.subplots(figsize=(6, 3), layout="constrained")
axes.plot(TIMES, measured, ".", markersize=3, color="gray", label="measured")
axes.plot(TIMES, motion(fit.x).sample(TIMES)[0], label="fit")
axes.set(xlabel="time", ylabel="displacement", xlim=(0, 30))
axes.legend()
if len(sys.argv) > 1:
    figure.savefig(sys.argv[1])
