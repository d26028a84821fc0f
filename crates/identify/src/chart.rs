//! Charts as SVG and PNG: signals over time, of one run or with the range of all seeds, and maps with every way.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::FontStyle;

pub use plotters::chart::SeriesLabelPosition as Legend;

/// Points of a curve; what is not finite is a gap.
pub type Points = Vec<(f64, f64)>;
type Drawn<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

/// Most points of one curve: the eye sees no more, and the files stay small.
const MOST_POINTS: usize = 360;
/// The same of a curve that stands alone.
const MOST_OF_ONE: usize = 4_000;
/// Readable on a light and on a dark page.
const PAPER: RGBColor = RGBColor(0xfb, 0xfb, 0xf9);
const TEXT: RGBColor = RGBColor(0x33, 0x33, 0x33);
/// The first of the colour-blind-safe palette of Okabe and Ito: our program.
pub const OURS: RGBColor = RGBColor(0x00, 0x72, 0xb2);
/// The second: the report's program.
pub const BASELINE: RGBColor = RGBColor(0xd5, 0x5e, 0x00);
/// The third.
pub const THIRD: RGBColor = RGBColor(0x00, 0x9e, 0x73);
/// The whole palette, for curves that have no other order.
pub const PALETTE: [RGBColor; 7] = [
    OURS,
    BASELINE,
    THIRD,
    RGBColor(0xcc, 0x79, 0xa7),
    RGBColor(0xe6, 0x9f, 0x00),
    RGBColor(0x56, 0xb4, 0xe9),
    RGBColor(0x33, 0x33, 0x33),
];
const GIVEN: RGBColor = RGBColor(0x66, 0x66, 0x66);

/// What is drawn in one chart.
pub enum Curve<'a> {
    /// The median of all seeds, and between which values all of them are, as time goes on.
    Seeds {
        /// As in the legend.
        name: &'a str,
        /// Of the lines.
        colour: RGBColor,
        /// One of each seed.
        runs: Vec<Points>,
    },
    /// A curve that stands alone.
    Line {
        /// As in the legend.
        name: &'a str,
        /// Of the line.
        colour: RGBColor,
        /// In order.
        points: Points,
    },
    /// Every seed's own curve.
    Ways {
        /// As in the legend.
        name: &'a str,
        /// Of the lines.
        colour: RGBColor,
        /// One of each seed.
        runs: Vec<Points>,
    },
    /// What was asked for.
    Given {
        /// As in the legend.
        name: &'a str,
        /// In order.
        points: Points,
    },
    /// Something that stands there.
    Shape(Points),
}

/// One diagram.
pub struct Chart<'a> {
    /// Above it.
    pub title: &'a str,
    /// What the axis shows, and its unit.
    pub x: &'a str,
    /// The same of the other axis.
    pub y: &'a str,
    /// What the axis shows at most; else all there is.
    pub y_range: Option<[f64; 2]>,
    /// The same of the other axis.
    pub x_range: Option<[f64; 2]>,
    /// A metre is as long in x as in y.
    pub map: bool,
    /// Where the names of the curves stand.
    pub legend: Legend,
    /// What is drawn, the first below the others.
    pub curves: Vec<Curve<'a>>,
}

/// A signal over time in seconds.
#[must_use]
pub fn over_time<'a>(title: &'a str, y: &'a str, curves: Vec<Curve<'a>>) -> Chart<'a> {
    Chart {
        title,
        x: "time, s",
        y,
        y_range: None,
        x_range: None,
        map: false,
        legend: Legend::UpperRight,
        curves,
    }
}

/// A map in metres.
#[must_use]
pub fn map<'a>(title: &'a str, curves: Vec<Curve<'a>>) -> Chart<'a> {
    Chart {
        title,
        x: "x, m",
        y: "y, m",
        y_range: None,
        x_range: None,
        map: true,
        legend: Legend::UpperRight,
        curves,
    }
}

