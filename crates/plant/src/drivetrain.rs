//! To come: drivetrain.
