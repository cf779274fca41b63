//! A block of samples in which loads come together, channel by channel, and in which friction is then spent.

use super::gradient::Gradient;
use crate::effects::LoadEffect;
use crate::isa;
use crate::motion::{Channel, Load, Motion, Touched};
use crate::scalar::{Dual, Known, LANES, Pack, Packed, Scalar, WIDE, Wide};
use pulp::NullaryFnOnce;
use std::ops::Range;

/// Samples that are evaluated at a time: their channels stay in the first cache.
pub(crate) const BLOCK: usize = 256;
/// Channels of a load that a moving knob feels: drive, inertia, dry friction backward and forward; normal load, load
/// by position, friction scale, friction per load, shares of position and of inertia in the load, hysteresis.
pub(crate) const CHANNELS: usize = Channel::Stick as usize;
/// The first of them, which suffice where nothing shapes the friction.
pub(crate) const PLAIN: usize = Channel::NormalLoad as usize;
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
        load.normal_load,
        load.position_load,
        load.friction_scale,
        load.mu,
        load.position_share,
        load.inertia_share,
        load.hysteresis,
    ]
}

#[inline(always)]
pub(crate) fn load_of<T: Scalar>(
    [
        drive,
        inertia,
        back,
        forth,
        normal_load,
        position_load,
        friction_scale,
        mu,
        position_share,
        inertia_share,
        hysteresis,
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

/// The loads over a block, coming together.
pub struct Totals<'a> {
    pub(super) whole: [&'a [f64]; 5],
    pub(super) motion: [&'a [f64]; 5],
    pub(super) block: Range<usize>,
    pub(super) channels: &'a mut Channels,
    pub(super) plain: bool,
}

impl<'a> Totals<'a> {
    /// An empty block of a motion; `plain` where no effect shapes the friction of others.
    pub(crate) fn new(
        whole: [&'a [f64]; 5],
        block: Range<usize>,
        plain: bool,
        channels: &'a mut Channels,
    ) -> Self {
        for (channel, column) in channels.iter_mut().enumerate().take(if plain { PLAIN } else { CHANNELS }) {
            column.fill(if channel == SCALE { 1.0 } else { 0.0 });
        }
        if plain {
            channels[SCALE].fill(1.0);
        }
        let motion = whole.map(|column| &column[block.clone()]);
        Self { whole, motion, block, channels, plain }
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
        let own = channels(load);
        for (channel, (column, own)) in self.channels.iter_mut().zip(own).take(C).enumerate() {
            if !touches[channel] {
                continue;
            }
            let before = Packed::load(column, at);
            (if channel == SCALE { before * own } else { before + own }).store(column, at);
        }
    }

    #[inline(always)]
    pub(super) fn motion<const L: usize>(&self, at: usize) -> Motion<Packed<L>> {
        Motion::over(&self.motion, at)
    }

    #[inline(always)]
    pub(super) fn add<const N: usize, E: LoadEffect<N>>(&mut self, p: &[f64]) {
        let p: [Wide; N] = std::array::from_fn(|i| Wide::of(p.get(i).copied().unwrap_or(0.0)));
        for at in (0..self.block.len()).step_by(WIDE) {
            let load = E::load(&p, &self.motion(at));
            self.join(at, &load, const { Channel::among(E::TOUCHES) });
        }
    }

    /// Brings in what was worked out for the whole motion at once, into one channel.
    pub(super) fn add_column(&mut self, channel: Channel, column: &[f64]) {
        for (total, own) in self.channels[channel as usize].iter_mut().zip(&column[self.block.clone()]) {
            *total = if channel == Channel::FrictionScale { *total * own } else { *total + own };
        }
    }

    /// Spends the friction budget: the torque over the block, and its gradient to each channel.
    pub(crate) fn spend<'b>(
        self,
        torque: &mut [f64],
        slopes: &'b mut [Vec<f64>],
        by: &'b mut Channels,
    ) -> Gradient<'b>
    where
        'a: 'b,
    {
        let torque = &mut torque[self.block.clone()];
        isa::dispatch(Spent { totals: &self, torque, by: (!slopes.is_empty()).then_some(&mut *by) });
        Gradient { totals: self, by, slopes }
    }
}

/// The spending as a value, so that its body is compiled for the machine's instruction set.
struct Spent<'a, 'b> {
    totals: &'a Totals<'b>,
    torque: &'a mut [f64],
    by: Option<&'a mut Channels>,
}

impl NullaryFnOnce for Spent<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { totals, torque, mut by } = self;
        for at in (0..totals.block.len()).step_by(LANES) {
            let mut packs = [Pack::of(0.0); CHANNELS];
            for (pack, channel) in packs.iter_mut().zip(&*totals.channels) {
                *pack = Pack::load(channel, at);
            }
            let motion = totals.motion(at);
            match &mut by {
                None => load_of(packs).sliding(&motion).store(torque, at),
                Some(by) if totals.plain => spend_by::<PLAIN>(packs, &motion, torque, by, at),
                Some(by) => spend_by::<CHANNELS>(packs, &motion, torque, by, at),
            }
        }
    }
}

#[inline(always)]
fn spend_by<const C: usize>(
    packs: [Pack; CHANNELS],
    motion: &Motion<Pack>,
    torque: &mut [f64],
    by: &mut Channels,
    at: usize,
) {
    let seeds: [Dual<Known<Pack>, C>; CHANNELS] = Dual::seeds(packs.map(Known::any), 0);
    let tau = load_of(seeds).sliding(&motion.map(|x| Dual::constant(Known::any(x))));
    tau.v.x.store(torque, at);
    for (column, slope) in by.iter_mut().zip(tau.slopes(|slope| slope.x)) {
        slope.store(column, at);
    }
}
