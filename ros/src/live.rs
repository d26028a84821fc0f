//! A session as a node of ROS 2 shows it: what is new becomes messages, calls of services become orders.
//!
//! The node takes control with an order, as a page does, and releases it when nothing lasts that needs it: no call, no
//! velocity, no goal; calling `take_control` keeps it.

mod calls;
mod drive;
mod goal;
mod settings;

use crate::address::StationError;
use crate::args::Args;
use crate::bridge::BridgeError;
use crate::dds::Dds;
use crate::node::{Node, Wish};
use crate::output;
use crate::station::{News, Order, Seat, Station};
use calls::{Service, Waiting, services};
use drive::Driving;
use goal::Navigation;
use rumbo_log::{Level, LoggedEvent, Scene, State};
use rumbo_ros::convert::{ConvertError, Converter, TopicMessage, clock};
use rumbo_ros::geometry::BodyGeometry;
use rumbo_ros::messages::DiagnosticStatus;
use rumbo_ros::types::Byte;
use settings::Settings;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// The robot confirms an order within this time, or it is reported that it has not.
const PATIENCE: Duration = Duration::from_secs(3);
/// Refusals are said this often at most.
const AGAIN: Duration = Duration::from_secs(2);
/// Diagnostics show them for this long.
const SHOWN: Duration = Duration::from_secs(4);
/// Between two looks at what is new.
const WAKE: Duration = Duration::from_millis(4);
/// Most requests and velocities taken in a row: a flood of them does not keep messages from going out.
const AT_ONCE: usize = 64;
/// The clock of a simulation is published this often at least: a pause has a time too.
const CLOCK: Duration = Duration::from_millis(200);

/// Why a node has failed.
#[derive(Debug)]
pub(super) enum LiveError {
    Station(StationError),
    Convert(ConvertError),
}

impl fmt::Display for LiveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Station(error) => error.fmt(f),
            Self::Convert(error) => error.fmt(f),
        }
    }
}

impl From<StationError> for LiveError {
    fn from(error: StationError) -> Self {
        Self::Station(error)
    }
}

impl From<ConvertError> for LiveError {
    fn from(error: ConvertError) -> Self {
        Self::Convert(error)
    }
}

/// A session as a node.
pub(super) struct Live {
    node: Node<Dds>,
    station: Station,
    /// It publishes the clock of a simulation, for all robots in it.
    has_clock: bool,
    services: Vec<(String, Service)>,
    waiting: Vec<Waiting>,
    driving: Driving,
    navigation: Navigation,
    settings: Settings,
    converter: Converter,
    /// The sonars become a scan too.
    with_scan: bool,
    run: u32,
    scene: Option<Box<Scene>>,
    state: State,
    /// Telemetry frames of the run.
    rows: u64,
    /// The time of a simulation [ms], and when it was published last.
    clock_ms: i64,
    clocked: Instant,
    /// The last trouble with others, and when it was said.
    trouble: Option<(String, Instant)>,
    reported: bool,
}

/// Whether there may be said more, this long after what was said last.
fn is_due(said: Option<&(String, Instant)>, after: Duration) -> bool {
    said.is_none_or(|(_, since)| since.elapsed() >= after)
}

/// A node that cannot publish is reported, and the session goes on.
fn report(outcome: Result<(), BridgeError>, reported: &mut bool) {
    if let Err(error) = outcome
        && !std::mem::replace(reported, true)
    {
        output::note(&error.to_string());
    }
}

