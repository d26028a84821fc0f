//! To come: world.
