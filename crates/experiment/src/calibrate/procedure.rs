//! The sequence of movements, and the calibration computed from them.

use super::error::CalibrateError;
use super::fit::{self, LegFit, Measured, Steady};
use super::link::Link;
use super::station::Station;
use super::{Calibration, fit::mean};
use rumbo_control::mode::Movement;
use rumbo_control::params::ParamId;
use rumbo_control::rig::Rig;
use rumbo_control::{SonarId, Wheels};
use std::f64::consts::TAU;

/// Longest leg [m].
const LEG_M: f64 = 1.6;
/// Speeds of the legs in turn [rpm].
const SPEEDS_RPM: [f64; 3] = [60.0, 40.0, 80.0];
/// Distances of a wall to begin at, from the sonar [m].
const BESIDE_M: std::ops::Range<f64> = 0.18..0.9;
/// Headings to the wall beyond this are corrected before the next leg [rad]: 1 degree.
const ASKEW_RAD: f64 = 0.0175;
/// Legs to and fro before the turns, between them and at the end; whole turns in between.
const PAIRS: usize = 3;
/// Whole turns, counter-clockwise positive; a leg to and fro follows each. The first is short: the base is still poorly known.
const TURNS: [f64; 3] = [1.0, 3.0, -3.0];
/// Variance of a fitted parabola's curvature over that of the heading's change per distance, when the heading wanders.
const PARABOLA: f64 = 1.43;
/// A heading at the end of a fitted leg errs as much as slip does over this distance [m].
const HEADING_M: f64 = 0.4;
/// Standard deviation of the speed of sound about its parameter, relative: +-0.9 %, uniform.
const SOUND: f64 = 0.0052;
/// Standard deviation of the nominal mean radius, relative: each wheel +-0.5 %, uniform.
const MAKER: f64 = 0.002;

/// Calibrates a robot that stands beside a wall, along it, with free floor ahead. It is left disarmed, with the
/// parameters found; if it fails, stopped.
pub(super) async fn course(link: Link) -> Result<Calibration, CalibrateError> {
    let mut station = Station::new(link);
    let result = Course::drive(&mut station).await;
    if result.is_err() {
        station.stop().await;
    }
    result
}

/// A calibration in progress.
struct Course<'s> {
    station: &'s mut Station,
    side: SonarId,
    ahead_m: f64,
    radius_m: Wheels<f64>,
    base_m: f64,
    /// Parameters that it sets on its way, with their values before.
    before: Vec<(ParamId, f64)>,
    /// Heading to the wall where the last leg ended, to the left positive [rad].
    heading_rad: f64,
    legs: usize,
    /// Logarithm of the ratio of the radii of each leg, and its length.
    ratios: Vec<(f64, f64)>,
    /// Estimate of the base from each turn.
    bases: Vec<Base>,
    /// True distance over the odometry's of each forward leg.
    scales: Vec<(f64, f64)>,
    steady: Vec<Steady>,
}

impl<'s> Course<'s> {
    async fn drive(station: &'s mut Station) -> Result<Calibration, CalibrateError> {
        Self::begin(station).await?.run().await
    }

    async fn begin(station: &'s mut Station) -> Result<Self, CalibrateError> {
        station.wait(0.6).await?;
        if station.parameter(ParamId::Rig).await? != f64::from(Rig::Final as u8) {
            return Err(CalibrateError::WrongRig);
        }
        let radius_m = Wheels {
            left: station.parameter(ParamId::RadiusLeft).await?,
            right: station.parameter(ParamId::RadiusRight).await?,
        };
        let base_m = station.parameter(ParamId::Base).await?;
        let ahead_m = station.parameter(ParamId::SonarSideX).await?;
        let side = wall_side(station)?;
        Ok(Self {
            station,
            side,
            ahead_m,
            radius_m,
            base_m,
            before: vec![
                (ParamId::RadiusLeft, radius_m.left),
                (ParamId::RadiusRight, radius_m.right),
                (ParamId::Base, base_m),
            ],
            heading_rad: 0.0,
            legs: 0,
            ratios: Vec::new(),
            bases: Vec::new(),
            scales: Vec::new(),
            steady: Vec::new(),
        })
    }

