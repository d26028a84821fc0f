//! A session as a node of ROS 2 shows it: what is new on its board becomes messages, calls of services become orders.
//!
//! A call is answered when the robot's state shows what was asked for, or the robot has refused it. The node takes
//! control for a call, as a page does, and releases it after it; calling `take_control` keeps it. Velocities take it while
//! they drive.

use super::{RosNode, WAKE, report};
use crate::output;
use rumbo_control::mode::ModeId;
use rumbo_log::{RobotState, Scene, State};
use rumbo_ros::bridge::BridgeError;
use rumbo_ros::convert::{ConvertError, Converter, Sent, clock};
use rumbo_ros::geometry::Geometry;
use rumbo_ros::messages::DiagnosticStatus;
use rumbo_ros::node::{BadVelocity, Call, Velocity, Wish};
use rumbo_ros::types::Byte;
use rumbo_session::{News, Order, Seat};
use rumbo_station::Client;
use rumbo_wire::Command;
use std::collections::BTreeMap;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// A call is answered within this time.
const PATIENCE: Duration = Duration::from_secs(3);
/// Oldest velocity that is passed on [s]; the robot judges by the same, from there on.
const OLDEST_S: f64 = 0.3;
/// Without a velocity for this long control is released; the robot has released its wheels.
const SILENCE: Duration = Duration::from_millis(500);
/// Refusals are said this often at most.
const AGAIN: Duration = Duration::from_secs(2);
/// Diagnostics show them for this long.
const SHOWN: Duration = Duration::from_secs(4);
/// Most calls and velocities taken in a row: a flood of them does not keep messages from going out.
const AT_ONCE: usize = 64;
/// Two who send velocities within this time drive by turns.
const ALTERNATING: Duration = Duration::from_millis(500);
/// The session has certainly taken an order after this time.
const TAKEN: Duration = Duration::from_millis(50);
/// The clock of a simulation is published this often at least: a pause has a time too.
const CLOCK: Duration = Duration::from_millis(200);

/// What a service is for.
enum Service {
    /// An order for the robot, and how its state shows that it was done.
    Robot(Command, fn(&RobotState) -> bool),
    Mode(ModeId),
    TakeControl,
    ReleaseControl,
}

/// The services by name.
fn services() -> Vec<(String, Service)> {
    let services = [
        ("arm", Service::Robot(Command::Arm, |robot| robot.armed)),
        (
            "disarm",
            Service::Robot(Command::Disarm, |robot| !robot.armed),
        ),
        ("stop", Service::Robot(Command::Stop, |robot| !robot.armed)),
        (
            "clear_fault",
            Service::Robot(Command::ClearFault, |robot| robot.fault.is_none()),
        ),
        ("reset_pose", Service::Robot(Command::ResetPose, |_| true)),
        ("take_control", Service::TakeControl),
        ("release_control", Service::ReleaseControl),
    ];
    let services = services.map(|(name, service)| (name.to_owned(), service));
    let modes = ModeId::ALL.map(|mode| (format!("mode/{}", mode.name()), Service::Mode(mode)));
    services.into_iter().chain(modes).collect()
}

/// A call that waits for the robot.
struct Waiting {
    call: Call,
    since: Instant,
    /// Control is to be released with the answer.
    releases: bool,
}

/// What is known of those who send velocities.
#[derive(Default)]
struct Driving {
    /// Who sent the last one, and when it came.
    last: Option<([u8; 16], Instant)>,
    /// Another one has sent one within [`ALTERNATING`] of it.
    alternating: Option<Instant>,
    /// Control was taken for them.
    holds: bool,
    /// When one was passed on.
    passed: Option<Instant>,
    /// Why one was not passed on, and when.
    refused: Option<(String, Instant)>,
    /// The same of what was said on the terminal.
    said: Option<(String, Instant)>,
}

