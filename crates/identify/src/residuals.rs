//! What is left between a recorded run and its simulation, in standard deviations.

use crate::log::{DriveLog, RobotProgram, Seen};
use crate::replay::{Correct, Predicted, Replay};
use crate::row::LogRow;
use crate::wall;

/// Wheel speed error that counts as one standard deviation, rad/s: 10 rpm over the whole run, 1.7 rpm half a second ahead:
/// the prediction tells more, since the floor's disturbances have less time to add up.
const WHOLE_SD_RAD_S: f64 = 1.0;
const AHEAD_SD_RAD_S: f64 = 0.18;
/// The same for a distance to a wall, over a stretch of some seconds, m.
pub(crate) const RANGE_SD_M: f64 = 0.006;
/// Errors in turns on the spot count as this much smaller: the castor and the tyres scrub in ways not modelled.
const TURNING: f64 = 3.0;
/// Errors closer in time than this say the same thing once, s.
const CORRELATION_S: f64 = 0.2;
/// Every so manieth row starts a prediction half a second ahead.
const AHEAD_EVERY: usize = 4;
/// Logs of our program: a speed's error that counts as one standard deviation in the air, where only the edges' spacing
/// and the time of a change of duty are uncertain, and on the floor, which is rough; rad/s.
const AIR_SD_RAD_S: f64 = 0.04;
const FLOOR_SD_RAD_S: f64 = 0.25;
/// They are predicted over this time from an observed state, one stretch after the other.
const SPAN_MS: usize = 1_000;
/// When the duty changed is known to one of four ticks, s.
const CHANGE_SD_S: f64 = 0.011;
/// Faster than this a wheel that shows no edge for 40 ms cannot be: 16.4 mrad in that time.
const STANDING_RAD_S: f64 = 0.5;
/// Slower ones have too few edges, rad/s. A limit that slow turns reach would leave out those that the floor happens to
/// slow down, and so take it for an easier one.
const SLOWEST_RAD_S: f64 = 1.0;
/// In so short a time an observed state follows the measured speeds.
const SETTLED_MS: usize = 200;
/// Errors closer in time than this may have one cause, such as the floor at a place: they are independent beyond, ms.
const BLOCK_MS: usize = 2_000;

/// Residuals and the block of each.
#[derive(Default)]
pub(crate) struct Residuals {
    /// Each in standard deviations.
    pub(crate) values: Vec<f64>,
    /// The block of each; `None` for what is believed beforehand.
    pub(crate) blocks: Vec<Option<usize>>,
    /// The first block of the present run.
    first: usize,
}

impl Residuals {
    /// A residual of what is believed beforehand.
    pub(crate) fn believe(&mut self, residual: f64) {
        self.values.push(residual);
        self.blocks.push(None);
    }

    /// The residuals that follow are of another run.
    pub(crate) fn begin_run(&mut self) {
        self.first = self
            .blocks
            .iter()
            .flatten()
            .max()
            .map_or(0, |last| last + 1);
    }

    fn push(&mut self, row: &LogRow, residual: f64) {
        self.values.push(residual);
        self.blocks.push(Some(self.first + row.at_ms / BLOCK_MS));
    }
}

/// The residuals of a run on its replay.
pub(crate) fn run_residuals(log: &DriveLog, replay: &Replay<'_>, residuals: &mut Residuals) {
    let weight = (log.duration_ms() as f64 / log.rows.len() as f64 / 1000.0 / CORRELATION_S)
        .min(1.0)
        .sqrt();
    match (log.seen, log.program) {
        (Seen::FrontRange | Seen::SidePair, _) => {
            let errors_m = wall::errors_m(log, &replay.whole(), RANGE_SD_M);
            let per_row = (errors_m.len() / log.rows.len()).max(1);
            for (index, error_m) in errors_m.iter().enumerate() {
                let row = &log.rows[index / per_row];
                residuals.push(row, weight * robust(error_m / RANGE_SD_M));
            }
        }
        (Seen::Speeds, RobotProgram::Rumbo) => timed_residuals(log, replay, weight, residuals),
        (Seen::Speeds, _) => counted_residuals(log, replay, weight, residuals),
    }
}

/// Speeds as the original counts them: over the whole run, and half a second ahead.
fn counted_residuals(log: &DriveLog, replay: &Replay<'_>, weight: f64, residuals: &mut Residuals) {
    let of_row = |row: &LogRow| match row.is_turning() {
        true => weight / TURNING,
        false => weight,
    };
    for (simulated, row) in replay.speeds(&replay.whole()).iter().zip(&log.rows) {
        for (simulated, measured) in simulated.iter().zip(row.speed_rad_s) {
            let error = (simulated - measured) / WHOLE_SD_RAD_S;
            residuals.push(row, of_row(row) * robust(error));
        }
    }
    let observed = replay.observe(Correct::Speeds);
    for (index, observed) in observed.iter().enumerate().step_by(AHEAD_EVERY) {
        if let Some((target, predicted)) = replay.ahead(index, observed) {
            let row = &log.rows[target];
            for (speed, measured) in predicted.iter().zip(row.speed_rad_s) {
                let error = (speed - measured) / AHEAD_SD_RAD_S;
                let weight = of_row(row) * (AHEAD_EVERY as f64).sqrt();
                residuals.push(row, weight * robust(error));
            }
        }
    }
}

