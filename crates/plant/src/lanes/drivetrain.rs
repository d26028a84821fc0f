//! From the bridges to the motion of wheels and bodies, in lanes: [`crate::drivetrain`] line by line.

use super::vector::{Bits, M, V, gather, splat};
use super::wander::{self, Wanders};
use super::{LANES, Lane};
use crate::battery::{KNEE_FALL_V, KNEE_V, PLATEAU_V};
use fearless_simd::prelude::*;

/// What one step moved.
pub(super) struct Motion<S: Simd> {
    pub(super) forward_m: V<S>,
    pub(super) yaw_rad: V<S>,
}

/// A wheel of each robot: its parameters, its command, its state.
pub(super) struct Wheels<S: Simd> {
    side: usize,
    radius_m: V<S>,
    viscous_n_m_s: V<S>,
    coulomb_forward_n_m: V<S>,
    coulomb_backward_n_m: V<S>,
    sticking: V<S>,
    back_emf_v_s: V<S>,
    torque_n_m_a: V<S>,
    inverse_stribeck: V<S>,
    forgetting_per_s: V<S>,
    lacking_at_onset: V<S>,
    growth_per_rad: V<S>,
    growth_per_s: V<S>,
    floor_knots_per_rad: V<S>,
    slip_knots_per_rad: V<S>,
    /// Own and shared entry of the inverse inertia.
    own: V<S>,
    direction: V<S>,
    duty: V<S>,
    periods: V<S>,
    reached: V<S>,
    released: M<S>,
    braking: Bits,
    angle_rad: V<S>,
    speed_rad_s: V<S>,
    current_a: V<S>,
    remembered_rad_s: V<S>,
    grown: V<S>,
    slip: V<S>,
    floor: Wanders<S>,
    slipping: Wanders<S>,
}

