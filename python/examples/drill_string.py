"""A drill string of two inertias: at which speeds of the rotary table the bit sticks and slips."""

import sys
from math import tau

import matplotlib.pyplot as plt
import numpy as np

import stick_slip as ss

ROCK = ss.Stribeck(0.8, 0.4, 1.0, 1)  # coefficient of the bit over its speed in rad/s
TORQUE = 120e3 * 0.1  # N m: weight on the bit times its effective radius


def string(rpm: float) -> ss.Structure:
    """Angles of bit and table in a frame that turns with the drive; kg m^2, N m/rad, N m s."""
    bit = ss.Contact(0, ROCK, TORQUE, belt_velocity=-rpm * tau / 60)
    return (
        ss.Structure([374.0, 2122.0])
        .with_spring(0, 1, 473.0)
        .with_damper(0, 1, 23.2)
        .with_ground_spring(1, 4000.0)
        .with_ground_damper(1, 425.0)
        .with_contact(bit)
    )


ranges = ss.vibration_ranges(string, 30.0, 150.0)
for r in ranges:
    print(f"{r.low:6.2f} to {r.high:6.2f} rpm: {' or '.join(r.attractors)}")

figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3), layout="constrained")
speed = 50 * tau / 60
motion = string(50.0).simulate(([0.0, 0.0], [-speed, 0.0]), 30.0)
times = np.linspace(0.0, 30.0, 600)
q, v = motion.sample(times)
left.plot(times, (v + speed) * 60 / tau, label=["bit", "table"])
left.set(xlabel="time in s", ylabel="speed in rpm")
left.legend()
for branch in ranges.branches:
    branch.plot(right, coordinate=0, bifurcations=False)
right.set(xlabel="speed of the table in rpm", ylabel="amplitude of the bit in rad")
if len(sys.argv) > 1:
    figure.savefig(sys.argv[1])
