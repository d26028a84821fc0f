//! What explains a stretch of a run: rules over signals, loop terms, ground truth and events. Each says what the log shows,
//! when, and in which lesson to read about it; the cause that explains most comes first.
//!
//! Without ground truth, of a real robot, only those rules speak that need none.

mod motion;
mod sensors;
#[cfg(test)]
mod tests;

use crate::board::News;
use rumbo_log::{Level, Log, LoggedEvent, Reading, ReadingSource, Row};
use serde::Serialize;
use std::collections::BTreeMap;

/// Longest time between two frames that is no silence \[s\].
const SILENCE_S: f64 = 0.25;

/// A cause, in words.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cause {
    /// Which rule found it.
    pub kind: CauseKind,
    /// When it began and ended \[s\].
    pub from_s: f64,
    /// See `from_s`.
    pub to_s: f64,
    /// What the log shows, for a person.
    pub text: String,
    /// The lesson about it, by the name of its file without the ending.
    pub lesson: Option<&'static str>,
}

/// What a rule is about; those that explain more come first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CauseKind {
    /// The robot's program started again.
    Restart,
    /// No telemetry came.
    Silence,
    /// An encoder counted what its wheel did not do.
    Encoder,
    /// A sonar repeated itself, heard nothing, or did not answer.
    Sonar,
    /// A wheel was held.
    Held,
    /// The robot touched something.
    Contact,
    /// Single readings of a sonar were far off.
    Outliers,
    /// A fault that the robot reported.
    Fault,
    /// STOP or OFF.
    Stopped,
    /// Wheels rolled farther than the robot went.
    Slip,
    /// A wheel stood although it was driven.
    DeadZone,
    /// The PWM was at its limit.
    Saturation,
    /// Friction brakes otherwise than the parameters say.
    Braking,
    /// The pose that the robot believes in drifted away.
    Drift,
    /// The integral stands in for a wrong feedforward.
    Feedforward,
}

/// What is known of a stretch.
struct Seen<'a> {
    rows: Vec<&'a Row>,
    loops: Vec<&'a Reading>,
    parameters: BTreeMap<String, f32>,
}

/// What explains a run from one time to another \[s\].
#[must_use]
pub fn explain(log: &Log, from_s: f64, to_s: f64) -> Vec<Cause> {
    let parameters = log.parameters();
    causes(
        (&log.rows, &log.readings, &log.events),
        parameters,
        from_s,
        to_s,
    )
}

/// The same of what a page has got, all of it: the news for a new page.
#[must_use]
pub fn explain_news(news: &News, from_s: f64, to_s: f64) -> Vec<Cause> {
    let known = news.parameters.iter().flatten();
    let known = known.filter_map(|each| Some((each.entry.name.to_string(), each.value?)));
    let all = (&news.samples[..], &news.readings[..], &news.events[..]);
    causes(all, known.collect(), from_s, to_s)
}

fn causes(
    (rows, readings, events): (&[Row], &[Reading], &[LoggedEvent]),
    parameters: BTreeMap<String, f32>,
    from_s: f64,
    to_s: f64,
) -> Vec<Cause> {
    let within = |t_s: f64| (from_s..=to_s).contains(&t_s);
    let is_loop =
        |each: &&Reading| each.source == ReadingSource::Loops && within(seconds(each.t_ms));
    let seen = Seen {
        rows: rows
            .iter()
            .filter(|row| within(seconds(row.t_ms)))
            .collect(),
        loops: readings.iter().filter(is_loop).collect(),
        parameters,
    };
    let of_time = events.iter().filter(|event| within(event.t_s));
    let mut causes: Vec<Cause> = of_time.filter_map(named_by).collect();
    causes.extend(seen.silences());
    causes.extend(seen.sensors());
    causes.extend(seen.motion());
    causes.sort_by(|one, other| {
        let order = one.kind.cmp(&other.kind);
        order.then(one.from_s.total_cmp(&other.from_s))
    });
    causes
}

/// What the session itself says of an event.
fn named_by(event: &LoggedEvent) -> Option<Cause> {
    let kind = if event.text.contains("program started again") {
        CauseKind::Restart
    } else if event.level == Level::Fault {
        CauseKind::Fault
    } else if event.text == "sent: STOP" || event.text == "sent: OFF" {
        CauseKind::Stopped
    } else {
        return None;
    };
    Some(Cause {
        kind,
        from_s: event.t_s,
        to_s: event.t_s,
        text: event.text.clone(),
        lesson: None,
    })
}

fn seconds(t_ms: i64) -> f64 {
    t_ms as f64 / 1e3
}

/// A number with so many digits after the point, without a sign where it is zero.
fn digits(value: f64, decimals: usize) -> String {
    format!("{:.decimals$}", value + 0.0)
}

/// The longest stretch in which something holds, with its indices, if it lasts that long \[s\].
fn longest(times_s: &[f64], holds: impl Fn(usize) -> bool, least_s: f64) -> Option<(usize, usize)> {
    let (mut best, mut begun): (Option<(usize, usize)>, Option<usize>) = (None, None);
    let lasts = |(from, to): (usize, usize)| times_s[to] - times_s[from];
    for index in 0..times_s.len() {
        let from = match (holds(index), begun) {
            (false, _) => {
                begun = None;
                continue;
            }
            (true, Some(from)) => from,
            (true, None) => index,
        };
        begun = Some(from);
        if best.is_none_or(|best| lasts((from, index)) > lasts(best)) {
            best = Some((from, index));
        }
    }
    best.filter(|span| lasts(*span) >= least_s)
}

impl Seen<'_> {
    fn times_s(&self) -> Vec<f64> {
        self.rows.iter().map(|row| seconds(row.t_ms)).collect()
    }

    /// A signal in every row; not a number where unknown, infinite where a range is clear.
    fn signal(&self, name: &str) -> Vec<f64> {
        let column = Row::column(name);
        let value = |row: &&Row| column.and_then(|column| row.get(column));
        self.rows
            .iter()
            .map(|row| value(row).unwrap_or(f64::NAN))
            .collect()
    }

    fn parameter(&self, name: &str) -> Option<f64> {
        self.parameters.get(name).copied().map(f64::from)
    }

    fn silences(&self) -> Vec<Cause> {
        let pairs = self.rows.windows(2);
        let gaps = pairs.filter_map(|two| {
            let [from_s, to_s] = [two[0], two[1]].map(|row| seconds(row.t_ms));
            (to_s - from_s > SILENCE_S).then(|| Cause {
                kind: CauseKind::Silence,
                from_s,
                to_s,
                text: format!(
                    "the link was silent for {} s: no telemetry came",
                    digits(to_s - from_s, 2)
                ),
                lesson: None,
            })
        });
        gaps.collect()
    }
}
