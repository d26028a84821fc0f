//! Who owns which sources of noise in the simulator, each a base and an index, so that no two share a draw. Those of the
//! plant are lower ([`rumbo_plant::noise::source`]); its spread of parameters begins at 1000.

/// Spikes of sonars; each takes two.
pub(crate) const SPIKES: u32 = 900;
/// Faults of wires; each takes two.
pub(crate) const WIRES: u32 = 920;
/// Voltages of line sensors.
pub(crate) const FLOOR: u32 = 960;
/// Inertial sensors; each takes seven.
pub(crate) const INERTIAL: u32 = 970;
/// Compasses; each takes three.
pub(crate) const COMPASSES: u32 = 100_000;
/// Sensors of distance by light; each takes two.
pub(crate) const DISTANCE: u32 = 200_000;
/// Resistances of light sensors, of the bag and then of each.
pub(crate) const RESISTANCES: u32 = 300_000;
/// Voltages of light sensors.
pub(crate) const LIGHT: u32 = 400_000;
