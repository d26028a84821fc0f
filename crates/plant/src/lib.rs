//! Rumbo's plant: 2-D physics of the robot, its sensors and its world.
