use super::*;

fn set(imu: &mut Mpu6050, register: u8, value: u8) {
    imu.address();
    imu.write(register);
    imu.write(value);
}

/// Seven values in one go, as libraries read them.
fn burst(imu: &mut Mpu6050) -> [i16; 7] {
    imu.address();
    imu.write(ACCEL_XOUT_H);
    imu.address();
    std::array::from_fn(|_| i16::from_be_bytes([imu.read(), imu.read()]))
}

fn means(imu: &mut Mpu6050, seed: u64, motion: impl Fn(f64) -> Motion) -> [f64; 7] {
    let noise = Noise::new(seed, 0);
    let mut sums = [0.0; 7];
    for ms in 1..=2_000 {
        imu.measure(
            motion(f64::from(ms) * 1e-3),
            [0.0; 2],
            u64::from(ms as u32) * 1_000,
            &noise,
        );
        if ms > 1_000 {
            let read = burst(imu);
            (0..7).for_each(|at| sums[at] += f64::from(read[at]) / 1_000.0);
        }
    }
    sums
}

#[test]
fn it_sleeps_until_it_is_woken_and_says_who_it_is() {
    let mut imu = Mpu6050::new(0, [1, 2, 3]);
    assert_eq!(means(&mut imu, 1, |_| Motion::default()), [0.0; 7]);
    imu.address();
    imu.write(WHO_AM_I);
    assert_eq!(imu.read(), 0x68);
    set(&mut imu, PWR_MGMT_1, 0);
    let rest = means(&mut imu, 1, |_| Motion::default());
    assert!((rest[2] - 16_384.0).abs() < 0.12 * 16_384.0, "{rest:?}");
    assert!((rest[3] / 340.0 + 36.53 - 25.0).abs() < 1.1, "{rest:?}");
    set(&mut imu, PWR_MGMT_1, RESET);
    assert_eq!(burst(&mut imu), [0; 7]);
}

#[test]
fn a_curve_is_felt_towards_its_centre_and_as_a_turn_in_every_range() {
    let moving = |forward_m_s, yaw_rad_s| Motion {
        forward_m_s,
        yaw_rad_s,
    };
    for (bits, range) in [(0, 1.0), (0x08, 2.0), (0x10, 4.0), (0x18, 8.0)] {
        let mut imu = Mpu6050::new(0, [1, 2, 3]);
        set(&mut imu, PWR_MGMT_1, 1);
        set(&mut imu, ACCEL_CONFIG, bits);
        set(&mut imu, GYRO_CONFIG, bits);
        let rest = means(&mut imu, 3, |_| Motion::default());
        let curve = means(&mut imu, 3, |_| moving(0.5, -1.0));
        let speeding = means(&mut imu, 3, |t_s| moving(2.0 * t_s, 0.0));
        let close = |counts: f64, expected: f64| {
            let error = counts * range / expected - 1.0;
            assert!(error.abs() < 0.04, "{bits} {counts} {expected}");
        };
        close(curve[1] - rest[1], -0.5 / ACCELERATION);
        close(curve[6] - rest[6], -1.0 / RATE);
        close(speeding[0] - rest[0], 2.0 / ACCELERATION);
    }
}

#[test]
fn a_sensor_that_is_mounted_upright_feels_gravity_and_turns_about_its_x() {
    let curve = |_| Motion {
        forward_m_s: 0.5,
        yaw_rad_s: 1.0,
    };
    let mut imu = Mpu6050::new(0, [3, 2, -1]);
    set(&mut imu, PWR_MGMT_1, 0);
    let rest = means(&mut imu, 3, |_| Motion::default());
    let turning = means(&mut imu, 3, curve);
    assert!((rest[0] - 16_384.0).abs() < 2_000.0, "{rest:?}");
    assert!(rest[2].abs() < 2_000.0, "{rest:?}");
    assert!((RATE * (turning[4] - rest[4]) - 1.0).abs() < 0.04);
    let [_, left, up, yaw] = imu.shown();
    assert!((left - 0.5).abs() < 0.8 && (up - GRAVITY).abs() < 1.0 && (yaw - 1.0).abs() < 0.4);
}

