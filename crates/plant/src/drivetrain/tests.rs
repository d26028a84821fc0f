use super::*;

const MS: f64 = 0.001;

fn smooth(params: &mut Params) {
    params.floor.roughness = 0.0;
    params.floor.slip = 0.0;
}

fn nominal() -> Drivetrain {
    let mut params = Params::default();
    smooth(&mut params);
    Drivetrain::new(&params, Noise::new(1, 0), true)
}

fn drive(drivetrain: &Drivetrain, state: &mut State, bridges: [Bridge; 2], seconds: f64) {
    drivetrain.set_bridge(state, Side::Left, bridges[0]);
    drivetrain.set_bridge(state, Side::Right, bridges[1]);
    for _ in 0..(seconds / MS).round() as usize {
        drivetrain.step(state, MS, [0.0; 2]);
    }
}

fn speeds(state: &State) -> [f64; 2] {
    [state.wheels[0].speed_rad_s, state.wheels[1].speed_rad_s]
}

#[test]
fn a_stuck_wheel_is_exactly_at_rest() {
    let drivetrain = nominal();
    let mut state = drivetrain.start();
    let angles = [state.wheels[0].angle_rad, state.wheels[1].angle_rad];
    drive(
        &drivetrain,
        &mut state,
        [Bridge::Forward(0.05), Bridge::Backward(0.05)],
        1.0,
    );
    assert!(state.wheels[0].current_a > 0.0, "the motor pulls");
    assert_eq!(speeds(&state), [0.0, 0.0]);
    assert_eq!(
        [state.wheels[0].angle_rad, state.wheels[1].angle_rad],
        angles
    );
}

#[test]
fn a_coasting_robot_slows_down_steadily_and_stays_stopped() {
    let drivetrain = nominal();
    let mut state = drivetrain.start();
    drive(&drivetrain, &mut state, [Bridge::Forward(0.6); 2], 1.0);
    let [mut before, _] = speeds(&state);
    assert!(before > 5.0, "{before} rad/s");
    for bridge in [Side::Left, Side::Right] {
        drivetrain.set_bridge(&mut state, bridge, Bridge::Released);
    }
    for _ in 0..3000 {
        drivetrain.step(&mut state, MS, [0.0; 2]);
        let [now, _] = speeds(&state);
        assert!(now < before || now == 0.0);
        assert!(now >= 0.0, "friction reversed the wheel");
        assert_eq!(state.wheels[0].current_a, 0.0);
        before = now;
    }
    assert_eq!(speeds(&state), [0.0, 0.0]);
}

#[test]
fn one_wheel_may_hold_while_the_other_turns() {
    let drivetrain = nominal();
    let mut state = drivetrain.start();
    drive(
        &drivetrain,
        &mut state,
        [Bridge::Released, Bridge::Forward(0.5)],
        1.0,
    );
    let [left, right] = speeds(&state);
    assert_eq!(left, 0.0);
    assert!(right > 3.0);
    let motion = drivetrain.step(&mut state, 1e-3, [0.0; 2]);
    let right_m = 0.0325 * motion.wheel_rad[1];
    assert!(motion.forward_m > 0.0 && (motion.forward_m - right_m / 2.0).abs() < 1e-12);
    assert!((motion.yaw_rad - right_m / 0.10).abs() < 1e-12);
}

#[test]
fn a_brake_stops_sooner_than_coasting() {
    let drivetrain = nominal();
    let way = |bridge| {
        let mut state = drivetrain.start();
        drive(&drivetrain, &mut state, [Bridge::Forward(1.0); 2], 1.0);
        let from = state.wheels[0].angle_rad;
        drive(&drivetrain, &mut state, [bridge; 2], 2.0);
        state.wheels[0].angle_rad - from
    };
    assert!(way(Bridge::Brake(1.0)) < 0.9 * way(Bridge::Released));
    assert!(way(Bridge::Brake(1.0)) < way(Bridge::Brake(0.3)));
    assert_eq!(way(Bridge::Brake(0.0)), way(Bridge::Released));
}

#[test]
fn a_faster_pwm_leaves_no_time_for_the_current_to_die() {
    let drivetrain = nominal();
    let speed = |pwm_hz| {
        let mut state = drivetrain.start();
        for _ in 0..1_000 {
            let modulation = Modulation {
                hz: pwm_hz,
                ..Modulation::default()
            };
            drivetrain.set_bridge_at(&mut state, Side::Left, Bridge::Forward(0.7), modulation);
            drivetrain.step(&mut state, 1e-3, [0.0; 2]);
        }
        state.wheels[0].speed_rad_s
    };
    let hz = Params::default().bridge.pwm_hz;
    assert_eq!(speed(None), speed(Some(hz)));
    // Twenty periods in a time constant: the mean voltage decides, and while the enable is low that is the supply's,
    // reversed.
    assert!(speed(Some(60_000.0)) < 0.9 * speed(None));
}

