//! Telemetry rows of the original text protocol, parsed from the raw bytes of the link.

use crate::channel::Channel;
use rumbo_sim::LinkTape;
use rumbo_wire::text::{MissionRow, TextRow};

/// The rows that the robot sent, each with its time of arrival [s].
pub(crate) fn rows(link: &LinkTape) -> Vec<(f64, TextRow)> {
    let (mut rows, mut line) = (Vec::new(), Vec::new());
    for burst in link.iter().filter(|burst| !burst.to_robot) {
        for byte in burst.bytes {
            if *byte != b'\n' {
                line.push(*byte);
                continue;
            }
            let text = std::mem::take(&mut line);
            if let Ok(Ok(row)) = std::str::from_utf8(&text).map(|text| TextRow::parse(text.trim()))
            {
                rows.push((burst.t_us as f64 * 1e-6, row));
            }
        }
    }
    rows
}

/// A sonar's range [cm]. A robot with one sonar sends it twice.
pub(crate) fn range_cm(row: &TextRow, sonar: Channel) -> Option<f64> {
    let range_cm = match (row, sonar) {
        (TextRow::Distance(row), Channel::Left | Channel::Front) => row.left_cm,
        (TextRow::Distance(row), Channel::Right) => row.right_cm,
        (TextRow::Mission(row), Channel::Left) => row.left_cm,
        (TextRow::Mission(row), Channel::Right) => row.right_cm,
        (TextRow::Mission(row), Channel::Front) => row.front_cm,
        _ => return None,
    };
    Some(f64::from(range_cm))
}

/// A wheel's speed [rpm].
pub(crate) fn speed_rpm(row: &TextRow, wheel: Channel) -> Option<f64> {
    let wheels = match row {
        TextRow::Speed(row) => row.wheel_rpm,
        TextRow::Waypoints(row) => row.wheel_rpm,
        TextRow::Distance(_) | TextRow::Mission(_) => return None,
    };
    Some(f64::from(wheel.of(wheels)))
}

/// A wheel's setpoint [rpm].
pub(crate) fn reference_rpm(row: &TextRow, wheel: Channel) -> Option<f64> {
    let wheels = match row {
        TextRow::Speed(row) => return Some(f64::from(row.reference_rpm)),
        TextRow::Waypoints(row) => row.reference_rpm,
        TextRow::Mission(row) => row.reference_rpm,
        TextRow::Distance(_) => return None,
    };
    Some(f64::from(wheel.of(wheels)))
}

/// x [m], y [m] and heading [deg].
pub(crate) fn pose(row: &TextRow) -> Option<[f64; 3]> {
    let pose = match row {
        TextRow::Waypoints(row) => [row.x_m, row.y_m, row.heading_deg],
        TextRow::Mission(row) => [row.x_m, row.y_m, row.heading_deg],
        TextRow::Distance(_) | TextRow::Speed(_) => return None,
    };
    Some(pose.map(f64::from))
}

/// A row of mode 8.
pub(crate) fn mission(row: &TextRow) -> Option<&MissionRow> {
    match row {
        TextRow::Mission(row) => Some(row),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_sim::LinkBurst;

    #[test]
    fn rows_are_found_in_bytes_that_come_in_pieces() {
        let mut link = LinkTape::default();
        for (t_us, to_robot, text) in [
            (1_000_000, false, "hello\r\n60,10"),
            (1_100_000, true, "ON\n"),
            (1_200_000, false, "7.5,107.5,30,1,115,115\r\n"),
        ] {
            link.push(LinkBurst {
                t_us,
                to_robot,
                bytes: text.as_bytes(),
            });
        }
        let rows = rows(&link);
        assert_eq!(rows.len(), 1);
        assert_eq!(
            (rows[0].0, range_cm(&rows[0].1, Channel::Front)),
            (1.2, Some(107.5))
        );
    }
}
