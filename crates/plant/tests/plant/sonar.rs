//! Many pings: the errors of the readings are those that the parameters state.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use rumbo_plant::noise::Noise;
use rumbo_plant::params;
use rumbo_plant::sonar::{Sonar, SonarId, State, View};
use rumbo_plant::world::{Wall, World};

fn wall_at(x_m: f64) -> World {
    World::new(
        &[Wall {
            from_m: [x_m, -5.0],
            to_m: [x_m, 5.0],
            thickness_m: 0.0,
        }],
        &[],
    )
    .unwrap()
}

/// Noise-free rangers, for a test to change in one respect.
fn clean() -> params::Sonar {
    params::Sonar {
        jitter_m: 0.0,
        noise_m: 0.0,
        disturbed_weakness: 1.0,
        outlier_rate: 0.0,
        loss_rate: 0.0,
        crosstalk: 0.0,
        crosstalk_bounce: 0.0,
        ..params::Sonar::default()
    }
}

fn view(speed_m_s: f64) -> View {
    View {
        at: [0.0, 0.0],
        axis_rad: 0.0,
        speed_m_s,
    }
}

/// Echo pulse widths, in microseconds, of pings 60 ms apart; `None` for a time-out.
fn pulses_us(params: &params::Sonar, range_m: f64, speed_m_s: f64, pings: u64) -> Vec<Option<u64>> {
    let sonar = Sonar::new(params, Noise::new(9, 0));
    let (world, mut states) = (wall_at(range_m), [State::default(); 3]);
    (0..pings)
        .map(|i| {
            let now_us = i * 60_000;
            assert!(sonar.trigger(
                &mut states,
                SonarId::Front,
                now_us,
                &world,
                &view(speed_m_s)
            ));
            pulse_us(&mut states, SonarId::Front, now_us + 60_000)
                .filter(|&width_us| width_us < 38_000)
        })
        .collect()
}

fn pulse_us(states: &mut [State; 3], id: SonarId, until_us: u64) -> Option<u64> {
    let (mut rise_us, mut width_us) = (0, None);
    Sonar::advance(&mut states[id.index()], until_us, |edge| {
        if edge.level {
            rise_us = edge.at_us;
        } else {
            width_us = Some(edge.at_us - rise_us);
        }
    });
    width_us
}

fn range_m(pulse_us: u64) -> f64 {
    pulse_us as f64 * 1e-6 * (331.3 + 0.606 * 20.0) / 2.0
}

fn sd(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / n).sqrt()
}

fn readings_m(params: &params::Sonar, at_m: f64, speed_m_s: f64) -> Vec<f64> {
    pulses_us(params, at_m, speed_m_s, 5_000)
        .into_iter()
        .flatten()
        .map(range_m)
        .collect()
}

#[test]
fn a_clean_sonar_reads_the_wall_to_the_microsecond() {
    for at_m in [0.1, 0.57, 2.4] {
        assert!(
            readings_m(&clean(), at_m, 0.0)
                .iter()
                .all(|range_m| (range_m - at_m).abs() < 1e-4)
        );
    }
    assert!(
        pulses_us(&clean(), 2.6, 0.0, 10)
            .iter()
            .all(Option::is_none),
        "out of reach"
    );
    assert!(
        readings_m(&clean(), 0.01, 0.0)
            .iter()
            .all(|range_m| (range_m - 0.02).abs() < 1e-4)
    );
}

#[test]
fn jitter_has_its_standard_deviation() {
    let params = params::Sonar {
        jitter_m: 0.001,
        ..clean()
    };
    assert!((sd(&readings_m(&params, 1.0, 0.0)) / 0.001 - 1.0).abs() < 0.04);
}

#[test]
fn weak_echoes_slip_whole_cycles_more_in_motion_and_far_away() {
    let params = params::Sonar {
        noise_m: 0.006,
        rest_weakness: 0.3,
        ..clean()
    };
    let cycle_m = 0.5 * (331.3 + 0.606 * 20.0) / params.carrier_hz;
    let at_rest = readings_m(&params, 0.57, 0.0);
    assert!(at_rest.iter().all(|range_m| {
        let cycles = (range_m - 0.57) / cycle_m;
        (cycles - cycles.round()).abs() < 0.05
    }));
    // In motion the spread is over a cycle, so that rounding adds a twelfth of its square.
    let expected_m = (0.006_f64.powi(2) + cycle_m * cycle_m / 12.0).sqrt();
    assert!((sd(&readings_m(&params, 0.57, 0.3)) / expected_m - 1.0).abs() < 0.04);
    assert!(sd(&at_rest) < 0.003);
    assert!(sd(&readings_m(&params, 0.9, 0.0)) > 2.0 * sd(&at_rest));
    let (far, farther) = (readings_m(&params, 1.0, 0.3), readings_m(&params, 2.0, 0.3));
    assert!(
        (sd(&far) / sd(&farther) - 1.0).abs() < 0.04,
        "it grows no more"
    );
    assert!(
        sd(&readings_m(&params, 0.1, 0.0)) < 1e-9,
        "an echo from near is strong"
    );
}

