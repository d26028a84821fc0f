use super::*;
use crate::files::{Library, Overrides};

fn axes(texts: &[&str]) -> Vec<Axis> {
    texts.iter().map(|text| text.parse().unwrap()).collect()
}

fn setup() -> Setup {
    Library::new()
        .setup("mode5", &Overrides::default())
        .unwrap()
}

#[test]
fn a_grid_has_every_combination_with_the_last_axis_fastest() {
    let plan = SweepPlan::new(
        axes(&["kv=0.02,0.03", "battery.open_circuit_v=7:8:3"]),
        Design::Grid,
        7,
        2,
    )
    .unwrap();
    assert_eq!(plan.points[..3], [[0.02, 7.0], [0.02, 7.5], [0.02, 8.0]]);
    assert_eq!(plan.len(), 12);
    assert_eq!(
        [plan.job(0), plan.job(3), plan.job(11)],
        [(0, 7), (1, 8), (5, 8)]
    );
}

#[test]
fn a_sobol_sequence_fills_each_axis_evenly_and_a_seed_repeats() {
    let texts = ["front_kp=1:20:log", "battery.open_circuit_v=7:8"];
    let plan = |design, seed| {
        SweepPlan::new(axes(&texts), design, seed, 1)
            .unwrap()
            .points
    };
    let sobol = plan(Design::Sobol(64), 1);
    for (dimension, middle) in [(0, 20f64.sqrt()), (1, 7.5)] {
        let below = sobol.iter().filter(|point| point[dimension] < middle);
        assert_eq!(below.count(), 32);
    }
    for design in [Design::Sobol(64), Design::Random(64)] {
        assert_eq!(plan(design, 5), plan(design, 5));
        assert_ne!(plan(design, 5), plan(design, 6));
        let inside = |point: &Vec<f64>| (1.0..=20.0).contains(&point[0]);
        assert!(plan(design, 5).iter().all(inside));
    }
}

#[test]
fn a_plan_without_sense_is_refused_before_anything_runs() {
    let refused = |texts: &[&str], design| {
        let plan = SweepPlan::new(axes(texts), design, 1, 50);
        let Err(error) = plan.and_then(|plan| {
            plan.check(&setup())
                .map_err(|error| PlanError::Count(error.to_string()))
        }) else {
            panic!("{texts:?} is no error")
        };
        error.to_string()
    };
    for (texts, design, why) in [
        (&["kv=0.01:0.02:3", "kv=1,2"][..], Design::Grid, "two axes"),
        (&["kv=0.01:0.02"], Design::Grid, "needs a count"),
        (&["kv=0.01:0.02:4"], Design::Random(5), "leave its count"),
        (
            &["kv=0.01:0.02:5000", "ki=0:1:5000"],
            Design::Grid,
            "too many",
        ),
        (&["kv=0.01:0.02"], Design::Sobol(100_000), "Sobol"),
        (&["front_kq=1,2"], Design::Grid, "front_kp"),
        (&["battery.open_circuit_v=7,7000"], Design::Grid, "7000"),
    ] {
        let said = refused(texts, design);
        assert!(said.contains(why), "{said}");
    }
}

#[test]
fn each_run_is_that_of_its_point_and_seed_and_can_go_on_anywhere() {
    let setup = setup();
    let axes = axes(&["kv=0.02:0.04:3"]);
    let plan = SweepPlan::new(axes, Design::Grid, 3, 2).unwrap();
    let rows = |first: usize| {
        let mut rows = Vec::new();
        plan.run(
            &setup,
            first,
            2,
            || Ok(()),
            |row| {
                rows.push(row);
                Ok::<(), FileError>(())
            },
        )
        .unwrap();
        rows
    };
    let all = rows(0);
    assert_eq!(all.len(), 6);
    assert_eq!(rows(4)[..], all[4..]);
    let own = setup.with_parameters(&[("kv", 0.03)]).unwrap();
    let result = crate::run::run(&own, 4).unwrap();
    assert_eq!((all[3].point, all[3].seed), (1, 4));
    assert_eq!(
        format!("{:?}", all[3].metrics),
        format!("{:?}", result.metrics)
    );
    let sweep = SweepOutcome { plan, rows: all };
    // Half the feedforward and more of it are worse than about the right one.
    assert_eq!(sweep.ranked("rms_rad_s").len(), 3);
    let spread = sweep.spread(1, "rms_rad_s").unwrap();
    assert!(spread.low <= spread.median && spread.median <= spread.high);
    let worst = sweep.extreme(0, "rms_rad_s", true).unwrap();
    assert_eq!(worst.point, 0);
}

#[test]
fn a_row_survives_its_text_with_what_never_happened() {
    let mut metrics = crate::metrics::Metrics::new();
    metrics.insert("step1.settling_s".into(), f64::NAN);
    metrics.insert("step2.settling_s".into(), 0.1 + 0.2);
    let row = RunRow {
        point: 3,
        seed: u64::MAX,
        pass: false,
        metrics,
    };
    let text = serde_json::to_string(&row).unwrap();
    let again: RunRow = serde_json::from_str(&text).unwrap();
    assert_eq!(serde_json::to_string(&again).unwrap(), text);
    assert!(again.metrics["step1.settling_s"].is_nan());
    assert!(
        crate::metrics::worst(&again.metrics, "settling_s")
            .unwrap()
            .is_nan()
    );
    assert_eq!(crate::metrics::worst(&again.metrics, "overshoot_m"), None);
}
