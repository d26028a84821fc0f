//! The slow state for pages and logs, from the session, its client and its observer.

use super::Observer;
use crate::client::RobotClient;
use crate::words;
use rumbo_control::rig::Rig;
use rumbo_log::{LinkState, RobotState, State};

/// What only the session knows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Around {
    /// The target's time \[us\].
    pub(crate) t_us: u64,
    pub(crate) simulated: bool,
    /// Requested seconds of the target per second of the wall clock.
    pub(crate) speed: f64,
    /// The same, measured.
    pub(crate) achieved_speed: f64,
    pub(crate) baud: u32,
    pub(crate) true_battery_v: Option<f64>,
}

/// The state now.
pub(crate) fn describe(around: &Around, client: &mut RobotClient, observer: &Observer) -> State {
    let link = client.link(around.t_us);
    // Ten bits to a byte.
    let load = |bytes_s: f64| rounded(bytes_s * 10.0 / f64::from(around.baud.max(1)), 1e3);
    let status = observer.status();
    State {
        t_s: around.t_us as f64 / 1e6,
        simulated: around.simulated,
        speed: around.speed,
        achieved_speed: rounded(around.achieved_speed, 1e2),
        link: LinkState {
            connected: client.connected(),
            telemetry_hz: rounded(link.telemetry_hz, 10.0),
            down_load: load(link.down_bytes_s),
            up_load: load(link.up_bytes_s),
            baud: around.baud,
            round_trip_ms: link
                .round_trip_us
                .map(|round_trip_us| round_trip_us / 1_000),
            crc_errors_down: link.crc_errors,
            crc_errors_up: status.crc_errors,
            frames_lost: link.frames_lost,
            dropped: status.dropped,
            unacknowledged: link.unacknowledged,
            clock_offset_ms: link.clock_offset_ms,
            clock_fast_ppm: link.clock_fast_ppm,
        },
        robot: RobotState {
            mode: client.mode() as u8,
            armed: status.armed,
            fault: status.fault.map(|fault| fault.explanation().into()),
            battery_v: status.battery_v.map(|volts| rounded(volts.into(), 1e2)),
            true_battery_v: around.true_battery_v.map(|volts| rounded(volts, 1e2)),
            reference: client.reference().numbers(),
            overruns: status.overruns,
            servo_rad: observer.servo_rad(),
            rig: observer.rig().map(|rig| Rig::name(rig).into()),
            task: observer.task().clone(),
            foreign: client.hello().is_some() && !client.table_matches(),
            text: client.speaks_text(),
        },
        refused: observer.refused().map(str::to_owned),
        alarms: alarms(around.t_us, client),
        calibration: None,
        program: None,
        motors_cut: false,
        experiment: None,
        replay: None,
    }
}

/// What needs the operator's attention at once.
fn alarms(now_us: u64, client: &RobotClient) -> Vec<String> {
    let stop = client.stop_unconfirmed(now_us);
    let stop = stop.then(|| words::STOP_UNCONFIRMED.to_owned());
    let odd = client.anomalies(now_us).map(words::alarm);
    stop.into_iter().chain(odd).collect()
}

/// Rounds to `1 / per_unit`: further digits would only add bytes.
fn rounded(value: f64, per_unit: f64) -> f64 {
    (value * per_unit).round() / per_unit
}
