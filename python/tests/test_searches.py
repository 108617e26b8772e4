"""Limit cycles, diagrams, ranges; periodic motions, branches, curves, sections."""

from __future__ import annotations

import math

import numpy as np
import pytest
import reference

import stick_slip as ss

LAW = ss.Polynomial(0.4, 0.25, 0.5)
SYSTEM = ss.MassOnBelt(LAW, 0.2, damping=0.05)


def family(belt_velocity: float) -> ss.MassOnBelt:
    return ss.MassOnBelt(LAW, belt_velocity, damping=0.05)


def test_limit_cycles_have_the_documented_numbers() -> None:
    cycles = ss.limit_cycles(SYSTEM)
    [cycle] = cycles
    assert len(cycles) == 1 and cycles[-1].period == cycle.period
    assert cycle.kind == "stick-slip" and cycle.is_stable and cycle.multiplier == 0.0
    assert cycle.state == (0.38, 0.2)
    assert cycle.period == pytest.approx(6.799421444472157605, abs=1e-14)
    assert cycle.stick_duration == pytest.approx(1.629558444940023627, abs=4e-15)
    assert cycle.amplitude == pytest.approx(0.2862087190457751, abs=1e-15)
    assert cycle.mean_displacement == pytest.approx(0.289051936827857, abs=1e-15)
    energy = cycle.energy
    assert energy.drive_work == pytest.approx(energy.damper_loss + energy.friction_loss)
    assert energy.damper_loss == pytest.approx(0.02314806731453380, abs=1e-16)
    squares = (np.abs(cycle.velocity_harmonics(40)) ** 2).sum()
    assert cycle.rms_velocity == pytest.approx(math.sqrt(squares / 2), abs=1e-6)
    assert cycle.motion.duration == cycle.period and cycle.motion.last == cycle.state
    assert list(cycle.motion.events["kind"]) == ["stick", "release"]
    assert ss.stick_slip_cycle(SYSTEM.replace(belt_velocity=0.46)) is None
    assert cycles.stable[0].period == cycle.period and cycles.unstable == []
    with pytest.raises(IndexError):
        cycles[1]
    undamped = ss.limit_cycles(ss.MassOnBelt(ss.Coulomb(0.3, 0.3), 0.5))
    assert undamped.continuum is not None and "continuum" in repr(undamped)


def test_attractors() -> None:
    assert ss.attractor(SYSTEM, (0.0, 0.0)).kind == "stick-slip"
    bistable = ss.MassOnBelt(ss.Exponential(0.6, 0.3, 0.4), 1.0, damping=0.01)
    found = ss.attractor(bistable, [(0.3, 0.0), (2.0, 0.0)])
    assert [it.kind for it in found] == ["steady sliding", "stick-slip"]
    assert found[0].cycle is None and found[1].cycle is not None
    assert ss.classify(bistable, (2.0, 0.0)).kind == "stick-slip"


def test_belt_velocities_of_changes() -> None:
    [hopf] = ss.hopf_velocities(SYSTEM, 0.01, 1.0)
    assert hopf == pytest.approx(0.4409585518, abs=1e-10)
    [grazing] = ss.grazing_velocities(SYSTEM, 0.01, 1.0)
    assert grazing == pytest.approx(0.3957902887978, abs=1e-12)
    assert ss.criticality(SYSTEM, hopf) == "supercritical"
    for search in (
        ss.touching_velocities,
        ss.overshoot_velocities,
        ss.crossing_velocities,
        ss.fold_velocities,
    ):
        assert isinstance(search(SYSTEM, 0.1, 0.5), np.ndarray)
    for case in reference.cases("bifurcations") if reference.DATA.is_dir() else []:
        if case["kind"] == "poly_grazing":
            found = ss.grazing_velocities(reference.belt({**case, "v_b": "1"}), 0.01, 3.0)
            assert np.abs(found - float(case["v_grazing"])).min() < 1e-13
    with pytest.raises(ss.StickSlipError) as caught:
        ss.grazing_velocities(SYSTEM, 0.01, 0.5, max_steps=700)
    assert caught.value.variant == "Stopped" and len(caught.value.found) == 1


