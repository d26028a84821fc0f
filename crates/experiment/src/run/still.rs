//! Motors that were driven in vain: by a PWM too weak for the wheels to turn.

use crate::note::Note;
use rumbo_sim::trace::TruthSample;

/// A wheel that is no faster stands [rad/s]: what a motor gives as it is switched on is no turn.
const CREEP_RAD_S: f64 = 0.05;
/// For so long a robot may stand against its motors without a word [s].
const LONG_S: f64 = 5.0;

/// That no wheel ever turned, or for long not, though the motors were driven and nothing was in the way.
pub(super) fn in_vain(samples: &[TruthSample]) -> Option<Note> {
    let stands = |sample: &TruthSample| {
        let is_slow = |speed: f64| speed.abs() < CREEP_RAD_S;
        sample.wheel_rad_s.into_iter().all(is_slow)
    };
    let pwm = |samples: &[TruthSample]| {
        let pwm = samples.iter().flat_map(|sample| sample.duty);
        pwm.map(i16::unsigned_abs).max().unwrap_or_default()
    };
    if samples.iter().all(stands) {
        let pwm = pwm(samples);
        return (pwm > 0).then_some(Note::NeverTurned { pwm });
    }
    let in_vain =
        |sample: &TruthSample| stands(sample) && sample.duty != [0; 2] && !sample.touching;
    let stretches = samples.chunk_by(|one, other| in_vain(one) == in_vain(other));
    let stood = stretches.filter(|stretch| in_vain(&stretch[0]));
    let lasted_s = |stretch: &[TruthSample]| stretch[stretch.len() - 1].t_s - stretch[0].t_s;
    let longest = stood.max_by(|one, other| lasted_s(one).total_cmp(&lasted_s(other)))?;
    let (for_s, from_s) = (lasted_s(longest), longest[0].t_s);
    let pwm = pwm(longest);
    (for_s > LONG_S).then_some(Note::StoodStill { from_s, for_s, pwm })
}
