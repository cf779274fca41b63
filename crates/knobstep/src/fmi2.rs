//! FMI 2.0 for co-simulation (Modelica Association 2022, "Functional Mock-up Interface 2.0.4"): the step as a slave.
//!
//! The library is the same for every model: the text of the model is a resource of the unit, below a line that has its
//! rate. What FMI leaves to choice is not offered: states of the unit, derivatives, cancelling.

use knobrender::{Renderer, Sensed};
use std::ffi::{CStr, c_char, c_int, c_void};
use std::path::PathBuf;

const OK: c_int = 0;
const ERROR: c_int = 3;
/// Share of a step by which a communication step may differ from a whole number of them.
const WHOLE: f64 = 1e-6;
/// The file of the unit that has its rate and its model.
const RESOURCE: &str = "knob.txt";
/// Real variables by their reference: angle, speed, acceleration, torque of the hand; the torque comes last.
const INPUTS: usize = 4;
/// Boolean variables: whether the torque of the hand is measured, and whether the motion is imposed.
const CHOICES: usize = 2;

type Logger = unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...);

/// What the simulator brings along.
#[repr(C)]
#[derive(Debug)]
pub struct Callbacks {
    logger: Option<Logger>,
    allocate: *const c_void,
    free: *const c_void,
    finished: *const c_void,
    environment: *mut c_void,
}

/// One knob in a simulator.
#[derive(Debug)]
pub struct Slave {
    /// On a free handle, and on one whose motion is imposed.
    knobs: [Renderer; 2],
    inputs: [f64; INPUTS],
    choices: [bool; CHOICES],
    tau: f64,
}

impl Slave {
    /// A knob of the resource's text: its rate on the first line, its model below.
    fn new(resource: &str) -> Result<Self, String> {
        let (rate, model) = resource.split_once('\n').unwrap_or((resource, ""));
        let rate =
            rate.trim().parse::<f64>().map_err(|_| format!("{RESOURCE}: no rate on its first line"))?;
        let knob = |held| super::renderer(model, rate, held).map_err(|error| format!("{RESOURCE}: {error}"));
        let knobs = [knob(false)?, knob(true)?];
        Ok(Self { knobs, inputs: [0.0; INPUTS], choices: [false; CHOICES], tau: 0.0 })
    }

    /// One communication step: as many of the knob's as fit, the motion that of its end.
    fn advance(&mut self, duration: f64) -> bool {
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
        knob.fault().is_none()
    }

    fn real(&self, reference: usize) -> Option<&f64> {
        if reference == INPUTS { Some(&self.tau) } else { self.inputs.get(reference) }
    }
}

/// The path of the resource that a `file:` address of their folder leads to.
fn resource(folder: &str) -> PathBuf {
    let path = folder.strip_prefix("file://").or(folder.strip_prefix("file:")).unwrap_or(folder);
    let (mut bytes, mut rest) = (Vec::new(), path.as_bytes());
    while let [first, others @ ..] = rest {
        let code = others.get(..2).and_then(|hex| std::str::from_utf8(hex).ok());
        let escaped = code.filter(|_| *first == b'%').and_then(|hex| u8::from_str_radix(hex, 16).ok());
        bytes.push(escaped.unwrap_or(*first));
        rest = if escaped.is_some() { &others[2..] } else { others };
    }
    PathBuf::from(String::from_utf8_lossy(&bytes).into_owned()).join(RESOURCE)
}

/// # Safety
/// `text` is null or ended by a zero.
unsafe fn read<'a>(text: *const c_char) -> &'a str {
    if text.is_null() {
        return "";
    }
    // SAFETY: as the caller vouches.
    unsafe { CStr::from_ptr(text) }.to_str().unwrap_or("")
}

/// The version of the interface.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// The sizes of its types.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

