//! Lamps of a world, and the photoresistors of a robot that see them.
//!
//! A lamp shines alike into all directions: it gives a sensor its intensity times the cosine of the incidence, over the
//! square of the distance. What stands or moves in between is higher than any lamp, and shades. The light of the room comes
//! from everywhere alike.
//!
//! | | is | source |
//! |---|---|---|
//! | resistance | 10 to 20 kOhm at 10 lx, of a robot's by the seed; gamma 0.6: a quarter at 100 lx; 1 MOhm in the dark | data sheet GL5528 |
//! | | a robot's sensors, from one bag, differ from each other by up to a tenth either way | assumed |
//! | response | 20 ms when it gets brighter, 30 ms darker | the same |
//! | voltage | with a resistor between the supply's 5 V and GND | circuit |
//! | level | a comparator, LM393, with a trimmer | modules with it |
//!
//! Not identified from recordings; colours do not count.

use crate::source;
use rumbo_plant::cone;
use rumbo_plant::contact::Pose;
use rumbo_plant::noise::Noise;
use rumbo_plant::world::World;

/// Supply of robot and sensors \[V\].
const SUPPLY_V: f64 = 5.0;
/// At this illuminance data sheets give the resistance \[lx\].
const RATED_LUX: f64 = 10.0;
/// The resistance there \[Ohm\].
const RATED_OHM: [f64; 2] = [10e3, 20e3];
/// A robot's sensors differ from theirs by up to so much of it.
const ALIKE: f64 = 0.1;
/// How the resistance falls: its logarithm over that of the illuminance.
const GAMMA: f64 = 0.6;
/// The resistance without light \[Ohm\].
const DARK_OHM: f64 = 1e6;
/// Time constants \[s\].
const BRIGHTER_S: f64 = 0.02;
const DARKER_S: f64 = 0.03;
/// A comparator switches this far from the trimmer's conductance.
const HYSTERESIS: f64 = 0.05;
/// Height of the sensors, on a robot's deck \[m\].
const DECK_M: f64 = 0.05;
/// Nearer to a lamp it is no point \[m\].
const NEAREST_M: f64 = 0.02;

/// A lamp, a point that shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    /// Where it is \[m\].
    pub at_m: [f64; 2],
    /// How high above the floor \[m\].
    pub height_m: f64,
    /// Luminous flux into all directions together \[lm\].
    pub lumen: f64,
}

/// The light of a world.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Light {
    /// That of the room, from everywhere \[lx\].
    pub ambient_lux: f64,
    /// What shines besides.
    pub lamps: Vec<Lamp>,
}

/// What a light sensor gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightReading {
    /// The voltage between the photoresistor and this resistor \[Ohm\].
    Volts(f64),
    /// A level, which changes at this illuminance \[lx\].
    Level(f64),
}

/// A light sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct LightSensor {
    /// What the robot file calls it.
    pub name: String,
    /// Where it is on the robot, ahead of the wheels' axis and to the left \[m\].
    pub at_m: [f64; 2],
    /// Where it looks, counter-clockwise from ahead \[rad\].
    pub angle_rad: f64,
    /// How far it looks up \[rad\].
    pub up_rad: f64,
    /// The board's pin.
    pub pin: u8,
    /// What it gives.
    pub reading: LightReading,
    /// More light is a higher voltage or level.
    pub bright_high: bool,
    /// Its resistance at 10 lx, where it was measured \[Ohm\].
    pub rated_ohm: Option<f64>,
}

/// The light at a sensor, and what that makes of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lit {
    at_us: u64,
    /// Illuminance \[lx\].
    pub(crate) lux: f64,
    /// Conductance of the photoresistor \[S\].
    siemens: f64,
    /// Voltage or level of the output \[V\].
    pub(crate) volts: f64,
}

