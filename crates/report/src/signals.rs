//! Signals of a run over the time since arming: the robot's telemetry where there is any, otherwise ground truth.

use crate::channel::Channel;
use crate::text_rows;
use rumbo_control::Range;
use rumbo_control::mode::ModeId;
use rumbo_experiment::files::Setup;
use rumbo_experiment::run::RunResult;
use rumbo_plot::Points;
use rumbo_sim::trace::{TimedMessage, Trace, TruthSample};
use rumbo_wire::text::TextRow;
use rumbo_wire::{Command, EventKind, FromRobot, Telemetry};
use std::f64::consts::{PI, TAU};

pub(crate) const RPM: f64 = 30.0 / PI;
pub(crate) const DEG: f64 = 180.0 / PI;
pub(crate) const CM: f64 = 100.0;

/// A run and its setup.
#[derive(Debug)]
pub struct ReportedRun {
    /// The scenario and all that it names.
    pub setup: Setup,
    /// Its trace, metrics and failures.
    pub result: RunResult,
}

impl ReportedRun {
    pub(crate) fn trace(&self) -> &Trace {
        &self.result.trace
    }

    /// When the robot was armed [s]: the zero of all time axes.
    pub(crate) fn armed_s(&self) -> f64 {
        let commands = &self.setup.scenario.commands;
        let arm = commands.iter().find(|timed| timed.command == Command::Arm);
        arm.map_or(0.0, |timed| timed.at_s)
    }

    /// Length of the run from the arming on [s].
    pub(crate) fn duration_s(&self) -> f64 {
        self.setup.scenario.duration_s - self.armed_s()
    }

    /// A signal of ground truth.
    pub(crate) fn truth(&self, signal: impl Fn(&TruthSample) -> f64) -> Points {
        let armed_s = self.armed_s();
        let samples = self.trace().samples.iter();
        samples
            .map(|sample| (sample.t_s - armed_s, signal(sample)))
            .collect()
    }

    /// Whether the program sent telemetry, as frames or as text.
    pub(crate) fn has_telemetry(&self) -> bool {
        self.telemetry().next().is_some()
    }

    /// The telemetry frames, each with its time of arrival since arming.
    pub(crate) fn telemetry(&self) -> impl Iterator<Item = (f64, &Telemetry)> {
        let armed_s = self.armed_s();
        self.trace()
            .messages
            .iter()
            .filter_map(move |received| match &received.what {
                FromRobot::Telemetry(frame) => Some((received.t_s - armed_s, frame)),
                _ => None,
            })
    }

    fn frames(&self, signal: impl Fn(&Telemetry) -> f64) -> Points {
        self.telemetry()
            .map(|(t_s, frame)| (t_s, signal(frame)))
            .collect()
    }

    /// The best source there is: text rows, which hold more than the telemetry parsed from them; else frames; else
    /// ground truth, if given.
    fn best(
        &self,
        frames: impl Fn(&Telemetry) -> f64,
        text: impl Fn(&TextRow) -> Option<f64>,
        truth: Option<&dyn Fn(&TruthSample) -> f64>,
    ) -> Points {
        let points = self.text(text);
        match truth {
            _ if !points.is_empty() => points,
            _ if self.has_telemetry() => self.frames(frames),
            Some(truth) => self.truth(truth),
            None => points,
        }
    }

    /// A signal of the rows of the original text protocol.
    fn text(&self, of: impl Fn(&TextRow) -> Option<f64>) -> Points {
        let armed_s = self.armed_s();
        let rows = text_rows::rows(&self.trace().link);
        rows.iter()
            .filter_map(|(t_s, row)| Some((t_s - armed_s, of(row)?)))
            .collect()
    }

    /// Whether the robot sent rows of the original text protocol.
    pub(crate) fn has_text_rows(&self) -> bool {
        !text_rows::rows(&self.trace().link).is_empty()
    }

    /// A sonar's range as the robot measures it [cm]; a gap where there is none.
    pub(crate) fn range_cm(&self, sonar: Channel) -> Points {
        self.best(
            |frame| match frame.ranges[sonar as usize].range {
                Range::Valid(range_m) => CM * f64::from(range_m),
                Range::Clear | Range::Faulty => f64::NAN,
            },
            |row| text_rows::range_cm(row, sonar),
            Some(&|sample| CM * self.trace().range_m(sample, sonar as usize)),
        )
    }

