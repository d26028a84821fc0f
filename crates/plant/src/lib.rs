//! Rumbo's plant: 2-D physics of the robot, its sensors and its world.
//!
//! ```text
//! bridge, servo, trigger ──► drivetrain ──► contact ──► pose ──► sonars ──► edges and echoes, at their microsecond
//!                               ▲              ▲                    ▲
//!                            battery         world           world, noise
//! ```
//!
//! [`plant::Plant`] holds what does not change during a run (parameters, rig, world, noise), [`plant::State`]
//! holds plain `Copy` numbers. All arithmetic is `f64` with `+ - * /`, `sqrt` and the `libm` crate, and all
//! randomness is a function of (seed, robot, source, step): the same seed gives the same run, bit for bit, on every
//! machine and for any number of threads.
//!
//! Frames follow REP 103: x forward, y left, headings counter-clockwise; SI units.

pub mod battery;
pub mod cone;
pub mod contact;
pub mod draw;
pub mod drivetrain;
pub mod encoder;
pub mod event;
pub mod link;
pub mod moving;
pub mod noise;
mod outline;
pub mod params;
pub mod plant;
mod rest;
pub mod rewrite;
pub mod rig;
pub mod servo;
pub mod sonar;
pub mod world;

/// The example of the README is a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
