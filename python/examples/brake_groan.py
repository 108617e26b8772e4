"""Brake groan in SI units: at which disc speeds a pad vibrates, how, and what silences it."""

import sys

import matplotlib.pyplot as plt
import numpy as np

import stick_slip as ss

# Friction falls from 0.45 to 0.35 within some 0.05 m/s.
pad = ss.PhysicalMassOnBelt(
    ss.Stribeck(0.45, 0.35, 0.05, 1),
    mass=4.0,
    stiffness=1.0e6,
    normal_force=800.0,
    belt_velocity=0.03,
    damping=20.0,
)

[cycle] = ss.limit_cycles(pad)
print(f"at 0.03 m/s: {cycle.kind}, {cycle.hertz:.2f} Hz, {1e6 * cycle.amplitude:.1f} um")
for r in ss.vibration_ranges(pad, 0.005, 0.5):
    print(f"{r.low:.4f} to {r.high:.4f} m/s: {' or '.join(r.attractors)}")
print(f"silent from a damper of {ss.silencing_damping(pad):.1f} N s/m on")

motion = pad.simulate((0.0, 0.0), 0.1)
diagram = ss.diagram(pad, np.linspace(0.005, 0.45, 40))

figure, (left, middle, right) = plt.subplots(1, 3, figsize=(9, 2.8), layout="constrained")
motion.plot(left, points=400)
left.set(xlabel="time in s", ylabel="displacement in m")
cycle.motion.plot_phase(middle, points=200)
middle.set(xlabel="displacement in m", ylabel="velocity in m/s")
diagram.plot(right)
right.set(xlabel="disc speed in m/s", ylabel="amplitude in m")
if len(sys.argv) > 1:
    figure.savefig(sys.argv[1])
