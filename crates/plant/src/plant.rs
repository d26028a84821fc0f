//! To come: plant.
