//! Recent echoes of the sonars: a bounded set of obstacle points in the odometry frame.
//!
//! A reading says two things. *Something is on this arc*: up to three points across the beam are stored. *Nothing is
//! nearer in this beam*: points in it that are nearer and were seen from about the same direction lose belief, and are
//! removed when they have none left. From another direction silence says nothing: a face gives no echo when it is
//! turned away by more than the beam's half angle plus the incidence limit, 0.31 + 0.55 rad (docs/theory/mission.md).
//!
//! Millimetres in 16 bits and a direction in 8 keep a point in 6 bytes and its arithmetic in integers: the memory is
//! read some ten times as often as it is written.

use super::beam::{Beam, direction};
use super::place::{Bounds, Place, fractions};
use crate::math::{round, sin_cos};
use crate::types::{Pose, Range, SonarId, SonarReading, Transform};

/// Most points stored.
pub(super) const CAPACITY: usize = 48;
/// Most silences of the front sonar that wait for its next echo: those of two sweeps.
const SILENCES: usize = 12;
/// Points closer together than this are merged [mm].
const MERGE_MM: u16 = 50;
/// Belief in a point detected once, in one detected again, and the maximum.
const FRESH: u8 = 2;
const FIRM: u8 = 3;
const MOST_BELIEF: u8 = 6;
/// Points nearer to the robot than this count even if detected only once [mm].
const CLOSE_MM: u16 = 350;
/// Farthest point stored, of the front sonar and of a side sonar [mm].
const HORIZON_MM: [i32; 2] = [1_300, 700];
/// Silence contradicts only points nearer than this [mm].
const REACH_MM: i32 = 2_500;
/// Half width of the part of a beam in which a point would surely be detected, as a tangent in 256ths: 0.21 rad.
const SURE_TANGENT: i32 = 54;
/// A reading this much beyond a point contradicts it: [mm] and 256ths of the range.
const BEYOND_MM: i32 = 50;
const BEYOND_SHARE: i32 = 20;
/// Half width of a beam, as a tangent in 256ths: 0.33 rad.
const BEAM_TANGENT: i32 = 88;
/// What approaches has left points on its way, so far behind it [mm].
const TRAIL_MM: i32 = 300;
/// An echo this near to the distance of a point may be the point's: [mm] and 256ths of the range.
const ALIKE_MM: i32 = 25;
const ALIKE_SHARE: i32 = 8;
/// Directions alike, in 256ths of a turn: 0.47 rad.
const ALIKE: i8 = 19;
/// Offsets from the axis at which an arc gets points, by their sines and cosines: 0, 0.2 and -0.2 rad.
const ACROSS: [(f32, f32); 3] = {
    let (sin, cos) = sin_cos(0.2);
    [(0.0, 1.0), (sin, cos), (-sin, cos)]
};
/// Echoes nearer than this always store a point: nothing near may be missed [mm].
const NEAR_MM: i32 = 300;
/// A wall that a side sonar sees within this is extended ahead, by this much [mm, m].
const BESIDE_MM: i32 = 200;
const GOES_ON_M: f32 = 0.1;
/// Arcs shorter than this get one point [m].
const SHORT_M: f32 = 0.18;

/// A remembered point of an obstacle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct ObstaclePoint {
    at: Place,
    /// The beam's axis at its last echo, in 256ths of a turn.
    axis: i8,
    /// Recent detections; 0: no point.
    belief: u8,
}

impl ObstaclePoint {
    const NONE: Self = Self {
        at: Place { x_mm: 0, y_mm: 0 },
        axis: 0,
        belief: 0,
    };

    /// Its position, if there is a point.
    #[inline]
    pub(super) fn place(&self) -> Option<Place> {
        (self.belief > 0).then_some(self.at)
    }

    /// Detected again.
    fn confirm(&mut self) {
        self.belief = (self.belief + 1).clamp(FIRM, MOST_BELIEF);
    }
}

/// Most points stored per reading: those across the beam, and one ahead.
const MOST_PUT: usize = ACROSS.len() + 1;

/// Slots for a reading's points: free ones, then those of the farthest points. Up to four are found in one pass.
struct Room {
    robot: Place,
    /// Distance of the point in a slot [mm], and the slot's number; the farthest first.
    slots: [(u16, u8); MOST_PUT],
    /// The first not taken yet.
    next: usize,
}

impl Room {
    fn offer(&mut self, away_mm: u16, number: u8) {
        let mut offered = (away_mm, number);
        if self
            .slots
            .last()
            .is_some_and(|(least, _)| away_mm <= *least)
        {
            return;
        }
        for slot in &mut self.slots {
            if offered.0 > slot.0 {
                core::mem::swap(&mut offered, slot);
            }
        }
    }

    /// A slot for a point; none where all stored points are nearer.
    fn take(&mut self, at: Place) -> Option<u8> {
        let (away_mm, number) = *self.slots.get(self.next)?;
        if away_mm <= at.about_mm(self.robot) {
            return None;
        }
        self.next += 1;
        Some(number)
    }
}

