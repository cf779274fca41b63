//! Effects of the user's own: registered while the program runs, called over whole columns.

use super::formula::Formula;
use super::law::{LEAST, Law, NARROW, Stated};
use super::{Id, Info, Joint, Place};
use crate::error::{Error, Result};
use crate::local::{Shared, local};
use crate::motion::{Channel, Motion};
use crate::param::{Kind, Param};
use crate::prelude::*;
use alloc::collections::BTreeMap;
use core::cmp::Ordering;
use core::hash::{Hash, Hasher};
use core::sync::atomic::{AtomicUsize, Ordering as Memory};

/// A law of a user's own: the values of its parameters, and columns of one length.
///
/// A load gets t, theta, omega, alpha and forward and answers a torque at each sample, N m, or, where it touches the
/// level of friction, a factor on the dry friction. A sensor gets the torque as a sixth column and answers what it
/// reads. A joint gets no column and answers gap, stiffness, damping and share, and 1 where shaft and knob hold on to
/// each other, else 0.
pub type Function = Box<dyn Fn(&[f64], &[&[f64]]) -> core::result::Result<Vec<f64>, String> + Send + Sync>;

/// What an effect of a user's own does.
pub enum Does {
    /// A function of theirs is called.
    Call(Function),
    /// A formula is worked out.
    Formula(Stated),
}

/// An effect that a user registered. It lives as long as the program, and is one with itself alone.
pub struct User {
    /// Its row of the catalogue.
    pub info: &'static Info,
    /// Whether its torque depends on earlier samples; it is then given whole stretches.
    pub remembers: bool,
    /// Parameter values to start a search from; none for the neutral ones.
    pub starts: Vec<Vec<f64>>,
    /// Its law.
    pub does: Does,
    order: usize,
}

/// Step of central differences as a share of the parameter, of its scale where it is nought. What is linear may go all the way.
const STEP: f64 = 1e-5;
local! {
    /// What went wrong on this thread, by the order of the effect: two fits at a time do not see each other's.
    static FAILURES: BTreeMap<usize, String> = BTreeMap::new();
}

fn failures<R>(work: impl FnOnce(&mut BTreeMap<usize, String>) -> R) -> R {
    let mut failures = FAILURES.take();
    let done = work(&mut failures);
    FAILURES.set(failures);
    done
}

static ORDER: AtomicUsize = AtomicUsize::new(0);
static VERSION: AtomicUsize = AtomicUsize::new(0);
static REGISTERED: Shared<Vec<&'static User>> = Shared::new(Vec::new());

/// All that are registered.
pub(super) fn all() -> impl Iterator<Item = &'static User> {
    REGISTERED.with(|registered| registered.clone()).into_iter()
}

/// A number that grows whenever an effect enters the catalogue or leaves it.
pub fn version() -> usize {
    VERSION.load(Memory::Acquire)
}

