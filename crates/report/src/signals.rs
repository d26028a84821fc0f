//! What figures show of a run: what the station heard of the robot, else what was truly the case, over the time since the arming.

use crate::plot::Points;
use rumbo_control::Range;
use rumbo_control::mode::ModeId;
use rumbo_scenario::files::Setup;
use rumbo_scenario::run::RunResult;
use rumbo_scenario::trace::{Heard, Sample, Trace};
use rumbo_wire::{Command, EventKind, FromRobot, Telemetry};
use std::f64::consts::{PI, TAU};

pub(crate) const RPM: f64 = 30.0 / PI;
pub(crate) const DEG: f64 = 180.0 / PI;
pub(crate) const CM: f64 = 100.0;

/// A run and what it was made of.
#[derive(Debug)]
pub struct Outcome {
    /// The scenario and all that it names.
    pub setup: Setup,
    /// What came of it.
    pub result: RunResult,
}

/// A wheel or a sonar, by its place in arrays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    Left = 0,
    Right = 1,
    Front = 2,
}

impl Outcome {
    fn trace(&self) -> &Trace {
        &self.result.trace
    }

    /// When the robot was armed: zero of all time axes [s].
    pub(crate) fn armed_s(&self) -> f64 {
        let commands = &self.setup.scenario.commands;
        let arm = commands.iter().find(|timed| timed.command == Command::Arm);
        arm.map_or(0.0, |timed| timed.at_s)
    }

    /// Length of the run from the arming on [s].
    pub(crate) fn duration_s(&self) -> f64 {
        self.setup.scenario.duration_s - self.armed_s()
    }

    /// A true signal.
    pub(crate) fn truth(&self, signal: impl Fn(&Sample) -> f64) -> Points {
        let armed_s = self.armed_s();
        let samples = self.trace().samples.iter();
        samples
            .map(|sample| (sample.t_s - armed_s, signal(sample)))
            .collect()
    }

    /// Whether the program at the pins told telemetry; an image with another protocol does not.
    pub(crate) fn tells(&self) -> bool {
        self.telemetry().next().is_some()
    }

    /// The frames of telemetry, and when each was heard since the arming.
    pub(crate) fn telemetry(&self) -> impl Iterator<Item = (f64, &Telemetry)> {
        let armed_s = self.armed_s();
        self.trace()
            .heard
            .iter()
            .filter_map(move |heard| match &heard.what {
                FromRobot::Telemetry(told) => Some((heard.t_s - armed_s, told)),
                _ => None,
            })
    }

    fn told(&self, signal: impl Fn(&Telemetry) -> f64) -> Points {
        self.telemetry()
            .map(|(t_s, told)| (t_s, signal(told)))
            .collect()
    }

    /// A sonar's range as the robot filtered it [cm]; a gap where there is none.
    pub(crate) fn range_cm(&self, sonar: Place) -> Points {
        if !self.tells() {
            return self.truth(|sample| CM * sample.range_m[sonar as usize]);
        }
        self.told(|told| match told.ranges[sonar as usize].range {
            Range::Valid(range_m) => CM * f64::from(range_m),
            Range::Clear | Range::Faulty => f64::NAN,
        })
    }

    /// A wheel's measured speed [rpm].
    pub(crate) fn speed_rpm(&self, wheel: Place) -> Points {
        if !self.tells() {
            return self.truth(|sample| RPM * sample.wheel_rad_s[wheel as usize]);
        }
        // Two samples in a frame, the first 20 ms older.
        let both = self.telemetry().flat_map(|(t_s, told)| {
            [
                (t_s - 0.02, told.wheel_rad_s[0]),
                (t_s, told.wheel_rad_s[1]),
            ]
        });
        both.map(|(t_s, wheels)| (t_s, RPM * f64::from(side(wheel, wheels.left, wheels.right))))
            .collect()
    }

    /// What a wheel's speed loop was asked for [rpm].
    pub(crate) fn speed_reference_rpm(&self, wheel: Place) -> Points {
        self.told(|told| {
            let wheels = told.wheel_ref_rad_s;
            RPM * f64::from(side(wheel, wheels.left, wheels.right))
        })
    }

    /// PWM at a wheel's bridge, of 255.
    pub(crate) fn pwm(&self, wheel: Place) -> Points {
        self.truth(|sample| f64::from(sample.duty[wheel as usize]))
    }

