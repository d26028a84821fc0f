//! Use of the chip's time in each mode: the loop's period, the share spent waiting, the latency from an echo to the
//! wheels, the interrupts.

use crate::memoria::experiments::Experiment;
use crate::memoria::{our_setup, sketch_setup};
use rumbo_emulator::devices::Level;
use rumbo_emulator::observe::profile::{InterruptUse, Profile};
use rumbo_experiment::files::{FileError, Setup};
use rumbo_experiment::run::run_by;
use rumbo_sim::Sim;

/// From `ON` to the end of the profile [us].
const START_US: u64 = 500_000;
const END_US: u64 = 12_500_000;
/// Time between two samples of the robot [us].
const STEP_US: u64 = 10_000;
const CYCLES_PER_US: f64 = 16.0;
/// Ours: nothing that is set sooner after an echo has seen it, for outputs follow the inputs by 3 ms.
const OUTPUT_DELAY_US: u64 = 3_000;
/// Period of our loop [ms].
const PERIOD_MS: f64 = 10.0;
/// The Arduino core's functions that do nothing but wait, beside those that are inlined: of `delay` and `pulseIn` little else is left.
const WAITING: [&str; 3] = ["micros", "delay", "countPulseASM"];
/// Vectors of the encoders' interrupts, and of our tick.
const ENCODERS: [u8; 2] = [1, 2];
const TICK: u8 = 17;

/// Times of a program in one scenario.
#[derive(Debug, Default)]
pub(crate) struct Times {
    /// Of the loop: median, longest [ms].
    pub(crate) period_ms: [f64; 2],
    /// Share of time spent waiting: for the serial line, in all.
    pub(crate) waits: [f64; 2],
    /// From the end of an echo to the next change of a motor's PWM, median [ms].
    pub(crate) echo_to_pwm_ms: Option<f64>,
    /// The longest interrupt [us].
    pub(crate) interrupt_us: f64,
    /// The longest that an encoder's interrupt waited [us].
    pub(crate) encoder_us: Option<f64>,
}

/// What is recorded of a run besides the profile.
#[derive(Default)]
struct Notes {
    begun: bool,
    /// Between cycles and the run's time [us].
    offset_us: u64,
    echoes_us: Vec<u64>,
    driven_us: Vec<u64>,
}

impl Notes {
    /// Samples the robot; begins the profile the first time.
    fn look(&mut self, setup: &Setup, sim: &mut Sim) {
        let now_us = sim.now_us();
        let driven_us = sim.driven_us();
        let (Some(firmware), Some(mega)) = (&setup.firmware, sim.mega_mut()) else {
            return;
        };
        let chip = mega.chip_mut();
        if !self.begun {
            self.begun = true;
            chip.observers_mut().profile(Profile::new(firmware.image()));
            chip.record_levels();
            self.offset_us = (chip.cycle() as f64 / CYCLES_PER_US) as u64 - now_us;
        }
        let signals = firmware.signals();
        let is_echo = |level: &Level| {
            let mut names = signals.iter().filter(|(_, pin)| *pin == level.pin);
            names.any(|(name, _)| name.contains("echo"))
        };
        let mut falls = chip.take_levels();
        falls.retain(|level| !level.high && is_echo(level));
        let at_us = |level: &Level| {
            ((level.cycle as f64 / CYCLES_PER_US) as u64).saturating_sub(self.offset_us)
        };
        self.echoes_us.extend(falls.iter().map(at_us));
        if self.driven_us.last() != Some(&driven_us) {
            self.driven_us.push(driven_us);
        }
    }

    /// From an echo to the first change of PWM `after_us` or later, where one comes within a period; median [ms].
    fn echo_to_pwm_ms(&self, after_us: u64, period_ms: f64) -> Option<f64> {
        let within_us = after_us + (1_000.0 * period_ms) as u64;
        let follows = |echo_us: &u64| {
            let driven = self.driven_us.iter().find(|us| **us >= echo_us + after_us);
            driven
                .map(|us| us - echo_us)
                .filter(|took_us| *took_us <= within_us)
        };
        let mut took_us: Vec<u64> = self.echoes_us.iter().filter_map(follows).collect();
        took_us.sort_unstable();
        took_us
            .get(took_us.len() / 2)
            .map(|took_us| *took_us as f64 / 1_000.0)
    }
}

