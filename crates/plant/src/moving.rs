//! Bodies that move: convex outlines whose pose is a function of simulated time.
//!
//! A [`Body`] follows a [`Course`], which nothing that happens in the world changes: so the state of a plant stays plain
//! numbers, and a look ahead, a snapshot and a repetition meet the same bodies. A sonar asks for the outline at the
//! instant of its ping, contact for that at the end of the step.

use libm::{sincos, sqrt};

use crate::outline::{Obstacle, Point, Pose, ShapeError, add, dot, sub};

/// Most bodies of a world: contact keeps a bit for each.
pub const MOST_BODIES: usize = 63;

/// How fast a body moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyVelocity {
    /// Along the world's x and y.
    pub m_s: Point,
    /// Turn rate, counter-clockwise.
    pub yaw_rad_s: f64,
}

/// Where a body is at an instant, and how fast it moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyMotion {
    /// Where.
    pub pose: Pose,
    /// How fast.
    pub velocity: BodyVelocity,
}

impl BodyMotion {
    /// Velocity of the body's point that is at `at`.
    #[must_use]
    pub fn surface_m_s(&self, at: Point) -> Point {
        let arm = sub(at, [self.pose.x_m, self.pose.y_m]);
        let BodyVelocity { m_s, yaw_rad_s } = self.velocity;
        [m_s[0] - yaw_rad_s * arm[1], m_s[1] + yaw_rad_s * arm[0]]
    }
}

/// A pose and when it is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedWaypoint {
    /// Time since the start of the route.
    pub at_us: u64,
    /// The pose; the heading is not wrapped.
    pub pose: Pose,
}

/// What follows the last waypoint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MoverRepeat {
    /// The body stays there.
    #[default]
    Once,
    /// The first one: both are the same pose.
    Loop,
    /// The way back, and so on.
    BackAndForth,
}

/// Waypoints with straight, even motion between them.
#[derive(Clone, Debug, PartialEq)]
pub struct MoverRoute {
    waypoints: Vec<TimedWaypoint>,
    repeat: MoverRepeat,
    start_us: u64,
}

/// What gives a body's pose.
#[derive(Clone, Debug, PartialEq)]
pub enum Course {
    /// A route, at its first waypoint until it starts.
    Route(MoverRoute),
    /// Straight on from a pose, with the velocity it had there.
    Straight {
        /// Time of `from`.
        at_us: u64,
        /// Pose and velocity then.
        from: BodyMotion,
    },
}

/// A convex outline on its course.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Counter-clockwise, in its own frame.
    corners: Vec<Point>,
    /// Farthest corner from the origin of that frame.
    radius_m: f64,
    course: Course,
    fastest_m_s: f64,
}

impl MoverRoute {
    /// A route that starts at `start_us`.
    ///
    /// # Errors
    /// Fewer than two waypoints, times that do not grow from 0, a loop that is not closed, a pose that is not finite.
    pub fn new(
        waypoints: Vec<TimedWaypoint>,
        repeat: MoverRepeat,
        start_us: u64,
    ) -> Result<Self, ShapeError> {
        let poses = || waypoints.iter().map(|waypoint| waypoint.pose);
        let finite = |pose: Pose| {
            pose.x_m.is_finite() && pose.y_m.is_finite() && pose.heading_rad.is_finite()
        };
        if !poses().all(finite) {
            return Err(ShapeError::NotFinite);
        }
        let grows = waypoints.windows(2).all(|two| two[0].at_us < two[1].at_us);
        let begins = waypoints.first().is_some_and(|first| first.at_us == 0);
        let closed = repeat != MoverRepeat::Loop || poses().next() == poses().next_back();
        if waypoints.len() < 2 || !grows || !begins || !closed {
            return Err(ShapeError::NoRoute);
        }
        Ok(Self {
            waypoints,
            repeat,
            start_us,
        })
    }

