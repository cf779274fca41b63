//! Bindings of the fit.
use super::convert::{Floats, array, input_error, matrix};
use super::model::PyModel;
use super::names::{ids, own_id};
use super::progress::Progress;
use super::signals::PySignals;
use super::watched::watched;
use knobcore::diagnose::{
    Candidate, Evidence, Set, Split, State, at_floor as at_floor_core, complete as complete_core, converge,
    diagnose as diagnose_core, exact as exact_core, implausible as implausible_core,
    in_place as in_place_core, judge as judge_core, locate as locate_core, pairs as pairs_core,
    sets as sets_core, worth_adding,
};
use knobcore::fit::{Detents, Fit, fit as fit_core, report, sketch_within};
use knobcore::floor::{Unheard, unheard as unheard_core};
use knobcore::rule::{Row, Rule, rule, settle};
use knobcore::stiction::{Estimate, stiction as stiction_core};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A fitted model.
#[pyclass(frozen, name = "Fit", module = "knobcam._core")]
pub struct PyFit(pub Fit);

#[pymethods]
impl PyFit {
    #[getter]
    fn model(&self) -> PyModel {
        PyModel(self.0.model.clone())
    }

    /// Names of the determined parameters, the order of `standard_errors`, `correlation` and `bootstrap`.
    #[getter]
    fn free(&self) -> Vec<String> {
        self.0.free.iter().map(|&i| self.0.model.slots()[i].name()).collect()
    }

    #[getter]
    fn standard_errors<'py>(&self, py: Python<'py>) -> Floats<'py> {
        array(py, &self.0.standard_errors())
    }

    #[getter]
    fn correlation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        matrix(py, &self.0.correlation())
    }

    #[getter]
    fn undetermined(&self) -> Vec<(String, String)> {
        self.0.undetermined.iter().map(|u| (u.name.clone(), u.why.clone())).collect()
    }

    #[getter]
    fn rmse(&self) -> f64 {
        self.0.rmse
    }

    #[getter]
    fn rmse_heldout(&self) -> f64 {
        self.0.rmse_heldout
    }

    /// What it would cost at least to do without an effect, in variances of the raw noise, to first order.
    fn worth(&self, effect: &str) -> f64 {
        self.0.worth(effect)
    }

    #[getter]
    fn noise_floor(&self) -> f64 {
        self.0.noise_floor
    }

    #[getter]
    fn white_squares(&self) -> f64 {
        self.0.white_squares
    }

    #[getter]
    fn iterations(&self) -> usize {
        self.0.iterations
    }

    #[getter]
    fn evaluations(&self) -> usize {
        self.0.evaluations
    }

    #[getter]
    fn status(&self) -> &'static str {
        self.0.status.word()
    }

    #[getter]
    fn message(&self) -> &'static str {
        self.0.status.message()
    }

    /// The detent scan: (1/P, gain in (N m)^2), where one was made.
    #[getter]
    fn scan<'py>(&self, py: Python<'py>) -> Option<(Floats<'py>, Floats<'py>)> {
        let scan = self.0.scan.as_ref()?;
        Some((array(py, &scan.inverse_period), array(py, &scan.gain)))
    }

    /// Block-bootstrap refits, shape (parameters, draws).
    fn bootstrap<'py>(
        &self,
        py: Python<'py>,
        draws: usize,
        seed: u64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let refits = watched(py, &self.0.model, || self.0.bootstrap(draws, seed))?;
        Ok(PyArray2::from_vec2(py, &refits)?)
    }

    /// Half-width of the 95 % band of the mean prediction, N m.
    fn band<'py>(&self, py: Python<'py>, signals: &PySignals) -> PyResult<Floats<'py>> {
        let band = watched(py, &self.0.model, || self.0.band(&signals.prepared.signals))?;
        Ok(array(py, &band))
    }

    /// What a refit would leave of signals whose torque is another model's, in variances of white noise (`white`, (N m)^2), and
    /// the standard errors after it, in the order of `free`.
    fn expected<'py>(
        &self,
        py: Python<'py>,
        signals: &PySignals,
        white: f64,
    ) -> PyResult<(f64, Floats<'py>)> {
        let work = || self.0.expected(&signals.prepared.signals, white);
        let expected = watched(py, &self.0.model, work)?.map_err(input_error)?;
        Ok((expected.left, array(py, &expected.standard_errors)))
    }

    /// The model with other parameters that the data allow, by numbers of a normal distribution, one for each of `free`.
    fn drawn(&self, normals: Vec<f64>) -> PyModel {
        PyModel(self.0.drawn(&normals))
    }
}

