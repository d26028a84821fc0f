//! Sketches of others: compiled in a sandbox.

mod compile;
mod hostile;
