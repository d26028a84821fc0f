//! Variants of a scenario against each other: the same seeds, so that each difference is of one robot with itself.
//!
//! Two runs of a seed share robot, floor and noise. What is left of their difference is the variant's, and few seeds
//! show what unpaired runs would hide.

use crate::files::{FileError, Setup};
use crate::metrics::{Metrics, more_is_better};
use crate::run::run_each;
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::borrow::Cow;
use std::collections::BTreeSet;

/// Share of such intervals that hold the true mean difference.
const CONFIDENCE: f64 = 0.95;

/// A variant and its runs, in the order of the seeds.
#[derive(Clone, Debug)]
pub struct Variant {
    /// What makes it one.
    pub name: String,
    /// Whether each run passes.
    pub passes: Vec<bool>,
    /// The metrics of each run.
    pub metrics: Vec<Metrics>,
}

/// Runs all variants with the same seeds, on all cores; `done` is called after each run, `go_on` in between, and both end
/// the rest with their error.
///
/// # Errors
/// The first error, of a setup, of `go_on` or of `done`.
pub fn run_variants<E: From<FileError>>(
    variants: &[(String, Setup)],
    seeds: &[u64],
    go_on: impl Fn() -> Result<(), E>,
    mut done: impl FnMut() -> Result<(), E>,
) -> Result<Vec<Variant>, E> {
    let mut all: Vec<Variant> = variants
        .iter()
        .map(|(name, _)| Variant {
            name: name.clone(),
            passes: Vec::new(),
            metrics: Vec::new(),
        })
        .collect();
    let count = variants.len();
    let job = |index: usize| {
        let (setup, seed) = (&variants[index % count].1, seeds[index / count]);
        Ok((Cow::Borrowed(setup), seed))
    };
    run_each(
        rayon::current_num_threads(),
        count * seeds.len(),
        job,
        |_, result| (result.pass, result.metrics),
        go_on,
        |index, (pass, metrics)| {
            let variant = &mut all[index % count];
            variant.passes.push(pass);
            variant.metrics.push(metrics);
            done()
        },
    )?;
    Ok(all)
}

/// A metric of two variants, pair by pair.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// The metric.
    pub metric: String,
    /// Pairs in which both have a value.
    pub pairs: usize,
    /// Pairs in which what is measured never happened in the first variant, and in the second.
    pub never: [usize; 2],
    /// The medians of both variants over these pairs.
    pub medians: [f64; 2],
    /// Mean of second minus first.
    pub mean: f64,
    /// The 95 % confidence interval of the mean, from Student's t distribution; not a number for fewer than two pairs.
    pub interval: [f64; 2],
    /// The mean over the standard deviation of the differences (Cohen's d of paired values); not a number where the
    /// differences are all the same.
    pub effect: f64,
    /// Share of the pairs in which the second is better.
    pub better: f64,
    /// Share of the pairs in which the second is worse.
    pub worse: f64,
}

impl Difference {
    /// Whether zero lies outside the interval.
    #[must_use]
    pub fn is_clear(&self) -> bool {
        self.interval[0] > 0.0 || self.interval[1] < 0.0
    }

    /// Whether it is no difference at all, in no pair.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.better == 0.0 && self.worse == 0.0 && self.never[0] == self.never[1]
    }
}

/// The differences of all metrics that both have.
#[must_use]
pub fn differences(first: &Variant, second: &Variant) -> Vec<Difference> {
    let names = |variant: &Variant| -> BTreeSet<String> {
        variant
            .metrics
            .iter()
            .flat_map(|run| run.keys().cloned())
            .collect()
    };
    let both = names(first);
    let names = names(second);
    let both = both.intersection(&names);
    both.map(|metric| difference(metric, first, second))
        .collect()
}

