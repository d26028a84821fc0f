//! The simulated lab: its world, its clock, programs in place of the core.

mod programs;
mod velocity;
mod world;
