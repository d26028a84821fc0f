//! To come: encoder.
