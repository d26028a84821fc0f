//! From the bridge's pins to the motion of wheels and body.
//!
//! ```text
//! duty ─► mean current of one PWM period ─► torque ─► dry and viscous friction ─► wheel speeds ─► slip ─► body
//!                ▲ back-EMF, supply                        ▲ floor under each wheel
//! ```
//!
//! The PWM is on the L298N's *enable* pin: while it is low all four transistors are off, the current returns to the
//! supply through the diodes, and once it has died the motor coasts. The mean torque is therefore far from linear in
//! the duty; [`Drivetrain`] uses its closed form (docs/theory/plant.md). The two wheels are coupled through the mass
//! of the body. Dry friction is exact: it stops a wheel, holds it at a speed of exactly zero, and never reverses it.
//!
//! Wheel index 0 is the left wheel, 1 the right. All angles and speeds are the wheels', positive forward.

pub use bridge::{Bridge, Decay, Modulation};

use crate::battery::{self, Battery};
use crate::noise::{Noise, source};
use crate::params::{self, Params};
use bridge::{Command, RELEASED, Winding};
use coupling::{Coupling, turning_share};
use wander::Wander;

pub(crate) mod bridge;
pub(crate) mod coupling;
pub(crate) mod wander;

/// Left or right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Left wheel, motor B of the report.
    Left,
    /// Right wheel, motor A of the report.
    Right,
}

impl Side {
    /// Index of this side in arrays of both wheels.
    #[must_use]
    pub const fn index(self) -> usize {
        match self {
            Self::Left => 0,
            Self::Right => 1,
        }
    }
}

/// What one step moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Way of the point between the wheels, along the body's x axis, m.
    pub forward_m: f64,
    /// Turn, counter-clockwise positive, rad.
    pub yaw_rad: f64,
    /// Angle turned by each wheel, rad.
    pub wheel_rad: [f64; 2],
}

/// One wheel with its motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelState {
    /// Angle since the start, rad.
    pub angle_rad: f64,
    /// Speed, rad/s.
    pub speed_rad_s: f64,
    /// Mean current through the motor over a PWM period, positive for forward torque, A.
    pub current_a: f64,
    /// Low-passed speed on which the friction depends, rad/s, never negative: see [`params::Wheel::friction_memory_s`].
    pub remembered_rad_s: f64,
    /// How far the dry friction has grown since the wheel last stopped or broke loose, 0 to 1: see
    /// [`params::Wheel::onset_ratio`].
    pub grown: f64,
    /// Share of the rolled distance lost to slip at this place.
    pub slip: f64,
    pub(crate) command: Command,
    pub(crate) floor: Wander,
    pub(crate) slipping: Wander,
}

/// State of a [`Drivetrain`]: plain numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Left and right wheel.
    pub wheels: [WheelState; 2],
    /// Battery.
    pub battery: battery::State,
}

/// Parameters in the form the step needs.
#[derive(Clone, Copy, Debug)]
pub struct Drivetrain {
    pub(crate) battery: Battery,
    pub(crate) noise: Noise,
    pub(crate) winding: Winding,
    pub(crate) wheels: [WheelModel; 2],
    pub(crate) floor: params::Floor,
    on_floor: bool,
    pub(crate) coupling: Coupling,
    pub(crate) base_m: f64,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct WheelModel {
    pub(crate) params: params::Wheel,
    pub(crate) back_emf_v_s: f64,
    pub(crate) torque_n_m_a: f64,
    pub(crate) inverse_stribeck: f64,
    pub(crate) forgetting_per_s: f64,
    pub(crate) lacking_at_onset: f64,
    pub(crate) growth_per_rad: f64,
    pub(crate) growth_per_s: f64,
    pub(crate) floor_knots_per_rad: f64,
    pub(crate) slip_knots_per_rad: f64,
}

impl Drivetrain {
    /// A drivetrain on the floor, or with the wheels in the air.
    #[must_use]
    pub fn new(params: &Params, noise: Noise, on_floor: bool) -> Self {
        let motor = &params.motor;
        let wheel = |wheel: params::Wheel| WheelModel {
            params: wheel,
            back_emf_v_s: motor.back_emf_v_s * wheel.strength,
            torque_n_m_a: motor.back_emf_v_s * wheel.strength * motor.gear_efficiency,
            inverse_stribeck: 1.0 / wheel.stribeck_rad_s,
            forgetting_per_s: 1.0 / wheel.friction_memory_s,
            lacking_at_onset: 1.0 - wheel.onset_ratio,
            growth_per_rad: 1.0 / wheel.onset_rad,
            growth_per_s: 1.0 / wheel.onset_rest_s,
            floor_knots_per_rad: wheel.radius_m / params.floor.roughness_length_m,
            slip_knots_per_rad: wheel.radius_m / params.floor.slip_length_m,
        };
        Self {
            battery: Battery::new(&params.battery),
            noise,
            winding: Winding::new(params),
            wheels: [wheel(params.wheels.left), wheel(params.wheels.right)],
            floor: params.floor,
            on_floor,
            coupling: Coupling::new(params, on_floor),
            base_m: params.body.base_m,
        }
    }

