use super::*;
use proptest::prelude::*;

/// A disc with uneven poles turning at a speed that depends on time, as seen by the interrupt.
struct Disc {
    places: [f32; 8],
    angle_edges: f64,
    next: u32,
    edges: Edges,
    poles: [u32; 8],
    /// Whether its edge of this number arrives.
    arrives: fn(u32) -> bool,
}

impl Disc {
    fn new(places: [f32; 8]) -> Self {
        Self {
            places,
            angle_edges: 0.0,
            next: 1,
            edges: Edges::default(),
            poles: [0; 8],
            arrives: |_| true,
        }
    }

    fn edge(&mut self, us: u32) {
        let pole = &mut self.poles[usize::from(self.edges.count % 8)];
        if self.edges.count >= 8 {
            self.edges.turn_us = us - *pole;
        }
        *pole = us;
        self.edges.last = Micros(us);
        self.edges.count = self.edges.count.wrapping_add(1);
    }

    /// Turns for one tick that ends at `now_us`, in steps of 1 us.
    fn tick(&mut self, start_us: u32, speed_rad_s: f64) -> Edges {
        for us in start_us..start_us + 10_000 {
            self.angle_edges += speed_rad_s * 1e-6 / f64::from(EDGE_RAD);
            let pole = self.next as usize % 8;
            if self.angle_edges >= f64::from(self.next) + f64::from(self.places[pole]) {
                if (self.arrives)(self.next) {
                    self.edge(us);
                }
                self.next += 1;
            }
        }
        self.edges
    }
}

const UNEVEN: [f32; 8] = [0.05, -0.04, 0.02, -0.05, 0.05, -0.02, 0.03, -0.05];

fn speeds(
    places: [f32; 8],
    ticks: u32,
    speed: impl Fn(u32) -> f64,
) -> std::vec::Vec<(f64, f32, bool)> {
    let (mut disc, mut estimator) = (Disc::new(places), SpeedEstimator::default());
    (0..ticks)
        .map(|tick| {
            let edges = disc.tick(tick * 10_000, speed(tick));
            let motion = estimator.step(&edges, Micros((tick + 1) * 10_000));
            (speed(tick), motion.speed_rad_s, motion.standing)
        })
        .collect()
}

extern crate std;

#[test]
fn uneven_poles_do_not_ripple_a_steady_speed() {
    for rpm in [20.0, 60.0, 100.0, 150.0] {
        let w = rpm / 60.0 * core::f64::consts::TAU;
        for (_, estimate, _) in speeds(UNEVEN, 200, |_| w).into_iter().skip(30) {
            assert!(
                (f64::from(estimate) / w - 1.0).abs() < 0.002,
                "{rpm} rpm: {estimate} of {w}"
            );
        }
    }
}

#[test]
fn a_wheel_that_speeds_up_is_followed_within_a_tenth() {
    let ramp = |tick: u32| 2.0 + 20.0 * f64::from(tick) * 0.01;
    for (truth, estimate, _) in speeds(UNEVEN, 60, ramp).into_iter().skip(5) {
        assert!(
            (f64::from(estimate) - truth).abs() < 0.1 * truth + 0.25,
            "{estimate} of {truth}"
        );
    }
}

#[test]
fn when_edges_stop_the_estimate_falls_and_the_wheel_stands_within_50_ms() {
    let seen = speeds(UNEVEN, 60, |tick| if tick < 50 { 6.0 } else { 0.0 });
    assert!(seen[51].1 < 2.0, "{:?}", seen[51]);
    let stood = seen
        .iter()
        .skip(50)
        .position(|(_, speed, standing)| *standing && *speed == 0.0);
    assert!(stood.is_some_and(|ticks| ticks <= 5), "{stood:?}");
}

/// Pulses half as long as the pauses, and the poles of [`UNEVEN`].
const LOPSIDED: [f32; 8] = [0.2, -0.15, 0.17, -0.2, 0.2, -0.17, 0.18, -0.2];

/// Of 300 ticks in which a wheel speeds up, turns and slows down, those with uneven edges.
fn uneven(mut disc: Disc) -> usize {
    let mut estimator = SpeedEstimator::default();
    let uneven = |tick: &u32| {
        let tick = *tick;
        let speed = f64::from(tick.min(300 - tick).min(80)) * 0.01 * 20.0;
        let edges = disc.tick(tick * 10_000, speed);
        let motion = estimator.step(&edges, Micros((tick + 1) * 10_000));
        motion.evenness == Evenness::Uneven
    };
    (0..300).filter(uneven).count()
}

#[test]
fn a_disc_is_even_whatever_its_poles_and_however_its_speed_changes() {
    for places in [[0.0; 8], UNEVEN, LOPSIDED] {
        assert_eq!(uneven(Disc::new(places)), 0, "{places:?}");
    }
}

/// The most overdue edges in a second in which a wheel changes from one speed to another.
fn most_overdue(arrives: fn(u32) -> bool, speed: impl Fn(u32) -> f64) -> u8 {
    let mut disc = Disc {
        arrives,
        ..Disc::new(LOPSIDED)
    };
    let mut estimator = SpeedEstimator::default();
    let overdue = |tick: u32| {
        let edges = disc.tick(tick * 10_000, speed(tick));
        estimator.step(&edges, Micros((tick + 1) * 10_000)).overdue
    };
    (0..100).map(overdue).max().unwrap_or(0)
}

