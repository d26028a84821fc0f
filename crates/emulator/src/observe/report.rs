//! A profile as tables for people.

use super::profile::{FunctionUse, InterruptUse, Profile};

/// Cycles in a second and in a microsecond at the boards' 16 MHz.
const HERTZ: f64 = 16e6;
const CYCLES_PER_US: f64 = 16.0;
/// Most functions that are listed.
const FUNCTIONS: usize = 20;

impl Profile {
    /// Summary: time asleep, the most expensive functions, every interrupt.
    pub fn report(&self) -> String {
        let all = self.cycles().max(1) as f64;
        let percent = |cycles: u64| format!("{:.1}", 100.0 * cycles as f64 / all);
        let mut text = format!(
            "{} cycles ({:.3} s), {} % asleep\n",
            self.cycles(),
            self.cycles() as f64 / HERTZ,
            percent(self.cycles_asleep())
        );
        let mut rows =
            vec![["function", "calls", "every ms", "own %", "with calls %"].map(String::from)];
        rows.extend(self.costliest(FUNCTIONS).into_iter().map(
            |FunctionUse {
                 name,
                 calls,
                 own,
                 total,
             }| {
                let every_ms = match calls {
                    0 => "-".to_owned(),
                    calls => format!("{:.3}", 1e3 * all / HERTZ / calls as f64),
                };
                [
                    name,
                    calls.to_string(),
                    every_ms,
                    percent(own),
                    percent(total),
                ]
            },
        ));
        text += &table(&rows);
        let interrupts = self.interrupts();
        if !interrupts.is_empty() {
            let titles = [
                "interrupt",
                "count",
                "per s",
                "total %",
                "mean",
                "longest",
                "worst latency",
            ];
            let mut rows = vec![titles.map(String::from)];
            rows.extend(interrupts.iter().map(|interrupt| {
                let InterruptUse {
                    vector,
                    count,
                    total,
                    longest,
                    worst_latency,
                } = *interrupt;
                [
                    self.vector_name(vector).to_owned(),
                    count.to_string(),
                    format!("{:.1}", count as f64 * HERTZ / all),
                    percent(total),
                    time(interrupt.mean()),
                    time(longest),
                    time(worst_latency),
                ]
            }));
            text += &table(&rows);
        }
        text
    }
}

/// Cycles and microseconds.
fn time(cycles: u64) -> String {
    format!("{cycles} ({:.1} us)", cycles as f64 / CYCLES_PER_US)
}

/// The first column to the left, the others to the right.
fn table<const COLUMNS: usize>(rows: &[[String; COLUMNS]]) -> String {
    let width = |column: usize| {
        rows.iter()
            .map(|row| row[column].chars().count())
            .max()
            .unwrap_or(0)
    };
    let mut text = String::new();
    for row in rows {
        for (column, cell) in row.iter().enumerate() {
            let width = width(column);
            text += &match column {
                0 => format!("  {cell:<width$}"),
                _ => format!("  {cell:>width$}"),
            };
        }
        text += "\n";
    }
    text
}
