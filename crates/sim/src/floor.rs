//! Dark lines on the floor, and what reflectance sensors below the robot see of them.
//!
//! A sensor sees a spot; what share of it is dark grows from 0 to 1 across the edge of a line. Spot and voltages are those of
//! TCRT5000 modules by their data sheet (Vishay 83760) and usual circuit, not identified from recordings. Arrays such as
//! Pololu's QTR-RC give a time: the program charges a capacitor at the pin, which the reflected light discharges.

use rumbo_plant::contact::Pose;

/// Width of the spot \[m\]: the data sheet's working distance of 2.5 mm sees about that.
const SPOT_M: f64 = 0.004;
/// Voltages of an analogue module over a light and a dark floor \[V\].
pub const USUAL_V: [f64; 2] = [0.4, 4.4];
/// Times to discharge over a light and a dark floor \[us\]: "a few dozen microseconds" to "several milliseconds"
/// (Pololu, QTR-1RC).
const DISCHARGE_US: [f64; 2] = [120.0, 4_000.0];
/// Standard deviation of its voltage \[V\]: two counts of the converter.
pub(crate) const NOISE_V: f64 = 0.01;
/// A comparator switches this far beyond the middle.
const HYSTERESIS: f64 = 0.05;

/// A dark line.
#[derive(Clone, Debug, PartialEq)]
pub struct DarkLine {
    /// Its corners, in order \[m\].
    pub points_m: Vec<[f64; 2]>,
    /// Its width \[m\].
    pub width_m: f64,
}

impl DarkLine {
    /// Its length, back to its first point where it ends there \[m\]; `None` where it is open.
    #[must_use]
    pub fn lap_m(&self) -> Option<f64> {
        let pieces = self.points_m.windows(2);
        let lengths =
            pieces.map(|ends| libm::hypot(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]));
        (self.points_m.first() == self.points_m.last()).then(|| lengths.sum())
    }
}

/// What a reflectance sensor gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FloorReading {
    /// A level.
    Level,
    /// A voltage, over a light and over a dark floor \[V\].
    Volts([f64; 2]),
    /// The time for which the charged pin stays high.
    Discharge,
}

/// A reflectance sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct LineSensor {
    /// What the robot file calls it.
    pub name: String,
    /// Where it is on the robot, ahead of the wheels' axis and to the left \[m\].
    pub at_m: [f64; 2],
    /// The board's pin.
    pub pin: u8,
    /// What it gives.
    pub reading: FloorReading,
    /// A dark floor is high.
    pub dark_high: bool,
}

impl LineSensor {
    /// Where it is in the world \[m\].
    #[must_use]
    pub fn place(&self, pose: &Pose) -> [f64; 2] {
        pose.place(self.at_m)
    }

    /// The voltage of an analogue one, of what it gives over a light and over a dark floor.
    pub(crate) fn volts(&self, [light_v, dark_v]: [f64; 2], darkness: f64) -> f64 {
        let high = if self.dark_high {
            darkness
        } else {
            1.0 - darkness
        };
        light_v + high * (dark_v - light_v)
    }

    /// The level of another one, which was at a level before.
    pub(crate) fn level(&self, darkness: f64, before: bool) -> bool {
        let was_dark = before == self.dark_high;
        let edge = if was_dark {
            0.5 - HYSTERESIS
        } else {
            0.5 + HYSTERESIS
        };
        (darkness > edge) == self.dark_high
    }
}

/// How long a charged pin stays high \[us\]: the currents of the light and the dark share of the spot add.
pub(crate) fn discharge_us(darkness: f64) -> f64 {
    let [light_us, dark_us] = DISCHARGE_US;
    1.0 / ((1.0 - darkness) / light_us + darkness / dark_us)
}

/// The place on a line that is nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// The line's number.
    pub line: usize,
    /// Distance from its middle \[m\].
    pub distance_m: f64,
    /// Its width \[m\].
    pub width_m: f64,
    /// From its first point to there, along it \[m\].
    pub along_m: f64,
}

/// The nearest line of a point.
#[must_use]
pub fn nearest(lines: &[DarkLine], [x_m, y_m]: [f64; 2]) -> Option<Nearest> {
    let places = lines
        .iter()
        .enumerate()
        .flat_map(|(line, DarkLine { points_m, width_m })| {
            let mut before_m = 0.0;
            points_m.windows(2).map(move |ends| {
                let ([ax, ay], [bx, by]) = (ends[0], ends[1]);
                let (dx, dy) = (bx - ax, by - ay);
                let square = dx * dx + dy * dy;
                let share = ((x_m - ax) * dx + (y_m - ay) * dy) / square.max(1e-12);
                let share = share.clamp(0.0, 1.0);
                let (ex, ey) = (x_m - ax - share * dx, y_m - ay - share * dy);
                let length_m = libm::sqrt(square);
                let along_m = before_m + share * length_m;
                before_m += length_m;
                Nearest {
                    line,
                    distance_m: libm::sqrt(ex * ex + ey * ey),
                    width_m: *width_m,
                    along_m,
                }
            })
        });
    let from_edge = |place: &Nearest| place.distance_m - 0.5 * place.width_m;
    places.min_by(|one, other| from_edge(one).total_cmp(&from_edge(other)))
}

/// The dark share of a spot there, 0 to 1.
#[must_use]
pub fn darkness(lines: &[DarkLine], at_m: [f64; 2]) -> f64 {
    nearest(lines, at_m).map_or(0.0, |place| {
        (0.5 + (0.5 * place.width_m - place.distance_m) / SPOT_M).clamp(0.0, 1.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spot_is_dark_on_a_line_half_at_its_edge_and_light_beside_it() {
        let line = DarkLine {
            points_m: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]],
            width_m: 0.02,
        };
        let lines = [line];
        for (at_m, expected) in [
            ([0.5, 0.0], 1.0),
            ([0.5, 0.01], 0.5),
            ([0.5, 0.02], 0.0),
            ([1.01, 0.5], 0.5),
            ([-0.1, 0.0], 0.0),
        ] {
            assert!((darkness(&lines, at_m) - expected).abs() < 1e-9, "{at_m:?}");
        }
        assert_eq!(darkness(&[], [0.0, 0.0]), 0.0);
    }
}
