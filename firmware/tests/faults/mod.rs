//! Failures while the shipped image drives: each ends stopped or in the degraded mode named in docs/faults.md, with its
//! cause reported, and without touching anything.

pub(crate) mod drive;
mod link;
mod modes;
mod restart;
mod sensors;
mod values;
