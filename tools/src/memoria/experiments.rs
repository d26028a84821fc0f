//! The scenarios, the report's program's time in each, and the metric compared.

/// One row.
pub(crate) struct Metric {
    pub(crate) what: &'static str,
    pub(crate) name: &'static str,
    pub(crate) unit: &'static str,
}

/// One table.
pub(crate) struct Experiment {
    pub(crate) scenario: &'static str,
    /// Ending of the image's name.
    pub(crate) sketch: &'static str,
    pub(crate) duration_s: f64,
    /// Lines sent for the profile besides `ON`.
    pub(crate) line: &'static str,
    pub(crate) metric: Metric,
}

const fn metric(what: &'static str, name: &'static str, unit: &'static str) -> Metric {
    Metric { what, name, unit }
}

pub(crate) const EXPERIMENTS: [Experiment; 12] = [
    Experiment {
        scenario: "mode1",
        sketch: "mode1",
        duration_s: 9.0,
        line: "REF 30",
        metric: metric("107 to 30 cm, within 5 %", "step1.settling_s", "s"),
    },
    Experiment {
        scenario: "mode2",
        sketch: "mode2",
        duration_s: 24.0,
        line: "REF 30",
        metric: metric("119 to 30 cm, within 5 %", "step1.settling_s", "s"),
    },
    Experiment {
        scenario: "mode3",
        sketch: "mode3",
        duration_s: 28.0,
        line: "",
        metric: metric("distance error, rms", "distance_rms_m", "cm"),
    },
    Experiment {
        scenario: "mode4",
        sketch: "mode4",
        duration_s: 28.0,
        line: "REF 50",
        metric: metric("59 to 50 cm, within 2 cm", "step1.within_2cm_s", "s"),
    },
    Experiment {
        scenario: "mode5",
        sketch: "mode5",
        duration_s: 45.5,
        line: "REF 60",
        metric: metric("0 to 60 rpm, within 5 %", "step1.settling_s", "s"),
    },
    Experiment {
        scenario: "mode5-reversal",
        sketch: "mode5",
        duration_s: 15.5,
        line: "REF 70",
        metric: metric("70 to -100 rpm", "step2.settling_s", "s"),
    },
    Experiment {
        scenario: "mode6",
        sketch: "mode6",
        duration_s: 26.0,
        line: "REF 40",
        metric: metric("sideways after 3 m", "after_3_m.sideways_m", "cm"),
    },
    Experiment {
        scenario: "mode7",
        sketch: "mode7",
        duration_s: 60.0,
        line: "",
        metric: metric("once round", "finish_s", "s"),
    },
    Experiment {
        scenario: "mode7-repeat",
        sketch: "mode7",
        duration_s: 60.0,
        line: "",
        metric: metric("off the square in 60 s, true", "true_worst_m", "cm"),
    },
    Experiment {
        scenario: "mode8-goals",
        sketch: "mode8",
        duration_s: 150.0,
        line: "GOAL 1 1",
        metric: metric("all four goals", "total_time_s", "s"),
    },
    Experiment {
        scenario: "mode8-obstacles",
        sketch: "mode8",
        duration_s: 150.0,
        line: "GOAL 2.5 0",
        metric: metric("time", "total_time_s", "s"),
    },
    Experiment {
        scenario: "mode8-lane",
        sketch: "lane",
        duration_s: 150.0,
        line: "",
        metric: metric("time", "finish_s", "s"),
    },
];
