"""Two blocks of the bench, by heyoka: a Taylor integrator in C++ that compiles the equations.

    pip install heyoka && python benches/peers/two_blocks.py

The motion is that of `set.rs`, over 1000 units of time, with one `taylor_adaptive` for each pair of
modes and terminal events for what ends it. Printed are, for each tolerance, the least time per
cycle and the largest error of an event time; Dop853's time of the same minute, from `cargo bench`,
gives the ratio. One call from Python per phase is part of the time: about 1 us each.
"""

import sys
from fractions import Fraction
from importlib.metadata import version
from itertools import product
from time import perf_counter

import heyoka as hy

DURATION = 1000
ROUNDS = 40

# Static and kinetic coefficient and velocity of the laws, loads, and the matrices.
LAWS = [(0.6, 0.3, 0.2), (0.5, 0.25, 0.3)]
LOADS = [1.0, 1.4]
STIFFNESS = [[1.5, -0.5], [-0.5, 1.5]]
DAMPING = 0.05
BELT = 0.15
START = [0.523_660_590_383_745_1, 0.233_890_518_299_209_98]
VELOCITIES = [0.140_353_859_793_521_73, -0.132_503_073_222_260_2]

# Of the limit cycle, in units of 1e-24.
CYCLE = [
    508_293_215_527_993_490_415_401,
    2_547_609_415_828_917_893_598_680,
    3_392_906_458_578_959_572_403_559,
    5_504_332_522_897_116_729_048_316,
]
PERIOD = 5_750_688_912_863_576_733_684_439
UNIT = 10**24


def limit(i):
    return LOADS[i] * LAWS[i][0]


def force(i, u, w):
    """Force on block i, without friction; of numbers or expressions."""
    a, b = STIFFNESS[i]
    return -(a * u[0] + b * u[1]) - DAMPING * (w[i] + BELT)


def integrator(signs, tolerance):
    """The equations of a pair of modes, and the block of each event."""
    variables = hy.make_vars("u0", "u1", "w0", "w1")
    u, w = variables[:2], variables[2:]
    rates = [w[i] + BELT for i in range(2)]
    events, blocks = [], []
    for i, sign in enumerate(signs):
        if sign == 0:
            rates.append(hy.expression(0.0))
            expressions = [limit(i) - force(i, u, w), limit(i) + force(i, u, w)]
        else:
            top, low, speed = LAWS[i]
            friction = low + (top - low) * hy.exp(-((w[i] / speed) ** 2))
            rates.append(force(i, u, w) - LOADS[i] * sign * friction)
            expressions = [sign * w[i]]
        for expression in expressions:
            events.append(hy.t_event(expression, direction=hy.event_direction.negative))
            blocks.append(i)
    system = hy.taylor_adaptive(
        list(zip(variables, rates)), [0.0] * 4, t_events=events, tol=tolerance
    )
    return system, blocks


def run(systems):
    """The event times, as sums of two numbers."""
    signs = (-1, -1)
    point = START + [v - BELT for v in VELOCITIES]
    released = None
    time, rest, events = 0.0, 0.0, []
    while True:
        system, blocks = systems[signs]
        system.reset_cooldowns()
        system.time = 0.0
        system.state[:] = point
        while True:
            outcome = int(system.propagate_until(2.0 * DURATION)[0])
            assert outcome < 0, "a phase without an end"
            block = blocks[-outcome - 1]
            # A block starts to slip without acceleration: rounding may see another root of w there.
            if block != released or system.time > 1e-6:
                break
        step = system.time + rest
        total = time + step
        rest = step - (total - time)
        time = total
        if time >= DURATION:
            return events
        events.append((time, rest))
        point = list(system.state)
        point[2 + block] = 0.0
        pull = force(block, point[:2], point[2:])
        sticks = signs[block] != 0 and abs(pull) < limit(block)
        new = 0 if sticks else (1 if pull > 0 else -1)
        released = None if sticks else block
        signs = (new, signs[1]) if block == 0 else (signs[0], new)


def worst_error(events):
    exact = [CYCLE[k % 4] + k // 4 * PERIOD for k in range(len(events) + 1)]
    assert exact[-1] >= DURATION * UNIT, "events are missing"
    assert exact[-2] < DURATION * UNIT, "too many events"
    errors = (
        abs(Fraction(time) + Fraction(rest) - Fraction(place, UNIT))
        for (time, rest), place in zip(events, exact)
    )
    return float(max(errors))


def main():
    cycles = DURATION * UNIT // PERIOD
    versions = f"heyoka {version('heyoka')}, Python {sys.version.split()[0]}"
    print(f"{versions}, two blocks, {cycles} cycles")
    for tolerance in [1e-9, 1e-12, 2.2e-16]:
        pairs = product([-1, 0, 1], repeat=2)
        systems = {signs: integrator(signs, tolerance) for signs in pairs}
        events = run(systems)
        least = float("inf")
        for _ in range(ROUNDS):
            start = perf_counter()
            run(systems)
            least = min(least, perf_counter() - start)
        time, error = 1e6 * least / cycles, worst_error(events)
        print(f"{tolerance:8.0e} {time:8.2f} us a cycle, largest error {error:.1e}")


if __name__ == "__main__":
    main()
