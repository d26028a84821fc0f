//! Rumbo's session with a robot: time and bytes come in, events and bytes to send go out.
//!
//! A [`Session`] knows no port, thread, clock or socket. Its [`SessionDriver`] advances the [`Target`], hands over the bytes
//! received, sends the outgoing ones, and publishes the [`Event`]s: to the page's [`Board`], to a log, to a bridge,
//! each of which takes what it needs. The program around the driver, its [`Host`], has the clock and the threads. A
//! [`Replay`] gives the same events of a log.

mod ahead;
pub mod anomaly;
mod board;
mod catalogue;
pub mod client;
pub mod commands;
mod console;
mod driver;
mod error;
mod event;
pub mod explain;
pub mod fault;
mod guest;
pub mod headless;
mod lease;
mod meter;
mod observer;
mod orders;
mod origin;
mod pace;
mod page;
mod printed;
mod program;
mod replay;
mod robot_clock;
mod round_trip;
mod session;
mod target;
mod task;
mod terminal;
mod truth_log;
mod watch;
mod words;
mod world;

pub use board::{Arrival, Board, Cursor, EVENTS_KEPT, News, SAMPLES_KEPT};
pub use catalogue::ModeEntry;
pub use console::{ConsoleText, LINK_CONSOLE, PARTS_CONSOLE, readable};
pub use driver::{Calibration, Extras, Host, SessionDriver};
pub use error::{CalibrationError, TargetError};
pub use event::Event;
pub use guest::Guest;
pub use lease::{ControlView, Lease, PageId, Seat};
pub use orders::{BadOrder, MAX_ORDER, MAX_SPEED, Order, SHORT_ORDER, WORLD_ORDER, stop_first};
pub use pace::{Pace, SLICE_US};
pub use page::{LinkBytes, ReadingGroup, ToPage};
pub use printed::plotter_row;
pub use program::{GivenProgram, ShownSketch, SketchFile};
pub use replay::Replay;
pub use session::{Ask, Going, Now, Session, TargetView};
pub use target::{Abilities, About, Ghost, LinkNews, Shown, Standing, Target};
pub use watch::{BaudTooLow, DEFAULT_BAUD, check_baud};
pub use world::{EditedWorld, WorldAct, WorldOrder};
