//! The toy robot of the session's tests.

#[path = "../../../session/tests/support/mod.rs"]
mod toy;

pub(crate) use toy::Toy;
