//! Where the jerk is above its usual level, and by how much.

/// Jerk in units of the usual, window by window. Without any window it is the usual jerk everywhere.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Lifts {
    /// A window is 2^`bits` samples.
    bits: u32,
    /// Jerk in each window; 1 is the usual.
    pub windows: Vec<f64>,
}

impl Lifts {
    /// The usual jerk, in windows of 2^`bits` samples that cover `n` samples.
    pub fn usual(n: usize, bits: u32) -> Self {
        Self { bits, windows: vec![1.0; n.div_ceil(1 << bits)] }
    }

    /// Over the step that ends at sample `k`.
    #[inline]
    pub fn at(&self, k: usize) -> f64 {
        self.windows.get(k >> self.bits).copied().unwrap_or(1.0)
    }
}
