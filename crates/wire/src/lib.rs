//! Rumbo's bytes: frames, messages, the original's text protocol and its CSV.