#[test]
fn outliers_and_losses_come_at_their_rates() {
    let params = params::Sonar {
        outlier_rate: 0.05,
        fault_growth: 0.0,
        loss_rate: 0.02,
        ..clean()
    };
    let pulses = pulses_us(&params, 1.0, 0.0, 20_000);
    let lost = pulses.iter().filter(|pulse| pulse.is_none()).count() as f64 / 20_000.0;
    assert!((lost / 0.02 - 1.0).abs() < 0.15, "{lost}");
    let ranges: Vec<f64> = pulses.into_iter().flatten().map(range_m).collect();
    assert!(
        ranges
            .iter()
            .all(|range_m| (1.0 - params.outlier_span..1.0001).contains(range_m))
    );
    let short =
        ranges.iter().filter(|&&range_m| range_m < 0.999).count() as f64 / ranges.len() as f64;
    assert!((short / 0.05 - 1.0).abs() < 0.1, "{short}");
}

/// Pairs of pings, the second `gap_us` after the first; widths of the second's pulses.
fn second_of_a_pair(params: &params::Sonar, gap_us: u64, second_axis_rad: f64) -> Vec<f64> {
    let sonar = Sonar::new(params, Noise::new(9, 0));
    let mut world = wall_at(0.5);
    world
        .add_wall(&Wall {
            from_m: [-5.0, 0.8],
            to_m: [5.0, 0.8],
            thickness_m: 0.0,
        })
        .unwrap();
    let mut states = [State::default(); 3];
    (0..4_000)
        .map(|i| {
            let now_us = i * 200_000;
            let second = View {
                axis_rad: second_axis_rad,
                ..view(0.0)
            };
            sonar.trigger(&mut states, SonarId::Left, now_us, &world, &view(0.0));
            pulse_us(&mut states, SonarId::Left, now_us + gap_us);
            sonar.trigger(
                &mut states,
                SonarId::Right,
                now_us + gap_us,
                &world,
                &second,
            );
            pulse_us(&mut states, SonarId::Left, now_us + 100_000);
            range_m(pulse_us(&mut states, SonarId::Right, now_us + 100_000).unwrap())
        })
        .collect()
}

#[test]
fn outliers_are_rare_until_the_echo_is_weak() {
    let params = params::Sonar {
        outlier_rate: 0.01,
        noise_growth: 3.2,
        ..clean()
    };
    let share = |at_m: f64| {
        let ranges = readings_m(&params, at_m, 0.3);
        ranges
            .iter()
            .filter(|&&range_m| range_m < at_m - 1e-3)
            .count() as f64
            / ranges.len() as f64
    };
    assert!((share(params.noise_range_m) / 0.01 - 1.0).abs() < 0.4);
    assert!(share(0.3) < 0.001);
    assert!(share(0.8) > 0.1);
}

#[test]
fn two_pings_in_the_air_are_mistaken_for_each_other() {
    let params = params::Sonar {
        crosstalk: 0.4,
        ..clean()
    };
    let short = |ranges: Vec<f64>, true_m: f64| {
        ranges
            .iter()
            .filter(|&&range_m| range_m < true_m - 0.01)
            .count() as f64
            / ranges.len() as f64
    };
    // The other's echo comes a millisecond early: 17 cm short.
    let share = short(second_of_a_pair(&params, 1_000, 0.0), 0.5);
    assert!((share / 0.4 - 1.0).abs() < 0.1, "{share}");
    assert_eq!(
        short(second_of_a_pair(&params, 20_000, 0.0), 0.5),
        0.0,
        "20 ms later nothing is left in the air"
    );
    let aside = short(
        second_of_a_pair(&params, 1_000, std::f64::consts::FRAC_PI_2),
        0.8,
    );
    assert_eq!(aside, 0.0, "one that looks aside does not hear it");
}

#[test]
fn a_second_echo_from_beyond_its_reach_shortens_and_disturbs_no_reading() {
    let params = params::Sonar {
        crosstalk_bounce: 0.1,
        disturbed_weakness: 10.0,
        noise_m: 0.0005,
        bounce_reach_m: 0.49,
        ..clean()
    };
    let ranges = second_of_a_pair(&params, 3_800, 0.0);
    assert!(ranges.iter().all(|range_m| (range_m - 0.5).abs() < 0.001));
}

#[test]
fn right_after_a_ping_its_second_echo_shortens_the_next_reading() {
    let params = params::Sonar {
        crosstalk_bounce: 0.1,
        ..clean()
    };
    // The second echo arrives at 450 + 6,058 us and the way to the body and back; the next sonar's own at 3,800 + 450 +
    // 2,913.
    let ranges = second_of_a_pair(&params, 3_800, 0.0);
    let short: Vec<f64> = ranges
        .iter()
        .copied()
        .filter(|&range_m| range_m < 0.499)
        .collect();
    assert!(
        (short.len() as f64 / ranges.len() as f64 / 0.1 - 1.0).abs() < 0.2,
        "{}",
        short.len()
    );
    let expected_m = 0.5 + 0.5 + params.bounce_behind_m - 0.003_8 * (331.3 + 0.606 * 20.0) / 2.0;
    assert!(
        short
            .iter()
            .all(|range_m| (range_m - expected_m).abs() < 0.001),
        "{short:?}"
    );
}
