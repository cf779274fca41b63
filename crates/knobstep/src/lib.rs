//! The render step for those who call it from C: a model's text goes in, and then, sample by sample, motion.
//!
//! Bindings: they convert, delegate and convert. The step itself is [`knobrender::Renderer::step`], so that what runs in
//! a firmware or a simulator is what runs here, to the last bit. Only `knobcam_new` takes memory; no step does.
#![cfg_attr(not(feature = "std"), no_std)]
#![allow(unsafe_code, reason = "a C ABI takes pointers, whose validity only its caller can know")]

#[cfg(not(feature = "std"))]
mod bare;
#[cfg(feature = "std")]
pub mod fmi2;
#[cfg(feature = "std")]
pub mod fmi3;
#[cfg(feature = "std")]
mod slave;

use core::ffi::{CStr, c_char, c_int, c_void};
use knobcore::error::Result;
use knobcore::model_file;
use knobcore::prelude::*;
use knobrender::{Device, Fault, Limits, Renderer, Sensed};

/// Speed that no handle reaches, rad/s, as of `knobcam.Renderer`: faster motion is a broken sensor.
const FASTEST: f64 = 1000.0;

/// A handle that adds nothing to what is rendered and whose motion is imposed.
const IMPOSED: Device = Device {
    inertia: 1e-15,
    damping: 0.0,
    delay: 0,
    torque_limit: f64::INFINITY,
    torque_rate_limit: f64::INFINITY,
    encoder_step: 0.0,
    held: true,
};

/// A renderer of the model in a text, as `knobcam.Renderer` makes it; `held` where a rig or a simulation imposes the
/// motion, so that friction turns round as sharply as the motion does. On a free handle it would ring.
///
/// # Errors
/// A text that is no model, a rate that is none, a model that would feed a hand.
pub fn renderer(text: &str, rate_hz: f64, held: bool) -> Result<Renderer> {
    let limits = Limits { torque: f64::INFINITY, torque_rate: f64::INFINITY, speed: FASTEST };
    Renderer::new(&model_file::parse(text)?, rate_hz, held.then_some(IMPOSED), limits)
}

/// Bytes that it takes at most to make a knob of a model, whatever it says; for each character of its text, for each table
/// in braces, and for each law that is written in it. What 26 models took on 64 bits, where it is most, was 0.65 to 0.85 of it.
const NEEDS: [usize; 4] = [6144, 20, 2560, 8192];
/// Of these for the books of what is taken and what is left.
const BOOKS: usize = 2048;

fn needs(text: &str) -> usize {
    let laws = text.lines().filter(|line| line.trim_start().starts_with("law")).count();
    NEEDS[0] + NEEDS[1] * text.len() + NEEDS[2] * text.matches('{').count() + NEEDS[3] * laws
}

/// The text of a caller, or what it is not.
///
/// # Safety
/// `model` is null or a text that a zero ends.
unsafe fn told<'a>(model: *const c_char) -> core::result::Result<&'a str, &'static str> {
    if model.is_null() {
        return Err("model: is none; give the text of a model file");
    }
    // SAFETY: the caller vouches for the zero at its end.
    unsafe { CStr::from_ptr(model) }.to_str().map_err(|_| "model: is no UTF-8 text")
}

/// Bytes that are left; of an operating system as many as anybody wants.
fn left() -> usize {
    #[cfg(feature = "std")]
    let left = usize::MAX;
    #[cfg(not(feature = "std"))]
    let left = bare::left();
    left
}

/// Said without any memory.
const TOO_LITTLE: &str =
    "memory: too little is left for this model; give as much as knobcam_needs says by knobcam_memory";

/// Writes a text into the room of a caller, ended by a zero and cut where it is too long.
///
/// # Safety
/// `to` is null or has `room` bytes.
unsafe fn tell(text: &str, to: *mut c_char, room: usize) {
    if to.is_null() || room == 0 {
        return;
    }
    let bytes = text.as_bytes();
    let kept = bytes.len().min(room - 1);
    // SAFETY: the caller vouches for `room` bytes, of which at most that many are written.
    unsafe {
        core::ptr::copy_nonoverlapping(bytes.as_ptr().cast::<c_char>(), to, kept);
        *to.add(kept) = 0;
    }
}

/// Memory that knobs are made in, the program's for as long as it runs: what this library has where there is no operating
/// system, to be given before the first knob. Several are shared out together. Of an operating system it takes memory itself.
///
/// # Safety
/// `memory` has `bytes` bytes, which nobody else uses from now on.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn knobcam_memory(memory: *mut c_void, bytes: usize) {
    #[cfg(not(feature = "std"))]
    // SAFETY: as the caller vouches.
    unsafe {
        bare::take(memory, bytes);
    }
    #[cfg(feature = "std")]
    let _ = (memory, bytes);
}

/// Bytes of memory with which a knob of the model in a text can be made; 0 of what is no text.
///
/// # Safety
/// `model` is null or a text that a zero ends.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn knobcam_needs(model: *const c_char) -> usize {
    // SAFETY: as the caller vouches.
    unsafe { told(model) }.map_or(0, needs)
}

/// Makes a knob of the model in a text at `rate_hz`; `held` is 0 on a handle that a hand turns or a simulation moves by
/// the torque, 1 where the motion is imposed. Null where that cannot be, and `why` (of `room` bytes) then says so.
///
/// # Safety
/// `model` is a text that a zero ends; `why` is null or has `room` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn knobcam_new(
    model: *const c_char,
    rate_hz: f64,
    held: c_int,
    why: *mut c_char,
    room: usize,
) -> *mut Renderer {
    // SAFETY: as the caller vouches.
    let text = unsafe { told(model) }
        .and_then(|text| if left() < needs(text) - BOOKS { Err(TOO_LITTLE) } else { Ok(text) });
    let refused = match text.map(|text| renderer(text, rate_hz, held != 0)) {
        Ok(Ok(knob)) => return Box::into_raw(Box::new(knob)),
        Ok(Err(error)) => &*error.to_string(),
        Err(why) => why,
    };
    // SAFETY: as the caller vouches.
    unsafe { tell(refused, why, room) };
    core::ptr::null_mut()
}

