//! Which figures of the report's robot are compared, and with which runs of its program.

/// A figure of a run.
pub(crate) struct Figure {
    pub(crate) what: &'static str,
    /// A metric of the run; `measured.stepN` is the settling of a step by the speeds that the program measured.
    pub(crate) metric: &'static str,
    pub(crate) unit: &'static str,
    /// What the recorded run shows, or the report says where no recording is left; NaN where it is read from the run.
    pub(crate) recorded: f64,
}

/// A run of the report's robot, and the scenario that repeats it.
pub(crate) struct Experiment {
    pub(crate) name: &'static str,
    pub(crate) scenario: &'static str,
    /// Its recording, from which battery and floor of that day are read.
    pub(crate) recording: Option<&'static str>,
    /// Longer than the scenario, for a slow program [s].
    pub(crate) duration_s: Option<f64>,
    /// Commands from the third on come this many times later.
    pub(crate) later: f64,
    pub(crate) figures: &'static [Figure],
}

impl Figure {
    /// Which step's settling it is, by the speeds that the program measured, counted from 0.
    pub(crate) fn measured_step(&self) -> Option<usize> {
        let number = self.metric.strip_prefix("measured.step")?;
        number.parse::<usize>().ok()?.checked_sub(1)
    }
}

impl Experiment {
    /// Any of its figures is read off measured speeds.
    pub(crate) fn is_measured(&self) -> bool {
        self.figures
            .iter()
            .any(|figure| figure.measured_step().is_some())
    }
}

const fn figure(
    what: &'static str,
    metric: &'static str,
    unit: &'static str,
    recorded: f64,
) -> Figure {
    Figure {
        what,
        metric,
        unit,
        recorded,
    }
}

const fn experiment(
    name: &'static str,
    scenario: &'static str,
    recording: Option<&'static str>,
    figures: &'static [Figure],
) -> Experiment {
    Experiment {
        name,
        scenario,
        recording,
        duration_s: None,
        later: 1.0,
        figures,
    }
}

/// A program that takes its time in mode 8 gets 150 s.
const fn mission(
    name: &'static str,
    scenario: &'static str,
    figures: &'static [Figure],
) -> Experiment {
    Experiment {
        duration_s: Some(150.0),
        later: 4.0,
        ..experiment(name, scenario, None, figures)
    }
}

pub(crate) const EXPERIMENTS: [Experiment; 9] = [
    experiment(
        "mode 1",
        "mode1",
        Some("mode1_stop_at_wall.csv"),
        &[
            figure("107 -> 30 cm, within 5 %", "step1.settling_s", "s", 3.0),
            figure("overshoot", "step1.overshoot_m", "cm", 0.6),
            figure("30 -> 50 cm, within 5 %", "step2.settling_s", "s", 1.2),
            figure("period of the loop", "control_period_s", "ms", 65.5),
        ],
    ),
    experiment(
        "mode 2",
        "mode2",
        Some("mode2_square_to_wall.csv"),
        &[figure(
            "119 -> 30 cm, within 5 %",
            "step1.settling_s",
            "s",
            3.4,
        )],
    ),
    experiment(
        "mode 3",
        "mode3",
        Some("mode3_follow_wall.csv"),
        &[
            figure("distance error, rms", "distance_rms_m", "cm", 1.2),
            figure("distance error, worst", "distance_worst_m", "cm", 4.6),
        ],
    ),
    Experiment {
        duration_s: Some(30.0),
        later: 1.4,
        ..experiment(
            "mode 4",
            "mode4",
            None,
            &[
                figure("59 -> 50 cm, within 2 cm", "step1.within_2cm_s", "s", 7.1),
                figure("50 -> 30 cm, within 2 cm", "step2.within_2cm_s", "s", 6.3),
                figure("30 -> 40 cm, within 2 cm", "step3.within_2cm_s", "s", 9.0),
            ],
        )
    },
    experiment(
        "mode 5",
        "mode5",
        Some("mode5_wheel_speed.csv"),
        &[
            figure(
                "0 -> 60 rpm, within 3.2 rpm",
                "measured.step1",
                "s",
                f64::NAN,
            ),
            figure("50 -> 100 rpm", "measured.step3", "s", f64::NAN),
            figure("0 -> -100 rpm", "measured.step6", "s", f64::NAN),
            figure("0 -> 40 rpm", "measured.step9", "s", f64::NAN),
            figure("ripple at 60 rpm, mean", "step1.ripple_rad_s", "rpm", 1.5),
            figure("period of the loop", "control_period_s", "ms", 42.9),
        ],
    ),
    Experiment {
        duration_s: Some(60.0),
        ..experiment(
            "mode 7",
            "mode7",
            Some("mode7_square.csv"),
            &[
                figure("once round", "finish_s", "s", 30.0),
                figure(
                    "off the square by odometry, worst",
                    "odometry_worst_m",
                    "cm",
                    6.0,
                ),
                figure("the same, rms", "odometry_rms_m", "cm", 2.4),
                figure("period of the loop", "control_period_s", "ms", 66.9),
            ],
        )
    },
    mission(
        "mode 8, goals",
        "mode8-goals",
        &[
            figure("all four", "total_time_s", "s", 32.0),
            figure("way", "path_m", "m", 4.3),
        ],
    ),
    mission(
        "mode 8, lane",
        "mode8-lane",
        &[figure("four straights", "finish_s", "s", 57.8)],
    ),
    mission(
        "mode 8, obstacles",
        "mode8-obstacles",
        &[
            figure("time", "total_time_s", "s", 73.6),
            figure("way", "path_m", "m", 4.16),
        ],
    ),
];
