//! Twenty seeds of a scenario with one program at the pins.

use rumbo_experiment::files::{Kind, Library, NativeProgram, Overrides, Setup};
use rumbo_experiment::run::{RunResult, run_all};
use rumbo_sim::trace::TruthSample;

pub(crate) const SEEDS: u64 = 20;

/// Changes to the scenario.
#[derive(Clone, Copy, Default)]
pub(crate) struct Change {
    pub(crate) program: NativeProgram,
    /// Longer than the scenario, for a program that needs it [s].
    pub(crate) duration_s: Option<f64>,
    /// Factor on the times of commands from the third on.
    pub(crate) later: Option<f64>,
    /// Without a calibration, even if the scenario has one.
    pub(crate) uncalibrated: bool,
}

/// The report's program, as it is.
pub(crate) const BASELINE: Change = Change {
    program: NativeProgram::Baseline,
    duration_s: None,
    later: None,
    uncalibrated: false,
};
pub(crate) const OURS: Change = Change {
    program: NativeProgram::Rumbo,
    ..BASELINE
};

/// The runs, and what is needed to interpret them.
pub(crate) struct Runs {
    pub(crate) setup: Setup,
    pub(crate) results: Vec<RunResult>,
    /// For each run: factor that converts distances to a speed of sound of 343.4 m/s.
    scales: Vec<f64>,
}

/// The seeds of a scenario; none if there is no such scenario yet.
pub(crate) fn runs(scenario: &str, change: Change) -> Result<Option<Runs>, String> {
    let library = Library::new();
    if !library
        .list(Kind::Scenario)
        .iter()
        .any(|name| name == scenario)
    {
        return Ok(None);
    }
    let overrides = Overrides {
        program: change.program,
        ..Overrides::default()
    };
    let mut setup = library
        .setup(scenario, &overrides)
        .map_err(|error| error.to_string())?;
    if let Some(duration_s) = change.duration_s {
        setup.scenario.duration_s = duration_s;
    }
    setup.scenario.calibrated &= !change.uncalibrated;
    for timed in setup.scenario.commands.iter_mut().skip(2) {
        timed.at_s *= change.later.unwrap_or(1.0);
    }
    let jobs: Vec<_> = (1..=SEEDS).map(|seed| (&setup, seed)).collect();
    let mut results = Vec::new();
    run_all(&jobs, |_, result| {
        results.push(result);
        Ok(())
    })
    .map_err(|error: rumbo_experiment::files::FileError| error.to_string())?;
    let scale = |seed| {
        let temperature_c = setup.sim(seed)?.params().sonar.temperature_c;
        Ok(343.42 / (331.3 + 0.606 * temperature_c))
    };
    let scales = (1..=SEEDS)
        .map(scale)
        .collect::<Result<_, rumbo_experiment::files::FileError>>()
        .map_err(|error| error.to_string())?;
    Ok(Some(Runs {
        setup,
        results,
        scales,
    }))
}

impl Runs {
    /// A signal over time in each run.
    pub(crate) fn over_time(&self, signal: impl Fn(&TruthSample) -> f64) -> Vec<Vec<(f64, f64)>> {
        self.each(|sample| (sample.t_s, signal(sample)))
    }

    /// What the front sonar measures over time in each run, by its scale of distances.
    pub(crate) fn ahead_cm(&self) -> Vec<Vec<(f64, f64)>> {
        let of_run = |(result, scale): (&RunResult, &f64)| {
            let ahead_cm = |sample| 100.0 * result.trace.range_m(sample, 2) * scale;
            let samples = result.trace.samples.iter();
            samples
                .map(|sample| (sample.t_s, ahead_cm(sample)))
                .collect()
        };
        std::iter::zip(&self.results, &self.scales)
            .map(of_run)
            .collect()
    }

    /// A curve in each run.
    pub(crate) fn each(&self, point: impl Fn(&TruthSample) -> (f64, f64)) -> Vec<Vec<(f64, f64)>> {
        let results = self.results.iter();
        results
            .map(|result| result.trace.samples.iter().map(&point).collect())
            .collect()
    }

    /// Median and worst of a metric; an event that never happened is the worst. `None` where no run has it.
    pub(crate) fn median_and_worst(&self, metric: &str, least_is_worst: bool) -> Option<[f64; 2]> {
        let mut values: Vec<f64> = self
            .results
            .iter()
            .filter_map(|result| result.metrics.get(metric).copied())
            .map(|value| if value.is_nan() { f64::INFINITY } else { value })
            .collect();
        values.sort_by(f64::total_cmp);
        let worst = if least_is_worst {
            values.first()
        } else {
            values.last()
        };
        Some([*values.get(values.len() / 2)?, *worst?])
    }
}