    async fn run(mut self) -> Result<Calibration, CalibrateError> {
        let start_s = self.station.now_s();
        let before_m = 0.5 * (self.radius_m.left + self.radius_m.right);
        let dead_zone = [
            self.dead_zone(Movement::Forward).await?,
            self.dead_zone(Movement::Backward).await?,
        ];
        for _ in 0..PAIRS {
            self.straighten(self.heading_rad).await?;
            let (_, back) = self.leg_and_back().await?;
            self.heading_rad = back.end_rad;
        }
        for turns in TURNS {
            self.turn_and_compare(turns).await?;
        }
        let ratio = mean(&self.ratios).ok_or(CalibrateError::NotDetermined("the wheels' radii"))?;
        let scale = mean(&self.scales);
        let mut calibration = Calibration {
            ratio: Measured {
                value: ratio.value.exp(),
                error: ratio.error,
            },
            base_m: self.base(self.base_m),
            radius_m: scale.map(|scale| Measured {
                value: before_m * scale.value,
                error: before_m * scale.error.hypot(SOUND),
            }),
            radius_before_m: Measured {
                value: before_m,
                error: MAKER * before_m,
            },
            dead_zone,
            feedforward: fit::feedforward(&self.steady)?,
            duration_s: self.station.now_s() - start_s,
            way_m: self.ratios.iter().map(|(_, way_m)| way_m).sum(),
            before: Vec::new(),
        };
        for (id, value) in calibration.parameters() {
            let known = self.before.iter().find(|(known, _)| *known == id);
            let before = match known {
                Some((_, before)) => *before,
                None => self.station.parameter(id).await?,
            };
            calibration.before.push((id, before as f32));
            self.station.set_parameter(id, f64::from(value)).await?;
        }
        Ok(calibration)
    }

    /// Dead zone of both wheels; one breaks away before the other, so the robot then turns back.
    async fn dead_zone(
        &mut self,
        movement: Movement,
    ) -> Result<Wheels<Option<f64>>, CalibrateError> {
        let before_rad = self.station.last()?.heading_rad;
        let found = self.station.break_away(movement).await?;
        let turned_rad = self.station.last()?.heading_rad - before_rad;
        self.straighten(turned_rad).await?;
        Ok(found)
    }

    /// Turns back by a heading, unless it is too small to matter.
    async fn straighten(&mut self, heading_rad: f64) -> Result<(), CalibrateError> {
        if heading_rad.abs() > ASKEW_RAD {
            self.station.turn(-heading_rad).await?;
        }
        Ok(())
    }

    /// A leg along the wall and back; returns both fits, and records their estimates.
    async fn leg_and_back(&mut self) -> Result<(LegFit, LegFit), CalibrateError> {
        let speed_rad_s = SPEEDS_RPM[self.legs % SPEEDS_RPM.len()] * TAU / 60.0;
        self.legs += 1;
        let there = self.leg(LEG_M, speed_rad_s).await?;
        let back = self.leg(-there.way_m, speed_rad_s).await?;
        let ratio = self
            .ratios
            .iter()
            .map(|(ratio, way_m)| ratio * way_m)
            .sum::<f64>()
            / self.ratios.iter().map(|(_, way_m)| way_m).sum::<f64>();
        let mean_m = 0.5 * (self.radius_m.left + self.radius_m.right);
        let left_m = 2.0 * mean_m / (1.0 + ratio.exp());
        self.radius_m = Wheels {
            left: left_m,
            right: left_m * ratio.exp(),
        };
        self.station
            .set_parameter(ParamId::RadiusLeft, self.radius_m.left)
            .await?;
        self.station
            .set_parameter(ParamId::RadiusRight, self.radius_m.right)
            .await?;
        Ok((there, back))
    }