/// The torque of the model, N m: what a hand has to apply; the motor applies its negative. Angle rad, speed rad/s,
/// acceleration rad/s^2; call it once a sample. Without a knob it is zero.
///
/// # Safety
/// `knob` is null or of `knobcam_new`, and nobody else's at the time.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn knobcam_step(knob: *mut Renderer, theta: f64, omega: f64, alpha: f64) -> f64 {
    // SAFETY: as the caller vouches.
    let knob = unsafe { knob.as_mut() };
    knob.map_or(0.0, |knob| knob.step(Sensed { theta, omega, alpha, hand: None }))
}

/// The same where the torque that the hand applies is measured, N m.
///
/// # Safety
/// As for `knobcam_step`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn knobcam_step_beside(
    knob: *mut Renderer,
    theta: f64,
    omega: f64,
    alpha: f64,
    tau_other: f64,
) -> f64 {
    // SAFETY: as the caller vouches.
    let knob = unsafe { knob.as_mut() };
    knob.map_or(0.0, |knob| knob.step(Sensed { theta, omega, alpha, hand: Some(tau_other) }))
}

/// Forgets everything, faults too.
///
/// # Safety
/// As for `knobcam_step`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn knobcam_reset(knob: *mut Renderer) {
    // SAFETY: as the caller vouches.
    if let Some(knob) = unsafe { knob.as_mut() } {
        knob.reset();
    }
}

/// Why the knob renders nothing any more: 0 it does; 1 not finite, 2 a jump, 3 its torque, 4 energy; -1 it is null.
///
/// # Safety
/// As for `knobcam_step`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn knobcam_fault(knob: *const Renderer) -> c_int {
    // SAFETY: as the caller vouches.
    let Some(knob) = (unsafe { knob.as_ref() }) else { return -1 };
    let Some(fault) = knob.fault() else { return 0 };
    Fault::ALL.iter().position(|one| *one == fault).map_or(0, |at| at as c_int + 1)
}

/// Gives the knob's memory back.
///
/// # Safety
/// `knob` is null or of `knobcam_new`, and is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn knobcam_free(knob: *mut Renderer) {
    if !knob.is_null() {
        // SAFETY: `knobcam_new` made it so, and the caller gives it away.
        drop(unsafe { Box::from_raw(knob) });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use knobcore::effects::Id;
    use knobcore::model::Model;
    use knobcore::param::Axis;
    use std::ffi::CString;

    pub(crate) fn text() -> String {
        let ids = ["inertia", "coulomb", "viscous"].map(|id| Id::parse(id).unwrap());
        let mut model = Model::new(&ids, Axis::Rotary);
        for (name, value) in [("inertia.M", 6e-5), ("coulomb.pos", 0.01), ("coulomb.neg", 0.02)] {
            model.set(name, value).unwrap();
        }
        model_file::write(&model)
    }

    #[test]
    fn a_knob_of_c_answers_what_the_renderer_does_to_the_last_bit() {
        let mut right = renderer(&text(), 5000.0, false).unwrap();
        let model = CString::new(text()).unwrap();
        let knob = unsafe { knobcam_new(model.as_ptr(), 5000.0, 0, core::ptr::null_mut(), 0) };
        for i in 0..1000 {
            let t = f64::from(i) * 2e-4;
            let (theta, omega, alpha) = ((9.0 * t).sin(), 9.0 * (9.0 * t).cos(), -81.0 * (9.0 * t).sin());
            let tau = right.step(Sensed { theta, omega, alpha, hand: None });
            assert_eq!(unsafe { knobcam_step(knob, theta, omega, alpha) }.to_bits(), tau.to_bits());
            let tau = right.step(Sensed { theta, omega, alpha, hand: Some(1e-3) });
            assert_eq!(
                unsafe { knobcam_step_beside(knob, theta, omega, alpha, 1e-3) }.to_bits(),
                tau.to_bits()
            );
        }
        assert_eq!(unsafe { knobcam_step(knob, f64::NAN, 0.0, 0.0) }, 0.0);
        assert_eq!(unsafe { knobcam_fault(knob) }, 1);
        unsafe { knobcam_reset(knob) };
        assert_eq!(unsafe { knobcam_fault(knob) }, 0);
        unsafe { knobcam_free(knob) };
    }

    #[test]
    fn what_is_no_model_is_refused_in_one_line_that_fits() {
        let mut why = [1 as c_char; 16];
        for (model, rate) in [(CString::new("nonsense").unwrap(), 5e3), (CString::new(text()).unwrap(), 1.0)]
        {
            let knob = unsafe { knobcam_new(model.as_ptr(), rate, 0, why.as_mut_ptr(), why.len()) };
            assert!(knob.is_null());
            let said = unsafe { CStr::from_ptr(why.as_ptr()) }.to_str().unwrap();
            assert!(said.len() == 15 || rate == 1.0 && said.starts_with("rate"), "{said}");
        }
        assert!(unsafe { knobcam_new(core::ptr::null(), 5e3, 0, core::ptr::null_mut(), 0) }.is_null());
        let none = core::ptr::null_mut();
        unsafe { knobcam_reset(none) };
        assert_eq!(unsafe { (knobcam_step(none, 0.0, 0.0, 0.0), knobcam_fault(none)) }, (0.0, -1));
        unsafe { knobcam_free(none) };
    }
}
