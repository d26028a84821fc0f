//! The two wheels coupled through the body, with dry friction that stops and holds but never reverses.

use crate::params::Params;

/// Inverse of the wheels' inertia matrix.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coupling {
    pub(crate) left: f64,
    pub(crate) shared: f64,
    pub(crate) right: f64,
}

impl Coupling {
    /// Inverse of the inertia the wheels feel: their own plus, on the floor, the body's mass and yaw inertia.
    pub(super) fn new(params: &Params, on_floor: bool) -> Self {
        let own = params.motor.inertia_kg_m2;
        let (left_m, right_m) = (params.wheels.left.radius_m, params.wheels.right.radius_m);
        let along = if on_floor {
            params.body.mass_kg / 4.0
        } else {
            0.0
        };
        let about = if on_floor {
            params.body.yaw_inertia_kg_m2 / (params.body.base_m * params.body.base_m)
        } else {
            0.0
        };
        let left = own + left_m * left_m * (along + about);
        let right = own + right_m * right_m * (along + about);
        let shared = left_m * right_m * (along - about);
        let determinant = left * right - shared * shared;
        Self {
            left: right / determinant,
            shared: -shared / determinant,
            right: left / determinant,
        }
    }

    /// Wheel speeds after `dt_s` under these torques and at most this much dry friction.
    /// Inline as `Winding::current` is.
    #[inline(always)]
    pub(crate) fn speeds_after(
        &self,
        old: [f64; 2],
        torque_n_m: [f64; 2],
        dry_n_m: [f64; 2],
        dt_s: f64,
    ) -> [f64; 2] {
        let Self {
            left: own_l,
            shared,
            right: own_r,
        } = *self;
        let driven =
            |i: usize, own: f64| old[i] + dt_s * (own * torque_n_m[i] + shared * torque_n_m[1 - i]);
        let free = [driven(0, own_l), driven(1, own_r)];
        let limit = [dt_s * dry_n_m[0], dt_s * dry_n_m[1]];
        if free == [0.0; 2] && limit[0] > 0.0 && limit[1] > 0.0 {
            return [0.0; 2];
        }
        let with = |p: [f64; 2]| {
            [
                free[0] + own_l * p[0] + shared * p[1],
                free[1] + shared * p[0] + own_r * p[1],
            ]
        };

        let sliding = with([-limit[0].copysign(free[0]), -limit[1].copysign(free[1])]);
        if sliding[0] * free[0] > 0.0 && sliding[1] * free[1] > 0.0 {
            return sliding;
        }
        // A wheel stops within the step: find the impulses of both, each within its limit, that leave a wheel at rest
        // or sliding against its friction (Gauss-Seidel; the coupling is weak, so that few rounds are exact enough).
        let mut p = [0.0; 2];
        for _ in 0..4 {
            p[0] = within(limit[0], -(free[0] + shared * p[1]) / own_l);
            p[1] = within(limit[1], -(free[1] + shared * p[0]) / own_r);
        }
        let holds = |i: usize| p[i].abs() < limit[i];
        match (holds(0), holds(1)) {
            (true, true) => [0.0; 2],
            (true, false) => [0.0, with([-(free[0] + shared * p[1]) / own_l, p[1]])[1]],
            (false, true) => [with([p[0], -(free[1] + shared * p[0]) / own_r])[0], 0.0],
            (false, false) => with(p),
        }
    }
}

/// 0 when both go alike, 1 when they go against each other or only one goes.
pub(super) fn turning_share([left, right]: [f64; 2]) -> f64 {
    let sum = left.abs() + right.abs();
    if sum > 0.0 {
        (right - left).abs() / sum
    } else {
        0.0
    }
}

fn within(limit: f64, value: f64) -> f64 {
    if value > limit {
        limit
    } else if value < -limit {
        -limit
    } else {
        value
    }
}
