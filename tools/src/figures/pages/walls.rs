//! Modes 1 to 4: before a wall and along one.

use super::*;

pub(super) fn mode1() -> Result<Option<Made>, String> {
    let Some([baseline, ours]) = both("mode1", runs::BASELINE)? else {
        return Ok(None);
    };
    let mut distance = vec![
        Curve::median(REPORT, BASELINE, &baseline.ahead_cm()),
        Curve::median("ours", OURS, &ours.ahead_cm()),
    ];
    distance.insert(0, reference(&ours.setup, 100.0));
    let distance = Panel::new("distance to the wall, cm", distance);
    let plot = Plot::over_time(vec![distance, pwm(&baseline, &ours)]);
    let rows = [
        row("107 -> 30 cm, within 5 %", "step1.settling_s", "s", "3.0 s"),
        row("overshoot", "step1.overshoot_m", "cm", "0.6 cm"),
        row("steady error", "step1.steady_error_m", "cm", "0.02 cm"),
        row("30 -> 50 cm, within 5 %", "step2.settling_s", "s", "1.2 s"),
        row("overshoot", "step2.overshoot_m", "cm", ""),
        row(
            "driven against its motion",
            "reverse_drive_rad_s",
            "rad/s",
            "",
        ),
        row(
            "time between two settings of the PWM",
            "control_period_s",
            "ms",
            "65 ms",
        ),
    ];
    Ok(Some(Made {
        figures: vec![(
            "mode1",
            "Distance to the wall and PWM over time: ours reaches each setpoint sooner, without overshoot",
            figure("Mode 1", &plot),
        )],
        words: words(&[(REPORT, &baseline), ("ours", &ours)], "mode1", &rows),
    }))
}

/// Distance of the middle of the front pair from the wall at x = 1.2 m.
fn ahead_m(sample: &TruthSample) -> f64 {
    1.2 - sample.x_m - 0.13 * sample.heading_rad.cos()
}

fn mode2_plot(baseline: &Runs, ours: &Runs) -> Plot {
    let mut distance = signal(baseline, ours, |sample| 100.0 * ahead_m(sample));
    distance.insert(0, reference(&ours.setup, 100.0));
    let angle = signal(baseline, ours, |sample| DEG * sample.heading_rad);
    Plot::over_time(vec![
        Panel::new("distance to the wall, cm", distance).exactly(0.0, 125.0),
        Panel::new("angle to its normal, deg", angle).exactly(-20.0, 40.0),
    ])
}

pub(super) fn mode2() -> Result<Option<Made>, String> {
    let (Some([baseline, ours]), Some(turning)) = (
        both("mode2", runs::BASELINE)?,
        runs("mode2-final", runs::OURS)?,
    ) else {
        return Ok(None);
    };
    let rows = [
        row("119 -> 30 cm, within 5 %", "step1.settling_s", "s", "3.4 s"),
        row("steady error", "step1.steady_error_m", "cm", "0.64 cm"),
        row(
            "angle to the wall at rest",
            "step1.angle_rad",
            "deg",
            "not measured",
        ),
        row(
            "50 -> 15 cm, within 2 cm",
            "step3.within_2cm_s",
            "s",
            "5.5 s",
        ),
        row("overshoot", "step3.overshoot_m", "cm", "5.7 cm"),
        row("contacts", "contacts", "", "0"),
    ];
    Ok(Some(Made {
        figures: vec![(
            "mode2",
            "Distance and angle to the wall over time: ours stands square at every reference",
            figure("Mode 2", &mode2_plot(&baseline, &ours)),
        )],
        words: words(
            &[
                (REPORT, &baseline),
                ("ours, one sonar on the servo (`mode2-final`)", &turning),
                ("ours", &ours),
            ],
            "mode2",
            &rows,
        ),
    }))
}

/// Distance of the middle of the side pair from the wall at y = 0.65 m.
fn beside_m(sample: &TruthSample) -> f64 {
    let (sin, cos) = sample.heading_rad.sin_cos();
    0.65 - sample.y_m - 0.03 * sin - 0.075 * cos
}

pub(super) fn mode3() -> Result<Option<Made>, String> {
    let Some([baseline, ours]) = both("mode3", runs::BASELINE)? else {
        return Ok(None);
    };
    let curves = signal(&baseline, &ours, |sample| {
        100.0 * (beside_m(sample) - 0.575)
    });
    let plot = Plot::over_time(vec![Panel::new("error of the distance, cm", curves)]);
    let rows = [
        row("distance error, rms", "distance_rms_m", "cm", "1.2 cm"),
        row("worst", "distance_worst_m", "cm", "4.6 cm"),
        Row {
            least_is_worst: true,
            ..row("slowest half second", "cruise_m_s", "m/s", "")
        },
        row("contacts", "contacts", "", "0"),
    ];
    Ok(Some(Made {
        figures: vec![(
            "mode3",
            "Error of the distance to the wall over time: ours stays within half a centimetre",
            figure("Mode 3: distance to the wall", &plot),
        )],
        words: words(&[(REPORT, &baseline), ("ours", &ours)], "mode3", &rows),
    }))
}

/// Times of mode 4's steps.
pub(super) const MODE_4: [Row; 3] = [
    row(
        "59 -> 50 cm, within 2 cm",
        "step1.within_2cm_s",
        "s",
        "7.1 s",
    ),
    row("50 -> 30 cm", "step2.within_2cm_s", "s", "6.3 s"),
    row("30 -> 40 cm", "step3.within_2cm_s", "s", "9.0 s"),
];

pub(super) fn mode4() -> Result<Option<Made>, String> {
    let Some([baseline, ours]) = both("mode4", SLOW_STEPS)? else {
        return Ok(None);
    };
    let panel = |name, ink, runs: &Runs| {
        let distance = runs.over_time(|sample| 100.0 * beside_m(sample));
        let distance = Curve::median(name, ink, &distance);
        let curves = vec![reference(&runs.setup, 100.0), distance];
        Panel::new("distance, cm", curves).exactly(20.0, 70.0)
    };
    let plot = Plot {
        x_range: Some([-1.0, 31.0]),
        ..Plot::over_time(vec![
            panel(REPORT, BASELINE, &baseline),
            panel("ours, its references sooner", OURS, &ours),
        ])
    };
    let ripple = [
        row(
            "swing at 50 cm, standard deviation",
            "step1.ripple_m",
            "cm",
            "",
        ),
        row("swing at 30 cm", "step2.ripple_m", "cm", ""),
        row("overshoot of 50 -> 30 cm", "step2.overshoot_m", "cm", ""),
        row("contacts", "contacts", "", "0"),
    ];
    Ok(Some(Made {
        figures: vec![(
            "mode4",
            "Distance to the wall over time: ours takes each step without swinging",
            figure("Mode 4: distance to the wall", &plot),
        )],
        words: words(
            &[(REPORT, &baseline), ("ours", &ours)],
            "mode4",
            &[&MODE_4[..], &ripple].concat(),
        ),
    }))
}
