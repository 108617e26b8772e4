"""The formulas against the motions."""

from __future__ import annotations

import math

import numpy as np
import pytest

import stick_slip as ss
from stick_slip import analysis

SYSTEM = ss.MassOnBelt(ss.Polynomial(0.4, 0.25, 0.5), 0.42, damping=0.05)


def test_pure_slip() -> None:
    formulas = analysis.PureSlip(SYSTEM)
    assert formulas.eta == pytest.approx(0.45)
    assert (formulas.h1, formulas.h2, formulas.h3) == pytest.approx((-0.03248, -0.756, 0.6))
    [cycle] = ss.limit_cycles(SYSTEM)
    orders = [
        formulas.first_order(),
        formulas.second_order(),
        formulas.third_order(),
        formulas.fourth_order(),
    ]
    errors = [abs(it.amplitude - cycle.amplitude) for it in orders if it is not None]
    assert len(errors) == 4 and errors[0] > 10 * errors[1] >= errors[3]
    assert formulas.amplitude == pytest.approx(0.2686592224, abs=1e-10)
    assert formulas.is_valid and analysis.regime(SYSTEM) == "pure slip"
    state = formulas.transient(0.1, 0.0, 1000.0)
    assert state is not None and abs(state[1]) < 0.3
    assert formulas.onset_velocity == pytest.approx(ss.hopf_velocities(SYSTEM, 0.1, 1.0)[0])
    with pytest.raises(TypeError, match="Polynomial"):
        analysis.PureSlip(ss.MassOnBelt(ss.Coulomb(0.4, 0.3), 0.2))
    with pytest.raises(ValueError, match="at rest"):
        analysis.PureSlip(SYSTEM.replace(belt_velocity=0.0))


def test_stick_slip() -> None:
    system = SYSTEM.replace(belt_velocity=0.2)
    formulas = analysis.StickSlip(system)
    [cycle] = ss.limit_cycles(system)
    first, second = formulas.first_order(), formulas.second_order()
    assert first is not None and second is not None
    assert abs(second.period - cycle.period) < abs(first.period - cycle.period)
    # Every law, one's own too, has the formulas that need no cubic.
    own = ss.Law(lambda s: 0.3 + 0.1 * np.exp(-s), static=0.4)
    assert analysis.StickSlip(ss.MassOnBelt(own, 0.2)).amplitude > 0
    with pytest.raises(ValueError, match="kappa > 0"):
        analysis.StickSlip(ss.MassOnBelt(ss.Coulomb(0.3, 0.3), 0.2))


def test_averaging() -> None:
    [averaged] = analysis.averaged_cycles(SYSTEM)
    assert averaged.amplitude == pytest.approx(analysis.PureSlip(SYSTEM).amplitude)
    assert analysis.drift(SYSTEM, averaged.amplitude) == pytest.approx(0.0, abs=1e-15)
    assert analysis.drift_slope(SYSTEM, averaged.amplitude) == pytest.approx(averaged.drift_slope)
    assert averaged.is_stable and averaged.is_valid


def test_design() -> None:
    damping = analysis.stabilizing_damping(SYSTEM)
    assert damping == pytest.approx(-SYSTEM.law.slope(0.42) / 2)
    over = analysis.stabilizing_damping(SYSTEM, 0.0, 1.0)
    assert over == pytest.approx(0.45 / 2)
    assert analysis.silencing_damping_everywhere(SYSTEM) == pytest.approx(0.225)
    assert analysis.quiet_velocity(SYSTEM) == pytest.approx(0.4409585518, abs=1e-9)
    exponential = ss.MassOnBelt(ss.Exponential(0.4, 0.25, 0.5), 1.0, damping=0.01)
    pair = analysis.exponential_hopf_velocities(exponential)
    assert pair is not None
    assert [v for v, _ in pair] == pytest.approx(ss.hopf_velocities(exponential, 1e-3, 3.0))
    with pytest.raises(ValueError, match="both"):
        analysis.stabilizing_damping(SYSTEM, 0.0)


def test_coulomb() -> None:
    system = ss.MassOnBelt(ss.Coulomb(0.4, 0.25), 0.1, damping=0.05)
    exact, cycle = analysis.coulomb_stick_slip(system), ss.stick_slip_cycle(system)
    assert exact is not None and cycle is not None
    assert exact.period == pytest.approx(cycle.period, rel=1e-13)
    assert exact.amplitude == pytest.approx(cycle.amplitude, rel=1e-13)
    [grazing] = ss.grazing_velocities(system, 0.01, 1.0)
    assert analysis.largest_stick_slip_velocity(system) == pytest.approx(grazing)
    slip = analysis.tangential_slip(0.05)
    assert slip is not None and slip.velocity_factor * 0.15 == pytest.approx(grazing)
    assert analysis.coulomb_silencing_damping(system) == pytest.approx(ss.silencing_damping(system))
    rest = ss.MassOnBelt(ss.Coulomb(0.1, 0.1), 0.0)
    free = analysis.free_vibration(rest, (1.03, 0.0))
    assert free is not None and free.amplitude_loss == pytest.approx(0.4)
    motion = rest.simulate((1.03, 0.0), 50.0)
    assert motion.last == pytest.approx((free.rest_position, 0.0), abs=1e-14)
    assert analysis.mean_coefficient(ss.Coulomb(0.4, 0.25), 0.1, 0.2) == pytest.approx(
        0.25 * 2 / math.pi * math.asin(0.5)
    )


