//! Several robots in one world, each behind a session of its own, as the station drives them.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests too")]

use rumbo_control::Velocity;
use rumbo_control::mode::ModeId;
use rumbo_experiment::files::{Kind, Library, Overrides};
use rumbo_lab::SimulatedRobot;
use rumbo_log::{Choice, Level, Manifest};
use rumbo_session::{
    Event, Extras, Host, LinkNews, Order, SLICE_US, SessionDriver, Target, TargetError,
};
use rumbo_wire::Command;

const THREE: &str = "title = \"t\"\nrobot = \"memoria\"\nrig = \"final\"\nworld = \"open\"\nmode = \"wheel_speed\"\nduration_s = 10\n\
    [[fleet]]\nname = \"a\"\n\
    [[fleet]]\nname = \"b\"\nstart = { x_m = 1 }\n\
    [[fleet]]\nname = \"c\"\nstart = { x_m = 2 }\n";

fn choice() -> Choice {
    Choice {
        scenario: "three".into(),
        world: None,
        rig: None,
        seed: 4,
    }
}

fn robots() -> Vec<SimulatedRobot> {
    let library = Library::new().holding(Kind::Scenario, "three", THREE);
    SimulatedRobot::all(library, Overrides::default(), &choice(), 1).unwrap()
}

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

/// The sessions; the first one has the time.
struct Bench {
    drivers: Vec<SessionDriver<Quiet, SimulatedRobot>>,
    wall_us: u64,
}

impl Bench {
    fn new() -> Self {
        let drivers = robots().into_iter().map(|robot| {
            let mut driver = SessionDriver::new(Box::new(robot), Quiet, 1.0, Extras::default());
            driver.begin(0);
            driver
        });
        let mut bench = Self {
            drivers: drivers.collect(),
            wall_us: 0,
        };
        bench.pass(200);
        bench
    }

    fn order(&mut self, robot: usize, order: Order) {
        self.drivers[robot].obey([order], self.wall_us).unwrap();
    }

    /// Some slices of 5 ms.
    fn pass(&mut self, slices: u64) {
        for _ in 0..slices {
            self.wall_us += SLICE_US;
            let wall_us = self.wall_us;
            let [first, others @ ..] = &mut self.drivers[..] else {
                panic!()
            };
            others.iter_mut().for_each(|driver| driver.follow(first));
            first.wall_passed(wall_us);
            while first.slice(wall_us).unwrap() {
                others
                    .iter_mut()
                    .for_each(|driver| driver.step(wall_us).unwrap());
            }
            let mut all = self.drivers.iter_mut();
            all.by_ref().for_each(|driver| driver.update(wall_us));
        }
    }

    /// Arms robots, and has them drive for a second.
    fn drive(&mut self, robots: &[usize]) {
        for &robot in robots {
            for command in [Command::Mode(ModeId::Twist), Command::Arm] {
                self.order(robot, Order::Robot(command));
                self.pass(80);
            }
        }
        self.steer(robots);
    }

    /// Gives velocities for a second.
    fn steer(&mut self, robots: &[usize]) {
        for _ in 0..20 {
            for &robot in robots {
                let velocity = Velocity {
                    forward_m_s: 0.2,
                    yaw_rad_s: 0.0,
                };
                self.order(robot, Order::Velocity(velocity));
            }
            self.pass(10);
        }
    }

    /// Which of them turn their wheels.
    fn turning(&mut self) -> Vec<bool> {
        let drivers = self.drivers.iter_mut();
        let speeds = drivers.map(|driver| driver.target().truth().unwrap().wheel_rad_s.left);
        speeds.map(|speed| speed > 1.0).collect()
    }
}

#[test]
fn an_order_reaches_the_robot_of_its_session_and_no_other() {
    let mut bench = Bench::new();
    bench.drive(&[1]);
    assert_eq!(bench.turning(), [false, true, false]);
    bench.drive(&[0, 2]);
    assert_eq!(
        bench.turning(),
        [true, false, true],
        "robot 1 got no order since"
    );
}

#[test]
fn stop_in_each_session_stops_each_robot_at_once() {
    let mut bench = Bench::new();
    bench.drive(&[0, 1, 2]);
    assert_eq!(bench.turning(), [true; 3]);
    // As the station does it, whose STOP is one for all of them.
    for robot in 0..3 {
        bench.order(robot, Order::Robot(Command::Stop));
    }
    // Velocities no longer move them: the wheels roll out.
    bench.steer(&[0, 1, 2]);
    assert_eq!(bench.turning(), [false; 3]);
}

#[test]
fn the_first_starts_all_of_them_again_and_only_the_first() {
    let mut bench = Bench::new();
    bench.drive(&[2]);
    let x_m = |bench: &mut Bench| bench.drivers[2].target().truth().unwrap().pose.x_m;
    assert!(x_m(&mut bench) > 2.02);
    bench.order(0, Order::Reset(choice()));
    assert_eq!(x_m(&mut bench), 2.0);
    for driver in &mut bench.drivers {
        assert_eq!(driver.target().now_us(), 0);
    }
    // Their sessions go on: the link is there again.
    bench.pass(200);
    bench.drive(&[2]);
    assert_eq!(bench.turning(), [false, false, true]);

    let mut robots = robots();
    robots[0].advance(5_000).unwrap();
    assert_eq!(robots[1].reset(&choice()), Err(TargetError::NotOffered));
    assert_eq!(robots[1].now_us(), 5_000);
    robots[0].reset(&choice()).unwrap();
    assert_eq!(robots[1].now_us(), 0);
    assert_eq!(robots[0].news(), None, "it was the one who asked");
    for robot in &mut robots[1..] {
        assert_eq!(robot.news(), Some(LinkNews::Renewed));
        assert_eq!(robot.news(), None, "once");
    }
}

#[test]
fn only_the_first_passes_the_time() {
    let mut robots = robots();
    robots[1].advance(5_000).unwrap();
    assert_eq!(robots[0].now_us(), 0);
    robots[0].advance(5_000).unwrap();
    let times: Vec<u64> = robots.iter().map(|robot| robot.now_us()).collect();
    assert_eq!(times, [5_000; 3]);
    let leads: Vec<bool> = robots.iter().map(|robot| robot.abilities().pace).collect();
    assert_eq!(leads, [true, false, false]);
    let names: Vec<String> = robots.iter().map(SimulatedRobot::name).collect();
    assert_eq!(names, ["a", "b", "c"]);
}
