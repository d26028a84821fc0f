//! A row of the original text protocol as a telemetry frame: only the values that the row has.

use rumbo_control::{AgedRange, Duty, Pose, SonarId, Wheels};

use crate::message::Telemetry;
use crate::text::{RAD_PER_DEG, RAD_S_PER_RPM, TextRow, range_from_cm};

impl TextRow {
    /// Time since the row before [ms].
    pub fn dt_ms(&self) -> u32 {
        match self {
            TextRow::Distance(row) => row.dt_ms,
            TextRow::Speed(row) => row.dt_ms,
            TextRow::Waypoints(row) => row.dt_ms,
            TextRow::Mission(row) => row.dt_ms,
        }
    }

    /// Number of the mode, where the row has it.
    pub fn mode(&self) -> Option<u8> {
        match self {
            TextRow::Distance(row) => Some(row.mode),
            TextRow::Speed(row) => Some(row.mode),
            TextRow::Waypoints(_) | TextRow::Mission(_) => None,
        }
    }

    /// The row as a frame at this robot time; `armed` is not in the row and follows from the text commands sent.
    pub fn telemetry(&self, t_ms: u16, armed: bool) -> Telemetry {
        let mut sample = Telemetry {
            t_ms,
            armed,
            ..Telemetry::default()
        };
        let rad_s = |wheels: Wheels<f32>| wheels.map(|rpm| rpm * RAD_S_PER_RPM);
        let pose = |x_m, y_m, heading_deg: f32| Pose {
            x_m,
            y_m,
            heading_rad: heading_deg * RAD_PER_DEG,
        };
        let mut ranges = [None; 3];
        match self {
            TextRow::Distance(row) => {
                ranges[SonarId::Left as usize] = Some(row.left_cm);
                ranges[SonarId::Right as usize] = Some(row.right_cm);
                sample.duty = row.pwm.map(Duty::new);
            }
            TextRow::Speed(row) => {
                sample.wheel_rad_s = [rad_s(row.wheel_rpm); 2];
                sample.wheel_ref_rad_s = rad_s(Wheels::both(row.reference_rpm));
                sample.duty = row.pwm.map(Duty::new);
            }
            TextRow::Waypoints(row) => {
                sample.wheel_rad_s = [rad_s(row.wheel_rpm); 2];
                sample.wheel_ref_rad_s = rad_s(row.reference_rpm);
                sample.pose = pose(row.x_m, row.y_m, row.heading_deg);
                sample.duty = row.pwm.map(Duty::new);
            }
            TextRow::Mission(row) => {
                ranges[SonarId::Left as usize] = Some(row.left_cm);
                ranges[SonarId::Right as usize] = Some(row.right_cm);
                ranges[SonarId::Front as usize] = Some(row.front_cm);
                sample.wheel_ref_rad_s = rad_s(row.reference_rpm);
                sample.pose = pose(row.x_m, row.y_m, row.heading_deg);
                sample.state = row.state;
            }
        }
        for (range, cm) in sample.ranges.iter_mut().zip(ranges) {
            if let Some(cm) = cm {
                *range = AgedRange {
                    range: range_from_cm(cm),
                    age_ticks: 0,
                };
            }
        }
        sample
    }
}
