//! A row of the original's text as a telemetry frame: what the row has, and nothing else.

use rumbo_control::{AgedRange, Duty, Pose, SonarId, Wheels};

use crate::message::Telemetry;
use crate::text::{RAD_PER_DEG, RAD_S_PER_RPM, Row, range_from_cm};

impl Row {
    /// Time since the row before [ms].
    pub fn dt_ms(&self) -> u32 {
        match self {
            Row::Distance(row) => row.dt_ms,
            Row::Speed(row) => row.dt_ms,
            Row::Waypoints(row) => row.dt_ms,
            Row::Mission(row) => row.dt_ms,
        }
    }

    /// Number of the mode, where the row has it.
    pub fn mode(&self) -> Option<u8> {
        match self {
            Row::Distance(row) => Some(row.mode),
            Row::Speed(row) => Some(row.mode),
            Row::Waypoints(_) | Row::Mission(_) => None,
        }
    }

    /// The frame of a robot that was armed by text, which a row does not tell, at this time on its clock.
    pub fn telemetry(&self, t_ms: u16, armed: bool) -> Telemetry {
        let mut told = Telemetry {
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
            Row::Distance(row) => {
                ranges[SonarId::Left as usize] = Some(row.left_cm);
                ranges[SonarId::Right as usize] = Some(row.right_cm);
                told.duty = row.pwm.map(Duty::new);
            }
            Row::Speed(row) => {
                told.wheel_rad_s = [rad_s(row.wheel_rpm); 2];
                told.wheel_ref_rad_s = rad_s(Wheels::both(row.reference_rpm));
                told.duty = row.pwm.map(Duty::new);
            }
            Row::Waypoints(row) => {
                told.wheel_rad_s = [rad_s(row.wheel_rpm); 2];
                told.wheel_ref_rad_s = rad_s(row.reference_rpm);
                told.pose = pose(row.x_m, row.y_m, row.heading_deg);
                told.duty = row.pwm.map(Duty::new);
            }
            Row::Mission(row) => {
                ranges[SonarId::Left as usize] = Some(row.left_cm);
                ranges[SonarId::Right as usize] = Some(row.right_cm);
                ranges[SonarId::Front as usize] = Some(row.front_cm);
                told.wheel_ref_rad_s = rad_s(row.reference_rpm);
                told.pose = pose(row.x_m, row.y_m, row.heading_deg);
                told.state = row.state;
            }
        }
        for (told, cm) in told.ranges.iter_mut().zip(ranges) {
            if let Some(cm) = cm {
                *told = AgedRange {
                    range: range_from_cm(cm),
                    age_ticks: 0,
                };
            }
        }
        told
    }
}