def test_dwell() -> None:
    law = ss.Dwell(ss.Coulomb(0.3, 0.3), limit=0.6, time=2.0)
    oscillator = analysis.DwellOscillator(law, mass=1.0, stiffness=1.0, load=1.0, damping=0.05)
    exact = oscillator.stick_slip(0.1)
    block = (
        ss.Structure([1.0])
        .with_ground_spring(0, 1.0)
        .with_ground_damper(0, 0.05)
        .with_contact(ss.Contact(0, law, 1.0, belt_velocity=0.1))
    )
    assert exact is not None
    orbit = ss.settle(block, ([0.0], [0.0], [0.0]), 100.0, estimate=exact.period)
    assert exact.period == pytest.approx(orbit.period, rel=1e-12)
    assert oscillator.fold is not None and oscillator.grazing_velocity is not None
    assert oscillator.grazing_velocity < oscillator.fold.belt_velocity
    with pytest.raises(TypeError, match="Dwell"):
        analysis.DwellOscillator(ss.Dahl(0.3, 1.0), mass=1.0, stiffness=1.0, load=1.0)


def test_other_formulas() -> None:
    assert analysis.duffing_period(1.0, 1.0, 0.7, 2.0) == pytest.approx(3.603712656168182)
    decay = analysis.duffing_friction_decay(1.0, 1.0, 0.0, 0.1, 0.1, 1.03)
    assert decay is not None and abs(decay[1][-1]) <= 0.1
    assert len(analysis.duffing_response(1.0, 0.05, 1.0, 0.5, 0.1, 0.6, 1.4)) == 3
    string = analysis.TwoInertias(upper=2000.0, lower=400.0, stiffness=600.0, damping=500.0)
    slope = string.critical_slope
    assert slope is not None and string.is_stable(0.99 * slope)
    assert not string.is_stable(1.01 * slope)
    assert string.best_damper == pytest.approx(2000 * math.sqrt(1.5))
    oscillator = analysis.ForcedOscillator(
        damping=0.05, angular_frequency=0.8, kinetic_friction=0.3, static_friction=0.3, force=1.0
    )
    motion = oscillator.without_stops()
    assert motion is not None and motion.at(0.0)[0] == pytest.approx(motion.amplitude)
    assert analysis.no_stop_limit(0.8) is not None
    bristles = ss.LuGre(ss.Exponential(0.4, 0.25, 0.5), 100.0, 0.5, viscous=0.02)
    steady = analysis.steady_bristles(bristles, 0.3)
    assert steady is not None
    assert steady.coefficient == pytest.approx(0.25 + 0.15 * math.exp(-0.36) + 0.006)
    small = analysis.contact_vibration(bristles, mass=2.0, load=3.0, stiffness=4.0)
    assert small is not None and small.angular_frequency == pytest.approx(math.sqrt(152.0))
    assert analysis.passive_viscosity(bristles, 1.0) >= 0
    flutter = analysis.mode_coupling_flutter(
        masses=(1.0, 1.0), stiffness=((2.0, 0.3), (0.3, 1.5)), normal_stiffness=1.0
    )
    assert flutter is not None and flutter.coefficient == pytest.approx(0.3 + 0.25 / 1.2)
    assert analysis.loop_area(2.0, 3.0, 5.0) == 42.0
    stiffness, damping, loss = analysis.first_harmonic(2.0, 3.0, 5.0, 1.0)
    assert loss == 42.0 and damping == pytest.approx(42.0 / (math.pi * 25.0)) and stiffness < 2.0
    assert analysis.backbone(1.0, 0.0, 1.0, 1.0, 1.0, 0.5) is not None
    forces = analysis.masing(lambda x: max(-3.0, min(3.0, 2 * x)), [0.0, 5.0, 3.5, 2.0, -5.0])
    assert forces is not None and forces.tolist() == [0.0, 3.0, 0.0, -3.0, -3.0]
    with pytest.raises(ZeroDivisionError):
        analysis.masing(lambda x: 1 / 0, [0.0, 1.0])