#[test]
fn edges_that_a_rolling_wheel_owes_are_overdue_within_two_ticks() {
    // 6.7 rad/s are 4.1 edges a tick: the last one of 200 comes in tick 49.
    let overdue = most_overdue(|edge| edge < 200, |_| 6.7);
    assert!(overdue >= 8, "{overdue}");
}

#[test]
fn a_speed_that_falls_as_no_wheel_can_is_believed_bit_by_bit() {
    let mut disc = Disc {
        arrives: |edge| edge < 200 || edge.is_multiple_of(2),
        ..Disc::new(UNEVEN)
    };
    let mut estimator = SpeedEstimator::default();
    let mut before_rad_s = 0.0;
    for tick in 0..60 {
        let edges = disc.tick(tick * 10_000, 6.7);
        let motion = estimator.step(&edges, Micros((tick + 1) * 10_000));
        assert!(motion.believed_rad_s >= motion.speed_rad_s);
        if tick > 10 {
            assert!(motion.believed_rad_s > before_rad_s - 0.61);
        }
        before_rad_s = motion.believed_rad_s;
    }
}

#[test]
fn a_wheel_that_brakes_hard_owes_hardly_an_edge() {
    for speed in [2.0, 6.7, 15.0] {
        let braked = |tick: u32| (speed - 0.3 * f64::from(tick.saturating_sub(50))).max(0.0);
        // A pole may stand a fifth of its pitch off.
        assert!(most_overdue(|_| true, braked) <= 1, "{speed} rad/s");
    }
}

#[test]
fn lost_edges_are_uneven() {
    let kinds: [fn(u32) -> bool; 3] = [
        |edge| edge % 10 != 0,
        // Half of them, by no rule.
        |edge| edge.wrapping_mul(edge).wrapping_mul(2_654_435_769) >> 31 == 0,
        // A worn magnet: a pole of the disc.
        |edge| edge % 8 > 1,
    ];
    for arrives in kinds {
        for places in [UNEVEN, LOPSIDED] {
            let disc = Disc::new(places);
            let ticks = uneven(Disc { arrives, ..disc });
            assert!(ticks >= 30, "{ticks}");
        }
    }
}

#[test]
fn lost_edges_of_a_slow_wheel_are_uneven_too() {
    fn drawn(edge: u32) -> u32 {
        edge.wrapping_mul(edge).wrapping_mul(2_654_435_769) >> 16
    }
    // What arrives makes 1 to 3 rad/s.
    let kinds: [fn(u32) -> bool; 3] = [
        |edge| drawn(edge).is_multiple_of(2),
        |edge| drawn(edge).is_multiple_of(4),
        |edge| drawn(edge).is_multiple_of(6),
    ];
    for arrives in kinds {
        let mut disc = Disc {
            arrives,
            ..Disc::new(UNEVEN)
        };
        let mut estimator = SpeedEstimator::default();
        let uneven = |tick: &u32| {
            let edges = disc.tick(*tick * 10_000, 6.0);
            let motion = estimator.step(&edges, Micros((*tick + 1) * 10_000));
            motion.evenness == Evenness::Uneven
        };
        let ticks = (0..200).filter(uneven).count();
        // Four are enough, where none is even.
        assert!(ticks >= 4, "{ticks}");
    }
}

#[test]
fn a_wheel_at_five_rpm_does_not_count_as_standing() {
    let seen = speeds([0.0; 8], 300, |_| 5.0 / 60.0 * core::f64::consts::TAU);
    assert!(seen.iter().skip(20).all(|(_, _, standing)| !standing));
}

#[test]
fn the_clock_may_wrap() {
    let mut estimator = SpeedEstimator::default();
    let at = |us: u32, count: u16| {
        (
            Edges {
                count,
                last: Micros(us),
                turn_us: 0,
            },
            Micros(us.wrapping_add(500)),
        )
    };
    let (edges, now) = at(u32::MAX - 3_999, 0);
    estimator.step(&edges, now);
    let (edges, now) = at(u32::MAX - 3_999, 1);
    estimator.step(&edges, now);
    let (edges, now) = at(4_000, 5);
    let motion = estimator.step(&edges, now);
    assert!((motion.speed_rad_s - 4.0 * EDGE_RAD / 8e-3).abs() < 1e-3);
}

proptest! {
    #[test]
    fn no_edges_make_a_speed_that_is_not_finite(inputs in prop::collection::vec((0u16..40, any::<u32>(), any::<u32>()), 1..100)) {
        let (mut estimator, mut count) = (SpeedEstimator::default(), 0u16);
        for (new, last, turn_us) in inputs {
            count = count.wrapping_add(new);
            let motion = estimator.step(&Edges { count, last: Micros(last), turn_us }, Micros(last));
            prop_assert!(motion.speed_rad_s.is_finite() && motion.speed_rad_s >= 0.0);
        }
    }
}