    /// A wheel's measured speed [rpm].
    pub(crate) fn speed_rpm(&self, wheel: Channel) -> Points {
        if self.has_telemetry() && !self.has_text_rows() {
            // Two samples in a frame, the first 20 ms older.
            let both = self.telemetry().flat_map(|(t_s, frame)| {
                let [before, now] = frame.wheel_rad_s;
                [(t_s - 0.02, before), (t_s, now)]
            });
            return both
                .map(|(t_s, wheels)| (t_s, RPM * f64::from(wheel.of(wheels))))
                .collect();
        }
        self.best(
            |_| f64::NAN,
            |row| text_rows::speed_rpm(row, wheel),
            Some(&|sample| RPM * sample.wheel_rad_s[wheel as usize]),
        )
    }

    /// Setpoint of a wheel's speed loop [rpm].
    pub(crate) fn speed_reference_rpm(&self, wheel: Channel) -> Points {
        self.best(
            |frame| RPM * f64::from(wheel.of(frame.wheel_ref_rad_s)),
            |row| text_rows::reference_rpm(row, wheel),
            None,
        )
    }

    /// PWM at a wheel's bridge, of 255.
    pub(crate) fn pwm(&self, wheel: Channel) -> Points {
        self.truth(|sample| f64::from(sample.duty[wheel as usize]))
    }

    /// The estimated pose: x [m], y [m], heading within +-180 [deg]. The true pose relative to the start where the
    /// robot reports none.
    pub(crate) fn pose(&self) -> [Points; 3] {
        let start = self.setup.scenario.start;
        let (sin, cos) = start.heading_rad.sin_cos();
        let seen = |sample: &TruthSample| {
            let (x, y) = (sample.x_m - start.x_m, sample.y_m - start.y_m);
            [
                cos * x + sin * y,
                cos * y - sin * x,
                DEG * wrap(sample.heading_rad - start.heading_rad),
            ]
        };
        let [x, y, heading] = [0, 1, 2].map(|index| {
            self.best(
                |frame| {
                    let pose = frame.pose;
                    [
                        f64::from(pose.x_m),
                        f64::from(pose.y_m),
                        DEG * f64::from(pose.heading_rad),
                    ][index]
                },
                |row| Some(text_rows::pose(row)?[index]),
                Some(&|sample| seen(sample)[index]),
            )
        });
        [x, y, unwrapped(heading)]
    }

    /// The mode's heading setpoint [deg].
    pub(crate) fn heading_reference_deg(&self) -> Points {
        let armed_s = self.armed_s();
        let received = self
            .trace()
            .messages
            .iter()
            .filter_map(|received| match received.what {
                FromRobot::HeadingRef(heading_rad) => {
                    Some((received.t_s - armed_s, DEG * f64::from(heading_rad)))
                }
                _ => None,
            });
        let mut points: Points = received.collect();
        if points.is_empty() {
            points =
                self.text(|row| Some(f64::from(text_rows::mission(row)?.heading_reference_deg)));
        }
        self.hold_last(&mut points);
        points
    }

    /// The goal that the robot reports [m], x and y.
    pub(crate) fn goal_m(&self) -> [Points; 2] {
        let armed_s = self.armed_s();
        let mut goals = [Points::new(), Points::new()];
        for received in &self.trace().messages {
            if let FromRobot::Status(status) = &received.what {
                let goal = status.reference.numbers();
                for (points, coordinate) in std::iter::zip(&mut goals, goal) {
                    points.push((received.t_s - armed_s, f64::from(coordinate)));
                }
            }
        }
        if self.has_text_rows() {
            goals = [
                self.text(|row| Some(f64::from(text_rows::mission(row)?.goal_x_m))),
                self.text(|row| Some(f64::from(text_rows::mission(row)?.goal_y_m))),
            ];
        }
        goals.iter_mut().for_each(|points| self.hold_last(points));
        goals
    }

    /// The number of the mode's state.
    pub(crate) fn states(&self) -> Points {
        let text = |row: &TextRow| Some(f64::from(text_rows::mission(row)?.state));
        let mut points = self.best(|frame| f64::from(frame.state), text, None);
        self.hold_last(&mut points);
        points
    }

    /// The true trajectory in the world [m].
    pub(crate) fn true_trajectory(&self) -> Points {
        self.trace()
            .samples
            .iter()
            .map(|sample| (sample.x_m, sample.y_m))
            .collect()
    }

    /// When the run was done, since the arming [s]; `None` if it never was.
    pub(crate) fn end_s(&self) -> Option<f64> {
        let lane = self.metric("finish_s");
        let lane = lane.filter(|finish_s| finish_s.is_finite());
        lane.or_else(|| self.reached_s().last().copied())
    }

