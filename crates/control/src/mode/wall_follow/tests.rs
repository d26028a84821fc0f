use super::*;
use crate::fixtures::{params, with_ranges};
use crate::types::AgedRange;

const PAIRS: [Rig; 2] = [Rig::SidePairLeft, Rig::SidePairRight];

/// Ranges of the sonars left, right and front to walls this far away.
fn seeing(left_m: f32, right_m: f32, ahead: Range) -> Estimate {
    with_ranges([Range::Valid(left_m), Range::Valid(right_m), ahead])
}

fn first(mode: &WallFollow, estimate: &Estimate) -> Result<(f32, f32), Fault> {
    match mode.step(&mut State::default(), estimate)?.drive {
        Drive::Twist {
            forward_m_s,
            yaw_rad_s,
        } => Ok((forward_m_s, yaw_rad_s)),
        other => panic!("{other:?}"),
    }
}

/// Yaw rate towards the wall, of a robot parallel to it.
fn towards(rig: Rig, range_m: f32, reference_m: f32) -> f32 {
    let seen = seeing(range_m, range_m, Range::Clear);
    let (_, yaw_rad_s) = first(&WallFollow::new(&params(rig), &reference_m), &seen).unwrap();
    match rig {
        Rig::SidePairRight => -yaw_rad_s,
        _ => yaw_rad_s,
    }
}

#[test]
fn too_far_turns_towards_the_wall_and_too_near_away_from_it_on_either_side() {
    for rig in PAIRS {
        assert!(towards(rig, 0.5, 0.4) > 0.2, "{rig:?}");
        assert!(towards(rig, 0.3, 0.4) < -0.2, "{rig:?}");
        assert!(towards(rig, 0.4, 0.4).abs() < 1e-3, "{rig:?}");
    }
}

#[test]
fn a_robot_askew_is_straightened_on_either_side() {
    for (rig, sign) in [(Rig::SidePairLeft, 1.0), (Rig::SidePairRight, -1.0)] {
        // The front one reads less: the robot drives towards the wall.
        let seen = seeing(0.39, 0.41, Range::Clear);
        let (_, yaw_rad_s) = first(&WallFollow::new(&params(rig), &0.4), &seen).unwrap();
        assert!(sign * yaw_rad_s < -0.1, "{rig:?}: {yaw_rad_s}");
    }
}

#[test]
fn a_step_back_and_forth_leaves_no_integral_behind() {
    let params = params(Rig::SidePairLeft);
    let mode = WallFollow::new(&params, &0.3);
    let mut state = State::default();
    let seen = seeing(0.5, 0.5, Range::Clear);
    for _ in 0..500 {
        mode.step(&mut state, &seen).unwrap();
    }
    assert_eq!(state.integral_rad, 0.0);
}

fn wall_terms(mode: &WallFollow, state: &State, seen: &Estimate) -> WallTerms {
    match mode.terms(state, seen) {
        Some(ModeTerms::Wall(terms)) => terms,
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_terms_of_its_loops_add_up_to_the_heading_setpoint_and_the_yaw_rate_on_either_side() {
    for rig in PAIRS {
        let params = params(rig);
        let mode = WallFollow::new(&params, &0.4);
        let mut state = State::default();
        let mut seen = seeing(0.42, 0.42, Range::Clear);
        seen.yaw_rad_s = 0.05;
        for _ in 0..50 {
            let action = mode.step(&mut state, &seen).unwrap();
            let terms = wall_terms(&mode, &state, &seen);
            let heading_rad = terms.distance_p_rad + terms.distance_i_rad;
            // The integral has grown by a tick of 2 cm.
            let grown_rad = params.get(ParamId::WallKi) * 0.02 * TICK_S + 1e-5;
            assert!((heading_rad - action.heading_ref_rad).abs() < grown_rad);
            let sum_rad_s = terms.heading_p_rad_s + terms.heading_d_rad_s;
            let grown_rad_s = params.get(ParamId::WallHeadingKp) * grown_rad;
            match action.drive {
                Drive::Twist { yaw_rad_s, .. } => {
                    assert!((sum_rad_s - yaw_rad_s).abs() < grown_rad_s, "{terms:?}");
                }
                other => panic!("{other:?}"),
            }
        }
        let integral_rad = wall_terms(&mode, &state, &seen).distance_i_rad;
        assert!(integral_rad.abs() > 0.005, "{rig:?}");
    }
}

#[test]
fn a_bend_never_stops_the_inner_wheel_nor_overdrives_the_outer_one() {
    let params = params(Rig::Final);
    let mode = WallFollow::new(&params, &0.3);
    for ahead in [Range::Clear, Range::Valid(0.3), Range::Valid(0.16)] {
        let seen = seeing(1.2, 2.0, ahead);
        let (forward_m_s, yaw_rad_s) = first(&mode, &seen).unwrap();
        let half_m_s = 0.5 * params.get(ParamId::Base) * yaw_rad_s.abs();
        assert!(forward_m_s - half_m_s >= INNER_M_S - 1e-6, "{ahead:?}");
        assert!(forward_m_s + half_m_s <= OUTER_M_S + 1e-6, "{ahead:?}");
    }
}

#[test]
fn something_ahead_slows_it_and_then_stops_it() {
    let params = params(Rig::Final);
    let mode = WallFollow::new(&params, &0.5);
    let speed = |ahead| first(&mode, &seeing(0.5, 2.0, ahead)).map(|(forward, _)| forward);
    assert_eq!(speed(Range::Clear), Ok(mode.cruise_m_s));
    assert_eq!(speed(Range::Valid(1.0)), Ok(mode.cruise_m_s));
    assert!(speed(Range::Valid(0.18)).is_ok_and(|forward| forward < 0.1));
    assert_eq!(speed(Range::Valid(0.14)), Err(Fault::Blocked));
    assert_eq!(speed(Range::Faulty), Err(Fault::SonarFaulty));
}

#[test]
fn it_never_drives_on_a_lost_stale_or_faulty_range_beside_it() {
    let params = params(Rig::SidePairLeft);
    let mode = WallFollow::new(&params, &0.5);
    let mut state = State::default();
    let mut seen = seeing(0.5, 0.5, Range::Clear);
    mode.step(&mut state, &seen).unwrap();
    for (range, age_ticks, fault) in [
        (Range::Clear, 0, Fault::WallLost),
        (Range::Faulty, 0, Fault::SonarFaulty),
        (Range::Valid(0.5), 60, Fault::SonarStale),
    ] {
        seen.ranges[1] = AgedRange { range, age_ticks };
        let stopped = mode.step(&mut state.clone(), &seen);
        assert_eq!(stopped, Err(fault));
    }
}
