//! A session as a node of ROS 2 shows it: what is new on its board becomes messages, calls of services become orders.
//!
//! The node takes control with an order, as a page does, and releases it when nothing lasts that needs it: no call, no
//! velocity, no goal; calling `take_control` keeps it.

use super::calls::{Service, Waiting, services};
use super::drive::Driving;
use super::goal::Navigation;
use super::parameters::Parameters;
use super::{RosNode, WAKE, definitions, report};
use crate::args::NodeArgs;
use crate::output;
use rumbo_log::{Scene, State};
use rumbo_ros::bridge::BridgeError;
use rumbo_ros::convert::{ConvertError, Converter, Sent, clock};
use rumbo_ros::geometry::Geometry;
use rumbo_ros::messages::DiagnosticStatus;
use rumbo_ros::node::Wish;
use rumbo_ros::types::Byte;
use rumbo_session::{News, Order, Seat};
use rumbo_station::Client;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// The robot confirms an order within this time, or it is reported that it has not.
pub(super) const PATIENCE: Duration = Duration::from_secs(3);
/// Refusals are said this often at most.
pub(super) const AGAIN: Duration = Duration::from_secs(2);
/// Diagnostics show them for this long.
pub(super) const SHOWN: Duration = Duration::from_secs(4);
/// Most requests and velocities taken in a row: a flood of them does not keep messages from going out.
const AT_ONCE: usize = 64;
/// The session has certainly taken an order after this time.
pub(super) const TAKEN: Duration = Duration::from_millis(50);
/// The clock of a simulation is published this often at least: a pause has a time too.
const CLOCK: Duration = Duration::from_millis(200);

/// What the times of a session are.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Times {
    /// Of day.
    OfDay,
    /// Of a simulation, whose clock the node publishes.
    Simulated,
    /// Of a simulation, whose clock another robot's node publishes.
    SimulatedWithOthers,
}

/// A session as a node.
pub(super) struct Live {
    pub(super) node: RosNode,
    client: Client,
    times: Times,
    pub(super) services: Vec<(String, Service)>,
    pub(super) waiting: Vec<Waiting>,
    pub(super) driving: Driving,
    pub(super) navigation: Navigation,
    pub(super) parameters: Parameters,
    pub(super) converter: Converter,
    /// Control was taken with an order, to be released after it.
    borrows: bool,
    run: u32,
    scene: Option<Scene>,
    pub(super) state: State,
    /// Telemetry frames of the run.
    pub(super) rows: u64,
    /// The time of a simulation [ms], and when it was published last.
    clock_ms: i64,
    clocked: Instant,
    /// The last trouble with others, and when it was said.
    trouble: Option<(String, Instant)>,
    pub(super) reported: bool,
}

/// Whether there may be said more, this long after what was said last.
pub(super) fn is_due(said: Option<&(String, Instant)>, after: Duration) -> bool {
    said.is_none_or(|(_, since)| since.elapsed() >= after)
}

