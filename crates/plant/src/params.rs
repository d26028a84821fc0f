//! Every physical number of the robot, each declared once.
//!
//! The [`section!`](self) macro turns one declaration per number into a field with its documentation, its nominal
//! value, its `serde` form (unknown keys refused, missing keys nominal) and its row in the table of limits. Loaders
//! use [`Params::check`] to report key, value and allowed range; identification and `--param` use [`Params::get`]
//! and [`Params::set`] with dotted keys such as `wheels.left.viscous_n_m_s`.
//!
//! The nominal values describe the robot of the report by its parts' data sheets. What a robot's recorded runs
//! determine is identified and kept in its robot file; the rest (mass, resistance, inductance) stays nominal.

use serde::{Deserialize, Serialize};
use std::fmt;

/// What is allowed for one parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// Dotted path below `[plant]`, e.g. `battery.resistance_ohm`.
    pub key: String,
    /// Unit as written for people; `count` marks a whole number.
    pub unit: &'static str,
    /// Smallest allowed value.
    pub min: f64,
    /// Largest allowed value.
    pub max: f64,
    /// The value without a robot file.
    pub nominal: f64,
    /// What the parameter is, in one line.
    pub help: &'static str,
}

/// A parameter that cannot be used.
#[derive(Clone, Debug, PartialEq)]
pub enum PlantParamError {
    /// No parameter has this key.
    UnknownKey {
        /// The key asked for.
        key: String,
        /// The existing key that resembles it most.
        nearest: String,
    },
    /// The value is not a number within the limits (or not whole where it counts things).
    OutOfRange {
        /// The refused value.
        value: f64,
        /// What is allowed.
        limit: Limit,
    },
}

impl fmt::Display for PlantParamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownKey { key, nearest } => {
                write!(f, "unknown parameter `{key}`; did you mean `{nearest}`?")
            }
            Self::OutOfRange { value, limit } => {
                let Limit {
                    key,
                    min,
                    max,
                    unit,
                    ..
                } = limit;
                write!(f, "`{key}` = {value}: allowed {min} to {max} {unit}")
            }
        }
    }
}

impl std::error::Error for PlantParamError {}

/// A section of parameters: calls back for each number with its limit and its place.
trait Section {
    fn visit(&mut self, prefix: &str, each: &mut dyn FnMut(Limit, &mut f64));
}

