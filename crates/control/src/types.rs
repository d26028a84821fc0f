//! The values that cross the boundary of the core, each with its unit, and the newtypes of raw counts.

pub use crate::fault::Fault;
use crate::math::sin_cos;
use core::ops::{Index, IndexMut};

/// Control ticks per second [Hz].
pub const TICK_HZ: u32 = 100;
/// Period of the control tick [us].
pub const TICK_US: u32 = 1_000_000 / TICK_HZ;
/// Period of the control tick [s].
pub const TICK_S: f32 = 1.0 / TICK_HZ as f32;
/// Time from the latching of the inputs to the outputs taking effect [us].
pub const OUTPUT_DELAY_US: u32 = 3_000;

/// A side of the robot, looking forward. The original's motor A is the right wheel, B the left one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Left, towards +y.
    Left,
    /// Right, towards -y.
    Right,
}

impl Side {
    /// The side opposite.
    pub const fn other(self) -> Side {
        match self {
            Side::Left => Side::Right,
            Side::Right => Side::Left,
        }
    }
}

/// Both sides, in the order in which they are always processed.
pub const SIDES: [Side; 2] = [Side::Left, Side::Right];

/// One value for each wheel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wheels<T> {
    /// The left wheel's.
    pub left: T,
    /// The right wheel's.
    pub right: T,
}

impl<T> Wheels<T> {
    /// The same value for both wheels.
    pub const fn both(value: T) -> Self
    where
        T: Copy,
    {
        Self {
            left: value,
            right: value,
        }
    }

    /// Applies `f` to each wheel's value.
    pub fn map<U>(self, mut f: impl FnMut(T) -> U) -> Wheels<U> {
        Wheels {
            left: f(self.left),
            right: f(self.right),
        }
    }
}

impl<T> Index<Side> for Wheels<T> {
    type Output = T;

    fn index(&self, side: Side) -> &T {
        match side {
            Side::Left => &self.left,
            Side::Right => &self.right,
        }
    }
}

impl<T> IndexMut<Side> for Wheels<T> {
    fn index_mut(&mut self, side: Side) -> &mut T {
        match side {
            Side::Left => &mut self.left,
            Side::Right => &mut self.right,
        }
    }
}

/// A reading of the robot's free-running microsecond clock. It wraps after 71.6 minutes; differences survive the wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Micros(pub u32);

impl Micros {
    /// Time from `earlier` to `self` [us], right as long as it is below 71.6 minutes.
    pub const fn since(self, earlier: Micros) -> u32 {
        self.0.wrapping_sub(earlier.0)
    }

    /// The instant `us` microseconds later.
    pub const fn after(self, us: u32) -> Micros {
        Micros(self.0.wrapping_add(us))
    }
}

/// PWM of one wheel, signed: -255 (full backward) to 255 (full forward); 0 releases the bridge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Duty(i16);

impl Duty {
    /// Full forward.
    pub const MAX: i16 = 255;
    /// The bridge released.
    pub const RELEASED: Duty = Duty(0);

    /// A duty from PWM counts, limited to -255..=255.
    pub const fn new(counts: i16) -> Duty {
        if counts > Self::MAX {
            Duty(Self::MAX)
        } else if counts < -Self::MAX {
            Duty(-Self::MAX)
        } else {
            Duty(counts)
        }
    }

    /// PWM counts, -255..=255.
    pub const fn counts(self) -> i16 {
        self.0
    }
}

/// Record of one wheel's encoder interrupt at the tick. One Hall channel: the direction is not measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Edges {
    /// Edges seen since the start, wrapping.
    pub count: u16,
    /// Instant of the last edge.
    pub last: Micros,
    /// Time between the last edge and the one of the same pole a motor turn (eight edges) before [us];
    /// 0 until there have been eight.
    pub turn_us: u32,
}

/// The three sonars of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum SonarId {
    /// Left (or first of a pair).
    Left = 0,
    /// Right (or second of a pair).
    Right = 1,
    /// In front, on the servo in the final rig.
    Front = 2,
}

impl SonarId {
    /// All sonars, in the order of their numbers.
    pub const ALL: [SonarId; 3] = [SonarId::Left, SonarId::Right, SonarId::Front];
}

/// The result of a ping.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Echo {
    /// Time for which the echo line was high [us].
    Pulse(u32),
    /// The line rose and did not fall within the range: nothing in sight.
    Clear,
    /// The line never rose, or was already high when the ping was due.
    Silent,
}

/// A range as the modes see it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Range {
    /// Distance from the sonar [m].
    Valid(f32),
    /// Nothing within reach.
    Clear,
    /// No echo line, or impossible values; also before the first reading.
    #[default]
    Faulty,
}

/// Position and direction of a sonar, in the robot's frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SonarView {
    /// Ahead of the wheels' axis [m].
    pub x_m: f32,
    /// Left of the middle [m].
    pub y_m: f32,
    /// The beam's axis, counter-clockwise from ahead [rad].
    pub axis_rad: f32,
}

/// A sonar's reading at this tick, unfiltered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SonarReading {
    /// Which one.
    pub sonar: SonarId,
    /// Its range.
    pub range: Range,
    /// Its view when it pinged, in the robot's present frame: the robot has moved since.
    pub view: SonarView,
    /// Where the servo pointed when it pinged [rad].
    pub servo_rad: f32,
}