    /// The waypoints.
    #[must_use]
    pub fn waypoints(&self) -> &[TimedWaypoint] {
        &self.waypoints
    }

    /// What follows the last one.
    #[must_use]
    pub const fn repeat(&self) -> MoverRepeat {
        self.repeat
    }

    /// Time of the first one.
    #[must_use]
    pub const fn start_us(&self) -> u64 {
        self.start_us
    }

    fn shift(&mut self, by_m: Point) {
        for waypoint in &mut self.waypoints {
            waypoint.pose.shift(by_m);
        }
    }

    fn at(&self, now_us: u64) -> BodyMotion {
        let since_us = now_us.saturating_sub(self.start_us);
        let last_us = self.waypoints[self.waypoints.len() - 1].at_us;
        let (along_us, direction) = match self.repeat {
            MoverRepeat::Once => (since_us.min(last_us), 1.0),
            MoverRepeat::Loop => (since_us % last_us, 1.0),
            MoverRepeat::BackAndForth => match since_us % (2 * last_us) {
                forth if forth < last_us => (forth, 1.0),
                back => (2 * last_us - back, -1.0),
            },
        };
        let next = self
            .waypoints
            .partition_point(|waypoint| waypoint.at_us <= along_us)
            .min(self.waypoints.len() - 1);
        let moves =
            now_us >= self.start_us && (self.repeat != MoverRepeat::Once || since_us < last_us);
        leg(
            &self.waypoints[next - 1],
            &self.waypoints[next],
            along_us,
            if moves { direction } else { 0.0 },
        )
    }

    /// Fastest that a point within `radius_m` of the origin moves.
    fn fastest_m_s(&self, radius_m: f64) -> f64 {
        self.waypoints
            .windows(2)
            .map(|two| fastest_m_s(&leg(&two[0], &two[1], two[0].at_us, 1.0).velocity, radius_m))
            .fold(0.0, f64::max)
    }
}

/// Between two waypoints; `direction` -1 backwards, 0 at rest.
fn leg(from: &TimedWaypoint, to: &TimedWaypoint, along_us: u64, direction: f64) -> BodyMotion {
    let whole_us = (to.at_us - from.at_us) as f64;
    let share = (along_us - from.at_us) as f64 / whole_us;
    let (a, b) = (from.pose, to.pose);
    let way = [b.x_m - a.x_m, b.y_m - a.y_m, b.heading_rad - a.heading_rad];
    let per_s = direction * 1e6 / whole_us;
    BodyMotion {
        pose: Pose {
            x_m: a.x_m + share * way[0],
            y_m: a.y_m + share * way[1],
            heading_rad: a.heading_rad + share * way[2],
        },
        velocity: BodyVelocity {
            m_s: [way[0] * per_s, way[1] * per_s],
            yaw_rad_s: way[2] * per_s,
        },
    }
}

impl Body {
    /// A body with these corners, counter-clockwise in its own frame.
    ///
    /// # Errors
    /// Corners that are not finite, or not convex and counter-clockwise.
    pub fn new(corners: Vec<Point>, course: Course) -> Result<Self, ShapeError> {
        Obstacle::convex(&corners)?;
        let radius_m = corners
            .iter()
            .map(|&corner| sqrt(dot(corner, corner)))
            .fold(0.0, f64::max);
        let mut body = Self {
            corners,
            radius_m,
            course: Course::Straight {
                at_us: 0,
                from: BodyMotion::default(),
            },
            fastest_m_s: 0.0,
        };
        body.follow(course);
        Ok(body)
    }

    /// Corners in its own frame.
    #[must_use]
    pub fn corners(&self) -> &[Point] {
        &self.corners
    }

    /// Its course.
    #[must_use]
    pub const fn course(&self) -> &Course {
        &self.course
    }

    /// Farthest corner from the origin of its frame.
    #[must_use]
    pub const fn radius_m(&self) -> f64 {
        self.radius_m
    }

