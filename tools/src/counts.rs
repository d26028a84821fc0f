//! A piece of work for `cargo xtask bench --only counts`, which counts its instructions: the same ones each time, on one
//! thread, until it says how it ended. `counts` alone lists the pieces.
//!
//! `counts PIECE`; `alone IMAGE SECONDS` runs an image for so long.

use crate::pages;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::image::Image;
use rumbo_experiment::files::{Library, Overrides, Setup};
use rumbo_experiment::run::run;
use rumbo_identify::{check, stretches};
use rumbo_lab::run_log::RunSource;
use rumbo_log::{Log, LogKind};
use rumbo_plant::plant::{self, Plant};
use rumbo_plant::{contact::Pose, drivetrain::Bridge, drivetrain::Side, sonar::SonarId};
use rumbo_session::headless::record_run;
use rumbo_wire::{Decoder, FrameMessage, FromRobot, Received, Telemetry};
use std::error::Error;
use std::io::Cursor;
use std::path::Path;
use std::process::ExitCode;

type Done = Result<String, Box<dyn Error>>;

/// A name, and what does it.
type Piece = (&'static str, fn() -> Done);

const PIECES: [Piece; 11] = [
    ("emulator-pulse-in", || alone("sketches/pulse_in.elf")),
    ("emulator-text", || alone("sketches/text.elf")),
    ("emulator-rumbo", || alone("firmware/rumbo.elf")),
    ("emulator-robot", || {
        drive("mode1", Some("sketches/memoria-mode1.elf"), 1)
    }),
    ("plant", plant),
    ("headless-mode1", || drive("mode1", None, 20)),
    ("headless-mode5", || drive("mode5", None, 10)),
    ("headless-mode8-random", || drive("mode8-random", None, 2)),
    ("log", log),
    ("identify", identify),
    ("frames", frames),
];

pub(crate) fn main() -> ExitCode {
    let Some(name) = crate::arguments().next() else {
        PIECES.iter().for_each(|(name, _)| println!("{name}"));
        return ExitCode::SUCCESS;
    };
    let piece = PIECES.iter().find(|(known, _)| *known == name);
    ended(piece.map_or_else(|| Err("no such piece".into()), |(_, work)| work()))
}

pub(crate) fn chip_alone() -> ExitCode {
    let arguments: Vec<String> = crate::arguments().collect();
    ended(match &arguments[..] {
        [image, seconds] => seconds
            .parse()
            .map_err(Into::into)
            .and_then(|seconds: u64| run_chip(image.as_ref(), seconds)),
        _ => Err("give an image and seconds".into()),
    })
}

fn ended(done: Done) -> ExitCode {
    match done {
        Ok(end) => {
            println!("{end}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// A chip with nothing at its pins.
fn run_chip(path: &Path, seconds: u64) -> Done {
    let bytes = std::fs::read(path).map_err(|error| {
        let remedy = "`cargo xtask sketches` and `cargo xtask firmware` make the images";
        format!("{}: {error}; {remedy}", path.display())
    })?;
    let mut chip = Chip::new(&Image::parse(&bytes)?);
    chip.run_until(seconds * 16_000_000);
    Ok(format!("{} cycles", chip.cycle()))
}

fn alone(image: &str) -> Done {
    run_chip(&pages::built(image), 2)
}

fn setup(scenario: &str, image: Option<&str>) -> Result<Setup, Box<dyn Error>> {
    let overrides = Overrides {
        firmware: image.map(pages::built),
        ..Overrides::default()
    };
    Ok(Library::new().setup(scenario, &overrides)?)
}

fn drive(scenario: &str, image: Option<&str>, seeds: u64) -> Done {
    let mut setup = setup(scenario, image)?;
    if image.is_some() {
        setup.scenario.duration_s = 2.0;
    }
    let runs = (1..=seeds).map(|seed| run(&setup, seed));
    let passed = runs.map(|run| run.map(|run| u32::from(run.pass)));
    Ok(format!("{} passed", passed.sum::<Result<u32, _>>()?))
}

/// A minute in an empty world, a sonar after the other at 50 pings a second.
fn plant() -> Done {
    let plant = Plant::new(plant::PlantSetup::default());
    let mut state = plant.start(Pose::default());
    let mut events = 0;
    for tick in 0..6_000_u64 {
        let ripple = 0.01 * (tick % 7) as f64;
        plant.set_bridge(&mut state, Side::Left, Bridge::Forward(0.4 + ripple));
        plant.set_bridge(&mut state, Side::Right, Bridge::Forward(0.6 - ripple));
        if tick % 2 == 0 {
            plant.trigger(&mut state, SonarId::ALL[(tick / 2 % 3) as usize]);
        }
        plant.advance(&mut state, (tick + 1) * 10_000, &mut |_| events += 1);
    }
    Ok(format!("{events} events"))
}

/// The log of a run, written and read.
fn recorded() -> Result<Log, Box<dyn Error>> {
    let (library, overrides) = (Library::new(), Overrides::default());
    let mut setup = setup("mode5", None)?;
    setup.scenario.duration_s = 12.0;
    let source = RunSource {
        kind: LogKind::Run,
        library: &library,
        overrides: &overrides,
    };
    let mut bytes = Vec::new();
    source.each_robot(&setup, &run(&setup, 1)?, |manifest, run| {
        bytes = record_run(Vec::new(), manifest, run)?;
        Ok::<(), Box<dyn Error>>(())
    })?;
    Ok(Log::read(Cursor::new(bytes))?)
}

fn log() -> Done {
    Ok(format!("{} rows", recorded()?.rows.len()))
}

/// That log repeated on the plant.
fn identify() -> Done {
    let logs = stretches(Path::new("counts.mcap"), &recorded()?)?.logs;
    let runs = check(&logs, &setup("mode5", None)?.robot.plant)?;
    Ok(format!("{} stretches", runs.len()))
}

fn frames() -> Done {
    let mut decoder = Decoder::<160>::default();
    let mut whole = 0;
    for number in 0..20_000_u16 {
        let sent = FromRobot::Telemetry(Telemetry {
            t_ms: number,
            servo_rad: f32::from(number % 90) * 0.01,
            ..Telemetry::default()
        });
        for byte in sent.frame(number as u8).bytes() {
            if let Some(Received::Frame(body)) = decoder.push(*byte) {
                whole += u32::from(FromRobot::from_body(&body).is_ok());
            }
        }
    }
    Ok(format!("{whole} frames"))
}
