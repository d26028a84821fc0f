//! Rumbo's station: link, session and web dashboard.
//!
//! A [`Target`] is a robot behind a byte link. A session drives it in its own thread, and turns bytes into signals and
//! commands into bytes; the web side shows the signals in a browser on this machine and passes on what is asked there.
//! [`serve`] joins the two.

mod assets;
mod board;
#[cfg(feature = "foxglove")]
mod bridge;
mod catalogue;
pub mod client;
pub mod commands;
mod console;
mod door;
mod echo;
mod ending;
mod errand;
pub mod fault;
mod guard;
mod guest;
pub mod headless;
mod lease;
pub mod log_file;
mod meter;
mod observer;
pub mod oddity;
mod orders;
mod origin;
mod pace;
pub mod port;
mod recorder;
mod replay;
mod robot_clock;
mod round_trip;
mod serve;
mod session;
mod socket;
mod target;
mod terminal;
mod truth_log;
mod watch;
mod web;
mod words;

#[cfg(feature = "foxglove")]
pub use bridge::{BRIDGE_PORT, Bridge};
pub use console::readable;
pub use echo::Print;
pub use ending::asked_to_end;
pub use guest::{Calibration, GuestLink};
#[cfg(feature = "fuzzing")]
pub use orders::commands_of;
pub use recorder::{Recording, now_utc};
pub use serve::{DEFAULT_PORT, Lab, LabConfig, ServeAt, ServeError, serve, serve_log, serve_with};
pub use session::Extras;
pub use target::{Ghost, LinkNews, Simulation, Standing, Target};
pub use watch::check_baud;
