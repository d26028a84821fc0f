//! The report's mode 7: turn, then drive, from point to point by odometry (section 5.1).
//!
//! | state | does | until |
//! |---|---|---|
//! | 0 | the bearing from the last point to the next | at once |
//! | 1 | orientation [deg] to rpm: 4 + 0.0005 per ms, +-30, half to each wheel | within 5 deg and both wheels stand |
//! | 2 | distance [m] to rpm: 1000 + 0.005 per ms, at most 80, plus the orientation controller, thrice on the wheel that it speeds up | within 0.1 m |

use super::chip::Chip;
use super::pid::{Gains, Pid};
use super::speed::{RAD_S_PER_RPM, RADIUS_M, Speeds, TIMER_S};
use rumbo_control::Wheels;

const BASE_M: f64 = 0.10;
const ARRIVED_M: f64 = 0.1;
/// A turn ends within this of its angle [deg].
pub(super) const TURNED_DEG: f64 = 5.0;

/// The pose by the report's odometry, with the angle in degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Pose {
    pub(super) x_m: f64,
    pub(super) y_m: f64,
    pub(super) angle_deg: f64,
}

impl Pose {
    /// One period of the timer, along the tangent at its start.
    pub(super) fn advance(&mut self, speed_rpm: Wheels<f64>) {
        let Wheels { left, right } = speed_rpm.map(|rpm| rpm * RAD_S_PER_RPM * RADIUS_M);
        let (sin, cos) = self.angle_deg.to_radians().sin_cos();
        self.x_m += 0.5 * (left + right) * cos * TIMER_S;
        self.y_m += 0.5 * (left + right) * sin * TIMER_S;
        self.angle_deg = wrapped(self.angle_deg + ((right - left) / BASE_M * TIMER_S).to_degrees());
    }

    /// Bearing of a point [deg].
    pub(super) fn bearing_deg(&self, x_m: f64, y_m: f64) -> f64 {
        wrapped((y_m - self.y_m).atan2(x_m - self.x_m).to_degrees())
    }

    pub(super) fn distance_m(&self, x_m: f64, y_m: f64) -> f64 {
        (x_m - self.x_m).hypot(y_m - self.y_m)
    }
}

/// An angle in (-180, 180] of one at most a turn outside.
pub(super) fn wrapped(deg: f64) -> f64 {
    if deg > 180.0 {
        deg - 360.0
    } else if deg <= -180.0 {
        deg + 360.0
    } else {
        deg
    }
}

/// References of a turn about the centre: half of the correction to each wheel.
pub(super) fn turning(rpm: f64) -> Wheels<f64> {
    Wheels {
        left: -0.5 * rpm,
        right: 0.5 * rpm,
    }
}

/// References of driving on with a correction.
pub(super) fn driving(rpm: f64, correction_rpm: f64) -> Wheels<f64> {
    turning(correction_rpm).map(|half| rpm + half)
}

/// The same, with the correction once more on the wheel that it speeds up. The report's listing does not have this, but
/// all references of the recorded square do: 78 and 86 rpm for a correction of -4.
fn driving_hard(rpm: f64, correction_rpm: f64) -> Wheels<f64> {
    let Wheels { left, right } = driving(rpm, correction_rpm);
    Wheels {
        left: left + (-correction_rpm).max(0.0),
        right: right + correction_rpm.max(0.0),
    }
}

/// The controller of the distance to a point; its input is negative.
pub(super) fn distance_pid() -> Pid {
    Pid::new(Gains(-1000.0, -0.005, 0.0), 80.0)
}

/// What the loop is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Choose,
    Turn,
    Drive,
    Done,
}

/// Mode 7.
#[derive(Clone, Debug)]
pub(super) struct Square {
    pub(super) speeds: Speeds,
    pub(super) pose: Pose,
    pub(super) points: Vec<[f64; 2]>,
    pub(super) repeat: bool,
    state: State,
    /// Index of the point driven to.
    index: Option<usize>,
    angle_ref_deg: f64,
    reference_rpm: Wheels<f64>,
    distance: Pid,
    orientation: Pid,
}

