//! The drive layer: feedforward, reversal, saturation.

use super::*;
use crate::speed::Evenness;
use crate::speed_loop::RAMP_LEAD_RAD_S;

const TURNING: WheelMotion = WheelMotion {
    speed_rad_s: 6.0,
    believed_rad_s: 6.0,
    edges: 4,
    standing: false,
    evenness: Evenness::Unknown,
    overdue: 0,
};
const STANDING: WheelMotion = WheelMotion {
    speed_rad_s: 0.0,
    believed_rad_s: 0.0,
    edges: 0,
    standing: true,
    evenness: Evenness::Unknown,
    overdue: 0,
};

fn step(layer: &mut DriveLayer, drive: Drive, motion: WheelMotion) -> Wheels<Duty> {
    layer
        .step(&Params::default(), &drive, &Wheels::both(motion), None)
        .unwrap()
        .duty
}

fn speed(rad_s: f32) -> Drive {
    Drive::WheelSpeed(Wheels::both(rad_s))
}

#[test]
fn a_turning_wheel_is_released_until_it_stands_before_it_is_driven_back() {
    let mut layer = DriveLayer::default();
    assert!(step(&mut layer, speed(6.0), TURNING).left.counts() > 0);
    for _ in 0..20 {
        assert_eq!(
            step(&mut layer, speed(-6.0), TURNING),
            Wheels::both(Duty::RELEASED)
        );
        assert_eq!(
            step(&mut layer, Drive::Duty(Wheels::both(-0.5)), TURNING),
            Wheels::both(Duty::RELEASED)
        );
    }
    assert_eq!(layer.directions(), Wheels::both(WheelDirection::Forward));
    assert!(step(&mut layer, speed(-6.0), STANDING).left.counts() < 0);
    assert_eq!(layer.directions(), Wheels::both(WheelDirection::Backward));
}

fn wheels(left: WheelMotion, right: WheelMotion) -> Wheels<WheelMotion> {
    Wheels { left, right }
}

fn both(layer: &mut DriveLayer, left: f32, right: f32, motion: Wheels<WheelMotion>) -> [i16; 2] {
    driven(layer, Drive::WheelSpeed(Wheels { left, right }), motion)
}

fn driven(layer: &mut DriveLayer, drive: Drive, motion: Wheels<WheelMotion>) -> [i16; 2] {
    let duty = layer
        .step(&Params::default(), &drive, &motion, None)
        .unwrap()
        .duty;
    [duty.left.counts(), duty.right.counts()]
}

#[test]
fn after_a_reversal_the_wheel_that_stands_first_waits_for_the_other() {
    let mut layer = DriveLayer::default();
    both(&mut layer, 6.0, 6.0, Wheels::both(TURNING));
    for _ in 0..20 {
        let duty = both(&mut layer, -6.0, -6.0, wheels(STANDING, TURNING));
        assert_eq!(duty, [0, 0]);
    }
    let [left, right] = both(&mut layer, -6.0, -6.0, wheels(STANDING, STANDING));
    assert!(left < 0 && left == right, "{left} {right}");
}

#[test]
fn an_open_loop_reversal_starts_with_both_wheels_at_rest() {
    let mut layer = DriveLayer::default();
    let backward = Drive::Duty(Wheels::both(-0.5));
    // The left wheel comes to rest first; a jolt gives it an edge.
    for left in [STANDING, TURNING, STANDING] {
        assert_eq!(driven(&mut layer, backward, wheels(left, TURNING)), [0, 0]);
    }
    assert_eq!(
        driven(&mut layer, backward, Wheels::both(STANDING)),
        [-128, -128]
    );
    // What turns on goes on.
    let turn = Drive::Duty(Wheels {
        left: -0.5,
        right: 0.5,
    });
    assert_eq!(driven(&mut layer, turn, Wheels::both(TURNING)), [-128, 0]);
}

#[test]
fn a_wheel_that_rolls_the_right_way_gains_no_speed_while_the_other_must_stop() {
    let mut layer = DriveLayer::default();
    for _ in 0..50 {
        both(&mut layer, 6.0, 6.0, Wheels::both(TURNING));
    }
    for _ in 0..20 {
        let [left, right] = both(&mut layer, -9.0, 9.0, Wheels::both(TURNING));
        assert!(left == 0 && right > 0);
    }
    assert!(layer.wheels.right.ramp_rad_s.unwrap() <= 6.0);
    for _ in 0..20 {
        both(&mut layer, -9.0, 9.0, wheels(STANDING, TURNING));
    }
    assert!(layer.wheels.right.ramp_rad_s.unwrap() > 8.0);
}

