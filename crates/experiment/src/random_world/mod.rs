//! Random worlds for mode 8: boxes on the floor and a goal, another arrangement for each seed, with the true shortest
//! path.
//!
//! Groups of boxes (one, several that touch, an L, a U; some of them against a wall) are placed at random. Groups that
//! do not touch are far enough apart for the robot to pass, so there is never a doubt whether a goal can be reached. In
//! a given share of the worlds the goal is inside a box or walled in; in a given share of the others a group blocks the
//! straight line to the goal.
//!
//! Everything follows from the seed. What does not fit is drawn again, so that the shares are as requested. Derivation
//! and figures: docs/theory/random_worlds.md.

mod arrangement;
mod dice;
mod layouts;

use crate::shortest_path::{Floor, Path};
use arrangement::Arrangement;
pub(crate) use dice::Dice;
use rumbo_plant::params::Body;
use rumbo_plant::world::{Block, Point, Wall, World};

/// Arrangements tried for a seed.
const ATTEMPTS: u32 = 1000;

/// Configuration of random worlds: `[random]` of a world file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RandomWorld {
    /// Minimum and maximum number of groups of boxes; fewer where they do not fit.
    pub groups: [f64; 2],
    /// Smallest and largest straight distance from the start to the goal [m].
    pub goal_away_m: [f64; 2],
    /// Share of the worlds with a goal that cannot be reached, half of them inside a box, half walled in.
    pub unreachable: f64,
    /// Share of the other worlds in which something blocks the straight line to the goal.
    pub blocked: f64,
}

impl Default for RandomWorld {
    fn default() -> Self {
        Self {
            groups: [2.0, 6.0],
            goal_away_m: [2.0, 4.0],
            unreachable: 0.1,
            blocked: 0.8,
        }
    }
}

/// The relevant sizes of the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// Half its width [m]: the least distance at which the middle of its axis can pass anything.
    pub half_width_m: f64,
    /// Its farthest corner from the middle of its axis [m]: the room it needs to turn on the spot.
    pub turning_m: f64,
}

impl Size {
    /// The size of a body.
    #[must_use]
    pub fn of(body: &Body) -> Self {
        let half_width_m = 0.5 * body.width_m;
        let far_m = 0.5 * body.length_m + body.centre_ahead_m.abs();
        Self {
            half_width_m,
            turning_m: libm::hypot(far_m, half_width_m),
        }
    }

    /// Radius of a disc that can reach every goal that counts as reachable [m]: it excludes passages that are hard to
    /// drive.
    #[must_use]
    pub fn easy_m(&self) -> f64 {
        self.turning_m + 0.03
    }

    /// Least distance between groups that do not touch, and from the walls [m].
    fn gap_m(&self) -> f64 {
        2.0 * (self.turning_m + 0.05)
    }

    /// Free radius around the start [m].
    fn start_room_m(&self) -> f64 {
        self.turning_m + 0.15
    }

    /// Free radius around a goal that can be reached [m].
    fn goal_room_m(&self) -> f64 {
        self.turning_m + 0.20
    }
}

/// The site of a random world.
#[derive(Clone, Copy, Debug)]
pub struct Site<'a> {
    /// Corner of smallest x and y of the part to fill [m].
    pub from_m: Point,
    /// Corner of largest x and y [m].
    pub to_m: Point,
    /// Existing walls.
    pub walls: &'a [Wall],
    /// Existing boxes.
    pub boxes: &'a [Block],
    /// Where the robot starts.
    pub start_m: Point,
    /// The robot's size.
    pub robot: Size,
}

/// A goal and the true shortest path to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Journey {
    /// The goal, in the world's frame.
    pub goal_m: Point,
    /// Something blocks the straight line from the start to the goal, for a robot of this width.
    pub blocked: bool,
    /// The shortest path that leaves half the robot's width on either side; `None` if the goal cannot be reached.
    pub shortest: Option<Path>,
}

impl Journey {
    /// From the start of a site to a goal, among these obstacles.
    pub(crate) fn to(goal_m: Point, site: &Site<'_>, obstacles: &World) -> Self {
        let slim = Floor::grown(obstacles, site.robot.half_width_m);
        Self {
            goal_m,
            blocked: !slim.is_straight(site.start_m, goal_m),
            shortest: slim.shortest(site.start_m, goal_m),
        }
    }
}

/// The boxes of a seed, and its goal.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// The boxes added to the site.
    pub boxes: Vec<Block>,
    /// The goal.
    pub journey: Journey,
}

/// The kind of task that a seed draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    InsideABox,
    WalledIn,
    Blocked,
    Free,
}

