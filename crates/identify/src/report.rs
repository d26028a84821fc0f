//! Identification in words: tables for a terminal.

use crate::fit::{Identification, SDS_95};
use crate::replay::Nuisance;
use crate::score::{RunScore, WheelError};
use std::collections::BTreeMap;
use std::fmt;

/// Share of the knowledge from the runs below which a parameter does not count as identified.
const SHOWN: f64 = 0.5;

impl fmt::Display for Identification {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{:<42}{:>10}  {:>10}  {:<12}from the runs",
            "parameter", "value", "+- (95 %)", "unit"
        )?;
        for parameter in &self.parameters {
            let unit = match &*parameter.unit {
                "1" => "",
                unit => unit,
            };
            let value = significant(parameter.value);
            let uncertainty = significant(SDS_95 * parameter.uncertainty);
            let share = 100.0 * parameter.from_runs;
            for key in &parameter.keys {
                writeln!(
                    f,
                    "{key:<42}{value:>10}  {uncertainty:>10}  {unit:<12}{share:.0} %"
                )?;
            }
        }
        self.write_hardly_shown(f)?;
        writeln!(
            f,
            "wheels start to turn at PWM {:.0} in the air, {:.0} on the floor; cost of the fit {:.1}",
            self.dead_zone_air_pwm, self.dead_zone_floor_pwm, self.cost
        )?;
        self.runs.iter().try_for_each(|run| write!(f, "{run}"))
    }
}

impl Identification {
    /// What the runs hardly show, by the experiment that would.
    fn write_hardly_shown(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut by_experiment: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for parameter in &self.parameters {
            if parameter.from_runs < SHOWN {
                let names = by_experiment.entry(parameter.shown_by).or_default();
                names.extend(parameter.keys.first().map(String::as_str));
            }
        }
        by_experiment.iter().try_for_each(|(experiment, names)| {
            let names = names.join(", ");
            writeln!(f, "these runs hardly show {names}; what does: {experiment}")
        })
    }
}

impl fmt::Display for RunScore {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Nuisance {
            battery_v,
            floor_scale,
            scrub_scale,
        } = self.nuisance;
        let name = &self.name;
        write!(
            f,
            "\n{name}: battery {battery_v:.2} V, floor friction x {floor_scale:.2}"
        )?;
        if self.whole_turning.is_some() {
            write!(f, ", scrubbing x {scrub_scale:.2}")?;
        }
        writeln!(f)?;
        if let Some(range_rmse_m) = self.range_rmse_m {
            writeln!(
                f,
                "  distance to the wall, over 3 s: RMSE {:.1} cm",
                100.0 * range_rmse_m
            )?;
        }
        for (what, wheels) in [
            ("whole run, open loop", &self.whole),
            ("  straight stretches", &self.whole_straight),
            ("  turns on the spot", &self.whole_turning),
            ("0.5 s ahead", &self.ahead),
            ("  straight stretches", &self.ahead_straight),
            ("  turns on the spot", &self.ahead_turning),
        ] {
            let Some([left, right]) = wheels else {
                continue;
            };
            // A run without turns is all straight stretches.
            if self.whole_turning.is_some() || !what.starts_with("  ") {
                writeln!(
                    f,
                    "  {what:<24}left {}  right {}",
                    words(left),
                    words(right)
                )?;
            }
        }
        Ok(())
    }
}

fn words(error: &WheelError) -> String {
    format!("RMSE {:>5.2} rpm, R^2 {:>6.3}", error.rmse_rpm, error.r2)
}

/// Four significant digits.
pub(crate) fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let digits = 3 - value.abs().log10().floor() as i32;
    let scale = 10_f64.powi(digits);
    format!("{}", (value * scale).round() / scale)
}