def test_silence_along_a_parameter() -> None:
    system = ss.MassOnBelt(ss.Exponential(0.4, 0.25, 0.5), 1.0)
    silent = ss.silencing_damping(system)
    search = ss.along(lambda damping: system.replace(damping=damping), 0.0, 0.5)
    assert search.silence() == pytest.approx(silent, abs=1e-15)
    law = ss.Exponential(0.4, 0.25, 0.5)
    brake = ss.along(lambda load: ss.MassOnBelt(law, 0.4, damping=0.05, load=load), 0.01, 2.0)
    [hopf] = brake.hopf()
    # 2 beta + gamma^2 mu' = 0
    assert hopf == pytest.approx(0.1 / (1.2 * 0.4 * math.exp(-0.64)), abs=4e-16)
    assert [r.vibrates for r in brake.vibration_ranges()] == [False, True, True]
    assert ss.silencing_load(system.replace(damping=0.05)) > 0
    with pytest.raises(ss.ParameterError, match="one's own throughout"):
        own = ss.Law(lambda s: 0.3 - 0.01 * s / (1 + s), static=0.4)
        ss.along(
            lambda load: ss.MassOnBelt(law if load < 0.5 else own, 0.4, load=load), 0.01, 2.0
        ).hopf()
    with pytest.raises(TypeError, match="must return a MassOnBelt"):
        ss.along(lambda load: load, 0.01, 2.0).hopf()  # type: ignore[arg-type, return-value]


def test_silencing_in_si_units() -> None:
    brake = ss.PhysicalMassOnBelt(
        ss.Exponential(0.4, 0.25, 0.05),
        mass=2.0,
        stiffness=800.0,
        normal_force=20.0,
        belt_velocity=0.05,
    )
    damping = ss.silencing_damping(brake)
    assert len(ss.limit_cycles(brake.replace(damping=1.0001 * damping))) == 0
    assert len(ss.limit_cycles(brake.replace(damping=0.9999 * damping))) > 0
    # The same cycle without dimensions: time in 1/omega, omega = 20 rad/s.
    plain = ss.MassOnBelt(ss.Exponential(0.4, 0.25, 0.05 / 20), 0.05 / 20, load=20.0 / 800.0)
    periods = [ss.limit_cycles(brake)[0].period * 20.0, ss.limit_cycles(plain)[0].period]
    assert periods[0] == pytest.approx(periods[1], rel=1e-12)


def test_a_brake_without_units() -> None:
    own = ss.Law(
        [lambda s: 0.45 - 0.1 * s / 0.05, lambda s: 0.35 + 0 * s], static=0.45, breakpoints=[0.05]
    )
    for law in (ss.Exponential(0.4, 0.25, 0.05), own):
        brake = ss.PhysicalMassOnBelt(
            law, mass=2.0, stiffness=800.0, normal_force=20.0, belt_velocity=0.03, damping=1.0
        )
        system = brake.dimensionless
        unit = brake.length * brake.angular_frequency
        speeds = np.linspace(0.0, 0.5, 20)
        assert np.array_equal(system.law.kinetic(speeds), law.kinetic(unit * speeds))
        assert system.law.breakpoints == [speed / unit for speed in law.breakpoints]
        [cycle], [plain] = ss.limit_cycles(brake), ss.limit_cycles(system)
        assert cycle.period * brake.angular_frequency == pytest.approx(plain.period, rel=1e-15)
        assert cycle.amplitude == pytest.approx(plain.amplitude * brake.length, rel=1e-15)
        averaged = ss.analysis.averaged_cycles(system)
        assert averaged[0].amplitude > 0.5 * plain.max_velocity
        contact = ss.Contact(0, system.law, 1.0, belt_velocity=system.belt_velocity)
        block = (
            ss.Structure([1.0])
            .with_ground_spring(0, 1.0)
            .with_ground_damper(0, 2 * system.damping)
            .with_contact(contact)
        )
        orbit = ss.shoot(block, plain.state, estimate=plain.period)
        assert orbit.period == pytest.approx(plain.period, rel=1e-13)
    scaled = ss.Scaled(ss.Exponential(0.4, 0.25, 0.05), 0.5)
    for refused in (
        lambda: ss.Scaled(scaled, 2.0),
        lambda: ss.Scaled(ss.Coulomb(0.4, 0.3), 0.0),
        lambda: ss.LuGre(scaled, 100.0, 0.5),
        lambda: ss.Dwell(scaled, rate=0.1, time=1.0),
        lambda: ss.Directional(ss.Coulomb(0.4, 0.3), scaled),
        lambda: ss.Freewheel(scaled),
        lambda: ss.PhysicalMassOnBelt(
            scaled, mass=2.0, stiffness=800.0, normal_force=20.0, belt_velocity=0.03
        ),
    ):
        with pytest.raises(ss.ParameterError) as caught:
            refused()
        assert caught.value.name == "velocity_unit"


