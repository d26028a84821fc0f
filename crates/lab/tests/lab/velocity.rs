//! How soon a velocity moves the wheels, and how soon silence stops them, by the simulation's own clock: the session, the
//! link at 9600 baud, the robot's program, the plant.
#![allow(clippy::unwrap_used, clippy::panic)]

use rumbo_control::Velocity;
use rumbo_control::mode::ModeId;
use rumbo_experiment::files::Overrides;
use rumbo_lab::SimulatedRobot;
use rumbo_log::{Choice, Level, Manifest};
use rumbo_session::{Event, Extras, Host, Order, SLICE_US, SessionDriver, Target};
use rumbo_wire::Command;

struct Quiet;

impl Host for Quiet {
    fn random_id(&mut self) -> u8 {
        7
    }

    fn publish(&mut self, _: Event) {}

    fn begin_run(&mut self, _: Manifest) -> Option<(Level, String)> {
        None
    }
}

struct Bench {
    driver: SessionDriver<Quiet, SimulatedRobot>,
    wall_us: u64,
}

impl Bench {
    /// An armed robot in mode 10.
    fn new(seed: u64) -> Self {
        let choice = Choice {
            scenario: "mode8-goals".into(),
            world: None,
            rig: None,
            seed,
        };
        let robot = SimulatedRobot::new(Overrides::default(), choice).unwrap();
        assert_eq!(robot.baud(), 9_600);
        let mut driver = SessionDriver::new(Box::new(robot), Quiet, 1.0, Extras::default());
        driver.begin(0);
        let mut bench = Self { driver, wall_us: 0 };
        bench.pass(200);
        for command in [Command::Mode(ModeId::Twist), Command::Arm] {
            bench.order(Order::Robot(command));
            bench.pass(80);
        }
        bench
    }

    fn order(&mut self, order: Order) {
        self.driver.obey([order], self.wall_us).unwrap();
    }

    fn drive(&mut self, forward_m_s: f32) {
        let velocity = Velocity {
            forward_m_s,
            yaw_rad_s: 0.0,
        };
        self.order(Order::Velocity(velocity));
    }

    /// Some slices of 5 ms.
    fn pass(&mut self, slices: u64) {
        for _ in 0..slices {
            self.wall_us += SLICE_US;
            self.driver.wall_passed(self.wall_us);
            while self.driver.slice(self.wall_us).unwrap() {}
            self.driver.update(self.wall_us);
        }
    }

    fn wheel_rad_s(&mut self) -> f64 {
        self.driver.target().truth().unwrap().wheel_rad_s.left
    }

    /// Milliseconds until the wheel's speed is so, with a velocity every 50 ms if there is one.
    fn until(&mut self, forward_m_s: Option<f32>, is_so: fn(f64) -> bool) -> u64 {
        for slice in 0..400 {
            if let Some(forward_m_s) = forward_m_s
                && slice % 10 == 0
            {
                self.drive(forward_m_s);
            }
            self.pass(1);
            if is_so(self.wheel_rad_s()) {
                return (slice + 1) * SLICE_US / 1_000;
            }
        }
        panic!("it never is");
    }
}

#[test]
fn a_velocity_turns_the_wheels_within_60_ms_and_silence_stops_them() {
    let (mut starts_ms, mut stops_ms) = (Vec::new(), Vec::new());
    for seed in 0..20 {
        let mut bench = Bench::new(seed);
        for event in 0..5 {
            // At any phase of ticks, telemetry and heartbeats.
            bench.pass(60 + (7 * event + 3 * seed) % 41);
            starts_ms.push(bench.until(Some(0.2), |speed| speed > 0.0));
            for _ in 0..10 {
                bench.pass(10);
                bench.drive(0.2);
            }
            stops_ms.push(bench.until(None, |speed| speed < 0.01));
        }
    }
    starts_ms.sort_unstable();
    stops_ms.sort_unstable();
    let figures = |all: &[u64]| {
        (
            all[all.len() / 2],
            all[all.len() * 95 / 100],
            all[all.len() - 1],
        )
    };
    println!(
        "wheels turn after (median, p95, max) {:?} ms",
        figures(&starts_ms)
    );
    println!("they stand after {:?} ms of silence", figures(&stops_ms));
    assert!(figures(&starts_ms).1 <= 60, "{starts_ms:?}");
    assert!(figures(&stops_ms).2 <= 1_000, "{stops_ms:?}");
}
