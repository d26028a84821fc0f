//! To come: battery.
