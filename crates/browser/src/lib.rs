//! The lab in a browser: a simulated robot and its session as one object that a worker drives, `web/lab/worker.js`.
//!
//! The worker hands in the page's orders, advances the [`Lab`] by the browser's clock in bounded rounds, and posts its
//! messages to the page: those of the station's WebSocket.

mod drive;
#[cfg(target_family = "wasm")]
pub mod exports;
mod following;
mod lab;
mod recording;
mod showing;

pub use lab::{Lab, Shared, Start};
pub use showing::Showing;
