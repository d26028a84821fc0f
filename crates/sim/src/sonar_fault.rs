//! Sonars that fail in the middle of a run: what the board receives from then on.

use crate::source;
use rumbo_control::{Echo, SonarId};
use rumbo_plant::noise::Noise;

/// The report's recorded absurdities end here: 21.96 m [us].
const LONGEST_SPIKE_US: f64 = 128_000.0;
/// Longest spike that looks like a distance within reach: 2.5 m [us].
const LONGEST_CREDIBLE_US: f64 = 14_500.0;

/// An HC-SR04 without an echo holds its line for this long [us].
const HELD_US: u64 = 38_000;

/// How a sonar fails.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SonarFault {
    /// Its wires are cut: it answers no ping.
    Cut,
    /// It repeats the last answer before the failure for ever.
    Stuck,
    /// It reports for ever that nothing is in range.
    Clear,
    /// This share of its answers, 0 to 1, are random: half of them credible distances, half as absurd as 0.1 cm or 20 m.
    Spiking(f64),
}

/// One sonar's fault and when it begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedSonarFault {
    /// Time since the start [s].
    pub at_s: f64,
    /// Which sonar.
    pub sonar: SonarId,
    /// What happens to it.
    pub fault: SonarFault,
}

/// The faults of a run and their state.
#[derive(Clone, Debug, Default)]
pub(crate) struct SonarFaults {
    faults: Vec<TimedSonarFault>,
    /// The last sound answer of each sonar.
    last: [Option<Echo>; 3],
    answers: u64,
}

impl SonarFaults {
    pub(crate) fn add(&mut self, fault: TimedSonarFault) {
        self.faults.push(fault);
    }

    /// The fault that a sonar has now: the last one that has begun.
    fn now(&self, sonar: SonarId, now_us: u64) -> Option<SonarFault> {
        self.faults
            .iter()
            .rev()
            .find(|timed| timed.sonar == sonar && timed.at_s * 1e6 <= now_us as f64)
            .map(|timed| timed.fault)
    }

    /// Whether a ping reaches the sonar.
    pub(crate) fn is_cut(&self, sonar: SonarId, now_us: u64) -> bool {
        self.now(sonar, now_us) == Some(SonarFault::Cut)
    }

    /// What the board receives in place of a sonar's answer.
    pub(crate) fn answer(
        &mut self,
        noise: &Noise,
        (sonar, echo): (SonarId, Echo),
        now_us: u64,
    ) -> (SonarId, Echo) {
        self.answers += 1;
        let last = &mut self.last[sonar as usize];
        let kept = *last.get_or_insert(echo);
        let answer = match self.now(sonar, now_us) {
            None | Some(SonarFault::Cut) => {
                self.last[sonar as usize] = Some(echo);
                echo
            }
            Some(SonarFault::Stuck) => kept,
            Some(SonarFault::Clear) => Echo::Clear,
            Some(SonarFault::Spiking(share)) => {
                let source = source::SPIKES + 2 * sonar as u32;
                if noise.chance(source, self.answers, share) {
                    spike(noise.uniform(source + 1, self.answers))
                } else {
                    echo
                }
            }
        };
        (sonar, answer)
    }

    /// How long a line that has just risen stays high, whatever its sonar receives [us]; `None` if the sonar decides.
    pub(crate) fn width_us(&mut self, noise: &Noise, sonar: SonarId, now_us: u64) -> Option<u64> {
        self.answers += 1;
        match self.now(sonar, now_us)? {
            SonarFault::Cut => None,
            SonarFault::Stuck => match self.last[sonar as usize] {
                Some(Echo::Pulse(width_us)) => Some(width_us.into()),
                _ => None,
            },
            SonarFault::Clear => Some(HELD_US),
            SonarFault::Spiking(share) => {
                let source = source::SPIKES + 2 * sonar as u32;
                noise
                    .chance(source, self.answers, share)
                    .then(|| spike_us(noise.uniform(source + 1, self.answers)).into())
            }
        }
    }

    /// A line has fallen this long after it rose: the sonar's own answer.
    pub(crate) fn sounded(&mut self, sonar: SonarId, width_us: u64, now_us: u64) {
        let sound = !matches!(self.now(sonar, now_us), Some(SonarFault::Stuck));
        let last = &mut self.last[sonar as usize];
        if sound || last.is_none() {
            *last = Some(Echo::Pulse(u32::try_from(width_us).unwrap_or(u32::MAX)));
        }
    }
}

/// A random answer from a number in [0, 1).
fn spike(uniform: f64) -> Echo {
    Echo::Pulse(spike_us(uniform))
}

fn spike_us(uniform: f64) -> u32 {
    let us = if uniform < 0.5 {
        2.0 * uniform * LONGEST_CREDIBLE_US
    } else {
        (2.0 * uniform - 1.0) * LONGEST_SPIKE_US
    };
    us as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answers(fault: SonarFault) -> Vec<Echo> {
        let mut faults = SonarFaults::default();
        faults.add(TimedSonarFault {
            at_s: 1.0,
            sonar: SonarId::Left,
            fault,
        });
        let noise = Noise::new(1, 0);
        (0..200u32)
            .map(|n| {
                let echo = (SonarId::Left, Echo::Pulse(3_000 + n));
                faults.answer(&noise, echo, u64::from(n) * 60_000).1
            })
            .collect()
    }

    #[test]
    fn a_stuck_sonar_repeats_its_last_sound_answer_from_the_moment_it_fails() {
        let received = answers(SonarFault::Stuck);
        assert_eq!(received[16], Echo::Pulse(3_016));
        assert!(received[17..].iter().all(|echo| *echo == received[16]));
    }

    #[test]
    fn a_spiking_sonar_is_wrong_in_its_share_of_answers() {
        let received = answers(SonarFault::Spiking(0.3));
        let wrong = (0..200)
            .filter(|n| received[*n as usize] != Echo::Pulse(3_000 + n))
            .count();
        assert!((35..75).contains(&wrong), "{wrong}");
    }

    #[test]
    fn a_fault_befalls_its_own_sonar_only_and_not_before_its_time() {
        let mut faults = SonarFaults::default();
        faults.add(TimedSonarFault {
            at_s: 1.0,
            sonar: SonarId::Left,
            fault: SonarFault::Cut,
        });
        assert!(!faults.is_cut(SonarId::Left, 999_999) && faults.is_cut(SonarId::Left, 1_000_000));
        assert!(!faults.is_cut(SonarId::Right, 2_000_000));
    }
}
