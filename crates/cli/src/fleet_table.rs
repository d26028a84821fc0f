//! The metrics of several robots in one world as tables: a column for each robot, a row for each pair.

use crate::output::in_words;
use rumbo_experiment::compare::median;
use rumbo_experiment::files::Setup;
use std::collections::BTreeMap;

/// Values of each metric, one for each run.
type Values<'a> = BTreeMap<&'a str, Vec<f64>>;
/// Rows of cells.
type Table = Vec<Vec<String>>;

/// Takes the metrics of single robots and of pairs out of `values`, but for those with limits, and puts them into tables:
/// the value of one run, the median of several. No tables where a robot is alone.
pub(crate) fn take(setup: &Setup, values: &mut Values<'_>) -> Vec<Table> {
    let robots = setup.fleet.iter();
    let robots: Vec<&str> = robots.map(|robot| robot.scenario.name.as_str()).collect();
    let (mut of_robots, mut of_pairs) = (Cells::default(), Cells::default());
    let limits = &setup.scenario.limits;
    values.retain(|metric, values| {
        let Some((whose, bare)) = metric
            .split_once('.')
            .filter(|_| !limits.contains_key(*metric))
        else {
            return true;
        };
        let value = in_words(median(values));
        if robots.contains(&whose) {
            of_robots.put(bare, whose, value);
        } else if whose
            .split_once('-')
            .is_some_and(|(one, other)| robots.contains(&one) && robots.contains(&other))
        {
            of_pairs.put(whose, bare, value);
        } else {
            return true;
        }
        false
    });
    let pairs = ["closest_m", "contacts", "contact_speed_m_s"];
    [of_robots.table(&robots), of_pairs.table(&pairs)]
        .into_iter()
        .flatten()
        .collect()
}

/// A table's cells by row and column.
#[derive(Default)]
struct Cells(BTreeMap<String, BTreeMap<String, String>>);

impl Cells {
    fn put(&mut self, row: &str, column: &str, value: String) {
        let row = self.0.entry(row.to_owned()).or_default();
        row.insert(column.to_owned(), value);
    }

    /// `None` if it is empty.
    fn table(self, columns: &[&str]) -> Option<Table> {
        let mut head = vec![String::new()];
        head.extend(columns.iter().map(ToString::to_string));
        let rows = self.0.into_iter().map(|(name, mut cells)| {
            let mut row = vec![name];
            row.extend(
                columns
                    .iter()
                    .map(|column| cells.remove(*column).unwrap_or_default()),
            );
            row
        });
        let table: Table = std::iter::once(head).chain(rows).collect();
        (table.len() > 1).then_some(table)
    }
}