    /// No point of it is faster on this course.
    #[must_use]
    pub const fn fastest_m_s(&self) -> f64 {
        self.fastest_m_s
    }

    /// Where it is.
    #[must_use]
    pub fn at(&self, now_us: u64) -> BodyMotion {
        match &self.course {
            Course::Route(route) => route.at(now_us),
            Course::Straight { at_us, from } => {
                let dt_s = now_us.saturating_sub(*at_us) as f64 * 1e-6;
                let BodyMotion { pose, velocity } = *from;
                let pose = Pose {
                    x_m: pose.x_m + velocity.m_s[0] * dt_s,
                    y_m: pose.y_m + velocity.m_s[1] * dt_s,
                    heading_rad: pose.heading_rad + velocity.yaw_rad_s * dt_s,
                };
                BodyMotion { pose, velocity }
            }
        }
    }

    /// Its outline there.
    #[must_use]
    pub fn outline(&self, pose: &Pose) -> Obstacle {
        let mut outline = Obstacle::default();
        self.outline_again(pose, &mut outline);
        outline
    }

    /// The same in place of an earlier outline, whose memory it keeps.
    pub fn outline_again(&self, pose: &Pose, outline: &mut Obstacle) {
        let (s, c) = sincos(pose.heading_rad);
        let place = |&[x, y]: &Point| add([pose.x_m, pose.y_m], [c * x - s * y, s * x + c * y]);
        outline.take_corners(self.corners.iter().map(place));
    }

    /// True if it stands here for good, on its course as it is.
    #[must_use]
    pub fn stands_as(&self, motion: &BodyMotion) -> bool {
        let stands = motion.velocity == BodyVelocity::default();
        stands && matches!(&self.course, Course::Straight { from, .. } if from == motion)
    }

    /// Sets its course; returns how far at most a point of it jumps now \[m\].
    pub fn turn_to(&mut self, now_us: u64, course: Course) -> f64 {
        let was = self.at(now_us).pose;
        self.follow(course);
        way_m(&was, &self.at(now_us).pose, self.radius_m)
    }

    /// Shifts its whole course.
    pub(crate) fn shift(&mut self, by_m: Point) {
        match &mut self.course {
            Course::Route(route) => route.shift(by_m),
            Course::Straight { from, .. } => from.pose.shift(by_m),
        }
    }

    /// Takes the course of another one with the same outline.
    pub(crate) fn go_as(&mut self, other: &Self) {
        match (&mut self.course, &other.course) {
            // Robots of a fleet do so all the time: plain numbers, copied.
            (
                Course::Straight { at_us, from },
                &Course::Straight {
                    at_us: other_us,
                    from: other_from,
                },
            ) => {
                *at_us = other_us;
                *from = other_from;
            }
            (own, course) => own.clone_from(course),
        }
        self.fastest_m_s = other.fastest_m_s;
    }

    fn follow(&mut self, course: Course) {
        self.fastest_m_s = match &course {
            Course::Route(route) => route.fastest_m_s(self.radius_m),
            Course::Straight { from, .. } => fastest_m_s(&from.velocity, self.radius_m),
        };
        self.course = course;
    }
}

/// No point within `radius_m` of the origin of a frame is farther from where it was [m].
#[must_use]
pub fn way_m(was: &Pose, is: &Pose, radius_m: f64) -> f64 {
    let turn_rad = (is.heading_rad - was.heading_rad).abs();
    // By the shorter way, if a heading was wrapped.
    let turn_rad = turn_rad.min((core::f64::consts::TAU - turn_rad).abs());
    (is.x_m - was.x_m).abs() + (is.y_m - was.y_m).abs() + turn_rad * radius_m
}

fn fastest_m_s(velocity: &BodyVelocity, radius_m: f64) -> f64 {
    sqrt(dot(velocity.m_s, velocity.m_s)) + velocity.yaw_rad_s.abs() * radius_m
}
