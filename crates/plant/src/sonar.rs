//! To come: sonar.
