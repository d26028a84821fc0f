//! Drawings that are no diagrams of values: control schemes, wirings, rigs, state machines, geometry. All inline SVG,
//! coloured by the page. What depends on no data is a file of the content (`file`); the rest is computed.

pub(crate) mod file;
pub(crate) mod machine;
pub(crate) mod rig;
pub(crate) mod scheme;
mod sketch;
pub(crate) mod wiring;
