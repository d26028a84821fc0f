//! Rules for wheels, friction and the way.

use super::{Cause, CauseKind, Seen, digits, longest, seconds};
use std::f64::consts::PI;

const SPEEDS: Option<&str> = Some("1-wheel-speed");
const BRAKES: Option<&str> = Some("2-front-distance");
const ODOMETRY: Option<&str> = Some("4-odometry");
/// PWM at its limit, of 255.
const LIMIT: f64 = 250.0;
/// It says something when it lasts so long: each start reaches it for a moment [s].
const SATURATED_S: f64 = 0.4;
/// Share of the wanted speed that counts as reached.
const REACHED: f64 = 0.9;
/// A wheel stands below this [rad/s], and is driven above this PWM.
const STANDS_RAD_S: f64 = 0.1;
const DRIVEN: f64 = 8.0;
const STOOD_S: f64 = 0.2;
/// No friction stands against this PWM: something holds the wheel.
const HELD: f64 = 150.0;
/// Window of the slip [s], least way in it [m], and the share of the way that is lost.
const SLIP_S: f64 = 0.5;
const ROLLED_M: f64 = 0.05;
const SLIPPED: f64 = 0.12;
/// Rolling out with released wheels: least time [s], and how much less than planned it slows.
const ROLLS_S: f64 = 0.1;
const LESS: f64 = 0.85;
/// What the integral adds to the PWM, in counts and as a share, for so long [s].
const ADDED: f64 = 15.0;
const ADDED_SHARE: f64 = 0.2;
const ADDED_S: f64 = 0.5;
/// The believed pose drifts by this much [m], and share of the way.
const DRIFTED_M: f64 = 0.05;
const DRIFTED_SHARE: f64 = 0.04;

const RPM: f64 = 30.0 / PI;