    async fn leg(&mut self, way_m: f64, speed_rad_s: f64) -> Result<LegFit, CalibrateError> {
        let mean_m = 0.5 * (self.radius_m.left + self.radius_m.right);
        let samples = self
            .station
            .leg(self.side, way_m, speed_rad_s, mean_m)
            .await?;
        let found = fit::leg(&samples, self.side, self.ahead_m)?;
        let forward = way_m > 0.0;
        self.steady.extend(fit::steady(&samples, forward));
        if forward {
            self.scales
                .extend(fit::way_scale(&samples).map(|scale| (scale, 1.0)));
        }
        let in_force = (self.radius_m.right / self.radius_m.left).ln();
        let ratio = in_force + found.curvature_rad_m * self.base_m;
        self.ratios.push((ratio, found.way_m));
        Ok(found)
    }

    /// The base from all turns so far. They are too few for a scatter: the error is that of the slip shown by the legs'
    /// scatter.
    fn base(&self, in_force_m: f64) -> Measured {
        let weight: f64 = self.bases.iter().map(Base::weight).sum();
        if weight == 0.0 {
            return Measured {
                value: in_force_m,
                error: f64::INFINITY,
            };
        }
        let of = |base: &Base| base.weight() / weight;
        let value: f64 = self.bases.iter().map(|base| of(base) * base.base_m).sum();
        let slip = mean(&self.ratios).map_or(0.0, |ratio| {
            let way_m: f64 = self.ratios.iter().map(|(_, way_m)| way_m).sum();
            (ratio.error / in_force_m).powi(2) * way_m / PARABOLA
        });
        let variance: f64 = self
            .bases
            .iter()
            .map(|base| of(base) * of(base) * base.variance(slip))
            .sum();
        Measured {
            value,
            error: value * variance.sqrt(),
        }
    }

    /// Whole turns between two legs: the base is what makes the odometry's turn the true one.
    async fn turn_and_compare(&mut self, turns: f64) -> Result<(), CalibrateError> {
        let before = self.heading_rad;
        let from = self.station.last()?;
        self.station.turn(TAU * turns - before).await?;
        let to = self.station.last()?;
        let (there, back) = self.leg_and_back().await?;
        let seen_rad = to.heading_rad - from.heading_rad;
        // A robot that has drifted drives back, and turns the shorter way to its next heading: a whole turn may be
        // missing.
        let turns = ((seen_rad + before) / TAU).round();
        let true_rad = TAU * turns + there.start_rad - before;
        if turns != 0.0 {
            let base_m = self.base_m * seen_rad / true_rad;
            self.bases.push(Base { base_m, turns });
        }
        self.base_m = self.base(self.base_m).value;
        self.station
            .set_parameter(ParamId::Base, self.base_m)
            .await?;
        self.heading_rad = back.end_rad;
        Ok(())
    }
}

/// Estimate of the base from a number of whole turns.
struct Base {
    base_m: f64,
    turns: f64,
}

impl Base {
    /// Weight: an error of the headings before and after counts for less the more turns are in between.
    fn weight(&self) -> f64 {
        self.turns * self.turns
    }

    /// Variance of the base, relative: slip along the wheels' arcs, and the two headings. `slip`: variance of the
    /// heading per metre.
    fn variance(&self, slip: f64) -> f64 {
        let turned_rad = TAU * self.turns;
        let way_m = 0.5 * self.base_m * turned_rad.abs();
        slip * (way_m + 2.0 * HEADING_M) / (turned_rad * turned_rad)
    }
}

/// The side sonar that sees a wall at a fitting distance, the nearer one if both do.
fn wall_side(station: &Station) -> Result<SonarId, CalibrateError> {
    let sample = station.last()?;
    let fitting = |sonar| {
        sample
            .range_m(sonar)
            .filter(|range_m| BESIDE_M.contains(range_m))
            .map(|range_m| (range_m, sonar))
    };
    let [left, right] = [SonarId::Left, SonarId::Right].map(fitting);
    match (left, right) {
        (Some(left), Some(right)) => Ok(if left.0 < right.0 { left.1 } else { right.1 }),
        (Some((_, sonar)), None) | (None, Some((_, sonar))) => Ok(sonar),
        (None, None) => {
            Err(CalibrateError::NoWall([0, 1].map(|index: usize| {
                sample.range_m[index].map(|range_m| range_m as f32)
            })))
        }
    }
}
