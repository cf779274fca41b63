//! What each thread keeps for itself, and what they share. A program without an operating system has one thread.

/// A place of this name that each thread has for itself.
macro_rules! local {
    ($(#[$about:meta])* static $name:ident: $kept:ty = $first:expr;) => {
        #[cfg(feature = "std")]
        std::thread_local! {
            $(#[$about])*
            static $name: core::cell::Cell<$kept> = const { core::cell::Cell::new($first) };
        }
        $(#[$about])*
        #[cfg(not(feature = "std"))]
        static $name: $crate::local::Local<$kept> = $crate::local::Local::new($first);
    };
}
pub(crate) use local;

/// What all threads share; whoever has it is done soon.
pub(crate) struct Shared<T>(Mutex<T>);

#[cfg(feature = "std")]
use std::sync::{Mutex, PoisonError};

#[cfg(not(feature = "std"))]
use spin::Mutex;

impl<T> Shared<T> {
    pub const fn new(first: T) -> Self {
        Self(Mutex::new(first))
    }

    /// Does something with it, alone.
    pub fn with<R>(&self, work: impl FnOnce(&mut T) -> R) -> R {
        #[cfg(feature = "std")]
        let mut shared = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        #[cfg(not(feature = "std"))]
        let mut shared = self.0.lock();
        work(&mut shared)
    }
}

/// As a cell of the one thread's own. An interrupt that meets it while it is taken finds nothing there, and leaves nothing.
#[cfg(not(feature = "std"))]
pub(crate) struct Local<T>(Mutex<T>);

#[cfg(not(feature = "std"))]
impl<T: Default> Local<T> {
    pub const fn new(first: T) -> Self {
        Self(Mutex::new(first))
    }

    pub fn take(&self) -> T {
        self.0.try_lock().map(|mut kept| core::mem::take(&mut *kept)).unwrap_or_default()
    }

    pub fn set(&self, to: T) {
        if let Some(mut kept) = self.0.try_lock() {
            *kept = to;
        }
    }

    pub fn get(&self) -> T
    where
        T: Copy,
    {
        self.0.try_lock().map(|kept| *kept).unwrap_or_default()
    }
}
