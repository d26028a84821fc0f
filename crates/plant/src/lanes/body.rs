//! Bodies that move along the arcs of their wheels, in lanes: `Plant::move_body` and what spares its contacts.

use super::drivetrain::Motion;
use super::vector::{Bits, M, V, gather, splat};
use super::{LANES, Lane, math};
use crate::contact::{Impact, Pose, Step};
use crate::plant::State;
use core::f64::consts::{PI, TAU};
use fearless_simd::prelude::*;

/// The bodies of a group.
pub(super) struct Bodies<S: Simd> {
    x_m: V<S>,
    y_m: V<S>,
    heading_rad: V<S>,
    /// What the last step moved, and how long it took.
    moved_m: V<S>,
    turned_rad: V<S>,
    dt_s: f64,
    reach_m: V<S>,
    clearance_m: V<S>,
    /// Dry friction that blocked wheels feel.
    pub(super) resist_n_m: [V<S>; 2],
}

/// The lanes of touches that begin in a step, and the touches there.
#[derive(Default)]
pub(super) struct Impacts {
    pub(super) lanes: Bits,
    pub(super) each: [Option<Impact>; LANES],
}

impl<S: Simd> Bodies<S> {
    #[inline(always)]
    pub(super) fn gather(simd: S, group: &[Lane<'_>; LANES]) -> Self {
        let pose = |lane: usize| &group[lane].1.pose;
        let resist = |i: usize| {
            gather(simd, |lane| {
                let (plant, state) = &group[lane];
                plant.footprint.resistance_n_m(&state.contact)[i]
            })
        };
        Self {
            x_m: gather(simd, |lane| pose(lane).x_m),
            y_m: gather(simd, |lane| pose(lane).y_m),
            heading_rad: gather(simd, |lane| pose(lane).heading_rad),
            moved_m: splat(simd, 0.0),
            turned_rad: splat(simd, 0.0),
            dt_s: 1.0,
            reach_m: gather(simd, |lane| group[lane].0.footprint.reach_m),
            clearance_m: gather(simd, |lane| group[lane].1.contact.clearance_m),
            resist_n_m: [resist(0), resist(1)],
        }
    }

    #[inline(always)]
    pub(super) fn scatter(&self, lane: usize, state: &mut State) {
        state.pose = self.pose(lane);
        state.speed = [
            self.moved_m[lane] / self.dt_s,
            self.turned_rad[lane] / self.dt_s,
        ];
        state.contact.clearance_m = self.clearance_m[lane];
    }

    #[inline(always)]
    fn pose(&self, lane: usize) -> Pose {
        Pose {
            x_m: self.x_m[lane],
            y_m: self.y_m[lane],
            heading_rad: self.heading_rad[lane],
        }
    }

    /// `Plant::move_body` for all; a body near an obstacle goes by itself.
    #[inline(always)]
    pub(super) fn step(
        &mut self,
        simd: S,
        group: &mut [Lane<'_>; LANES],
        motion: &Motion<S>,
        dt_s: f64,
        impacts: &mut Impacts,
    ) {
        let zero = splat(simd, 0.0);
        let moves = motion.forward_m.simd_ne(zero) | motion.yaw_rad.simd_ne(zero);
        let before = [self.x_m, self.y_m, self.heading_rad];
        let (across, ahead) = math::sincos(simd, before[2] + motion.yaw_rad * 0.5);
        self.x_m += motion.forward_m * ahead;
        self.y_m += motion.forward_m * across;
        self.heading_rad += motion.yaw_rad;
        self.settle(simd, group, &before, moves, dt_s, impacts);

        let moved_m = (self.x_m - before[0]) * ahead + (self.y_m - before[1]) * across;
        self.moved_m = moves.select(moved_m, zero);
        self.turned_rad = moves.select(self.heading_rad - before[2], zero);
        self.dt_s = dt_s;
        let heading_rad = self.heading_rad;
        let (half, turn) = (splat(simd, PI), splat(simd, TAU));
        let wrapped = heading_rad.simd_gt(half).select(
            heading_rad - turn,
            heading_rad
                .simd_le(-half)
                .select(heading_rad + turn, heading_rad),
        );
        self.x_m = moves.select(self.x_m, before[0]);
        self.y_m = moves.select(self.y_m, before[1]);
        self.heading_rad = moves.select(wrapped, before[2]);
    }

    /// `Footprint::settle` for all that move.
    #[inline(always)]
    fn settle(
        &mut self,
        simd: S,
        group: &mut [Lane<'_>; LANES],
        before: &[V<S>; 3],
        moves: M<S>,
        dt_s: f64,
        impacts: &mut Impacts,
    ) {
        let way = (self.x_m - before[0]).abs() + (self.y_m - before[1]).abs();
        let turn_rad = (self.heading_rad - before[2]).abs();
        let left_m = self.clearance_m - (way + self.reach_m * turn_rad);
        self.clearance_m = moves.select(left_m, self.clearance_m);
        let clear = left_m.simd_gt(splat(simd, 0.0));
        impacts.lanes = Bits(0);
        for lane in Bits(Bits::of(moves).0 & !Bits::of(clear).0) {
            let (plant, state) = &mut group[lane];
            let before = Pose {
                x_m: before[0][lane],
                y_m: before[1][lane],
                heading_rad: before[2][lane],
            };
            let mut pose = self.pose(lane);
            let contact = &mut state.contact;
            // Nothing moves in the worlds of lanes: the time makes no difference.
            let step = Step {
                world: &plant.world,
                until_us: state.now_us,
                dt_s,
            };
            let impact = plant
                .footprint
                .settle_near(&step, contact, &before, &mut pose);
            self.x_m[lane] = pose.x_m;
            self.y_m[lane] = pose.y_m;
            self.heading_rad[lane] = pose.heading_rad;
            self.clearance_m[lane] = contact.clearance_m;
            let resist_n_m = plant.footprint.resistance_n_m(contact);
            self.resist_n_m[0][lane] = resist_n_m[0];
            self.resist_n_m[1][lane] = resist_n_m[1];
            impacts.lanes.0 |= u64::from(impact.is_some()) << lane;
            impacts.each[lane] = impact;
        }
    }
}