/// Declares a section. Each line: doc comment, `name = nominal, min => max, "unit";`.
macro_rules! section {
    ($(#[$meta:meta])* $name:ident { $( #[doc = $help:literal] $field:ident = $nominal:expr, $min:expr => $max:expr, $unit:literal; )+ }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields, default)]
        pub struct $name { $(
            #[doc = $help]
            #[doc = concat!(" Unit: ", $unit, "; allowed ", stringify!($min), " to ", stringify!($max), ".")]
            pub $field: f64,
        )+ }

        impl Default for $name {
            fn default() -> Self {
                Self { $( $field: $nominal, )+ }
            }
        }

        impl Section for $name {
            fn visit(&mut self, prefix: &str, each: &mut dyn FnMut(Limit, &mut f64)) {
                $( each(
                    Limit {
                        key: format!("{prefix}{}", stringify!($field)),
                        unit: $unit, min: $min, max: $max, nominal: $nominal, help: $help.trim_ascii(),
                    },
                    &mut self.$field,
                ); )+
            }
        }
    };
}

/// Declares a group of sections, nested under the field's name.
macro_rules! group {
    ($(#[$meta:meta])* $name:ident { $( #[doc = $help:literal] $field:ident: $kind:ty; )+ }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields, default)]
        pub struct $name { $( #[doc = $help] pub $field: $kind, )+ }

        impl Section for $name {
            fn visit(&mut self, prefix: &str, each: &mut dyn FnMut(Limit, &mut f64)) {
                $( self.$field.visit(&format!("{prefix}{}.", stringify!($field)), each); )+
            }
        }
    };
}

section! {
    /// Shape and mass of the body.
    Body {
        /// Mass with battery and electronics (typical of such a kit; the runs do not tell it).
        mass_kg = 0.9, 0.05 => 20.0, "kg";
        /// Moment of inertia about the vertical axis: m (l^2 + w^2) / 12 of the footprint. Identified, also the castor's resistance.
        yaw_inertia_kg_m2 = 0.0047, 1e-5 => 5.0, "kg m2";
        /// Distance between the wheels' contact points (the odometry of the report uses 0.10).
        base_m = 0.10, 0.03 => 1.0, "m";
        /// Footprint along x.
        length_m = 0.20, 0.04 => 1.0, "m";
        /// Footprint along y.
        width_m = 0.15, 0.04 => 1.0, "m";
        /// Footprint's centre ahead of the wheels' axis.
        centre_ahead_m = 0.03, -0.5 => 0.5, "m";
    }
}

section! {
    /// Two Li-ion cells in series, shared by motors and electronics.
    Battery {
        /// Open-circuit voltage at the start of a run: the charge follows from it.
        open_circuit_v = 7.4, 5.0 => 13.0, "V";
        /// Internal resistance with wiring and switch.
        resistance_ohm = 0.15, 0.0 => 3.0, "ohm";
        /// Capacity.
        capacity_ah = 2.6, 0.1 => 50.0, "A h";
        /// Current drawn by the electronics all the time.
        electronics_a = 0.15, 0.0 => 2.0, "A";
    }
}

section! {
    /// H bridge, one half per motor: an L298N with the PWM on its enable pin, or another by its data sheet.
    Bridge {
        /// Voltage lost in the two saturated transistors at small current.
        drop_v = 1.4, 0.0 => 4.0, "V";
        /// Growth of that loss with the current.
        drop_ohm = 0.5, 0.0 => 5.0, "ohm";
        /// Forward voltage of one freewheeling diode.
        diode_v = 0.9, 0.0 => 2.0, "V";
        /// Voltage lost around a shorted motor, in a transistor and a diode; 0 where the transistors conduct both ways.
        brake_v = 1.6, 0.0 => 4.0, "V";
        /// PWM frequency of the Mega's timers 3 and 4 as Arduino sets them.
        pwm_hz = 490.2, 30.0 => 40000.0, "Hz";
    }
}

section! {
    /// DC gear motor, the same for both wheels; what sets one apart from the other is in its wheel.
    Motor {
        /// Winding resistance.
        resistance_ohm = 4.0, 0.2 => 50.0, "ohm";
        /// Winding inductance.
        inductance_h = 0.0015, 1e-5 => 0.1, "H";
        /// Back-EMF per wheel speed, equal to the ideal torque per current (V s/rad = N m/A).
        back_emf_v_s = 0.25, 0.01 => 5.0, "V s/rad";
        /// Share of the torque that the gears pass on.
        gear_efficiency = 0.7, 0.1 => 1.0, "1";
        /// Inertia of rotor, gears and wheel, referred to the wheel: a rotor of 6e-7 kg m2 times 48^2.
        inertia_kg_m2 = 0.0014, 1e-5 => 0.1, "kg m2";
        /// Motor turns per wheel turn.
        gear_ratio = 48.0, 1.0 => 500.0, "1";
    }
}

section! {
    /// One wheel with its motor's own friction.
    Wheel {
        /// Radius.
        radius_m = 0.0325, 0.005 => 0.2, "m";
        /// Back-EMF and torque constants relative to `motor`.
        strength = 1.0, 0.5 => 2.0, "1";
        /// Dry friction of gears and brushes turning forward, referred to the wheel.
        coulomb_forward_n_m = 0.008, 0.0 => 1.0, "N m";
        /// The same turning backward.
        coulomb_backward_n_m = 0.008, 0.0 => 1.0, "N m";
        /// Viscous friction, referred to the wheel.
        viscous_n_m_s = 0.0015, 0.0 => 0.1, "N m s/rad";
        /// Dry friction after rest, relative to that at speed.
        static_ratio = 1.0, 1.0 => 3.0, "1";
        /// Speed at which half of that excess is gone (Stribeck).
        stribeck_rad_s = 10.0, 0.05 => 50.0, "rad/s";
        /// Time over which the friction follows the speed: lubricant and tyres remember how fast they went.
        friction_memory_s = 1.5, 0.001 => 30.0, "s";
        /// Dry friction of a wheel that has just broken loose or just stopped, relative to the whole.
        onset_ratio = 1.0, 0.1 => 1.0, "1";
        /// Angle rolled over which it grows to the whole: a first-order lag.
        onset_rad = 1.5, 0.05 => 50.0, "rad";
        /// Time at rest over which it grows to the whole: a first-order lag.
        onset_rest_s = 0.5, 0.001 => 30.0, "s";
    }
}

group! {
    /// The two wheels.
    Wheels {
        /// The left wheel (motor B of the report).
        left: Wheel;
        /// The right wheel (motor A of the report).
        right: Wheel;
    }
}

section! {
    /// What the floor takes from the motion. Absent with the wheels in the air.
    Floor {
        /// Scale on all floor friction: 1 is the floor of the identified runs.
        friction_scale = 1.0, 0.0 => 5.0, "1";
        /// Dry resistance per wheel when rolling straight: tyres and castor.
        rolling_n_m = 0.01, 0.0 => 1.0, "N m";
        /// Dry resistance per wheel added when turning on the spot: scrubbing tyres, castor. At rest `onset_ratio` of it.
        scrub_n_m = 0.01, 0.0 => 1.0, "N m";
        /// Moment against turning, per rad/s of yaw: tyres that spin while they roll, and the castor.
        yaw_damping_n_m_s = 0.0, 0.0 => 1.0, "N m s";
        /// Standard deviation of that resistance along the way, relative.
        roughness = 0.09, 0.0 => 0.5, "1";
        /// Distance over which the floor changes.
        roughness_length_m = 0.15, 0.001 => 1.0, "m";
        /// Standard deviation of each wheel's slip: distance lost over distance rolled.
        slip = 0.01, 0.0 => 0.2, "1";
        /// Distance rolled over which the slip changes: the grain of floor and tyre.
        slip_length_m = 0.001, 0.0005 => 5.0, "m";
    }
}

section! {
    /// One sensor per wheel, counted on both edges: a Hall sensor on the motor's shaft, or a slotted disc on the wheel.
    Encoder {
        /// Edges per turn of the motor shaft.
        edges_per_motor_turn = 8.0, 1.0 => 32.0, "count";
        /// Slots of a disc on the wheel itself, each of which gives two edges; 0: the disc is on the motor's shaft.
        slots = 0.0, 0.0 => 4000.0, "count";
        /// Largest deviation of an edge from even spacing, relative to that spacing.
        spacing_error = 0.05, 0.0 => 0.45, "1";
    }
}

section! {
    /// HC-SR04 rangers, all alike. Noise: see `sonar`; beam and incidence are read off the servo sweeps of the lane run.
    Sonar {
        /// From the end of the trigger pulse to the rise of the echo line.
        trigger_to_rise_s = 450e-6, 1e-6 => 5e-3, "s";
        /// Longest range that returns an echo.
        reach_m = 2.5, 0.1 => 6.0, "m";
        /// Shortest range that is measured; nearer things read as this.
        min_range_m = 0.02, 0.0 => 0.5, "m";
        /// Half of the beam's opening.
        beam_half_angle_rad = 0.31, 0.01 => 1.5, "rad";
        /// Angle of incidence beyond which a flat face returns no echo.
        incidence_limit_rad = 0.55, 0.01 => 1.57, "rad";
        /// Standard deviation of that limit from ping to ping.
        incidence_soft_rad = 0.06, 0.0 => 0.5, "rad";
        /// Longest range at which a corner is heard whose faces are turned away.
        corner_reach_m = 0.6, 0.0 => 6.0, "m";
        /// Standard deviation of the timing of a clean echo.
        jitter_m = 0.0005, 0.0 => 0.05, "m";
        /// Frequency of the burst: a weak echo is timed whole cycles early or late.
        carrier_hz = 40000.0, 1000.0 => 500000.0, "Hz";
        /// Standard deviation, before rounding to whole cycles, in motion and at `noise_range_m`: weakness 1.
        noise_m = 0.002, 0.0 => 0.3, "m";
        /// Weakness of an echo at rest relative to motion.
        rest_weakness = 0.7, 0.0 => 1.0, "1";
        /// Weakness of an echo while the second echo of another sonar is still to come.
        disturbed_weakness = 1.6, 1.0 => 10.0, "1";
        /// Range at which the weakness is 1 in motion.
        noise_range_m = 0.57, 0.05 => 5.0, "m";
        /// Power of the range with which the weakness grows: it differs from wall to wall.
        noise_growth = 1.9, 0.0 => 6.0, "1";
        /// Range beyond which it grows no more.
        noise_full_m = 0.9, 0.05 => 6.0, "m";
        /// Share of readings that are outliers at weakness 1.
        outlier_rate = 0.0023, 0.0 => 0.5, "1";
        /// Largest outlier, towards shorter ranges, relative to the range.
        outlier_span = 0.17, 0.0 => 1.0, "1";
        /// Share of pings without an echo, though something is in reach, at weakness 1.
        loss_rate = 1e-5, 0.0 => 0.9, "1";
        /// Power of the weakness with which outliers and losses grow.
        fault_growth = 3.1, 0.0 => 6.0, "1";
        /// Chance that a sonar takes the echo of another, looking the same way, for its own.
        crosstalk = 0.5, 0.0 => 1.0, "1";
        /// The same for the other's second echo: obstacle, body, obstacle.
        crosstalk_bounce = 0.07, 0.0 => 1.0, "1";
        /// Longest range from which that second echo is strong enough to disturb or to be taken.
        bounce_reach_m = 2.5, 0.0 => 6.0, "m";
        /// How far behind the transducers the body reflects that second echo.
        bounce_behind_m = 0.055, 0.0 => 0.3, "m";
        /// How long the echo line stays high without an echo.
        timeout_high_s = 0.038, 0.001 => 0.3, "s";
        /// Air temperature: speed of sound = 331.3 + 0.606 T.
        temperature_c = 20.0, -30.0 => 60.0, "degC";
    }
}

section! {
    /// The hobby servo that carries the front sonar.
    Servo {
        /// Speed (0.17 s per 60 degrees).
        speed_rad_s = 6.2, 0.1 => 50.0, "rad/s";
        /// Largest deflection from straight ahead, either side.
        travel_rad = std::f64::consts::FRAC_PI_2, 0.1 => 3.2, "rad";
    }
}

section! {
    /// How far robots, batteries and floors differ: what a seed draws, uniform within these bounds (see [`Params::draw`]).
    /// Relative ones are the largest deviation from the robot's own value.
    Spread {
        /// Radius of each wheel, relative.
        radius = 0.005, 0.0 => 0.1, "1";
        /// Distance between the wheels, relative.
        base = 0.02, 0.0 => 0.2, "1";
        /// Dry friction of each wheel's gears, relative; breakaway friction follows.
        friction = 0.15, 0.0 => 0.9, "1";
        /// Friction of the floor, relative.
        floor = 0.15, 0.0 => 0.9, "1";
        /// Emptiest battery: open-circuit voltage.
        battery_min_v = 6.8, 5.0 => 13.0, "V";
        /// Fullest battery: open-circuit voltage.
        battery_max_v = 8.4, 5.0 => 13.0, "V";
        /// Speed of sound, relative: the temperature of the room.
        sound = 0.009, 0.0 => 0.05, "1";
        /// Back-EMF of both motors, relative.
        back_emf = 0.0, 0.0 => 0.5, "1";
        /// Torque of the right motor beside the left one's, relative.
        strength = 0.0, 0.0 => 0.5, "1";
        /// Dry friction after rest, relative.
        static_ratio = 0.0, 0.0 => 0.5, "1";
        /// Time over which friction remembers the speed, relative.
        friction_memory = 0.0, 0.0 => 0.9, "1";
        /// Dry friction of a wheel that has just broken loose or just stopped, relative.
        onset_ratio = 0.0, 0.0 => 0.9, "1";
        /// Resistance added when turning on the spot, relative.
        scrub = 0.0, 0.0 => 0.9, "1";
        /// Yaw inertia, relative.
        yaw_inertia = 0.0, 0.0 => 0.9, "1";
        /// Damping of the yaw, relative.
        yaw_damping = 0.0, 0.0 => 0.9, "1";
        /// Growth of the sonars' noise with the range, relative: what they look at.
        noise_growth = 0.0, 0.0 => 0.9, "1";
    }
}

group! {
    /// All parameters of one robot and its floor: the `[plant]` table of a robot file.
    Params {
        /// Shape and mass.
        body: Body;
        /// Supply.
        battery: Battery;
        /// H bridge.
        bridge: Bridge;
        /// Gear motors.
        motor: Motor;
        /// Wheels, each with its own friction.
        wheels: Wheels;
        /// Floor under them.
        floor: Floor;
        /// Hall sensors.
        encoder: Encoder;
        /// Rangers.
        sonar: Sonar;
        /// Servo of the front sonar.
        servo: Servo;
        /// What a seed draws.
        spread: Spread;
    }
}

impl Params {
    /// The limits of all parameters, in the order of the robot file.
    pub fn limits() -> Vec<Limit> {
        let mut limits = Vec::new();
        Self::default().visit("", &mut |limit, _| limits.push(limit));
        limits
    }

    /// The value of a dotted key; `None` for an unknown key.
    pub fn get(&self, key: &str) -> Option<f64> {
        let (mut copy, mut found) = (*self, None);
        copy.visit("", &mut |limit, value| {
            if limit.key == key {
                found = Some(*value);
            }
        });
        found
    }

    /// Sets the value of a dotted key.
    ///
    /// # Errors
    /// An unknown key or a value out of range; the parameters are then as before.
    pub fn set(&mut self, key: &str, new: f64) -> Result<(), PlantParamError> {
        let mut outcome = None;
        self.visit("", &mut |limit, value| {
            if limit.key == key {
                outcome = Some(admit(limit, new).map(|()| *value = new));
            }
        });
        outcome.unwrap_or_else(|| {
            Err(PlantParamError::UnknownKey {
                key: key.into(),
                nearest: nearest_key(key),
            })
        })
    }

    /// Checks every value against its limits.
    ///
    /// # Errors
    /// The first value out of range.
    pub fn check(&self) -> Result<(), PlantParamError> {
        let (mut copy, mut outcome) = (*self, Ok(()));
        copy.visit("", &mut |limit, value| {
            if outcome.is_ok() {
                outcome = admit(limit, *value);
            }
        });
        outcome
    }
}

fn admit(limit: Limit, value: f64) -> Result<(), PlantParamError> {
    let whole = limit.unit != "count" || libm::floor(value) == value;
    if (limit.min..=limit.max).contains(&value) && whole {
        Ok(())
    } else {
        Err(PlantParamError::OutOfRange { value, limit })
    }
}

/// The key that shares most three-letter pieces with the one asked for.
fn nearest_key(asked: &str) -> String {
    let pieces = |key: &str| {
        key.as_bytes()
            .windows(3)
            .map(<[u8]>::to_vec)
            .collect::<Vec<_>>()
    };
    let asked = pieces(asked);
    let shared = |key: &str| {
        let own = pieces(key);
        own.iter().filter(|piece| asked.contains(piece)).count() * 1000
            / (own.len() + asked.len()).max(1)
    };
    Params::limits()
        .into_iter()
        .map(|limit| limit.key)
        .max_by_key(|key| shared(key))
        .unwrap_or_default()
}

#[cfg(test)]
mod tests;
