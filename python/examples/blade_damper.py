"""Two blades with a friction damper between them: resonance curves for several loads."""

import sys

import matplotlib.pyplot as plt

import stick_slip as ss

STIFFNESS = (1.0, 1.3)
DAMPING = 0.02
LOADS = (0.01, 1.0, 3.0, 8.0)


def blades(frequency: float, load: float) -> ss.Structure:
    built = ss.Structure([1.0, 1.0])
    for i, stiffness in enumerate(STIFFNESS):
        built = (
            built.with_ground_spring(i, stiffness)
            .with_ground_damper(i, DAMPING)
            .with_force(i, ss.Drive.harmonic(1.0, frequency))
        )
    return built.with_contact(ss.Contact.between(0, 1, ss.Coulomb(0.3, 0.3), load))


def largest(orbit: ss.Orbit) -> float:
    return max(orbit.amplitude(0), orbit.amplitude(1))


figure, axes = plt.subplots(figsize=(5, 3.2), layout="constrained")
for load in LOADS:
    start = ss.settle(blades(1.07, load), ([0.0, 0.0], [0.0, 0.0]), 400.0, periods=1)
    curve = ss.follow(lambda frequency: blades(frequency, load), 1.07, start, 0.96, 1.18)
    peak = max(curve.points, key=lambda point: largest(point.orbit))
    print(f"load {load:4.2f}: peak {largest(peak.orbit):.1f} at {peak.parameter:.3f}")
    curve.plot(axes, measure=largest, bifurcations=False)
    axes.lines[-1].set_label(None)
    axes.lines[-2].set_label(f"load {load:g}")
axes.set(xlabel="angular frequency", ylabel="largest amplitude", yscale="log")
axes.legend()
if len(sys.argv) > 1:
    figure.savefig(sys.argv[1])
