//! Range finders that nobody triggers: LV-MaxSonar-EZ1, which measures by itself as long as its RX is open or high.
//!
//! ```text
//! each 49 ms: burst ──► PW rises ──147 us an inch──► PW falls (37.5 ms without an echo) ... 44.3 ms: AN has its voltage
//! ```
//!
//! Ranges are whole inches from 6 on; what is nearer is 6 inches away. The sensor is not identified from recordings: periods,
//! scales and ranges are those of its data sheet (MaxBotix PD11832), the beam is about what that shows of a board. Which
//! slanted walls mirror the sound away is known of the robot's other sonars.

use rumbo_plant::cone::{self, Cone, Hearing};
use rumbo_plant::contact::Pose;
use rumbo_plant::params;
use rumbo_plant::world::World;
use std::collections::VecDeque;

const INCH_M: f64 = 0.0254;
/// Nearest and farthest range \[inches\].
const INCHES: [f64; 2] = [6.0, 254.0];
/// Half of the beam \[rad\].
const BEAM_RAD: f64 = 0.35;
/// From one measurement to the next \[us\].
const PERIOD_US: u64 = 49_000;
/// Thirteen waves of 42 kHz \[us\].
const BURST_US: u64 = 310;
/// How long PW is high by range, and without an echo \[us\].
const INCH_US: f64 = 147.0;
const LONGEST_US: u64 = 37_500;
/// The voltage has its level, before serial data of 4.7 ms \[us\].
const SETTLED_US: u64 = PERIOD_US - 4_700;
/// The voltage by range \[V\]: Vcc / 512.
const INCH_V: f64 = 5.0 / 512.0;

/// A range finder that measures by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct MaxSonar {
    /// What the robot file calls it.
    pub name: String,
    /// Where it is on the robot, ahead of the wheels' axis and to the left \[m\].
    pub at_m: [f64; 2],
    /// Where it looks, counter-clockwise from ahead \[rad\].
    pub angle_rad: f64,
    /// The board's pin.
    pub pin: u8,
    /// That is on AN, a voltage, and not on PW, a pulse.
    pub analogue: bool,
    /// The board's pin at RX, which stops it while it is low.
    pub rx: Option<u8>,
}

impl MaxSonar {
    /// The range that it measures from this pose \[inches\]; `None` without an echo.
    fn measure(
        &self,
        world: &World,
        pose: &Pose,
        now_us: u64,
        sound: &params::Sonar,
    ) -> Option<f64> {
        let cone = Cone {
            apex: pose.place(self.at_m),
            axis_rad: pose.heading_rad + self.angle_rad,
            half_angle_rad: BEAM_RAD,
        };
        let [nearest, farthest] = INCHES;
        let hearing = Hearing {
            reach_m: farthest * INCH_M,
            incidence_limit_rad: sound.incidence_limit_rad,
            corner_reach_m: sound.corner_reach_m,
        };
        let found = cone::nearest(world, now_us, &cone, &hearing)?;
        Some(libm::round(found.range_m / INCH_M).max(nearest))
    }
}

/// What a range finder does.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ranging {
    /// It measures again then \[us\].
    next_us: u64,
    /// The range that it measured last \[m\]; infinite without an echo.
    pub(crate) range_m: f64,
    /// Edges of PW to come, and when \[us\].
    edges: VecDeque<(u64, bool)>,
    /// The voltage to come at AN \[V\], and when \[us\].
    voltage: Option<(u64, f64)>,
}

