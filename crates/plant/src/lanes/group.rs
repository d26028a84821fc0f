//! A group through time: its steps, and the events of its robots.

use super::body::{Bodies, Impacts};
use super::drivetrain::Drivetrains;
use super::vector::{Bits, V, gather, splat};
use super::{LANES, Lane};
use crate::drivetrain::Side;
use crate::event::{Event, Queue};
use crate::plant::{Plant, STEP_US, State};
use fearless_simd::prelude::*;

/// Where the wheels' sensors are on their discs.
struct Discs<S: Simd> {
    below_rad: [V<S>; 2],
    above_rad: [V<S>; 2],
}

/// Passes `for_us` for each robot, all at the same place within a millisecond.
#[inline(always)]
pub(super) fn advance<S: Simd>(
    simd: S,
    group: &mut [Lane<'_>; LANES],
    for_us: u64,
    events: &mut impl FnMut(usize, Event),
) {
    let phase_us = group[0].1.now_us % STEP_US;
    let mut drivetrains = Drivetrains::gather(simd, group);
    let mut bodies = Bodies::gather(simd, group);
    let disc = |i: usize| {
        (
            gather(simd, |lane| group[lane].1.encoders[i].below_rad),
            gather(simd, |lane| group[lane].1.encoders[i].above_rad),
        )
    };
    let ((below_left, above_left), (below_right, above_right)) = (disc(0), disc(1));
    let mut discs = Discs {
        below_rad: [below_left, below_right],
        above_rad: [above_left, above_right],
    };
    // Time to the next edge of an echo line [us].
    let mut due_us = gather(simd, |lane| due_us(group[lane].1, 0));
    let mut turning = Bits(0);
    for (lane, (_, state)) in group.iter().enumerate() {
        turning.0 |= u64::from(state.servo.angle_rad != state.servo.target_rad) << lane;
    }
    let mut queue = Queue::default();

    let mut passed_us = 0;
    while passed_us < for_us {
        let to_grid_us = STEP_US - (phase_us + passed_us) % STEP_US;
        let step_us = to_grid_us.min(for_us - passed_us);
        let dt_s = step_us as f64 * 1e-6;
        let before_rad = drivetrains.angles();
        let motion = drivetrains.step(simd, group, dt_s, &bodies.resist_n_m);
        let after_rad = drivetrains.angles();
        let impacts = bodies.step(simd, group, &motion, dt_s);
        passed_us += step_us;
        let edges = [0, 1].map(|i: usize| {
            let up = after_rad[i].simd_ge(discs.above_rad[i]);
            Bits::of(up | after_rad[i].simd_lt(discs.below_rad[i]))
        });
        let echoes = Bits::of(due_us.simd_le(splat(simd, passed_us as f64)));

        for lane in turning {
            let (plant, state) = &mut group[lane];
            state.servo.step(&plant.servo, dt_s);
        }
        for lane in Bits(edges[0].0 | edges[1].0 | impacts.lanes.0 | echoes.0) {
            let (plant, state) = &mut group[lane];
            let events = &mut |event| events(lane, event);
            for side in [Side::Left, Side::Right] {
                let i = side.index();
                if edges[i].has(lane) {
                    let turn_rad = [before_rad[i][lane], after_rad[i][lane]];
                    let step_us = step_us as f64;
                    plant.pass_edges(state, side, turn_rad, step_us, &mut queue, events);
                    discs.below_rad[i][lane] = state.encoders[i].below_rad;
                    discs.above_rad[i][lane] = state.encoders[i].above_rad;
                }
            }
            state.now_us += step_us;
            touch(&impacts, lane, state, &mut queue, events);
            if echoes.has(lane) {
                Plant::pass_echoes(state, &mut queue, events);
                due_us[lane] = self::due_us(state, passed_us);
            }
            state.now_us -= step_us;
            queue.flush(events);
        }
        for (_, state) in group.iter_mut() {
            state.now_us += step_us;
        }
    }
    for (lane, (_, state)) in group.iter_mut().enumerate() {
        drivetrains.scatter(lane, &mut state.drivetrain);
        bodies.scatter(lane, state);
    }
}

#[inline(always)]
fn touch(
    impacts: &Impacts,
    lane: usize,
    state: &State,
    queue: &mut Queue,
    events: &mut impl FnMut(Event),
) {
    if let Some(impact) = impacts.each[lane] {
        let event = Event::Contact {
            at_us: state.now_us,
            obstacle: impact.obstacle,
            speed_m_s: impact.speed_m_s,
        };
        queue.put(event, events);
    }
}

/// Time from the group's start to the next edge of a robot's echo lines [us]; infinite without one.
#[inline(always)]
fn due_us(state: &State, passed_us: u64) -> f64 {
    let start_us = state.now_us - passed_us;
    let due = state.sonars.iter().filter_map(|sonar| sonar.due_us());
    due.min()
        .map_or(f64::INFINITY, |due_us| (due_us - start_us) as f64)
}