impl<S: Simd> Wheels<S> {
    #[inline(always)]
    fn gather(simd: S, group: &[Lane<'_>; LANES], side: usize) -> Self {
        let model = |lane: usize| &group[lane].0.drivetrain.wheels[side];
        let state = |lane: usize| &group[lane].1.drivetrain.wheels[side];
        let coupling = |lane: usize| &group[lane].0.drivetrain.coupling;
        let direction = gather(simd, |lane| state(lane).command.direction);
        let mut braking = 0;
        for lane in 0..LANES {
            braking |= u64::from(state(lane).command.braking) << lane;
        }
        Self {
            side,
            radius_m: gather(simd, |lane| model(lane).params.radius_m),
            viscous_n_m_s: gather(simd, |lane| model(lane).params.viscous_n_m_s),
            coulomb_forward_n_m: gather(simd, |lane| model(lane).params.coulomb_forward_n_m),
            coulomb_backward_n_m: gather(simd, |lane| model(lane).params.coulomb_backward_n_m),
            sticking: gather(simd, |lane| model(lane).params.static_ratio) - 1.0,
            back_emf_v_s: gather(simd, |lane| model(lane).back_emf_v_s),
            torque_n_m_a: gather(simd, |lane| model(lane).torque_n_m_a),
            inverse_stribeck: gather(simd, |lane| model(lane).inverse_stribeck),
            forgetting_per_s: gather(simd, |lane| model(lane).forgetting_per_s),
            lacking_at_onset: gather(simd, |lane| model(lane).lacking_at_onset),
            growth_per_rad: gather(simd, |lane| model(lane).growth_per_rad),
            growth_per_s: gather(simd, |lane| model(lane).growth_per_s),
            floor_knots_per_rad: gather(simd, |lane| model(lane).floor_knots_per_rad),
            slip_knots_per_rad: gather(simd, |lane| model(lane).slip_knots_per_rad),
            own: gather(simd, |lane| match side {
                0 => coupling(lane).left,
                _ => coupling(lane).right,
            }),
            direction,
            duty: gather(simd, |lane| state(lane).command.duty),
            periods: gather(simd, |lane| state(lane).command.periods),
            reached: gather(simd, |lane| state(lane).command.reached),
            released: direction.simd_eq(splat(simd, 0.0)),
            braking: Bits(braking),
            angle_rad: gather(simd, |lane| state(lane).angle_rad),
            speed_rad_s: gather(simd, |lane| state(lane).speed_rad_s),
            current_a: gather(simd, |lane| state(lane).current_a),
            remembered_rad_s: gather(simd, |lane| state(lane).remembered_rad_s),
            grown: gather(simd, |lane| state(lane).grown),
            slip: gather(simd, |lane| state(lane).slip),
            floor: Wanders::gather(simd, 2 + side as u32, |lane| state(lane).floor),
            slipping: Wanders::gather(simd, 4 + side as u32, |lane| state(lane).slipping),
        }
    }

    #[inline(always)]
    fn scatter(&self, lane: usize, state: &mut crate::drivetrain::WheelState) {
        state.angle_rad = self.angle_rad[lane];
        state.speed_rad_s = self.speed_rad_s[lane];
        state.current_a = self.current_a[lane];
        state.remembered_rad_s = self.remembered_rad_s[lane];
        state.grown = self.grown[lane];
        state.slip = self.slip[lane];
        self.floor.scatter(lane, &mut state.floor);
        self.slipping.scatter(lane, &mut state.slipping);
    }
}

impl<S: Simd> Wheels<S> {
    /// `Drivetrain::roll`, but for passing knots and the slip; gives the angle turned.
    #[inline(always)]
    fn roll(&mut self, simd: S, speed_rad_s: V<S>, dt_s: f64) -> V<S> {
        let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
        let rolled_rad = (self.speed_rad_s + speed_rad_s) * 0.5 * dt_s;
        let (stood, stands) = (self.speed_rad_s.simd_eq(zero), speed_rad_s.simd_eq(zero));
        self.speed_rad_s = speed_rad_s;
        self.angle_rad += rolled_rad;
        let share = self.forgetting_per_s * dt_s;
        let share = share.simd_lt(one).select(share, one);
        self.remembered_rad_s += share * (speed_rad_s.abs() - self.remembered_rad_s);
        let way = rolled_rad.abs();
        let growth = stands.select(self.growth_per_s * dt_s, way * self.growth_per_rad);
        let growth = growth.simd_lt(one).select(growth, one);
        let before = (stands ^ stood).select(zero, self.grown);
        self.grown = before + growth * (one - before);
        self.floor.advance(way * self.floor_knots_per_rad);
        self.slipping.advance(way * self.slip_knots_per_rad);
        rolled_rad
    }

