//! Groups of boxes on a floor that do not obstruct each other.

use super::Site;
use super::dice::Dice;
use rumbo_plant::world::{Block, Obstacle, Point, World};

/// Places tried for a group.
const TRIES: u32 = 20;
/// How far a group against a wall may stand out on its other side [m].
const OUTSIDE_M: f64 = 0.3;

/// The groups placed so far.
pub(super) struct Arrangement<'a> {
    site: &'a Site<'a>,
    /// The obstacles of the site itself, walls first.
    fixed: &'a World,
    /// Circles that stay free: of the start, and of the goal.
    free: [(Point, f64); 2],
    groups: Vec<(Vec<Block>, World)>,
}

impl<'a> Arrangement<'a> {
    pub(super) fn new(
        site: &'a Site<'a>,
        fixed: &'a World,
        goal_m: Point,
        goal_room_m: f64,
    ) -> Self {
        let free = [
            (site.start_m, site.robot.start_room_m()),
            (goal_m, goal_room_m),
        ];
        Self {
            site,
            fixed,
            free,
            groups: Vec::new(),
        }
    }

    /// How many groups there are.
    pub(super) fn groups(&self) -> usize {
        self.groups.len()
    }

    /// All boxes.
    pub(super) fn boxes(self) -> Vec<Block> {
        self.groups
            .into_iter()
            .flat_map(|(boxes, _)| boxes)
            .collect()
    }

    /// Places a group, the first of some draws that fits; false if none does. A draw is boxes and the index of the wall
    /// that they stand against.
    pub(super) fn add(
        &mut self,
        dice: &mut Dice,
        draw: impl Fn(&mut Dice) -> (Vec<Block>, Option<usize>),
    ) -> bool {
        let fitting = (0..TRIES).find_map(|_| {
            let (boxes, wall) = draw(dice);
            let group = World::new(&[], &boxes).ok()?;
            self.fits(&group, wall).then_some((boxes, group))
        });
        let found = fitting.is_some();
        self.groups.extend(fitting);
        found
    }

    /// Whether a group leaves the circles free, and passages that are wide enough everywhere.
    fn fits(&self, group: &World, wall: Option<usize>) -> bool {
        let gap_m = self.site.robot.gap_m();
        let beside = |others: &[Obstacle], except: Option<usize>| {
            others.iter().enumerate().all(|(index, other)| {
                Some(index) == except
                    || group
                        .obstacles()
                        .iter()
                        .all(|own| apart_m(own, other) >= gap_m)
            })
        };
        group.obstacles().iter().all(|own| {
            self.free
                .iter()
                .all(|(center, radius_m)| own.distance_m(*center) >= *radius_m)
                && self.within(own, if wall.is_some() { OUTSIDE_M } else { 0.0 })
        }) && beside(self.fixed.obstacles(), wall)
            && self
                .groups
                .iter()
                .all(|(_, other)| beside(other.obstacles(), None))
    }

    fn within(&self, own: &Obstacle, outside_m: f64) -> bool {
        own.corners().all(|corner| {
            (0..2).all(|axis| {
                (self.site.from_m[axis] - outside_m..=self.site.to_m[axis] + outside_m)
                    .contains(&corner[axis])
            })
        })
    }
}

/// Distance between two outlines, 0 if they overlap.
pub(super) fn apart_m(one: &Obstacle, other: &Obstacle) -> f64 {
    if !separates(one, other) && !separates(other, one) {
        return 0.0;
    }
    let from = |one: &Obstacle, other: &Obstacle| {
        one.corners()
            .map(|corner| other.distance_m(corner))
            .fold(f64::INFINITY, f64::min)
    };
    from(one, other).min(from(other, one))
}

/// Whether a face of one has the other wholly outside.
fn separates(one: &Obstacle, other: &Obstacle) -> bool {
    one.faces
        .iter()
        .any(|face| other.corners().all(|corner| face.height_m(corner) > 0.0))
}
