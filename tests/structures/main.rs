//! Several masses, drives in time, several contacts.
//!
//! `data/driven_trajectories.json`, `data/structure_trajectories.json`,
//! `data/dwell_trajectories.json`, `data/dwell_cycles.json`, `data/bristle_trajectories.json` and
//! `data/structure_bifurcations.json` come from a Taylor integration in 220-bit arithmetic, checked
//! against a Runge-Kutta method; the field `header` of each file explains the others.

use common::{naive, plain, reading, work};
use stick_slip_tests_common as common;
use stick_slip_tests_compiled as _;

mod bad_input;
mod bristles;
mod closed_forms;
mod contacts;
mod contacts_random;
mod cost;
mod decisions;
mod dependent;
mod directional;
mod edges;
mod elastic;
mod elastic_identities;
mod energy;
mod first_order;
mod force_laws;
mod forces;
mod formulas;
mod functions;
mod heat;
mod identities;
mod loads;
mod memory;
mod memory_formulas;
mod modelica;
mod not_numbers;
mod random;
mod rate_state;
mod restarts;
mod seismic;
mod steady;
mod steady_at;
mod stiff_memory;
mod stiff_speed;
mod stops;
mod ties;
mod trajectories;
mod two_engines;
