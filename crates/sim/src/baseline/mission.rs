//! The report's mode 8: goals around obstacles, and lanes of boxes (section 6.1).
//!
//! | state | does | until | then |
//! |---|---|---|---|
//! | wait | released, pose set to zero | a goal has come | initialise |
//! | initialise | the bearing of the goal becomes the line's angle | at once | first turn |
//! | first turn | turns to the line's angle | within 5 deg and both wheels stand | go |
//! | go | distance and orientation controllers towards the goal | within 5 cm | wait |
//! | sweep right, left | servo 3 deg on, then sleeps for 300 ms | a jump of 30 cm, or 90 deg | sweep left, decide |
//! | decide | 90 deg to the side of the smaller sweep | at once | turn |
//! | turn | turns to that angle | within 5 deg and both wheels stand | seek (lane: straight) |
//! | seek | 50 rpm, holding the angle | the side sonar is below 55 cm | along |
//! | along | the same | it is above 55 cm | pass |
//! | pass | 12.5 cm on, by the distance controller | done; 90 deg back | turn |
//!
//! The echo of the front sonar at 25 cm or less starts a sweep from go, seek, along and pass, unless one has begun and no
//! turn has ended since. From seek, along and pass the robot leaves for the goal when its bearing equals the line's
//! angle within 1 deg, not wrapped, once it has differed while along.

use super::chip::Chip;
use super::pid::{Gains, Pid};
use super::speed::Speeds;
use super::square::{Pose, TURNED_DEG, distance_pid, driving, turning, wrapped};
use rumbo_control::{SonarId, Wheels};

const ARRIVED_M: f64 = 0.05;
const SAFE_CM: f64 = 25.0;
const JUMP_CM: f64 = 30.0;
const REJOIN_DEG: f64 = 1.0;
const SWEEP_STEP_DEG: f64 = 3.0;
const SWEEP_END_DEG: f64 = 90.0;
const SLEEP_US: u64 = 300_000;
const CRUISE_RPM: f64 = 50.0;
/// Microseconds of echo per centimetre.
const US_PER_CM: f64 = 58.0;

/// The states by the numbers of the report's telemetry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
enum State {
    Wait = 0,
    FirstTurn = 1,
    Initialise = 2,
    Go = 3,
    SweepRight = 4,
    SweepLeft = 5,
    Decide = 6,
    Turn = 7,
    Seek = 8,
    Along = 9,
    Pass = 10,
}

/// Mode 8.
#[derive(Clone, Debug)]
pub(super) struct Mission {
    pub(super) speeds: Speeds,
    pub(super) pose: Pose,
    /// A goal that has come in and waits for the robot to take it.
    pub(super) ordered: Option<[f64; 2]>,
    pub(super) lane: bool,
    state: State,
    goal_m: [f64; 2],
    reference_rpm: Wheels<f64>,
    angle_ref_deg: f64,
    line_deg: f64,
    corner: Pose,
    watching: bool,
    /// It turned to the right: the obstacle is on the left.
    turned_right: bool,
    has_differed: bool,
    /// A goal has just been reached.
    arrived: bool,
    swept_deg: [f64; 2],
    last_cm: f64,
    distance: Pid,
    orientation: Pid,
    fire: bool,
    /// The switch of this pass is done and slept; the wheels are still to be driven.
    slept: bool,
}

impl Mission {
    pub(super) fn new() -> Self {
        Self {
            speeds: Speeds::new(60.0),
            pose: Pose::default(),
            ordered: None,
            lane: false,
            state: State::Wait,
            goal_m: [0.0; 2],
            reference_rpm: Wheels::both(0.0),
            angle_ref_deg: 0.0,
            line_deg: 0.0,
            corner: Pose::default(),
            watching: false,
            turned_right: false,
            has_differed: false,
            arrived: false,
            swept_deg: [0.0; 2],
            last_cm: SAFE_CM,
            distance: distance_pid(),
            orientation: Pid::new(Gains(1.5, 0.0005, 0.0), 30.0),
            fire: false,
            slept: false,
        }
    }