/// A silence that waits for the next echo.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Silence {
    apex: Place,
    axis: i8,
}

/// The memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Echoes {
    points: [ObstaclePoint; CAPACITY],
    /// Silences of the front sonar, the oldest first: their number, and how many of them are confirmed.
    silences: [Silence; SILENCES],
    silent: u8,
    confirmed: u8,
}

impl Default for Echoes {
    #[inline]
    fn default() -> Self {
        Self {
            points: [ObstaclePoint::NONE; CAPACITY],
            silences: [Silence::default(); SILENCES],
            silent: 0,
            confirmed: 0,
        }
    }
}

impl Echoes {
    /// All points by their numbers, free slots included.
    #[inline]
    pub(super) fn points(&self) -> &[ObstaclePoint; CAPACITY] {
        &self.points
    }

    /// Whether a point was detected more than once, or is near the robot, which is `here`.
    pub(super) fn is_firm(&self, number: usize, here: Place) -> bool {
        self.points.get(number).is_some_and(|point| {
            point.belief >= FIRM || (point.belief > 0 && point.at.is_within(CLOSE_MM, here))
        })
    }

    /// Fades points detected only once, or all of them. To be called at intervals.
    pub(super) fn fade(&mut self, all: bool) {
        for point in (self.points.iter_mut()).filter(|point| all || point.belief < FIRM) {
            point.belief = point.belief.saturating_sub(1);
        }
    }

    /// The point with this number.
    pub(super) fn get(&self, number: usize) -> Option<Place> {
        let point = self.points.get(number)?;
        (point.belief > 0).then_some(point.at)
    }

    /// Ingests a reading with its beam; says whether it is an echo in reach that no point explains. Unless it is `sure`,
    /// points that it contradicts keep their belief.
    pub(super) fn ingest(
        &mut self,
        robot: &Transform,
        reading: &SonarReading,
        beam: &Beam,
        sure: bool,
    ) -> bool {
        let pose = &robot.pose;
        let ((x_m, y_m), (sin, cos)) = (beam.from_m, beam.sin_cos);
        let [front_mm, side_mm] = HORIZON_MM;
        let (range_mm, echo) = match reading.range {
            Range::Valid(range_m) => (round(1_000.0 * range_m), true),
            Range::Clear => (REACH_MM, false),
            Range::Faulty => return false,
        };
        if sure {
            self.clear(beam, range_mm);
        }
        let horizon_mm = if reading.sonar == SonarId::Front {
            front_mm
        } else {
            side_mm
        };
        if !echo || range_mm > horizon_mm {
            return false;
        }
        let range_m = 1e-3 * crate::math::from_u32(range_mm.unsigned_abs());
        let explained = self.explain(beam, range_mm);
        if explained && range_mm > NEAR_MM {
            return false;
        }
        let mut room = self.room(Place::new(pose.x_m, pose.y_m));
        let count = if explained || range_m < SHORT_M {
            1
        } else {
            ACROSS.len()
        };
        for (by_sin, by_cos) in ACROSS.iter().take(count) {
            let (aside_sin, aside_cos) = (sin * by_cos + cos * by_sin, cos * by_cos - sin * by_sin);
            let at = Place::new(x_m + range_m * aside_cos, y_m + range_m * aside_sin);
            self.put(at, beam.axis, &mut room);
        }
        if reading.sonar != SonarId::Front && range_mm < BESIDE_MM {
            // A wall beside the robot is assumed to reach as far as the robot's front, until the sonar has been there.
            let at = Place::new(
                x_m + range_m * cos + GOES_ON_M * robot.cos,
                y_m + range_m * sin + GOES_ON_M * robot.sin,
            );
            // While the robot turns, this place slides off the wall: it confirms a point, and moves none.
            match self.merging(at) {
                Some(point) => point.confirm(),
                None => self.put(at, beam.axis, &mut room),
            }
        }
        !explained
    }

    /// The front sonar reported that nothing is in reach. That lowers no belief until the next echo: a sonar that is
    /// always silent contradicts nothing.
    pub(super) fn silence(&mut self, beam: &Beam) {
        if usize::from(self.silent) == SILENCES {
            self.silences.rotate_left(1);
            self.silent -= 1;
            self.confirmed = self.confirmed.saturating_sub(1);
        }
        if let Some(next) = self.silences.get_mut(usize::from(self.silent)) {
            *next = Silence {
                apex: beam.apex,
                axis: beam.axis,
            };
            self.silent += 1;
        }
    }

    /// The front sonar has had an echo: it worked during the silences before.
    pub(super) fn confirm_silences(&mut self) {
        self.confirmed = self.silent;
    }

    /// Ingests one of the confirmed silences. To be called once a tick.
    pub(super) fn settle(&mut self) {
        if self.confirmed == 0 {
            return;
        }
        let [Silence { apex, axis }, ..] = self.silences;
        self.silences.rotate_left(1);
        self.silent -= 1;
        self.confirmed -= 1;
        let axis_rad = f32::from(axis) * (core::f32::consts::PI / 128.0);
        self.clear(&Beam::along(apex, axis_rad), REACH_MM);
    }

