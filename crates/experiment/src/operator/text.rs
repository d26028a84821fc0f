//! The link to a program with the original text protocol: lines out, rows of telemetry in.

use super::goal::{GoalWatch, RouteWatch};
use crate::files::Setup;
use rumbo_control::mode::{ModeId, ReferenceKind};
use rumbo_plant::contact;
use rumbo_sim::Sim;
use rumbo_sim::trace::TimedMessage;
use rumbo_wire::message::Event;
use rumbo_wire::text::{self, TextRow};
use rumbo_wire::{Command, EventKind, FromRobot, Telemetry};

/// A line longer than this is none.
const LONGEST: usize = 256;

/// The station's end of a link of text.
#[derive(Clone, Debug)]
pub(super) struct Terminal {
    mode: ModeId,
    line: Vec<u8>,
    clock_ms: u32,
    /// Origin of the goals, in the world.
    origin: contact::Pose,
    goal: GoalWatch,
    route: RouteWatch,
    /// State of mode 8 in the last row; 0 is *wait for goal*.
    state: u8,
    /// Rows are not believed.
    ground_truth: bool,
    /// A row has reported the goal or the end of the route as reached.
    reported: bool,
}

impl Terminal {
    pub(super) fn new(setup: &Setup) -> Self {
        let start = &setup.scenario.start;
        Self {
            mode: setup.scenario.mode,
            line: Vec::new(),
            clock_ms: 0,
            origin: contact::Pose {
                x_m: start.x_m,
                y_m: start.y_m,
                heading_rad: start.heading_rad,
            },
            goal: GoalWatch::default(),
            route: RouteWatch::default(),
            state: 0,
            ground_truth: setup.ground_truth,
            reported: false,
        }
    }

    /// Sends a command; notes those that the protocol lacks. STOP and OFF also cut the supply of the motors, ON gives it
    /// back: the program may ignore them.
    pub(super) fn write(&mut self, sim: &mut Sim, command: Command) -> Option<String> {
        if let Some(on) = command.supplies_motors() {
            sim.supply_motors(on);
        }
        match command {
            Command::Mode(mode) => self.mode = mode,
            Command::Goal { x_m, y_m } => self.send_to(sim, x_m, y_m),
            Command::Route { .. } => self.route = RouteWatch::default(),
            Command::Waypoint(place) => {
                self.send_to(sim, place.x_m, place.y_m);
                self.route.add(place.x_m, place.y_m);
            }
            _ => {}
        }
        let lines = text::lines_of(&command, self.mode);
        // The route itself has been noted.
        let of_route = matches!(command, Command::Waypoint(_));
        if lines == [None; 2] && of_route {
            return None;
        }
        if lines == [None; 2] {
            return Some(format!(
                "the original's text has no words for this, which is not sent: {}",
                command.in_words(self.mode)
            ));
        }
        for line in lines.into_iter().flatten() {
            sim.send(format!("{line}\n").as_bytes());
        }
        None
    }

    fn send_to(&mut self, sim: &Sim, x_m: f32, y_m: f32) {
        let (sin, cos) = self.origin.heading_rad.sin_cos();
        let (x_m, y_m) = (f64::from(x_m), f64::from(y_m));
        let at_m = [
            self.origin.x_m + cos * x_m - sin * y_m,
            self.origin.y_m + sin * x_m + cos * y_m,
        ];
        self.goal.send(at_m, &sim.truth());
    }

    /// Records a goal reached: in mode 8 from the state, in mode 7 from the pose, otherwise from ground truth.
    pub(super) fn watch(&mut self, sim: &Sim, received: &mut Vec<TimedMessage>) -> bool {
        let reference = self.mode.description().reference;
        if reference.is_none_or(|reference| reference.kind != ReferenceKind::Goal) {
            return false;
        }
        let truth = sim.truth();
        let reported_us = std::mem::take(&mut self.reported).then_some(truth.now_us);
        let Some(at_us) = reported_us.or_else(|| self.goal.reached(&truth)) else {
            return false;
        };
        self.goal = GoalWatch::default();
        if self.mode == ModeId::Mission {
            // The report's mission makes each goal its new origin.
            self.origin = truth.pose;
        }
        let t_ms = ((at_us / 1_000) & 0xffff) as u16;
        let kind = EventKind::Reached;
        received.push(TimedMessage {
            t_s: at_us as f64 * 1e-6,
            what: FromRobot::Event(Event { t_ms, kind }),
        });
        true
    }

    /// Ingests what has arrived; only rows of telemetry matter to metrics.
    pub(super) fn read(&mut self, bytes: &[u8], now_us: u64, received: &mut Vec<TimedMessage>) {
        if self.ground_truth {
            return;
        }
        for byte in bytes {
            if *byte != b'\n' {
                if self.line.len() < LONGEST {
                    self.line.push(*byte);
                }
                continue;
            }
            let line = std::mem::take(&mut self.line);
            let row = str::from_utf8(&line).ok().map(str::trim);
            if let Some(Ok(row)) = row.map(TextRow::parse) {
                match &row {
                    TextRow::Mission(row) => {
                        self.reported |= row.state == 0 && self.state != 0 && self.goal.is_set();
                        self.state = row.state;
                    }
                    TextRow::Waypoints(row) => self.reported |= self.route.passes(row.x_m, row.y_m),
                    _ => {}
                }
                let telemetry = self.telemetry(&row, now_us);
                received.push(TimedMessage {
                    t_s: now_us as f64 * 1e-6,
                    what: FromRobot::Telemetry(telemetry),
                });
            }
        }
    }

    /// A row as a telemetry frame; one without a time was made now.
    fn telemetry(&mut self, row: &TextRow, now_us: u64) -> Telemetry {
        self.clock_ms = match row.dt_ms() {
            0 => (now_us / 1_000) as u32,
            dt_ms => self.clock_ms.wrapping_add(dt_ms),
        };
        row.telemetry((self.clock_ms & 0xffff) as u16, true)
    }
}
