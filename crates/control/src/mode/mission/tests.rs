use super::*;
use crate::types::SonarView;

#[test]
fn all_that_is_remembered_fits_into_1_200_bytes() {
    let bytes = core::mem::size_of::<State>();
    assert!(bytes <= 1_200, "{bytes}");
}

/// A mission on its way to a goal, and what it decides while the left sonar answers so.
fn answered(state: &mut State, ranges_m: &[f32]) -> Action {
    let params = Params::default();
    let mission = Mission::new(&params, &Task::Goal { x_m: 3.0, y_m: 0.0 });
    let mut action = Action::default();
    let looks = ranges_m.iter().flat_map(|range_m| {
        [
            (SonarId::Left, 1.57, Range::Valid(*range_m)),
            (SonarId::Right, -1.57, Range::Clear),
            (SonarId::Front, 0.0, Range::Clear),
        ]
    });
    for (sonar, axis_rad, range) in looks {
        let view = SonarView {
            axis_rad,
            ..SonarView::default()
        };
        let mut estimate = Estimate {
            facing: (0.0, 1.0),
            reading: Some(SonarReading {
                sonar,
                range,
                view,
                servo_rad: 0.0,
            }),
            ..Estimate::default()
        };
        for _ in 0..2 {
            action = mission.step(state, &estimate).expect("no fault");
            estimate.reading = None;
        }
    }
    action
}

#[test]
fn a_sonar_that_contradicts_itself_stops_the_robot_until_it_repeats_its_ranges() {
    let drives = |action: &Action| matches!(action.drive, Drive::Twist { .. });
    let state = &mut State::default();
    state.renew();
    assert!(drives(&answered(state, &[0.8, 0.8])));
    let wild = answered(state, &[0.4, 1.1, 0.6, 1.4, 0.9, 0.3]);
    assert!(state.watch.is_wild() && !state.movement.gives_way());
    assert_eq!(wild.drive, Drive::Release);
    assert_eq!(wild.state, Phase::GiveWay as u8);
    let calm = answered(state, &[0.8, 0.8, 0.8, 0.8]);
    assert!(drives(&calm));
    assert_eq!(calm.state, Phase::GoToGoal as u8);
}