/// A range and its age.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AgedRange {
    /// The range.
    pub range: Range,
    /// Ticks since the one at which it was answered; stays at the largest number.
    pub age_ticks: u16,
}

impl AgedRange {
    /// A range that was answered at this tick.
    pub const fn fresh(range: Range) -> Self {
        Self {
            range,
            age_ticks: 0,
        }
    }

    /// Older than `limit_s` [s].
    pub fn is_older(&self, limit_s: f32) -> bool {
        f32::from(self.age_ticks) * TICK_S > limit_s
    }
}

impl Default for AgedRange {
    #[inline]
    fn default() -> Self {
        Self {
            range: Range::Faulty,
            age_ticks: u16::MAX,
        }
    }
}

/// Angle of the front sonar's servo [rad]: 0 straight ahead, positive to the left, -pi/2..=pi/2.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ServoAngle(pub f32);

/// Where the robot looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Where the servo points.
    pub servo: ServoAngle,
    /// Which sonars matter, by `SonarId` number; these are pinged in turn.
    pub sonars: [bool; 3],
}

impl Default for Look {
    #[inline]
    fn default() -> Self {
        Self::AHEAD
    }
}

impl Look {
    /// The servo ahead, every sonar in turn.
    pub const AHEAD: Self = Self {
        servo: ServoAngle(0.0),
        sonars: [true; 3],
    };

    /// One sonar only, as often as it can.
    pub const fn only(sonar: SonarId) -> Self {
        let mut sonars = [false; 3];
        sonars[sonar as usize] = true;
        Self {
            servo: ServoAngle(0.0),
            sonars,
        }
    }
}

/// Velocity of the robot's body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Velocity {
    /// Forward [m/s].
    pub forward_m_s: f32,
    /// Yaw rate, to the left [rad/s].
    pub yaw_rad_s: f32,
}

/// Position and heading in the world frame (REP 103).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Forward of the start [m].
    pub x_m: f32,
    /// Left of the start [m].
    pub y_m: f32,
    /// Counter-clockwise from x, in (-pi, pi] [rad].
    pub heading_rad: f32,
}

impl Pose {
    /// A point of the world [m] as seen from here: ahead, left.
    pub fn to_local(&self, x_m: f32, y_m: f32) -> (f32, f32) {
        Transform::of(*self).to_local(x_m, y_m)
    }

    /// A point seen from here [m] (ahead, left) in the world.
    pub fn to_world(&self, ahead_m: f32, left_m: f32) -> (f32, f32) {
        Transform::of(*self).to_world(ahead_m, left_m)
    }
}

/// A pose with the sine and cosine of its heading, which take the AVR as long as all the rest of a transformation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// The pose.
    pub pose: Pose,
    /// Sine of its heading.
    pub sin: f32,
    /// Cosine of its heading.
    pub cos: f32,
}

impl Default for Transform {
    #[inline]
    fn default() -> Self {
        Self {
            pose: Pose::default(),
            sin: 0.0,
            cos: 1.0,
        }
    }
}

impl Transform {
    /// A pose.
    pub fn of(pose: Pose) -> Transform {
        let (sin, cos) = sin_cos(pose.heading_rad);
        Transform { pose, sin, cos }
    }

    /// A point of the world [m] as seen from here: ahead, left.
    pub fn to_local(&self, x_m: f32, y_m: f32) -> (f32, f32) {
        let (dx, dy) = (x_m - self.pose.x_m, y_m - self.pose.y_m);
        (self.cos * dx + self.sin * dy, self.cos * dy - self.sin * dx)
    }

    /// A point seen from here [m] (ahead, left) in the world.
    pub fn to_world(&self, ahead_m: f32, left_m: f32) -> (f32, f32) {
        (
            self.pose.x_m + self.cos * ahead_m - self.sin * left_m,
            self.pose.y_m + self.sin * ahead_m + self.cos * left_m,
        )
    }
}

/// The latched inputs of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inputs {
    /// The instant of the tick.
    pub now: Micros,
    /// Both encoders.
    pub encoders: Wheels<Edges>,
    /// A ping that ended since the last tick.
    pub echo: Option<(SonarId, Echo)>,
    /// Battery voltage [V] where a divider is wired; the original has none.
    pub battery_v: Option<f32>,
}

/// The outputs of a tick, which take effect [`OUTPUT_DELAY_US`] after it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outputs {
    /// PWM and direction of both wheels.
    pub drive: Wheels<Duty>,
    /// Where the front sonar points.
    pub servo: ServoAngle,
    /// The sonar to trigger, if any.
    pub ping: Option<SonarId>,
}

/// A mode's request to the wheels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Drive {
    /// Both bridges released.
    #[default]
    Release,
    /// Open loop: signed fraction of full PWM for each wheel, -1..=1.
    Duty(Wheels<f32>),
    /// Wheel speeds [rad/s].
    WheelSpeed(Wheels<f32>),
    /// Body velocities.
    Twist {
        /// Forward speed [m/s].
        forward_m_s: f32,
        /// Yaw rate, counter-clockwise [rad/s].
        yaw_rad_s: f32,
    },
}