    /// The pose as the robot estimates it: x [m], y [m], heading within +-180 [deg]; the true one, seen from the start, where it tells
    /// none.
    pub(crate) fn pose(&self) -> [Points; 3] {
        if !self.tells() {
            let start = self.setup.scenario.start;
            let (sin, cos) = start.heading_rad.sin_cos();
            return [
                self.truth(|sample| {
                    cos * (sample.x_m - start.x_m) + sin * (sample.y_m - start.y_m)
                }),
                self.truth(|sample| {
                    cos * (sample.y_m - start.y_m) - sin * (sample.x_m - start.x_m)
                }),
                unwrapped(self.truth(|sample| DEG * wrap(sample.heading_rad - start.heading_rad))),
            ];
        }
        [
            self.told(|told| f64::from(told.pose.x_m)),
            self.told(|told| f64::from(told.pose.y_m)),
            unwrapped(self.told(|told| DEG * f64::from(told.pose.heading_rad))),
        ]
    }

    /// The heading that the mode wants [deg].
    pub(crate) fn heading_reference_deg(&self) -> Points {
        let armed_s = self.armed_s();
        let heard = self
            .trace()
            .heard
            .iter()
            .filter_map(|heard| match heard.what {
                FromRobot::HeadingRef(heading_rad) => {
                    Some((heard.t_s - armed_s, DEG * f64::from(heading_rad)))
                }
                _ => None,
            });
        let mut points: Points = heard.collect();
        self.hold_last(&mut points);
        points
    }

    /// The goal as the robot has it [m], x and y.
    pub(crate) fn goal_m(&self) -> [Points; 2] {
        let armed_s = self.armed_s();
        let status = || {
            self.trace()
                .heard
                .iter()
                .filter_map(move |heard| match &heard.what {
                    FromRobot::Status(status) => Some((heard.t_s - armed_s, status.reference)),
                    _ => None,
                })
        };
        let mut goals = [
            status()
                .map(|(t_s, goal)| (t_s, f64::from(goal.left)))
                .collect(),
            status()
                .map(|(t_s, goal)| (t_s, f64::from(goal.right)))
                .collect(),
        ];
        goals.iter_mut().for_each(|points| self.hold_last(points));
        goals
    }

    /// The number of the mode's state.
    pub(crate) fn states(&self) -> Points {
        let mut points = self.told(|told| f64::from(told.state));
        self.hold_last(&mut points);
        points
    }

    /// The true way in the world [m].
    pub(crate) fn way(&self) -> Points {
        self.trace()
            .samples
            .iter()
            .map(|sample| (sample.x_m, sample.y_m))
            .collect()
    }

    /// When the robot said that it reached its goal, since the arming [s].
    pub(crate) fn reached_s(&self) -> Vec<f64> {
        let armed_s = self.armed_s();
        let reached = |heard: &Heard| matches!(&heard.what, FromRobot::Event(event) if event.kind == EventKind::Reached);
        self.trace()
            .heard
            .iter()
            .filter(|heard| reached(heard))
            .map(|heard| heard.t_s - armed_s)
            .collect()
    }

    /// Where it truly was at a time since the arming [m].
    pub(crate) fn place_at(&self, t_s: f64) -> (f64, f64) {
        let samples = &self.trace().samples;
        let at = samples.partition_point(|sample| sample.t_s - self.armed_s() < t_s);
        samples
            .get(at.min(samples.len().saturating_sub(1)))
            .map_or((0.0, 0.0), |sample| (sample.x_m, sample.y_m))
    }

    /// The estimated way in the world [m], from the start. A mission that has reached a goal calls it its origin: there the way ends.
    pub(crate) fn told_way(&self) -> Points {
        let mission = self.setup.scenario.mode == ModeId::Mission;
        let end_s = self
            .reached_s()
            .first()
            .copied()
            .filter(|_| mission)
            .unwrap_or(f64::INFINITY);
        let start = self.setup.scenario.start;
        let (sin, cos) = start.heading_rad.sin_cos();
        let pose = self
            .telemetry()
            .filter(|(t_s, _)| (0.0..end_s).contains(t_s))
            .map(|(_, told)| told.pose);
        pose.map(|pose| (f64::from(pose.x_m), f64::from(pose.y_m)))
            .map(|(x, y)| (start.x_m + cos * x - sin * y, start.y_m + sin * x + cos * y))
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

fn side(wheel: Place, left: f32, right: f32) -> f32 {
    if wheel == Place::Left { left } else { right }
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