    /// The same one put on the floor, or lifted off it.
    #[must_use]
    pub fn moved(&self, params: &Params, on_floor: bool) -> Self {
        Self::new(params, self.noise, on_floor)
    }

    /// At rest, bridges released, at a random angle of the motor shafts.
    #[must_use]
    pub fn start(&self) -> State {
        let wheel = |index: u32| WheelState {
            angle_rad: self.noise.uniform(source::DRIVETRAIN + index, 0),
            speed_rad_s: 0.0,
            current_a: 0.0,
            remembered_rad_s: 0.0,
            grown: 1.0,
            slip: 0.0,
            command: RELEASED,
            floor: Wander::start(&self.noise, source::DRIVETRAIN + 2 + index),
            slipping: Wander::start(&self.noise, source::DRIVETRAIN + 4 + index),
        };
        State {
            wheels: [wheel(0), wheel(1)],
            battery: self.battery.start(),
        }
    }

    /// Sets one half of the bridge; it holds until set again.
    pub fn set_bridge(&self, state: &mut State, side: Side, bridge: Bridge) {
        self.set_bridge_at(state, side, bridge, Modulation::default());
    }

    /// The same with another PWM than the parameters'.
    pub fn set_bridge_at(
        &self,
        state: &mut State,
        side: Side,
        bridge: Bridge,
        modulation: Modulation,
    ) {
        let command = &mut state.wheels[side.index()].command;
        *command = self.winding.command(bridge, modulation, *command);
    }

    /// Terminal voltage of the battery, V.
    #[must_use]
    pub fn battery_v(&self, state: &State) -> f64 {
        self.battery.terminal_v(&state.battery)
    }

    /// Advances by `dt_s` (at most 1 ms for the stated accuracy). `resist_n_m` is dry friction added to each wheel
    /// from outside, such as a wall the body leans on; a negative one is a floor easier than the parameters say.
    pub fn step(&self, state: &mut State, dt_s: f64, resist_n_m: [f64; 2]) -> Motion {
        let supply_v = self.battery.terminal_v(&state.battery);
        let old = [state.wheels[0].speed_rad_s, state.wheels[1].speed_rad_s];
        let (mut supply_a, mut torque_n_m) = (0.0, [0.0; 2]);
        for i in 0..2 {
            let (model, wheel) = (&self.wheels[i], &state.wheels[i]);
            let emf_v = model.back_emf_v_s * wheel.speed_rad_s;
            let (motor_a, drawn_a) = self.winding.current(&wheel.command, emf_v, supply_v);
            state.wheels[i].current_a = motor_a;
            supply_a += drawn_a;
            torque_n_m[i] = motor_a * model.torque_n_m_a - model.params.viscous_n_m_s * old[i];
        }
        self.battery.draw(&mut state.battery, supply_a, dt_s);
        self.damp_yaw(old, &mut torque_n_m);

        let turning = if old == [0.0; 2] {
            turning_share(torque_n_m)
        } else {
            turning_share(old)
        };
        let dry = |i: usize| {
            let dry = self.dry_n_m(i, &state.wheels[i], torque_n_m[i], turning) + resist_n_m[i];
            if dry > 0.0 { dry } else { 0.0 }
        };
        let new = self
            .coupling
            .speeds_after(old, torque_n_m, [dry(0), dry(1)], dt_s);

        let mut wheel_rad = [0.0; 2];
        for i in 0..2 {
            wheel_rad[i] = 0.5 * (old[i] + new[i]) * dt_s;
            self.roll(i, &mut state.wheels[i], new[i], wheel_rad[i], dt_s);
        }
        self.motion(state, wheel_rad)
    }

