//! Bindings of the recorder: a thread that reads a port without the GIL, or whoever pushes bytes.
use super::convert::input_error;
use super::wire::frame_dict;
use knobcore::error::Error;
use knobrig::record::{Desk, LogFile, Session};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::fs::OpenOptions;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// What is served by a thread, or by whoever pushes bytes.
enum Service {
    #[cfg(target_os = "linux")]
    Thread {
        waker: knobrig::record::Waker,
        thread: Mutex<Option<std::thread::JoinHandle<()>>>,
    },
    Pushed(Mutex<Box<Session>>),
}

/// Records what a rig says.
#[pyclass(frozen, name = "Recorder", module = "knobcam._core")]
pub struct PyRecorder {
    desk: Arc<Desk>,
    start: Instant,
    service: Service,
}

#[pymethods]
impl PyRecorder {
    /// Reads the port behind a file descriptor; without one, bytes are pushed.
    #[new]
    #[pyo3(signature = (fd = None))]
    fn new(fd: Option<i32>) -> PyResult<Self> {
        let (desk, start) = (Arc::new(Desk::default()), Instant::now());
        let session = Session::new(desk.clone(), start);
        let service = match fd {
            None => Service::Pushed(Mutex::new(Box::new(session))),
            Some(fd) => served(session, fd)?,
        };
        Ok(Self { desk, start, service })
    }

    /// From now on everything that comes is appended to this file, or goes nowhere.
    #[pyo3(signature = (path))]
    fn log_to(&self, path: Option<PathBuf>) -> PyResult<()> {
        let open = |path: PathBuf| {
            let file = OpenOptions::new().append(true).open(&path);
            let why = |error: std::io::Error| Error::invalid(path.display().to_string(), error.to_string());
            file.map(|file| Box::new(file) as LogFile).map_err(why)
        };
        self.desk.log_to(path.map(open).transpose().map_err(input_error)?);
        Ok(())
    }

    /// Sends frames.
    fn send(&self, frames: &[u8]) -> PyResult<()> {
        self.desk.send(frames).map_err(input_error)?;
        self.wake();
        Ok(())
    }

    /// Sends heartbeats for so many seconds from now; 0 ends them.
    fn beat(&self, seconds: f64) -> PyResult<()> {
        let span = Duration::try_from_secs_f64(seconds)
            .map_err(|error| input_error(Error::invalid("seconds", error.to_string())))?;
        self.desk.beat_until((!span.is_zero()).then(|| Instant::now() + span));
        self.wake();
        Ok(())
    }

    /// The clock of this host: microseconds since the recorder began.
    #[getter]
    fn now_us(&self) -> u64 {
        self.start.elapsed().as_micros() as u64
    }

    /// What can be told at this moment.
    fn figures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let figures = py.detach(|| self.desk.figures());
        let dict = PyDict::new(py);
        for (name, count) in [
            ("bytes", figures.bytes),
            ("logged", figures.logged),
            ("frames", figures.frames),
            ("corrupt", figures.corrupt),
            ("forgotten", figures.forgotten),
            ("received", figures.received),
            ("missing", figures.missing),
        ] {
            dict.set_item(name, count)?;
        }
        dict.set_item("foreign_version", figures.foreign_version)?;
        dict.set_item("state", figures.state.map(|state| format!("{state:?}").to_lowercase()))?;
        dict.set_item("temperature", figures.temperature)?;
        dict.set_item("run", figures.run)?;
        dict.set_item("complete", figures.complete)?;
        dict.set_item("rate_hz", figures.rate_hz)?;
        dict.set_item("device_rate_hz", figures.device_rate_hz)?;
        dict.set_item("device_span_s", figures.device_span_s)?;
        dict.set_item("peak_torque", figures.peak_torque)?;
        dict.set_item("clipped", figures.clipped)?;
        dict.set_item("log_error", figures.log_error)?;
        dict.set_item("ended", figures.ended)?;
        Ok(dict)
    }

    /// The next message other than DATA; None where none comes in time, or none can come any more.
    fn next_message<'py>(&self, py: Python<'py>, timeout_s: f64) -> PyResult<Option<Bound<'py, PyDict>>> {
        let patience = Duration::try_from_secs_f64(timeout_s)
            .map_err(|error| input_error(Error::invalid("timeout_s", error.to_string())))?;
        let frame = py.detach(|| self.desk.next_message(patience));
        frame.map(|frame| frame_dict(py, &frame)).transpose()
    }

    /// Takes bytes that were read elsewhere; what is to be sent to the device.
    fn push<'py>(&self, py: Python<'py>, received: &[u8]) -> PyResult<Bound<'py, PyBytes>> {
        let Service::Pushed(session) = &self.service else {
            return Err(input_error(Error::invalid("push", "this recorder reads its port itself")));
        };
        let outgoing = py.detach(|| {
            let mut session = session.lock().unwrap_or_else(PoisonError::into_inner);
            session.receive(received, Instant::now());
            session.outgoing(Instant::now())
        });
        Ok(PyBytes::new(py, &outgoing))
    }

    /// Nothing comes any more, and why; for whoever pushes.
    fn end(&self, why: &str) {
        self.desk.end(why);
    }

    /// Stops and lets go of the port; may be called again.
    fn stop(&self, py: Python<'_>) {
        self.desk.stop();
        self.wake();
        match &self.service {
            #[cfg(target_os = "linux")]
            Service::Thread { thread, .. } => {
                let thread = thread.lock().unwrap_or_else(PoisonError::into_inner).take();
                // It ends by itself; what it could not do is in its figures.
                let _ = thread.map(|thread| py.detach(|| thread.join()));
            }
            Service::Pushed(_) => py.detach(|| self.desk.end("the recorder was stopped")),
        }
    }
}

impl PyRecorder {
    fn wake(&self) {
        #[cfg(target_os = "linux")]
        if let Service::Thread { waker, .. } = &self.service {
            waker.wake();
        }
    }
}

impl Drop for PyRecorder {
    fn drop(&mut self) {
        self.desk.stop();
        self.wake();
    }
}

#[cfg(target_os = "linux")]
fn served(session: Session, fd: i32) -> PyResult<Service> {
    use std::os::fd::BorrowedFd;
    let refused = |why: String| input_error(Error::invalid("fd", why));
    if fd < 0 {
        return Err(refused(format!("{fd} is no file descriptor")));
    }
    // SAFETY: the number is only used to make a descriptor of its own, here and now; the caller holds the GIL and
    // the port. A number that is not open is refused by the system.
    #[allow(unsafe_code)]
    let port = unsafe { BorrowedFd::borrow_raw(fd) }.try_clone_to_owned();
    let port = port.map_err(|error| refused(error.to_string()))?;
    let (waker, thread) = knobrig::record::serve(session, port).map_err(input_error)?;
    Ok(Service::Thread { waker, thread: Mutex::new(Some(thread)) })
}

#[cfg(not(target_os = "linux"))]
fn served(_: Session, _: i32) -> PyResult<Service> {
    Err(input_error(Error::invalid("fd", "on this system bytes are pushed; leave it out")))
}