/// Speeds by the times of edges: in the air over the whole stretch, on the floor a second at a time, from the state
/// observed at its beginning.
fn timed_residuals(log: &DriveLog, replay: &Replay<'_>, weight: f64, residuals: &mut Residuals) {
    let segments = segments(log);
    if !log.on_floor {
        let series = replay.series(&replay.whole());
        return compare(log, &segments, &series, weight / AIR_SD_RAD_S, residuals);
    }
    let observed = replay.observe(Correct::Speeds);
    let mut from = settled(log, replay.row_after(0, SETTLED_MS));
    while let Some(index) = from {
        from = settled(log, replay.row_after(index, SPAN_MS));
        let last = from.unwrap_or(log.rows.len() - 1);
        let series = replay.span(index, &observed[index], last);
        compare(log, &segments, &series, weight / FLOOR_SD_RAD_S, residuals);
    }
}

/// The number of the segment of constant duty that each row is in.
fn segments(log: &DriveLog) -> Vec<usize> {
    let mut segment = 0;
    let mut before = None;
    let rows = log.rows.iter().map(|row| {
        if before
            .replace(row.duty)
            .is_some_and(|duty| duty != row.duty)
        {
            segment += 1;
        }
        segment
    });
    rows.collect()
}

/// The first row from here on whose duty has been constant for so long that the observed state follows; any row where
/// the duty always changes.
fn settled(log: &DriveLog, from: Option<usize>) -> Option<usize> {
    const ROWS: usize = 6;
    let from = from?;
    let constant = |row: &usize| {
        let rows = &log.rows[row.saturating_sub(ROWS)..=*row];
        rows.iter().all(|each| each.duty == rows[0].duty)
    };
    let until = (from + 2 * SPAN_MS / 40).min(log.rows.len());
    Some((from..until).find(constant).unwrap_or(from))
}

/// A speed's error, rad/s, and its slope, rad/s2; none where there are too few edges for a speed. A wheel counts as
/// standing that turns so slowly that no edge comes for long.
fn error(predicted: &Predicted, row: &LogRow, wheel: usize) -> Option<(f64, f64)> {
    let (predicted_rad_s, measured_rad_s) = (predicted.speed_rad_s[wheel], row.speed_rad_s[wheel]);
    if row.edgeless[wheel] {
        None
    } else if measured_rad_s == 0.0 {
        let moving_rad_s = (predicted_rad_s.abs() - STANDING_RAD_S).max(0.0);
        Some((moving_rad_s.copysign(predicted_rad_s), 0.0))
    } else if measured_rad_s.abs() < SLOWEST_RAD_S {
        None
    } else {
        let error_rad_s = predicted_rad_s - measured_rad_s;
        Some((error_rad_s, predicted.slope_rad_s2[wheel]))
    }
}

/// Residuals of predicted rows. When exactly the duty changed no frame says: for each change the shift is taken out that
/// explains most, as far as it is believable.
fn compare(
    log: &DriveLog,
    segments: &[usize],
    series: &[Predicted],
    weight: f64,
    residuals: &mut Residuals,
) {
    for segment in series.chunk_by(|a, b| segments[a.row] == segments[b.row]) {
        let first = segments.partition_point(|each| *each < segments[segment[0].row]);
        // The frame that shows a change first is partly from before.
        let rows = segment.iter().filter(|predicted| predicted.row > first);
        let errors = rows.clone().flat_map(|predicted| {
            let row = &log.rows[predicted.row];
            let of = move |wheel| Some((row, error(predicted, row, wheel)?));
            [of(0), of(1)].into_iter().flatten()
        });
        let (mut explained, mut slopes) = (0.0, 0.0);
        for (_, (error, slope)) in errors.clone() {
            explained += weight * weight * slope * error;
            slopes += weight * weight * slope * slope;
        }
        let shift_s = explained / (slopes + CHANGE_SD_S.powi(-2));
        for (row, (error, slope)) in errors {
            residuals.push(row, robust(weight * (error - slope * shift_s)));
        }
        if segment.iter().any(|predicted| predicted.row > first) {
            let row = &log.rows[segment[0].row];
            residuals.push(row, shift_s / CHANGE_SD_S);
        }
    }
}

/// Pseudo-Huber: quadratic below five standard deviations, linear far above.
fn robust(residual: f64) -> f64 {
    const BEND: f64 = 5.0;
    let relative = residual / BEND;
    (BEND * (2.0 * ((1.0 + relative * relative).sqrt() - 1.0)).sqrt()).copysign(residual)
}
