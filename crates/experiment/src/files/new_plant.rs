//! The plant of a robot file to start from: body, motors by their published figures, battery.
//!
//! What is published of a small gear motor is its speed and current without a load at a voltage V, and the torque that stalls it:
//! with constant k, resistance R and gear efficiency e, k w = V - R i and e k (V/R - i) = T, so R is the smaller root of
//! `i^2 R^2 - (2 V i + T w/e) R + V^2 = 0`. The friction is `e k i`; a second speed at a lower voltage tells dry from viscous.

use super::RobotFile;
use super::new_asked::{EDGES, MOTOR, TOP_SPEED, WHEELS};
use rumbo_plant::params::Params;
use rumbo_sim::drivers::{Direction, Driver};
use rumbo_sim::wiring::Wiring;
use std::f64::consts::PI;

/// Newton metres in a kilogram-force centimetre.
const KG_CM: f64 = 0.0980665;
/// Share of the torque that gears of plastic pass on: the nominal one.
const EFFICIENCY: f64 = 0.7;

/// A gear motor by its figures.
#[derive(Clone, Debug)]
pub(super) struct GearMotor {
    /// As `new robot` names it.
    name: &'static str,
    title: &'static str,
    figures: &'static str,
    /// Voltage, and without a load speed \[rpm\] and current \[A\]; the torque that stalls it \[N m\].
    volts: f64,
    rpm: f64,
    amperes: f64,
    stall_n_m: f64,
    /// A lower voltage and its speed without a load \[rpm\]; without one half of the friction is taken for dry.
    slow: Option<(f64, f64)>,
    /// Of winding, and of gears and wheel; no data sheet has them.
    inductance_h: f64,
    inertia_kg_m2: f64,
    gear_ratio: f64,
}

/// The yellow motor of hobby cars. Inductance and inertia are those of the report's motors, identified.
static TT: GearMotor = GearMotor {
    name: "tt",
    title: "TT motors, 1:48",
    figures: "at 6 V 200 rpm and 150 mA without a load, 0.8 kg cm stalled, 90 rpm at 3 V",
    volts: 6.0,
    rpm: 200.0,
    amperes: 0.15,
    stall_n_m: 0.8 * KG_CM,
    slow: Some((3.0, 90.0)),
    inductance_h: 0.0003,
    inertia_kg_m2: 0.0008,
    gear_ratio: 48.0,
};

/// Small ones with gears of metal, on which people put encoders: Pololu's items 992 (6 V, low power, 100:1) and 4886 (12 V, 75:1),
/// which those of other makers resemble. Their dry friction is a tenth of their torque or less.
static N20: GearMotor = GearMotor {
    name: "n20",
    title: "N20 gear motors, 1:100",
    figures: "at 6 V 130 rpm and 20 mA without a load, 0.74 kg cm stalled",
    volts: 6.0,
    rpm: 130.0,
    amperes: 0.02,
    stall_n_m: 0.74 * KG_CM,
    slow: None,
    inductance_h: 0.0003,
    inertia_kg_m2: 0.0008,
    gear_ratio: 100.0,
};
static MM25: GearMotor = GearMotor {
    name: "25d",
    title: "gear motors of 25 mm, 1:75",
    figures: "at 12 V 75 rpm and 60 mA without a load, 7.1 kg cm stalled",
    volts: 12.0,
    rpm: 75.0,
    amperes: 0.06,
    stall_n_m: 7.1 * KG_CM,
    slow: None,
    inductance_h: 0.0003,
    inertia_kg_m2: 0.002,
    gear_ratio: 75.0,
};

/// The motors that a new robot may have.
pub(super) static MOTORS: [&GearMotor; 3] = [&TT, &N20, &MM25];

/// The servo of the Boe-Bot and its kind.
static SERVO: GearMotor = GearMotor {
    name: "servo",
    title: "continuous-rotation servos",
    figures: "at 6 V 50 rpm and 140 mA without a load, 2.7 kg cm stalled",
    volts: 6.0,
    rpm: 50.0,
    amperes: 0.14,
    stall_n_m: 2.7 * KG_CM,
    slow: None,
    inductance_h: 0.0003,
    inertia_kg_m2: 0.0014,
    gear_ratio: 250.0,
};