    /// The state's number; a lane has numbers of its own.
    pub(super) fn state(&self) -> u8 {
        match (self.lane, self.state) {
            (false, state) => state as u8,
            (true, State::SweepRight) => 1,
            (true, State::SweepLeft) => 2,
            (true, State::Decide) => 3,
            (true, State::Turn) => 4,
            (true, _) => 0,
        }
    }

    /// Begins to follow a lane, straight ahead.
    pub(super) fn follow_lane(&mut self) {
        self.lane = true;
        self.state = State::Seek;
        self.watching = true;
    }

    /// The timer: odometry every 50 ms, all sonars at once every 100 ms.
    pub(super) fn timer(&mut self, chip: &mut Chip) {
        self.speeds.timer(chip);
        self.pose.advance(self.speeds.speed_rpm());
        self.fire = !self.fire;
        if self.fire {
            for sonar in SonarId::ALL {
                chip.ping(sonar);
            }
        }
    }

    /// The interrupt at the end of an echo.
    pub(super) fn echo(&mut self, chip: &mut Chip, sonar: SonarId) {
        if sonar == SonarId::Front && self.watching && range_cm(chip, sonar) <= SAFE_CM {
            self.watching = false;
            self.orientation.reset();
            self.reference_rpm = Wheels::both(0.0);
            self.start_sweep(chip, 0);
            self.state = State::SweepRight;
        }
    }

    /// One pass of the loop, or its second half after a sleep. Returns how long it sleeps [us], if it does, and
    /// whether a goal has been reached.
    pub(super) fn pass(&mut self, chip: &mut Chip) -> (Option<u64>, bool) {
        let mut reached = false;
        if !std::mem::take(&mut self.slept) {
            let before = self.state;
            let sleep_us = self.switch(chip);
            reached = before == State::Go && self.state == State::Wait;
            if sleep_us > 0 {
                self.slept = true;
                return (Some(sleep_us), reached);
            }
        }
        self.speeds.refer(self.reference_rpm);
        self.speeds.together();
        self.speeds.drive(chip);
        (None, reached)
    }

    fn switch(&mut self, chip: &mut Chip) -> u64 {
        match self.state {
            State::Wait => self.wait(),
            State::Initialise => {
                chip.point(0.0);
                self.line_deg = self.bearing_deg();
                self.state = State::FirstTurn;
            }
            State::FirstTurn => {
                if self.turn_to(chip, self.line_deg) {
                    self.state = State::Go;
                    self.watching = true;
                    self.has_differed = false;
                }
            }
            State::Go => self.go(chip),
            State::SweepRight | State::SweepLeft => return self.sweep(chip),
            State::Decide => {
                let [right, left] = self.swept_deg;
                self.turned_right = right <= left;
                let by_deg = if self.turned_right { -90.0 } else { 90.0 };
                self.angle_ref_deg = wrapped(self.pose.angle_deg + by_deg);
                self.state = State::Turn;
            }
            State::Turn => {
                if self.turn_to(chip, self.angle_ref_deg) {
                    self.reference_rpm = Wheels::both(0.0);
                    self.state = State::Seek;
                    self.watching = true;
                }
            }
            State::Seek => {
                if !self.lane && self.beside(chip) {
                    self.state = State::Along;
                } else {
                    self.cruise(chip, CRUISE_RPM);
                }
                self.leave();
            }
            State::Along => {
                self.cruise(chip, CRUISE_RPM);
                if !self.leave() {
                    self.has_differed = true;
                    if !self.beside(chip) {
                        self.corner = self.pose;
                        self.state = State::Pass;
                    }
                }
            }
            State::Pass => self.pass_corner(chip),
        }
        0
    }

    fn wait(&mut self) {
        if std::mem::take(&mut self.arrived) {
            // The new origin is here, one pass after the goal; what the robot still rolls counts.
            self.pose = Pose::default();
        }
        if let Some(goal_m) = self.ordered.take() {
            self.goal_m = goal_m;
            self.state = State::Initialise;
        }
    }

