//! Where a recorded value lies among those of drawn robots.

use crate::fidelity::figures::Figure;

pub(crate) struct Place {
    /// In order; what never happened is infinite and comes last.
    values: Vec<f64>,
    pub(crate) recorded: f64,
}

/// A median this near to the recorded value, relative, is near.
const NEAR: f64 = 0.2;

impl Place {
    pub(crate) fn new(values: &[f64], recorded: f64) -> Self {
        let mut values = values.to_vec();
        values.sort_by(f64::total_cmp);
        Self { values, recorded }
    }

    /// The value that this share of the robots stays below.
    pub(crate) fn quantile(&self, share: f64) -> f64 {
        let last = self.values.len().saturating_sub(1);
        let index = (share * last as f64).round() as usize;
        self.values.get(index).copied().unwrap_or(f64::NAN)
    }

    /// Share of the robots below the recorded value; equal ones count half.
    fn share_below(&self) -> f64 {
        let count = |less: fn(&f64, &f64) -> bool| {
            self.values
                .iter()
                .filter(|value| less(value, &self.recorded))
                .count() as f64
        };
        (count(f64::lt) + count(f64::le)) / (2.0 * self.values.len() as f64)
    }

    pub(crate) fn within_ninety(&self) -> bool {
        (0.05..=0.95).contains(&self.share_below())
    }

    pub(crate) fn within_fifty(&self) -> bool {
        (0.25..=0.75).contains(&self.share_below())
    }

    /// The median is within 20 % of the recorded value.
    pub(crate) fn is_near(&self) -> bool {
        (self.quantile(0.5) / self.recorded - 1.0).abs() <= NEAR
    }

    /// A row of the table, with its end.
    pub(crate) fn row(&self, run: &str, figure: &Figure, day: Option<&Self>) -> String {
        let [low, median, high] = [0.05, 0.5, 0.95].map(|share| shown(self.quantile(share)));
        let yes = |within| if within { "yes" } else { "no" };
        let day = day.map_or_else(String::new, |day| {
            let far = if day.is_near() { "" } else { " (far)" };
            format!("{}{far}", shown(day.quantile(0.5)))
        });
        format!(
            "| {run} | {} | {} {} | {median} ({low} to {high}) | {:.0} % | {} | {} | {day} |\n",
            figure.what,
            shown(self.recorded),
            figure.unit,
            100.0 * self.share_below(),
            yes(self.within_ninety()),
            yes(self.within_fifty()),
        )
    }
}

fn shown(value: f64) -> String {
    if value.is_infinite() {
        "never".to_owned()
    } else {
        format!(
            "{value:.prec$}",
            prec = if value.abs() < 10.0 { 2 } else { 1 }
        )
    }
}
