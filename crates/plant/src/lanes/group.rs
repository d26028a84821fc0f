//! A group through time: its steps, and the events of its robots.

use super::body::{Bodies, Impacts};
use super::drivetrain::Drivetrains;
use super::vector::{Bits, V, gather, splat};
use super::{LANES, Lane};
use crate::drivetrain::Side;
use crate::event::{Event, Queue};
use crate::plant::{Plant, STEP_US, State};
use fearless_simd::prelude::*;

/// The sensors of a wheel of each robot: the boundaries on both sides of them, and the first that a step passes.
struct Discs<S: Simd> {
    side: Side,
    below_rad: V<S>,
    above_rad: V<S>,
    /// Where they were before the step, and after it.
    turn_rad: [V<S>; 2],
    /// When the first edge is, from the step's start [us].
    first_us: V<S>,
    up: Bits,
    passed: Bits,
}

impl<S: Simd> Discs<S> {
    #[inline(always)]
    fn gather(simd: S, group: &[Lane<'_>; LANES], side: Side) -> Self {
        let state = |lane: usize| &group[lane].1.encoders[side.index()];
        let zero = splat(simd, 0.0);
        Self {
            side,
            below_rad: gather(simd, |lane| state(lane).below_rad),
            above_rad: gather(simd, |lane| state(lane).above_rad),
            turn_rad: [zero; 2],
            first_us: zero,
            up: Bits(0),
            passed: Bits(0),
        }
    }

    /// Turns the wheels: `Encoder::turn` up to the first edge.
    #[inline(always)]
    fn turn(&mut self, simd: S, from_rad: V<S>, to_rad: V<S>, step_us: f64) {
        let up = to_rad.simd_ge(self.above_rad);
        let down = to_rad.simd_lt(self.below_rad);
        let boundary_rad = up.select(self.above_rad, self.below_rad);
        let fraction = (boundary_rad - from_rad) / (to_rad - from_rad);
        let into_us = (fraction * step_us).ceil();
        let (least, most) = (splat(simd, 1.0), splat(simd, step_us));
        let into_us = into_us.simd_lt(least).select(least, into_us);
        self.first_us = into_us.simd_gt(most).select(most, into_us);
        self.turn_rad = [from_rad, to_rad];
        self.up = Bits::of(up);
        self.passed = Bits::of(up | down);
    }

    /// Passes the first edge of one robot.
    #[inline(always)]
    fn pass(&mut self, lane: usize, plant: &Plant, state: &mut State) -> Event {
        let i = self.side.index();
        let sensor = &mut state.encoders[i];
        let level = plant.encoders[i].pass(sensor, self.up.has(lane));
        self.below_rad[lane] = sensor.below_rad;
        self.above_rad[lane] = sensor.above_rad;
        Event::Edge {
            wheel: self.side,
            at_us: state.now_us + self.first_us[lane] as u64,
            level,
        }
    }

    /// There are more edges in the step.
    #[inline(always)]
    fn is_passed_again(&self, lane: usize) -> bool {
        let to_rad = self.turn_rad[1][lane];
        to_rad >= self.above_rad[lane] || to_rad < self.below_rad[lane]
    }

    /// Passes the other edges of one robot, if there are some.
    #[inline(always)]
    fn pass_others(
        &mut self,
        lane: usize,
        plant: &Plant,
        state: &mut State,
        step_us: f64,
        queue: &mut Queue,
        events: &mut impl FnMut(Event),
    ) {
        if self.is_passed_again(lane) {
            let turn_rad = [self.turn_rad[0][lane], self.turn_rad[1][lane]];
            plant.pass_edges(state, self.side, turn_rad, step_us, queue, events);
            let sensor = &state.encoders[self.side.index()];
            self.below_rad[lane] = sensor.below_rad;
            self.above_rad[lane] = sensor.above_rad;
        }
    }
}

/// Whether the robots can go in lanes.
pub(super) fn are_alike(group: &[Lane<'_>; LANES]) -> bool {
    let phase_us = group[0].1.now_us % STEP_US;
    group.iter().all(|(plant, state)| {
        state.now_us % STEP_US == phase_us
            && !plant.wheels_in_air
            && plant.world.bodies().is_empty()
    })
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
    let mut start_us = [0; LANES];
    for (start_us, (_, state)) in start_us.iter_mut().zip(group.iter()) {
        *start_us = state.now_us;
    }
    let mut drivetrains = Drivetrains::gather(simd, group);
    let mut bodies = Bodies::gather(simd, group);
    let mut discs = [
        Discs::gather(simd, group, Side::Left),
        Discs::gather(simd, group, Side::Right),
    ];
    // Time to the next edge of an echo line [us].
    let mut due_us = gather(simd, |lane| due_us(group[lane].1, start_us[lane]));
    let mut turning = Bits(0);
    for (lane, (_, state)) in group.iter().enumerate() {
        turning.0 |= u64::from(state.servo.angle_rad != state.servo.target_rad) << lane;
    }
    let (mut queue, mut impacts) = (Queue::default(), Impacts::default());

    let mut passed_us = 0;
    while passed_us < for_us {
        let to_grid_us = STEP_US - (phase_us + passed_us) % STEP_US;
        let step_us = to_grid_us.min(for_us - passed_us);
        let dt_s = step_us as f64 * 1e-6;
        let before_rad = drivetrains.angles();
        let motion = drivetrains.step(simd, group, dt_s, &bodies.resist_n_m);
        let after_rad = drivetrains.angles();
        bodies.step(simd, group, &motion, dt_s, &mut impacts);
        passed_us += step_us;
        discs[0].turn(simd, before_rad[0], after_rad[0], step_us as f64);
        discs[1].turn(simd, before_rad[1], after_rad[1], step_us as f64);
        let echoes = Bits::of(due_us.simd_le(splat(simd, passed_us as f64)));

        for lane in turning {
            let (plant, state) = &mut group[lane];
            state.servo.step(&plant.servo, dt_s);
        }
        let [left, right] = [discs[0].passed.0, discs[1].passed.0];
        let others = impacts.lanes.0 | echoes.0;
        // Which of two wheels it is, and which edge comes first, is as chance has it: the less that branches by it, the
        // better.
        for lane in Bits((left ^ right) & !others) {
            let (plant, state) = &mut group[lane];
            let discs = &mut discs[(right >> lane & 1) as usize];
            state.now_us = start_us[lane] + (passed_us - step_us);
            let event = discs.pass(lane, plant, state);
            let events = &mut |event| events(lane, event);
            events(event);
            discs.pass_others(lane, plant, state, step_us as f64, &mut queue, events);
            queue.flush(events);
        }
        for lane in Bits(left & right | others) {
            let (plant, state) = &mut group[lane];
            let events = &mut |event| events(lane, event);
            state.now_us = start_us[lane] + (passed_us - step_us);
            for discs in &mut discs {
                if discs.passed.has(lane) {
                    queue.put(discs.pass(lane, plant, state), events);
                    discs.pass_others(lane, plant, state, step_us as f64, &mut queue, events);
                }
            }
            state.now_us = start_us[lane] + passed_us;
            touch(&impacts, lane, state, &mut queue, events);
            if echoes.has(lane) {
                Plant::pass_echoes(state, &mut queue, events);
                due_us[lane] = self::due_us(state, start_us[lane]);
            }
            queue.flush(events);
        }
    }
    if for_us > 0 {
        for (lane, (_, state)) in group.iter_mut().enumerate() {
            state.now_us = start_us[lane] + for_us;
            drivetrains.scatter(lane, &mut state.drivetrain);
            bodies.scatter(lane, state);
        }
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
    if impacts.lanes.has(lane)
        && let Some(impact) = impacts.each[lane]
    {
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
fn due_us(state: &State, start_us: u64) -> f64 {
    let due = state.sonars.iter().filter_map(|sonar| sonar.due_us());
    due.min()
        .map_or(f64::INFINITY, |due_us| (due_us - start_us) as f64)
}
