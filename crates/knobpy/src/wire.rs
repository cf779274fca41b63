//! Bindings of the wire: messages are dicts whose `type` is their name in docs/wire-protocol.md.
use super::convert::{Column, input_error};
use knobcore::error::Error;
use knobrig::wire::{
    Account, Decoder, Event, Frame, Header, Log, Message, Point, Recording, Sample, encode, model_chunks,
    motion_chunks,
};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};
use toml::Value;

/// Adds the functions of this file to the module.
pub(super) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<PyDecoder>()?;
    m.add_function(wrap_pyfunction!(wire_encode, m)?)?;
    m.add_function(wrap_pyfunction!(wire_motion, m)?)?;
    m.add_function(wrap_pyfunction!(wire_model, m)?)?;
    m.add_function(wrap_pyfunction!(wire_check, m)?)?;
    m.add_function(wrap_pyfunction!(wire_log, m)?)
}

/// The bytes of one frame.
#[pyfunction]
#[pyo3(signature = (message, number, time_us = 0))]
fn wire_encode<'py>(
    py: Python<'py>,
    message: &Bound<'py, PyDict>,
    number: u32,
    time_us: u64,
) -> PyResult<Bound<'py, PyBytes>> {
    let frame = encode(Header { sequence: number, time_us }, &self::message(message)?);
    Ok(PyBytes::new(py, &frame))
}

/// The message that a dict says.
pub(super) fn message(dict: &Bound<'_, PyDict>) -> PyResult<Message> {
    let wrong = |error: toml::de::Error| input_error(Error::invalid("message", error.message()));
    value(dict.as_any())?.try_into().map_err(wrong)
}

/// Refuses the DESCRIPTOR of a device whose numbers cannot be.
#[pyfunction]
fn wire_check(message: &Bound<'_, PyDict>) -> PyResult<()> {
    match read_message(message)? {
        Message::Descriptor { device } => device.check().map_err(input_error),
        _ => Err(input_error(Error::invalid("message", "is no DESCRIPTOR"))),
    }
}

fn read_message(message: &Bound<'_, PyDict>) -> PyResult<Message> {
    let wrong = |error: toml::de::Error| input_error(Error::invalid("message", error.message()));
    value(message.as_any())?.try_into().map_err(wrong)
}

/// The frames that upload a motion, numbered from `number` on.
#[pyfunction]
#[pyo3(signature = (theta, omega, alpha, number, time_us = 0))]
fn wire_motion<'py>(
    py: Python<'py>,
    theta: Column<'py>,
    omega: Column<'py>,
    alpha: Column<'py>,
    number: u32,
    time_us: u64,
) -> PyResult<Bound<'py, PyList>> {
    let (theta, omega, alpha) = (theta.as_slice()?, omega.as_slice()?, alpha.as_slice()?);
    if theta.len() != omega.len() || theta.len() != alpha.len() {
        let why = format!("lengths {}, {} and {} differ", theta.len(), omega.len(), alpha.len());
        return Err(input_error(Error::invalid("motion", why)));
    }
    let columns = theta.iter().zip(omega).zip(alpha);
    let points =
        columns.map(|((&theta, &omega), &alpha)| Point { theta, omega: omega as f32, alpha: alpha as f32 });
    numbered(py, motion_chunks(&points.collect::<Vec<_>>()), number, time_us)
}

/// The frames that upload the text of a model file, numbered from `number` on.
#[pyfunction]
#[pyo3(signature = (text, number, time_us = 0))]
fn wire_model<'py>(py: Python<'py>, text: &str, number: u32, time_us: u64) -> PyResult<Bound<'py, PyList>> {
    numbered(py, model_chunks(text.as_bytes()), number, time_us)
}

fn numbered<'py>(
    py: Python<'py>,
    chunks: impl Iterator<Item = Message>,
    number: u32,
    time_us: u64,
) -> PyResult<Bound<'py, PyList>> {
    let numbers = std::iter::successors(Some(number), |number| Some(number.wrapping_add(1)));
    let frames = chunks
        .zip(numbers)
        .map(|(chunk, sequence)| PyBytes::new(py, &encode(Header { sequence, time_us }, &chunk)));
    PyList::new(py, frames.collect::<Vec<_>>())
}

/// Frames out of a stream of bytes.
#[pyclass(name = "WireDecoder", module = "knobcam._core")]
#[derive(Default)]
struct PyDecoder {
    decoder: Decoder,
}

#[pymethods]
impl PyDecoder {
    #[new]
    fn new() -> Self {
        Self::default()
    }

    /// What the next bytes of the stream complete: dicts with `event` frame, corrupt, foreign or unknown.
    fn push<'py>(&mut self, py: Python<'py>, stream: &[u8]) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let mut events = Vec::new();
        self.decoder.push(stream, |event| events.push(event_dict(py, &event)));
        events.into_iter().collect()
    }

    /// Bytes since the last delimiter.
    #[getter]
    fn pending(&self) -> usize {
        self.decoder.pending()
    }
}

/// All that a wire log holds.
#[pyfunction]
fn wire_log<'py>(py: Python<'py>, log: &[u8]) -> PyResult<Bound<'py, PyDict>> {
    let read = py.detach(|| {
        let mut read = Log::default();
        read.push(log);
        read
    });
    let dict = PyDict::new(py);
    dict.set_item("frames", read.frames)?;
    dict.set_item("corrupt", read.corrupt)?;
    dict.set_item("corrupt_bytes", read.corrupt_bytes)?;
    dict.set_item("unknown", read.unknown)?;
    dict.set_item("foreign", read.foreign)?;
    dict.set_item("pending", read.pending())?;
    let said = read.said.iter().map(|frame| frame_dict(py, frame)).collect::<PyResult<Vec<_>>>()?;
    dict.set_item("said", said)?;
    let runs = py.detach(|| read.recordings());
    let runs = runs.iter().map(|run| run_dict(py, run)).collect::<PyResult<Vec<_>>>()?;
    dict.set_item("runs", runs)?;
    Ok(dict)
}

