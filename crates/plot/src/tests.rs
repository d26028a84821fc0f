//! Ticks, thinning, gaps, legends, sheets.
#![allow(clippy::unwrap_used)]

use super::frame::{Frame, LEFT, LEGEND_ROW, legend, path, step, tick, ticks};
use super::*;

#[test]
fn ticks_are_round_numbers_within_the_axis() {
    let range = [-3.0, 47.0];
    let every = step(range, 7.0);
    assert_eq!(every, 10.0);
    assert_eq!(
        ticks(range, every).collect::<Vec<_>>(),
        [0.0, 10.0, 20.0, 30.0, 40.0]
    );
    let spanish = Words {
        comma: true,
        ..Words::default()
    };
    assert_eq!(tick(spanish, 0.25, 0.05), "0,25");
}

#[test]
fn a_single_spike_among_thousands_of_points_is_drawn() {
    let mut points: Points = (0..10_000).map(|n| (f64::from(n), 0.0)).collect();
    points[5_003].1 = 7.0;
    let frame = Frame {
        x: 0.0,
        y: 0.0,
        width: 600.0,
        height: 100.0,
        x_range: [0.0, 10_000.0],
        y_range: [0.0, 10.0],
    };
    let drawn = path(&frame, &points, false);
    assert!(drawn.contains(" 30.0"), "{drawn}");
    assert!(drawn.len() < 25_000, "{}", drawn.len());
}

#[test]
fn what_is_not_a_number_is_a_gap() {
    let frame = Frame {
        x: 0.0,
        y: 0.0,
        width: 10.0,
        height: 10.0,
        x_range: [0.0, 4.0],
        y_range: [0.0, 1.0],
    };
    let points = vec![
        (0.0, 0.0),
        (1.0, 1.0),
        (2.0, f64::NAN),
        (3.0, 1.0),
        (4.0, 0.0),
    ];
    let drawn = path(&frame, &points, false);
    assert_eq!(drawn.matches('M').count(), 2, "{drawn}");
}

#[test]
fn a_legend_with_many_names_takes_a_second_row_rather_than_leave_the_picture() {
    let names = [
        "a name of some length",
        "another name of some length",
        "a third one that is even longer",
        "the last",
    ];
    let curves: Vec<Curve> = names
        .iter()
        .map(|name| Curve::new(name, Ink::First, vec![(0.0, 0.0)]))
        .collect();
    let mut svg = String::new();
    assert_eq!(
        legend(&mut svg, &curves[..1], [LEFT, WIDTH], 0.0),
        LEGEND_ROW + 4.0
    );
    assert_eq!(
        legend(&mut svg, &curves, [LEFT, WIDTH], 0.0),
        2.0 * LEGEND_ROW + 4.0
    );
}

#[test]
fn of_many_runs_the_median_is_drawn_over_the_range_of_all() {
    let runs: Vec<Points> = [3.0, 1.0, 2.0]
        .into_iter()
        .map(|y| vec![(0.0, y), (1.0, y * y)])
        .collect();
    let curve = Curve::median("", Ink::First, &runs);
    assert_eq!(curve.points, [(0.0, 2.0), (1.0, 4.0)]);
    let Band { low, high } = curve.band.unwrap();
    assert_eq!(low, [(0.0, 1.0), (1.0, 1.0)]);
    assert_eq!(high, [(0.0, 3.0), (1.0, 9.0)]);
}

fn sheet() -> Sheet {
    let curve = Curve::new("speed", Ink::First, vec![(0.0, 0.0), (1.0, 50.0)]);
    let plot = Plot::over_time(vec![Panel::new("rpm", vec![curve])]);
    Sheet::new(1).with("A < B", plot.picture(Words::default(), WIDTH))
}

#[test]
fn a_sheet_needs_no_page_around_it() {
    let svg = sheet().svg();
    assert!(svg.contains("xmlns=") && svg.contains("A &lt; B") && svg.contains(">speed<"));
    assert!(!svg.contains("var("), "a variable without its colour");
}
