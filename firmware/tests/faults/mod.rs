//! What fails, fails while the shipped image drives: each ends stopped or in the degraded mode that docs/faults.md names, with its
//! cause told, and without touching anything.

pub(crate) mod drive;
mod link;
mod modes;
mod restart;
mod sensors;
mod values;