fn run_dict<'py>(py: Python<'py>, run: &Recording) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("run", run.tag)?;
    dict.set_item("first", run.first)?;
    dict.set_item("start_known", run.start_known)?;
    dict.set_item("index", PyArray1::from_slice(py, &run.index))?;
    dict.set_item("count", column(py, &run.samples, |sample| sample.count))?;
    dict.set_item("omega", column(py, &run.samples, |sample| sample.omega))?;
    dict.set_item("alpha", column(py, &run.samples, |sample| sample.alpha))?;
    dict.set_item("tau", column(py, &run.samples, |sample| sample.tau))?;
    dict.set_item("gaps", run.gaps.iter().map(|gap| (gap.start, gap.end)).collect::<Vec<_>>())?;
    dict.set_item("frame_index", PyArray1::from_iter(py, run.stamps.iter().map(|stamp| stamp.0)))?;
    dict.set_item("frame_time_us", PyArray1::from_iter(py, run.stamps.iter().map(|stamp| stamp.1)))?;
    let Account { received, late, duplicate, stray, missing, gaps, .. } = run.account;
    let account = PyDict::new(py);
    for (name, samples) in [
        ("received", Some(received)),
        ("late", Some(late)),
        ("duplicate", Some(duplicate)),
        ("stray", Some(stray)),
        ("missing", Some(missing)),
        ("gaps", Some(gaps)),
        ("contradicted", Some(run.account.contradicted)),
        ("missing_head", Some(run.account.missing_head)),
        ("missing_tail", Some(run.account.missing_tail)),
        ("produced", run.account.produced),
        ("dropped_on_device", run.account.dropped_on_device),
        ("lost_on_the_way", run.account.lost_on_the_way),
    ] {
        account.set_item(name, samples)?;
    }
    dict.set_item("account", account)?;
    Ok(dict)
}

fn column<'py, T: numpy::Element>(
    py: Python<'py>,
    samples: &[Sample],
    of: fn(&Sample) -> T,
) -> Bound<'py, PyArray1<T>> {
    PyArray1::from_iter(py, samples.iter().map(of))
}

fn event_dict<'py>(py: Python<'py>, event: &Event) -> PyResult<Bound<'py, PyDict>> {
    let dict = match event {
        Event::Frame(frame) => frame_dict(py, frame)?,
        _ => PyDict::new(py),
    };
    let name = match event {
        Event::Frame(_) => "frame",
        Event::Corrupt { bytes } => {
            dict.set_item("bytes", bytes)?;
            "corrupt"
        }
        Event::Foreign { version } => {
            dict.set_item("version", version)?;
            "foreign"
        }
        Event::Unknown { header, kind } => {
            dict.set_item("sequence", header.sequence)?;
            dict.set_item("time_us", header.time_us)?;
            dict.set_item("kind", kind)?;
            "unknown"
        }
    };
    dict.set_item("event", name)?;
    Ok(dict)
}

/// A frame as a dict: sequence, time_us, message.
pub(super) fn frame_dict<'py>(py: Python<'py>, frame: &Frame) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("sequence", frame.header.sequence)?;
    dict.set_item("time_us", frame.header.time_us)?;
    let wrong = |error: toml::ser::Error| input_error(Error::invalid("message", error.to_string()));
    dict.set_item("message", object(py, Value::try_from(&frame.message).map_err(wrong)?)?)?;
    Ok(dict)
}

/// A value of Python as one that serde reads.
fn value(object: &Bound<'_, PyAny>) -> PyResult<Value> {
    if let Ok(dict) = object.cast::<PyDict>() {
        let items = dict.iter().map(|(name, item)| Ok((name.extract::<String>()?, value(&item)?)));
        return items.collect::<PyResult<toml::Table>>().map(Value::Table);
    }
    if let Ok(text) = object.extract::<String>() {
        return Ok(Value::String(text));
    }
    if let Ok(whole) = object.extract::<i64>() {
        return Ok(Value::Integer(whole));
    }
    if let Ok(number) = object.extract::<f64>() {
        return Ok(Value::Float(number));
    }
    let items = object.try_iter()?.map(|item| value(&item?));
    items.collect::<PyResult<Vec<_>>>().map(Value::Array)
}

/// A value that serde wrote as one of Python.
fn object(py: Python<'_>, value: Value) -> PyResult<Bound<'_, PyAny>> {
    Ok(match value {
        Value::String(text) => text.into_pyobject(py)?.into_any(),
        Value::Integer(whole) => whole.into_pyobject(py)?.into_any(),
        Value::Float(number) => number.into_pyobject(py)?.into_any(),
        Value::Boolean(truth) => truth.into_pyobject(py)?.to_owned().into_any(),
        Value::Datetime(time) => time.to_string().into_pyobject(py)?.into_any(),
        Value::Array(items) => {
            let items = items.into_iter().map(|item| object(py, item)).collect::<PyResult<Vec<_>>>()?;
            PyList::new(py, items)?.into_any()
        }
        Value::Table(items) => {
            let dict = PyDict::new(py);
            for (name, item) in items {
                dict.set_item(name, object(py, item)?)?;
            }
            dict.into_any()
        }
    })
}
