//! The choice of the processor's instructions for Taylor series.
//!
//! A fused multiply-add rounds once, and takes one instruction instead of two. Not every x86-64
//! processor has it, so a build for all of them tests for it at run time. Only [`compute`] makes
//! this test. It computes the series of a slip phase, of many masses and of perturbations, and the
//! search for events and the defect of a structure. These uses give nearly all of the possible
//! gain.
//!
//! | target | in `taylor.rs`, `lanes.rs`, `many.rs`, `PowerSeries::survey` | in all else |
//! |---|---|---|
//! | x86-64 built with `fma`; 64-bit ARM | fused | fused |
//! | x86-64 | fused | two roundings |
//! | others, such as WebAssembly | two roundings | two roundings |
//!
//! In the second row a processor without the instruction expands a slip phase by `jet.rs` instead,
//! with two roundings. A second copy of the unrolled code, with two roundings, would take 14 kB for
//! each law instead of 0.5 kB. Without this copy a whole motion takes up to 1.4 times as long.
//!
//! With AVX-512 the fused code has twice as many registers, which saves 3 to 8 % of the time of a
//! motion on an AMD EPYC. Processors that AVX-512 slows down (those before Intel's Ice Lake, known
//! by `avx512vbmi2`) run without it. Results with and without AVX-512 are the same to the bit.
//!
//! In a build for all x86-64 processors, `f64::mul_add` outside of [`compute`] calls slow library
//! code. The functions and closures of [`compute`] must therefore be inlined into it; `.ci/run`
//! checks this.
//!
//! The only `unsafe` expression of the crate is here: stable Rust has no safe call of a function
//! that needs instructions which a test has just found. A crate that hides the call in a macro
//! takes a tenth of the time in which one mass on a belt is compiled.

use super::FUSED;

/// True if the choice is made at run time.
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

/// The sum a·b + c of code that [`compute`] uses as its kernel (`CHOSEN`) or as its `otherwise`.
#[inline(always)]
pub(crate) fn mul_add_in<const CHOSEN: bool>(a: f64, b: f64, c: f64) -> f64 {
    if CHOSEN {
        mul_add(a, b, c)
    } else {
        super::mul_add(a, b, c)
    }
}

/// The result of `kernel` for `fixed` and `work`, with the instructions of this processor. If the
/// choice is made at run time and the processor has no fused multiply-add, the result of
/// `otherwise`.
///
/// The kernel and all that it calls must be `#[inline(always)]`; otherwise they are compiled for
/// any processor. The kernel gets only two references. Two are passed in registers, so the compiler
/// knows that `fixed` does not change while `work` is written. Further references would be read
/// from memory, and the compiler would not know whether they overlap.
#[inline(always)]
pub(crate) fn compute<A, B, R>(
    fixed: &A,
    work: &mut B,
    kernel: impl FnOnce(&A, &mut B) -> R,
    otherwise: impl FnOnce(&A, &mut B) -> R,
) -> R {
    #[cfg(all(target_arch = "x86_64", not(target_feature = "fma")))]
    return processor::compute(fixed, work, kernel, otherwise);
    #[cfg(not(all(target_arch = "x86_64", not(target_feature = "fma"))))]
    {
        let _ = otherwise;
        kernel(fixed, work)
    }
}

#[cfg(all(target_arch = "x86_64", not(target_feature = "fma")))]
mod processor {
    use std::arch::is_x86_feature_detected as has;
    use std::sync::atomic::{AtomicU8, Ordering::Relaxed};

    /// Instructions that a processor may have; the tests take longer than reading their result.
    const UNKNOWN: u8 = 0;
    const NONE: u8 = 1;
    const AVX2: u8 = 2;
    const AVX512: u8 = 3;
    static KNOWN: AtomicU8 = AtomicU8::new(UNKNOWN);

    #[cold]
    #[inline(never)]
    fn test() -> u8 {
        let has_avx2 = has!("avx2") && has!("bmi1") && has!("bmi2") && has!("fma");
        let has_avx512 = has!("avx512f") && has!("avx512vbmi2");
        let found = match (has_avx2, has_avx512) {
            (false, _) => NONE,
            (true, false) => AVX2,
            (true, true) => AVX512,
        };
        KNOWN.store(found, Relaxed);
        found
    }

    /// The result of [`compute`](super::compute), chosen at run time.
    #[expect(
        unsafe_code,
        reason = "stable Rust calls what a test has just allowed only so"
    )]
    #[inline(always)]
    pub(super) fn compute<A, B, R>(
        fixed: &A,
        work: &mut B,
        kernel: impl FnOnce(&A, &mut B) -> R,
        otherwise: impl FnOnce(&A, &mut B) -> R,
    ) -> R {
        let known = match KNOWN.load(Relaxed) {
            UNKNOWN => test(),
            known => known,
        };
        // SAFETY: the processor has all features that the function called is compiled for.
        match known {
            AVX512 => unsafe { with_avx512(fixed, work, kernel) },
            AVX2 => unsafe { with_avx2(fixed, work, kernel) },
            _ => otherwise(fixed, work),
        }
    }

    #[target_feature(enable = "avx2,bmi1,bmi2,fma")]
    fn with_avx2<A, B, R>(fixed: &A, work: &mut B, kernel: impl FnOnce(&A, &mut B) -> R) -> R {
        kernel(fixed, work)
    }

    #[target_feature(enable = "avx512f,avx2,bmi1,bmi2,fma")]
    fn with_avx512<A, B, R>(fixed: &A, work: &mut B, kernel: impl FnOnce(&A, &mut B) -> R) -> R {
        kernel(fixed, work)
    }
}
