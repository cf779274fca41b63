//! What a run is set up with: the motion and the knob, or the handle and who holds it.

use super::handle::Handle;
use super::rig::{Fixture, Rig};
use super::scene::{Scene, Source, Track, torque};
use super::servo::Servo;
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
        let rendered = |device: Device, limits: Limits| -> Result<Renderer, u16> {
            let model = self.model.as_ref().ok_or(refusal::MISSING)?;
            let make = if self.forced { Renderer::forced } else { Renderer::new };
            make(model, rate, Some(device), limits).map_err(|_| refusal::MODEL)
        };
        let held = |source| Scene::Held {
            source,
            handle: Handle::new(self.device(None), 1.0 / rate, place),
            hand: self.setup.hand.clone(),
            place,
            at: 0,
            pushes: 0.0,
        };
        Ok(match mode {
            None => self.moved(self.setup.hand.clone(), None),
            Some((Mode::Drive, limits)) => self.moved(uploaded()?, Some(limits)),
            Some((Mode::RenderDriven, limits)) => {
                let device = Device { held: true, delay: 0, ..self.device(Some(limits)) };
                let knob = rendered(device, limits)?;
                Scene::Driven { track: uploaded()?, place, at: 0, knob: Box::new(knob), device }
            }
            Some((Mode::Render, limits)) => {
                held(Source::Model(Box::new(rendered(self.device(Some(limits)), limits)?)))
            }
            Some((Mode::Commanded, limits)) => {
                held(Source::Host { wanted: 0.0, given: 0.0, limits, dt: 1.0 / rate })
            }
        })
    }

    /// A motion that moves what is in the gripper: by a hand, again and again, or by the motor within its limits.
    fn moved(&self, track: Track, limits: Option<Limits>) -> Scene {
        let rate = self.setup.descriptor.rate_hz;
        let own = f64::from(self.setup.descriptor.inertia);
        let (tau, track, inertia) = match &self.setup.fixture {
            Fixture::Knob(knob) => {
                let inertia = knob.inertia().map_or(0.0, |at| knob.values()[at].max(0.0));
                (torque(knob, &track, self.place, rate), track, own + inertia)
            }
            Fixture::Free => (vec![0.0; track.len()], track, own),
            Fixture::Anchor(stiffness) => {
                let still = vec![0.0; track.len()];
                let tau = track.theta.iter().map(|theta| stiffness * theta).collect();
                // What is anchored does not stay behind, however weak the motor.
                (tau, Track { theta: still.clone(), omega: still.clone(), alpha: still }, f64::INFINITY)
            }
        };
        let motor = limits.map(|limits| Servo::new(limits, inertia, 1.0 / rate));
        Scene::Moved { track, tau, place: self.place, at: 0, motor }
    }

    /// The handle as a device to render on.
    pub(super) fn device(&self, limits: Option<Limits>) -> Device {
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
