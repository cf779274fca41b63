//! What a run is set up with: the motion and the knob, or the handle and who holds it.

use super::handle::Handle;
use super::rig::{Fixture, Rig};
use super::scene::{Scene, Source, Track, torque};
use crate::wire::{Mode, Point, refusal};
use knobrender::{Device, Limits, Renderer};

impl Rig {
    /// What goes on in a run of this mode; without one a hand turns the knob. The code where that cannot be.
    pub(super) fn scene(&self, mode: Option<(Mode, Limits)>) -> Result<Scene, u16> {
        let rate = self.setup.descriptor.rate_hz;
        let place = self.place;
        let uploaded = || -> Result<Track, u16> {
            let points = self.motion.whole().ok_or(refusal::MISSING)?;
            let column = |of: fn(&Point) -> f64| points.iter().map(of).collect();
            Ok(Track {
                theta: column(|p| p.theta),
                omega: column(|p| p.omega.into()),
                alpha: column(|p| p.alpha.into()),
            })
        };
        let model = || self.model.as_ref().ok_or(refusal::MISSING);
        let held = |source| Scene::Held {
            source,
            handle: Handle::new(self.device(None), 1.0 / rate, place),
            hand: self.setup.hand.clone(),
            place,
            at: 0,
            pushes: 0.0,
        };
        Ok(match mode {
            None => self.moved(self.setup.hand.clone(), true),
            Some((Mode::Drive, _)) => self.moved(uploaded()?, false),
            Some((Mode::RenderDriven, limits)) => {
                let device = self.device(Some(limits));
                Scene::driven(model()?, device, uploaded()?, place, rate).map_err(|_| refusal::MODEL)?
            }
            Some((Mode::Render, limits)) => {
                let device = self.device(Some(limits));
                let knob = Renderer::new(model()?, rate, Some(device), limits).map_err(|_| refusal::MODEL)?;
                held(Source::Model(Box::new(knob)))
            }
            Some((Mode::Commanded, _)) => held(Source::Host(0.0)),
        })
    }

    /// A motion that is imposed on what is in the gripper.
    fn moved(&self, track: Track, again: bool) -> Scene {
        let rate = self.setup.descriptor.rate_hz;
        let (tau, track) = match &self.setup.fixture {
            Fixture::Knob(knob) => (torque(knob, &track, self.place, rate), track),
            Fixture::Free => (vec![0.0; track.len()], track),
            Fixture::Anchor(stiffness) => {
                let still = vec![0.0; track.len()];
                let tau = track.theta.iter().map(|theta| stiffness * theta).collect();
                (tau, Track { theta: still.clone(), omega: still.clone(), alpha: still })
            }
        };
        Scene::Moved { track, tau, place: self.place, again, at: 0 }
    }

    /// The handle as a device to render on.
    fn device(&self, limits: Option<Limits>) -> Device {
        let d = &self.setup.descriptor;
        let [torque, rate] = [d.torque_limit, d.torque_rate_limit].map(f64::from);
        Device {
            inertia: d.inertia.into(),
            damping: d.damping.into(),
            delay: d.delay_samples.into(),
            torque_limit: limits.map_or(torque, |limits| limits.torque.min(torque)),
            torque_rate_limit: limits.map_or(rate, |limits| limits.torque_rate.min(rate)),
            encoder_step: 1.0 / d.counts_per_rad.abs(),
            held: false,
        }
    }
}
