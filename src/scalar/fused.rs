//! The choice of instructions for the series of slip.
//!
//! A fused multiply-add rounds once, and takes one instruction instead of two. Not every x86-64
//! processor has it, so a build for all of them tests for it at run time. The test is in one place,
//! [`compute`], and applies to the expansion of a slip phase and of many masses side by side, and
//! to the search for events of a structure. They give nearly all of the possible gain.
//!
//! | target | a·b + c in `taylor.rs`, `lanes.rs`, `PowerSeries::survey` | in everything else |
//! |---|---|---|
//! | x86-64 built with `fma`; 64-bit ARM | fused | fused |
//! | x86-64 | fused | two roundings |
//! | others, such as WebAssembly | two roundings | two roundings |
//!
//! In the second row a processor without the instruction expands a slip phase by `jet.rs` instead,
//! with two roundings. A whole motion then takes up to 1.4 times as long as unrolled without
//! fusing, but a second copy of the unrolled code would be 14 kB for each law, and of these 0.5 kB.
//!
//! With AVX-512 the fused code has twice as many registers, which takes 3 to 8 % off a motion on an
//! AMD EPYC. Processors that have to slow down for it (those before Intel's Ice Lake) are not asked
//! to use it. All results are the same to the bit.
//!
//! On other processors the instruction is replaced by slow library code. Code that is meant for
//! [`compute`] but not inlined into it (including closures) would call this code; `.ci/run` checks
//! that there is none.

use super::FUSED;

/// True if the processor is asked.
pub(crate) const CHOSEN: bool = cfg!(all(target_arch = "x86_64", not(target_feature = "fma")));

/// The sum a·b + c of code that is inlined into [`compute`].
#[inline(always)]
pub(crate) fn mul_add(a: f64, b: f64, c: f64) -> f64 {
    if FUSED || CHOSEN {
        a.mul_add(b, c)
    } else {
        a * b + c
    }
}

/// The sum a·b + c of code within [`compute`] that is its `otherwise` too, there not `CHOSEN`.
#[inline(always)]
pub(crate) fn mul_add_in<const CHOSEN: bool>(a: f64, b: f64, c: f64) -> f64 {
    if CHOSEN {
        mul_add(a, b, c)
    } else {
        super::mul_add(a, b, c)
    }
}

/// The result of `kernel` for `fixed` and `work`, with the instructions of this processor. If the
/// processor has to be asked, and has no fused multiply-add, the result of `otherwise`.
///
/// The kernel and all that it calls has to be `#[inline(always)]`, or is compiled for any
/// processor. It gets two references and no more, because two are handed over in registers, as
/// what they are: the compiler then knows that `fixed` stays the same while `work` is written. Of
/// two more, read from memory, it would not know whether they overlap.
#[inline(always)]
#[cfg_attr(
    all(target_arch = "x86_64", not(target_feature = "fma")),
    multiversion::multiversion(targets(
        "x86_64+avx512f+avx2+bmi1+bmi2+fma",
        "x86_64+avx2+bmi1+bmi2+fma"
    ))
)]
#[cfg_attr(
    not(all(target_arch = "x86_64", not(target_feature = "fma"))),
    expect(unused_variables)
)]
pub(crate) fn compute<A, B, R>(
    fixed: &A,
    work: &mut B,
    kernel: impl FnOnce(&A, &mut B) -> R,
    otherwise: impl FnOnce(&A, &mut B) -> R,
) -> R {
    #[cfg(all(target_arch = "x86_64", not(target_feature = "fma")))]
    if !multiversion::target::target_cfg_f!(target_feature = "fma") {
        return otherwise(fixed, work);
    }
    kernel(fixed, work)
}