#[test]
fn its_errors_are_those_of_its_data_sheet_and_others_for_every_seed() {
    let mut offsets = Vec::new();
    for seed in 0..300 {
        let mut imu = Mpu6050::new(0, [1, 2, 3]);
        set(&mut imu, PWR_MGMT_1, 0);
        let noise = Noise::new(seed, 0);
        (1..=300).for_each(|ms| imu.measure(Motion::default(), [0.0; 2], ms * 1_000, &noise));
        offsets.push(f64::from(burst(&mut imu)[6]) / 131.0);
    }
    let rms = libm::sqrt(offsets.iter().map(|each| each * each).sum::<f64>() / 300.0);
    assert!((rms - 20.0 / 3.0).abs() < 0.7, "{rms}");
    assert!(offsets.iter().all(|each| each.abs() < 20.5));
}

#[test]
fn the_filter_takes_noise_away_as_the_data_sheet_says() {
    // 0.05 deg/s rms in 100 Hz.
    let mut imu = Mpu6050::new(0, [1, 2, 3]);
    set(&mut imu, PWR_MGMT_1, 0);
    set(&mut imu, CONFIG, 2);
    let noise = Noise::new(5, 0);
    let (mut sum, mut squares) = (0.0, 0.0);
    for ms in 1..=5_000_u64 {
        imu.measure(Motion::default(), [0.0; 2], ms * 1_000, &noise);
        if ms > 1_000 {
            let read = f64::from(burst(&mut imu)[4]) / 131.0;
            (sum, squares) = (sum + read / 4_000.0, squares + read * read / 4_000.0);
        }
    }
    let rms = libm::sqrt(squares - sum * sum);
    assert!((0.04..0.075).contains(&rms), "{rms}");
}

#[test]
fn values_come_at_the_divided_rate_and_each_with_a_pulse_or_until_it_is_read() {
    let mut imu = Mpu6050::new(0, [1, 2, 3]);
    for (register, value) in [
        (PWR_MGMT_1, 0),
        (CONFIG, 3),
        (SMPLRT_DIV, 9),
        (INT_ENABLE, 1),
    ] {
        set(&mut imu, register, value);
    }
    let noise = Noise::new(1, 0);
    let pulse = Some(Interrupt::Pulse { active: true });
    let run = |imu: &mut Mpu6050, from: u64| {
        let pulses = (from..from + 100).filter(|ms| {
            let due_us = imu.next_us();
            imu.measure(Motion::default(), [0.0; 2], ms * 1_000, &noise);
            imu.interrupt(imu.next_us() != due_us) == pulse
        });
        pulses.count()
    };
    assert_eq!(run(&mut imu, 1), 11);
    set(&mut imu, INT_PIN_CFG, 0x20);
    assert_eq!(run(&mut imu, 101), 0);
    imu.address();
    imu.write(INT_STATUS);
    assert_eq!(imu.read(), 1);
    assert_eq!(imu.interrupt(false), Some(Interrupt::Level(false)));
    assert_eq!(run(&mut imu, 201), 0);
    assert_eq!(imu.held, Some(true));
}

#[test]
fn what_is_in_the_offset_registers_is_added() {
    let mut imu = Mpu6050::new(0, [1, 2, 3]);
    set(&mut imu, PWR_MGMT_1, 1);
    let rest = means(&mut imu, 5, |_| Motion::default());
    // As libraries calibrate: what is read at rest goes back with the other sign, in coarser counts.
    for (axis, first, coarser) in [(0, XA_OFFS_H, 4.0), (6, XG_OFFS_USR_H + 4, 4.0)] {
        let counts = (-rest[axis] / coarser).round() as i16;
        let [high, low] = counts.to_be_bytes();
        set(&mut imu, first, high);
        set(&mut imu, first + 1, low);
    }
    let trimmed = means(&mut imu, 5, |_| Motion::default());
    assert!(rest[0].abs() > 20.0 && rest[6].abs() > 20.0, "{rest:?}");
    assert!(
        trimmed[0].abs() < 6.0 && trimmed[6].abs() < 4.0,
        "{trimmed:?}"
    );
    assert!(
        (trimmed[5] - rest[5]).abs() < 1.0,
        "another axis: {trimmed:?}"
    );
}