impl User {
    /// Registers an effect; one of the same name is replaced for models that are made from now on.
    ///
    /// # Errors
    /// A name of the built-in catalogue; bounds, neutral values or starts that contradict each other.
    pub fn register(info: Info, remembers: bool, starts: Vec<Vec<f64>>, does: Does) -> Result<&'static Self> {
        let user = Self::made(Box::leak(Box::new(info)), remembers, starts, does)?;
        user.enter();
        Ok(user)
    }

    /// An effect that the catalogue does not have: only models that are given it do.
    ///
    /// # Errors
    /// As of [`User::register`].
    pub(super) fn made(
        info: &'static Info,
        remembers: bool,
        starts: Vec<Vec<f64>>,
        does: Does,
    ) -> Result<&'static Self> {
        if Id::BUILT_IN.iter().any(|own| own.info().id == info.id) {
            let why = "is built in already; choose another name";
            return Err(Error::invalid(format!("effect '{}'", info.id), why));
        }
        check(info, &starts)?;
        let order = ORDER.fetch_add(1, Memory::Relaxed);
        Ok(Box::leak(Box::new(Self { info, remembers, starts, does, order })))
    }

    /// Takes it into the catalogue, in place of what has its name there.
    pub(super) fn enter(&'static self) {
        REGISTERED.with(|registered| {
            registered.retain(|other| other.info.id != self.info.id);
            registered.push(self);
        });
        VERSION.fetch_add(1, Memory::Release);
    }

    /// How the chain meets it.
    pub(super) fn law(&'static self) -> &'static dyn Law {
        match &self.does {
            Does::Call(_) => self,
            Does::Formula(law) => law,
        }
    }

    /// The formula that it is written as, if it is.
    pub fn formula(&self) -> Option<&Formula> {
        match &self.does {
            Does::Formula(stated) => Some(&stated.law),
            Does::Call(_) => None,
        }
    }

    /// Takes an effect out of the catalogue; models that have it keep it. Whether it was there.
    pub fn forget(id: &str) -> bool {
        let named = |user: &&Self| user.info.id == id;
        let was = REGISTERED.with(|all| all.iter().position(named).map(|at| all.remove(at)));
        VERSION.fetch_add(1, Memory::Release);
        was.is_some()
    }

    /// What went wrong on this thread since this was last asked on it.
    pub fn failure(&self) -> Option<String> {
        match &self.does {
            Does::Formula(stated) => stated.failure(),
            Does::Call(_) => failures(|failures| failures.remove(&self.order)),
        }
    }

    fn fail(&self, p: &[f64], why: &str) {
        let why = format!("{why} (with {}); mend its function, or {NARROW}", self.info.with_values(p));
        failures(|failures| _ = failures.entry(self.order).or_insert(why));
    }

    /// What it answers over columns, and what it then stands for where it fails: nothing, which
    /// [`User::failure`] tells. That parameters are no numbers is no failure of the law.
    pub fn over(&self, p: &[f64], columns: &[&[f64]]) -> Vec<f64> {
        let samples = columns.first().map_or(0, |column| column.len());
        if !p.iter().all(|x| x.is_finite()) {
            return vec![f64::NAN; samples];
        }
        let Does::Call(function) = &self.does else { return vec![0.0; samples] };
        let checked = function(p, columns).and_then(|own| {
            if own.len() != samples {
                return Err(format!("returned {} values for {samples} samples", own.len()));
            }
            match own.iter().position(|x| !x.is_finite()) {
                Some(at) => Err(format!(
                    "returned {} at theta = {}, omega = {}",
                    own[at], columns[1][at], columns[2][at]
                )),
                None => Ok(own),
            }
        });
        let factor = self.info.touches.contains(&Channel::FrictionScale);
        match checked {
            Ok(own) if factor => own.into_iter().map(|x| x.max(LEAST)).collect(),
            Ok(own) => own,
            Err(why) => {
                self.fail(p, &why);
                // A sensor that fails reads what there is.
                columns.get(5).map_or(vec![f64::from(u8::from(factor)); samples], |tau| tau.to_vec())
            }
        }
    }

    /// The joint that it makes between shaft and knob, if it is one.
    pub(super) fn joined(&self, p: &[f64]) -> Option<Joint<f64>> {
        if self.info.place != Place::Coupling {
            return None;
        }
        let rigid = Joint { gap: 0.0, stiffness: 1e5, damping: 1e2, share: 0.5, welded: true };
        let Does::Call(function) = &self.does else { return None };
        let answer = function(p, &[]);
        let joint = answer.as_deref().map(|values| match values {
            &[gap, stiffness, damping, share, welded] => {
                Some(Joint { gap, stiffness, damping, share, welded: welded > 0.5 })
            }
            _ => None,
        });
        let sound = |j: &Joint<f64>| {
            let sizes = j.gap >= 0.0 && j.stiffness > 0.0 && j.damping >= 0.0 && j.share > 0.0;
            sizes && j.share <= 1.0 && (j.gap + j.stiffness + j.damping).is_finite()
        };
        match joint {
            Ok(Some(joint)) if sound(&joint) => Some(joint),
            Ok(Some(joint)) => {
                let why = "a joint has gap and damping from 0 on, stiffness above 0, and a share of the inertia \
                           above 0 and up to 1";
                self.fail(p, &format!("returned {joint:?}; {why}"));
                Some(rigid)
            }
            Ok(None) => {
                self.fail(p, "returned no joint");
                Some(rigid)
            }
            Err(why) => {
                self.fail(p, why);
                Some(rigid)
            }
        }
    }

    /// Parameter `i` a step below and above, each with all values.
    pub(super) fn beside(&self, p: &[f64], i: usize) -> [(f64, Vec<f64>); 2] {
        let param = &self.info.params[i];
        let share = if param.kind == Kind::Linear { 1.0 } else { STEP };
        let step = share * if p[i] == 0.0 { param.scale() } else { p[i].abs() };
        [-step, step].map(|by| {
            let mut p = p.to_vec();
            p[i] = (p[i] + by).clamp(param.lower, param.upper);
            (p[i], p)
        })
    }

    /// The derivative of what it answers by parameter `i` over columns, by central differences.
    pub fn slope(&self, p: &[f64], i: usize, columns: &[&[f64]]) -> Vec<f64> {
        let [(below, low), (above, high)] = self.beside(p, i).map(|(x, p)| (x, self.over(&p, columns)));
        high.iter().zip(low).map(|(high, low)| (high - low) / (above - below)).collect()
    }

    /// What it answers at one instant, which an effect that remembers does not have.
    pub fn at(&self, p: &[f64], motion: &Motion<f64>) -> f64 {
        if self.remembers {
            self.fail(p, "remembers, so it has no torque at one instant, which a simulated motion needs");
            return f64::from(u8::from(self.info.touches.contains(&Channel::FrictionScale)));
        }
        let Motion { t, theta, omega, alpha, forward } = motion;
        let columns = [t, theta, omega, alpha, forward].map(core::slice::from_ref);
        self.over(p, &columns).first().copied().unwrap_or(0.0)
    }
}