impl Seen<'_> {
    pub(super) fn motion(&self) -> Vec<Cause> {
        let wheels = ["left", "right"].into_iter();
        let wheels = wheels.flat_map(|side| {
            let stood = self.stood(side);
            let limited = self.saturated(side);
            [stood, limited, self.feedforward(side)]
                .into_iter()
                .flatten()
        });
        let all = [
            self.contact(),
            self.slipped(),
            self.braked(),
            self.drifted(),
        ];
        wheels.chain(all.into_iter().flatten()).collect()
    }

    /// The true speed of both wheels over the floor [m/s]; 0 where it is not known.
    pub(super) fn speed_m_s(&self) -> Vec<f64> {
        let radius_m = |side| self.parameter(&format!("radius_{side}_m")).unwrap_or(0.0);
        let [left, right] =
            ["left", "right"].map(|side| self.signal(&format!("true_{side}_rad_s")));
        let mean = |(left, right): (&f64, &f64)| {
            let speed = 0.5 * (radius_m("left") * left + radius_m("right") * right);
            if speed.is_nan() { 0.0 } else { speed }
        };
        left.iter().zip(&right).map(mean).collect()
    }

    fn cause(
        &self,
        kind: CauseKind,
        (from, to): (usize, usize),
        text: String,
        lesson: Option<&'static str>,
    ) -> Cause {
        let at_s = |index: usize| self.rows.get(index).map_or(0.0, |row| seconds(row.t_ms));
        Cause {
            kind,
            from_s: at_s(from),
            to_s: at_s(to),
            text,
            lesson,
        }
    }

    /// The speed of a wheel: the true one, else the measured one.
    fn wheel_rad_s(&self, side: &str) -> Vec<f64> {
        let truth = self.signal(&format!("true_{side}_rad_s"));
        match truth.iter().any(|value| value.is_finite()) {
            true => truth,
            false => self.signal(&format!("{side}_rad_s")),
        }
    }

    fn stood(&self, side: &str) -> Option<Cause> {
        let times_s = self.times_s();
        let pwm = self.signal(&format!("{side}_pwm"));
        let speed = self.wheel_rad_s(side);
        let stands = |at: usize| pwm[at].abs() > DRIVEN && speed[at].abs() < STANDS_RAD_S;
        let span = longest(&times_s, stands, STOOD_S)?;
        let most = pwm[span.0..=span.1]
            .iter()
            .fold(0.0_f64, |most, pwm| most.max(pwm.abs()));
        let lasted = digits(times_s[span.1] - times_s[span.0], 2);
        Some(match most > HELD {
            true => self.cause(
                CauseKind::Held,
                span,
                format!("something held the {side} wheel: it stood for {lasted} s with a PWM of up to {}", digits(most, 0)),
                None,
            ),
            false => self.cause(
                CauseKind::DeadZone,
                span,
                format!("the {side} wheel stood for {lasted} s: a PWM of {} does not overcome its friction", digits(most, 0)),
                SPEEDS,
            ),
        })
    }

    fn saturated(&self, side: &str) -> Option<Cause> {
        let times_s = self.times_s();
        let pwm = self.signal(&format!("{side}_pwm"));
        let wanted = self.signal(&format!("{side}_ref_rad_s"));
        let speed = self.wheel_rad_s(side);
        let limited = |at: usize| {
            pwm[at].abs() >= LIMIT
                && speed[at].abs() < REACHED * wanted[at].abs()
                && speed[at].abs() > STANDS_RAD_S
        };
        let (from, to) = longest(&times_s, limited, SATURATED_S)?;
        let text = format!(
            "the PWM of the {side} wheel was at its limit for {} s: the wheel came to {} of {} rpm",
            digits(times_s[to] - times_s[from], 2),
            digits(RPM * speed[to].abs(), 0),
            digits(RPM * wanted[to].abs(), 0)
        );
        Some(self.cause(CauseKind::Saturation, (from, to), text, SPEEDS))
    }

    /// What the integral has to add where the speed is as wanted.
    fn feedforward(&self, side: &str) -> Option<Cause> {
        let times_s: Vec<f64> = self.loops.iter().map(|each| seconds(each.t_ms)).collect();
        let term = |name: &str| -> Vec<f64> {
            let name = format!("{side}_{name}");
            let value = self.loops.iter().map(|each| each.signal(&name));
            value.map(|value| value.unwrap_or(f64::NAN)).collect()
        };
        let (integral, forward, error) = (term("i_pwm"), term("feedforward_pwm"), term("p_pwm"));
        let adds = |at: usize| {
            integral[at].abs() > ADDED.max(ADDED_SHARE * forward[at].abs())
                && error[at].abs() < ADDED
        };
        let (from, to) = longest(&times_s, adds, ADDED_S)?;
        let more = match integral[to] * forward[to] > 0.0 {
            true => "more",
            false => "less",
        };
        Some(Cause {
            kind: CauseKind::Feedforward,
            from_s: times_s[from],
            to_s: times_s[to],
            text: format!(
                "the {side} wheel needs {more} than its feedforward believes: the integral adds {} to a PWM of {}; friction, battery, kv or ks are other",
                digits(integral[to], 0),
                digits(forward[to], 0)
            ),
            lesson: SPEEDS,
        })
    }

    fn contact(&self) -> Option<Cause> {
        let contact = self.signal("contact");
        let from = contact.iter().position(|touches| *touches == 1.0)?;
        let to = contact.iter().rposition(|touches| *touches == 1.0)?;
        let at_s = digits(self.times_s()[from], 2);
        Some(self.cause(
            CauseKind::Contact,
            (from, to),
            format!("the robot touched something, at {at_s} s first"),
            None,
        ))
    }

    fn slipped(&self) -> Option<Cause> {
        let times_s = self.times_s();
        let speed = self.speed_m_s();
        let [x, y] = ["true_x_m", "true_y_m"].map(|name| self.signal(name));
        let mut worst: Option<(usize, usize, f64, f64)> = None;
        for from in 0..times_s.len() {
            let (mut rolled_m, mut moved_m, mut to) = (0.0, 0.0, from);
            while to + 1 < times_s.len() && times_s[to] - times_s[from] < SLIP_S {
                let dt_s = times_s[to + 1] - times_s[to];
                rolled_m += (0.5 * (speed[to] + speed[to + 1]) * dt_s).abs();
                moved_m += (x[to + 1] - x[to]).hypot(y[to + 1] - y[to]);
                to += 1;
            }
            let lost = |rolled_m: f64, moved_m: f64| 1.0 - moved_m / rolled_m;
            if rolled_m > ROLLED_M
                && lost(rolled_m, moved_m) > SLIPPED
                && worst.is_none_or(|(_, _, rolled, moved)| {
                    lost(rolled_m, moved_m) > lost(rolled, moved)
                })
            {
                worst = Some((from, to, rolled_m, moved_m));
            }
        }
        let (from, to, rolled_m, moved_m) = worst?;
        let text = format!(
            "the wheels slipped: in {} s they rolled {} cm, and the robot went {} cm",
            digits(times_s[to] - times_s[from], 2),
            digits(100.0 * rolled_m, 1),
            digits(100.0 * moved_m, 1)
        );
        Some(self.cause(CauseKind::Slip, (from, to), text, ODOMETRY))
    }

    /// Before a wall: what friction took from the speed while the bridge was at 0, beside what the approach counts on.
    fn braked(&self) -> Option<Cause> {
        let planned = self.parameter("front_brake_m_s2")?;
        let times_s = self.times_s();
        let speed = self.speed_m_s();
        let [left, right] = ["left_pwm", "right_pwm"].map(|name| self.signal(name));
        let [armed, mode, wanted] =
            ["armed", "mode", "left_ref_rad_s"].map(|name| self.signal(name));
        let radius_m = self.parameter("radius_left_m")?;
        let rolls = |at: usize| {
            armed[at] == 1.0
                && (mode[at] == 1.0 || mode[at] == 2.0)
                && left[at] == 0.0
                && right[at] == 0.0
                && speed[at].abs() > (radius_m * wanted[at]).abs() + 0.02
        };
        let (from, to) = longest(&times_s, rolls, ROLLS_S)?;
        let slowed = (speed[from].abs() - speed[to].abs()) / (times_s[to] - times_s[from]);
        if slowed > LESS * planned {
            return None;
        }
        let text = format!(
            "with the bridge at 0 for {} s, friction slowed the robot by {} m/s²; front_brake_m_s2 counts on {}",
            digits(times_s[to] - times_s[from], 2),
            digits(slowed, 2),
            digits(planned, 2)
        );
        Some(self.cause(CauseKind::Braking, (from, to), text, BRAKES))
    }

    fn drifted(&self) -> Option<Cause> {
        let off = |row: &&rumbo_log::Row| {
            let (origin, own, truth) = (row.pose("origin_")?, row.pose("")?, row.pose("true_")?);
            let (sin, cos) = origin.heading_rad.sin_cos();
            let x_m = origin.x_m + cos * own.x_m - sin * own.y_m;
            let y_m = origin.y_m + sin * own.x_m + cos * own.y_m;
            Some((x_m - truth.x_m).hypot(y_m - truth.y_m))
        };
        let offs: Vec<f64> = self
            .rows
            .iter()
            .map(|row| off(row).unwrap_or(f64::NAN))
            .collect();
        let from = offs.iter().position(|value| value.is_finite())?;
        let to = offs.iter().rposition(|value| value.is_finite())?;
        let (times_s, speed) = (self.times_s(), self.speed_m_s());
        let rolled_m: f64 = (from..to)
            .map(|at| speed[at].abs() * (times_s[at + 1] - times_s[at]))
            .sum();
        if offs[to] - offs[from] < DRIFTED_M.max(DRIFTED_SHARE * rolled_m) {
            return None;
        }
        let text = format!(
            "the robot believes to be {} cm from where it is, {} cm more than before",
            digits(100.0 * offs[to], 1),
            digits(100.0 * (offs[to] - offs[from]), 1)
        );
        Some(self.cause(CauseKind::Drift, (from, to), text, ODOMETRY))
    }
}
