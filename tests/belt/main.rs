//! Motions of one mass on its belt: every step, event and error.

use stick_slip_tests_common as common;
use stick_slip_tests_compiled as _;

mod broken_laws;
mod check_law;
mod errors;
mod hostile;
mod independent;
mod integrator;
mod laws;
mod physical;
mod radau;
mod reference;
mod scaling;
mod stiff;
mod stop;
mod sweep;
