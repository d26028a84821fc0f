//! The report's controller (section 2.1.5): integer output, sums per millisecond. From mode 3 on an error is taken back when
//! the output saturates; in modes 1 and 2 it stays in the sum.

/// Gains and limits of a [`Pid`]; the integral gain is per millisecond.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gains(pub f64, pub f64, pub f64);

/// One controller with its memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pid {
    gains: Gains,
    limit: f64,
    last_ms: f64,
    last_error: f64,
    sum: f64,
    first: bool,
    winds_up: bool,
}

impl Pid {
    pub(super) fn new(gains: Gains, limit: f64) -> Self {
        Self {
            gains,
            limit,
            last_ms: 0.0,
            last_error: 0.0,
            sum: 0.0,
            first: true,
            winds_up: false,
        }
    }

    /// One that sums errors on while its output is at the limit.
    pub(super) fn winding_up(gains: Gains, limit: f64) -> Self {
        Self {
            winds_up: true,
            ..Self::new(gains, limit)
        }
    }

    /// Forgets everything but the gains.
    pub(super) fn reset(&mut self) {
        *self = Self {
            winds_up: self.winds_up,
            ..Self::new(self.gains, self.limit)
        };
    }

    /// The output for an error, a whole number; `now_ms` is the program's clock. The time since the last call counts,
    /// whatever happened in it.
    pub(super) fn step(&mut self, error: f64, now_ms: u64) -> f64 {
        let now_ms = now_ms as f64;
        let passed_ms = now_ms - self.last_ms;
        // The report's listing takes an error back on a first call too, where none was added: the whole time since the
        // start would be in the sum. Its recorded turns show that the program that ran did not.
        let added = if self.first { 0.0 } else { error * passed_ms };
        self.sum += added;
        let slope = if self.first {
            0.0
        } else {
            // Two calls within a millisecond would divide by zero; the report's gains of this term are all zero.
            (error - self.last_error) / passed_ms.max(1.0)
        };
        self.first = false;
        let Gains(kp, ki, kd) = self.gains;
        let output = (kp * error + ki * self.sum + kd * slope).round();
        if output.abs() > self.limit && !self.winds_up {
            self.sum -= added;
        }
        self.last_error = error;
        self.last_ms = now_ms;
        output.clamp(-self.limit, self.limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_errors_are_rounded_away_until_the_sum_has_grown() {
        let mut pid = Pid::new(Gains(1.0, 0.001, 0.0), 50.0);
        assert_eq!(pid.step(0.4, 0), 0.0);
        assert_eq!(pid.step(0.4, 100), 0.0);
        assert_eq!(pid.step(0.4, 400), 1.0);
    }

    #[test]
    fn an_error_that_saturates_is_not_summed() {
        let mut pid = Pid::new(Gains(1.0, 0.001, 0.0), 50.0);
        pid.step(80.0, 0);
        assert_eq!(pid.step(80.0, 100), 50.0);
        assert_eq!(pid.sum, 0.0);
        assert_eq!(pid.step(10.0, 200), 11.0);
    }

    #[test]
    fn the_controller_of_modes_1_and_2_sums_on_at_its_limit() {
        let mut pid = Pid::winding_up(Gains(1.0, 0.001, 0.0), 50.0);
        pid.step(80.0, 0);
        assert_eq!(pid.step(80.0, 100), 50.0);
        assert_eq!(pid.sum, 8000.0);
    }
}
