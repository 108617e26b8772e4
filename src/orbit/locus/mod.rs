//! Curves in two parameters.

pub(super) mod found;
