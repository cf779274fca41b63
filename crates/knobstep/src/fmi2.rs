//! FMI 2.0 for co-simulation (Modelica Association 2022, "Functional Mock-up Interface 2.0.4"): a [`Slave`] by its
//! functions. What FMI leaves to choice is not offered: states of the unit, derivatives, cancelling.

use super::slave::{Any, ERROR, OK, Slave, addressed, answer, answers, each, free, read};
use std::ffi::{c_char, c_int, c_void};

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
    let folder = addressed(unsafe { read(location) });
    let alone = "is for co-simulation alone";
    let made = if kind == 1 { Slave::of_resources(&folder) } else { Err(alone.to_owned()) };
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
    // SAFETY: as the caller vouches.
    unsafe { free(slave) };
}

/// Forgets everything.
///
/// # Safety
/// `slave` is null or of `fmi2Instantiate`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Reset(slave: *mut Slave) -> c_int {
    // SAFETY: as the caller vouches.
    answer(unsafe { slave.as_mut() }.map(Slave::reset).is_some())
}

/// Goes on by one communication step, which is a whole number of the knob's.
///
/// # Safety
/// `slave` is null or of `fmi2Instantiate`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DoStep(slave: *mut Slave, now: f64, duration: f64, _no_return: c_int) -> c_int {
    // SAFETY: as the caller vouches.
    answer(unsafe { slave.as_mut() }.is_some_and(|slave| slave.advance(now, duration)))
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
        answer(each(slave, references, count, |slave, reference, at| {
            *values.add(at) = slave.real(reference)?;
            Some(())
        }))
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
        answer(each(slave, references, count, |slave, reference, at| {
            *slave.inputs.get_mut(reference)? = *values.add(at);
            Some(())
        }))
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
        answer(each(slave, references, count, |slave, reference, at| {
            *slave.choices.get_mut(reference)? = *values.add(at) != 0;
            Some(())
        }))
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
        answer(each(slave, references, count, |slave, reference, at| {
            *values.add(at) = c_int::from(*slave.choices.get(reference)?);
            Some(())
        }))
    }
}

answers! {
    OK => c_int:
        fmi2SetDebugLogging(Any, c_int, usize, Any)
        fmi2SetupExperiment(Any, c_int, f64, f64, c_int, f64)
        fmi2EnterInitializationMode(Any)
        fmi2ExitInitializationMode(Any)
        fmi2Terminate(Any);
    ERROR => c_int:
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
