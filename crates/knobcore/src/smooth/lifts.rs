//! Where the jerk is above its usual level, and by how much.

/// Samples in a window.
pub const WINDOW: usize = 8;

/// Jerk in units of the usual, window by window. Without any window it is the usual jerk everywhere.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Lifts {
    /// Jerk in each window; 1 is the usual.
    pub windows: Vec<f64>,
}

impl Lifts {
    /// Over the step that ends at sample `k`.
    #[inline]
    pub fn at(&self, k: usize) -> f64 {
        self.windows.get(k / WINDOW).copied().unwrap_or(1.0)
    }
}
