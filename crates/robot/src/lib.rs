//! Rumbo's robot: one tick from bytes and edges to duty and telemetry.
