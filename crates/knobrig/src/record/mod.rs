//! Recording: what a rig says goes into the wire log as it comes, and into books and figures for those who watch.
//!
//! A [`Session`] takes bytes and gives bytes, and asks nobody for the time. [`serve`] lends it a port and a thread
//! of its own; where there is no such thread, whoever reads the port hands the bytes over. The host and the session
//! meet at a [`Desk`], and neither ever waits there for the other.
mod desk;
mod figures;
#[cfg(target_os = "linux")]
mod serve;
mod session;

pub use desk::{Desk, LogFile};
pub use figures::Figures;
#[cfg(target_os = "linux")]
pub use serve::{Waker, serve};
pub use session::Session;