impl Ranging {
    /// Measures where it is time for it and RX lets it.
    pub(crate) fn range(
        &mut self,
        sensor: &MaxSonar,
        held: bool,
        now_us: u64,
        (world, pose, sound): (&World, &Pose, &params::Sonar),
    ) {
        if held || now_us < self.next_us {
            return;
        }
        let inches = sensor.measure(world, pose, now_us, sound);
        let rise_us = now_us + BURST_US;
        let high_us = inches.map_or(LONGEST_US, |inches| (INCH_US * inches) as u64);
        self.edges = VecDeque::from([(rise_us, true), (rise_us + high_us.min(LONGEST_US), false)]);
        // Its first voltage is there from before.
        let settled_us = if self.next_us == 0 {
            now_us
        } else {
            now_us + SETTLED_US
        };
        self.voltage = Some((settled_us, INCH_V * inches.unwrap_or(INCHES[1])));
        self.range_m = inches.map_or(f64::INFINITY, |inches| inches * INCH_M);
        self.next_us = now_us + PERIOD_US;
    }

    /// The next edge of PW before a time.
    pub(crate) fn edge(&mut self, before_us: u64) -> Option<(u64, bool)> {
        let due = *self.edges.front()?;
        (due.0 < before_us).then(|| self.edges.pop_front())?
    }

    /// The voltage that AN has from now on, where that is another one.
    pub(crate) fn voltage(&mut self, now_us: u64) -> Option<f64> {
        let (at_us, volts) = self.voltage?;
        if at_us > now_us {
            return None;
        }
        self.voltage = None;
        Some(volts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_plant::world::Wall;

    const FRONT: MaxSonar = MaxSonar {
        name: String::new(),
        at_m: [0.1, 0.0],
        angle_rad: 0.0,
        pin: 7,
        analogue: false,
        rx: None,
    };

    /// Pulses and voltages within a time, of a wall so far ahead of the sensor.
    fn seen(wall_m: f64, until_us: u64, held: impl Fn(u64) -> bool) -> (Vec<u64>, Vec<(u64, f64)>) {
        let x_m = FRONT.at_m[0] + wall_m;
        let wall = Wall {
            from_m: [x_m, -1.0],
            to_m: [x_m, 1.0],
            thickness_m: 0.0,
        };
        let world = World::new(&[wall], &[]).unwrap();
        let (pose, sound) = (Pose::default(), params::Sonar::default());
        let (mut ranging, mut rise_us) = (Ranging::default(), 0);
        let (mut pulses, mut volts) = (Vec::new(), Vec::new());
        for now_us in (0..until_us).step_by(1_000) {
            ranging.range(&FRONT, held(now_us), now_us, (&world, &pose, &sound));
            while let Some((at_us, level)) = ranging.edge(now_us + 1_000) {
                assert!((now_us..now_us + 1_000).contains(&at_us));
                match level {
                    true => rise_us = at_us,
                    false => pulses.push(at_us - rise_us),
                }
            }
            volts.extend(ranging.voltage(now_us).map(|volts| (now_us, volts)));
        }
        (pulses, volts)
    }

    #[test]
    fn a_pulse_and_a_voltage_tell_whole_inches_from_6_to_254() {
        for (wall_m, inches) in [(0.05, 6.0), (0.26, 10.0), (1.0, 39.0), (6.4, 252.0)] {
            let (pulses, volts) = seen(wall_m, 98_000, |_| false);
            assert_eq!(pulses, [(147.0 * inches) as u64; 2], "{wall_m}");
            assert_eq!(
                volts,
                [
                    (0, inches * 5.0 / 512.0),
                    (93_300_u64.div_ceil(1_000) * 1_000, inches * 5.0 / 512.0)
                ]
            );
        }
        let (pulses, volts) = seen(7.0, 49_000, |_| false);
        assert_eq!((pulses[0], volts[0].1), (37_500, 254.0 * 5.0 / 512.0));
    }

    #[test]
    fn it_measures_20_times_a_second_and_not_while_rx_is_low() {
        assert_eq!(seen(1.0, 980_000, |_| false).0.len(), 20);
        // RX goes up once, for a moment.
        let once = |now_us| !(100_000..110_000).contains(&now_us);
        assert_eq!(seen(1.0, 980_000, once).0.len(), 1);
    }
}
