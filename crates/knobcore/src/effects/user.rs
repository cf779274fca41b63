//! Effects of the user's own: registered while the program runs, called over whole columns.

use super::Info;
use crate::motion::Motion;
use crate::scalar::Scalar;
use std::cmp::Ordering;
use std::hash::{Hash, Hasher};
use std::sync::{Mutex, PoisonError, RwLock};

/// Torque over a motion: parameters, then t, theta, omega, alpha and forward, all of one length; N m.
pub type Torque = Box<dyn Fn(&[f64], [&[f64]; 5]) -> Result<Vec<f64>, String> + Send + Sync>;

/// An effect that a user registered. It lives as long as the program, and is one with itself alone.
pub struct User {
    /// Its row of the catalogue.
    pub info: Info,
    /// Whether its torque depends on earlier samples; it is then given whole stretches.
    pub remembers: bool,
    /// Its law.
    pub torque: Torque,
    order: usize,
    failure: Mutex<Option<String>>,
}

/// Step of central differences as a share of the parameter, or of its scale.
const STEP: f64 = 1e-5;

static REGISTERED: RwLock<Vec<&'static User>> = RwLock::new(Vec::new());

/// All that are registered.
pub(super) fn all() -> impl Iterator<Item = &'static User> {
    REGISTERED.read().unwrap_or_else(PoisonError::into_inner).clone().into_iter()
}

impl User {
    /// Registers an effect; one of the same name is replaced for models that are made from now on.
    pub fn register(info: Info, remembers: bool, torque: Torque) -> &'static Self {
        let mut registered = REGISTERED.write().unwrap_or_else(PoisonError::into_inner);
        let order = registered.iter().map(|user| user.order + 1).max().unwrap_or(0);
        let user: &'static Self =
            Box::leak(Box::new(Self { info, remembers, torque, order, failure: Mutex::new(None) }));
        registered.retain(|other| other.info.id != info.id);
        registered.push(user);
        user
    }

    /// Takes an effect out of the catalogue; models that have it keep it. Whether it was there.
    pub fn forget(id: &str) -> bool {
        let mut registered = REGISTERED.write().unwrap_or_else(PoisonError::into_inner);
        let before = registered.len();
        registered.retain(|user| user.info.id != id);
        registered.len() < before
    }

    /// What went wrong since this was last asked.
    pub fn failure(&self) -> Option<String> {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// The torque over columns; zero where the law fails, which [`User::failure`] then tells.
    pub(super) fn over(&self, p: &[f64], motion: [&[f64]; 5]) -> Vec<f64> {
        let samples = motion[0].len();
        let checked = (self.torque)(p, motion).and_then(|tau| {
            if tau.len() != samples {
                return Err(format!("returned {} values for {samples} samples", tau.len()));
            }
            match tau.iter().position(|x| !x.is_finite()) {
                Some(at) => Err(format!(
                    "returned {} at theta = {}, omega = {} with parameters {p:?}",
                    tau[at], motion[1][at], motion[2][at]
                )),
                None => Ok(tau),
            }
        });
        checked.unwrap_or_else(|why| {
            self.failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(why);
            vec![0.0; samples]
        })
    }

    /// The derivative of the torque by parameter `i` over columns, by central differences.
    pub(super) fn slope(&self, p: &[f64], i: usize, motion: [&[f64]; 5]) -> Vec<f64> {
        let Some(param) = self.info.params.get(i) else { return Vec::new() };
        let step = STEP * p[i].abs().max(param.scale());
        let at = |value: f64| {
            let mut p = p.to_vec();
            p[i] = value.clamp(param.lower, param.upper);
            (p[i], self.over(&p, motion))
        };
        let ((below, low), (above, high)) = (at(p[i] - step), at(p[i] + step));
        high.iter().zip(low).map(|(high, low)| (high - low) / (above - below)).collect()
    }

    /// The torque at one instant.
    pub(super) fn at<T: Scalar>(&self, p: &[T], motion: &Motion<T>) -> T {
        let mut arguments = p.to_vec();
        arguments.extend([motion.t, motion.theta, motion.omega, motion.alpha, motion.forward]);
        let split = p.len();
        T::foreign(&arguments, &|x| {
            let (p, m) = x.split_at(split);
            let columns = [&m[0..1], &m[1..2], &m[2..3], &m[3..4], &m[4..5]];
            self.over(p, columns).first().copied().unwrap_or(0.0)
        })
    }
}

impl std::fmt::Debug for User {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("User").field(&self.info.id).finish()
    }
}

impl PartialEq for User {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
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