/// A knob of the resource in the unit; null, and a line to the logger, where that cannot be.
///
/// # Safety
/// As FMI has it: texts are ended by zeros, `callbacks` is null or what FMI says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    name: *const c_char,
    kind: c_int,
    _guid: *const c_char,
    location: *const c_char,
    callbacks: *const Callbacks,
    _visible: c_int,
    _logging: c_int,
) -> *mut Slave {
    // SAFETY: as the caller vouches.
    let path = resource(unsafe { read(location) });
    let text = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()));
    let made = text.and_then(|text| {
        if kind == 1 { Slave::new(&text) } else { Err("is for co-simulation alone".to_owned()) }
    });
    match made {
        Ok(slave) => Box::into_raw(Box::new(slave)),
        Err(why) => {
            let why = std::ffi::CString::new(why).unwrap_or_default();
            // SAFETY: the simulator vouches for its callbacks; the format takes one text.
            unsafe {
                if let Some(Callbacks { logger: Some(logger), environment, .. }) = callbacks.as_ref() {
                    logger(*environment, name, ERROR, c"error".as_ptr(), c"%s".as_ptr(), why.as_ptr());
                }
            }
            std::ptr::null_mut()
        }
    }
}

/// Gives the knob's memory back.
///
/// # Safety
/// `slave` is null or of `fmi2Instantiate`, and is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(slave: *mut Slave) {
    if !slave.is_null() {
        // SAFETY: `fmi2Instantiate` made it so, and the caller gives it away.
        drop(unsafe { Box::from_raw(slave) });
    }
}

/// Forgets everything.
///
/// # Safety
/// `slave` is null or of `fmi2Instantiate`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Reset(slave: *mut Slave) -> c_int {
    // SAFETY: as the caller vouches.
    let Some(slave) = (unsafe { slave.as_mut() }) else { return ERROR };
    slave.knobs.iter_mut().for_each(Renderer::reset);
    (slave.inputs, slave.choices, slave.tau) = ([0.0; INPUTS], [false; CHOICES], 0.0);
    OK
}

/// Goes on by one communication step, which is a whole number of the knob's.
///
/// # Safety
/// `slave` is null or of `fmi2Instantiate`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DoStep(slave: *mut Slave, _now: f64, duration: f64, _no_return: c_int) -> c_int {
    // SAFETY: as the caller vouches.
    let Some(slave) = (unsafe { slave.as_mut() }) else { return ERROR };
    if slave.advance(duration) { OK } else { ERROR }
}

/// Does something with every variable of a call, given by its reference and its place; an error where there is none.
///
/// # Safety
/// `slave` is null or of `fmi2Instantiate`; `references` has `count` elements.
unsafe fn each(
    slave: *mut Slave,
    references: *const u32,
    count: usize,
    mut variable: impl FnMut(&mut Slave, usize, usize) -> Option<()>,
) -> c_int {
    // SAFETY: as the caller vouches.
    let Some(slave) = (unsafe { slave.as_mut() }) else { return ERROR };
    let known = (0..count).all(|at| {
        // SAFETY: as the caller vouches.
        let reference = unsafe { *references.add(at) };
        variable(slave, reference as usize, at).is_some()
    });
    if known { OK } else { ERROR }
}

/// Reads real variables.
///
/// # Safety
/// `slave` is null or of `fmi2Instantiate`; `references` and `values` have `count` elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(
    slave: *mut Slave,
    references: *const u32,
    count: usize,
    values: *mut f64,
) -> c_int {
    // SAFETY: as the caller vouches.
    unsafe {
        each(slave, references, count, |slave, reference, at| {
            *values.add(at) = *slave.real(reference)?;
            Some(())
        })
    }
}

/// Sets real inputs.
///
/// # Safety
/// As for `fmi2GetReal`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(
    slave: *mut Slave,
    references: *const u32,
    count: usize,
    values: *const f64,
) -> c_int {
    // SAFETY: as the caller vouches.
    unsafe {
        each(slave, references, count, |slave, reference, at| {
            *slave.inputs.get_mut(reference)? = *values.add(at);
            Some(())
        })
    }
}

