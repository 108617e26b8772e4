//! Analytic formulas, against the exact motions.

use stick_slip_tests_common as common;
use stick_slip_tests_compiled as _;

mod averaging;
mod duffing;
mod formulas;
mod hostile;
mod jenkins;
mod misprints;
mod motions;
mod orders;
mod properties;
mod rate_state;