def test_progress_has_the_units_of_the_system() -> None:
    brake = ss.PhysicalMassOnBelt(
        ss.Exponential(0.4, 0.25, 0.05),
        mass=2.0,
        stiffness=800.0,
        normal_force=20.0,
        belt_velocity=0.03,
        damping=1.0,
    )
    for search in (ss.grazing_velocities, ss.fold_velocities, ss.vibration_ranges):
        seen: list[float] = []
        search(brake, 0.01, 0.15, progress=lambda p: seen.append(p.value))
        assert len(seen) > 1 and all(0.01 - 1e-15 <= value <= 0.15 + 1e-15 for value in seen)
        assert max(seen) > 0.1
    with pytest.raises(ss.StickSlipError) as caught:
        ss.vibration_ranges(brake, 0.01, 0.15, progress=lambda p: False)
    assert caught.value.variant == "Stopped"
    with pytest.raises(ValueError, match="max_points"):
        ss.vibration_ranges(brake, 0.01, 0.15, max_points=3)


def test_diagrams() -> None:
    points = ss.diagram(SYSTEM, [0.2, 0.42, 0.46])
    kinds = [[c.kind for c in point.cycles] for point in points]
    assert kinds == [["stick-slip"], ["pure slip"], []]
    sliding = [point.equilibrium for point in points if point.equilibrium]
    assert [it.is_stable for it in sliding] == [False, False, True]
    assert len(points) == 3 and points[-1].belt_velocity == 0.46
    part = ss.diagram(SYSTEM, [0.2, 0.42, 0.46], progress=lambda p: p.points < 2)
    assert len(part) == 2


def test_ranges_of_a_belt_and_of_a_family() -> None:
    system = ss.MassOnBelt(ss.Exponential(0.6, 0.3, 0.4), 1.0, damping=0.01)
    ranges = ss.vibration_ranges(system, 0.05, 4.0)
    assert [r.is_bistable for r in ranges] == [False, True, False]
    found = ss.vibration_ranges(lambda v: system.replace(belt_velocity=v), 0.05, 4.0)
    assert len(found.branches) >= 1 and found.sweep is not None and found.stopped is None
    assert len(found.probes) >= 16
    for one, other in zip(ranges, found, strict=True):
        assert one.attractors == other.attractors
        assert (one.low, one.high) == pytest.approx((other.low, other.high), abs=1e-8)
    assert found[1].borders[0] == "Hopf"