    /// The slip at the new place, and the way on the floor.
    #[inline(always)]
    fn way_m(&mut self, simd: S, slip: V<S>, rolled_rad: V<S>) -> V<S> {
        let rolled = rolled_rad.simd_ne(splat(simd, 0.0));
        self.slip = rolled.select(slip * self.slipping.value(), self.slip);
        self.radius_m * rolled_rad * (splat(simd, 1.0) - self.slip)
    }
}

/// The drivetrains of a group.
pub(super) struct Drivetrains<S: Simd> {
    wheels: [Wheels<S>; 2],
    drop_v: V<S>,
    two_diodes_v: V<S>,
    loop_ohm: V<S>,
    open_circuit_v: V<S>,
    current_a: V<S>,
    resistance_ohm: V<S>,
    electronics_a: V<S>,
    per_coulomb: V<S>,
    yaw_damping_n_m_s: V<S>,
    damped: M<S>,
    roughness: V<S>,
    friction_scale: V<S>,
    rolling_n_m: V<S>,
    scrub_n_m: V<S>,
    slip: V<S>,
    base_m: V<S>,
    shared: V<S>,
}

impl<S: Simd> Drivetrains<S> {
    #[inline(always)]
    pub(super) fn gather(simd: S, group: &[Lane<'_>; LANES]) -> Self {
        let model = |lane: usize| &group[lane].0.drivetrain;
        let battery = |lane: usize| &group[lane].1.drivetrain.battery;
        let yaw_damping_n_m_s = gather(simd, |lane| model(lane).floor.yaw_damping_n_m_s);
        Self {
            wheels: [
                Wheels::gather(simd, group, 0),
                Wheels::gather(simd, group, 1),
            ],
            drop_v: gather(simd, |lane| model(lane).winding.drop_v),
            two_diodes_v: gather(simd, |lane| 2.0 * model(lane).winding.diode_v),
            loop_ohm: gather(simd, |lane| model(lane).winding.loop_ohm),
            open_circuit_v: gather(simd, |lane| battery(lane).open_circuit_v),
            current_a: gather(simd, |lane| battery(lane).current_a),
            resistance_ohm: gather(simd, |lane| model(lane).battery.resistance_ohm),
            electronics_a: gather(simd, |lane| model(lane).battery.electronics_a),
            per_coulomb: gather(simd, |lane| model(lane).battery.per_coulomb),
            yaw_damping_n_m_s,
            damped: yaw_damping_n_m_s.simd_ne(splat(simd, 0.0)),
            roughness: gather(simd, |lane| model(lane).floor.roughness),
            friction_scale: gather(simd, |lane| model(lane).floor.friction_scale),
            rolling_n_m: gather(simd, |lane| model(lane).floor.rolling_n_m),
            scrub_n_m: gather(simd, |lane| model(lane).floor.scrub_n_m),
            slip: gather(simd, |lane| model(lane).floor.slip),
            base_m: gather(simd, |lane| model(lane).base_m),
            shared: gather(simd, |lane| model(lane).coupling.shared),
        }
    }

    #[inline(always)]
    pub(super) fn scatter(&self, lane: usize, state: &mut crate::drivetrain::State) {
        let [left, right] = &mut state.wheels;
        self.wheels[0].scatter(lane, left);
        self.wheels[1].scatter(lane, right);
        state.battery.open_circuit_v = self.open_circuit_v[lane];
        state.battery.current_a = self.current_a[lane];
    }

    /// Angles of the wheels, left and right.
    #[inline(always)]
    pub(super) fn angles(&self) -> [V<S>; 2] {
        [self.wheels[0].angle_rad, self.wheels[1].angle_rad]
    }

    /// `Drivetrain::step` for all.
    #[inline(always)]
    pub(super) fn step(
        &mut self,
        simd: S,
        group: &[Lane<'_>; LANES],
        dt_s: f64,
        resist_n_m: &[V<S>; 2],
    ) -> Motion<S> {
        let zero = splat(simd, 0.0);
        let old = [self.wheels[0].speed_rad_s, self.wheels[1].speed_rad_s];
        let supply_v = positive(
            simd,
            self.open_circuit_v - self.resistance_ohm * self.current_a,
        );
        let (left_a, left_n_m) = self.drive(simd, group, 0, supply_v);
        let (right_a, right_n_m) = self.drive(simd, group, 1, supply_v);
        self.draw(simd, (zero + left_a) + right_a, dt_s);
        let torque_n_m = self.damp_yaw(old, [left_n_m, right_n_m]);

        let still = old[0].simd_eq(zero) & old[1].simd_eq(zero);
        let turning = turning_share(
            simd,
            still.select(torque_n_m[0], old[0]),
            still.select(torque_n_m[1], old[1]),
        );
        let dry_n_m = [
            self.dry_n_m(simd, 0, torque_n_m[0], turning, resist_n_m[0]),
            self.dry_n_m(simd, 1, torque_n_m[1], turning, resist_n_m[1]),
        ];
        let new = self.speeds_after(simd, group, old, torque_n_m, dry_n_m, dt_s);

        let [left, right] = &mut self.wheels;
        let rolled = [
            left.roll(simd, new[0], dt_s),
            right.roll(simd, new[1], dt_s),
        ];
        wander::pass(simd, group, &mut left.floor, &mut right.floor);
        wander::pass(simd, group, &mut left.slipping, &mut right.slipping);
        let left_m = left.way_m(simd, self.slip, rolled[0]);
        let right_m = right.way_m(simd, self.slip, rolled[1]);
        Motion {
            forward_m: (left_m + right_m) * 0.5,
            yaw_rad: (right_m - left_m) / self.base_m,
        }
    }

    /// Current drawn by one wheel's motor, and the torque at its wheel.
    #[inline(always)]
    fn drive(
        &mut self,
        simd: S,
        group: &[Lane<'_>; LANES],
        i: usize,
        supply_v: V<S>,
    ) -> (V<S>, V<S>) {
        let zero = splat(simd, 0.0);
        let wheels = &self.wheels[i];
        let emf_v = wheels.back_emf_v_s * wheels.speed_rad_s;
        let against_v = wheels.direction * emf_v;
        let on_a = (supply_v - self.drop_v - against_v) / self.loop_ohm;
        let off_a = (supply_v + self.two_diodes_v + against_v) / self.loop_ohm;
        let least_a = on_a * 0.05;
        let off_a = off_a.simd_gt(least_a).select(off_a, least_a);
        let peak_a = on_a * wheels.reached;
        let fall = wheels.periods * ln_1p(simd, peak_a / off_a);
        let off = splat(simd, 1.0) - wheels.duty;
        let dies = fall.simd_lt(off);
        let mean_a = on_a * wheels.duty - off_a * dies.select(fall, off);
        let drawn_a = dies.select(
            mean_a + (off_a * fall - wheels.periods * peak_a) * 2.0,
            mean_a * (wheels.duty - off),
        );
        let nothing = wheels.released | on_a.simd_le(zero);
        let mut motor_a = nothing.select(zero, wheels.direction * mean_a);
        let drawn_a = nothing.select(zero, drawn_a);
        for lane in wheels.braking {
            let (plant, state) = &group[lane];
            let command = &state.drivetrain.wheels[wheels.side].command;
            let winding = &plant.drivetrain.winding;
            motor_a[lane] = winding.current(command, emf_v[lane], supply_v[lane]).0;
        }
        let torque_n_m = motor_a * wheels.torque_n_m_a - wheels.viscous_n_m_s * wheels.speed_rad_s;
        self.wheels[i].current_a = motor_a;
        (drawn_a, torque_n_m)
    }

    /// `Battery::draw`.
    #[inline(always)]
    fn draw(&mut self, simd: S, motors_a: V<S>, dt_s: f64) {
        self.current_a = motors_a + self.electronics_a;
        let full = self.open_circuit_v.simd_gt(splat(simd, KNEE_V));
        let fall_v = full.select(splat(simd, PLATEAU_V), splat(simd, KNEE_FALL_V));
        let left_v = self.open_circuit_v - self.current_a * dt_s * self.per_coulomb * fall_v;
        let zero = splat(simd, 0.0);
        self.open_circuit_v = left_v.simd_lt(zero).select(zero, left_v);
    }

    #[inline(always)]
    fn damp_yaw(&self, speed_rad_s: [V<S>; 2], torque_n_m: [V<S>; 2]) -> [V<S>; 2] {
        let radius_m = [self.wheels[0].radius_m, self.wheels[1].radius_m];
        let yaw_rad_s = (radius_m[1] * speed_rad_s[1] - radius_m[0] * speed_rad_s[0]) / self.base_m;
        let force_n = self.yaw_damping_n_m_s * yaw_rad_s / self.base_m;
        let left_n_m = torque_n_m[0] + radius_m[0] * force_n;
        let right_n_m = torque_n_m[1] - radius_m[1] * force_n;
        [
            self.damped.select(left_n_m, torque_n_m[0]),
            self.damped.select(right_n_m, torque_n_m[1]),
        ]
    }

    #[inline(always)]
    fn dry_n_m(
        &self,
        simd: S,
        i: usize,
        torque_n_m: V<S>,
        turning: V<S>,
        resist_n_m: V<S>,
    ) -> V<S> {
        let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
        let wheels = &self.wheels[i];
        let speed_rad_s = wheels.speed_rad_s;
        let stands = speed_rad_s.simd_eq(zero);
        let towards = stands.select(torque_n_m, speed_rad_s);
        let own = towards
            .simd_lt(zero)
            .select(wheels.coulomb_backward_n_m, wheels.coulomb_forward_n_m);
        let relative = wheels.remembered_rad_s * wheels.inverse_stribeck;
        let breakaway = one + wheels.sticking / (one + relative * relative);
        let here = one + self.roughness * wheels.floor.value();
        let here = positive(simd, here);
        let floor_scale = self.friction_scale * here;
        let onset = one - wheels.lacking_at_onset * (one - wheels.grown);
        let scrub_onset = stands.select(one - wheels.lacking_at_onset, onset);
        let rolling_n_m = self.rolling_n_m * onset;
        let scrub_n_m = self.scrub_n_m * turning * scrub_onset;
        let dry_n_m = (own * onset + floor_scale * (rolling_n_m + scrub_n_m)) * breakaway;
        positive(simd, dry_n_m + resist_n_m)
    }

    /// `Coupling::speeds_after`; wheels that stop or stand go robot by robot.
    #[inline(always)]
    fn speeds_after(
        &self,
        simd: S,
        group: &[Lane<'_>; LANES],
        old: [V<S>; 2],
        torque_n_m: [V<S>; 2],
        dry_n_m: [V<S>; 2],
        dt_s: f64,
    ) -> [V<S>; 2] {
        let zero = splat(simd, 0.0);
        let (own_l, shared, own_r) = (self.wheels[0].own, self.shared, self.wheels[1].own);
        let [torque_l, torque_r] = torque_n_m;
        let free = [
            old[0] + (own_l * torque_l + shared * torque_r) * dt_s,
            old[1] + (own_r * torque_r + shared * torque_l) * dt_s,
        ];
        let limit = [dry_n_m[0] * dt_s, dry_n_m[1] * dt_s];
        let p = [-limit[0].copysign(free[0]), -limit[1].copysign(free[1])];
        let mut new = [
            free[0] + own_l * p[0] + shared * p[1],
            free[1] + shared * p[0] + own_r * p[1],
        ];
        let sliding = (new[0] * free[0]).simd_gt(zero) & (new[1] * free[1]).simd_gt(zero);
        let resting = (free[0].simd_eq(zero) & limit[0].simd_gt(zero))
            & (free[1].simd_eq(zero) & limit[1].simd_gt(zero));
        new = [resting.select(zero, new[0]), resting.select(zero, new[1])];
        for lane in Bits(0xff & !Bits::of(sliding | resting).0) {
            let at = |both: [V<S>; 2]| [both[0][lane], both[1][lane]];
            let coupling = &group[lane].0.drivetrain.coupling;
            [new[0][lane], new[1][lane]] =
                coupling.speeds_after(at(old), at(torque_n_m), at(dry_n_m), dt_s);
        }
        new
    }
}

/// The value, or 0 where it is negative.
#[inline(always)]
fn positive<S: Simd>(simd: S, value: V<S>) -> V<S> {
    let zero = splat(simd, 0.0);
    value.simd_gt(zero).select(value, zero)
}

#[inline(always)]
fn turning_share<S: Simd>(simd: S, left: V<S>, right: V<S>) -> V<S> {
    let zero = splat(simd, 0.0);
    let sum = left.abs() + right.abs();
    let share = (right - left).abs() / sum;
    sum.simd_gt(zero).select(share, zero)
}

#[inline(always)]
fn ln_1p<S: Simd>(simd: S, x: V<S>) -> V<S> {
    let sixty = splat(simd, 60.0);
    x * (sixty + x * (sixty + x * 11.0)) / (sixty + x * (x * (x * 3.0 + 36.0) + 90.0))
}