/// The report's program.
pub(crate) fn of_the_sketch(experiment: &Experiment) -> Result<Times, FileError> {
    let setup = sketch_setup(experiment)?;
    let mut sim = setup.sim(1)?;
    sim.advance(START_US);
    for line in [experiment.line.as_str(), "ON"] {
        sim.send(line.as_bytes());
        sim.send(b"\n");
    }
    let usart = setup.firmware.as_ref().and_then(|it| it.link_usart());
    let (mut said, mut notes) = (Vec::new(), Notes::default());
    for at_us in (START_US..=END_US).step_by(STEP_US as usize) {
        sim.advance(at_us);
        notes.look(&setup, &mut sim);
        if let (Some(usart), Some(mega)) = (usart, sim.mega_mut()) {
            said.append(&mut mega.take_console(usart));
        }
    }
    let mut periods_ms = periods_ms(&said);
    periods_ms.sort_unstable();
    let median_ms = periods_ms.get(periods_ms.len() / 2).copied();
    let median_ms = f64::from(median_ms.unwrap_or(0));
    let longest_ms = f64::from(periods_ms.last().copied().unwrap_or(0));
    let times = Times {
        period_ms: [median_ms, longest_ms],
        echo_to_pwm_ms: notes.echo_to_pwm_ms(0, median_ms),
        ..Times::default()
    };
    Ok(with_profile(times, &sim))
}

/// Ours.
pub(crate) fn of_ours(experiment: &Experiment) -> Result<Times, FileError> {
    let setup = our_setup(experiment)?;
    let (mut notes, mut times) = (Notes::default(), Times::default());
    run_by(&setup, 1, |run| {
        while !run.is_over() && run.sim().now_us() < END_US {
            run.advance();
            if run.sim().now_us() >= START_US {
                notes.look(&setup, run.sim());
            }
        }
        times = with_profile(Times::default(), run.sim());
        Ok::<(), FileError>(())
    })?;
    times.echo_to_pwm_ms = notes.echo_to_pwm_ms(OUTPUT_DELAY_US, PERIOD_MS);
    Ok(times)
}

/// The same with the profile's figures.
fn with_profile(times: Times, sim: &Sim) -> Times {
    let chip = sim.mega().map(rumbo_sim::mega::Mega::chip);
    let Some(profile) = chip.and_then(|chip| chip.observers().profiled()) else {
        return times;
    };
    // It waits in these until there is room in the buffer, time has passed, an echo has come.
    let functions = profile.functions();
    let share = |cycles: u64| cycles as f64 / profile.cycles() as f64;
    let writing = functions
        .iter()
        .filter(|one| one.name.contains("HardwareSerial") && one.name.contains("write"));
    let waiting = functions
        .iter()
        .filter(|one| WAITING.iter().any(|name| one.name.starts_with(name)));
    let serial = share(writing.map(|one| one.own).sum());
    let others = share(waiting.map(|one| one.own).sum());
    let interrupts = profile.interrupts();
    let us = |cycles: u64| cycles as f64 / CYCLES_PER_US;
    let encoder = |it: &&InterruptUse| ENCODERS.contains(&it.vector);
    let tick = interrupts.iter().find(|it| it.vector == TICK);
    let ours = tick.map(|tick| {
        let median_ms = us(profile.cycles()) / 1_000.0 / tick.count as f64;
        [median_ms, PERIOD_MS + us(tick.worst_latency) / 1_000.0]
    });
    Times {
        period_ms: match times.period_ms {
            [0.0, _] => ours.unwrap_or_default(),
            time => time,
        },
        waits: [serial, serial + others],
        interrupt_us: us(interrupts.iter().map(|it| it.longest).max().unwrap_or(0)),
        encoder_us: interrupts
            .iter()
            .filter(encoder)
            .map(|it| us(it.worst_latency))
            .reduce(f64::max),
        ..times
    }
}

/// The first column of every whole line but the first, whose period began before `ON`.
fn periods_ms(said: &[u8]) -> Vec<u32> {
    String::from_utf8_lossy(said)
        .lines()
        .skip(1)
        .filter_map(|line| line.split(',').next()?.trim().parse().ok())
        .collect()
}
