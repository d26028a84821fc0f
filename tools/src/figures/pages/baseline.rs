//! The report's program compared with its recorded robot.

use super::*;

/// The period of the control loop.
const fn period(real: &'static str) -> Row {
    row("period of the loop", "control_period_s", 1000.0, "ms", real)
}

/// Medians of its runs beside the recorded ones.
pub(super) fn beside() -> Result<Option<Made>, String> {
    let experiments: [(&str, &str, Change, Vec<Row>); 9] = [
        (
            "mode 1",
            "mode1",
            runs::BASELINE,
            vec![
                row(
                    "107 -> 30 cm, within 5 %",
                    "step1.settling_s",
                    1.0,
                    "s",
                    "3.0 s",
                ),
                row(
                    "30 -> 50 cm, within 5 %",
                    "step2.settling_s",
                    1.0,
                    "s",
                    "1.2 s",
                ),
                row("overshoot", "step1.overshoot_m", 100.0, "cm", "0.6 cm"),
                period("65 ms"),
            ],
        ),
        (
            "mode 2",
            "mode2",
            runs::BASELINE,
            vec![row(
                "119 -> 30 cm, within 5 %",
                "step1.settling_s",
                1.0,
                "s",
                "3.4 s",
            )],
        ),
        (
            "mode 3",
            "mode3",
            runs::BASELINE,
            vec![
                row(
                    "distance error, rms",
                    "distance_rms_m",
                    100.0,
                    "cm",
                    "1.2 cm",
                ),
                row(
                    "distance error, worst",
                    "distance_worst_m",
                    100.0,
                    "cm",
                    "4.6 cm",
                ),
            ],
        ),
        ("mode 4", "mode4", SLOW_STEPS, walls::MODE_4.to_vec()),
        (
            "mode 5",
            "mode5",
            runs::BASELINE,
            [&wheels::MODE_5[..], &[period("41 ms")]].concat(),
        ),
        (
            "mode 7",
            "mode7",
            SLOW_SQUARE,
            vec![
                row("once round", "finish_s", 1.0, "s", "30 s"),
                row(
                    "off the square by odometry, worst",
                    "odometry_worst_m",
                    100.0,
                    "cm",
                    "6 cm",
                ),
                row("the same, rms", "odometry_rms_m", 100.0, "cm", "2.4 cm"),
                period("67 ms"),
            ],
        ),
        (
            "mode 8, goals",
            "mode8-goals",
            SLOW_MISSION,
            vec![
                row("all four", "total_time_s", 1.0, "s", "32 s"),
                row("path", "path_m", 1.0, "m", "4.3 m"),
            ],
        ),
        (
            "mode 8, lane",
            "mode8-lane",
            SLOW_MISSION,
            vec![
                row("time", "finish_s", 1.0, "s", "57.8 s"),
                Row {
                    least_is_worst: true,
                    ..row("straights", "straights", 1.0, "", "4")
                },
            ],
        ),
        (
            "mode 8, obstacles",
            "mode8-obstacles",
            SLOW_MISSION,
            vec![
                row("time", "total_time_s", 1.0, "s", "73.6 s"),
                row("path", "path_m", 1.0, "m", "4.16 m"),
            ],
        ),
    ];
    let mut words = String::from(
        "| experiment | | the report's robot, one run | its program here |\n|---|---|---|---|\n",
    );
    for (name, scenario, change, rows) in experiments {
        let Some(here) = runs(scenario, change)? else {
            return Ok(None);
        };
        for row in rows {
            words += &format!(
                "| {name} | {} | {} | {} |\n",
                row.what,
                row.real,
                spread(&row, &here),
            );
        }
    }
    Ok(Some(Made {
        figures: Vec::new(),
        words,
    }))
}
