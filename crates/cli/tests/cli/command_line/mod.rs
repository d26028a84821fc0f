//! The command's output, its stream, and its exit status.

#![allow(clippy::unwrap_used, clippy::panic)]

mod bus_sensors;
mod check;
mod devices;
mod import;
mod information;
mod kits;
mod lights;
mod observe;
mod obstacles;
mod run;
mod sketch;
mod sonars;
mod wrong_input;