/// An estimate as it goes out: (value, low, high).
type Interval = Option<(f64, f64, f64)>;

/// Static friction as it goes out: d_neg, d_pos, dv, breakaways.
type Stiction = (Interval, Interval, Interval, [usize; 2]);

/// Static friction that captures show beside a fitted model.
#[pyfunction]
pub fn stiction(py: Python<'_>, data: Vec<PyRef<'_, PySignals>>, model: &PyModel) -> PyResult<Stiction> {
    let signals: Vec<_> = data.iter().map(|signals| &signals.prepared.signals).collect();
    let (model, signals) = (&model.0, &signals[..]);
    let found = watched(py, model, || stiction_core(signals, model))?;
    let row = |e: Option<Estimate>| e.map(|e| (e.value, e.ci95[0], e.ci95[1]));
    Ok((row(found.d_neg), row(found.d_pos), row(found.dv), found.breakaways))
}

/// Why the spectrum of the first capture's torque does not tell its noise beside a model: short, smoothed or loud.
#[pyfunction]
pub fn unheard(
    py: Python<'_>,
    data: Vec<PyRef<'_, PySignals>>,
    model: &PyModel,
) -> PyResult<Option<&'static str>> {
    let signals: Vec<_> = data.iter().map(|signals| &signals.prepared.signals).collect();
    let (model, signals) = (&model.0, &signals[..]);
    Ok(watched(py, model, || unheard_core(signals, model))?.map(|why| match why {
        Unheard::Short => "short",
        Unheard::Smoothed => "smoothed",
        Unheard::Loud => "loud",
    }))
}

/// Splits the error of a model over every axis: dicts with the fields of `Split`.
#[pyfunction]
pub fn locate<'py>(
    py: Python<'py>,
    data: Vec<PyRef<'py, PySignals>>,
    model: &PyModel,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let signals: Vec<_> = data.iter().map(|signals| &signals.prepared.signals).collect();
    let (model, signals) = (&model.0, &signals[..]);
    let splits = watched(py, model, || locate_core(signals, model))?;
    splits.iter().map(|split| split_dict(py, split)).collect()
}

fn split_dict<'py>(py: Python<'py>, split: &Split) -> PyResult<Bound<'py, PyDict>> {
    let row = PyDict::new(py);
    row.set_item("axis", split.axis)?;
    let columns = [
        ("low", &split.low),
        ("high", &split.high),
        ("count", &split.count),
        ("mean", &split.mean),
        ("rms", &split.rms),
        ("band", &split.band),
    ];
    for (name, column) in columns {
        row.set_item(name, array(py, column))?;
    }
    row.set_item("direction", PyArray1::from_slice(py, &split.direction))?;
    row.set_item("share", split.share)?;
    row.set_item("part", split.part)?;
    row.set_item("chance", split.chance)?;
    let regions: Vec<_> =
        split.regions.iter().map(|r| (r.from, r.to, r.direction, r.mean, r.share)).collect();
    row.set_item("regions", regions)?;
    Ok(row)
}

/// A fit as it is judged: error, noise floor, what the noise leaves in variances of the raw noise, RMS torque, and of each
/// axis along which it fails beyond chance the part of the squared error that lies there.
type Judged = (f64, f64, f64, f64, Vec<f64>);

fn state((rmse, noise_floor, white_squares, torque_rms, beyond): Judged) -> State {
    let exact = exact_core(rmse, torque_rms);
    let state = State { rmse, noise_floor, white_squares, law: 0.0, complete: false, exact };
    State { complete: complete_core(&state, &beyond), ..state }
}

/// Whether what a fit leaves is rounding, and whether chance explains it.
#[pyfunction]
pub fn complete(fit: Judged) -> (bool, bool) {
    let state = state(fit);
    (state.exact, state.complete)
}

