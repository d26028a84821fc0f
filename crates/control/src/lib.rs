//! Rumbo's control core: all decisions of the robot, and no hardware.
//!
//! Bytes, pins and clocks stay outside: the caller passes the time and the latched sensors ([`Inputs`]), and receives
//! the outputs for the wheels, the servo and the sonars ([`Outputs`]). Inside, the flow of one tick is [`estimate`] (of
//! [`speed`], [`odometry`], [`range`]) -> [`mode`], of [`motion`]s -> [`drive`].
//!
//! The same inputs give the same bits on every machine: only `+ - * /`, a correctly rounded square root and
//! the polynomials of [`math`] are used. Nothing here panics, allocates, loops without bound or formats text.
#![no_std]
#![cfg_attr(target_arch = "avr", feature(core_float_math))]

pub mod ahead;
pub mod beside;
pub mod drive;
pub mod estimate;
mod fault;
#[cfg(test)]
mod fixtures;
pub mod math;
pub mod mode;
pub mod motion;
mod numbered;
pub mod odometry;
pub mod params;
pub mod pid;
pub mod policy;
pub mod pursuit;
pub mod range;
pub mod rig;
pub mod speed;
pub mod speed_loop;
pub mod stuck;
pub mod sweep;
pub mod types;
pub mod unrest;
pub mod wall;

pub use types::*;

/// The example of the README is a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
