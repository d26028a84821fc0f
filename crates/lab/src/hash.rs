//! A run in one number: equal numbers are equal runs, to the last bit, on any machine.

use crate::program::Held;
use rumbo_experiment::files::{FileError, Setup};
use rumbo_experiment::run::{self, RunResult};
use rumbo_log::{Entry, Row};
use rumbo_sim::trace::{Trace, TruthSample};

const CRC: crc::Crc<u64> = crc::Crc::<u64>::new(&crc::CRC_64_XZ);

/// Runs a setup with a seed, by the native program or an image (name and bytes of its file), as fast as it
/// goes. Returns the CRC-64 of the ground truth, of all bytes on the link and the USARTs of each robot, and of the
/// metrics.
///
/// # Errors
/// No image for its robot, or values that do not fit together.
pub fn run_hash(
    mut setup: Setup,
    seed: u64,
    image: Option<(&str, &[u8])>,
) -> Result<u64, FileError> {
    if let Some((name, bytes)) = image {
        setup.firmware = Some(Held::new(name, bytes)?.firmware(&setup, None)?);
    }
    Ok(of(&run::run(&setup, seed)?))
}

/// Telemetry is on the board this long after its time at the latest, or was lost \[ms\].
const UNDER_WAY_MS: u64 = 1_000;

/// A session's run up to this time of the target: the CRC-64 of all bytes on the link before it, and of all signals, ground
/// truth among them, but those of its last second, which may be under way.
#[must_use]
pub fn recorded_hash<'a>(entries: impl IntoIterator<Item = &'a Entry>, until_us: u64) -> u64 {
    let signals_ms = (until_us / 1_000).saturating_sub(UNDER_WAY_MS) as i64;
    // Apart: which of both comes first depends on how often the session was asked.
    let (mut link, mut signals) = (CRC.digest(), CRC.digest());
    for entry in entries {
        match entry {
            Entry::Burst(burst) if burst.t_us < until_us => {
                link.update(&burst.t_us.to_le_bytes());
                link.update(&[u8::from(burst.to_robot)]);
                link.update(&burst.bytes);
            }
            Entry::Rows(rows) => {
                for row in rows.iter().filter(|row| row.t_ms < signals_ms) {
                    let values = (0..Row::names().count()).filter_map(|column| row.get(column));
                    values.for_each(|value| signals.update(&bits(value)));
                }
            }
            _ => {}
        }
    }
    link.update(&signals.finalize().to_le_bytes());
    link.finalize()
}

fn of(result: &RunResult) -> u64 {
    let mut digest = CRC.digest();
    // Of several robots each has its own trace.
    for RunResult { trace, .. } in std::iter::once(result).chain(&result.robots) {
        for sample in &trace.samples {
            values_of(trace, sample).for_each(|value| digest.update(&bits(value)));
        }
        for burst in trace.link.iter() {
            digest.update(&burst.t_us.to_le_bytes());
            digest.update(&[u8::from(burst.to_robot)]);
            digest.update(burst.bytes);
        }
        for said in &trace.consoles {
            digest.update(&said.t_us.to_le_bytes());
            digest.update(&[said.usart]);
            digest.update(&said.bytes);
        }
    }
    for (name, value) in &result.metrics {
        digest.update(name.as_bytes());
        digest.update(&bits(*value));
    }
    digest.finalize()
}

fn values_of(trace: &Trace, sample: &TruthSample) -> impl Iterator<Item = f64> {
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
        touching,
    } = *sample;
    let [left, right] = duty.map(f64::from);
    let touching = f64::from(u8::from(touching));
    let rest = [
        t_s,
        x_m,
        y_m,
        heading_rad,
        left,
        right,
        servo_rad,
        battery_v,
        touching,
    ];
    let range_m = [0, 1, 2].map(|sonar| trace.range_m(sample, sonar));
    rest.into_iter().chain(wheel_rad_s).chain(range_m)
}

/// Not a number has many bit patterns, which processors choose as they like.
fn bits(value: f64) -> [u8; 8] {
    let value = if value.is_nan() { f64::NAN } else { value };
    value.to_bits().to_le_bytes()
}
