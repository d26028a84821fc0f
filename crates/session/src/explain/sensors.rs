//! Rules for sonars and encoders: what they said beside what was true.

use super::{Cause, CauseKind, Seen, digits, longest};
use std::f64::consts::PI;

const LESSON: Option<&str> = Some("5-lying-sensor");
/// A reading is wrong from here on: so far, by this share, and by what the robot may have driven meanwhile.
const OFF_M: f64 = 0.08;
const OFF_SHARE: f64 = 0.12;
const LAG_S: f64 = 0.25;
/// What a sonar can hear for sure [m].
const HEARD_M: f64 = 2.0;
/// A sonar fails when it does so for this long [s].
const FAILS_S: f64 = 0.35;
/// Repeated, while the truth has gone on so far [m].
const REPEATED_M: f64 = 0.03;
/// Of wheels: a lag of the estimate is no fault [rad/s], share, [s].
const WHEEL_RAD_S: f64 = 3.0;
const WHEEL_SHARE: f64 = 0.3;
const WHEEL_S: f64 = 0.08;
/// A servo that turns no more than this between frames stands [rad].
const STANDS_RAD: f64 = 0.02;

/// Where readings are wrong that do not go on: a face that comes into the beam is right the second time.
fn outliers(
    count: usize,
    wrong: impl Fn(usize) -> bool,
    is_right: impl Fn(usize) -> bool,
) -> Vec<usize> {
    let (mut outliers, mut at) = (Vec::new(), 0);
    while at < count {
        let from = at;
        while at < count && wrong(at) {
            at += 1;
        }
        if at > from && at - from <= 6 && from > 0 && is_right(from - 1) && is_right(at) {
            outliers.push(from);
        }
        at += 1;
    }
    outliers
}

impl Seen<'_> {
    pub(super) fn sensors(&self) -> Vec<Cause> {
        let sonars = ["left", "right", "front"].into_iter();
        let sonars = sonars.flat_map(|side| self.sonar(side));
        let encoders = ["left", "right"].into_iter();
        let encoders = encoders.filter_map(|side| self.encoder(side));
        sonars.chain(encoders).collect()
    }

    fn sonar(&self, side: &str) -> Vec<Cause> {
        let times_s = self.times_s();
        let said = self.signal(&format!("range_{side}_m"));
        let truth = self.signal(&format!("true_range_{side}_m"));
        let servo = self.signal("true_servo_rad");
        let speed = self.speed_m_s();
        // While it turns, what was heard and what is true are of different directions.
        let stands = |at: usize| {
            side != "front"
                || (at.saturating_sub(8)..=at).all(|before| {
                    (servo[before] - servo[at]).abs() < STANDS_RAD || servo[at].is_nan()
                })
        };
        let near = |at: usize| truth[at].is_finite() && truth[at] < HEARD_M && stands(at);
        let mut causes = Vec::new();
        let mut push = |kind, (from, to): (usize, usize), text| {
            causes.push(Cause {
                kind,
                from_s: times_s[from],
                to_s: times_s[to],
                text,
                lesson: LESSON,
            });
        };
        let lasts = |(from, to): (usize, usize)| digits(times_s[to] - times_s[from], 2);
        let cm = |value_m: f64| digits(100.0 * value_m, 1);
        let repeats =
            |at: usize| at > 0 && near(at) && said[at].is_finite() && said[at] == said[at - 1];
        let stuck = longest(&times_s, repeats, FAILS_S)
            .filter(|(from, to)| (truth[*to] - truth[*from]).abs() > REPEATED_M);
        if let Some((from, to)) = stuck {
            push(
                CauseKind::Sonar,
                (from, to),
                format!(
                    "the {side} sonar repeated {} cm for {} s, while the true range went from {} to {} cm",
                    cm(said[to]),
                    lasts((from, to)),
                    cm(truth[from]),
                    cm(truth[to])
                ),
            );
        }
        if let Some(span) = longest(&times_s, |at| near(at) && said[at].is_infinite(), FAILS_S) {
            push(
                CauseKind::Sonar,
                span,
                format!(
                    "the {side} sonar heard nothing for {} s, though something was at {} cm",
                    lasts(span),
                    cm(truth[span.1])
                ),
            );
        }
        let known = said.iter().position(|value| !value.is_nan());
        let silent =
            |at: usize| near(at) && said[at].is_nan() && known.is_some_and(|known| at > known);
        if let Some(span) = longest(&times_s, silent, FAILS_S) {
            push(
                CauseKind::Sonar,
                span,
                format!("the {side} sonar gave no answer for {} s", lasts(span)),
            );
        }
        let off_m = |at: usize| (said[at] - truth[at]).abs();
        let wrong = |at: usize| {
            let most = OFF_M.max(OFF_SHARE * truth[at]) + LAG_S * speed[at].abs();
            near(at) && said[at].is_finite() && off_m(at) > most
        };
        let is_right =
            |at: usize| said.get(at).is_some_and(|value| value.is_finite()) && !wrong(at);
        let outliers = outliers(said.len(), wrong, is_right);
        let worst = outliers
            .iter()
            .copied()
            .max_by(|one, other| off_m(*one).total_cmp(&off_m(*other)));
        if let Some(worst) = worst {
            push(
                CauseKind::Outliers,
                (outliers[0], outliers[outliers.len() - 1]),
                format!(
                    "readings of the {side} sonar that were far off: {}, the worst at {} s: {} cm instead of {} cm",
                    outliers.len(),
                    digits(times_s[worst], 2),
                    cm(said[worst]),
                    cm(truth[worst])
                ),
            );
        }
        causes
    }

    fn encoder(&self, side: &str) -> Option<Cause> {
        let times_s = self.times_s();
        let said = self.signal(&format!("{side}_rad_s"));
        let truth = self.signal(&format!("true_{side}_rad_s"));
        let off = |at: usize| {
            (said[at] - truth[at]).abs() > WHEEL_RAD_S.max(WHEEL_SHARE * truth[at].abs())
        };
        let (from, to) = longest(&times_s, off, WHEEL_S)?;
        let mean = |of: &[f64]| {
            let values = &of[from..=to];
            30.0 / PI * values.iter().sum::<f64>() / values.len() as f64
        };
        let (counted, turned) = (mean(&said), mean(&truth));
        let which = match counted.abs() < turned.abs() {
            true => "lost edges",
            false => "counted noise",
        };
        Some(Cause {
            kind: CauseKind::Encoder,
            from_s: times_s[from],
            to_s: times_s[to],
            text: format!(
                "the {side} encoder {which}: it counted {} rpm, the wheel turned with {} rpm, for {} s",
                digits(counted, 0),
                digits(turned, 0),
                digits(times_s[to] - times_s[from], 2)
            ),
            lesson: LESSON,
        })
    }
}