impl LightSensor {
    /// The illuminance at a sensor of a robot there \[lx\].
    #[must_use]
    pub fn lux(&self, light: &Light, world: &World, pose: &Pose, now_us: u64) -> f64 {
        let [x_m, y_m] = pose.place(self.at_m);
        let (sin, cos) = libm::sincos(pose.heading_rad + self.angle_rad);
        let (up, along) = libm::sincos(self.up_rad);
        let from_lamps = light.lamps.iter().map(|lamp| {
            let way_m = [
                lamp.at_m[0] - x_m,
                lamp.at_m[1] - y_m,
                lamp.height_m - DECK_M,
            ];
            let away_m = libm::sqrt(way_m.iter().map(|each| each * each).sum::<f64>());
            let away_m = away_m.max(NEAREST_M);
            let facing = (along * (cos * way_m[0] + sin * way_m[1]) + up * way_m[2]) / away_m;
            let sees = facing > 0.0 && cone::is_in_sight(world, now_us, [x_m, y_m], lamp.at_m);
            let candela = lamp.lumen / (4.0 * core::f64::consts::PI);
            f64::from(u8::from(sees)) * candela * facing / (away_m * away_m)
        });
        light.ambient_lux + from_lamps.sum::<f64>()
    }

    /// What the sensor of this number gives in a light, after what it did.
    pub(crate) fn respond(
        &self,
        lux: f64,
        now_us: u64,
        (number, noise): (usize, &Noise),
        before: Option<Lit>,
    ) -> Lit {
        let [least, most] = RATED_OHM;
        let drawn = || {
            let [bag, own] =
                [0, 1 + number as u32].map(|own| noise.uniform(source::RESISTANCES + own, 0));
            (least + (most - least) * bag) * (1.0 + ALIKE * (2.0 * own - 1.0))
        };
        let rated_ohm = self.rated_ohm.unwrap_or_else(drawn);
        let steady = |lux: f64| libm::pow(lux / RATED_LUX, GAMMA) / rated_ohm + 1.0 / DARK_OHM;
        let aim = steady(lux);
        let siemens = before.map_or(aim, |before| {
            let constant_s = if aim > before.siemens {
                BRIGHTER_S
            } else {
                DARKER_S
            };
            let passed_s = now_us.saturating_sub(before.at_us) as f64 * 1e-6;
            aim + (before.siemens - aim) * libm::exp(-passed_s / constant_s)
        });
        let share = match self.reading {
            LightReading::Volts(ohm) => ohm * siemens / (1.0 + ohm * siemens),
            LightReading::Level(lux) => {
                let was_bright = before.is_some_and(|lit| (lit.volts > 0.0) == self.bright_high);
                let edge = if was_bright {
                    1.0 - HYSTERESIS
                } else {
                    1.0 + HYSTERESIS
                };
                f64::from(u8::from(siemens > edge * steady(lux)))
            }
        };
        let share = if self.bright_high { share } else { 1.0 - share };
        Lit {
            at_us: now_us,
            lux,
            siemens,
            volts: SUPPLY_V * share,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_plant::world::Wall;

    fn sensor(reading: LightReading) -> LightSensor {
        LightSensor {
            name: "front".into(),
            at_m: [0.0, 0.0],
            angle_rad: 0.0,
            up_rad: 0.0,
            pin: 14,
            bright_high: matches!(reading, LightReading::Volts(_)),
            reading,
            rated_ohm: Some(14e3),
        }
    }

    #[test]
    fn a_lamp_lights_by_the_square_of_its_distance_and_the_cosine_and_walls_shade() {
        let light = Light {
            ambient_lux: 10.0,
            lamps: vec![Lamp {
                at_m: [1.0, 0.0],
                height_m: DECK_M,
                lumen: 4.0 * core::f64::consts::PI * 64.0,
            }],
        };
        let wall = Wall {
            from_m: [0.5, -0.1],
            to_m: [0.5, 0.1],
            thickness_m: 0.0,
        };
        let shaded = World::new(&[wall], &[]).unwrap();
        let sensor = sensor(LightReading::Volts(10e3));
        let mut pose = Pose::default();
        for (x_m, heading_deg, expected) in [
            (0.0, 0.0, 74.0),
            (-1.0, 0.0, 26.0),
            (0.0, 60.0, 42.0),
            (0.0, 180.0, 10.0),
        ] {
            (pose.x_m, pose.heading_rad) = (x_m, f64::to_radians(heading_deg));
            let lux = sensor.lux(&light, &World::empty(), &pose, 0);
            assert!((lux - expected).abs() < 1e-9, "{x_m} {heading_deg}: {lux}");
            assert_eq!(sensor.lux(&light, &shaded, &pose, 0), 10.0);
        }
        // Beside the wall the lamp is in sight again.
        (pose.y_m, pose.heading_rad) = (0.3, 0.0);
        assert!(sensor.lux(&light, &shaded, &pose, 0) > 60.0);
    }

    #[test]
    fn the_resistance_is_that_of_the_data_sheet_other_for_each_sensor_and_seed() {
        let mut sensor = sensor(LightReading::Volts(10e3));
        let kohm = |sensor: &LightSensor, lux, number, seed| {
            let noise = Noise::new(seed, 0);
            let volts = sensor.respond(lux, 0, (number, &noise), None).volts;
            10.0 * (SUPPLY_V / volts - 1.0)
        };
        assert!((kohm(&sensor, 10.0, 0, 1) / 14.0 - 1.0).abs() < 0.02);
        let [dim, bright] = [10.0, 100.0].map(|lux| kohm(&sensor, lux, 0, 1));
        assert!((libm::log10(dim / bright) - GAMMA).abs() < 0.01);
        assert!((kohm(&sensor, 0.0, 0, 1) - 1_000.0).abs() < 1e-6);
        sensor.rated_ohm = None;
        let pairs: Vec<[f64; 2]> = (0..20)
            .map(|seed| [0, 1].map(|number| kohm(&sensor, 10.0, number, seed)))
            .collect();
        assert!(
            pairs
                .iter()
                .flatten()
                .all(|kohm| (8.9..22.0).contains(kohm))
        );
        let apart = |pair: &[f64; 2]| libm::fabs(pair[0] / pair[1] - 1.0);
        assert!(
            pairs.iter().all(|pair| (1e-4..0.23).contains(&apart(pair))),
            "{pairs:?}"
        );
        let spread = |of: fn(f64, f64) -> f64| pairs.iter().flatten().copied().reduce(of).unwrap();
        assert!(spread(f64::max) > 1.5 * spread(f64::min), "{pairs:?}");
    }

    #[test]
    fn it_follows_light_within_20_ms_and_darkness_within_30() {
        let (sensor, noise) = (sensor(LightReading::Volts(10e3)), Noise::new(1, 0));
        let conductance = |lux| sensor.respond(lux, 0, (0, &noise), None).siemens;
        let [dark, bright] = [1.0, 100.0].map(conductance);
        for (from, to, within_us) in [(1.0, 100.0, 20_000), (100.0, 1.0, 30_000)] {
            let mut lit = sensor.respond(from, 0, (0, &noise), None);
            for now_us in (1_000..=within_us).step_by(1_000) {
                lit = sensor.respond(to, now_us, (0, &noise), Some(lit));
            }
            let passed = (lit.siemens - conductance(from)) / (conductance(to) - conductance(from));
            assert!((passed - 0.632).abs() < 0.001, "{passed} {dark} {bright}");
        }
    }

    #[test]
    fn a_module_is_low_where_it_is_brighter_than_its_trimmer_says() {
        let (module, noise) = (sensor(LightReading::Level(50.0)), Noise::new(1, 0));
        let level = |lux, before| module.respond(lux, 0, (0, &noise), before);
        let (dark, bright) = (level(40.0, None), level(60.0, None));
        assert_eq!([dark.volts, bright.volts], [5.0, 0.0]);
        // Between both edges it stays what it was.
        for was in [dark, bright] {
            let mut later = level(50.0, Some(was));
            for now_us in (0..500_000).step_by(1_000) {
                later = module.respond(50.0, now_us, (0, &noise), Some(later));
            }
            assert_eq!(later.volts, was.volts);
        }
    }
}
