//! A session in a browser as one object that a worker drives, `web/lab/worker.js`: with a simulated robot, the [`Lab`],
//! or with a real one at a serial port, the [`Robot`].
//!
//! The worker hands in the page's orders, advances the session by the browser's clock in bounded rounds, and posts its
//! messages to the page: those of the station's WebSocket.

mod desk;
mod drive;
#[cfg(target_family = "wasm")]
pub mod exports;
mod flasher;
mod following;
mod lab;
mod recording;
mod robot;
mod serial_port;
mod showing;
mod start;

pub use flasher::programmer;
pub use lab::{Lab, Shared};
pub use robot::Robot;
pub use showing::Showing;
pub use start::Start;
