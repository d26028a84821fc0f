//! Two-cell Li-ion battery: open-circuit voltage falling with the charge drawn, behind an internal resistance.
//!
//! The open-circuit voltage itself is the state. Down to the knee it falls by `PLATEAU_V` per full charge, below
//! the knee about ten times as fast: the shape of an NMC cell's discharge curve in two straight lines.

use crate::params;

/// Fall of the open-circuit voltage per full charge above the knee (two cells: 8.4 V full, 7.0 V at 5 %).
pub(crate) const PLATEAU_V: f64 = 1.45;
/// The same below the knee (7.0 V at 5 %, 6.2 V empty).
pub(crate) const KNEE_FALL_V: f64 = 16.0;
/// Open-circuit voltage at the knee.
pub(crate) const KNEE_V: f64 = 7.0;

/// What does not change: resistance and rate of discharge.
#[derive(Clone, Copy, Debug)]
pub struct Battery {
    start_v: f64,
    pub(crate) resistance_ohm: f64,
    pub(crate) electronics_a: f64,
    pub(crate) per_coulomb: f64,
}

/// State of a [`Battery`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Open-circuit voltage, V.
    pub open_circuit_v: f64,
    /// Current drawn by motors and electronics, A.
    pub current_a: f64,
}

impl Battery {
    /// A battery with these parameters.
    #[must_use]
    pub fn new(params: &params::Battery) -> Self {
        Self {
            start_v: params.open_circuit_v,
            resistance_ohm: params.resistance_ohm,
            electronics_a: params.electronics_a,
            per_coulomb: 1.0 / (params.capacity_ah * 3600.0),
        }
    }

    /// The state at the start of a run, motors at rest.
    #[must_use]
    pub fn start(&self) -> State {
        State {
            open_circuit_v: self.start_v,
            current_a: self.electronics_a,
        }
    }

    /// Voltage at the terminals under the present current, V; never below zero.
    #[must_use]
    pub fn terminal_v(&self, state: &State) -> f64 {
        let terminal_v = state.open_circuit_v - self.resistance_ohm * state.current_a;
        if terminal_v > 0.0 { terminal_v } else { 0.0 }
    }

    /// Draws `motors_a` (negative: fed back) besides the electronics for `dt_s`.
    pub fn draw(&self, state: &mut State, motors_a: f64, dt_s: f64) {
        state.current_a = motors_a + self.electronics_a;
        let fall_v = if state.open_circuit_v > KNEE_V {
            PLATEAU_V
        } else {
            KNEE_FALL_V
        };
        state.open_circuit_v -= state.current_a * dt_s * self.per_coulomb * fall_v;
        if state.open_circuit_v < 0.0 {
            state.open_circuit_v = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_terminals_sag_under_load_and_recover() {
        let battery = Battery::new(&params::Battery {
            open_circuit_v: 7.4,
            resistance_ohm: 0.2,
            ..Default::default()
        });
        let mut state = battery.start();
        battery.draw(&mut state, 2.0, 0.001);
        let sag_v = 7.4 - battery.terminal_v(&state);
        assert!(
            (0.42..0.44).contains(&sag_v),
            "2.15 A through 0.2 ohm: {sag_v}"
        );
        battery.draw(&mut state, 0.0, 0.001);
        assert!(battery.terminal_v(&state) > 7.36);
    }

    #[test]
    fn two_hours_at_one_ampere_empty_most_of_it_and_the_end_comes_fast() {
        let battery = Battery::new(&params::Battery {
            open_circuit_v: 8.4,
            electronics_a: 0.0,
            ..Default::default()
        });
        let mut state = battery.start();
        let mut hours_to = |volts: f64| {
            let mut hours = 0.0;
            while state.open_circuit_v > volts {
                battery.draw(&mut state, 1.0, 1.0);
                hours += 1.0 / 3600.0;
            }
            hours
        };
        let to_knee = hours_to(7.0);
        let beyond = hours_to(6.2);
        assert!((2.4..2.6).contains(&to_knee), "{to_knee} h");
        assert!(beyond < 0.2, "{beyond} h");
    }
}
