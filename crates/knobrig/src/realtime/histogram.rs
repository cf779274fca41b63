//! Durations, counted in bins that are finer than their spread.

/// Bins of an octave: a bin is 1/16 of its lower edge wide.
const FINE: usize = 16;
const FINE_BITS: u32 = FINE.ilog2();
/// The last bin ends at 2^32 ns, 4.3 s, and takes whatever is longer.
const OCTAVES: usize = 32;
/// How many bins there are.
pub const BINS: usize = (OCTAVES - FINE_BITS as usize + 1) * FINE;

/// Counts of durations over bins that are 1 ns wide up to 16 ns, and 6 % of their lower edge above.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    counts: [u64; BINS],
    count: u64,
    sum: u64,
    min: u64,
    max: u64,
}

impl Default for Histogram {
    fn default() -> Self {
        Self { counts: [0; BINS], count: 0, sum: 0, min: u64::MAX, max: 0 }
    }
}

fn bin(ns: u64) -> usize {
    if ns < FINE as u64 {
        return ns as usize;
    }
    let octave = ns.ilog2() - FINE_BITS;
    let within = (ns >> octave) as usize - FINE;
    (((octave as usize + 1) * FINE) + within).min(BINS - 1)
}

/// Lower edge of a bin, ns; that of the bin after the last is where the last one ends.
fn edge(bin: usize) -> u64 {
    let (octave, within) = (bin / FINE, (bin % FINE) as u64);
    if octave == 0 { within } else { (FINE as u64 + within) << (octave - 1) }
}

impl Histogram {
    /// Counts one duration, ns.
    pub fn add(&mut self, ns: u64) {
        if let Some(count) = self.counts.get_mut(bin(ns)) {
            *count += 1;
        }
        self.count += 1;
        self.sum = self.sum.saturating_add(ns);
        self.min = self.min.min(ns);
        self.max = self.max.max(ns);
    }

    /// How many were counted.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The shortest, ns; exact, 0 where nothing was counted.
    pub fn min(&self) -> u64 {
        self.min.min(self.max)
    }

    /// The longest, ns; exact.
    pub fn max(&self) -> u64 {
        self.max
    }

    /// The mean, ns; exact.
    pub fn mean(&self) -> f64 {
        self.sum as f64 / self.count.max(1) as f64
    }

    /// The duration that this share of all does not exceed, ns, to 3 %: the middle of its bin.
    pub fn quantile(&self, share: f64) -> u64 {
        let rank = (share * self.count as f64).ceil().max(1.0) as u64;
        let mut seen = 0;
        for (bin, &count) in self.counts.iter().enumerate() {
            seen += count;
            if seen >= rank {
                return (edge(bin) + (edge(bin + 1) - 1 - edge(bin)) / 2).clamp(self.min(), self.max);
            }
        }
        self.max
    }

    /// Edges of the bins, ns, one more than there are bins.
    pub fn edges() -> impl Iterator<Item = u64> {
        (0..=BINS).map(edge)
    }

    /// How many fell into each bin.
    pub fn counts(&self) -> &[u64] {
        &self.counts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use knobcore::random::Noise;

    #[test]
    fn every_duration_lies_between_the_edges_of_its_bin() {
        let mut random = Noise::new(1);
        for _ in 0..100_000 {
            let ns = random.bits() >> (32 + random.bits() % 32);
            assert!(edge(bin(ns)) <= ns && ns < edge(bin(ns) + 1), "{ns}");
        }
    }

    #[test]
    fn bins_are_no_wider_than_a_sixteenth() {
        assert_eq!(edge(BINS), 1 << OCTAVES);
        for i in FINE..BINS {
            assert!((edge(i + 1) - edge(i)) * FINE as u64 <= edge(i));
        }
    }

    #[test]
    fn quantiles_are_right_to_three_per_cent_and_the_ends_exact() {
        let mut random = Noise::new(2);
        let mut all: Vec<u64> = (0..10_001).map(|_| (3e4 * (2.0 * random.normal()).exp()) as u64).collect();
        let mut histogram = Histogram::default();
        all.iter().for_each(|&ns| histogram.add(ns));
        all.sort_unstable();
        for share in [0.01, 0.5, 0.99, 0.999] {
            let exact = all[(share * all.len() as f64).ceil() as usize - 1] as f64;
            assert!((histogram.quantile(share) as f64 / exact - 1.0).abs() < 0.032);
        }
        assert_eq!((histogram.min(), histogram.max()), (all[0], all[10_000]));
        let mean = all.iter().sum::<u64>() as f64 / all.len() as f64;
        assert!((histogram.mean() / mean - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_longer_than_the_last_bin_is_counted_in_it() {
        let mut histogram = Histogram::default();
        histogram.add(u64::MAX);
        assert_eq!(histogram.counts()[BINS - 1], 1);
        assert_eq!(histogram.max(), u64::MAX);
    }

    #[test]
    fn an_empty_histogram_is_all_zero() {
        let empty = Histogram::default();
        assert_eq!((empty.min(), empty.max(), empty.quantile(0.5)), (0, 0, 0));
        assert_eq!(empty.mean(), 0.0);
    }
}
