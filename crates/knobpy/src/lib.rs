//! Bindings: convert, delegate, convert. Nothing is computed here.
mod convert;
mod elsewhere;
mod emulate;
mod filter;
mod fit;
mod handle;
mod hints;
mod model;
mod names;
mod progress;
mod propose;
mod realtime;
mod record;
mod render;
mod signals;
mod user;
mod watched;
mod wire;

use knobcore::isa::used;
use pyo3::exceptions::PyImportError;
use pyo3::prelude::*;

/// A large block that was freed once tells the C library (glibc: "dynamic mmap threshold") to keep what is freed for
/// what is asked for next. Else it hands the columns of every fit back, and new pages take longer than the fit.
const KEPT_BYTES: usize = 8 << 20;

/// The instruction set that is used: sse2, avx2 or avx512; the environment's KNOBCAM_ISA names another, read once.
#[pyfunction]
fn instruction_set() -> PyResult<&'static str> {
    used().map_err(|error| PyImportError::new_err(error.to_string()))
}

/// Let the work of this process have at most so many threads from now on.
#[pyfunction]
fn at_most(threads: usize) {
    knobcore::threads::at_most(threads);
}

#[pymodule]
fn _core(m: &Bound<'_, PyModule>) -> PyResult<()> {
    drop(std::hint::black_box(Vec::<u8>::with_capacity(KEPT_BYTES)));
    m.add("__version__", env!("CARGO_PKG_VERSION"))?;
    // Once, when it is loaded: a process has one rule.
    if let Ok(changes) = std::env::var("KNOBCAM_RULE") {
        fit::settled(&changes)?;
    }
    instruction_set()?;
    m.add_function(wrap_pyfunction!(instruction_set, m)?)?;
    m.add_function(wrap_pyfunction!(at_most, m)?)?;
    filter::register(m)?;
    wire::register(m)?;
    m.add_class::<model::PyModel>()?;
    m.add_function(wrap_pyfunction!(model::catalogue, m)?)?;
    m.add_function(wrap_pyfunction!(model::catalogue_version, m)?)?;
    m.add_function(wrap_pyfunction!(user::effect_source, m)?)?;
    m.add_function(wrap_pyfunction!(model::push, m)?)?;
    m.add_function(wrap_pyfunction!(model::forward, m)?)?;
    m.add_function(wrap_pyfunction!(user::register_effect, m)?)?;
    m.add_function(wrap_pyfunction!(user::register_law, m)?)?;
    m.add_function(wrap_pyfunction!(user::forget_effect, m)?)?;
    m.add_function(wrap_pyfunction!(user::effect_failure, m)?)?;
    m.add_class::<realtime::PyLoop>()?;
    m.add_function(wrap_pyfunction!(realtime::start_loop, m)?)?;
    m.add_class::<record::PyRecorder>()?;
    m.add_class::<signals::PySignals>()?;
    m.add_function(wrap_pyfunction!(signals::prepare, m)?)?;
    m.add_class::<render::PyRenderer>()?;
    m.add_class::<render::PyHandle>()?;
    m.add_class::<handle::PyEmulatedHandle>()?;
    m.add_class::<emulate::PyRig>()?;
    m.add_function(wrap_pyfunction!(render::check_passive, m)?)?;
    m.add_function(wrap_pyfunction!(render::check_stability, m)?)?;
    m.add_class::<fit::PyFit>()?;
    m.add_function(wrap_pyfunction!(fit::locate, m)?)?;
    m.add_function(wrap_pyfunction!(fit::unheard, m)?)?;
    m.add_function(wrap_pyfunction!(fit::stiction, m)?)?;
    m.add_function(wrap_pyfunction!(fit::refine, m)?)?;
    m.add_function(wrap_pyfunction!(fit::thresholds, m)?)?;
    m.add_function(wrap_pyfunction!(fit::complete, m)?)?;
    m.add_function(wrap_pyfunction!(fit::at_floor, m)?)?;
    m.add_function(wrap_pyfunction!(fit::judge, m)?)?;
    m.add_function(wrap_pyfunction!(fit::diagnose, m)?)?;
    m.add_function(wrap_pyfunction!(fit::in_place, m)?)?;
    m.add_function(wrap_pyfunction!(elsewhere::elsewhere, m)?)?;
    m.add_function(wrap_pyfunction!(hints::hints, m)?)?;
    m.add_function(wrap_pyfunction!(fit::pairs, m)?)?;
    m.add_function(wrap_pyfunction!(propose::propose, m)?)?;
    m.add_function(wrap_pyfunction!(propose::trace, m)?)?;
    m.add_function(wrap_pyfunction!(fit::sets, m)?)?;
    m.add_function(wrap_pyfunction!(fit::implausible, m)?)?;
    m.add_function(wrap_pyfunction!(fit::fit, m)?)
}
