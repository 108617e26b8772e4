//! With which instructions the coefficients of a motion's series are computed.
//!
//! A fused multiply-add rounds once, and takes half the instructions. It was not among those that
//! every x86-64 processor has, so a build for any of them has to ask at run time. It asks in one
//! place, [`compute`], where one slip phase is expanded: that is more than half of all work, and
//! nine tenths of what these instructions gain.
//!
//! | target | a·b + c in `taylor.rs` | in everything else |
//! |---|---|---|
//! | x86-64 built with `fma`; 64-bit ARM | fused | fused |
//! | x86-64 | fused | two roundings |
//! | others, such as WebAssembly | two roundings | two roundings |
//!
//! In the second row a processor without the instruction expands by `jet.rs` instead, with two
//! roundings: slower, but with hardly any code, where a second copy of an unrolled series would
//! take 14 kB of each law. The software that stands for the instruction elsewhere is six times
//! slower than no fusing. It would be called by what is meant for [`compute`] but not inlined into
//! it; `.ci/run` looks for that.

use super::FUSED;

/// Whether the instructions are chosen at run time.
const CHOSEN: bool = cfg!(all(target_arch = "x86_64", not(target_feature = "fma")));

/// The sum a·b + c inside [`compute`].
#[inline(always)]
pub(crate) fn mul_add(a: f64, b: f64, c: f64) -> f64 {
    if FUSED || CHOSEN {
        a.mul_add(b, c)
    } else {
        a * b + c
    }
}

/// What `kernel` makes of `fixed` and `work`, with a fused multiply-add where targets have one;
/// `None`, and nothing is done, where the processor lacks it.
///
/// The kernel and all that it calls has to be `#[inline(always)]`, or it is compiled for any
/// processor. Its arguments are two references and no more, for two are handed over as they are:
/// the compiler then knows that `fixed` does not change while `work` is written. Anything else is
/// read from memory, and of two places there it would know nothing.
#[inline(always)]
pub(crate) fn compute<A, B, R>(
    fixed: &A,
    work: &mut B,
    kernel: impl FnOnce(&A, &mut B) -> R,
) -> Option<R> {
    #[cfg(all(target_arch = "x86_64", not(target_feature = "fma")))]
    {
        use fearless_simd::{Level, Simd};

        let processor = Level::new().as_avx2()?;
        let kernel = processor.vectorize(
            #[inline(always)]
            move || kernel(fixed, work),
        );
        Some(kernel)
    }
    #[cfg(not(all(target_arch = "x86_64", not(target_feature = "fma"))))]
    Some(kernel(fixed, work))
}