#[test]
fn with_the_wheels_in_the_air_less_duty_moves_them_and_the_body_stays() {
    let air = Drivetrain::new(&Params::default(), Noise::new(1, 0), false);
    let least_duty = |drivetrain: &Drivetrain| {
        (1..=255).find(|&pwm| {
            let mut state = drivetrain.start();
            drive(
                drivetrain,
                &mut state,
                [Bridge::Forward(f64::from(pwm) / 255.0); 2],
                0.05,
            );
            speeds(&state)[0] > 0.0
        })
    };
    assert!(least_duty(&air).unwrap() < least_duty(&nominal()).unwrap());
    let mut state = air.start();
    drive(&air, &mut state, [Bridge::Forward(0.5); 2], 0.5);
    let motion = air.step(&mut state, MS, [0.0; 2]);
    assert!(motion.wheel_rad[0] > 0.0);
    assert_eq!((motion.forward_m, motion.yaw_rad), (0.0, 0.0));
}

#[test]
fn backward_mirrors_forward() {
    let drivetrain = nominal();
    let (mut forward, mut backward) = (drivetrain.start(), drivetrain.start());
    drive(
        &drivetrain,
        &mut forward,
        [Bridge::Forward(0.4), Bridge::Forward(0.5)],
        0.5,
    );
    drive(
        &drivetrain,
        &mut backward,
        [Bridge::Backward(0.4), Bridge::Backward(0.5)],
        0.5,
    );
    let mirrored = speeds(&backward).map(|speed| -speed);
    assert_eq!(speeds(&forward), mirrored);
}

#[test]
fn more_duty_is_more_current_at_any_speed() {
    let drivetrain = nominal();
    for speed_rad_s in [-15.0, -5.0, 0.0, 5.0, 15.0] {
        let current = |pwm: i32| {
            let mut state = drivetrain.start();
            state.wheels[0].speed_rad_s = speed_rad_s;
            drivetrain.set_bridge(
                &mut state,
                Side::Left,
                Bridge::Forward(f64::from(pwm) / 255.0),
            );
            drivetrain.step(&mut state, MS, [0.0; 2]);
            state.wheels[0].current_a
        };
        let currents: Vec<f64> = (0..=255).map(current).collect();
        assert!(
            currents.windows(2).all(|pair| pair[1] >= pair[0]),
            "at {speed_rad_s} rad/s"
        );
    }
}

/// The closed form against the circuit's differential equation, integrated in steps of a thousandth of a period.
#[test]
fn the_mean_current_is_that_of_the_switched_circuit() {
    let diodes = Params::default();
    let mut transistors = Params::default();
    (transistors.bridge.drop_v, transistors.bridge.brake_v) = (0.0, 0.0);
    for (params, decay) in [
        (diodes, Decay::Fast),
        (diodes, Decay::Slow),
        (transistors, Decay::Slow),
    ] {
        compare_with_the_circuit(&params, decay);
    }
}

