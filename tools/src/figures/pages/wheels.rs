//! Modes 5 and 6: the wheels' speeds, and straight on.

use super::*;

/// Settling times of mode 5's steps, and its ripple.
pub(super) const MODE_5: [Row; 5] = [
    row(
        "0 -> 60 rpm, within 3.2 rpm",
        "step1.settling_s",
        "s",
        "3.7 s",
    ),
    row("50 -> 100 rpm", "step3.settling_s", "s", "1.8 s"),
    row("0 -> -100 rpm", "step6.settling_s", "s", "5.3 s"),
    row("0 -> 40 rpm", "step9.settling_s", "s", "5.5 s"),
    row(
        "ripple at 60 rpm",
        "step1.ripple_rad_s",
        "rpm",
        "0.9 to 2.1 rpm",
    ),
];

pub(super) fn mode5() -> Result<Option<Made>, String> {
    let Some([baseline, ours]) = both("mode5", runs::BASELINE)? else {
        return Ok(None);
    };
    // Of a part only its own points are drawn: of all, too few would lie in it.
    let speed = |until_s: f64| {
        let median = |name, ink, runs: &Runs| {
            let mut speeds = runs.over_time(|sample| RPM * sample.wheel_rad_s[0]);
            for points in &mut speeds {
                points.retain(|(t_s, _)| *t_s < until_s);
            }
            Curve::median(name, ink, &speeds)
        };
        let curves = vec![
            reference(&ours.setup, RPM),
            median(REPORT, BASELINE, &baseline),
            median("ours", OURS, &ours),
        ];
        Panel::new("left wheel, rpm", curves)
    };
    let steps = Plot {
        x_range: Some([0.0, 10.5]),
        ..Plot::over_time(vec![speed(10.5).exactly(0.0, 75.0)])
    };
    let sheet = [
        ("Mode 5", Plot::over_time(vec![speed(f64::INFINITY)])),
        ("The steps 0 -> 60 -> 50 rpm", steps),
    ];
    let sheet = sheet.iter().fold(Sheet::new(1), |sheet, (title, plot)| {
        sheet.with(title, plot.picture(Words::default(), WIDTH))
    });
    let more = [
        row("ripple at 100 rpm", "step3.ripple_rad_s", "rpm", ""),
        row(
            "time between two settings of the PWM",
            "control_period_s",
            "ms",
            "41 ms",
        ),
    ];
    Ok(Some(Made {
        figures: vec![(
            "mode5",
            "Speed of the left wheel over time: ours is there within a third of a second",
            sheet.svg(),
        )],
        words: words(
            &[(REPORT, &baseline), ("ours", &ours)],
            "mode5",
            &[&MODE_5[..], &more].concat(),
        ),
    }))
}

pub(super) fn mode6() -> Result<Option<Made>, String> {
    let raw = Change {
        uncalibrated: true,
        ..runs::OURS
    };
    let (Some([baseline, ours]), Some(raw)) = (both("mode6", runs::BASELINE)?, runs("mode6", raw)?)
    else {
        return Ok(None);
    };
    let drift = |runs: &Runs| -> Ways {
        let in_cm = |(x_m, y_m): (f64, f64)| (x_m, 100.0 * y_m);
        ways(runs)
            .into_iter()
            .map(|way| way.into_iter().map(in_cm).collect())
            .collect()
    };
    let curves = vec![
        Curve::each(REPORT, BASELINE, &drift(&baseline)),
        Curve::each("ours, calibrated", OURS, &drift(&ours)),
    ];
    let plot = Plot {
        x: "way ahead, m".into(),
        x_range: None,
        panels: vec![Panel::new("drift to the left, cm", curves)],
    };
    let rows = [
        row(
            "to the side after 3 m",
            "after_3_m.sideways_m",
            "cm",
            "not measured",
        ),
        row(
            "heading after 3 m",
            "after_3_m.heading_rad",
            "deg",
            "not measured",
        ),
    ];
    Ok(Some(Made {
        figures: vec![(
            "mode6",
            "Sideways drift over the way ahead: ours stays within four centimetres",
            figure("Mode 6: drift from a straight line", &plot),
        )],
        words: words(
            &[
                (REPORT, &baseline),
                ("ours, `calibrated = false`", &raw),
                ("ours", &ours),
            ],
            "mode6",
            &rows,
        ),
    }))
}
