//! A block of samples in which loads come together, channel by channel, and in which friction is then spent.

use crate::effects::LoadEffect;
use crate::motion::{Channel, Load, Motion, Touched};
use crate::scalar::{Packed, Scalar, WIDE, Wide};
use core::ops::Range;

/// Samples that are evaluated at a time: their channels stay in the first cache.
pub(crate) const BLOCK: usize = 256;
/// Channels of a load that a moving knob feels: drive, inertia, dry friction backward and forward; friction scale,
/// hysteresis; normal load, load by position, friction per load, shares of position and of inertia in the load.
pub(crate) const CHANNELS: usize = Channel::Stick as usize;
/// The first of them, which suffice where nothing shapes the friction.
pub(crate) const PLAIN: usize = Channel::FrictionScale as usize;
/// Those that suffice where no friction grows with a load.
pub(super) const SHAPED: usize = Channel::NormalLoad as usize;
/// The channel that multiplies.
pub(crate) const SCALE: usize = Channel::FrictionScale as usize;

#[inline(always)]
pub(super) fn channels<T: Scalar>(load: &Load<T>) -> [T; CHANNELS] {
    let [back, forth] = load.resist;
    [
        load.drive,
        load.inertia,
        back,
        forth,
        load.friction_scale,
        load.hysteresis,
        load.normal_load,
        load.position_load,
        load.mu,
        load.position_share,
        load.inertia_share,
    ]
}

#[inline(always)]
pub(crate) fn load_of<T: Scalar>(
    [
        drive,
        inertia,
        back,
        forth,
        friction_scale,
        hysteresis,
        normal_load,
        position_load,
        mu,
        position_share,
        inertia_share,
    ]: [T; CHANNELS],
) -> Load<T> {
    Load {
        drive,
        inertia,
        resist: [back, forth],
        normal_load,
        position_load,
        friction_scale,
        mu,
        position_share,
        inertia_share,
        hysteresis,
        ..Load::none()
    }
}

/// A block of every channel.
pub(crate) type Channels = [[f64; BLOCK]; CHANNELS];
/// A block of every column of a motion.
pub(crate) type Motions = [[f64; BLOCK]; 5];

/// What a motion is worked out in, block by block.
// Vectors of eight that lie across two lines of the cache take twice as long.
#[derive(Debug)]
#[repr(align(64))]
pub(crate) struct Scratch {
    /// The loads, channel by channel.
    pub channels: Channels,
    /// What friction makes of them: derivatives by the channels, and by an effect's own parameters.
    pub spent: [Channels; 2],
    /// The last block of a motion, filled up.
    pub end: Motions,
}

impl Default for Scratch {
    fn default() -> Self {
        let channels = [[0.0; BLOCK]; CHANNELS];
        Self { channels, spent: [channels; 2], end: [[0.0; BLOCK]; 5] }
    }
}

/// Columns over a block, filled up with their last sample so that they are packs side by side.
pub(crate) fn filled<'a>(columns: [&'a [f64]; 5], end: &'a mut Motions) -> [&'a [f64]; 5] {
    if columns[0].len() == BLOCK {
        return columns;
    }
    for (end, column) in end.iter_mut().zip(columns) {
        let (own, rest) = end.split_at_mut(column.len());
        own.copy_from_slice(column);
        rest.fill(column.last().copied().unwrap_or(0.0));
    }
    core::array::from_fn(|i| end[i].as_slice())
}

/// The loads over a block, coming together.
pub struct Totals<'a> {
    pub(super) whole: [&'a [f64]; 5],
    /// Packs side by side.
    pub(super) motion: [&'a [f64]; 5],
    pub(super) block: Range<usize>,
    pub(super) channels: &'a mut Channels,
    pub(super) plain: bool,
    /// Whether friction may grow with a load.
    pub(super) by_load: bool,
}

impl<'a> Totals<'a> {
    /// An empty block of a motion; `plain` where no effect shapes the friction of others.
    pub(crate) fn new(
        whole: [&'a [f64]; 5],
        block: Range<usize>,
        plain: bool,
        channels: &'a mut Channels,
        end: &'a mut Motions,
    ) -> Self {
        for (channel, column) in channels.iter_mut().enumerate().take(if plain { PLAIN } else { CHANNELS }) {
            column.fill(if channel == SCALE { 1.0 } else { 0.0 });
        }
        if plain {
            channels[SCALE].fill(1.0);
        }
        let motion = filled(whole.map(|column| &column[block.clone()]), end);
        Self { whole, motion, block, channels, plain, by_load: false }
    }

    #[inline(always)]
    pub(super) fn join<const L: usize>(&mut self, at: usize, load: &Load<Packed<L>>, touches: Touched) {
        if self.plain {
            self.joined::<PLAIN, L>(at, load, touches)
        } else {
            self.joined::<CHANNELS, L>(at, load, touches)
        }
    }

    #[inline(always)]
    fn joined<const C: usize, const L: usize>(
        &mut self,
        at: usize,
        load: &Load<Packed<L>>,
        touches: Touched,
    ) {
        self.by_load |= touches[Channel::Mu as usize];
        let own = channels(load);
        for (channel, (column, own)) in self.channels.iter_mut().zip(own).take(C).enumerate() {
            if !touches[channel] {
                continue;
            }
            let before = Packed::of_packs(column, at);
            (if channel == SCALE { before * own } else { before + own }).into_packs(column, at);
        }
    }

    #[inline(always)]
    pub(super) fn motion<const L: usize>(&self, at: usize) -> Motion<Packed<L>> {
        Motion::over(&self.motion, at)
    }

    #[inline(always)]
    pub(super) fn add<const N: usize, E: LoadEffect<N>>(&mut self, p: &[f64]) {
        let p: [Wide; N] = core::array::from_fn(|i| Wide::of(p.get(i).copied().unwrap_or(0.0)));
        for at in (0..self.block.len()).step_by(WIDE) {
            let load = E::load(&p, &self.motion(at));
            self.join(at, &load, const { Channel::among(E::TOUCHES) });
        }
    }

    /// Brings in what was worked out for the whole motion at once, into one channel.
    pub(super) fn add_column(&mut self, channel: Channel, column: &[f64]) {
        self.by_load |= channel == Channel::Mu;
        for (total, own) in self.channels[channel as usize].iter_mut().zip(&column[self.block.clone()]) {
            *total = if channel == Channel::FrictionScale { *total * own } else { *total + own };
        }
    }

    /// Brings in what was worked out for the block, into one channel.
    pub(super) fn add_block(&mut self, channel: Channel, own: &[f64; BLOCK]) {
        self.by_load |= channel == Channel::Mu;
        for (total, own) in self.channels[channel as usize].iter_mut().zip(own) {
            *total = if channel == Channel::FrictionScale { *total * own } else { *total + own };
        }
    }
}
