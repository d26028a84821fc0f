//! The plant and its sensors, one by one and in lanes.

mod cone;
mod lanes;
mod moving;
mod plant;
mod sonar;
