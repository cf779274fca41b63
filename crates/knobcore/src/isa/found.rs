//! The best that the processor says it has, or what the environment asks for.

use crate::error::{Error, Result};
use pulp::WithSimd;
#[cfg(target_arch = "x86_64")]
use pulp::{
    Simd,
    x86::{V3, V4},
};
use std::sync::OnceLock;

/// The environment variable that names the best instruction set to use: to test, or to compare.
pub const VARIABLE: &str = "KNOBCAM_ISA";
/// Those that work is compiled for, the least first, as they are named; on other processors than x86-64 the first is what
/// the target has.
pub const NAMES: [&str; 3] = ["sse2", "avx2", "avx512"];

#[derive(Debug, Clone, Copy)]
enum Found {
    Baseline,
    #[cfg(target_arch = "x86_64")]
    Avx2(V3),
    #[cfg(target_arch = "x86_64")]
    Avx512(V3, V4),
}

impl Found {
    fn name(self) -> &'static str {
        match self {
            Self::Baseline => NAMES[0],
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(_) => NAMES[1],
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(..) => NAMES[2],
        }
    }

    /// The best of this machine among the first `most`.
    fn among(most: usize) -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = V3::try_new().filter(|_| most > 1) {
            return match V4::try_new().filter(|_| most > 2) {
                Some(avx512) => Self::Avx512(avx2, avx512),
                None => Self::Avx2(avx2),
            };
        }
        let _ = most;
        Self::Baseline
    }

    /// What is used: the best of this machine, or what the environment names if there is that. Read once.
    fn here() -> Self {
        static HERE: OnceLock<Found> = OnceLock::new();
        *HERE.get_or_init(|| {
            let asked = std::env::var(VARIABLE).ok();
            let most = asked.and_then(|name| NAMES.iter().position(|known| *known == name));
            Self::among(most.map_or(NAMES.len(), |at| at + 1))
        })
    }
}

/// The instruction set that is used.
///
/// # Errors
/// The environment names one that does not exist, or that this machine does not have.
pub fn used() -> Result<&'static str> {
    let used = Found::here().name();
    match std::env::var(VARIABLE) {
        Ok(asked) if asked != used => {
            let best = Found::among(NAMES.len()).name();
            let why = format!(
                "is no instruction set of this machine, whose best is {best}; choose {}, or unset it",
                NAMES.join(", ")
            );
            Err(Error::invalid(format!("{VARIABLE}={asked}"), why))
        }
        _ => Ok(used),
    }
}

/// Does work that is compiled for vectors of four numbers (AVX2) and for whatever the target has.
#[inline]
pub fn dispatch<W: WithSimd>(work: W) -> W::Output {
    match Found::here() {
        Found::Baseline => work.with_simd(pulp::Scalar),
        #[cfg(target_arch = "x86_64")]
        Found::Avx2(avx2) | Found::Avx512(avx2, _) => Simd::vectorize(avx2, work),
    }
}

/// Does work that is compiled for vectors of eight numbers (AVX-512) too. That is a third copy to compile: for what is
/// short, and waits for what it has computed last. Where assertions are compiled in, somebody waits for one effect's tests,
/// and there is none.
#[inline]
pub fn dispatch_wide<W: WithSimd>(work: W) -> W::Output {
    match Found::here() {
        #[cfg(all(target_arch = "x86_64", not(debug_assertions)))]
        Found::Avx512(_, avx512) => Simd::vectorize(avx512, work),
        _ => dispatch(work),
    }
}
