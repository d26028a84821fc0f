//! Rumbo's station: ports, threads and the web dashboard around a session.
//!
//! A thread advances a [`Target`](rumbo_session::Target) and drives the session with it; the web side shows its events
//! in a browser on this machine and passes on what is asked there. [`serve`] joins the two.

mod assets;
mod board;
mod door;
mod echo;
mod ending;
mod error;
mod folder;
mod guard;
pub mod headless;
mod lease;
pub mod log_file;
mod order_sender;
pub mod port;
mod recorder;
mod recordings;
mod replay;
mod serve;
mod session;
mod socket;
mod subscribers;
mod tuning;
mod web;
mod wired;

pub use rumbo_session::Extras;

pub use echo::Print;
pub use ending::asked_to_end;
pub use error::{ServeError, SessionError};
pub use folder::{Folder, serve_folder};
pub use recorder::{RecordingSetting, now_utc, today_utc};
pub use serve::{
    Addresses, DEFAULT_PORT, Lab, LabConfig, Named, ServeAt, serve, serve_all, serve_log,
};
pub use tuning::{NotTuned, Tuner};
pub use wired::Answer;