impl Live {
    /// Offers the services, the parameters and the action.
    pub(super) fn new(
        mut node: Node<Dds>,
        station: Station,
        has_clock: bool,
        args: &Args,
    ) -> Result<Self, BridgeError> {
        node.take_velocities(args.stamped)?;
        let services = services(&station.hello.modes);
        services.iter().try_for_each(|(name, _)| node.offer(name))?;
        node.offer_parameters()?;
        node.offer_navigation()?;
        Ok(Self {
            converter: Converter::new(&node.speaker(), String::new(), 0),
            with_scan: args.scan,
            node,
            station,
            has_clock,
            services,
            waiting: Vec::new(),
            driving: Driving::default(),
            navigation: Navigation::new(args.distribution),
            settings: Settings::default(),
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

    /// Runs until the session is over, or somebody wants the program to end.
    pub(super) fn run(mut self, ends: &AtomicBool) -> Result<(), LiveError> {
        while !ends.load(Ordering::Relaxed) {
            let Some(news) = self.station.news()? else {
                output::note("the session is over");
                return Ok(());
            };
            self.turn(news)?;
            std::thread::sleep(WAKE);
        }
        // Nobody would follow the robot to its goal.
        if self.navigation.lasts() {
            let _ = self.station.order(Order::Stop);
        }
        self.station.leave();
        Ok(())
    }

    fn turn(&mut self, news: News) -> Result<(), ConvertError> {
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
        let needs = !self.waiting.is_empty()
            || self.driving.lasts()
            || self.settings.lasts()
            || self.navigation.lasts();
        self.station.release(needs);
        if is_due(self.trouble.as_ref(), AGAIN)
            && let Some(trouble) = self.node.trouble()
        {
            self.warn(trouble);
        }
        Ok(())
    }

    /// The name of the robot's mode.
    fn mode(&self) -> &str {
        let modes = &self.station.hello.modes;
        let of_robot = modes.iter().find(|mode| mode.id == self.state.robot.mode);
        of_robot.map_or("", |mode| &mode.name)
    }

    /// Says something on the terminal.
    fn note(&self, text: &str) {
        match self.node.namespace() {
            "" => output::note(text),
            namespace => output::note(&format!("{namespace}: {text}")),
        }
    }

    /// Says something of the others on the terminal, and for a while in diagnostics.
    fn warn(&mut self, trouble: String) {
        self.note(&trouble);
        self.trouble = Some((trouble, Instant::now()));
    }

    fn publish(&mut self, message: &TopicMessage) {
        let published = self.node.publish(message);
        report(published, &mut self.reported);
    }

    /// Makes messages of what is new.
    fn convert(&mut self, news: News) -> Result<(), ConvertError> {
        let has_state = news.state.is_some();
        if let Some(state) = news.state {
            self.state = *state;
        }
        if let Some(scene) = news.scene {
            self.scene = scene;
        }
        if std::mem::replace(&mut self.run, news.run) != news.run {
            self.begin_run();
        }
        if let Some(parameters) = news.parameters {
            self.know(parameters);
        }
        let parameter = |name: &str| self.settings.value(name);
        if let Some(geometry) = BodyGeometry::new(self.scene.as_deref(), parameter) {
            self.converter.know(geometry);
        }
        if let Some(scene) = &self.scene {
            self.converter.surround(&scene.obstacles);
        }
        if self.state.simulated && (!news.samples.is_empty() || self.clocked.elapsed() >= CLOCK) {
            let state_ms = (self.state.t_s * 1e3) as i64;
            self.clock_ms = self.clock_ms.max(news.heard_ms).max(state_ms);
            self.clocked = Instant::now();
            if self.has_clock {
                self.publish(&clock(self.clock_ms.unsigned_abs() * 1_000_000)?);
            }
        }
        let mut latched = BTreeMap::new();
        for row in &news.past {
            self.converter.row(row)?;
            for message in self.converter.take() {
                if message.topic.quality().latched {
                    latched.insert(message.topic, message);
                }
            }
        }
        latched.values().for_each(|message| self.publish(message));
        for row in &news.samples {
            self.converter.row(row)?;
        }
        self.rows += news.samples.len() as u64;
        for event in &news.events {
            self.tell(event);
            self.converter.event(event)?;
        }
        if has_state {
            let own = vec![self.status()];
            self.converter.state(&self.state, own)?;
        }
        Ok(())
    }

    /// Warnings and faults, for who looks at the terminal.
    fn tell(&self, event: &LoggedEvent) {
        if matches!(event.level, Level::Warning | Level::Fault) {
            self.note(&format!(
                "{:.1} s, {}: {}",
                event.t_s,
                event.level.name(),
                event.text
            ));
        }
    }

    fn begin_run(&mut self) {
        self.end_run();
        let scene = self.scene.as_ref().filter(|scene| !scene.of_ghost);
        let robot = scene.map(|scene| scene.robot.clone());
        let since_start = Duration::from_secs_f64(self.state.t_s.max(0.0));
        let started_ns = match self.state.simulated {
            true => 0,
            false => since_1970_ns(SystemTime::now() - since_start),
        };
        let speaker = self.node.speaker();
        self.converter = Converter::new(&speaker, robot.unwrap_or_default(), started_ns);
        self.converter.with_scan = self.with_scan;
        self.clock_ms = 0;
        self.rows = 0;
    }

    /// The time of messages: of the simulation, or of day \[ns\].
    fn now_ns(&self) -> u64 {
        match self.state.simulated {
            true => self.clock_ms.unsigned_abs() * 1_000_000,
            false => since_1970_ns(SystemTime::now()),
        }
    }

    /// The node itself, for diagnostics.
    fn status(&self) -> DiagnosticStatus {
        let control = match self.station.seat() {
            Seat::Driver => "ROS 2 has control",
            Seat::Free => "nobody has control",
            Seat::Passenger => "a page of the dashboard has control",
            Seat::Viewer => "ROS 2 may watch, and stop the robot",
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