impl Live {
    /// Offers the services, the parameters and the action.
    pub(super) fn new(
        mut node: RosNode,
        client: Client,
        times: Times,
        args: &NodeArgs,
    ) -> Result<Self, BridgeError> {
        node.take_velocities(args.stamped)?;
        let services = services();
        services.iter().try_for_each(|(name, _)| node.offer(name))?;
        node.offer_parameters()?;
        node.offer_navigation()?;
        Ok(Self {
            converter: Converter::new(&node.speaker(), String::new(), 0),
            node,
            client,
            times,
            services,
            waiting: Vec::new(),
            driving: Driving::default(),
            navigation: Navigation::new(definitions(args.distribution)),
            parameters: Parameters::default(),
            borrows: false,
            run: 0,
            scene: None,
            state: State::default(),
            rows: 0,
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
                    Some(Wish::Parameters(caller, question)) => self.ask(caller, &question),
                    Some(Wish::Navigate(caller, question)) => self.navigate(caller, question),
                    None => break,
                }
            }
            self.settle(has_state);
            self.set(has_state);
            self.follow(has_state);
            self.release();
            if is_due(self.trouble.as_ref(), AGAIN)
                && let Some(trouble) = self.node.trouble()
            {
                self.warn(trouble);
            }
            std::thread::sleep(WAKE);
        }
        Ok(())
    }

    /// Says something on the terminal.
    pub(super) fn note(&self, text: &str) {
        match self.node.namespace() {
            "" => output::note(&format!("ROS 2: {text}")),
            namespace => output::note(&format!("ROS 2, {namespace}: {text}")),
        }
    }

    /// Says something of the others on the terminal, and for a while in diagnostics.
    pub(super) fn warn(&mut self, trouble: String) {
        self.note(&trouble);
        self.trouble = Some((trouble, Instant::now()));
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
        if std::mem::replace(&mut self.run, news.run) != news.run {
            self.begin_run();
        }
        if let Some(parameters) = news.parameters {
            self.know(parameters);
        }
        let parameter = |name: &str| self.parameters.value(name);
        if let Some(geometry) = Geometry::new(self.scene.as_ref(), parameter) {
            self.converter.know(geometry);
        }
        if self.times != Times::OfDay
            && (!news.samples.is_empty() || self.clocked.elapsed() >= CLOCK)
        {
            let state_ms = (self.state.t_s * 1e3) as i64;
            self.clock_ms = self.clock_ms.max(news.received.1).max(state_ms);
            self.clocked = Instant::now();
            if self.times == Times::Simulated {
                self.publish(&clock(self.clock_ms.unsigned_abs() * 1_000_000)?);
            }
        }
        for row in &news.samples {
            self.converter.row(row)?;
        }
        self.rows += news.samples.len() as u64;
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
        self.end_run();
        let scene = self.scene.as_ref().filter(|scene| !scene.of_ghost);
        let robot = scene.map(|scene| scene.robot.clone());
        // A session without a state has just begun.
        let since_start = Duration::from_secs_f64(self.state.t_s.max(0.0));
        let started_ns = match self.times {
            Times::Simulated | Times::SimulatedWithOthers => 0,
            Times::OfDay => since_1970_ns(SystemTime::now() - since_start),
        };
        let speaker = self.node.speaker();
        self.converter = Converter::new(&speaker, robot.unwrap_or_default(), started_ns);
        self.clock_ms = 0;
        self.rows = 0;
    }

    /// The time of messages: of the simulation, or of day \[ns\].
    pub(super) fn now_ns(&self) -> u64 {
        match self.times {
            Times::Simulated | Times::SimulatedWithOthers => {
                self.clock_ms.unsigned_abs() * 1_000_000
            }
            Times::OfDay => since_1970_ns(SystemTime::now()),
        }
    }

    /// Gives an order; the control that it takes is released after it.
    pub(super) fn give(&mut self, order: Order) -> Result<(), String> {
        let held = self.client.view().seat == Seat::Driver;
        let keeps = order == Order::TakeControl;
        self.client.order(order)?;
        self.borrows = (self.borrows || !held) && !keeps;
        Ok(())
    }

    /// Releases the control that was taken with an order, when nothing lasts that needs it.
    fn release(&mut self) {
        let needed = !self.waiting.is_empty()
            || self.driving.lasts()
            || self.parameters.lasts()
            || self.navigation.lasts();
        if self.borrows && !needed {
            self.borrows = false;
            // Releasing is never refused.
            let _ = self.client.order(Order::ReleaseControl);
        }
    }

    /// The node itself, for diagnostics.
    fn status(&self) -> DiagnosticStatus {
        let control = match self.client.view().seat {
            Seat::Driver => "ROS 2 has control",
            Seat::Free => "nobody has control",
            Seat::Passenger | Seat::Viewer => "a page of the dashboard has control",
        };
        let trouble = self.trouble.as_ref();
        let trouble = trouble.filter(|(_, since)| since.elapsed() < SHOWN);
        let trouble = || trouble.map(|(trouble, _)| trouble.clone());
        let (level, message) = match self.driving.warning().or_else(trouble) {
            Some(warning) => (1, warning),
            None => (0, control.to_owned()),
        };
        DiagnosticStatus {
            level: Byte(level),
            name: format!("{}: ROS 2", self.node.speaker()),
            message,
            ..DiagnosticStatus::default()
        }
    }
}

fn since_1970_ns(at: SystemTime) -> u64 {
    let since = at.duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_nanos()).unwrap_or(0)
}
