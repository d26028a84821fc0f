use super::steps::warnings;
use super::*;

#[test]
fn the_closing_line_counts_every_step() {
    let outcomes = [
        Outcome::Passed,
        Outcome::Failed("x".to_owned()),
        Outcome::Passed,
        Outcome::Skipped("y".to_owned()),
    ];
    assert_eq!(tally(outcomes.iter()), "2 passed, 1 failed, 1 skipped");
}

#[test]
fn a_missing_tool_is_a_skip_at_home_and_a_failure_in_ci() {
    let missing = || Err(Stop::Missing("install it".to_owned()));
    assert_eq!(
        judge(missing(), false),
        Outcome::Skipped("install it".to_owned())
    );
    assert_eq!(
        judge(missing(), true),
        Outcome::Failed("not checked: install it".to_owned())
    );
}

#[test]
fn a_warning_of_any_unit_is_found_once() {
    let warning = r#"{"reason":"compiler-message","message":{"level":"warning","rendered":"warning: unused\n"}}"#;
    let artifact = r#"{"reason":"compiler-artifact","fresh":true}"#;
    let messages = [artifact, warning, warning, "no JSON"].join("\n");
    assert_eq!(warnings(&messages), ["warning: unused\n"]);
    assert!(warnings(artifact).is_empty());
}

/// Else they would be left out.
#[test]
fn the_lane_begins_before_its_steps() {
    let place = |name: &str| STEPS.iter().position(|step| step.name == name);
    let first = place(BESIDE.0).expect(BESIDE.0);
    for name in BESIDE.1 {
        assert!(place(name).expect(name) > first, "{name}");
    }
}

#[test]
fn every_step_is_in_the_help() {
    assert!(STEPS.iter().all(|step| help().contains(step.what)));
}