#[test]
fn a_wheel_that_nothing_is_asked_of_holds_nobody_back() {
    let mut layer = DriveLayer::default();
    both(&mut layer, 6.0, 6.0, Wheels::both(TURNING));
    let [left, right] = both(&mut layer, -6.0, 0.0, wheels(STANDING, TURNING));
    assert!(left < 0 && right == 0);
}

#[test]
fn the_duty_never_brakes_by_reversing() {
    let mut layer = DriveLayer::default();
    let fast = WheelMotion {
        believed_rad_s: 15.0,
        ..TURNING
    };
    for _ in 0..200 {
        assert!(step(&mut layer, speed(1.0), fast).left.counts() >= 0);
    }
}

#[test]
fn a_standing_wheel_is_kicked_harder_until_it_moves() {
    let mut layer = DriveLayer::default();
    let first = step(&mut layer, speed(0.5), STANDING).left.counts();
    assert!(first >= 76, "{first}");
    let later = (0..50)
        .map(|_| step(&mut layer, speed(0.5), STANDING).left.counts())
        .last()
        .unwrap();
    assert!(later > first + 50, "{first} -> {later}");
    let moving = WheelMotion {
        speed_rad_s: 0.5,
        believed_rad_s: 0.5,
        edges: 1,
        standing: false,
        evenness: Evenness::Unknown,
        overdue: 0,
    };
    assert!(step(&mut layer, speed(0.5), moving).left.counts() < later - 30);
}

#[test]
fn a_low_battery_gets_more_duty() {
    let duty = |battery_v| {
        let mut layer = DriveLayer::default();
        let motion = Wheels::both(TURNING);
        layer
            .step(&Params::default(), &speed(6.0), &motion, battery_v)
            .unwrap()
            .duty
            .left
            .counts()
    };
    assert!(duty(Some(6.4)) > duty(Some(7.4)));
    assert_eq!(duty(Some(7.4)), duty(None));
}

#[test]
fn zero_releases_both_wheels_and_forgets() {
    let mut layer = DriveLayer::default();
    for _ in 0..50 {
        step(&mut layer, speed(8.0), TURNING);
    }
    assert_eq!(
        step(&mut layer, speed(0.0), TURNING),
        Wheels::both(Duty::RELEASED)
    );
    assert_eq!(layer.wheels.left.pid, PidState::default());
    assert_eq!(
        step(&mut layer, Drive::Release, TURNING),
        Wheels::both(Duty::RELEASED)
    );
}

#[test]
fn a_request_that_is_not_finite_is_refused() {
    for drive in [speed(f32::NAN), Drive::Duty(Wheels::both(f32::INFINITY))] {
        let mut layer = DriveLayer::default();
        assert!(
            layer
                .step(&Params::default(), &drive, &Wheels::both(STANDING), None)
                .is_err()
        );
    }
}

#[test]
fn a_held_wheel_does_not_wind_the_ramp_up() {
    let mut layer = DriveLayer::default();
    for _ in 0..500 {
        step(&mut layer, speed(20.0), STANDING);
    }
    assert!(layer.wheels.left.ramp_rad_s.unwrap() <= RAMP_LEAD_RAD_S);
}

#[test]
fn the_terms_of_a_wheel_add_up_to_its_duty_forward_and_backward() {
    let mut params = Params::default();
    params.set(ParamId::SpeedKdLeft, 0.002).unwrap();
    let battery_v = Some(7.0);
    for sign in [1.0, -1.0] {
        let (mut layer, mut turning) = (DriveLayer::default(), STANDING);
        let mut regulated = 0;
        for tick in 0u8..60 {
            let (before, motion) = (layer, Wheels::both(turning));
            let driven = layer
                .step(&params, &speed(sign * 5.0), &motion, battery_v)
                .unwrap();
            let terms = layer.terms(&before, &params, &motion, battery_v).left;
            let WheelTerms {
                pid, feedforward, ..
            } = terms.unwrap();
            let sum = pid.proportional + pid.integral + pid.derivative + feedforward;
            if !turning.standing && sign * sum > 0.0 && sign * sum < 1.0 {
                let duty = f32::from(driven.duty.left.counts());
                assert!((255.0 * sum - duty).abs() <= 0.51, "{tick}: {sum} {duty}");
                assert!(tick < 2 || pid.derivative != 0.0);
                regulated += 1;
            }
            // It breaks away, then comes near its reference with a ripple.
            turning = WheelMotion {
                believed_rad_s: 0.1 * f32::from(tick) + 0.2 * f32::from(tick % 3),
                ..TURNING
            };
        }
        assert!(regulated > 50, "{regulated}");
        let (before, motion) = (layer, Wheels::both(STANDING));
        step(&mut layer, Drive::Release, STANDING);
        let released = layer.terms(&before, &params, &motion, battery_v);
        assert_eq!(released, Wheels::both(None));
    }
}
