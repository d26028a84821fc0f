//! To come: draw.