impl GearMotor {
    /// The same motor behind gears that make the wheel so many times faster, with as much power.
    fn geared(&self, faster: f64) -> Self {
        Self {
            rpm: faster * self.rpm,
            stall_n_m: self.stall_n_m / faster,
            slow: self.slow.map(|(volts, rpm)| (volts, faster * rpm)),
            inertia_kg_m2: (1e6 * self.inertia_kg_m2 / (faster * faster)).round() / 1e6,
            gear_ratio: self.gear_ratio / faster,
            ..*self
        }
    }

    /// Resistance, constant, and dry and viscous friction of a wheel.
    fn derived(&self) -> [f64; 4] {
        let speed = |rpm: f64| rpm * PI / 30.0;
        let Self { volts, amperes, .. } = *self;
        let half = volts * amperes + 0.5 * self.stall_n_m * speed(self.rpm) / EFFICIENCY;
        let root = (half * half - (amperes * volts).powi(2)).sqrt();
        let ohm = (half - root) / (amperes * amperes);
        let back_emf = (volts - ohm * amperes) / speed(self.rpm);
        let friction = |amperes: f64| EFFICIENCY * back_emf * amperes;
        let all = friction(amperes);
        let viscous = match self.slow {
            Some((volts, rpm)) => {
                let less = all - friction((volts - back_emf * speed(rpm)) / ohm);
                less / (speed(self.rpm) - speed(rpm))
            }
            None => 0.5 * all / speed(self.rpm),
        };
        [ohm, back_emf, all - viscous * speed(self.rpm), viscous]
    }
}

/// What somebody measured or knows of a robot, in place of the usual.
#[derive(Clone, Debug, Default)]
pub struct Measured {
    /// It has four wheels, the two of a side driven alike.
    four_wheels: bool,
    /// Its motors.
    pub(super) motor: Option<&'static GearMotor>,
    /// Voltage of its battery \[V\].
    battery_v: Option<f64>,
    /// Between the middles of its tyres, of four wheels those of an axle \[m\].
    base_m: Option<f64>,
    /// Diameter of its wheels \[m\].
    wheel_m: Option<f64>,
    /// What an output of an encoder gives in a turn of the wheel \[edges\].
    edges: Option<f64>,
    /// Its speed on the floor at full PWM \[m/s\].
    pub(super) top_speed_m_s: Option<f64>,
}

impl Measured {
    /// Takes an answer that has been checked to what is asked of a body.
    pub(super) fn say(&mut self, key: &str, text: &str) {
        let number = text.parse().ok();
        match key {
            WHEELS => self.four_wheels = text == "4",
            MOTOR => self.motor = MOTORS.into_iter().find(|motor| motor.name == text),
            "battery" => self.battery_v = number,
            "base" => self.base_m = number,
            "wheel" => self.wheel_m = number,
            EDGES => self.edges = number,
            TOP_SPEED => self.top_speed_m_s = number,
            _ => {}
        }
    }

    /// What is taken where nobody says it, as an answer; none of what else is asked.
    pub(super) fn usual(&self, key: &str, driver: &Driver) -> Option<String> {
        let usual = match key {
            WHEELS => return Some("2".to_owned()),
            MOTOR => return Some(TT.name.to_owned()),
            "battery" => {
                let nominal = Params::default().battery.open_circuit_v;
                self.usual_battery_v(driver).unwrap_or(nominal)
            }
            "base" => self.usual_base_m(driver),
            "wheel" => 2.0 * RADIUS_M,
            EDGES => 2.0 * f64::from(SLOTS),
            _ => return None,
        };
        Some(usual.to_string())
    }