/// A session as a node.
pub(super) struct Live {
    node: RosNode,
    client: Client,
    simulated: bool,
    services: Vec<(String, Service)>,
    waiting: Vec<Waiting>,
    driving: Driving,
    converter: Converter,
    run: u32,
    scene: Option<Scene>,
    parameters: BTreeMap<&'static str, f32>,
    state: State,
    /// The time of a simulation [ms], and when it was published last.
    clock_ms: i64,
    clocked: Instant,
    /// The last trouble with others, and when it was said.
    trouble: Option<(String, Instant)>,
    reported: bool,
}

/// Whether there may be said more, after what was said then.
fn is_due(said: Option<&(String, Instant)>) -> bool {
    said.is_none_or(|(_, since)| since.elapsed() >= AGAIN)
}

impl Live {
    /// Offers the services.
    pub(super) fn new(
        mut node: RosNode,
        client: Client,
        simulated: bool,
        stamped: bool,
    ) -> Result<Self, BridgeError> {
        node.take_velocities(stamped)?;
        let services = services();
        services.iter().try_for_each(|(name, _)| node.offer(name))?;
        Ok(Self {
            converter: Converter::new(&node.speaker(), String::new(), 0),
            node,
            client,
            simulated,
            services,
            waiting: Vec::new(),
            driving: Driving::default(),
            run: 0,
            scene: None,
            parameters: BTreeMap::new(),
            state: State::default(),
            clock_ms: 0,
            clocked: Instant::now(),
            trouble: None,
            reported: false,
        })
    }

    /// Runs until the session is over.
    pub(super) fn run(mut self) -> Result<(), ConvertError> {
        while let Some(news) = self.client.news() {
            let has_state = news.state.is_some();
            self.convert(news)?;
            for message in self.converter.take() {
                self.publish(&message);
            }
            for _ in 0..AT_ONCE {
                match self.node.wish() {
                    Some(Wish::Call(call)) => self.begin(call),
                    Some(Wish::Drive(velocity)) => self.drive(velocity),
                    None => break,
                }
            }
            self.settle(has_state);
            self.release();
            if is_due(self.trouble.as_ref())
                && let Some(trouble) = self.node.trouble()
            {
                output::note(&format!("ROS 2: {trouble}"));
                self.trouble = Some((trouble, Instant::now()));
            }
            std::thread::sleep(WAKE);
        }
        Ok(())
    }

    fn publish(&mut self, message: &Sent) {
        let published = self.node.publish(message);
        report(published, &mut self.reported);
    }

    /// Makes messages of what is new.
    fn convert(&mut self, news: News) -> Result<(), ConvertError> {
        let has_state = news.state.is_some();
        self.state = news
            .state
            .unwrap_or_else(|| std::mem::take(&mut self.state));
        if let Some(scene) = news.scene {
            self.scene = scene;
        }
        if let Some(parameters) = news.parameters {
            let known = parameters.iter();
            self.parameters = known
                .filter_map(|known| Some((known.entry.name, known.value?)))
                .collect();
        }
        if std::mem::replace(&mut self.run, news.run) != news.run {
            self.begin_run();
        }
        let parameter = |name: &str| self.parameters.get(name).copied();
        if let Some(geometry) = Geometry::new(self.scene.as_ref(), parameter) {
            self.converter.know(geometry);
        }
        if self.simulated && (!news.samples.is_empty() || self.clocked.elapsed() >= CLOCK) {
            let state_ms = (self.state.t_s * 1e3) as i64;
            self.clock_ms = self.clock_ms.max(news.received.1).max(state_ms);
            self.clocked = Instant::now();
            self.publish(&clock(self.clock_ms.unsigned_abs() * 1_000_000)?);
        }
        for row in &news.samples {
            self.converter.row(row)?;
        }
        for event in &news.events {
            self.converter.event(event)?;
        }
        if has_state {
            let own = vec![self.status()];
            self.converter.state(&self.state, own)?;
        }
        Ok(())
    }

