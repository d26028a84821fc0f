//! Rumbo's control core: maths, estimators, controllers, modes, parameters. No I/O, no clock, no allocation.