    fn go(&mut self, chip: &Chip) {
        let [x_m, y_m] = self.goal_m;
        let distance_m = self.pose.distance_m(x_m, y_m);
        self.angle_ref_deg = self.bearing_deg();
        let rpm = self.distance.step(0.0 - distance_m, chip.millis());
        self.cruise(chip, rpm);
        if distance_m < ARRIVED_M {
            self.state = State::Wait;
            self.watching = false;
            self.orientation.reset();
            self.reference_rpm = Wheels::both(0.0);
            self.arrived = true;
        }
    }

    /// Turns about the centre; true when there.
    fn turn_to(&mut self, chip: &Chip, angle_deg: f64) -> bool {
        let error_deg = wrapped(angle_deg - self.pose.angle_deg);
        self.reference_rpm = turning(self.orientation.step(error_deg, chip.millis()));
        let there = error_deg.abs() < TURNED_DEG && self.speeds.standing();
        if there {
            self.orientation.reset();
            self.distance.reset();
        }
        there
    }

    /// Drives on, holding the angle.
    fn cruise(&mut self, chip: &Chip, rpm: f64) {
        let error_deg = wrapped(self.angle_ref_deg - self.pose.angle_deg);
        let correction_rpm = self.orientation.step(error_deg, chip.millis());
        self.reference_rpm = driving(rpm, correction_rpm);
    }

    fn pass_corner(&mut self, chip: &Chip) {
        let way_m = 0.5 * SAFE_CM * 0.01;
        let gone_m = self.pose.distance_m(self.corner.x_m, self.corner.y_m);
        let rpm = self.distance.step(gone_m - way_m, chip.millis());
        self.cruise(chip, rpm);
        if !self.leave() && gone_m >= way_m {
            self.state = State::Turn;
            self.orientation.reset();
            self.distance.reset();
            self.reference_rpm = Wheels::both(0.0);
            let by_deg = if self.turned_right { 90.0 } else { -90.0 };
            self.angle_ref_deg = wrapped(self.pose.angle_deg + by_deg);
        }
    }

    fn start_sweep(&mut self, chip: &mut Chip, side: usize) {
        chip.point(0.0);
        self.last_cm = SAFE_CM;
        self.swept_deg[side] = 0.0;
    }

    /// One step of a sweep; returns how long it sleeps [us].
    fn sweep(&mut self, chip: &mut Chip) -> u64 {
        let (side, sign) = if self.state == State::SweepRight {
            (0, -1.0)
        } else {
            (1, 1.0)
        };
        let now_cm = range_cm(chip, SonarId::Front);
        let ended =
            (now_cm - self.last_cm).abs() > JUMP_CM || self.swept_deg[side] >= SWEEP_END_DEG;
        if !ended {
            self.swept_deg[side] += SWEEP_STEP_DEG;
            chip.point(sign * self.swept_deg[side]);
            self.last_cm = now_cm;
            return SLEEP_US;
        }
        if self.state == State::SweepRight {
            self.start_sweep(chip, 1);
            self.state = State::SweepLeft;
            return 2 * SLEEP_US;
        }
        chip.point(0.0);
        self.state = State::Decide;
        SLEEP_US
    }

    /// The sonar on the obstacle's side sees it.
    fn beside(&self, chip: &Chip) -> bool {
        let sonar = if self.turned_right {
            SonarId::Left
        } else {
            SonarId::Right
        };
        range_cm(chip, sonar) < SAFE_CM + JUMP_CM
    }

    /// Leaves for the goal where the straight line is crossed again; true while on it.
    fn leave(&mut self) -> bool {
        let on_line = !self.lane && self.on_line();
        if on_line && self.has_differed {
            self.state = State::FirstTurn;
            self.orientation.reset();
        }
        on_line
    }

    fn on_line(&self) -> bool {
        (self.bearing_deg() - self.line_deg).abs() <= REJOIN_DEG
    }

    fn bearing_deg(&self) -> f64 {
        let [x_m, y_m] = self.goal_m;
        self.pose.bearing_deg(x_m, y_m)
    }
}

fn range_cm(chip: &Chip, sonar: SonarId) -> f64 {
    chip.width_us(sonar) / US_PER_CM
}
