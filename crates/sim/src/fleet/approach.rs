//! How near robots have come to each other: the least distance of each pair, at the ends of all steps.
//!
//! An exact distance is not needed while both have gone less far, since the last one, than the pair was farther apart then
//! than ever before. Nor where the circles around them are farther apart than that.

use rumbo_plant::contact::Pose;
use rumbo_plant::moving::{Body, way_m};
use rumbo_plant::world::Obstacle;

/// More than what rounding does to a distance.
const ROUNDING_M: f64 = 1e-9;

/// The robots, and what is known of each pair.
#[derive(Clone, Debug)]
pub(super) struct Approaches {
    spots: Vec<Spot>,
    /// The second before the first of each in the list: by [`index`].
    pairs: Vec<Pair>,
}

/// A robot as it stood at the last look.
#[derive(Clone, Debug)]
struct Spot {
    pose: Pose,
    /// How far at most a point of it had gone since the look before.
    way_m: f64,
    outline: Obstacle,
    /// The outline is that of the pose.
    drawn: bool,
}

#[derive(Clone, Copy, Debug)]
struct Pair {
    closest_m: f64,
    /// Way that both together may go until a distance can be less than that.
    free_m: f64,
}

impl Approaches {
    pub(super) fn new(bodies: &[Body], poses: impl Iterator<Item = Pose>) -> Self {
        let spots = poses.map(|pose| Spot {
            pose,
            way_m: 0.0,
            outline: Obstacle::default(),
            drawn: false,
        });
        let spots: Vec<Spot> = spots.collect();
        let pair = Pair {
            closest_m: f64::INFINITY,
            free_m: 0.0,
        };
        let pairs = vec![pair; index(0, spots.len())];
        let mut approaches = Self { spots, pairs };
        approaches.look(bodies);
        approaches
    }

    /// Looks at the robots where they are now.
    pub(super) fn measure(&mut self, bodies: &[Body], poses: impl Iterator<Item = Pose>) {
        for ((spot, body), pose) in self.spots.iter_mut().zip(bodies).zip(poses) {
            spot.way_m = way_m(&spot.pose, &pose, body.radius_m());
            spot.drawn &= spot.way_m == 0.0;
            spot.pose = pose;
        }
        self.look(bodies);
    }

    fn look(&mut self, bodies: &[Body]) {
        for second in 1..self.spots.len() {
            let (before, from_second) = self.spots.split_at_mut(second);
            let other = &mut from_second[0];
            for (first, one) in before.iter_mut().enumerate() {
                let pair = &mut self.pairs[index(first, second)];
                pair.free_m -= one.way_m + other.way_m;
                if pair.free_m <= 0.0 {
                    pair.look((one, &bodies[first]), (other, &bodies[second]));
                }
            }
        }
    }

    /// The least distance that two robots have had [m]; infinite for one that is none.
    pub(super) fn closest_m(&self, one: usize, other: usize) -> f64 {
        let index = index(one.min(other), one.max(other));
        let known = (one != other).then(|| self.pairs.get(index)).flatten();
        known.map_or(f64::INFINITY, |pair| pair.closest_m)
    }
}

impl Pair {
    fn look(&mut self, one: (&mut Spot, &Body), other: (&mut Spot, &Body)) {
        let (from, to) = (&one.0.pose, &other.0.pose);
        let middles_m = (from.x_m - to.x_m).hypot(from.y_m - to.y_m);
        let mut apart_m = middles_m - one.1.radius_m() - other.1.radius_m();
        if apart_m < self.closest_m + ROUNDING_M {
            apart_m = one.0.draw(one.1).apart_m(other.0.draw(other.1));
            self.closest_m = self.closest_m.min(apart_m);
        }
        self.free_m = apart_m - self.closest_m - ROUNDING_M;
    }
}

impl Spot {
    fn draw(&mut self, body: &Body) -> &Obstacle {
        if !self.drawn {
            body.outline_again(&self.pose, &mut self.outline);
            self.drawn = true;
        }
        &self.outline
    }
}

/// Index of a pair, the first before the second.
fn index(first: usize, second: usize) -> usize {
    second * second.saturating_sub(1) / 2 + first
}
