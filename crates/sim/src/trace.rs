//! Ground truth of a run, sampled at every control tick from the plant and the pins.

use crate::instruments::READING_US;
use crate::mega::CONSOLES;
use crate::sim::Sim;
use crate::tape::LinkTape;
use rumbo_control::params::Params;
use rumbo_plant::contact::Pose;
use rumbo_plant::plant::Plant;
use rumbo_plant::sonar::SonarId;
use rumbo_robot::Loops;
use rumbo_wire::FromRobot;
use std::fmt::Write;

/// Period of the samples [us].
pub const SAMPLE_US: u64 = 10_000;

/// Ground truth at one instant.
#[derive(Clone, Copy, Debug)]
pub struct TruthSample {
    /// Time since the start [s].
    pub t_s: f64,
    /// Position in the world [m].
    pub x_m: f64,
    /// Position in the world [m].
    pub y_m: f64,
    /// Heading, not wrapped, so that turns add up [rad].
    pub heading_rad: f64,
    /// The same wrapped, as the plant has it [rad].
    pub wrapped_rad: f64,
    /// True wheel speeds, left and right [rad/s].
    pub wheel_rad_s: [f64; 2],
    /// PWM at the bridges, left and right, -255..=255.
    pub duty: [i16; 2],
    /// What [`Trace::range_m`] is, where the sample itself must say it: among other robots.
    pub seen_m: Option<[f64; SonarId::ALL.len()]>,
    /// Where the servo points [rad].
    pub servo_rad: f64,
    /// Battery at its terminals [V].
    pub battery_v: f64,
    /// The body touches something.
    pub touching: bool,
}

/// Two unknown ranges are equal.
impl PartialEq for TruthSample {
    fn eq(&self, other: &Self) -> bool {
        let whole = |sample: &Self| {
            let Self {
                t_s,
                x_m,
                y_m,
                heading_rad,
                wrapped_rad,
                wheel_rad_s,
                duty,
                seen_m,
                servo_rad,
                battery_v,
                touching,
            } = *sample;
            let pose = [x_m, y_m, heading_rad, wrapped_rad];
            (
                [t_s, servo_rad, battery_v],
                pose,
                wheel_rad_s,
                seen_m.map(|seen_m| seen_m.map(f64::to_bits)),
                duty,
                touching,
            )
        };
        whole(self) == whole(other)
    }
}

/// A message from the robot that metrics need.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedMessage {
    /// Time of arrival at the station since the start [s].
    pub t_s: f64,
    /// The message.
    pub what: FromRobot,
}

/// A whole run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// The robot's parameters at the start; `None` where its program has no table of ours.
    pub parameters: Option<Params>,
    /// Telemetry, status, events and heading references as they arrived at the station.
    pub messages: Vec<TimedMessage>,
    /// The samples, in order of time.
    pub samples: Vec<TruthSample>,
    /// What crossed the link, in order.
    pub link: LinkTape,
    /// What the USARTs of an emulated Mega have sent, in order.
    pub consoles: Vec<UsartOutput>,
    /// What instruments at an emulated Mega have shown, in order.
    pub readings: Vec<Shown>,
    /// What the control loops of our native robot added up, with its time [us], in order.
    pub loops: Vec<(u64, Loops)>,
    /// From where sonars look, and at what.
    pub sights: Sights,
    /// The names of the sonars from 3 on.
    pub other_sonars: Vec<String>,
}

/// Sonars and the world around them, each from its time [us] on: ranges are measured when somebody asks for them.
#[derive(Clone, Debug, Default)]
pub struct Sights(Vec<(u64, Plant)>);

impl Sights {
    /// Notes the world if it is another one than before.
    fn note(&mut self, now_us: u64, plant: &Plant) {
        let last = self.0.last();
        if last.is_none_or(|(_, last)| !last.has_world_of(plant)) {
            self.0.push((now_us, plant.clone()));
        }
    }

    fn at(&self, at_us: u64) -> Option<&Plant> {
        let after = self.0.partition_point(|(from_us, _)| *from_us <= at_us);
        Some(&self.0.get(after.checked_sub(1)?)?.1)
    }
}

