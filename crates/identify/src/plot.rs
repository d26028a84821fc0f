//! Measured against simulated: speeds of both wheels or the distance ahead, and the PWM below.

use crate::chart::{Chart, Curve, PALETTE, over_time};
use crate::log::{DriveLog, Seen};
use crate::replay::{Nuisance, Replay};
use crate::score::{RPM_PER_RAD_S, start_range_m};
use rumbo_plant::params::Params;

/// Names of the curves, in the order of the palette.
const MEASURED_AND_SIMULATED: [&str; 2] = ["measured", "simulated"];

/// The charts of a recorded run beside its simulation with these parameters; the first one is titled with the run's
/// name.
#[must_use]
pub fn plot<'a>(log: &'a DriveLog, params: &Params, nuisance: Nuisance) -> Vec<Chart<'a>> {
    let replay = Replay::new(log, params, nuisance);
    let trace = replay.whole();
    let rows = || log.rows.iter();
    let mut charts = Vec::new();
    if log.seen == Seen::FrontRange {
        let start_m = start_range_m(log, &trace);
        let measured = rows().map(|row| 100.0 * row.range_m).collect();
        let simulated = rows().map(|row| 100.0 * (start_m - trace.way_m[row.at_ms]));
        let values = [measured, simulated.collect()];
        charts.push(compared(log, "distance to the wall, cm", values));
    } else {
        let speeds = replay.speeds(&trace);
        for (i, label) in ["left wheel, rpm", "right wheel, rpm"]
            .into_iter()
            .enumerate()
        {
            let measured = rows().map(|row| RPM_PER_RAD_S * row.speed_rad_s[i]);
            let simulated = speeds.iter().map(|speed| RPM_PER_RAD_S * speed[i]);
            charts.push(compared(
                log,
                label,
                [measured.collect(), simulated.collect()],
            ));
        }
    }
    let pwm = rows().map(|row| 127.5 * (row.duty[0] + row.duty[1]));
    let pwm = line(log, 0, "", pwm.collect());
    charts.push(over_time("", "PWM of 255, mean of both wheels", vec![pwm]));
    if let Some(first) = charts.first_mut() {
        first.title = &log.name;
    }
    charts
}

fn compared(log: &DriveLog, label: &'static str, values: [Vec<f64>; 2]) -> Chart<'static> {
    let curves = MEASURED_AND_SIMULATED.into_iter().zip(values).enumerate();
    let curves = curves.map(|(i, (name, values))| line(log, i, name, values));
    over_time("", label, curves.collect())
}

/// A value of each row over time.
fn line(log: &DriveLog, colour: usize, name: &'static str, values: Vec<f64>) -> Curve<'static> {
    let times_s = log.rows.iter().map(|row| row.at_ms as f64 / 1000.0);
    Curve::Line {
        name,
        colour: PALETTE[colour],
        points: times_s.zip(values).collect(),
    }
}