def test_orbits_branches_and_bifurcations() -> None:
    orbit = ss.settle(SYSTEM, (0.0, 0.0), 60.0, estimate=6.8)
    cycle = ss.limit_cycles(SYSTEM)[0]
    assert orbit.period == pytest.approx(cycle.period, abs=1e-13)
    assert orbit.amplitude() == pytest.approx(cycle.amplitude, abs=1e-14)
    assert orbit.stick_duration() == pytest.approx(cycle.stick_duration, abs=1e-13)
    assert orbit.is_stable and not orbit.is_forced and orbit.slips() == 1
    assert orbit.energy.friction_loss[0] == pytest.approx(cycle.energy.friction_loss, abs=1e-13)
    assert abs(orbit.harmonics(3)).tolist() == pytest.approx(abs(cycle.harmonics(3)).tolist())
    assert orbit.motion.energy_budget().stored == pytest.approx(0.0, abs=1e-14)
    with pytest.raises(IndexError, match="no coordinate 1"):
        orbit.amplitude(1)
    with pytest.raises(IndexError, match="no contact 3"):
        orbit.slips(3)
    with pytest.raises(ValueError, match="give periods"):
        ss.shoot(SYSTEM, (0.1, 0.2))
    branch = ss.follow(family, 0.2, orbit, 0.05, 0.5)
    assert {end.kind for end in branch.ends} == {"range", "Hopf"}
    assert branch.ends[1].parameter == pytest.approx(ss.hopf_velocities(SYSTEM, 0.1, 1.0)[0])
    assert len(branch) == len(branch.parameters) == len(branch.points)
    assert branch.stable.all() and branch.stable.dtype == bool
    assert branch.amplitudes()[0] == branch.points[0].orbit.amplitude()
    grazing = [b for b in branch.bifurcations if b.kind == "grazing"]
    assert grazing[0].parameter == pytest.approx(0.3957902887978, abs=1e-9)
    born = ss.begin(family, 0.44)
    assert born.orbit.amplitude() < 0.1 and "BranchPoint" in repr(born)


def forced(omega: float, force: float = 0.15) -> ss.Structure:
    contact = ss.Contact(0, LAW, 1.0, belt_velocity=0.2)
    return (
        ss.Structure([1.0])
        .with_ground_spring(0, 1.0)
        .with_ground_damper(0, 0.1)
        .with_force(0, ss.Drive.harmonic(force, omega))
        .with_contact(contact)
    )


def test_forced_motions_sections_and_derivatives() -> None:
    system = forced(0.8)
    orbit = ss.settle(system, ([0.0], [0.0]), 100.0, periods=1)
    assert orbit.is_forced and orbit.period == pytest.approx(2 * math.pi / 0.8)
    assert orbit.multipliers[0] == pytest.approx(0.09088860389457677, abs=1e-13)
    q, v = ss.section(system, ([0.0], [0.0]), orbit.period, 3, skip=20)
    state = orbit.state
    np.testing.assert_allclose(q[:, 0], state[0][0], atol=1e-12)
    times, q, v = ss.section_at(system, ([0.0], [0.0]), 0, "stick", 4, skip=20)
    np.testing.assert_allclose(np.diff(times), orbit.period, rtol=1e-12)
    with pytest.raises(ValueError, match="kind is"):
        ss.section_at(system, ([0.0], [0.0]), 0, "halt", 4)
    assert ss.lyapunov(system, ([0.0], [0.0]), 50.0, 200.0).value < 0
    both = ss.orbit_sensitivities(lambda p: forced(0.8, p[0]), [0.15], orbit)
    assert both.period[0] == 0.0
    step = 1e-5
    ahead, behind = (
        ss.settle(forced(0.8, 0.15 + s), ([0.0], [0.0]), 100.0, periods=1) for s in (step, -step)
    )
    time = both.motion.times[0] + 0.3
    derivative = both.motion.at(time)
    assert derivative is not None and derivative.shape == (2, 1)
    difference = (ahead.motion.sample(time)[0][0] - behind.motion.sample(time)[0][0]) / (2 * step)
    assert derivative[0, 0] == pytest.approx(difference, rel=1e-5)


def test_derivatives_of_a_motion() -> None:
    law = ss.Coulomb(0.4, 0.25)
    found = ss.sensitivities(lambda p: (ss.MassOnBelt(law, p[0]), (0.0, p[0])), [0.5], 4.0)
    [release, *_] = found.events
    # The mass moves with the belt until u = 0.4: t = 0.4/v_b.
    assert release.kind == "release" and release.time == pytest.approx(0.8)
    assert release.by_parameters[0] == pytest.approx(-0.4 / 0.25, rel=1e-9)
    assert found.times == (0.0, 4.0) and found.at(5.0) is None and found.state_at(5.0) is None
    with pytest.raises(TypeError, match="pair"):
        ss.sensitivities(lambda p: ss.MassOnBelt(law, p[0]), [0.5], 4.0)  # type: ignore