/// By the worlds.
impl PartialEq for Sights {
    fn eq(&self, other: &Self) -> bool {
        let worlds = |sights: &Self| -> Vec<_> {
            let sights = sights.0.iter();
            sights
                .map(|(us, plant)| (*us, plant.world().clone()))
                .collect()
        };
        worlds(self) == worlds(other)
    }
}

/// What instruments show at one instant.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Time of the sample [us].
    pub t_us: u64,
    /// The signals, as [`Sim::read_instruments`] names them.
    pub signals: Vec<(String, f64)>,
}

/// Two unknown values are equal.
impl PartialEq for Shown {
    fn eq(&self, other: &Self) -> bool {
        let bits = |shown: &Self| -> Vec<(String, u64)> {
            let signals = shown.signals.iter();
            signals
                .map(|(name, value)| (name.clone(), value.to_bits()))
                .collect()
        };
        self.t_us == other.t_us && bits(self) == bits(other)
    }
}

/// What a USART of an emulated Mega has sent since the sample before.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UsartOutput {
    /// Time of the sample [us].
    pub t_us: u64,
    /// Which USART.
    pub usart: u8,
    /// What.
    pub bytes: Vec<u8>,
}

impl Trace {
    /// Adds a sample of the present state.
    pub fn sample(&mut self, sim: &Sim) {
        let (plant, state) = sim.physics();
        let (pose, now_us) = (state.pose(), state.now_us());
        let wrapped_rad = pose.heading_rad;
        let heading_rad = self.samples.last().map_or(wrapped_rad, |last| {
            let change = wrapped_rad - last.heading_rad;
            last.heading_rad + change
                - std::f64::consts::TAU * (change / std::f64::consts::TAU).round()
        });
        let duty = sim.duty();
        let mut sample = TruthSample {
            t_s: now_us as f64 * 1e-6,
            x_m: pose.x_m,
            y_m: pose.y_m,
            heading_rad,
            wrapped_rad,
            wheel_rad_s: plant.wheel_rad_s(state),
            duty: [duty.left.counts(), duty.right.counts()],
            seen_m: None,
            servo_rad: state.servo_rad(),
            battery_v: plant.battery_v(state),
            touching: state.touching(),
        };
        match sim.is_among_others() {
            // Their places are not kept.
            true => sample.seen_m = Some(SonarId::ALL.map(|sonar| seen_m(plant, &sample, sonar))),
            false => self.sights.note(now_us, plant),
        }
        if let Some(mega) = sim.mega().filter(|_| self.samples.is_empty()) {
            self.other_sonars = mega.firmware().other_sonars().to_vec();
        }
        self.samples.push(sample);
    }

    /// True range of a sonar at a sample, by its number: left, right, front, then the others \[m\]; infinite when nothing is
    /// within reach, not a number where there is no such sonar. Costs an exact cone query.
    pub fn range_m(&self, sample: &TruthSample, sonar: usize) -> f64 {
        match (
            sample.seen_m,
            self.sights.at(micros(sample.t_s)),
            SonarId::ALL.get(sonar),
        ) {
            (Some(seen_m), _, _) => seen_m.get(sonar).copied().unwrap_or(f64::NAN),
            (None, Some(plant), Some(sonar)) => seen_m(plant, sample, *sonar),
            _ => f64::NAN,
        }
    }

    /// The same for samples in order: in a world that stands, a sonar sees from the same place what it saw.
    pub fn ranges_m(&self, sonar: usize) -> impl FnMut(&TruthSample) -> f64 {
        let all_stands =
            matches!(&self.sights.0[..], [(_, plant)] if plant.world().bodies().is_empty());
        let mut last = None;
        move |sample| {
            let TruthSample {
                x_m,
                y_m,
                wrapped_rad,
                servo_rad,
                ..
            } = sample;
            let view = [x_m, y_m, wrapped_rad, servo_rad].map(|value| value.to_bits());
            let range_m = match last {
                Some((same, range_m)) if all_stands && same == view => range_m,
                _ => self.range_m(sample, sonar),
            };
            last = Some((view, range_m));
            range_m
        }
    }

