//! Periodic motions of any system: shooting, multipliers, sections, Lyapunov exponents.
//!
//! `data/driven_cycles.json`, `data/structure_cycles.json`, `data/dwell_cycles.json` and
//! `data/bristle_cycles.json` come from a Taylor integration in 220-bit arithmetic; the field
//! `header` of each file explains the others.

use common::reading;
use stick_slip_tests_common as common;
use stick_slip_tests_compiled as _;

mod bad_input;
mod belt;
mod births;
mod bounds;
mod classify;
mod derivatives;
mod dwell;
mod elastic;
mod event_loci;
mod families;
mod first_order;
mod fold_grazing;
mod follow;
mod forces;
mod formulas;
mod hopf_loci;
mod jenkins;
mod loci;
mod long_run;
mod measures;
mod opening;
mod random_births;
mod random_exponents;
mod random_ranges;
mod random_sensitivities;
mod random_switching;
mod ranges;
mod rate_state;
mod rate_state_searches;
mod references;
mod retracing;
mod seam;
mod sensitivities;
mod standing;
mod start_of_period;
mod stops;
mod stuck_joints;
mod switching;
mod translations;
