//! Half an H bridge with a modulated motor, and the mean current it sends through it.
//!
//! While the bridge drives, the current rises towards `on_a` with the electrical time constant; in between it falls
//! towards `-off_a` and stops at zero. Over a period the winding's flux comes back to where it was, so the mean current is
//! the mean voltage over the resistance, the voltage counted only while current flows: `on_a x on-time - off_a x
//! fall-time` (derivation: docs/theory/plant.md). What it falls by is the [`Decay`].

use crate::params::Params;

/// The drive state set by the pins of one half of the L298N. Duties are 0 to 1; outside they are clipped, NaN counts as
/// 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bridge {
    /// Enable low, or both inputs low with the enable low: the motor coasts.
    Released,
    /// Forward with this duty on the enable pin.
    Forward(f64),
    /// Backward with this duty on the enable pin.
    Backward(f64),
    /// Both inputs alike and this duty on the enable pin: the motor is shorted while it is high.
    Brake(f64),
}

impl Bridge {
    /// Driven by a duty of -1 to 1: backward below 0, released at 0.
    #[must_use]
    pub fn driven(duty: f64) -> Bridge {
        if duty > 0.0 {
            Bridge::Forward(duty)
        } else if duty < 0.0 {
            Bridge::Backward(-duty)
        } else {
            Bridge::Released
        }
    }
}

/// How the current of a motor falls between the pulses of its PWM.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Decay {
    /// All transistors are off: through the diodes, against the supply, then the motor coasts. PWM on an L298N's enable.
    #[default]
    Fast,
    /// The motor is shorted: slowly, then it brakes. PWM on a direction input under a constant enable.
    Slow,
}

/// How the bridge is modulated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Modulation {
    /// Frequency of the PWM \[Hz\]; that of the parameters where there is none.
    pub hz: Option<f64>,
    /// What happens between the pulses.
    pub decay: Decay,
}

/// Voltages and time constants of bridge and winding.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Winding {
    pub(crate) drop_v: f64,
    pub(crate) diode_v: f64,
    brake_v: f64,
    pub(crate) loop_ohm: f64,
    /// Electrical time constant.
    time_constant_s: f64,
    /// The default frequency of the PWM.
    pwm_hz: f64,
}

/// A bridge setting with the exponential its mean current needs, computed once per setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Command {
    /// +1 forward, -1 backward, 0 released or braking.
    pub(crate) direction: f64,
    pub(crate) braking: bool,
    pub(crate) decay: Decay,
    pub(crate) duty: f64,
    /// Electrical time constant in PWM periods.
    pub(crate) periods: f64,
    /// 1 - exp(-on-time / time constant): share of the final current reached at the end of the on-time.
    pub(crate) reached: f64,
}

pub(super) const RELEASED: Command = Command {
    direction: 0.0,
    braking: false,
    decay: Decay::Fast,
    duty: 0.0,
    periods: 0.0,
    reached: 0.0,
};

impl Winding {
    pub(super) fn new(params: &Params) -> Self {
        let loop_ohm = params.motor.resistance_ohm + params.bridge.drop_ohm;
        Self {
            drop_v: params.bridge.drop_v,
            diode_v: params.bridge.diode_v,
            brake_v: params.bridge.brake_v,
            loop_ohm,
            time_constant_s: params.motor.inductance_h / loop_ohm,
            pwm_hz: params.bridge.pwm_hz,
        }
    }

    /// The setting for these pins; the same as before costs no exponential.
    pub(super) fn command(
        &self,
        bridge: Bridge,
        Modulation { hz, decay }: Modulation,
        before: Command,
    ) -> Command {
        let (direction, duty) = match bridge {
            Bridge::Forward(duty) => (1.0, duty),
            Bridge::Backward(duty) => (-1.0, duty),
            Bridge::Brake(share) => {
                return Command {
                    braking: true,
                    duty: if share > 0.0 { share.min(1.0) } else { 0.0 },
                    ..RELEASED
                };
            }
            Bridge::Released => return RELEASED,
        };
        let periods = self.time_constant_s * hz.unwrap_or(self.pwm_hz);
        let same = direction == before.direction && duty == before.duty && decay == before.decay;
        if same && periods == before.periods {
            return before;
        }
        if duty > 0.0 {
            let duty = if duty < 1.0 { duty } else { 1.0 };
            Command {
                direction,
                braking: false,
                decay,
                duty,
                periods,
                reached: 1.0 - libm::exp(-duty / periods),
            }
        } else {
            RELEASED
        }
    }