    /// Adds what the USARTs of an emulated Mega have sent since, and what instruments and control loops show, if a reading
    /// is due.
    pub fn listen(&mut self, sim: &mut Sim) {
        let t_us = sim.now_us();
        let is_due = |last_us: u64| t_us >= last_us + READING_US;
        if sim.mega().is_some() && self.readings.last().is_none_or(|last| is_due(last.t_us)) {
            let signals = sim.read_instruments();
            self.readings.push(Shown { t_us, signals });
        }
        let last = self.loops.last();
        if last.is_none_or(|(last_us, _)| is_due(*last_us))
            && let Some(loops) = sim.loops()
        {
            self.loops.push((t_us, loops));
        }
        if let Some(mega) = sim.mega_mut() {
            let said = (0..CONSOLES).map(|usart| UsartOutput {
                t_us,
                usart,
                bytes: mega.take_console(usart),
            });
            self.consoles
                .extend(said.filter(|said| !said.bytes.is_empty()));
        }
    }

    /// All that a USART has sent.
    #[must_use]
    pub fn console(&self, usart: u8) -> Vec<u8> {
        let of_it = self.consoles.iter().filter(|said| said.usart == usart);
        of_it.flat_map(|said| said.bytes.iter().copied()).collect()
    }

    /// The samples from `from_s` to just before `until_s`.
    pub fn between(&self, from_s: f64, until_s: f64) -> &[TruthSample] {
        let index = |t_s: f64| {
            self.samples
                .partition_point(|sample| sample.t_s < t_s - 1e-9)
        };
        &self.samples[index(from_s)..index(until_s).max(index(from_s))]
    }

    /// Whether a wheel was ever driven; without that there is no driving to measure.
    pub fn drove(&self) -> bool {
        self.samples.iter().any(|sample| sample.duty != [0; 2])
    }

    /// The samples as CSV, units in the names of the columns.
    pub fn csv(&self) -> String {
        let mut text = String::from(
            "t_s,x_m,y_m,heading_rad,left_rad_s,right_rad_s,left_duty,right_duty,range_left_m,range_right_m,range_front_m,servo_rad,battery_v",
        );
        for name in &self.other_sonars {
            let _ = write!(text, ",range_{name}_m");
        }
        text.push('\n');
        for sample in &self.samples {
            let TruthSample {
                t_s,
                x_m,
                y_m,
                heading_rad,
                wrapped_rad: _,
                wheel_rad_s,
                duty,
                seen_m: _,
                servo_rad,
                battery_v,
                touching: _,
            } = sample;
            let range = |sonar| {
                let range_m = self.range_m(sample, sonar);
                match range_m.is_nan() {
                    true => String::new(),
                    // `inf` where nothing is within reach.
                    false => format!("{range_m:.5}"),
                }
            };
            let [left_m, right_m, front_m] = [0, 1, 2].map(range);
            // Writing to a string cannot fail.
            let _ = write!(
                text,
                "{t_s:.3},{x_m:.5},{y_m:.5},{heading_rad:.5},{:.4},{:.4},{},{},{left_m},{right_m},{front_m},{servo_rad:.4},{battery_v:.3}",
                wheel_rad_s[0], wheel_rad_s[1], duty[0], duty[1],
            );
            for sonar in 3..3 + self.other_sonars.len() {
                let _ = write!(text, ",{}", range(sonar));
            }
            text.push('\n');
        }
        text
    }
}

/// What a sonar of a plant sees at a sample; not a number where there is none.
fn seen_m(plant: &Plant, sample: &TruthSample, sonar: SonarId) -> f64 {
    let pose = Pose {
        x_m: sample.x_m,
        y_m: sample.y_m,
        heading_rad: sample.wrapped_rad,
    };
    let range_m = plant.range_m(sonar, micros(sample.t_s), &pose, sample.servo_rad);
    range_m.unwrap_or(f64::NAN)
}

fn micros(t_s: f64) -> u64 {
    (t_s * 1e6).round() as u64
}
