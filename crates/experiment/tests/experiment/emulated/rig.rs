//! A robot with an image on an emulated Mega, and a person at the other end of its Bluetooth link.

use rumbo_experiment::files::{Library, Overrides, Setup};
use rumbo_sim::Sim;
use std::path::PathBuf;

/// Path of a sketch's image; `None` where the sketches have not been built.
pub(crate) fn image(sketch: &str) -> Option<PathBuf> {
    let target = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let path = target
        .parent()
        .unwrap()
        .join(format!("sketches/{sketch}.elf"));
    if path.exists() {
        return Some(path);
    }
    let remedy = format!("{} is missing: run `cargo xtask sketches`", path.display());
    assert!(std::env::var_os("CI").is_none(), "{remedy}");
    println!("skipped: {remedy}");
    None
}

/// A scenario with a sketch in the final wiring.
pub(crate) fn setup(scenario: &str, sketch: &str, world: Option<&str>) -> Option<Setup> {
    let overrides = Overrides {
        world: world.map(str::to_owned),
        rig: Some("final".into()),
        firmware: Some(image(sketch)?),
        wiring: Some("final".into()),
        ..Overrides::default()
    };
    Some(Library::new().setup(scenario, &overrides).unwrap())
}

/// The person and the robot.
#[derive(Clone)]
pub(crate) struct Person {
    pub(crate) sim: Sim,
    pub(crate) received: Vec<u8>,
}

impl Person {
    /// Before a robot with the sketch `bench`, the same in every run but for its noise.
    pub(crate) fn at_the_bench(scenario: &str, world: Option<&str>) -> Option<Person> {
        let setup = setup(scenario, "bench", world)?;
        let mut person = Person {
            sim: setup.sim(1).unwrap(),
            received: Vec::new(),
        };
        // The Arduino core is ready after a few milliseconds.
        person.wait_s(0.05);
        Some(person)
    }

    /// Sends a line; the robot has received it when this returns.
    pub(crate) fn send(&mut self, line: &str) {
        self.sim.send(line.as_bytes());
        self.sim.send(b"\n");
        self.wait_s(0.03 + 0.001_1 * line.len() as f64);
    }

    /// To whole milliseconds: elsewhere a stop would split a step of the plant.
    pub(crate) fn wait_s(&mut self, s: f64) {
        let until_us = self.sim.now_us() + (s * 1e3).ceil() as u64 * 1_000;
        self.sim.advance(until_us);
        self.sim.receive(&mut self.received);
    }

    /// The robot's answer to a line.
    pub(crate) fn ask(&mut self, line: &str) -> String {
        self.received.clear();
        self.send(line);
        self.wait_s(0.15);
        String::from_utf8_lossy(&self.received).trim().to_owned()
    }

    /// The numbers in the answer.
    pub(crate) fn ask_numbers(&mut self, line: &str) -> Vec<f64> {
        let answer = self.ask(line);
        let words = answer.split_whitespace();
        words.filter_map(|word| word.parse().ok()).collect()
    }

    /// Mean speed of both wheels over the next half second [rad/s].
    pub(crate) fn speed_rad_s(&mut self) -> f64 {
        let before = self.sim.truth().wheel_rad;
        self.wait_s(0.5);
        let after = self.sim.truth().wheel_rad;
        (after[0] - before[0] + after[1] - before[1]) / (2.0 * 0.5)
    }

    /// The same, some time after a line was sent.
    pub(crate) fn speed_after(&mut self, line: &str) -> f64 {
        self.send(line);
        self.wait_s(0.7);
        self.speed_rad_s()
    }
}
