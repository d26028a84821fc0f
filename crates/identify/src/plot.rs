//! Measured against simulated: speeds of both wheels or the distances to a wall, and the PWM below.

use crate::log::{DriveLog, Seen};
use crate::replay::{Nuisance, Replay};
use crate::residuals::RANGE_SD_M;
use crate::score::RPM_PER_RAD_S;
use crate::wall;
use rumbo_plant::params::Params;
use rumbo_plot::{Curve, Ink, Panel, Plot};

/// The curves of a panel.
const CURVES: [(&str, Ink); 2] = [("measured", Ink::First), ("simulated", Ink::Second)];

/// A recorded run beside its simulation with these parameters.
#[must_use]
pub fn plot(log: &DriveLog, params: &Params, nuisance: Nuisance) -> Plot {
    let replay = Replay::new(log, params, nuisance);
    let trace = replay.whole();
    let rows = || log.rows.iter();
    let mut panels = Vec::new();
    if log.seen != Seen::Speeds {
        let errors_m = wall::errors_m(log, &trace, RANGE_SD_M);
        let per_row = errors_m.len() / log.rows.len();
        let labels = ["front sonar to the wall, cm", "rear sonar to the wall, cm"];
        for (index, of_pair) in labels.into_iter().enumerate().take(per_row) {
            let measured: Vec<f64> = rows()
                .map(|row| 100.0 * wall::reading_m(log, row, index))
                .collect();
            let simulated = measured
                .iter()
                .zip(errors_m.iter().skip(index).step_by(per_row));
            let simulated = simulated
                .map(|(cm, error_m)| cm - 100.0 * error_m)
                .collect();
            let label = if per_row == 1 {
                "distance to the wall, cm"
            } else {
                of_pair
            };
            panels.push(compared(log, label, [measured, simulated]));
        }
    } else {
        let speeds = replay.speeds(&trace);
        for (i, label) in ["left wheel, rpm", "right wheel, rpm"]
            .into_iter()
            .enumerate()
        {
            let measured = rows().map(|row| RPM_PER_RAD_S * row.speed_rad_s[i]);
            let simulated = speeds.iter().map(|speed| RPM_PER_RAD_S * speed[i]);
            panels.push(compared(
                log,
                label,
                [measured.collect(), simulated.collect()],
            ));
        }
    }
    let pwm = rows().map(|row| 127.5 * (row.duty[0] + row.duty[1]));
    let pwm = line(log, ("", Ink::First), pwm.collect());
    panels.push(Panel::new("PWM of 255, both wheels", vec![pwm]));
    Plot::over_time(panels)
}

fn compared(log: &DriveLog, label: &str, values: [Vec<f64>; 2]) -> Panel {
    let curves = CURVES.into_iter().zip(values);
    let curves = curves.map(|(look, values)| line(log, look, values));
    Panel::new(label, curves.collect())
}

/// A value of each row over time.
fn line(log: &DriveLog, (name, ink): (&str, Ink), values: Vec<f64>) -> Curve {
    let times_s = log.rows.iter().map(|row| row.at_ms as f64 / 1000.0);
    Curve::new(name, ink, times_s.zip(values).collect())
}