    /// The motors, behind their own gears.
    fn motor(&self, driver: &Driver) -> &'static GearMotor {
        let servos = driver.direction == Direction::Pulse;
        self.motor.unwrap_or(if servos { &SERVO } else { &TT })
    }

    fn usual_base_m(&self, driver: &Driver) -> f64 {
        let servos = driver.direction == Direction::Pulse;
        if servos && !self.four_wheels {
            0.105
        } else {
            TRACK_M
        }
    }

    /// Of the motors' figures; none where the plant's nominal one is meant.
    fn usual_battery_v(&self, driver: &Driver) -> Option<f64> {
        let motor = self.motor(driver);
        (!std::ptr::eq(motor, &TT) || !self.four_wheels).then_some(motor.volts)
    }
}

/// The plant of a robot on two wheels and a castor, at 6 V, the voltage of its motors' figures, or on four wheels; its gears make
/// the wheels so many times faster than the motor's own.
pub(super) fn plant(driver: &Driver, measured: &Measured, faster: f64) -> String {
    let radius_m = measured.wheel_m.map_or(RADIUS_M, |diameter| diameter / 2.0);
    let base_m = measured
        .base_m
        .unwrap_or_else(|| measured.usual_base_m(driver));
    let motor = measured.motor(driver);
    let geared = motor.geared(faster);
    let mut body = match measured.four_wheels {
        true if std::ptr::eq(motor, &TT) && faster == 1.0 => {
            four_wheels(&tt_pair(), base_m, radius_m)
        }
        true => four_wheels(&pair(&geared), base_m, radius_m),
        false => two_wheels(&geared, base_m, radius_m),
    };
    if let Some(speed_m_s) = measured.top_speed_m_s {
        body = format!(
            "\n# Gears of 1:{:.0} in place of 1:{} drive {speed_m_s} m/s at full PWM, as was measured.{body}",
            geared.gear_ratio, motor.gear_ratio
        );
    }
    let battery_v = measured.battery_v.or(measured.usual_battery_v(driver));
    body + &battery_v.map(battery).unwrap_or_default()
}

/// The encoders: each slot of a disc gives two edges.
pub(super) fn encoder(measured: &Measured) -> String {
    let (about, slots) = match measured.edges {
        Some(edges) => (
            "As many slots as each output rises in a turn of the wheel.",
            edges / 2.0,
        ),
        None => (
            "A disc on the wheel; of a sensor on the motor's shaft edges_per_motor_turn, and gear_ratio in [plant.motor].",
            f64::from(SLOTS),
        ),
    };
    format!("\n# {about}\n[plant.encoder]\nslots = {slots}\n")
}

/// What a turn of a wheel counts, of a robot with encoders.
#[must_use]
pub fn counted(robot: &RobotFile) -> Option<String> {
    let has = |wiring: &Wiring| {
        wiring
            .pins
            .keys()
            .any(|signal| signal.ends_with("_encoder"))
    };
    robot.wirings.values().any(has).then(|| {
        let edges = match robot.plant.encoder.slots {
            0.0 => robot.plant.encoder.edges_per_motor_turn * robot.plant.motor.gear_ratio,
            slots => 2.0 * slots,
        };
        format!(
            "a turn of a wheel gives {edges} edges on each output of its encoder, half of them rising: [plant.encoder], and \
             gear_ratio in [plant.motor]; the sketch must count with the same"
        )
    })
}

/// What a seed draws the battery from: from nearly empty to full.
fn battery(volts: f64) -> String {
    format!(
        "\n[plant.battery]\nopen_circuit_v = {volts:.1}\n\n[plant.spread]\nbattery_min_v = {:.2}\nbattery_max_v = {:.2}\n",
        (0.9 * volts).max(5.0),
        1.07 * volts
    )
}

