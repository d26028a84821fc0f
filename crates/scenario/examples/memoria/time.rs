//! Where the chip's time goes in each mode: the loop's period, the share of time that waits for the serial line, the
//! interrupts.

use crate::experiments::Experiment;
use crate::sketch_setup;
use rumbo_emulator::observe::profile::{InterruptUse, Profile};
use rumbo_scenario::files::FileError;
use rumbo_scenario::sim::Sim;

/// From `ON` to the end of the profile [us].
const START_US: u64 = 500_000;
const END_US: u64 = 12_500_000;
const CYCLES_PER_US: f64 = 16.0;

/// A row per scenario.
pub(crate) fn table(experiments: &[&Experiment]) -> Result<String, FileError> {
    let mut text = String::from(
        "| scenario | period of the loop, median | longest | waits for the serial line | longest interrupt | worst wait of an encoder's interrupt |\n\
         |---|---|---|---|---|---|\n",
    );
    for experiment in experiments {
        text += &row(experiment)?;
    }
    Ok(text)
}

fn row(experiment: &Experiment) -> Result<String, FileError> {
    let setup = sketch_setup(experiment, &[])?;
    let mut sim = Sim::new(&setup, 1)?;
    sim.advance(START_US);
    for line in [experiment.line, "ON"] {
        sim.send(line.as_bytes());
        sim.send(b"\n");
    }
    if let (Some(firmware), Some(mega)) = (&setup.firmware, sim.mega_mut()) {
        let profile = Profile::new(firmware.image());
        mega.chip_mut().observers_mut().profile(profile);
    }
    let usart = setup.firmware.as_ref().and_then(|it| it.link_usart());
    let mut said = Vec::new();
    for at_us in (START_US..=END_US).step_by(100_000) {
        sim.advance(at_us);
        if let (Some(usart), Some(mega)) = (usart, sim.mega_mut()) {
            said.append(&mut mega.take_console(usart));
        }
    }
    let mut periods_ms = periods_ms(&said);
    periods_ms.sort_unstable();
    let Some(mega) = sim.mega() else {
        return Ok(String::new());
    };
    let Some(profile) = mega.chip().observers().profiled() else {
        return Ok(String::new());
    };
    // It waits in here until there is room in the buffer.
    let functions = profile.functions();
    let writing = functions.iter().filter(|function| {
        function.name.contains("HardwareSerial") && function.name.contains("write")
    });
    let writing = writing.map(|function| function.own).sum::<u64>();
    let interrupts = profile.interrupts();
    let us = |cycles: Option<u64>| match cycles {
        Some(cycles) => format!("{:.0} us", cycles as f64 / CYCLES_PER_US),
        None => "-".to_owned(),
    };
    let encoder = |it: &&InterruptUse| matches!(it.vector, 1 | 2);
    Ok(format!(
        "| {} | {} ms | {} ms | {:.1} % | {} | {} |\n",
        experiment.scenario,
        periods_ms.get(periods_ms.len() / 2).copied().unwrap_or(0),
        periods_ms.last().copied().unwrap_or(0),
        100.0 * writing as f64 / profile.cycles() as f64,
        us(interrupts.iter().map(|it| it.longest).max()),
        us(interrupts
            .iter()
            .filter(encoder)
            .map(|it| it.worst_latency)
            .max()),
    ))
}

/// The first column of every whole line but the first, whose period began before `ON`.
fn periods_ms(said: &[u8]) -> Vec<u32> {
    String::from_utf8_lossy(said)
        .lines()
        .skip(1)
        .filter_map(|line| line.split(',').next()?.trim().parse().ok())
        .collect()
}
