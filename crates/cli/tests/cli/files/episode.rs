//! The log of a robot that a program in Python stepped: it has what a run's has, and says that it cannot be run again.

use super::{rumbo_in, status};
use crate::support::stderr;
use rumbo_control::Wheels;
use rumbo_control::mode::ModeId;
use rumbo_experiment::batch::{Batch, DrivenBy};
use rumbo_experiment::files::{Library, Overrides};
use rumbo_lab::run_log::RunSource;
use rumbo_log::LogKind;
use rumbo_station::headless::record_run;
use rumbo_station::log_file;
use rumbo_wire::Command;

#[test]
fn an_episode_s_log_has_the_robot_the_goal_and_the_truth_and_is_not_run_again() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (library, overrides) = (Library::new(), Overrides::default());
    let setup = library.setup("mode8-random", &overrides).unwrap();
    let mut batch = Batch::new(&setup, DrivenBy::Caller, &[4]).unwrap();
    let robot = batch.robot_mut(0).unwrap();
    let source = RunSource {
        kind: LogKind::Episode,
        library: &library,
        overrides: &overrides,
    };
    assert!(source.episode(&setup, robot, |_, _| ()).unwrap().is_none());
    robot.record().unwrap();
    assert!(source.episode(&setup, robot, |_, _| ()).unwrap().is_none());
    for command in [Command::Mode(ModeId::WheelSpeed), Command::Arm] {
        robot.command(&command).unwrap();
    }
    robot.advance(50);
    let wheels = Wheels {
        left: 5.0,
        right: 4.0,
    };
    robot.command(&Command::WheelReference(wheels)).unwrap();
    robot.advance(250);
    let path = folder.join("x.mcap");
    let written = source.episode(&setup, robot, |manifest, run| {
        record_run(&path, manifest, run)
    });
    written.unwrap().unwrap().unwrap();

    let log = log_file::read(&path).unwrap();
    assert_eq!(log.manifest.as_ref().unwrap().kind, LogKind::Episode);
    assert!(log.outcome.is_none() && log.cut.is_none());
    // The last one may wait for a tick that is not here any more.
    assert!((74..=75).contains(&log.rows.len()), "{}", log.rows.len());
    let samples = &robot.trace().unwrap().samples;
    for row in &log.rows {
        let sample = samples
            .iter()
            .find(|each| (each.t_s * 1e3).round() as i64 == row.t_ms);
        let (sample, x_m) = (sample.unwrap(), row.signal("true_x_m").unwrap());
        assert!((sample.x_m - x_m).abs() < 1e-4, "{} ms", row.t_ms);
    }
    let last = log.rows.last().unwrap();
    assert!((last.signal("left_ref_rad_s").unwrap() - 5.0).abs() < 0.01);
    assert!((last.signal("left_rad_s").unwrap() - 5.0).abs() < 1.0);
    assert_eq!(last.signal("armed"), Some(1.0));
    let state = log.states.last().unwrap();
    assert!(state.link.connected && state.link.frames_lost == 0);
    assert_eq!(state.robot.task.goal, robot.goal_m());
    assert!(state.robot.task.goal.is_some());
    let said: Vec<_> = log.events().map(|(_, _, text)| text.to_owned()).collect();
    let sent: Vec<_> = said
        .iter()
        .filter(|text| text.starts_with("sent"))
        .collect();
    assert_eq!(sent.len(), 2, "{said:?}");

    for (command, why) in [
        (&["rerun", "x.mcap"][..], "a program in Python drove"),
        (&["replay", "x.mcap", "--ghost"], "without a link"),
    ] {
        let output = rumbo_in(folder, command);
        assert_eq!(status(&output), 2, "{}", stderr(&output));
        assert!(stderr(&output).contains(why), "{}", stderr(&output));
    }
}

#[test]
fn a_run_s_log_has_the_goal_that_its_robot_was_given_until_it_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    rumbo_in(folder, &["run", "mode8-goals", "--seed", "1", "--out", "o"]);
    let log = log_file::read(&folder.join("o/mode8-goals-1.mcap")).unwrap();
    let goals: Vec<_> = log
        .states
        .iter()
        .map(|state| state.robot.task.goal)
        .collect();
    assert!(goals.contains(&None) && goals.iter().any(Option::is_some));
    assert!(goals.last().unwrap().is_none(), "{goals:?}");
}
