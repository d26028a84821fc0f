//! To come: servo.
