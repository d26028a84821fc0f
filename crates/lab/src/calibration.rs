//! The robot's own calibration as a guest of the session.

use rumbo_control::params::ParamId;
use rumbo_experiment::calibrate::{self, Calibration, Calibrator};
use rumbo_log::{Finding, Findings};
use rumbo_session::{CalibrationError, Guest};

/// The calibration of the robot in the dashboard.
#[derive(Debug)]
struct InDashboard(Calibrator);

impl Guest for InDashboard {
    fn advance(
        &mut self,
        now_us: u64,
        received: &[u8],
        to_robot: &mut Vec<u8>,
    ) -> Option<Result<Findings, CalibrationError>> {
        let found = self.0.advance(now_us, received, to_robot)?;
        Some(match found {
            Ok(found) => Ok(findings(&found)),
            Err(why) => Err(CalibrationError::GivenUp(why.to_string())),
        })
    }
}

/// The calibration of the robot in the dashboard, begun at this instant \[us\].
#[must_use]
pub fn calibration(now_us: u64) -> Box<dyn Guest> {
    Box::new(InDashboard(Calibrator::new(now_us)))
}

fn findings(found: &Calibration) -> Findings {
    let rows = calibrate::rows(found, None).into_iter();
    let numbered = |parameters: &[(ParamId, f32)]| {
        let each = parameters.iter();
        each.map(|(id, value)| (*id as u8, *value)).collect()
    };
    Findings {
        rows: rows
            .map(|row| Finding {
                name: row.name,
                found: row.found,
                standard_error: row.standard_error,
            })
            .collect(),
        parameters: numbered(&found.parameters()),
        before: numbered(&found.before),
    }
}