def test_sweeps_and_classes() -> None:
    swept = ss.sweep(family, [0.2, 0.42, 0.46], (0.0, 0.0))
    kinds = [point.attractor.kind for point in swept.up if point.attractor]
    assert kinds == ["stick-slip", "pure slip", "steady sliding"]
    assert [p.parameter for p in swept.down] == [0.46, 0.42, 0.2] and swept.stopped is None


def test_curves_of_bifurcations() -> None:
    def duffing(omega: float, force: float) -> ss.Structure:
        spring = ss.ForceElement(0, ss.PolynomialSpring([0.0, 0.0, 0.5]))
        return (
            ss.Structure([1.0])
            .with_ground_spring(0, 1.0)
            .with_ground_damper(0, 0.1)
            .with_force(0, ss.Drive.harmonic(force, omega))
            .with_element(spring)
        )

    orbit = ss.settle(duffing(1.0, 0.6), ([0.0], [0.0]), 200.0, periods=1)
    branch = ss.follow(lambda omega: duffing(omega, 0.6), 1.0, orbit, 0.8, 2.5)
    folds = [b for b in branch.bifurcations if b.kind == "fold"]
    assert len(folds) == 2 and not branch.stable.all()
    curve = ss.locus(duffing, folds[0], 0.6, ((0.8, 2.5), (0.01, 1.0)), max_points=400)
    assert curve.kind == "fold" and curve.parameters.shape == (len(curve.points), 2)
    assert [point.kind for point in curve.special] == ["cusp"]
    curves = ss.hopf_locus(
        lambda v, load: ss.MassOnBelt(LAW, v, damping=0.05, load=load), ((0.05, 0.6), (0.3, 2.0))
    )
    assert len(curves) == 1
    for point in curves[0].points:
        v, load = point.parameters
        # 2 beta + gamma^2 mu'(v) = 0
        assert 0.1 + load * LAW.slope(v) == pytest.approx(0.0, abs=1e-10)
        assert point.frequency == pytest.approx(1.0) and point.criticality == "supercritical"
    doubled = [b for b in branch.bifurcations if b.kind == "flip"]
    with pytest.raises(ss.StickSlipError) as caught:
        folds[0].switch(lambda omega: duffing(omega, 0.6))
    assert caught.value.variant == "NoSwitch" and doubled == []


def test_families_peaks_and_changes() -> None:
    def forced(omega: float) -> ss.Structure:
        return (
            ss.Structure([1.0])
            .with_ground_spring(0, 1.0)
            .with_ground_damper(0, 0.1)
            .with_force(0, ss.Drive.harmonic(1.0, omega))
        )

    orbit = ss.shoot(forced(0.9), ([0.0], [0.0]), periods=1)
    assert orbit.families == []
    branch = ss.follow(forced, 0.9, orbit, 0.9, 1.1)
    peak = branch.peak()
    assert peak is not None and peak.orbit.amplitude() == branch.amplitudes().max()
    assert peak.parameter == pytest.approx(0.9975, abs=0.2 / 64)
    with pytest.raises(IndexError):
        branch.peak(1)
    with pytest.raises(TypeError, match="do not keep their systems"):
        peak.orbit.motion.samples(0.1)
    law = ss.Exponential(0.6, 0.3, 0.4)
    sweep = ss.sweep(
        lambda w: ss.MassOnBelt(law, w, damping=0.01), 0.25 * np.arange(1, 17), (0.0, 0.0)
    )
    ends, begins = sweep.changes
    assert (ends.before, ends.after) == ("stick-slip", "steady sliding")
    assert (begins.before, begins.after) == ("steady sliding", "stick-slip")
    assert begins.between[0] < ends.between[0]
