//! VFH+ (Ulrich and Borenstein 1998): a polar histogram of what is near, its openings, and the cheapest direction of
//! them. It knows the last direction only, so it may stay in a pocket for ever.

use super::disc::{Planner, RADIUS_M, RAYS, Seen, Step, ray_rad, wrapped};
use std::f64::consts::TAU;

/// Sectors of the histogram.
const SECTORS: usize = 72;
/// What is farther away does not count [m].
const WINDOW_M: f64 = 1.0;
/// What is kept clear beside the disc [m].
const KEEP_M: f64 = 0.04;
/// An opening of more sectors is wide: it is entered so many from its edges.
const WIDE: usize = 16;
/// Weights of the angles to the goal, to the heading and to the direction before.
const WEIGHTS: [f64; 3] = [5.0, 2.0, 2.0];

#[derive(Default)]
pub(super) struct Histogram {
    last_rad: Option<f64>,
}

fn sector_rad(sector: usize) -> f64 {
    TAU * (sector as f64 + 0.5) / SECTORS as f64
}

/// Sectors that lead into something.
fn blocked(seen: &Seen, window_m: f64) -> [bool; SECTORS] {
    let mut blocked = [false; SECTORS];
    for ray in (0..RAYS).filter(|&ray| seen.ranges_m[ray] < window_m) {
        let half_rad = ((RADIUS_M + KEEP_M) / seen.ranges_m[ray]).min(1.0).asin();
        for (sector, blocked) in blocked.iter_mut().enumerate() {
            *blocked |= wrapped(sector_rad(sector) - ray_rad(ray)).abs() < half_rad;
        }
    }
    blocked
}

/// Directions to choose from: the middles of narrow openings, the edges of wide ones, and the goal's within one [rad].
fn candidates(blocked: &[bool; SECTORS], goal_rad: f64) -> Vec<f64> {
    let Some(edge) = blocked.iter().position(|&blocked| blocked) else {
        return vec![goal_rad];
    };
    let mut candidates = Vec::new();
    let mut open = 0;
    for step in 1..=SECTORS {
        let sector = (edge + step) % SECTORS;
        if !blocked[sector] {
            open += 1;
            continue;
        }
        // The opening ends before this sector.
        let back = |count: usize| sector_rad((sector + SECTORS - count) % SECTORS);
        if open > WIDE {
            candidates.extend([back(WIDE / 2), back(open + 1 - WIDE / 2)]);
        } else if open > 0 {
            candidates.push(back(open.div_ceil(2)));
        }
        open = 0;
    }
    let sector = (goal_rad.rem_euclid(TAU) / TAU * SECTORS as f64) as usize % SECTORS;
    if !blocked[sector] {
        candidates.push(goal_rad);
    }
    candidates
}

impl Planner for Histogram {
    fn step(&mut self, seen: &Seen) -> Step {
        let goal_rad = seen.bearing_rad(seen.goal);
        let blocked = blocked(seen, WINDOW_M.min(seen.distance_m(seen.goal) + RADIUS_M));
        let last_rad = self.last_rad.unwrap_or(seen.heading_rad);
        let cost = |towards_rad: f64| {
            let to = [goal_rad, seen.heading_rad, last_rad];
            let costs = WEIGHTS.iter().zip(to);
            costs
                .map(|(weight, to_rad)| weight * wrapped(towards_rad - to_rad).abs())
                .sum::<f64>()
        };
        let best = candidates(&blocked, goal_rad)
            .into_iter()
            .min_by(|one, other| cost(*one).total_cmp(&cost(*other)));
        // Closed in: away from what is nearest.
        let towards_rad = best.unwrap_or_else(|| ray_rad(seen.nearest().0) + 0.5 * TAU);
        self.last_rad = Some(towards_rad);
        Step::Towards(towards_rad)
    }
}
