//! The runs of a sweep as a table.
//!
//! One row per run: point, seed, the parameters, those of switches and choices by name, whether it passed, every metric. Empty where what is measured
//! never happened, or where the run has no such metric.

use rumbo_experiment::sweep::SweepOutcome;
use std::collections::BTreeSet;

/// Names of all metrics of any run.
fn metrics(sweep: &SweepOutcome) -> Vec<&str> {
    let names = sweep.rows.iter().flat_map(|row| row.metrics.keys());
    let names: BTreeSet<&str> = names.map(String::as_str).collect();
    names.into_iter().collect()
}

/// As comma-separated values.
pub(super) fn csv(sweep: &SweepOutcome) -> String {
    let metrics = metrics(sweep);
    let axes = sweep.plan.axes.iter().map(|axis| axis.name.as_str());
    let header: Vec<&str> = ["point", "seed"]
        .into_iter()
        .chain(axes)
        .chain(["passed"])
        .chain(metrics.iter().copied())
        .collect();
    let mut text = header.join(",") + "\n";
    for row in &sweep.rows {
        let mut cells = vec![row.point.to_string(), row.seed.to_string()];
        let values = sweep.plan.axes.iter().zip(&sweep.plan.points[row.point]);
        cells.extend(values.map(|(axis, value)| match axis.name_of(*value) {
            Some(name) => name.to_owned(),
            None => value.to_string(),
        }));
        cells.push(row.pass.to_string());
        cells.extend(metrics.iter().map(|name| {
            let value = row.metrics.get(*name).filter(|value| !value.is_nan());
            value.map(ToString::to_string).unwrap_or_default()
        }));
        text += &(cells.join(",") + "\n");
    }
    text
}
