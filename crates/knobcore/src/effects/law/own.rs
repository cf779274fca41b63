//! A function of the user's own as a [`Law`]: called at one instant.

use super::Law;
use crate::effects::{Info, Joint, Place, User};
use crate::motion::{Channel, Load, Motion};

impl User {
    /// The channel of its load.
    pub(crate) fn channel(&self) -> Channel {
        self.info.touches.first().copied().unwrap_or(Channel::Drive)
    }

    pub(super) fn loads(&self) -> bool {
        self.info.place == Place::Load
    }
}

impl Law for User {
    fn info(&self) -> &'static Info {
        self.info
    }

    fn remembers(&self) -> bool {
        self.remembers || self.info.place == Place::Coupling
    }

    fn load(&self, p: &[f64], _: &mut [f64], motion: &Motion<f64>, sum: &mut Load<f64>) {
        if self.loads() {
            let own = self.at(p, motion);
            let load = if self.channel() == Channel::FrictionScale {
                Load::friction_scale(own)
            } else {
                Load::drive(own)
            };
            sum.join(&load, Channel::among(self.info.touches));
        }
    }

    fn joint(&self, p: &[f64]) -> Option<Joint<f64>> {
        self.joined(p)
    }
}
