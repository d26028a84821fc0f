//! A log names the model that it was made with, and `rerun` reports a different one first.

use super::{rumbo_in, scenario, status};
use crate::support::{stderr, stdout};
use rumbo_log::{Manifest, Truth};
use rumbo_session::headless::RunRecords;
use rumbo_station::headless::record_run;
use rumbo_station::log_file;

#[test]
fn a_run_of_another_model_that_differs_reports_the_model_first() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("task.toml"), scenario("t", 0.2)).unwrap();
    rumbo_in(folder, &["run", "task.toml", "--out", "o"]);
    let log = log_file::read(&folder.join("o/task-1.mcap")).unwrap();
    let recorded = log.manifest.clone().unwrap();
    let here = rumbo_experiment::MODEL;
    assert_eq!(recorded.model, Some(here));
    let rerun = |model, metric: f64| {
        let mut outcome = log.outcome.clone().unwrap();
        *outcome.metrics.get_mut("telemetry_hz").unwrap() += metric;
        let manifest = Manifest {
            model,
            ..recorded.clone()
        };
        let run = RunRecords {
            truths: &[(200_000, Truth::default())],
            link: &log.link,
            said: &log.said,
            outcome: Some(outcome),
            ..RunRecords::default()
        };
        record_run(&folder.join("x.mcap"), &manifest, run).unwrap();
        let output = rumbo_in(folder, &["rerun", "x.mcap"]);
        assert_eq!(stderr(&output), "");
        (status(&output), stdout(&output))
    };
    let (status, said) = rerun(Some(here + 1), 1.0);
    let first = format!(
        "x.mcap: recorded with model {}, this is model {here}: robot or world changed between them; differs first at",
        here + 1
    );
    assert!(status == 1 && said.starts_with(&first), "{said}");
    let (status, said) = rerun(None, 1.0);
    let first = format!("x.mcap: recorded before models had numbers, this is model {here}: ");
    assert!(status == 1 && said.starts_with(&first), "{said}");
    let (status, said) = rerun(Some(here), 1.0);
    assert!(
        status == 1 && said.starts_with("x.mcap: differs first at"),
        "{said}"
    );
    let (status, said) = rerun(Some(here + 1), 0.0);
    assert!(status == 0 && said.starts_with("x.mcap: equal"), "{said}");
}