fn compare_with_the_circuit(params: &Params, decay: Decay) {
    let (r, l) = (
        params.motor.resistance_ohm + params.bridge.drop_ohm,
        params.motor.inductance_h,
    );
    for duty in [0.1, 0.3, 0.6, 0.9, 1.0] {
        for speed_rad_s in [-6.0, 0.0, 4.0, 10.0] {
            let emf_v = params.motor.back_emf_v_s * speed_rad_s;
            let supply_v = params.battery.open_circuit_v
                - params.battery.resistance_ohm * params.battery.electronics_a;
            let dt_s = 1.0 / params.bridge.pwm_hz / 1000.0;
            let (mut current_a, mut sum_a) = (0.0, 0.0);
            for period in 0..30 {
                for slice in 0..1000 {
                    let on = f64::from(slice) < duty * 1000.0;
                    let on_v = supply_v - params.bridge.drop_v;
                    let off_v = match decay {
                        Decay::Fast => -supply_v - 2.0 * params.bridge.diode_v,
                        // The loss is against the current, whose other direction is that of a brake.
                        Decay::Slow if current_a >= 0.0 => -params.bridge.brake_v,
                        Decay::Slow => params.bridge.brake_v,
                    };
                    let volts = if on { on_v } else { off_v } - emf_v;
                    let next_a = current_a + dt_s * (volts - r * current_a) / l;
                    let stops = next_a * current_a <= 0.0 && !on;
                    current_a = match decay {
                        Decay::Fast => f64::max(0.0, next_a),
                        // At rest the loss takes up what the motor generates.
                        Decay::Slow if stops && emf_v.abs() <= params.bridge.brake_v => 0.0,
                        Decay::Slow => next_a,
                    };
                    if period == 29 {
                        sum_a += current_a / 1000.0;
                    }
                }
            }
            let drivetrain = Drivetrain::new(params, Noise::new(1, 0), true);
            let mut state = drivetrain.start();
            state.wheels[1].speed_rad_s = speed_rad_s;
            let modulation = Modulation { hz: None, decay };
            drivetrain.set_bridge_at(&mut state, Side::Right, Bridge::Forward(duty), modulation);
            drivetrain.step(&mut state, MS, [0.0; 2]);
            let closed_a = state.wheels[1].current_a;
            // In continuous conduction at the border the winding does not start from zero: the closed form's error.
            assert!(
                (closed_a - sum_a).abs() < 0.01 + 0.01 * sum_a.abs(),
                "{decay:?}, duty {duty}, {speed_rad_s}: {closed_a} {sum_a}"
            );
        }
    }
}