    /// When the robot reported its goals reached, since arming [s].
    pub(crate) fn reached_s(&self) -> Vec<f64> {
        let armed_s = self.armed_s();
        let reached = |received: &TimedMessage| matches!(&received.what, FromRobot::Event(event) if event.kind == EventKind::Reached);
        self.trace()
            .messages
            .iter()
            .filter(|received| reached(received))
            .map(|received| received.t_s - armed_s)
            .collect()
    }

    /// The true position at a time since arming [m].
    pub(crate) fn true_position_at(&self, t_s: f64) -> (f64, f64) {
        let samples = &self.trace().samples;
        let at = samples.partition_point(|sample| sample.t_s - self.armed_s() < t_s);
        samples
            .get(at.min(samples.len().saturating_sub(1)))
            .map_or((0.0, 0.0), |sample| (sample.x_m, sample.y_m))
    }

    /// The estimated path in the world [m], from the start. A mission makes a reached goal its new origin: the path
    /// ends there.
    pub(crate) fn estimated_trajectory(&self) -> Points {
        let mission = self.setup.scenario.mode == ModeId::Mission;
        let end_s = self
            .reached_s()
            .first()
            .copied()
            .filter(|_| mission)
            .unwrap_or(f64::INFINITY);
        let start = self.setup.scenario.start;
        let (sin, cos) = start.heading_rad.sin_cos();
        if !self.has_telemetry() {
            return Points::new();
        }
        let [x, y, _] = self.pose();
        x.iter()
            .zip(&y)
            .filter(|((t_s, _), _)| (0.0..end_s).contains(t_s))
            .map(|((_, x), (_, y))| (start.x_m + cos * x - sin * y, start.y_m + sin * x + cos * y))
            .collect()
    }

    /// The reference of the commands over time, times `factor`.
    pub(crate) fn reference(&self, factor: f64) -> Points {
        let armed_s = self.armed_s();
        let mut points = Points::new();
        for timed in &self.setup.scenario.commands {
            let value = match timed.command {
                Command::Reference(value) => f64::from(value),
                Command::WheelReference(wheels) => f64::from(wheels.left),
                _ => continue,
            };
            points.push(((timed.at_s - armed_s).max(0.0), factor * value));
        }
        self.hold_last(&mut points);
        points
    }

    /// The last value holds to the end of the run.
    fn hold_last(&self, points: &mut Points) {
        if let Some((t_s, value)) = points.last().copied()
            && t_s < self.duration_s()
        {
            points.push((self.duration_s(), value));
        }
    }

    /// A metric, if the run has it.
    pub(crate) fn metric(&self, name: &str) -> Option<f64> {
        self.result.metrics.get(name).copied()
    }
}

fn wrap(angle_rad: f64) -> f64 {
    angle_rad - TAU * (angle_rad / TAU).round()
}

/// A gap where an angle jumps from one end of its range to the other: no line across the figure.
pub(crate) fn unwrapped(points: Points) -> Points {
    let mut broken = Points::new();
    for point in points {
        if broken
            .last()
            .is_some_and(|last: &(f64, f64)| (last.1 - point.1).abs() > 180.0)
        {
            broken.push((point.0, f64::NAN));
        }
        broken.push(point);
    }
    broken
}

/// The difference of two signals at the times of the first; the other one holds its value between its own times.
pub(crate) fn difference(one: &Points, other: &Points) -> Points {
    let mut at = 0;
    one.iter()
        .filter(|_| !other.is_empty())
        .map(|(t_s, value)| {
            while at + 1 < other.len() && other[at + 1].0 <= *t_s {
                at += 1;
            }
            (*t_s, value - other[at].1)
        })
        .collect()
}

/// The points from one time on, to another.
pub(crate) fn between(points: &Points, from_s: f64, until_s: f64) -> Points {
    points
        .iter()
        .copied()
        .filter(|(t_s, _)| (from_s..=until_s).contains(t_s))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_is_taken_from_the_value_that_holds() {
        let reference = vec![(0.0, 10.0), (2.0, 20.0)];
        let signal = vec![(1.0, 11.0), (2.0, 12.0), (3.0, 21.0)];
        assert_eq!(
            difference(&signal, &reference),
            [(1.0, 1.0), (2.0, -8.0), (3.0, 1.0)]
        );
    }

    #[test]
    fn a_heading_that_goes_on_through_a_half_turn_leaves_a_gap() {
        let points = unwrapped(vec![(0.0, 170.0), (1.0, 179.0), (2.0, -179.0)]);
        assert!(points.len() == 4 && points[2].1.is_nan());
    }
}
