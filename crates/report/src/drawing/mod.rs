//! Drawings that are no diagrams of values, all inline SVG, coloured by the page. Control schemes, state machines and
//! geometry are files of the content (`file`); rigs and wirings are computed from the robot.

pub(crate) mod file;
pub(crate) mod rig;
mod sketch;
pub(crate) mod wiring;