/// Sets choices: whether the torque of the hand is measured, and whether the motion is imposed.
///
/// # Safety
/// As for `fmi2GetReal`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetBoolean(
    slave: *mut Slave,
    references: *const u32,
    count: usize,
    values: *const c_int,
) -> c_int {
    // SAFETY: as the caller vouches.
    unsafe {
        each(slave, references, count, |slave, reference, at| {
            *slave.choices.get_mut(reference)? = *values.add(at) != 0;
            Some(())
        })
    }
}

/// Reads choices.
///
/// # Safety
/// As for `fmi2GetReal`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBoolean(
    slave: *mut Slave,
    references: *const u32,
    count: usize,
    values: *mut c_int,
) -> c_int {
    // SAFETY: as the caller vouches.
    unsafe {
        each(slave, references, count, |slave, reference, at| {
            *values.add(at) = c_int::from(*slave.choices.get(reference)?);
            Some(())
        })
    }
}

/// Functions that have nothing to do here, and those that are not offered.
macro_rules! answers {
    ($($answer:ident: $($name:ident($($argument:ty),*))*;)*) => {$($(
        /// Of FMI; it has nothing to do here, or is not offered.
        #[unsafe(no_mangle)]
        pub extern "C" fn $name($(_: $argument),*) -> c_int {
            $answer
        }
    )*)*};
}

type Any = *mut c_void;

answers! {
    OK:
        fmi2SetDebugLogging(Any, c_int, usize, Any)
        fmi2SetupExperiment(Any, c_int, f64, f64, c_int, f64)
        fmi2EnterInitializationMode(Any)
        fmi2ExitInitializationMode(Any)
        fmi2Terminate(Any);
    ERROR:
        fmi2GetInteger(Any, Any, usize, Any)
        fmi2GetString(Any, Any, usize, Any)
        fmi2SetInteger(Any, Any, usize, Any)
        fmi2SetString(Any, Any, usize, Any)
        fmi2GetFMUstate(Any, Any)
        fmi2SetFMUstate(Any, Any)
        fmi2FreeFMUstate(Any, Any)
        fmi2SerializedFMUstateSize(Any, Any, Any)
        fmi2SerializeFMUstate(Any, Any, Any, usize)
        fmi2DeSerializeFMUstate(Any, Any, usize, Any)
        fmi2GetDirectionalDerivative(Any, Any, usize, Any, usize, Any, Any)
        fmi2SetRealInputDerivatives(Any, Any, usize, Any, Any)
        fmi2GetRealOutputDerivatives(Any, Any, usize, Any, Any)
        fmi2CancelStep(Any)
        fmi2GetStatus(Any, c_int, Any)
        fmi2GetRealStatus(Any, c_int, Any)
        fmi2GetIntegerStatus(Any, c_int, Any)
        fmi2GetBooleanStatus(Any, c_int, Any)
        fmi2GetStringStatus(Any, c_int, Any);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_resource_is_found_by_its_address_whatever_it_is_escaped_by() {
        for (address, path) in [
            ("file:///tmp/a%20b/resources", "/tmp/a b/resources/knob.txt"),
            ("file:/tmp/100%/resources", "/tmp/100%/resources/knob.txt"),
            ("/tmp/resources", "/tmp/resources/knob.txt"),
        ] {
            assert_eq!(resource(address), PathBuf::from(path));
        }
    }

    #[test]
    fn a_communication_step_is_a_whole_number_of_the_knobs() {
        assert!(Slave::new(&crate::tests::text()).is_err(), "it has no rate");
        let text = format!("5000\n{}", crate::tests::text());
        let mut slave = Slave::new(&text).unwrap();
        slave.inputs = [0.1, 2.0, 10.0, 0.0];
        assert!(slave.advance(2e-4) && slave.advance(1e-3));
        assert!(!slave.advance(3e-4) && !slave.advance(0.0) && !slave.advance(f64::NAN));
        assert!(slave.tau > 0.0 && slave.real(5).is_none());
    }
}