    fn begin_run(&mut self) {
        let scene = self.scene.as_ref().filter(|scene| !scene.of_ghost);
        let robot = scene.map(|scene| scene.robot.clone());
        // A session without a state has just begun.
        let since_start = Duration::from_secs_f64(self.state.t_s.max(0.0));
        let started = SystemTime::now() - since_start;
        let started = started.duration_since(UNIX_EPOCH).unwrap_or_default();
        let started_ns = match self.simulated {
            true => 0,
            false => u64::try_from(started.as_nanos()).unwrap_or(0),
        };
        let speaker = self.node.speaker();
        self.converter = Converter::new(&speaker, robot.unwrap_or_default(), started_ns);
        self.clock_ms = 0;
    }

    /// The node itself, for diagnostics.
    fn status(&self) -> DiagnosticStatus {
        let control = match self.client.view().seat {
            Seat::Driver => "ROS 2 has control",
            Seat::Free => "nobody has control",
            Seat::Passenger | Seat::Viewer => "a page of the dashboard has control",
        };
        let lately = |said: &&(String, Instant)| said.1.elapsed() < SHOWN;
        let refused = self.driving.refused.as_ref().filter(lately);
        let trouble = self.trouble.as_ref().filter(lately);
        let alternating = self.driving.alternating.map(|since| since.elapsed());
        let (level, message) = match (refused, trouble) {
            (Some((why, _)), _) => (1, format!("/cmd_vel: {why}")),
            (None, Some((trouble, _))) => (1, trouble.clone()),
            (None, None) if alternating.is_some_and(|since| since < SHOWN) => {
                let text = "/cmd_vel: two publishers drive by turns, the newest counts";
                (1, text.to_owned())
            }
            (None, None) => (0, control.to_owned()),
        };
        DiagnosticStatus {
            level: Byte(level),
            name: format!("{}: ROS 2", self.node.speaker()),
            message,
            ..DiagnosticStatus::default()
        }
    }

    /// Passes a velocity on, or says why not: the one way from ROS 2 to the wheels.
    fn drive(&mut self, velocity: Result<Velocity, BadVelocity>) {
        let passed = velocity
            .map_err(|BadVelocity| "it cannot be decoded".to_owned())
            .and_then(|velocity| self.pass_on(velocity));
        let Err(why) = passed else {
            return;
        };
        if is_due(self.driving.said.as_ref()) {
            output::note(&format!("ROS 2: /cmd_vel: {why}"));
            self.driving.said = Some((why.clone(), Instant::now()));
        }
        self.driving.refused = Some((why, Instant::now()));
    }

    fn pass_on(&mut self, velocity: Velocity) -> Result<(), String> {
        let now = Instant::now();
        if let Some((before, since)) = self.driving.last.replace((velocity.sender, now))
            && before != velocity.sender
            && since.elapsed() < ALTERNATING
        {
            self.driving.alternating = Some(now);
        }
        self.check_age(&velocity)?;
        // What would move nothing takes no control from the pages.
        let robot = &self.state.robot;
        if robot.mode != ModeId::Twist as u8 {
            return Err("refused, the robot is in another mode; call mode/twist".into());
        }
        if !robot.armed {
            return Err("refused, the robot is off; call arm".into());
        }
        // What is out of range is refused by the session; a number that is none does not get there.
        let number = |value: f64, what: &str| match value.is_finite() {
            true => Ok(value as f32),
            false => Err(format!("refused, its {what} is not a finite number")),
        };
        let order = Order::Velocity(rumbo_control::Velocity {
            forward_m_s: number(velocity.forward_m_s, "forward speed")?,
            yaw_rad_s: number(velocity.yaw_rad_s, "yaw rate")?,
        });
        let held = self.client.view().seat == Seat::Driver;
        self.client.order(order)?;
        self.driving.holds |= !held;
        self.driving.passed = Some(now);
        Ok(())
    }

