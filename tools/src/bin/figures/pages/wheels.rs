//! Modes 5 and 6: the wheels' speeds, and straight on.

use super::*;

pub(super) fn mode5() -> Result<Option<Made>, String> {
    let Some([baseline, ours]) = both("mode5", runs::BASELINE)? else {
        return Ok(None);
    };
    let speed = || {
        let mut curves = signal(&baseline, &ours, |sample, _| RPM * sample.wheel_rad_s[0]);
        curves.insert(0, reference(&ours.setup, RPM));
        curves
    };
    let mut charts = [
        over_time("Mode 5: speed of the left wheel", "rpm", speed()),
        over_time("The steps 0 -> 60 -> 50 rpm", "rpm", speed()),
    ];
    charts[0].legend = Legend::LowerLeft;
    charts[1].legend = Legend::LowerRight;
    charts[1].x_range = Some([0.0, 10.5]);
    charts[1].y_range = Some([0.0, 75.0]);
    // Only the visible part: otherwise the few points of a curve would all lie outside.
    for curve in &mut charts[1].curves {
        if let Curve::Seeds { runs, .. } = curve {
            for points in runs {
                points.retain(|(t_s, _)| *t_s < 10.5);
            }
        }
        if let Curve::Given { points, .. } = curve {
            points.retain(|(t_s, _)| *t_s < 10.5);
        }
    }
    let rows = [
        row(
            "0 -> 60 rpm, within 3.2 rpm",
            "step1.settling_s",
            1.0,
            "s",
            "3.7 s",
        ),
        row("50 -> 100 rpm", "step3.settling_s", 1.0, "s", "1.8 s"),
        row("0 -> -100 rpm", "step6.settling_s", 1.0, "s", "5.3 s"),
        row("0 -> 40 rpm", "step9.settling_s", 1.0, "s", "5.5 s"),
        row(
            "ripple at 60 rpm",
            "step1.ripple_rad_s",
            RPM,
            "rpm",
            "0.9 to 2.1 rpm",
        ),
        row("ripple at 100 rpm", "step3.ripple_rad_s", RPM, "rpm", ""),
        row(
            "time between two settings of the PWM",
            "control_period_s",
            1000.0,
            "ms",
            "41 ms",
        ),
    ];
    Ok(Some(Made {
        figures: vec![(
            "mode5",
            "Speed of the left wheel over time: ours is there within a third of a second",
            svg(&charts, 1, WIDE)?,
        )],
        words: words(&[(REPORT, &baseline), ("ours", &ours)], "mode5", &rows),
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
    let chart = Chart {
        x: "way ahead, m",
        legend: Legend::UpperLeft,
        ..over_time(
            "Mode 6: drift to the left of a straight line",
            "cm",
            vec![
                Curve::Ways {
                    name: REPORT,
                    colour: BASELINE,
                    runs: drift(&baseline),
                },
                Curve::Ways {
                    name: "ours, calibrated",
                    colour: OURS,
                    runs: drift(&ours),
                },
            ],
        )
    };
    let rows = [
        row(
            "to the side after 3 m",
            "after_3_m.sideways_m",
            100.0,
            "cm",
            "not measured",
        ),
        row(
            "heading after 3 m",
            "after_3_m.heading_rad",
            DEG,
            "deg",
            "not measured",
        ),
    ];
    Ok(Some(Made {
        figures: vec![(
            "mode6",
            "Sideways drift over the way ahead: ours stays within four centimetres",
            svg(&[chart], 1, WIDE)?,
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