impl Square {
    pub(super) fn new() -> Self {
        Self {
            speeds: Speeds::new(60.0),
            pose: Pose::default(),
            points: Vec::new(),
            repeat: false,
            state: State::Choose,
            index: None,
            angle_ref_deg: 0.0,
            reference_rpm: Wheels::both(0.0),
            distance: distance_pid(),
            orientation: Pid::new(Gains(4.0, 0.0005, 0.0), 30.0),
        }
    }

    /// A new route: the report's vertices, or others.
    pub(super) fn route(&mut self, repeat: bool) {
        self.points.clear();
        self.repeat = repeat;
        self.index = None;
        self.state = State::Choose;
    }

    pub(super) fn state(&self) -> u8 {
        self.state as u8
    }

    pub(super) fn timer(&mut self, chip: &mut Chip) {
        self.speeds.timer(chip);
        self.pose.advance(self.speeds.speed_rpm());
    }

    /// One pass of the loop; true when the last point has been reached.
    pub(super) fn pass(&mut self, chip: &mut Chip) -> bool {
        let mut reached = false;
        let now_ms = chip.millis();
        match self.state {
            State::Choose => self.choose(),
            State::Turn => {
                let error_deg = wrapped(self.angle_ref_deg - self.pose.angle_deg);
                self.reference_rpm = turning(self.orientation.step(error_deg, now_ms));
                if error_deg.abs() < TURNED_DEG && self.speeds.standing() {
                    self.state = State::Drive;
                    self.orientation.reset();
                    self.distance.reset();
                }
            }
            State::Drive => {
                let [x_m, y_m] = self.point(self.index);
                let distance_m = self.pose.distance_m(x_m, y_m);
                if distance_m > ARRIVED_M {
                    self.angle_ref_deg = self.pose.bearing_deg(x_m, y_m);
                }
                let rpm = self.distance.step(0.0 - distance_m, now_ms);
                let error_deg = wrapped(self.angle_ref_deg - self.pose.angle_deg);
                self.reference_rpm = driving_hard(rpm, self.orientation.step(error_deg, now_ms));
                if distance_m < ARRIVED_M {
                    self.state = State::Choose;
                    self.orientation.reset();
                    reached = !self.repeat && self.next() >= self.points.len();
                }
            }
            State::Done => self.reference_rpm = Wheels::both(0.0),
        }
        self.speeds.refer(self.reference_rpm);
        self.speeds.together();
        self.speeds.drive(chip);
        reached
    }

    fn next(&self) -> usize {
        self.index.map_or(0, |index| index + 1)
    }

    /// The next point, and the bearing from the point before it: where the robot really is does not count.
    fn choose(&mut self) {
        let mut next = self.next();
        if next >= self.points.len() {
            if !self.repeat || self.points.is_empty() {
                self.state = State::Done;
                return;
            }
            next = 0;
        }
        let [from_x_m, from_y_m] = self.point(self.index);
        let [x_m, y_m] = self.points[next];
        let from = Pose {
            x_m: from_x_m,
            y_m: from_y_m,
            angle_deg: 0.0,
        };
        self.angle_ref_deg = from.bearing_deg(x_m, y_m);
        self.index = Some(next);
        self.state = State::Turn;
    }

    /// A point of the route; the origin before the first.
    fn point(&self, index: Option<usize>) -> [f64; 2] {
        index
            .and_then(|index| self.points.get(index))
            .copied()
            .unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_correction_counts_thrice_on_the_wheel_that_it_speeds_up() {
        // References of the recorded square: A is the right wheel.
        let to_the_right = driving_hard(80.0, -4.0);
        assert_eq!((to_the_right.right, to_the_right.left), (78.0, 86.0));
        let to_the_left = driving_hard(80.0, 11.0);
        assert_eq!((to_the_left.right, to_the_left.left), (96.5, 74.5));
    }
}
