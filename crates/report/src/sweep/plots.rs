//! Its plots: each metric over each parameter, heat maps over pairs of them, all at once.

use super::{PASS, Page, value_of};
use crate::summary::{figure, heading};
use crate::text::{Language, Text, escape, put, word};
use rumbo_control::params::ParamId;
use rumbo_experiment::sweep::{Axis, Design, MetricSpread};
use rumbo_plant::params::Params;
use rumbo_plot::{Band, Curve, Heat, Ink, Panel, Parallel, Plot, Points};

const OVER_EACH: Text = word("over-each-parameter");
const BANDS: Text = word("bands-note");
const OVER_PAIRS: Text = word("over-pairs");
const PAIRS_NOTE: Text = word("pairs-note");
const ALL_AT_ONCE: Text = word("all-parameters-at-once");
const LINES_NOTE: Text = word("lines-note");
const OTHERS: Text = word("other-metrics");
const MEDIAN: Text = word("median");

/// Bins of an axis whose points are drawn.
const BINS: usize = 10;
/// Most heat maps.
const MOST_PAIRS: usize = 6;
/// Most lines of parallel coordinates.
const MOST_LINES: usize = 600;

impl Page<'_> {
    /// Each metric over each parameter.
    pub(super) fn curves(&self, language: Language) -> String {
        let limited = self.limited();
        let mut html = heading(OVER_EACH.of(language));
        put(
            &mut html,
            format_args!("<p>{}</p>\n", escape(BANDS.of(language))),
        );
        for (index, axis) in self.sweep.plan.axes.iter().enumerate() {
            let groups = self.groups(index);
            let pass = groups.iter().map(|(x, points)| {
                let shares = points.iter().map(|point| self.sweep.pass_share(*point));
                (*x, 100.0 * shares.sum::<f64>() / points.len().max(1) as f64)
            });
            let pass = Curve::new("", Ink::Third, pass.collect());
            let label = format!("{}, %", PASS.of(language));
            let mut panels = vec![Panel::new(&label, vec![pass]).exactly(-4.0, 104.0)];
            panels.extend(
                limited
                    .iter()
                    .map(|metric| self.panel(language, metric, &groups)),
            );
            let plot = |panels| Plot {
                x: axis_name(axis),
                x_range: None,
                panels,
            };
            html += &figure(&plot(panels).svg(language), &axis.name);
            let others = self.sweep.metrics(self.scenario);
            let others = others
                .into_iter()
                .filter(|metric| !limited.contains(metric) && self.varies(metric));
            let others: Vec<Panel> = others
                .map(|metric| self.panel(language, metric, &groups))
                .collect();
            if !others.is_empty() {
                put(
                    &mut html,
                    format_args!(
                        "<details><summary>{}</summary>\n{}</details>\n",
                        escape(OTHERS.of(language)),
                        figure(&plot(others).svg(language), &axis.name)
                    ),
                );
            }
        }
        html
    }

    /// The points at each value of an axis, or in each of a few ranges of it where they are drawn.
    fn groups(&self, axis: usize) -> Vec<(f64, Vec<usize>)> {
        let plan = &self.sweep.plan;
        let place = |value: f64| match plan.axes[axis].is_log() {
            true => value.log10(),
            false => value,
        };
        let mut points: Vec<(f64, usize)> = (0..self.sweep.points_done())
            .map(|point| (place(plan.points[point][axis]), point))
            .collect();
        points.sort_by(|one, other| one.0.total_cmp(&other.0));
        let mut groups: Vec<(f64, Vec<usize>)> = Vec::new();
        for (x, point) in &points {
            match groups.last_mut() {
                Some((last, members)) if last == x => members.push(*point),
                _ => groups.push((*x, vec![*point])),
            }
        }
        if plan.design == Design::Grid || plan.axes.len() == 1 || groups.len() <= 2 * BINS {
            return groups;
        }
        let chunks = points.chunks(points.len().div_ceil(BINS));
        chunks
            .map(|chunk| {
                let x = chunk.iter().map(|(x, _)| x).sum::<f64>() / chunk.len() as f64;
                (x, chunk.iter().map(|(_, point)| *point).collect())
            })
            .collect()
    }

    fn panel(&self, language: Language, metric: &str, groups: &[(f64, Vec<usize>)]) -> Panel {
        let factor = self.shown(language, metric).factor;
        let (mut median, mut band) = (Points::new(), Band::default());
        for (x, points) in groups {
            let Some(spread) = self.sweep.spread_over(points, metric) else {
                continue;
            };
            let MetricSpread {
                median: middle,
                low,
                high,
            } = spread;
            median.push((*x, factor * middle));
            if low.is_finite() && high.is_finite() {
                band.low.push((*x, factor * low));
                band.high.push((*x, factor * high));
            }
        }
        let curve = Curve {
            band: Some(band),
            ..Curve::new("", Ink::First, median)
        };
        Panel::new(&self.name(language, metric), vec![curve])
    }

    /// Heat maps over pairs of parameters, of a grid.
    pub(super) fn heats(&self, language: Language) -> String {
        let axes = &self.sweep.plan.axes;
        if self.sweep.plan.design != Design::Grid {
            return String::new();
        }
        let grids: Vec<Option<Vec<f64>>> = axes.iter().map(Axis::grid).collect();
        let mut html = String::new();
        let pairs = (0..axes.len()).flat_map(|x| (x + 1..axes.len()).map(move |y| (x, y)));
        for (x, y) in pairs.take(MOST_PAIRS) {
            let (Some(columns), Some(rows)) = (&grids[x], &grids[y]) else {
                continue;
            };
            let pass = self.pass_varies().then_some(None);
            for metric in pass.into_iter().chain([Some(self.by)]) {
                html += &self.heat(language, (x, columns), (y, rows), metric);
            }
        }
        if html.is_empty() {
            return html;
        }
        let note = escape(PAIRS_NOTE.of(language));
        heading(OVER_PAIRS.of(language)) + &format!("<p>{note}</p>\n") + &html
    }

    fn heat(
        &self,
        language: Language,
        (x, columns): (usize, &[f64]),
        (y, rows): (usize, &[f64]),
        metric: Option<&str>,
    ) -> String {
        let plan = &self.sweep.plan;
        let [columns, rows] = [columns, rows].map(|values| {
            let mut values = values.to_vec();
            values.sort_by(f64::total_cmp);
            values
        });
        let mut cells = vec![vec![Vec::new(); columns.len()]; rows.len()];
        for point in 0..self.sweep.points_done() {
            let place = |values: &[f64], axis: usize| {
                values
                    .iter()
                    .position(|value| *value == plan.points[point][axis])
            };
            if let (Some(column), Some(row)) = (place(&columns, x), place(&rows, y)) {
                cells[row][column].push(point);
            }
        }
        let value = |points: &Vec<usize>| match metric {
            None => {
                let shares = points.iter().map(|point| self.sweep.pass_share(*point));
                100.0 * shares.sum::<f64>() / points.len() as f64
            }
            Some(metric) => {
                let factor = self.shown(language, metric).factor;
                let spread = self.sweep.spread_over(points, metric);
                spread.map_or(f64::NAN, |spread| factor * spread.median)
            }
        };
        let name = match metric {
            None => format!("{}, %", PASS.of(language)),
            Some(metric) => format!("{} ({})", self.name(language, metric), MEDIAN.of(language)),
        };
        let labels = |axis: usize, values: &[f64]| {
            let label = |value: &f64| value_of(language, &plan.axes[axis], *value);
            values.iter().map(label).collect()
        };
        let heat = Heat {
            x: plan.axes[x].name.clone(),
            y: plan.axes[y].name.clone(),
            value: name.clone(),
            columns: labels(x, &columns),
            rows: labels(y, &rows),
            values: cells
                .iter()
                .map(|row| row.iter().map(value).collect())
                .collect(),
        };
        figure(&heat.svg(language), &name)
    }

    /// All parameters and the metrics that matter at once.
    pub(super) fn parallel(&self, language: Language, ranked: &[usize]) -> String {
        let axes = &self.sweep.plan.axes;
        if axes.len() < 2 || ranked.len() < 2 {
            return String::new();
        }
        let others = self.limited().into_iter().filter(|name| *name != self.by);
        let metrics: Vec<&str> = others.take(2).chain([self.by]).collect();
        let pass_varies = self.pass_varies();
        let line = |point: &usize| {
            let values = self.sweep.plan.points[*point].iter().zip(axes);
            let mut line: Vec<f64> = values
                .map(|(value, axis)| if axis.is_log() { value.log10() } else { *value })
                .collect();
            if pass_varies {
                line.push(100.0 * self.sweep.pass_share(*point));
            }
            line.extend(metrics.iter().map(|metric| {
                let factor = self.shown(language, metric).factor;
                let spread = self.sweep.spread(*point, metric);
                spread.map_or(f64::NAN, |spread| factor * spread.median)
            }));
            line
        };
        let mut names: Vec<String> = axes.iter().map(axis_name).collect();
        if pass_varies {
            names.push(format!("{}, %", PASS.of(language)));
        }
        names.extend(metrics.iter().map(|metric| self.name(language, metric)));
        // The best lie above the others.
        let every = ranked.len().div_ceil(MOST_LINES).max(1);
        let points = ranked.iter().step_by(every).rev().map(line);
        let plot = Parallel {
            colour: names.len() - 1,
            axes: names,
            points: points.collect(),
        };
        let note = LINES_NOTE.with(language, &[("metric", &self.name(language, self.by))]);
        heading(ALL_AT_ONCE.of(language))
            + &format!("<p>{}</p>\n", escape(&note))
            + &figure(&plot.svg(language), ALL_AT_ONCE.of(language))
    }
}

/// The parameter with its unit.
fn axis_name(axis: &Axis) -> String {
    let limits = Params::limits();
    let plant = limits.iter().find(|limit| limit.key == axis.name);
    let unit = match (plant, ParamId::from_name(&axis.name)) {
        (Some(limit), _) => limit.unit,
        (None, Some(id)) => id.unit(),
        (None, None) => "",
    };
    let name = match unit {
        "" => axis.name.clone(),
        unit => format!("{}, {unit}", axis.name),
    };
    if axis.is_log() {
        format!("log₁₀ {name}")
    } else {
        name
    }
}
