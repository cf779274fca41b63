//! Elementary functions without branches, so that a loop over lanes becomes vector instructions.
//!
//! One formula serves `f64` and `Pack`, so that a render step and a fit agree to the last bit. No fused
//! multiply-add: its rounding would differ between machines that have it and machines that do not.
#![expect(clippy::excessive_precision, reason = "constants keep the digits that their sources print")]

use core::f64::consts::FRAC_2_PI;

/// pi/2 in three parts, the first two with trailing zero bits, so that `k` times each is exact for
/// |k| < 2^20 (Cody & Waite 1980, "Software Manual for the Elementary Functions").
const PIO2: [f64; 3] =
    [1.570_796_326_734_125_614_17, 6.077_100_506_303_965_976_60e-11, 2.022_266_248_795_950_631_54e-21];

/// Adding and taking away 1.5 * 2^52 rounds to the nearest integer, which is then in the low bits.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// (sin x, cos x). Minimax polynomials of fdlibm (Sun Microsystems 1993) on [-pi/4, pi/4].
#[inline(always)]
pub fn sin_cos(x: f64) -> (f64, f64) {
    let shifted = x * FRAC_2_PI + ROUND;
    let k = shifted - ROUND;
    let quadrant = shifted.to_bits();
    let r = ((x - k * PIO2[0]) - k * PIO2[1]) - k * PIO2[2];
    let z = r * r;
    let sin = r + r
        * z
        * (-1.666_666_666_666_663_24e-1
            + z * (8.333_333_333_322_489_46e-3
                + z * (-1.984_126_982_985_794_93e-4
                    + z * (2.755_731_370_707_006_77e-6
                        + z * (-2.505_076_025_340_686_34e-8 + z * 1.589_690_995_211_550_10e-10)))));
    let cos = 1.0 - 0.5 * z
        + z * z
            * (4.166_666_666_666_660_19e-2
                + z * (-1.388_888_888_887_410_96e-3
                    + z * (2.480_158_728_947_672_94e-5
                        + z * (-2.755_731_435_139_066_33e-7
                            + z * (2.087_572_321_298_174_83e-9 + z * -1.135_964_755_778_819_48e-11)))));
    let swap = quadrant & 1 == 1;
    let (s, c) = (if swap { cos } else { sin }, if swap { sin } else { cos });
    // Bit 1 of the quadrant flips the sine, bit 1 of (quadrant + 1) the cosine.
    let s = f64::from_bits(s.to_bits() ^ ((quadrant & 2) << 62));
    let c = f64::from_bits(c.to_bits() ^ ((quadrant.wrapping_add(1) & 2) << 62));
    (s, c)
}

/// ln 2 in two parts, the first with trailing zero bits, so that `k` times it is exact.
const LN2: [f64; 2] = [6.931_471_803_691_238_164_90e-1, 1.908_214_929_270_587_700_02e-10];
/// Beyond this e^x leaves the range of normal numbers.
const MOST: f64 = 700.0;

/// e^x. The rational approximation of fdlibm (Sun Microsystems 1993) on [-ln 2 / 2, ln 2 / 2].
#[inline(always)]
pub fn exp(x: f64) -> f64 {
    let x = if x > MOST { MOST } else { x };
    let x = if x < -MOST { -MOST } else { x };
    let shifted = x * core::f64::consts::LOG2_E + ROUND;
    let k = shifted - ROUND;
    let (high, low) = (x - k * LN2[0], k * LN2[1]);
    let r = high - low;
    let z = r * r;
    let c = r - z
        * (1.666_666_666_666_660_190_37e-1
            + z * (-2.777_777_777_701_559_338_42e-3
                + z * (6.613_756_321_437_934_361_17e-5
                    + z * (-1.653_390_220_546_525_153_90e-6 + z * 4.138_136_797_057_238_460_39e-8))));
    let y = 1.0 - ((low - (r * c) / (2.0 - c)) - high);
    // k sits in the low bits of `shifted`; two to the k is that number as an exponent.
    y * f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52)
}

/// ln x of a positive normal number. The polynomial of fdlibm on [sqrt(1/2), sqrt 2].
#[inline(always)]
pub fn ln(x: f64) -> f64 {
    /// High word of sqrt(1/2): subtracting it splits x at the powers of two times sqrt 2.
    const ROOT: u64 = 0x3fe6_a09e_0000_0000;
    const TWO52: f64 = 4_503_599_627_370_496.0;
    let bits = x.to_bits().wrapping_add(0x3ff0_0000_0000_0000 - ROOT);
    let k = f64::from_bits((bits >> 52) | TWO52.to_bits()) - TWO52 - 1023.0;
    let f = f64::from_bits((bits & 0x000f_ffff_ffff_ffff).wrapping_add(ROOT)) - 1.0;
    let s = f / (2.0 + f);
    let (z, half) = (s * s, 0.5 * f * f);
    let r = z
        * (6.666_666_666_666_735_130e-1
            + z * (3.999_999_999_940_941_908e-1
                + z * (2.857_142_874_366_239_149e-1
                    + z * (2.222_219_843_214_978_396e-1
                        + z * (1.818_357_216_161_805_012e-1
                            + z * (1.531_383_769_920_937_332e-1 + z * 1.479_819_860_511_658_591e-1))))));
    k * LN2[0] - ((half - (s * (half + r) + k * LN2[1])) - f)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponential_and_logarithm_agree_with_the_platform_to_two_units_in_the_last_place() {
        for i in -60_000..60_000_i32 {
            let x = f64::from(i) * 0.011_3 + 1e-7;
            let e = exp(x);
            assert!((e / x.exp() - 1.0).abs() < 5e-16, "{x}: {e}");
            assert!((ln(e) - e.ln()).abs() <= 5e-16 * e.ln().abs().max(1.0), "{x}: {}", ln(e));
        }
        assert_eq!((exp(0.0), ln(1.0), exp(-1e9) < 1e-300), (1.0, 0.0, true));
    }

    #[test]
    fn sine_and_cosine_agree_with_the_platform_to_two_units_in_the_last_place() {
        for i in -200_000..200_000_i32 {
            let x = f64::from(i) * 0.003_7 + 1e-9;
            let (s, c) = sin_cos(x);
            assert!((s - x.sin()).abs() < 3e-16 && (c - x.cos()).abs() < 3e-16, "{x}: {s} {c}");
        }
    }

    #[test]
    fn large_angles_lose_no_more_than_their_own_rounding() {
        for i in 1..1000_i32 {
            let x = f64::from(i) * 997.3;
            assert!((sin_cos(x).0 - x.sin()).abs() < 1e-15 * (1.0 + x.abs() * 1e-3));
        }
    }
}
