//! Measured against simulated, as SVG and PNG: speeds of both wheels or the distance ahead, and the PWM below.

use crate::error::IdentifyError;
use crate::log::{DriveLog, Seen};
use crate::replay::{Nuisance, Replay};
use crate::score::start_range_m;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::FontStyle;
use rumbo_plant::params::Params;
use std::path::Path;

const SIZE: (u32, u32) = (1200, 900);
const RPM_PER_RAD_S: f64 = 30.0 / std::f64::consts::PI;
/// Of the colour-blind-safe palette of Okabe and Ito.
const MEASURED: RGBColor = RGBColor(0x00, 0x72, 0xb2);
const SIMULATED: RGBColor = RGBColor(0xd5, 0x5e, 0x00);

type Series = Vec<(f64, f64)>;

/// One diagram: measured and simulated over time in seconds; without the second, a signal given.
struct Panel {
    caption: String,
    unit: &'static str,
    measured: Series,
    simulated: Option<Series>,
}

/// A recorded run against its simulation.
pub struct Plot<'a> {
    title: &'a str,
    panels: Vec<Panel>,
}

impl<'a> Plot<'a> {
    /// The run of a log, with these parameters.
    pub fn new(log: &'a DriveLog, params: &Params, nuisance: Nuisance) -> Self {
        Self {
            title: &log.name,
            panels: panels(log, params, nuisance),
        }
    }

    /// Draws it into a file: as an image if its name ends in `png`, else as SVG.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn draw(&self, path: &Path) -> Result<(), IdentifyError> {
        // Registering the same font again changes nothing; the bytes are a font, so that it cannot fail.
        let _ = plotters::style::register_font(
            "sans-serif",
            FontStyle::Normal,
            dejavu::sans::regular(),
        );
        let wrong = |cause: String| IdentifyError::Plot(format!("{}: {cause}", path.display()));
        if path.extension().is_some_and(|ending| ending == "png") {
            let area = BitMapBackend::new(path, SIZE).into_drawing_area();
            draw(&area, self.title, &self.panels).map_err(|cause| wrong(cause.to_string()))
        } else {
            let area = SVGBackend::new(path, SIZE).into_drawing_area();
            draw(&area, self.title, &self.panels).map_err(|cause| wrong(cause.to_string()))
        }
    }
}

fn panels(log: &DriveLog, params: &Params, nuisance: Nuisance) -> Vec<Panel> {
    let replay = Replay::new(log, params, nuisance);
    let trace = replay.whole();
    let over_time = |values: Vec<f64>| -> Series {
        log.rows
            .iter()
            .map(|row| row.at_ms as f64 / 1000.0)
            .zip(values)
            .collect()
    };
    let mut panels = Vec::new();
    if log.seen == Seen::FrontRange {
        let start_m = start_range_m(log, &trace);
        panels.push(Panel {
            caption: "distance to the wall".into(),
            unit: "cm",
            measured: over_time(log.rows.iter().map(|row| 100.0 * row.range_m).collect()),
            simulated: Some(over_time(
                log.rows
                    .iter()
                    .map(|row| 100.0 * (start_m - trace.way_m[row.at_ms]))
                    .collect(),
            )),
        });
    } else {
        let speeds = replay.speeds(&trace);
        for (i, side) in ["left", "right"].into_iter().enumerate() {
            panels.push(Panel {
                caption: format!("{side} wheel"),
                unit: "rpm",
                measured: over_time(
                    log.rows
                        .iter()
                        .map(|row| RPM_PER_RAD_S * row.speed_rad_s[i])
                        .collect(),
                ),
                simulated: Some(over_time(
                    speeds
                        .iter()
                        .map(|speed| RPM_PER_RAD_S * speed[i])
                        .collect(),
                )),
            });
        }
    }
    panels.push(Panel {
        caption: "PWM applied, mean of both wheels".into(),
        unit: "of 255",
        measured: over_time(
            log.rows
                .iter()
                .map(|row| 127.5 * (row.duty[0] + row.duty[1]))
                .collect(),
        ),
        simulated: None,
    });
    panels
}

type Drawn<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

fn draw<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    title: &str,
    panels: &[Panel],
) -> Drawn<B> {
    area.fill(&WHITE)?;
    let area = area.titled(title, ("sans-serif", 24))?;
    for (part, panel) in area.split_evenly((panels.len(), 1)).iter().zip(panels) {
        draw_panel(part, panel)?;
    }
    area.present()
}

fn draw_panel<B: DrawingBackend>(area: &DrawingArea<B, Shift>, panel: &Panel) -> Drawn<B> {
    let all = || {
        panel
            .measured
            .iter()
            .chain(panel.simulated.iter().flatten())
    };
    let end_s = all().map(|&(at_s, _)| at_s).fold(1e-3, f64::max);
    let low = all().map(|&(_, value)| value).fold(0.0, f64::min);
    let high = all().map(|&(_, value)| value).fold(1.0, f64::max);
    let margin = 0.05 * (high - low);
    let mut chart = ChartBuilder::on(area)
        .caption(&panel.caption, ("sans-serif", 18))
        .margin(8)
        .x_label_area_size(36)
        .y_label_area_size(56)
        .build_cartesian_2d(0.0..end_s, low - margin..high + margin)?;
    chart
        .configure_mesh()
        .x_desc("time, s")
        .y_desc(panel.unit)
        .light_line_style(WHITE)
        .draw()?;
    let measured = chart.draw_series(LineSeries::new(panel.measured.iter().copied(), MEASURED))?;
    if let Some(simulated) = &panel.simulated {
        measured
            .label("measured")
            .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], MEASURED));
        chart
            .draw_series(LineSeries::new(
                simulated.iter().copied(),
                SIMULATED.stroke_width(2),
            ))?
            .label("simulated")
            .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], SIMULATED.stroke_width(2)));
        chart
            .configure_series_labels()
            .background_style(WHITE.mix(0.8))
            .border_style(BLACK.mix(0.3))
            .draw()?;
    }
    Ok(())
}