/// Bounds, neutral values and starts of every parameter must agree with each other.
fn check(info: &Info, starts: &[Vec<f64>]) -> Result<()> {
    let bad = |param: &Param, why: String| {
        Err(Error::invalid(format!("parameter '{}.{}'", info.id, param.name), why))
    };
    for (i, param) in info.params.iter().enumerate() {
        let Param { lower, upper, neutral, .. } = *param;
        let within = |x: f64| x.is_finite() && (lower..=upper).contains(&x);
        if lower.is_nan() || upper.is_nan() || lower >= upper {
            return bad(
                param,
                format!("has the bounds [{lower}, {upper}]; the lower must be below the upper"),
            );
        }
        if !within(neutral) {
            return bad(
                param,
                format!(
                    "is neutral at {neutral}, outside of its bounds [{lower}, {upper}]; change one of them"
                ),
            );
        }
        if let Some(start) = starts.iter().find(|start| !start.get(i).is_some_and(|x| within(*x))) {
            return bad(
                param,
                format!("starts at {:?}, which must be within [{lower}, {upper}]", start.get(i)),
            );
        }
    }
    Ok(())
}

impl core::fmt::Debug for User {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_tuple("User").field(&self.info.id).finish()
    }
}

impl PartialEq for User {
    fn eq(&self, other: &Self) -> bool {
        core::ptr::eq(self, other)
    }
}
impl Eq for User {}
impl Hash for User {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.order.hash(state);
    }
}
impl PartialOrd for User {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for User {
    fn cmp(&self, other: &Self) -> Ordering {
        self.order.cmp(&other.order)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{Place, Survey};
    use crate::param::Unit;

    fn drag(id: &'static str, law: fn(f64, f64) -> f64) -> &'static User {
        const PARAMS: &[Param] = &[Param::linear("d", Unit::of(1, -2, 2), "drag")];
        let torque: Function = Box::new(move |p, m| Ok(m[2].iter().map(|omega| law(p[0], *omega)).collect()));
        User::register(info(id, PARAMS), false, Vec::new(), Does::Call(torque)).unwrap()
    }

    fn info(id: &'static str, params: &'static [Param]) -> Info {
        let built_in = Id::QuadraticDrag.info();
        Info { id, place: Place::Load, law: "", source: "", shows: "", params, ..*built_in }
    }

    const MOTION: [&[f64]; 5] = [&[0.0, 1.0], &[0.0, 0.5], &[-2.0, 3.0], &[0.0, 0.0], &[0.0, 1.0]];

    #[test]
    fn a_registered_effect_is_found_by_name_until_it_is_forgotten() {
        let user = drag("found_drag", |d, omega| d * omega * omega.abs());
        assert_eq!(Id::parse("found_drag").unwrap(), Id::User(user));
        let replaced = drag("found_drag", |d, omega| d * omega);
        assert_eq!(Id::parse("found_drag").unwrap(), Id::User(replaced));
        assert!(User::forget("found_drag") && !User::forget("found_drag"));
        assert!(Id::parse("found_drag").unwrap_err().to_string().contains("found_drag"));
    }

    #[test]
    fn effects_stand_in_the_order_in_which_they_were_registered() {
        let [first, second] = ["first_drag", "second_drag"].map(|id| drag(id, |d, omega| d * omega));
        assert!(first < second);
    }

    #[test]
    fn the_derivative_by_a_linear_parameter_is_exact() {
        let user = drag("exact_drag", |d, omega| d * omega * omega.abs());
        assert_eq!(user.over(&[2.0], &MOTION), [-8.0, 18.0]);
        assert_eq!(user.slope(&[2.0], 0, &MOTION), [-4.0, 9.0]);
    }

    #[test]
    fn a_law_that_fails_is_silent_and_says_so_once() {
        let user = drag("broken_drag", |d, omega| (d * omega).sqrt());
        assert_eq!(user.over(&[2.0], &MOTION), [0.0, 0.0]);
        let why = user.failure().unwrap();
        assert!(why.contains("NaN at theta = 0, omega = -2") && why.contains("d = 2"), "{why}");
        assert_eq!(user.failure(), None);
    }

    #[test]
    fn a_search_starts_where_the_user_said_or_else_at_the_neutral_values() {
        const SHAPES: &[Param] = &[Param::shape("c", Unit::of(0, 1, 0), [-3.0, 3.0], 0.5, "centre")];
        let survey = Survey {
            theta: vec![0.0, 1.0],
            speed: vec![0.0, 1.0],
            torque: vec![0.0, 1.0],
            duration_s: 1.0,
            rate_hz: 1000.0,
            inertia: 1e-4,
            friction: [0.01; 2],
            revolution: Some(1.0),
            waves: None,
        };
        for (starts, expected) in
            [(vec![], vec![vec![0.5]]), (vec![vec![-2.0], vec![2.0]], vec![vec![-2.0], vec![2.0]])]
        {
            let torque: Function = Box::new(|_, m| Ok(m[0].to_vec()));
            let user = User::register(info("started", SHAPES), false, starts, Does::Call(torque)).unwrap();
            assert_eq!(Id::User(user).law().starts(&survey), expected);
        }
    }

    #[test]
    fn what_contradicts_itself_is_refused_by_name() {
        const SHAPE: Param = Param::shape("w", Unit::NUMBER, [1.0, 2.0], 1.5, "width");
        const TURNED: &[Param] = &[Param { lower: 3.0, ..SHAPE }];
        const OUTSIDE: &[Param] = &[Param { neutral: 0.0, ..SHAPE }];
        for (id, params, starts, said) in [
            ("viscous", &[SHAPE][..], vec![], "built in"),
            ("own", TURNED, vec![], "own.w"),
            ("own", OUTSIDE, vec![], "neutral at 0"),
            ("own", &[SHAPE], vec![vec![9.0]], "9"),
            ("own", &[SHAPE], vec![vec![]], "own.w"),
        ] {
            let torque: Function = Box::new(|_, m| Ok(m[0].to_vec()));
            let error =
                User::register(info(id, params), false, starts, Does::Call(torque)).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
