//! The report's program compared with its recorded robot.

use super::*;

/// Medians of its runs beside the recorded ones.
pub(super) fn beside() -> Result<Option<Made>, String> {
    let experiments: [(&str, &str, Change, &[Row]); 9] = [
        (
            "mode 1",
            "mode1",
            runs::BASELINE,
            &[
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
                row(
                    "period of the loop",
                    "control_period_s",
                    1000.0,
                    "ms",
                    "65 ms",
                ),
            ],
        ),
        (
            "mode 2",
            "mode2",
            runs::BASELINE,
            &[row(
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
            &[
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
        (
            "mode 4",
            "mode4",
            SLOW_STEPS,
            &[
                row(
                    "59 -> 50 cm, within 2 cm",
                    "step1.within_2cm_s",
                    1.0,
                    "s",
                    "7.1 s",
                ),
                row("50 -> 30 cm", "step2.within_2cm_s", 1.0, "s", "6.3 s"),
                row("30 -> 40 cm", "step3.within_2cm_s", 1.0, "s", "9.0 s"),
            ],
        ),
        (
            "mode 5",
            "mode5",
            runs::BASELINE,
            &[
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
                row(
                    "period of the loop",
                    "control_period_s",
                    1000.0,
                    "ms",
                    "41 ms",
                ),
            ],
        ),
        (
            "mode 7",
            "mode7",
            SLOW_SQUARE,
            &[
                row("once round", "finish_s", 1.0, "s", "30 s"),
                row(
                    "off the square by odometry, worst",
                    "odometry_worst_m",
                    100.0,
                    "cm",
                    "6 cm",
                ),
                row("the same, rms", "odometry_rms_m", 100.0, "cm", "2.4 cm"),
                row(
                    "period of the loop",
                    "control_period_s",
                    1000.0,
                    "ms",
                    "67 ms",
                ),
            ],
        ),
        (
            "mode 8, goals",
            "mode8-goals",
            SLOW_MISSION,
            &[
                row("all four", "total_time_s", 1.0, "s", "32 s"),
                row("way", "path_m", 1.0, "m", "4.3 m"),
            ],
        ),
        (
            "mode 8, lane",
            "mode8-lane",
            SLOW_MISSION,
            &[
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
            &[
                row("time", "total_time_s", 1.0, "s", "73.6 s"),
                row("way", "path_m", 1.0, "m", "4.16 m"),
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
                spread(row, &here),
            );
        }
    }
    Ok(Some(Made {
        figures: Vec::new(),
        words,
    }))
}