    /// Takes the moment that the floor sets against turning from the wheels, as a couple.
    fn damp_yaw(&self, speed_rad_s: [f64; 2], torque_n_m: &mut [f64; 2]) {
        if !self.on_floor || self.floor.yaw_damping_n_m_s == 0.0 {
            return;
        }
        let radius_m = self.wheels.map(|wheel| wheel.params.radius_m);
        let yaw_rad_s = (radius_m[1] * speed_rad_s[1] - radius_m[0] * speed_rad_s[0]) / self.base_m;
        let force_n = self.floor.yaw_damping_n_m_s * yaw_rad_s / self.base_m;
        torque_n_m[0] += radius_m[0] * force_n;
        torque_n_m[1] -= radius_m[1] * force_n;
    }

    /// Largest dry friction on a wheel, N m: its own in the direction it turns (or would), plus the floor's.
    /// [`params::Wheel::onset_ratio`] says how it grows; a standing tyre scrubs by that ratio however long it stood.
    fn dry_n_m(&self, i: usize, wheel: &WheelState, torque_n_m: f64, turning: f64) -> f64 {
        let model = &self.wheels[i];
        let towards = if wheel.speed_rad_s == 0.0 {
            torque_n_m
        } else {
            wheel.speed_rad_s
        };
        let own = if towards < 0.0 {
            model.params.coulomb_backward_n_m
        } else {
            model.params.coulomb_forward_n_m
        };
        let relative = wheel.remembered_rad_s * model.inverse_stribeck;
        let breakaway = 1.0 + (model.params.static_ratio - 1.0) / (1.0 + relative * relative);
        let onset = 1.0 - model.lacking_at_onset * (1.0 - wheel.grown);
        let scrub_onset = if wheel.speed_rad_s == 0.0 {
            1.0 - model.lacking_at_onset
        } else {
            onset
        };
        let rolling_n_m = self.floor.rolling_n_m * onset;
        let scrub_n_m = self.floor.scrub_n_m * turning * scrub_onset;
        (own * onset + self.floor_scale(wheel) * (rolling_n_m + scrub_n_m)) * breakaway
    }

    /// The floor's friction at this place relative to the parameters'; 0 with the wheels in the air.
    fn floor_scale(&self, wheel: &WheelState) -> f64 {
        if !self.on_floor {
            return 0.0;
        }
        let here = 1.0 + self.floor.roughness * wheel.floor.value();
        let here = if here > 0.0 { here } else { 0.0 };
        self.floor.friction_scale * here
    }

    /// Advances one wheel, with the floor and slip at its new position. Inline: a call costs 4 % of a step.
    #[inline(always)]
    pub(crate) fn roll(
        &self,
        i: usize,
        wheel: &mut WheelState,
        speed_rad_s: f64,
        rolled_rad: f64,
        dt_s: f64,
    ) {
        let model = &self.wheels[i];
        let (stood, stands) = (wheel.speed_rad_s == 0.0, speed_rad_s == 0.0);
        wheel.speed_rad_s = speed_rad_s;
        wheel.angle_rad += rolled_rad;
        let share = dt_s * model.forgetting_per_s;
        let share = if share < 1.0 { share } else { 1.0 };
        wheel.remembered_rad_s += share * (speed_rad_s.abs() - wheel.remembered_rad_s);
        let growth = if stands {
            dt_s * model.growth_per_s
        } else {
            rolled_rad.abs() * model.growth_per_rad
        };
        let growth = if growth < 1.0 { growth } else { 1.0 };
        let before = if stands == stood { wheel.grown } else { 0.0 };
        wheel.grown = before + growth * (1.0 - before);
        if self.on_floor && rolled_rad != 0.0 {
            let (way, index) = (rolled_rad.abs(), i as u32);
            wheel.floor.advance(
                way * model.floor_knots_per_rad,
                &self.noise,
                source::DRIVETRAIN + 2 + index,
            );
            wheel.slipping.advance(
                way * model.slip_knots_per_rad,
                &self.noise,
                source::DRIVETRAIN + 4 + index,
            );
            wheel.slip = self.floor.slip * wheel.slipping.value();
        }
    }

    /// The body's motion when the wheels turn by these angles (or at these speeds).
    fn motion(&self, state: &State, wheel_rad: [f64; 2]) -> Motion {
        let way =
            |i: usize| self.wheels[i].params.radius_m * wheel_rad[i] * (1.0 - state.wheels[i].slip);
        let (left_m, right_m) = if self.on_floor {
            (way(0), way(1))
        } else {
            (0.0, 0.0)
        };
        Motion {
            forward_m: 0.5 * (left_m + right_m),
            yaw_rad: (right_m - left_m) / self.base_m,
            wheel_rad,
        }
    }
}

#[cfg(test)]
mod tests;
