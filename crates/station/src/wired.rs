//! What a page asks of the robot that it wires.

use serde_json::Value;

/// Answers what a page asks.
pub type Answer = fn(&Value) -> Value;
