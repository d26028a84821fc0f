//! Response of a measured signal to each step of its reference, computed alike for our runs and recorded ones.

use rumbo_plot::Points;

/// Band of a settled speed [rpm]: the resolution of the original's measurement.
const SPEED_BAND_RPM: f64 = 3.2;
/// Share of a distance step that is its band.
const DISTANCE_BAND: f64 = 0.05;
/// Share of a step, at its end, that counts as steady.
const STEADY_SHARE: f64 = 0.4;

/// Band within which a response counts as settled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Within 5 % of the step, in cm.
    Distance,
    /// Within 3.2 rpm.
    Speed,
}

/// A response.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Response {
    /// The signal when the step came, and the reference.
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// Time after which it stayed within the band [s]; not a number if it never did.
    pub(crate) settling_s: f64,
    pub(crate) overshoot: f64,
    /// Difference of the steady mean from the reference.
    pub(crate) steady_error: f64,
    /// Standard deviation of the steady part.
    pub(crate) ripple: f64,
}

/// The response to each reference; references start at these times, and the last one ends with the signal.
pub(crate) fn responses(kind: Kind, references: &[(f64, f64)], signal: &Points) -> Vec<Response> {
    let ends = references
        .iter()
        .skip(1)
        .map(|(t_s, _)| *t_s)
        .chain([f64::INFINITY]);
    references
        .iter()
        .zip(ends)
        .filter_map(|((from_s, to), until_s)| {
            let part: Points = signal
                .iter()
                .copied()
                .filter(|(t_s, value)| (*from_s..until_s).contains(t_s) && value.is_finite())
                .collect();
            response(kind, *from_s, *to, &part)
        })
        .collect()
}

fn response(kind: Kind, from_s: f64, to: f64, part: &Points) -> Option<Response> {
    let from = part.first()?.1;
    let band = match kind {
        Kind::Distance => DISTANCE_BAND * (to - from).abs(),
        Kind::Speed => SPEED_BAND_RPM,
    };
    let inside = |value: f64| (value - to).abs() <= band;
    let outside = part.iter().rposition(|(_, value)| !inside(*value));
    let settling_s = match outside {
        None => 0.0,
        Some(last) if last + 1 == part.len() => f64::NAN,
        Some(last) => part[last + 1].0 - from_s,
    };
    let direction = if to < from { -1.0 } else { 1.0 };
    let beyond = part
        .iter()
        .map(|(_, value)| direction * (value - to))
        .fold(0.0, f64::max);
    let steady = &part[(part.len() as f64 * (1.0 - STEADY_SHARE)) as usize..];
    let count = steady.len().max(1) as f64;
    let mean = steady.iter().map(|(_, value)| value).sum::<f64>() / count;
    let variance = steady
        .iter()
        .map(|(_, value)| (value - mean).powi(2))
        .sum::<f64>()
        / count;
    Some(Response {
        from,
        to,
        settling_s,
        overshoot: beyond,
        steady_error: (mean - to).abs(),
        ripple: variance.sqrt(),
    })
}

/// Root mean square and largest absolute value of a signal.
pub(crate) fn rms_and_worst(signal: &Points) -> [f64; 2] {
    let values: Vec<f64> = signal
        .iter()
        .map(|(_, value)| value.abs())
        .filter(|value| value.is_finite())
        .collect();
    let square = values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64;
    [square.sqrt(), values.iter().copied().fold(0.0, f64::max)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_step_is_judged_by_itself() {
        let signal: Points = (0..100)
            .map(|n| f64::from(n) * 0.1)
            .map(|t_s| {
                (
                    t_s,
                    if t_s < 5.0 {
                        (100.0 - 40.0 * t_s).max(28.0)
                    } else {
                        50.0
                    },
                )
            })
            .collect();
        let [one, other] = responses(Kind::Distance, &[(0.0, 30.0), (5.0, 50.0)], &signal)[..]
        else {
            panic!("two steps")
        };
        assert!(
            (one.settling_s - 1.7).abs() < 0.11 && (one.overshoot - 2.0).abs() < 1e-9,
            "{one:?}"
        );
        assert!((one.steady_error - 2.0).abs() < 1e-9 && one.ripple < 1e-9);
        assert!(
            other.settling_s == 0.0 && other.overshoot == 0.0,
            "{other:?}"
        );
    }

    #[test]
    fn what_swings_to_the_end_never_settles() {
        let signal: Points = (0..100)
            .map(|n| (f64::from(n), 50.0 + 10.0 * f64::from(n % 2)))
            .collect();
        let found = responses(Kind::Speed, &[(0.0, 55.0)], &signal);
        assert!(found[0].settling_s.is_nan());
    }
}