    /// Refuses what is old, or of another time.
    fn check_age(&self, velocity: &Velocity) -> Result<(), String> {
        let now_ns = match self.simulated {
            true => self.clock_ms as f64 * 1e6,
            false => SystemTime::now()
                .duration_since(UNIX_EPOCH)
                .map_or(0.0, |since| since.as_nanos() as f64),
        };
        let stamp_s = velocity
            .stamp_ns
            .map(|stamp_ns| (now_ns - stamp_ns as f64) / 1e9);
        for (age_s, of) in [(velocity.age_s, "sent"), (stamp_s, "stamped")] {
            match age_s {
                Some(age_s) if age_s > OLDEST_S => {
                    return Err(format!("refused, it was {of} {age_s:.1} s ago"));
                }
                Some(age_s) if age_s < -OLDEST_S => {
                    let ahead_s = -age_s;
                    return Err(format!(
                        "refused, it is {of} {ahead_s:.1} s ahead of the time here; do the clocks agree?"
                    ));
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Releases the control that velocities have taken, when there are none any more.
    fn release(&mut self) {
        let is_silent = |passed: Instant| passed.elapsed() >= SILENCE;
        if self.driving.holds && self.driving.passed.is_none_or(is_silent) {
            self.driving.holds = false;
            // Releasing is never refused.
            let _ = self.client.order(Order::ReleaseControl);
        }
    }

    /// Gives the order of a call; one that does not reach the robot is answered at once.
    fn begin(&mut self, call: Call) {
        let held = self.client.view().seat == Seat::Driver;
        let Some((_, service)) = self.services.get(call.service) else {
            return;
        };
        // Control that velocities hold is released with them.
        let held = held || self.driving.holds;
        let (order, releases) = match service {
            Service::Robot(command, _) => (Order::Robot(*command), !held),
            Service::Mode(mode) => (Order::Robot(Command::Mode(*mode)), !held),
            Service::TakeControl => (Order::TakeControl, false),
            Service::ReleaseControl => (Order::ReleaseControl, false),
        };
        let for_robot = matches!(order, Order::Robot(_));
        // What is taken by a call is kept without velocities, too.
        self.driving.holds &= order != Order::TakeControl;
        match self.client.order(order) {
            Ok(()) if for_robot => self.waiting.push(Waiting {
                call,
                since: Instant::now(),
                releases,
            }),
            Ok(()) => self.answer(call, Ok(())),
            Err(why) => self.answer(call, Err(why.to_owned())),
        }
    }

    fn answer(&mut self, call: Call, done: Result<(), String>) {
        let answered = self.node.answer(call, done);
        report(answered, &mut self.reported);
    }

    /// Answers the calls whose outcome is known; `has_state`: the state is new.
    fn settle(&mut self, has_state: bool) {
        for waiting in std::mem::take(&mut self.waiting) {
            let lasts = waiting.since.elapsed();
            let known = has_state && lasts > TAKEN;
            let outcome = known.then(|| self.outcome(waiting.call)).flatten();
            let late = || Err("the robot has not confirmed it".to_owned());
            match outcome.or_else(|| (lasts > PATIENCE).then(late)) {
                None => self.waiting.push(waiting),
                Some(done) => {
                    if waiting.releases {
                        // Releasing is never refused.
                        let _ = self.client.order(Order::ReleaseControl);
                    }
                    self.answer(waiting.call, done);
                }
            }
        }
    }

    /// The outcome of a call by the robot's state, if it is known.
    fn outcome(&self, call: Call) -> Option<Result<(), String>> {
        if let Some(why) = &self.state.refused {
            return Some(Err(why.clone()));
        }
        let robot = &self.state.robot;
        let is_done = match self.services.get(call.service)? {
            (_, Service::Robot(_, shows)) => shows(robot),
            (_, Service::Mode(mode)) => robot.mode == *mode as u8,
            (_, Service::TakeControl | Service::ReleaseControl) => true,
        };
        (is_done && self.state.link.unacknowledged == 0).then_some(Ok(()))
    }
}
