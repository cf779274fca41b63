//! A knob as simulators have it: a unit of FMI for co-simulation, whichever version of its functions it is called by.
//!
//! The library is the same for every model: the text of the model is a resource of the unit, below a line that has its
//! rate.

use knobrender::{Renderer, Sensed};
use std::ffi::{CStr, c_char, c_int, c_void};
use std::path::{Path, PathBuf};

/// Share of a step by which a communication step may differ from a whole number of them.
const WHOLE: f64 = 1e-6;
/// The file of the unit that has its rate and its model.
const RESOURCE: &str = "knob.txt";
/// Real variables by their reference: angle, speed, acceleration, torque of the hand; the torque comes last.
pub const INPUTS: usize = 4;
/// Boolean variables: whether the torque of the hand is measured, and whether the motion is imposed.
pub const CHOICES: usize = 2;

/// What a function of any version answers.
pub const OK: c_int = 0;
pub const ERROR: c_int = 3;

/// What a simulator hands over, of which nothing is asked here.
pub type Any = *mut c_void;

pub fn answer(done: bool) -> c_int {
    if done { OK } else { ERROR }
}

/// One knob in a simulator.
#[derive(Debug)]
pub struct Slave {
    /// On a free handle, and on one whose motion is imposed.
    knobs: [Renderer; 2],
    pub inputs: [f64; INPUTS],
    pub choices: [bool; CHOICES],
    tau: f64,
    /// Time as the simulator has it, s.
    pub now: f64,
}

impl Slave {
    /// A knob of the resource's text: its rate on the first line, its model below.
    fn new(resource: &str) -> Result<Self, String> {
        let (rate, model) = resource.split_once('\n').unwrap_or((resource, ""));
        let rate =
            rate.trim().parse::<f64>().map_err(|_| format!("{RESOURCE}: no rate on its first line"))?;
        let knob = |held| super::renderer(model, rate, held).map_err(|error| format!("{RESOURCE}: {error}"));
        let knobs = [knob(false)?, knob(true)?];
        Ok(Self { knobs, inputs: [0.0; INPUTS], choices: [false; CHOICES], tau: 0.0, now: 0.0 })
    }

    /// The knob of a unit whose resources lie in a folder.
    pub fn of_resources(folder: &Path) -> Result<Self, String> {
        let path = folder.join(RESOURCE);
        let text = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        Self::new(&text)
    }

    /// Forgets everything.
    pub fn reset(&mut self) {
        self.knobs.iter_mut().for_each(Renderer::reset);
        (self.inputs, self.choices, self.tau, self.now) = ([0.0; INPUTS], [false; CHOICES], 0.0, 0.0);
    }

    /// One communication step from a time on: as many of the knob's as fit, the motion that of its end.
    pub fn advance(&mut self, from: f64, duration: f64) -> bool {
        let ([free, held], [measured, imposed]) = (&mut self.knobs, self.choices);
        let knob = if imposed { held } else { free };
        let steps = duration * knob.rate_hz();
        let whole = steps.round();
        let fits = whole >= 1.0 && (steps - whole).abs() <= WHOLE * whole;
        if !fits {
            return false;
        }
        let [theta, omega, alpha, hand] = self.inputs;
        knob.missed(whole as u64 - 1);
        self.tau = knob.step(Sensed { theta, omega, alpha, hand: measured.then_some(hand) });
        self.now = from + duration;
        knob.fault().is_none()
    }

    /// A real variable by its reference.
    pub fn real(&self, reference: usize) -> Option<f64> {
        if reference == INPUTS { Some(self.tau) } else { self.inputs.get(reference).copied() }
    }
}

/// The path that a `file:` address leads to.
pub fn addressed(folder: &str) -> PathBuf {
    let path = folder.strip_prefix("file://").or(folder.strip_prefix("file:")).unwrap_or(folder);
    let (mut bytes, mut rest) = (Vec::new(), path.as_bytes());
    while let [first, others @ ..] = rest {
        let code = others.get(..2).and_then(|hex| std::str::from_utf8(hex).ok());
        let escaped = code.filter(|_| *first == b'%').and_then(|hex| u8::from_str_radix(hex, 16).ok());
        bytes.push(escaped.unwrap_or(*first));
        rest = if escaped.is_some() { &others[2..] } else { others };
    }
    PathBuf::from(String::from_utf8_lossy(&bytes).into_owned())
}

/// # Safety
/// `text` is null or ended by a zero.
pub unsafe fn read<'a>(text: *const c_char) -> &'a str {
    if text.is_null() {
        return "";
    }
    // SAFETY: as the caller vouches.
    unsafe { CStr::from_ptr(text) }.to_str().unwrap_or("")
}

/// Gives a knob's memory back.
///
/// # Safety
/// `slave` is null or made as a box by this library, and is not used again.
pub unsafe fn free(slave: *mut Slave) {
    if !slave.is_null() {
        // SAFETY: it was made so, and the caller gives it away.
        drop(unsafe { Box::from_raw(slave) });
    }
}

/// Does something with every variable of a call, given by its reference and its place; whether it has them all.
///
/// # Safety
/// `slave` is null or of this library; `references` has `count` elements.
pub unsafe fn each(
    slave: *mut Slave,
    references: *const u32,
    count: usize,
    mut variable: impl FnMut(&mut Slave, usize, usize) -> Option<()>,
) -> bool {
    // SAFETY: as the caller vouches.
    let Some(slave) = (unsafe { slave.as_mut() }) else { return false };
    (0..count).all(|at| {
        // SAFETY: as the caller vouches.
        let reference = unsafe { *references.add(at) };
        variable(slave, reference as usize, at).is_some()
    })
}

/// Functions that have nothing to do here, and those that are not offered.
macro_rules! answers {
    ($($answer:expr => $type:ty: $($name:ident($($argument:ty),*))*;)*) => {$($(
        /// Of FMI; it has nothing to do here, or is not offered.
        #[unsafe(no_mangle)]
        pub extern "C" fn $name($(_: $argument),*) -> $type {
            $answer
        }
    )*)*};
}
pub(crate) use answers;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_resource_is_found_by_its_address_whatever_it_is_escaped_by() {
        for (address, path) in [
            ("file:///tmp/a%20b/resources", "/tmp/a b/resources"),
            ("file:/tmp/100%/resources", "/tmp/100%/resources"),
            ("/tmp/resources", "/tmp/resources"),
        ] {
            assert_eq!(addressed(address), PathBuf::from(path));
        }
    }

    #[test]
    fn a_communication_step_is_a_whole_number_of_the_knobs() {
        assert!(Slave::new(&crate::tests::text()).is_err(), "it has no rate");
        let text = format!("5000\n{}", crate::tests::text());
        let mut slave = Slave::new(&text).unwrap();
        slave.inputs = [0.1, 2.0, 10.0, 0.0];
        assert!(slave.advance(0.0, 2e-4) && slave.advance(2e-4, 1e-3));
        assert!((slave.now - 1.2e-3).abs() < 1e-15);
        assert!(!slave.advance(slave.now, 3e-4) && !slave.advance(slave.now, 0.0));
        assert!(!slave.advance(slave.now, f64::NAN));
        assert!(slave.tau > 0.0 && slave.real(INPUTS) == Some(slave.tau) && slave.real(5).is_none());
        slave.reset();
        assert_eq!((slave.now, slave.tau), (0.0, 0.0));
    }
}
