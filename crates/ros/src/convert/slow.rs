//! What is not of every instant: the battery, the health of robot and link, events, and where the task leads.

use super::{BASE, ConvertError, Converter, stamp};
use crate::messages::{BatteryState, DiagnosticStatus, Diagnostics, Event, KeyValue};
use crate::topics::Topic;
use crate::types::Byte;
use rumbo_log::{Level, LoggedEvent, MapPose, State, TaskState, compose};

/// Levels of a `DiagnosticStatus`.
const OK: u8 = 0;
const WARN: u8 = 1;
const ERROR: u8 = 2;

impl Converter {
    /// What changes slowly, and what the speaker has to say of itself.
    ///
    /// # Errors
    /// [`ConvertError::Encoding`].
    pub fn state(
        &mut self,
        state: &State,
        also: Vec<DiagnosticStatus>,
    ) -> Result<(), ConvertError> {
        let t_ns = self.at_ms((state.t_s * 1e3) as i64);
        let origin = self.origin.in_odom();
        let goals = goals(&state.robot.task).into_iter();
        self.way.aim(goals.map(|goal| compose(origin, goal)));
        if let Some(battery_v) = state.robot.battery_v {
            let battery = BatteryState {
                header: self.header(t_ns, BASE),
                voltage: battery_v as f32,
                temperature: f32::NAN,
                current: f32::NAN,
                charge: f32::NAN,
                capacity: f32::NAN,
                design_capacity: f32::NAN,
                percentage: f32::NAN,
                present: true,
                ..BatteryState::default()
            };
            self.put(Topic::Battery, t_ns, &battery)?;
        }
        let mut status = self.health(state);
        status.extend(also);
        let diagnostics = Diagnostics {
            status,
            header: self.header(t_ns, ""),
        };
        self.put(Topic::Diagnostics, t_ns, &diagnostics)
    }

    /// Robot, link, and alarms.
    fn health(&self, state: &State) -> Vec<DiagnosticStatus> {
        let (robot, link) = (&state.robot, &state.link);
        let status = |name: &str, level: u8, message: &str, figures: &[(&str, String)]| {
            let figures = figures.iter().map(|(key, value)| KeyValue {
                key: (*key).to_owned(),
                value: value.clone(),
            });
            DiagnosticStatus {
                level: Byte(level),
                name: format!("{}: {name}", self.speaker),
                message: message.to_owned(),
                hardware_id: self.robot.clone(),
                values: figures.collect(),
            }
        };
        let (level, message) = match (&robot.fault, robot.armed) {
            (Some(fault), _) => (ERROR, fault.as_ref()),
            (None, true) => (OK, "on"),
            (None, false) => (OK, "off"),
        };
        let figures = [
            ("mode", robot.mode.to_string()),
            ("tick overruns", robot.overruns.to_string()),
        ];
        let mut all = vec![status("robot", level, message, &figures)];
        let (level, message) = match link.connected {
            true => (OK, "connected"),
            false => (WARN, "the robot does not answer"),
        };
        let hz = format!("{:.1}", link.telemetry_hz);
        let wrong = link.crc_errors_down.to_string();
        let figures = [
            ("telemetry, frames a second", hz),
            ("frames lost", link.frames_lost.to_string()),
            ("frames with a wrong checksum", wrong),
        ];
        all.push(status("link", level, message, &figures));
        let alarms = state.alarms.iter();
        all.extend(alarms.map(|alarm| status("alarm", ERROR, alarm, &[])));
        all
    }

    /// What happened.
    ///
    /// # Errors
    /// [`ConvertError::Encoding`].
    pub fn event(&mut self, event: &LoggedEvent) -> Result<(), ConvertError> {
        let LoggedEvent { t_s, level, text } = event;
        let t_ns = self.at_ms((t_s * 1e3) as i64);
        let event = Event {
            stamp: stamp(t_ns),
            level: match level {
                Level::Info | Level::Good => 20,
                Level::Warning => 30,
                Level::Fault => 40,
            },
            name: self.speaker.replace('/', "."),
            msg: text.clone(),
            ..Event::default()
        };
        self.put(Topic::Events, t_ns, &event)
    }
}

/// Where a task leads, from the robot's origin.
fn goals(task: &TaskState) -> Vec<MapPose> {
    let at = |x_m: f32, y_m: f32| MapPose {
        x_m: x_m.into(),
        y_m: y_m.into(),
        heading_rad: 0.0,
    };
    let route = task.route.iter().flat_map(|route| {
        let from = task.from.filter(|_| route.relative);
        let from = from.map_or(MapPose::default(), |[x_m, y_m, heading_rad]| MapPose {
            heading_rad: heading_rad.into(),
            ..at(x_m, y_m)
        });
        let places = route.waypoints.iter();
        places.map(move |place| compose(from, at(place.x_m, place.y_m)))
    });
    let goal = task.goal.map(|[x_m, y_m]| at(x_m, y_m));
    goal.into_iter().chain(route).collect()
}