#[test]
fn halving_the_step_hardly_changes_the_run() {
    let drivetrain = nominal();
    let run = |steps_per_ms: usize| {
        let mut state = drivetrain.start();
        for (left, right) in [(0.5, 0.5), (0.35, 0.6), (0.9, 0.3)] {
            drivetrain.set_bridge(&mut state, Side::Left, Bridge::Forward(left));
            drivetrain.set_bridge(&mut state, Side::Right, Bridge::Backward(right));
            for _ in 0..500 * steps_per_ms {
                drivetrain.step(&mut state, MS / steps_per_ms as f64, [0.0; 2]);
            }
        }
        state
    };
    let (coarse, fine) = (run(1), run(2));
    for i in 0..2 {
        assert!(
            (coarse.wheels[i].angle_rad - fine.wheels[i].angle_rad).abs() < 0.03,
            "{coarse:?} {fine:?}"
        );
        assert!((coarse.wheels[i].speed_rad_s - fine.wheels[i].speed_rad_s).abs() < 0.03);
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_seed_another_run() {
    let end = |seed| {
        let drivetrain = Drivetrain::new(&Params::default(), Noise::new(seed, 0), true);
        let mut state = drivetrain.start();
        drive(&drivetrain, &mut state, [Bridge::Forward(0.5); 2], 2.0);
        state
    };
    assert_eq!(end(3), end(3));
    assert_ne!(
        end(3).wheels[0].angle_rad - end(3).wheels[1].angle_rad,
        end(4).wheels[0].angle_rad - end(4).wheels[1].angle_rad
    );
}

#[test]
fn slip_and_floor_have_the_stated_spread() {
    let params = Params::default();
    let drivetrain = Drivetrain::new(&params, Noise::new(5, 0), true);
    let mut state = drivetrain.start();
    let (mut slip, mut floor, n) = (0.0, 0.0, 400_000);
    drive(&drivetrain, &mut state, [Bridge::Forward(0.8); 2], 0.5);
    for _ in 0..n {
        drivetrain.step(&mut state, MS, [0.0; 2]);
        slip += state.wheels[0].slip * state.wheels[0].slip / f64::from(n);
        floor += state.wheels[1].floor.value() * state.wheels[1].floor.value() / f64::from(n);
    }
    assert!((0.009..0.011).contains(&slip.sqrt()), "{}", slip.sqrt());
    assert!((0.95..1.05).contains(&floor.sqrt()), "{}", floor.sqrt());
}

#[test]
fn leaning_on_a_wall_stalls_the_wheels() {
    let drivetrain = nominal();
    let mut state = drivetrain.start();
    drive(&drivetrain, &mut state, [Bridge::Forward(0.45); 2], 0.5);
    for _ in 0..500 {
        drivetrain.step(&mut state, MS, [0.1; 2]);
    }
    assert_eq!(speeds(&state), [0.0, 0.0]);
}

#[test]
fn a_duty_that_is_no_number_releases_the_bridge() {
    let drivetrain = nominal();
    let mut state = drivetrain.start();
    drive(
        &drivetrain,
        &mut state,
        [Bridge::Forward(f64::NAN), Bridge::Forward(-1.0)],
        0.1,
    );
    assert_eq!(speeds(&state), [0.0, 0.0]);
}

#[test]
fn yaw_damping_slows_a_turn_on_the_floor_and_nothing_else() {
    let after = |damping: f64, bridges: [Bridge; 2], on_floor: bool| {
        let mut params = Params::default();
        smooth(&mut params);
        params.floor.yaw_damping_n_m_s = damping;
        let drivetrain = Drivetrain::new(&params, Noise::new(1, 0), on_floor);
        let mut state = drivetrain.start();
        drive(&drivetrain, &mut state, bridges, 1.0);
        speeds(&state)
    };
    let arc = [Bridge::Forward(0.5), Bridge::Forward(0.6)];
    let [free, damped] = [0.0, 0.05].map(|damping| after(damping, arc, true));
    assert!(damped[1] - damped[0] < 0.6 * (free[1] - free[0]));
    assert!(
        damped[0] > free[0] && damped[1] < free[1],
        "a couple: it takes from one wheel and gives to the other"
    );
    assert_eq!(after(0.0, arc, false), after(0.05, arc, false));
    let straight = [Bridge::Forward(0.5); 2];
    assert_eq!(after(0.0, straight, true), after(0.05, straight, true));
}

#[test]
fn friction_is_less_where_a_wheel_breaks_loose_and_grows_with_the_angle_and_at_rest() {
    let of = |onset_ratio: f64| {
        let mut params = Params::default();
        smooth(&mut params);
        for wheel in [&mut params.wheels.left, &mut params.wheels.right] {
            wheel.onset_ratio = onset_ratio;
        }
        Drivetrain::new(&params, Noise::new(1, 0), true)
    };
    let (growing, constant) = (of(0.5), of(1.0));
    let run = |drivetrain: &Drivetrain, seconds: f64| {
        let mut state = drivetrain.start();
        drive(drivetrain, &mut state, [Bridge::Forward(0.4); 2], seconds);
        state
    };
    let [early, late] = [0.2, 4.0].map(|seconds| {
        let (growing, constant) = (run(&growing, seconds), run(&constant, seconds));
        speeds(&growing)[0] / speeds(&constant)[0]
    });
    assert!(early > 1.05, "{early}");
    assert!((late - 1.0).abs() < 0.01, "{late}");

    // The least duty that breaks loose wheels that stood for so long after a run.
    let least = |rest_s: f64| {
        let mut rested = run(&growing, 4.0);
        while speeds(&rested) != [0.0; 2] {
            drive(&growing, &mut rested, [Bridge::Released; 2], MS);
        }
        drive(&growing, &mut rested, [Bridge::Released; 2], rest_s);
        let starts = |duty: &f64| {
            let mut state = rested;
            drive(&growing, &mut state, [Bridge::Forward(*duty); 2], 0.003);
            speeds(&state)[0] > 0.0
        };
        let mut duties = (1..255).map(|duty| f64::from(duty) / 255.0);
        duties.find(starts).unwrap()
    };
    let (at_once, later) = (least(0.0), least(5.0));
    assert!(at_once < 0.85 * later, "{at_once} {later}");
    // So long as one that never moved.
    let fresh = (1..255).map(|duty| f64::from(duty) / 255.0).find(|duty| {
        let mut state = growing.start();
        drive(&growing, &mut state, [Bridge::Forward(*duty); 2], 0.003);
        speeds(&state)[0] > 0.0
    });
    assert_eq!(fresh, Some(later));
}

#[test]
fn a_standing_tyre_scrubs_as_one_that_has_just_broken_loose() {
    let mut params = Params::default();
    smooth(&mut params);
    params.floor.scrub_n_m = 0.03;
    for wheel in [&mut params.wheels.left, &mut params.wheels.right] {
        wheel.onset_ratio = 0.5;
    }
    let drivetrain = Drivetrain::new(&params, Noise::new(1, 0), true);
    let scrub = |speed_rad_s: f64, grown: f64| {
        let wheel = WheelState {
            speed_rad_s,
            grown,
            ..drivetrain.start().wheels[0]
        };
        let of = |turning: f64| drivetrain.dry_n_m(0, &wheel, 1.0, turning);
        of(1.0) - of(0.0)
    };
    for (speed_rad_s, grown, expected) in [
        (0.0, 1.0, 0.015),
        (0.0, 0.0, 0.015),
        (1.0, 0.0, 0.015),
        (1.0, 1.0, 0.03),
    ] {
        let found = scrub(speed_rad_s, grown);
        assert!((found - expected).abs() < 1e-12, "{found} at {speed_rad_s}");
    }
}