/// Two wheels of this radius, so far apart, on such motors.
fn two_wheels(motor: &GearMotor, base_m: f64, radius_m: f64) -> String {
    let [ohm, back_emf, dry, viscous] = motor.derived();
    let GearMotor {
        title,
        figures,
        inductance_h,
        inertia_kg_m2,
        gear_ratio,
        ..
    } = motor;
    let wheel = format!(
        "radius_m = {radius_m}\ncoulomb_forward_n_m = {dry:.4}\ncoulomb_backward_n_m = {dry:.4}\nviscous_n_m_s = {viscous:.5}\n"
    );
    format!(
        "
# Measure it. Floor and sonars are nominal. Motors are {title}, by data sheet, not identified:
# {figures}.
[plant.body]
base_m = {base_m:<16} # between the middles of the tyres
length_m = 0.20
width_m = {:.2}
centre_ahead_m = 0.03

[plant.motor]
resistance_ohm = {ohm:.2}
inductance_h = {inductance_h}
back_emf_v_s = {back_emf:.3}
gear_ratio = {gear_ratio:.0}
inertia_kg_m2 = {inertia_kg_m2}

[plant.wheels.left]
{wheel}
[plant.wheels.right]
{wheel}",
        (base_m + 0.02).max(0.15)
    )
}

/// The usual car with four wheels: between the middles of the tyres, between the axles \[m\], its mass \[kg\], the radius of a
/// wheel \[m\], and the friction of rubber on a floor.
const TRACK_M: f64 = 0.13;
const AXLES_M: f64 = 0.115;
const MASS_KG: f64 = 1.1;
const RADIUS_M: f64 = 0.0325;
const FRICTION: f64 = 0.6;
/// The usual disc of an encoder.
const SLOTS: u8 = 20;

/// The usual motors of a side as one: the lines of their table, and their wheel's friction.
fn tt_pair() -> [String; 2] {
    [
        "resistance_ohm = 2.0\ninductance_h = 0.00075\ninertia_kg_m2 = 0.0028".into(),
        "coulomb_forward_n_m = 0.016\ncoulomb_backward_n_m = 0.016\nviscous_n_m_s = 0.003".into(),
    ]
}

/// The same of other motors.
fn pair(motor: &GearMotor) -> [String; 2] {
    let [ohm, back_emf, dry, viscous] = motor.derived();
    [
        format!(
            "resistance_ohm = {:.2}\ninductance_h = {}\nback_emf_v_s = {back_emf:.3}\ngear_ratio = {:.0}\ninertia_kg_m2 = {}",
            ohm / 2.0,
            motor.inductance_h / 2.0,
            motor.gear_ratio,
            motor.inertia_kg_m2 * 2.0
        ),
        format!(
            "coulomb_forward_n_m = {0:.4}\ncoulomb_backward_n_m = {0:.4}\nviscous_n_m_s = {1:.5}",
            dry * 2.0,
            viscous * 2.0
        ),
    ]
}

/// The plant of a car on four wheels, as two: those of a side turn alike, and slide aside as it turns.
///
/// Turning on the spot at w each tyre slides aside at w l/2 and along at v - w b/2, and its friction points against that. The
/// moments balance where along is to aside as l to b: v = w/2 (b + l^2/b), so the wheels act as far apart as b + l^2/b. The force along,
/// of a side 0.6 m g/2 l / sqrt(l^2 + b^2), loads its wheels.
fn four_wheels([motor, friction]: &[String; 2], track_m: f64, radius_m: f64) -> String {
    let base_m = track_m + AXLES_M * AXLES_M / track_m;
    let aside = AXLES_M / (AXLES_M * AXLES_M + track_m * track_m).sqrt();
    let scrub_n_m = FRICTION * MASS_KG * 9.81 / 2.0 * aside * radius_m;
    let wheel = format!("radius_m = {radius_m}\n{friction}\n");
    format!(
        "
# Four wheels, the two of a side as one: by track b = {track_m} m, axles l = {AXLES_M} m apart, mass and a friction of {FRICTION}.
# Nothing is identified: measure it, `rumbo identify` fits it.
[plant.body]
mass_kg = {MASS_KG}
base_m = {base_m:.3}          # b + l^2/b: turning, the tyres slide
length_m = 0.25
width_m = 0.15
centre_ahead_m = 0.0

[plant.motor]           # two side by side
{motor}

[plant.floor]
rolling_n_m = 0.02
scrub_n_m = {scrub_n_m:.3}       # {FRICTION} m g/2 l / sqrt(l^2 + b^2) times the radius

[plant.wheels.left]
{wheel}
[plant.wheels.right]
{wheel}"
    )
}