/// Times the noise floor up to which an error is no different from it, by what noise leaves of the sum of squares.
#[pyfunction]
pub fn at_floor(white_squares: f64) -> f64 {
    at_floor_core(white_squares)
}

/// What speaks for an effect as it comes in: the fields of [`Evidence`].
type EvidenceRow = (f64, usize, f64, f64, f64, f64, f64, bool, usize);

/// What is said of effects beside a fit, one each: a word, and the places of those that cannot be told from it; what speaks
/// for them as [`Evidence`] has it. `law` is the mean squared error by which laws that were added may be off.
#[pyfunction]
pub fn judge(fit: Judged, law: f64, effects: Vec<EvidenceRow>) -> Vec<(&'static str, Vec<usize>)> {
    let evidence = |row: EvidenceRow| {
        let (gain, parameters, charged, p_value, rmse, felt, doubt, implausible, bent) = row;
        Evidence { gain, parameters, charged, p_value, rmse, felt, doubt, implausible, bent }
    };
    let all: Vec<Evidence> = effects.into_iter().map(evidence).collect();
    judge_core(&State { law, ..state(fit) }, &all)
        .into_iter()
        .map(|one| (one.word.id(), one.equivalent))
        .collect()
}

/// A threshold as it goes out: name, value, unit, what it decides, meaning, source.
type Threshold = (&'static str, f64, &'static str, &'static str, &'static str, &'static str);

/// The thresholds that decide what is said to be missing, with their values in this process.
#[pyfunction]
pub fn thresholds() -> Vec<Threshold> {
    let row = |(row, value): (&Row, f64)| (row.name, value, row.unit, row.decides, row.meaning, row.source);
    Rule::ROWS.iter().zip(rule().values()).map(row).collect()
}

/// Changes thresholds for a study, `name=value` with commas between, before anything has asked for one.
pub fn settled(changes: &str) -> PyResult<()> {
    settle(Rule::with(changes).map_err(input_error)?);
    Ok(())
}

/// Fits a model to one or several captures; `find_detents` adds detents where the data show them.
#[pyfunction]
pub fn fit(
    py: Python<'_>,
    data: Vec<PyRef<'_, PySignals>>,
    model: &PyModel,
    find_detents: bool,
) -> PyResult<PyFit> {
    let signals: Vec<_> = data.iter().map(|signals| &signals.prepared.signals).collect();
    let detents = if find_detents { Detents::Find } else { Detents::AsModel };
    let (model, signals) = (&model.0, &signals[..]);
    watched(py, model, || fit_core(signals, model, detents))?.map(PyFit).map_err(input_error)
}

/// Fits a model from values near its best; not `thorough`: to compare, given up where an RMS error `within` is out of reach.
#[pyfunction]
#[pyo3(signature = (data, model, thorough, within=f64::INFINITY))]
pub fn refine(
    py: Python<'_>,
    data: Vec<PyRef<'_, PySignals>>,
    model: &PyModel,
    thorough: bool,
    within: f64,
) -> PyResult<PyFit> {
    let signals: Vec<_> = data.iter().map(|signals| &signals.prepared.signals).collect();
    let (model, signals) = (&model.0, &signals[..]);
    let sketched = || report(signals, model, sketch_within(signals, model, within));
    let work = || if thorough { converge(signals, model) } else { sketched() };
    watched(py, model, work)?.map(PyFit).map_err(input_error)
}

/// The fit with another coupling in the place of a model's own, from where that one ended; None where there is none.
#[pyfunction]
#[pyo3(signature = (data, model, other, progress=None))]
pub fn in_place(
    py: Python<'_>,
    data: Vec<PyRef<'_, PySignals>>,
    model: &PyModel,
    other: String,
    progress: Option<Py<PyAny>>,
) -> PyResult<Option<PyFit>> {
    let other = ids(&[other])?[0];
    let signals: Vec<_> = data.iter().map(|signals| &signals.prepared.signals).collect();
    let (model, signals) = (&model.0, &signals[..]);
    let progress = Progress::of(progress);
    let found = watched(py, model, || in_place_core(signals, model, other, &|share| progress.tell(share)))?;
    progress.raised()?;
    Ok(found.map(PyFit))
}

/// What is implausible about the values of an effect of a fit, a sentence each, beside those that no parameter may
/// have alone. `clipped` says that the torque sensor was seen at its limit, `first` that it is the first that is added.
#[pyfunction]
pub fn implausible(
    data: Vec<PyRef<'_, PySignals>>,
    fit: &PyFit,
    effect: &str,
    clipped: bool,
    first: bool,
) -> PyResult<Vec<String>> {
    let id = own_id(&fit.0.model, effect).map_err(input_error)?;
    let signals: Vec<_> = data.iter().map(|signals| &signals.prepared.signals).collect();
    Ok(implausible_core(&signals, &fit.0, id, clipped, first))
}

/// A candidate as it goes out: effect, fit, gain, parameters, p-value, note.
type CandidateRow = (&'static str, Option<PyFit>, f64, usize, f64, String);

/// Fits each of the effects beside a fitted model, or those `worth` adding; best first. `progress` as of all that takes long.
#[pyfunction]
#[pyo3(signature = (data, model, effects, progress=None, worth=false))]
pub fn diagnose(
    py: Python<'_>,
    data: Vec<PyRef<'_, PySignals>>,
    model: &PyModel,
    effects: Vec<String>,
    progress: Option<Py<PyAny>>,
    worth: bool,
) -> PyResult<Vec<CandidateRow>> {
    let ids = ids(&effects)?;
    let signals: Vec<_> = data.iter().map(|signals| &signals.prepared.signals).collect();
    let (model, signals) = (&model.0, &signals[..]);
    let progress = Progress::of(progress);
    let weigh = if worth { worth_adding } else { diagnose_core };
    let found = watched(py, model, || weigh(signals, model, &ids, &|share| progress.tell(share)))?;
    let found = progress.ended(found)?;
    let row = |c: Candidate| (c.id.info().id, c.fit.map(PyFit), c.gain, c.parameters, c.p_value, c.note);
    Ok(found.into_iter().map(row).collect())
}

/// The pairs of a coupling and another of the `effects` that explain most beside a fitted model: rows of (coupling, other
/// effect, fit), best first.
#[pyfunction]
#[pyo3(signature = (data, model, effects, progress=None))]
pub fn pairs(
    py: Python<'_>,
    data: Vec<PyRef<'_, PySignals>>,
    model: &PyModel,
    effects: Vec<String>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<(&'static str, &'static str, PyFit)>> {
    let ids = ids(&effects)?;
    let signals: Vec<_> = data.iter().map(|signals| &signals.prepared.signals).collect();
    let (model, signals) = (&model.0, &signals[..]);
    let progress = Progress::of(progress);
    let found = watched(py, model, || pairs_core(signals, model, &ids, &|share| progress.tell(share)))?;
    let found = progress.ended(found)?;
    Ok(found.into_iter().map(|p| (p.coupling.info().id, p.companion.info().id, PyFit(p.fit))).collect())
}

/// The sets of up to `most` effects of a pool that explain most beside a fitted model, for their parameters: rows of
/// (effects, fit), best first. The pool has a model for each effect with values near its best.
#[pyfunction]
#[pyo3(signature = (data, model, pool, most, progress=None))]
pub fn sets(
    py: Python<'_>,
    data: Vec<PyRef<'_, PySignals>>,
    model: &PyModel,
    pool: Vec<(String, PyRef<'_, PyModel>)>,
    most: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<(Vec<&'static str>, PyFit)>> {
    let parsed =
        |(effect, from): &(String, PyRef<'_, PyModel>)| Ok((own_id(&from.0, effect)?, from.0.clone()));
    let pool = pool.iter().map(parsed).collect::<knobcore::error::Result<Vec<_>>>().map_err(input_error)?;
    let signals: Vec<_> = data.iter().map(|signals| &signals.prepared.signals).collect();
    let (model, signals) = (&model.0, &signals[..]);
    let progress = Progress::of(progress);
    let found = watched(py, model, || sets_core(signals, model, &pool, most, &|share| progress.tell(share)))?;
    let found = progress.ended(found)?;
    let row = |set: Set| (set.effects.iter().map(|id| id.info().id).collect(), PyFit(set.fit));
    Ok(found.into_iter().map(row).collect())
}