fn difference(metric: &str, first: &Variant, second: &Variant) -> Difference {
    let value = |run: &Metrics| run.get(metric).copied().unwrap_or(f64::NAN);
    let all = first.metrics.iter().zip(&second.metrics);
    let all: Vec<[f64; 2]> = all.map(|(one, other)| [value(one), value(other)]).collect();
    let pairs = all
        .iter()
        .filter(|pair| pair.iter().all(|value| value.is_finite()));
    let pairs: Vec<[f64; 2]> = pairs.copied().collect();
    let never = [0, 1].map(|of| all.iter().filter(|pair| pair[of].is_nan()).count());
    let count = pairs.len() as f64;
    let differences: Vec<f64> = pairs.iter().map(|[one, other]| other - one).collect();
    let mean = differences.iter().sum::<f64>() / count;
    let squares = differences
        .iter()
        .map(|difference| (difference - mean).powi(2));
    let deviation = (squares.sum::<f64>() / (count - 1.0)).sqrt();
    let half = quantile(pairs.len()) * deviation / count.sqrt();
    let sign = if more_is_better(metric) { 1.0 } else { -1.0 };
    let share = |of: &dyn Fn(f64) -> bool| {
        let found = differences
            .iter()
            .filter(|difference| of(sign * **difference));
        found.count() as f64 / count.max(1.0)
    };
    Difference {
        metric: metric.to_owned(),
        pairs: pairs.len(),
        never,
        medians: [0, 1].map(|of| median(&pairs.iter().map(|pair| pair[of]).collect::<Vec<_>>())),
        mean,
        interval: [mean - half, mean + half],
        effect: match deviation > 0.0 {
            true => mean / deviation,
            false => f64::NAN,
        },
        better: share(&|gain| gain > 0.0),
        worse: share(&|gain| gain < 0.0),
    }
}

/// Half the interval in standard errors.
fn quantile(pairs: usize) -> f64 {
    let freedom = pairs.saturating_sub(1) as f64;
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |student| {
        student.inverse_cdf(0.5 + 0.5 * CONFIDENCE)
    })
}

/// The middle value; of an even number, half way between the two in the middle.
#[must_use]
pub fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => f64::NAN,
        count if count % 2 == 1 => values[middle],
        _ => 0.5 * (values[middle - 1] + values[middle]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::{Library, Overrides};

    fn variant(name: &str, values: &[f64]) -> Variant {
        let metrics = values
            .iter()
            .map(|value| Metrics::from([("time_s".to_owned(), *value)]));
        Variant {
            name: name.into(),
            passes: vec![true; values.len()],
            metrics: metrics.collect(),
        }
    }

    #[test]
    fn the_median_of_an_even_number_is_half_way_between_two() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), 2.5);
        assert!(median(&[1.0, f64::NAN]).is_nan() && median(&[]).is_nan());
    }

    #[test]
    fn the_interval_is_student_s_and_never_is_counted_apart() {
        let first = variant("a", &[1.0, 2.0, 3.0, 4.0, f64::NAN]);
        let second = variant("b", &[1.5, 2.4, 3.6, 4.5, 9.0]);
        let found = differences(&first, &second);
        assert_eq!(found.len(), 1);
        let found = &found[0];
        assert_eq!((found.pairs, found.never), (4, [1, 0]));
        assert_eq!(found.medians, [2.5, 3.0]);
        assert!((found.mean - 0.5).abs() < 1e-12);
        // Deviation 0.08165, t of three degrees of freedom 3.1824.
        assert!((found.interval[1] - found.mean - 0.129_923).abs() < 1e-5);
        assert!((found.effect - 6.1237).abs() < 1e-3);
        assert_eq!((found.better, found.worse), (0.0, 1.0));
        assert!(found.is_clear() && !found.is_none());
    }

    #[test]
    fn one_pair_and_equal_pairs_claim_nothing() {
        let one = differences(&variant("a", &[1.0]), &variant("b", &[2.0]));
        assert!(one[0].interval[0].is_nan() && !one[0].is_clear());
        let same = differences(&variant("a", &[1.0, 2.0]), &variant("b", &[1.0, 2.0]));
        assert!(same[0].is_none() && !same[0].is_clear() && same[0].effect.is_nan());
    }

    #[test]
    fn a_pair_has_one_robot_and_a_variant_that_changes_nothing_differs_in_nothing() {
        let library = Library::new();
        let setup = |kv: Option<f64>| {
            let overrides = Overrides {
                parameters: kv.map(|kv| ("kv".into(), kv)).into_iter().collect(),
                ..Overrides::default()
            };
            library.setup("mode5", &overrides).unwrap()
        };
        let variants = [
            ("as it is".to_owned(), setup(None)),
            ("again".to_owned(), setup(None)),
            ("less".to_owned(), setup(Some(0.0))),
        ];
        let runs =
            run_variants(&variants, &[1, 2, 3], || Ok(()), || Ok::<(), FileError>(())).unwrap();
        assert!(
            differences(&runs[0], &runs[1])
                .iter()
                .all(Difference::is_none)
        );
        let less = differences(&runs[0], &runs[2]);
        let rise = less
            .iter()
            .find(|one| one.metric == "step1.rise_s")
            .unwrap();
        assert_eq!(rise.worse, 1.0);
    }
}