    /// What this reading saw approaches: its way is free.
    pub(super) fn forget(&mut self, robot: &Transform, reading: &SonarReading, range_m: f32) {
        let (beam, _) = Beam::of(robot, reading);
        self.clear(&beam, round(1_000.0 * range_m) + TRAIL_MM);
    }

    /// Lowers the belief in points that a beam as far as `range_mm` would have detected.
    fn clear(&mut self, beam: &Beam, range_mm: i32) {
        let axis = beam.axis;
        let until_mm = range_mm - BEYOND_MM - ((range_mm * BEYOND_SHARE) >> 8);
        let aside_mm = (until_mm * SURE_TANGENT) >> 8;
        let bounds = Bounds::of(beam.apex, &beam.facing, until_mm, aside_mm);
        for point in &mut self.points {
            let alike = point.axis.wrapping_sub(axis).unsigned_abs() <= ALIKE.unsigned_abs();
            if point.belief == 0 || !alike || !bounds.hold(point.at) {
                continue;
            }
            let (along, across) = point.at.seen(beam.apex, &beam.facing);
            if along > 0 && along < until_mm && across.abs() * 256 < along * SURE_TANGENT {
                point.belief = if point.belief < FIRM {
                    0
                } else {
                    point.belief - 1
                };
            }
        }
    }

    /// Whether a known point explains this echo: its belief is then raised, and the echo adds nothing new.
    fn explain(&mut self, beam: &Beam, range_mm: i32) -> bool {
        let within_mm = ALIKE_MM + ((range_mm * ALIKE_SHARE) >> 8);
        let (near_mm, far_mm) = (range_mm - within_mm, range_mm + within_mm);
        let (near_mm2, far_mm2) = (
            (near_mm * near_mm).unsigned_abs(),
            (far_mm * far_mm).unsigned_abs(),
        );
        let bounds = Bounds::of(
            beam.apex,
            &beam.facing,
            far_mm,
            (far_mm * BEAM_TANGENT) >> 8,
        );
        let mut best: Option<&mut ObstaclePoint> = None;
        for point in &mut self.points {
            if point.belief == 0 || !bounds.hold(point.at) {
                continue;
            }
            let square_mm2 = point.at.square_mm2(beam.apex);
            if square_mm2 <= near_mm2
                || square_mm2 >= far_mm2
                || best
                    .as_ref()
                    .is_some_and(|best| best.belief >= point.belief)
            {
                continue;
            }
            let (along, across) = point.at.seen(beam.apex, &beam.facing);
            if across.abs() * 256 < along * BEAM_TANGENT {
                best = Some(point);
            }
        }
        let Some(point) = best else {
            return false;
        };
        point.axis = beam.axis;
        point.confirm();
        true
    }

    /// The slots for a reading's points.
    fn room(&self, robot: Place) -> Room {
        let mut room = Room {
            robot,
            slots: [(0, 0); MOST_PUT],
            next: 0,
        };
        for (number, point) in (0..).zip(&self.points) {
            // Farther than anything: a free slot is the first choice.
            let away_mm = if point.belief == 0 {
                u16::MAX
            } else {
                point.at.about_mm(robot)
            };
            room.offer(away_mm, number);
        }
        room
    }

    /// The point that a new one at this place is merged with.
    fn merging(&mut self, at: Place) -> Option<&mut ObstaclePoint> {
        let around = Bounds::around(at, MERGE_MM);
        let mut points = self.points.iter_mut();
        points.find(|point| {
            point.belief > 0 && around.hold(point.at) && point.at.is_within(MERGE_MM, at)
        })
    }

    /// Stores a point: merged with an existing one, in a free slot, or in place of a farther one.
    fn put(&mut self, at: Place, axis: i8, room: &mut Room) {
        if let Some(point) = self.merging(at) {
            point.at = at;
            point.axis = axis;
            point.confirm();
            return;
        }
        if let Some(point) = room
            .take(at)
            .and_then(|number| self.points.get_mut(usize::from(number)))
        {
            *point = ObstaclePoint {
                at,
                axis,
                belief: FRESH,
            };
        }
    }

    /// The place at `origin` becomes the origin.
    pub(super) fn move_origin(&mut self, origin: &Pose, facing: (f32, f32)) {
        let (here, facing) = (Place::new(origin.x_m, origin.y_m), fractions(facing));
        let turned = direction(origin.heading_rad);
        for point in self.points.iter_mut().filter(|point| point.belief > 0) {
            point.at = point.at.as_seen(here, &facing);
            point.axis = point.axis.wrapping_sub(turned);
        }
        for silence in &mut self.silences {
            silence.apex = silence.apex.as_seen(here, &facing);
            silence.axis = silence.axis.wrapping_sub(turned);
        }
    }
}

#[cfg(test)]
mod tests;
