//! FMI 3.0 for co-simulation (Modelica Association 2022, "Functional Mock-up Interface 3.0"): a [`Slave`] by its
//! functions. What FMI leaves to choice is not offered: states of the unit, derivatives, events, clocks, early return.

use super::slave::{Any, ERROR, INPUTS, OK, Slave, answer, answers, each, free, read};
use std::ffi::{CString, c_char, c_int};
use std::path::Path;

/// References are of one row here, whatever the type: after the real variables comes time, and then the choices.
const TIME: usize = INPUTS + 1;
const CHOICE: usize = TIME + 1;

type Log = unsafe extern "C" fn(Any, c_int, *const c_char, *const c_char);

/// The version of the interface.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// A knob of the resource in the unit; null, and a line to the log, where that cannot be.
///
/// # Safety
/// As FMI has it: texts are ended by zeros, `log` is null or what FMI says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _name: *const c_char,
    _token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    _logging: bool,
    _events: bool,
    _early: bool,
    _intermediate: *const u32,
    _count: usize,
    environment: Any,
    log: Option<Log>,
    _update: Any,
) -> *mut Slave {
    // SAFETY: as the caller vouches.
    match Slave::of_resources(Path::new(unsafe { read(resources) })) {
        Ok(slave) => Box::into_raw(Box::new(slave)),
        Err(why) => {
            let why = CString::new(why).unwrap_or_default();
            if let Some(log) = log {
                // SAFETY: the simulator vouches for its log.
                unsafe { log(environment, ERROR, c"error".as_ptr(), why.as_ptr()) };
            }
            std::ptr::null_mut()
        }
    }
}

/// Gives the knob's memory back.
///
/// # Safety
/// `slave` is null or of `fmi3InstantiateCoSimulation`, and is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(slave: *mut Slave) {
    // SAFETY: as the caller vouches.
    unsafe { free(slave) };
}

/// Begins at a time.
///
/// # Safety
/// `slave` is null or of `fmi3InstantiateCoSimulation`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterInitializationMode(
    slave: *mut Slave,
    _tolerant: bool,
    _tolerance: f64,
    start: f64,
    _ends: bool,
    _stop: f64,
) -> c_int {
    // SAFETY: as the caller vouches.
    answer(unsafe { slave.as_mut() }.map(|slave| slave.now = start).is_some())
}

/// Forgets everything.
///
/// # Safety
/// As for `fmi3EnterInitializationMode`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Reset(slave: *mut Slave) -> c_int {
    // SAFETY: as the caller vouches.
    answer(unsafe { slave.as_mut() }.map(Slave::reset).is_some())
}

/// Goes on by one communication step, which is a whole number of the knob's.
///
/// # Safety
/// As for `fmi3EnterInitializationMode`; what is told is null or has its room.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    slave: *mut Slave,
    now: f64,
    duration: f64,
    _no_return: bool,
    event: *mut bool,
    ends: *mut bool,
    early: *mut bool,
    reached: *mut f64,
) -> c_int {
    // SAFETY: as the caller vouches.
    let Some(slave) = (unsafe { slave.as_mut() }) else { return ERROR };
    let done = slave.advance(now, duration);
    // SAFETY: as the caller vouches.
    unsafe {
        for told in [event, ends, early] {
            if let Some(told) = told.as_mut() {
                *told = false;
            }
        }
        if let Some(reached) = reached.as_mut() {
            *reached = slave.now;
        }
    }
    answer(done)
}

/// Reads real variables.
///
/// # Safety
/// `slave` is null or of `fmi3InstantiateCoSimulation`; `references` and `values` have `count` elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFloat64(
    slave: *mut Slave,
    references: *const u32,
    count: usize,
    values: *mut f64,
    _room: usize,
) -> c_int {
    // SAFETY: as the caller vouches.
    unsafe {
        answer(each(slave, references, count, |slave, reference, at| {
            *values.add(at) = if reference == TIME { slave.now } else { slave.real(reference)? };
            Some(())
        }))
    }
}

/// Sets real inputs.
///
/// # Safety
/// As for `fmi3GetFloat64`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFloat64(
    slave: *mut Slave,
    references: *const u32,
    count: usize,
    values: *const f64,
    _room: usize,
) -> c_int {
    // SAFETY: as the caller vouches.
    unsafe {
        answer(each(slave, references, count, |slave, reference, at| {
            *slave.inputs.get_mut(reference)? = *values.add(at);
            Some(())
        }))
    }
}

/// Reads choices.
///
/// # Safety
/// As for `fmi3GetFloat64`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetBoolean(
    slave: *mut Slave,
    references: *const u32,
    count: usize,
    values: *mut bool,
    _room: usize,
) -> c_int {
    // SAFETY: as the caller vouches.
    unsafe {
        answer(each(slave, references, count, |slave, reference, at| {
            *values.add(at) = *slave.choices.get(reference.checked_sub(CHOICE)?)?;
            Some(())
        }))
    }
}