    /// Mean motor current and mean current drawn from the supply over one PWM period, A.
    /// Inline: with this call and that of `speeds_after` a run of one robot takes 5 % longer.
    #[inline(always)]
    pub(crate) fn current(&self, command: &Command, emf_v: f64, supply_v: f64) -> (f64, f64) {
        if command.direction == 0.0 {
            return if command.braking {
                (command.duty * self.braking_current_a(emf_v), 0.0)
            } else {
                (0.0, 0.0)
            };
        }
        let against_v = command.direction * emf_v;
        let on_a = (supply_v - self.drop_v - against_v) / self.loop_ohm;
        let off = 1.0 - command.duty;
        let off_v = match command.decay {
            Decay::Fast => supply_v + 2.0 * self.diode_v,
            Decay::Slow if self.brake_v > 0.0 => self.brake_v,
            Decay::Slow => {
                // Transistors that conduct both ways: the current never stops.
                let mean_a = on_a * command.duty - against_v / self.loop_ohm * off;
                return (command.direction * mean_a, mean_a * command.duty);
            }
        };
        let slow = command.decay == Decay::Slow;
        if on_a <= 0.0 {
            return match slow {
                true => (off * self.braking_current_a(emf_v), 0.0),
                false => (0.0, 0.0),
            };
        }
        // Towards minus this current the winding discharges. A motor turned against the bridge faster than the supply
        // would feed it for ever: the floor keeps the logarithm's argument bounded.
        let true_off_a = (off_v + against_v) / self.loop_ohm;
        let share = if slow { 0.01 } else { 0.05 };
        let least_a = share * on_a;
        let off_a = if true_off_a > least_a {
            true_off_a
        } else {
            least_a
        };
        let peak_a = on_a * command.reached;
        let fall = command.periods * ln_1p(peak_a / off_a);
        // A motor that is turned against the bridge feeds the short: the current does not end.
        let ends = fall < off && !(slow && true_off_a < 0.0);
        if ends {
            let mean_a = on_a * command.duty - off_a * fall;
            if slow {
                let shorted_a = (off - fall) * self.braking_current_a(emf_v);
                let drawn_a = on_a * command.duty - command.periods * peak_a;
                return (command.direction * mean_a + shorted_a, drawn_a);
            }
            let drawn_a = mean_a + 2.0 * (off_a * fall - command.periods * peak_a);
            (command.direction * mean_a, drawn_a)
        } else {
            // A short does not feed the motor: no floor is needed.
            let (off_a, returned) = if slow {
                (true_off_a, 0.0)
            } else {
                (off_a, off)
            };
            let mean_a = on_a * command.duty - off_a * off;
            (
                command.direction * mean_a,
                mean_a * (command.duty - returned),
            )
        }
    }

    /// Shorted motor.
    fn braking_current_a(&self, emf_v: f64) -> f64 {
        let drop_v = self.brake_v;
        if emf_v > drop_v {
            -(emf_v - drop_v) / self.loop_ohm
        } else if emf_v < -drop_v {
            -(emf_v + drop_v) / self.loop_ohm
        } else {
            0.0
        }
    }
}

/// ln(1 + x) for x >= 0 by its [3/2] Pade approximant: within 4e-5 up to x = 1, 0.1 % at 3, 2 % at 20. The currents'
/// ratio stays below 1 unless the motor is turned against the bridge.
fn ln_1p(x: f64) -> f64 {
    x * (60.0 + x * (60.0 + x * 11.0)) / (60.0 + x * (90.0 + x * (36.0 + x * 3.0)))
}
