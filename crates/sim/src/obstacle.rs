//! Infrared sensors that look for obstacles: a switch that closes within a set distance, and a voltage by distance.
//!
//! | | is | source |
//! |---|---|---|
//! | switch | an emitter, a receiver and a comparator (FC-51 and copies) | its sellers: 2 cm to 30 cm by a potentiometer, 35° wide |
//! | voltage | Sharp GP2Y0A21YK | its data sheet: 0.4 V at 80 cm, 2.3 V at 10 cm, a reading each 38.3 ms; in between published fits |
//! | | GP2Y0A02YK | the same: 0.4 V at 150 cm, 2.45 V at 20 cm |
//! | | GP2Y0A41SK | the same: 0.4 V at 30 cm, 2.65 V at 4 cm, a reading each 16.5 ms |
//!
//! Neither is identified from recordings; colour and slant of what they see do not count.

use rumbo_plant::cone::{self, Cone, Hearing};
use rumbo_plant::contact::Pose;
use rumbo_plant::world::World;

/// A comparator opens this much further away than it closes.
const HYSTERESIS: f64 = 0.05;
/// Half of what a switch sees, and of a narrow beam \[rad\].
const SWITCH_RAD: f64 = 0.305;
const BEAM_RAD: f64 = 0.02;
/// A sensor that gives a voltage.
#[derive(Debug, PartialEq)]
pub struct Sharp {
    /// Its name in robot files.
    pub name: &'static str,
    /// A reading takes so long \[us\].
    reading_us: u64,
    /// Distance \[m\] and voltage \[V\]; nearer than its range the voltage falls again.
    volts: &'static [(f64, f64)],
}

/// Those there are; the usual one first.
pub const SHARPS: [&Sharp; 3] = [
    &Sharp {
        name: "gp2y0a21",
        reading_us: 38_300,
        volts: &[
            (0.00, 1.00),
            (0.06, 3.10),
            (0.08, 2.75),
            (0.10, 2.30),
            (0.15, 1.63),
            (0.20, 1.30),
            (0.30, 0.92),
            (0.40, 0.74),
            (0.50, 0.60),
            (0.60, 0.51),
            (0.70, 0.45),
            (0.80, 0.40),
            (1.20, 0.25),
        ],
    },
    &Sharp {
        name: "gp2y0a02",
        reading_us: 38_300,
        volts: &[
            (0.00, 0.80),
            (0.15, 2.75),
            (0.20, 2.45),
            (0.30, 1.66),
            (0.40, 1.27),
            (0.50, 1.03),
            (0.60, 0.87),
            (0.80, 0.68),
            (1.00, 0.56),
            (1.20, 0.48),
            (1.50, 0.40),
            (2.00, 0.32),
        ],
    },
    &Sharp {
        name: "gp2y0a41",
        reading_us: 16_500,
        volts: &[
            (0.00, 1.20),
            (0.03, 3.10),
            (0.04, 2.65),
            (0.05, 2.13),
            (0.06, 1.79),
            (0.08, 1.35),
            (0.10, 1.09),
            (0.12, 0.92),
            (0.15, 0.75),
            (0.20, 0.57),
            (0.25, 0.47),
            (0.30, 0.40),
            (0.50, 0.26),
        ],
    },
];

impl Sharp {
    /// The voltage at a distance.
    fn volts_at(&self, range_m: f64) -> f64 {
        let last = self.reach();
        let pair = self.volts.windows(2).find(|pair| range_m < pair[1].0);
        pair.map_or(last.1, |pair| {
            let ((near_m, high_v), (far_m, low_v)) = (pair[0], pair[1]);
            high_v + (low_v - high_v) * (range_m - near_m) / (far_m - near_m)
        })
    }

    /// From where on the voltage does not change, and that.
    fn reach(&self) -> (f64, f64) {
        self.volts.last().copied().unwrap_or_default()
    }
}

/// What a sensor gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sight {
    /// A level: something is nearer than this \[m\].
    Switch {
        /// Set by its potentiometer.
        reach_m: f64,
        /// That is high, not low.
        seen_high: bool,
    },
    /// A voltage by distance.
    Volts(&'static Sharp),
}

/// An infrared sensor for obstacles.
#[derive(Clone, Debug, PartialEq)]
pub struct ObstacleSensor {
    /// What the robot file calls it.
    pub name: String,
    /// Where it is on the robot, ahead of the wheels' axis and to the left \[m\].
    pub at_m: [f64; 2],
    /// Where it looks, counter-clockwise from ahead \[rad\].
    pub angle_rad: f64,
    /// The board's pin.
    pub pin: u8,
    /// What it gives.
    pub sight: Sight,
}

/// What a sensor sees, and what it gives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Seen {
    /// How far away something is \[m\]; infinite without.
    pub(crate) range_m: f64,
    /// Its voltage \[V\].
    pub(crate) volts: f64,
}

impl ObstacleSensor {
    /// What it sees and gives from this pose on, after what it did; nothing where its reading is not renewed.
    pub(crate) fn look(
        &self,
        world: &World,
        pose: &Pose,
        now_us: u64,
        before: Option<Seen>,
    ) -> Option<Seen> {
        let (half_angle_rad, reach_m) = match self.sight {
            Sight::Switch { reach_m, .. } => (SWITCH_RAD, reach_m * (1.0 + HYSTERESIS)),
            Sight::Volts(sharp) if before.is_some() && now_us % sharp.reading_us >= 1_000 => {
                return None;
            }
            Sight::Volts(sharp) => (BEAM_RAD, sharp.reach().0),
        };
        let cone = cone_at(pose, self.at_m, self.angle_rad, half_angle_rad);
        let found = cone::nearest(world, now_us, &cone, &Hearing::geometric(reach_m));
        let range_m = found.map_or(f64::INFINITY, |found| found.range_m);
        let volts = match self.sight {
            Sight::Switch { reach_m, seen_high } => {
                let was_seen = before.is_some_and(|before| (before.volts > 0.0) == seen_high);
                let edge_m = if was_seen {
                    reach_m * (1.0 + HYSTERESIS)
                } else {
                    reach_m
                };
                if (range_m < edge_m) == seen_high {
                    5.0
                } else {
                    0.0
                }
            }
            Sight::Volts(sharp) => sharp.volts_at(range_m),
        };
        Some(Seen { range_m, volts })
    }
}

/// What is seen from a place on the robot, ahead of the wheels' axis and to the left \[m\], in a direction of its own.
pub(crate) fn cone_at(pose: &Pose, at_m: [f64; 2], angle_rad: f64, half_angle_rad: f64) -> Cone {
    Cone {
        apex: pose.place(at_m),
        axis_rad: pose.heading_rad + angle_rad,
        half_angle_rad,
    }
}
