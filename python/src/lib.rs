//! The extension module of the Python package `stick_slip`. See `README.md`.

// A function of Python has as many arguments as it needs, and takes them by value.
#![allow(clippy::needless_pass_by_value, clippy::too_many_arguments)]

mod analysis;
mod any_belt;
mod belt;
mod contact;
mod contact_law;
mod convert;
mod cycle;
mod drive;
mod error;
mod family;
mod first_order;
mod force;
mod law;
mod made;
mod motion;
mod orbit;
mod record;
mod simulate;
mod state;
mod stop;
mod structure;
mod traced;
mod waiting;

/// Friction-induced vibration, computed to round-off: the part written in Rust.
#[pyo3::pymodule]
mod _stick_slip {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::belt::{Equilibrium, PyBelt, PyPhysicalBelt};
    #[pymodule_export]
    use crate::contact::PyContact;
    #[pymodule_export]
    use crate::contact_law::{
        PyContactLaw, PyRateState, capstan, dahl, directional, dwell, freewheel, lugre,
    };
    #[pymodule_export]
    use crate::cycle::{
        Along, BeltAttractor, CycleEnergy, CycleSet, Diagram, LimitCycle, PyDiagramPoint, along,
        attractor, criticality, crossing_velocities, diagram, fold_velocities, grazing_velocities,
        hopf_velocities, limit_cycles, overshoot_velocities, silencing_damping, silencing_load,
        silencing_stiffness, stick_slip_cycle, touching_velocities,
    };
    #[pymodule_export]
    use crate::drive::PyDrive;
    #[pymodule_export]
    use crate::first_order::PyFirstOrder;
    #[pymodule_export]
    use crate::force::{
        PyForceElement, PyForceLaw, backlash, pendulum, polynomial_spring, snap_through,
        tabulated_force, van_der_pol,
    };
    #[pymodule_export]
    use crate::law::{
        Iwan4, PyLaw, coulomb, exponential, polynomial, rational, scaled, stribeck, tabulated,
    };
    #[pymodule_export]
    use crate::motion::{EnergyBudget, PyMotion, Samples};
    #[pymodule_export]
    use crate::orbit::{
        BranchEnd, Change, EventSensitivity, HopfPoint, LocusEnd, LyapunovExponent, Passage,
        PyAttractor, PyBifurcation, PyBranch, PyBranchPoint, PyHopfLocus, PyLocus, PyLocusPoint,
        PyOrbit, PyOrbitSensitivities, PySensitivities, PySpecialPoint, PySweep, SweepPoint,
        VibrationRange, VibrationRanges, begin, classify, follow, hopf_locus, locus, lyapunov,
        orbit_sensitivities, section, section_at, section_through, sensitivities, settle, shoot,
        sweep, vibration_ranges,
    };
    #[pymodule_export]
    use crate::stop::PyStop;
    #[pymodule_export]
    use crate::structure::{Carried, Mechanism, PyStructure, StabilityChange, SteadySliding};
    #[pymodule_export]
    use crate::waiting::Progress;

    /// Formulas: closed forms and expansions, against which motions are compared.
    #[pymodule]
    mod analysis {
        use pyo3::prelude::*;

        #[pymodule_export]
        use crate::analysis::{
            AveragedCycle, Backbone, ContactVibration, DuffingResponse, DwellOscillator,
            ExactCycle, Flutter, ForcedOscillator, FreeVibration, PureSlip, PureSlipCycle,
            SteadyBristles, StickSlip, StickSlipCycle, SymmetricResponse, TangentialSlip,
            TwoInertias, WithoutStops, averaged_cycles, backbone, contact_vibration,
            coulomb_silencing_damping, coulomb_stick_slip, drift, drift_slope,
            duffing_friction_decay, duffing_period, duffing_response, exponential_hopf_velocities,
            first_harmonic, first_integral, free_vibration, healing, largest_stick_slip_velocity,
            loop_area, masing, mean_coefficient, mode_coupling_flutter, no_stop_limit,
            onset_velocity, passive_viscosity, quiet_velocity, regime,
            silencing_damping_everywhere, stabilizing_damping, steady_bristles, stress_drop,
            symmetric_response, tangential_slip, time_to_instability, velocity_step,
        };

        /// Makes the module one that can be imported by its name.
        #[pymodule_init]
        fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
            let modules = module.py().import("sys")?.getattr("modules")?;
            modules.set_item("stick_slip._stick_slip.analysis", module)
        }
    }
}