impl RandomWorld {
    /// The world of a seed; `None` if nothing fits the site.
    #[must_use]
    pub fn draw(&self, site: &Site<'_>, seed: u64) -> Option<Drawn> {
        let mut dice = Dice::new(seed);
        let kind = self.kind(&mut dice);
        let fixed = World::new(site.walls, site.boxes).ok()?;
        (0..ATTEMPTS).find_map(|_| self.attempt(kind, site, &fixed, &mut dice))
    }

    fn kind(&self, dice: &mut Dice) -> Kind {
        if dice.chance(self.unreachable) {
            if dice.chance(0.5) {
                Kind::InsideABox
            } else {
                Kind::WalledIn
            }
        } else if dice.chance(self.blocked) {
            Kind::Blocked
        } else {
            Kind::Free
        }
    }

    /// One arrangement, if it is of the drawn kind.
    fn attempt(
        &self,
        kind: Kind,
        site: &Site<'_>,
        fixed: &World,
        dice: &mut Dice,
    ) -> Option<Drawn> {
        let goal_m = self.goal(site, dice)?;
        let goal_room_m = match kind {
            Kind::InsideABox | Kind::WalledIn => 0.0,
            Kind::Blocked | Kind::Free => site.robot.goal_room_m(),
        };
        let mut arrangement = Arrangement::new(site, fixed, goal_m, goal_room_m);
        let placed = match kind {
            Kind::InsideABox => arrangement.add(dice, |dice| {
                (layouts::around(dice, goal_m, layouts::solid), None)
            }),
            Kind::WalledIn => arrangement.add(dice, |dice| {
                (layouts::around(dice, goal_m, layouts::ring), None)
            }),
            Kind::Blocked => {
                arrangement.add(dice, |dice| layouts::across(dice, site.start_m, goal_m))
            }
            Kind::Free => true,
        };
        if !placed {
            return None;
        }
        let [fewest, most] = self.groups;
        let groups = dice.whole(fewest, most);
        while arrangement.groups() < groups && arrangement.add(dice, |dice| anywhere(dice, site)) {}
        let drawn = arrangement.boxes();
        let world = World::new(site.walls, &[site.boxes, &drawn].concat()).ok()?;
        let journey = survey(&world, site, goal_m)?;
        let wanted = match kind {
            Kind::InsideABox | Kind::WalledIn => journey.shortest.is_none(),
            Kind::Blocked => journey.shortest.is_some() && journey.blocked,
            Kind::Free => !journey.blocked,
        };
        wanted.then_some(Drawn {
            boxes: drawn,
            journey,
        })
    }

    /// A position within the site and the distances allowed.
    fn goal(&self, site: &Site<'_>, dice: &mut Dice) -> Option<Point> {
        let [nearest_m, farthest_m] = self.goal_away_m;
        let room_m = site.robot.goal_room_m();
        let inside = |goal: &Point| {
            (0..2).all(|axis| {
                (site.from_m[axis] + room_m..=site.to_m[axis] - room_m).contains(&goal[axis])
            })
        };
        let draw = |_| {
            let away_m = dice.within(nearest_m, farthest_m);
            let bearing_rad = dice.angle_rad();
            [
                site.start_m[0] + away_m * libm::cos(bearing_rad),
                site.start_m[1] + away_m * libm::sin(bearing_rad),
            ]
        };
        // A start in a corner leaves a quarter of the directions: a hundred draws find one.
        (0..100).map(draw).find(inside)
    }
}

/// A group anywhere in the site, some of them against a wall: the boxes, and the wall they stand against.
fn anywhere(dice: &mut Dice, site: &Site<'_>) -> (Vec<Block>, Option<usize>) {
    let group = layouts::group(dice);
    let (at, wall) = if !site.walls.is_empty() && dice.chance(0.2) {
        let index = dice.whole(0.0, site.walls.len() as f64 - 1.0);
        let Wall { from_m, to_m, .. } = site.walls[index];
        (
            layouts::between(from_m, to_m, dice.within(0.0, 1.0)),
            Some(index),
        )
    } else {
        let place = |axis: usize, part: f64| {
            site.from_m[axis] + part * (site.to_m[axis] - site.from_m[axis])
        };
        let (x, y) = (dice.within(0.0, 1.0), dice.within(0.0, 1.0));
        ([place(0, x), place(1, y)], None)
    };
    (layouts::placed(&group, at, dice.angle_rad()), wall)
}

/// The true shortest path from the start of a site to a goal; `None` where it is ambiguous: reachable only for a slim
/// robot.
fn survey(world: &World, site: &Site<'_>, goal_m: Point) -> Option<Journey> {
    let journey = Journey::to(goal_m, site, world);
    let easy = Floor::grown(world, site.robot.easy_m());
    if journey.shortest.is_some() && easy.shortest(site.start_m, goal_m).is_none() {
        return None;
    }
    Some(journey)
}

#[cfg(test)]
mod tests;
