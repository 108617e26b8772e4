//! Limit cycles and bifurcations.

use stick_slip_tests_common as common;
use stick_slip_tests_compiled as _;

mod along;
mod bifurcations;
mod brute_force;
mod cases;
mod cycles;
mod faults;
mod folds;
mod maps;
mod measures;
mod properties;
mod stiff;