/// The charts below each other (`columns` 1) or beside each other, each of this size in pixels, as SVG.
///
/// # Errors
/// What the drawing library says.
pub fn svg(charts: &[Chart<'_>], columns: usize, size: (u32, u32)) -> Result<String, String> {
    let mut text = String::new();
    let whole = whole(charts, columns, size);
    {
        let area = SVGBackend::with_string(&mut text, whole).into_drawing_area();
        draw_all(&area, charts, columns, size).map_err(|error| error.to_string())?;
    }
    Ok(text)
}

/// The same as the bytes of a PNG.
///
/// # Errors
/// What the drawing library says.
pub fn png(charts: &[Chart<'_>], columns: usize, size: (u32, u32)) -> Result<Vec<u8>, String> {
    let (width, height) = whole(charts, columns, size);
    let mut pixels = vec![0; 3 * width as usize * height as usize];
    {
        let area = BitMapBackend::with_buffer(&mut pixels, (width, height)).into_drawing_area();
        draw_all(&area, charts, columns, size).map_err(|error| error.to_string())?;
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(&pixels))
        .map_err(|error| error.to_string())?;
    Ok(bytes)
}

fn whole(charts: &[Chart<'_>], columns: usize, size: (u32, u32)) -> (u32, u32) {
    let rows = charts.len().div_ceil(columns.max(1)).max(1);
    (size.0 * columns.max(1) as u32, size.1 * rows as u32)
}

fn draw_all<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    charts: &[Chart<'_>],
    columns: usize,
    size: (u32, u32),
) -> Drawn<B> {
    // The bytes are a font, so that registering them cannot fail; doing it again changes nothing.
    let _ =
        plotters::style::register_font("sans-serif", FontStyle::Normal, dejavu::sans::regular());
    let rows = charts.len().div_ceil(columns.max(1)).max(1);
    area.fill(&PAPER)?;
    for (part, chart) in area.split_evenly((rows, columns.max(1))).iter().zip(charts) {
        chart.draw(part, size)?;
    }
    area.present()
}

impl Chart<'_> {
    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>, size: (u32, u32)) -> Drawn<B> {
        let [x_range, y_range] = self.ranges(size);
        let font = |size: i32| ("sans-serif", size).into_font().color(&TEXT);
        let mut context = ChartBuilder::on(area)
            .caption(self.title, font(17))
            .margin(10)
            .x_label_area_size(38)
            .y_label_area_size(58)
            .build_cartesian_2d(x_range[0]..x_range[1], y_range[0]..y_range[1])?;
        context
            .configure_mesh()
            .x_desc(self.x)
            .y_desc(self.y)
            .axis_desc_style(font(14))
            .label_style(font(13))
            .x_label_formatter(&tick)
            .y_label_formatter(&tick)
            .bold_line_style(TEXT.mix(0.14))
            .light_line_style(TRANSPARENT)
            .axis_style(TEXT.mix(0.6))
            .draw()?;
        let mut named = false;
        for curve in &self.curves {
            let (name, style) = match curve {
                Curve::Shape(corners) => {
                    context.draw_series([Polygon::new(corners.clone(), GIVEN.mix(0.35))])?;
                    continue;
                }
                Curve::Seeds { name, colour, runs } => {
                    let band = Band::of(runs);
                    context.draw_series([Polygon::new(band.outline(y_range), colour.mix(0.2))])?;
                    let style = colour.stroke_width(2);
                    context.draw_series(
                        broken(&band.median).map(|part| PathElement::new(part, style)),
                    )?;
                    (name, style)
                }
                Curve::Ways { name, colour, runs } => {
                    let thin = colour.mix(0.55).stroke_width(1);
                    for points in runs {
                        context.draw_series(
                            broken(&within(fewer(points, MOST_POINTS), x_range, y_range))
                                .map(|part| PathElement::new(part, thin)),
                        )?;
                    }
                    (name, colour.stroke_width(2))
                }
                Curve::Line {
                    name,
                    colour,
                    points,
                } => {
                    // A wider line gets spikes at its sharp corners where it is drawn in pixels.
                    let style = colour.stroke_width(1);
                    let points = fewer(points, MOST_OF_ONE);
                    context.draw_series(
                        broken(&within(points, x_range, y_range))
                            .map(|part| PathElement::new(part, style)),
                    )?;
                    (name, style)
                }
                Curve::Given { name, points } => {
                    let style = GIVEN.stroke_width(1);
                    context.draw_series(DashedLineSeries::new(
                        points.iter().copied(),
                        6,
                        4,
                        style,
                    ))?;
                    (name, style)
                }
            };
            if !name.is_empty() {
                named = true;
                // A reference is dashed in its name as well.
                let gap = if matches!(curve, Curve::Given { .. }) {
                    4
                } else {
                    0
                };
                context
                    .draw_series(std::iter::empty::<PathElement<(f64, f64)>>())?
                    .label(*name)
                    .legend(move |(x, y)| {
                        EmptyElement::at((x, y))
                            + PathElement::new([(0, 0), (9 - gap / 2, 0)], style)
                            + PathElement::new([(9 + gap / 2, 0), (18, 0)], style)
                    });
            }
        }
        if named {
            context
                .configure_series_labels()
                .position(self.legend.clone())
                .label_font(font(13))
                .background_style(PAPER.mix(0.85))
                .border_style(TEXT.mix(0.3))
                .draw()?;
        }
        Ok(())
    }

    /// What both axes show.
    fn ranges(&self, size: (u32, u32)) -> [[f64; 2]; 2] {
        let mut points = Vec::new();
        for curve in &self.curves {
            match curve {
                Curve::Seeds { runs, .. } | Curve::Ways { runs, .. } => {
                    points.extend(runs.iter().flatten().copied());
                }
                Curve::Given { points: given, .. }
                | Curve::Line { points: given, .. }
                | Curve::Shape(given) => points.extend(given),
            }
        }
        let range = |fixed: Option<[f64; 2]>, of: fn(&(f64, f64)) -> f64| {
            fixed.unwrap_or_else(|| {
                let finite = || points.iter().map(of).filter(|value| value.is_finite());
                let (low, high) = (
                    finite().fold(f64::MAX, f64::min),
                    finite().fold(f64::MIN, f64::max),
                );
                let margin = 0.04 * (high - low).max(1e-3);
                [low - margin, high + margin]
            })
        };
        let [mut x, mut y] = [range(self.x_range, |p| p.0), range(self.y_range, |p| p.1)];
        if self.map {
            // What margins, title and labels leave: see `draw`.
            let free = [f64::from(size.0) - 78.0, f64::from(size.1) - 84.0];
            let pixel_m = ((x[1] - x[0]) / free[0]).max((y[1] - y[0]) / free[1]);
            for (axis, free) in [&mut x, &mut y].into_iter().zip(free) {
                let more = 0.5 * (pixel_m * free - (axis[1] - axis[0]));
                *axis = [axis[0] - more, axis[1] + more];
            }
        }
        [x, y]
    }
}

/// A label without the noise of binary fractions.
fn tick(value: &f64) -> String {
    format!("{:.2}", value + 0.0)
        .trim_end_matches('0')
        .trim_end_matches('.')
        .replace("-0", if *value < -0.004 { "-0" } else { "0" })
}

/// Median and range of all runs at the same times.
struct Band {
    median: Points,
    low: Points,
    high: Points,
}

impl Band {
    fn of(runs: &[Points]) -> Self {
        let mut band = Self {
            median: Vec::new(),
            low: Vec::new(),
            high: Vec::new(),
        };
        let length = runs.iter().map(Vec::len).min().unwrap_or(0);
        for index in (0..length).step_by(stride(length, MOST_POINTS)) {
            let at = runs[0][index].0;
            let mut values: Vec<f64> = runs.iter().map(|points| points[index].1).collect();
            values.sort_by(f64::total_cmp);
            band.median.push((at, values[values.len() / 2]));
            band.low.push((at, values[0]));
            band.high.push((at, values[values.len() - 1]));
        }
        band
    }

    /// The range as one outline, cut off at what is shown.
    fn outline(&self, [least, most]: [f64; 2]) -> Points {
        let there = self.high.iter();
        there
            .chain(self.low.iter().rev())
            .map(|&(x, y)| (x, y.clamp(least, most)))
            .collect()
    }
}

fn stride(length: usize, most: usize) -> usize {
    length.div_ceil(most).max(1)
}

fn fewer(points: &Points, most: usize) -> Points {
    points
        .iter()
        .copied()
        .step_by(stride(points.len(), most))
        .collect()
}

/// What lies outside of the chart is no value: drawn, it would be a line along the border.
fn within(points: Points, x_range: [f64; 2], y_range: [f64; 2]) -> Points {
    let inside = |[least, most]: [f64; 2], value| (least..=most).contains(&value);
    let seen = |(x, y)| inside(x_range, x) && inside(y_range, y);
    let mark = |point: (f64, f64)| (point.0, if seen(point) { point.1 } else { f64::NAN });
    points.into_iter().map(mark).collect()
}

/// The parts of a curve between values that are none.
fn broken(points: &Points) -> impl Iterator<Item = Points> + '_ {
    points
        .split(|(_, y)| !y.is_finite())
        .filter(|part| !part.is_empty())
        .map(<[(f64, f64)]>::to_vec)
}