/// Sets choices: whether the torque of the hand is measured, and whether the motion is imposed.
///
/// # Safety
/// As for `fmi3GetFloat64`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetBoolean(
    slave: *mut Slave,
    references: *const u32,
    count: usize,
    values: *const bool,
    _room: usize,
) -> c_int {
    // SAFETY: as the caller vouches.
    unsafe {
        answer(each(slave, references, count, |slave, reference, at| {
            *slave.choices.get_mut(reference.checked_sub(CHOICE)?)? = *values.add(at);
            Some(())
        }))
    }
}

answers! {
    OK => c_int:
        fmi3SetDebugLogging(Any, bool, usize, Any)
        fmi3ExitInitializationMode(Any)
        fmi3Terminate(Any);
    std::ptr::null_mut() => *mut Slave:
        fmi3InstantiateModelExchange(Any, Any, Any, bool, bool, Any, Any)
        fmi3InstantiateScheduledExecution(Any, Any, Any, bool, bool, Any, Any, Any, Any, Any);
    ERROR => c_int:
        fmi3EnterEventMode(Any)
        fmi3EnterStepMode(Any)
        fmi3EnterConfigurationMode(Any)
        fmi3ExitConfigurationMode(Any)
        fmi3GetFloat32(Any, Any, usize, Any, usize)
        fmi3GetInt8(Any, Any, usize, Any, usize)
        fmi3GetUInt8(Any, Any, usize, Any, usize)
        fmi3GetInt16(Any, Any, usize, Any, usize)
        fmi3GetUInt16(Any, Any, usize, Any, usize)
        fmi3GetInt32(Any, Any, usize, Any, usize)
        fmi3GetUInt32(Any, Any, usize, Any, usize)
        fmi3GetInt64(Any, Any, usize, Any, usize)
        fmi3GetUInt64(Any, Any, usize, Any, usize)
        fmi3GetString(Any, Any, usize, Any, usize)
        fmi3GetBinary(Any, Any, usize, Any, Any, usize)
        fmi3GetClock(Any, Any, usize, Any)
        fmi3SetFloat32(Any, Any, usize, Any, usize)
        fmi3SetInt8(Any, Any, usize, Any, usize)
        fmi3SetUInt8(Any, Any, usize, Any, usize)
        fmi3SetInt16(Any, Any, usize, Any, usize)
        fmi3SetUInt16(Any, Any, usize, Any, usize)
        fmi3SetInt32(Any, Any, usize, Any, usize)
        fmi3SetUInt32(Any, Any, usize, Any, usize)
        fmi3SetInt64(Any, Any, usize, Any, usize)
        fmi3SetUInt64(Any, Any, usize, Any, usize)
        fmi3SetString(Any, Any, usize, Any, usize)
        fmi3SetBinary(Any, Any, usize, Any, Any, usize)
        fmi3SetClock(Any, Any, usize, Any)
        fmi3GetNumberOfVariableDependencies(Any, u32, Any)
        fmi3GetVariableDependencies(Any, u32, Any, Any, Any, Any, usize)
        fmi3GetFMUState(Any, Any)
        fmi3SetFMUState(Any, Any)
        fmi3FreeFMUState(Any, Any)
        fmi3SerializedFMUStateSize(Any, Any, Any)
        fmi3SerializeFMUState(Any, Any, Any, usize)
        fmi3DeserializeFMUState(Any, Any, usize, Any)
        fmi3GetDirectionalDerivative(Any, Any, usize, Any, usize, Any, usize, Any, usize)
        fmi3GetAdjointDerivative(Any, Any, usize, Any, usize, Any, usize, Any, usize)
        fmi3GetIntervalDecimal(Any, Any, usize, Any, Any)
        fmi3GetIntervalFraction(Any, Any, usize, Any, Any, Any)
        fmi3GetShiftDecimal(Any, Any, usize, Any)
        fmi3GetShiftFraction(Any, Any, usize, Any, Any)
        fmi3SetIntervalDecimal(Any, Any, usize, Any)
        fmi3SetIntervalFraction(Any, Any, usize, Any, Any)
        fmi3SetShiftDecimal(Any, Any, usize, Any)
        fmi3SetShiftFraction(Any, Any, usize, Any, Any)
        fmi3EvaluateDiscreteStates(Any)
        fmi3UpdateDiscreteStates(Any, Any, Any, Any, Any, Any, Any)
        fmi3EnterContinuousTimeMode(Any)
        fmi3CompletedIntegratorStep(Any, bool, Any, Any)
        fmi3SetTime(Any, f64)
        fmi3SetContinuousStates(Any, Any, usize)
        fmi3GetContinuousStateDerivatives(Any, Any, usize)
        fmi3GetEventIndicators(Any, Any, usize)
        fmi3GetContinuousStates(Any, Any, usize)
        fmi3GetNominalsOfContinuousStates(Any, Any, usize)
        fmi3GetNumberOfEventIndicators(Any, Any)
        fmi3GetNumberOfContinuousStates(Any, Any)
        fmi3GetOutputDerivatives(Any, Any, usize, Any, Any, usize)
        fmi3ActivateModelPartition(Any, u32, f64);
}
