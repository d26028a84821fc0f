//! What runs can tell of a robot, and what is believed of it beforehand.

/// A parameter (or several of one value) to identify.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unknown {
    /// The dotted keys that take the value.
    pub(crate) keys: &'static [&'static str],
    /// Standard deviation of what is believed beforehand, in the logarithm.
    pub(crate) prior_sd: f64,
    /// What is believed, where that is not the nominal value.
    pub(crate) believed: Option<f64>,
    /// The experiment that shows it.
    pub(crate) shown_by: &'static str,
}

/// Standard deviation of what is believed of the floor's scrubbing, in the logarithm.
pub(crate) const SCRUB_SD: f64 = 0.7;

const LEVELS: &str =
    "several PWM from 60 to 255 with the wheels in the air, and the battery's voltage";
const STARTS: &str = "starts and stops at several PWM, in the air and on the floor";
const BACKWARD: &str = "the same backward";
const FAST: &str = "some seconds of full PWM and then of a low one, without a stop";
const STRAIGHT: &str = "straight stretches on the floor beside some in the air";
pub(crate) const TURNS: &str = "turns on the spot at several PWM";

const fn unknown(keys: &'static [&'static str], prior_sd: f64, shown_by: &'static str) -> Unknown {
    Unknown {
        keys,
        prior_sd,
        believed: None,
        shown_by,
    }
}

/// What the runs can tell. Resistance, gear efficiency and mass scale all torques together and stay nominal.
pub(crate) const UNKNOWNS: [Unknown; 17] = [
    unknown(&["motor.back_emf_v_s"], 0.3, LEVELS),
    unknown(&["motor.inductance_h"], 0.5, LEVELS),
    unknown(&["motor.inertia_kg_m2"], 0.5, STARTS),
    unknown(&["motor.resistance_ohm"], 0.3, STRAIGHT),
    unknown(&["body.yaw_inertia_kg_m2"], 0.2, TURNS),
    unknown(&["wheels.left.coulomb_forward_n_m"], 0.5, FAST),
    unknown(&["wheels.left.coulomb_backward_n_m"], 0.5, BACKWARD),
    unknown(&["wheels.right.coulomb_forward_n_m"], 0.5, FAST),
    unknown(&["wheels.right.coulomb_backward_n_m"], 0.5, BACKWARD),
    unknown(
        &["wheels.left.viscous_n_m_s", "wheels.right.viscous_n_m_s"],
        0.7,
        LEVELS,
    ),
    Unknown {
        believed: Some(0.8),
        ..unknown(
            &["wheels.left.onset_ratio", "wheels.right.onset_ratio"],
            0.5,
            STARTS,
        )
    },
    unknown(
        &["wheels.left.onset_rad", "wheels.right.onset_rad"],
        0.7,
        STARTS,
    ),
    unknown(
        &["wheels.left.onset_rest_s", "wheels.right.onset_rest_s"],
        0.7,
        STARTS,
    ),
    // Two motors of a kind, 2.5 % of the whole: the logarithm counts from the lower limit, 0.5.
    unknown(&["wheels.right.strength"], 0.05, LEVELS),
    unknown(&["floor.rolling_n_m"], 0.5, STRAIGHT),
    // One day's: the recorded turns of mode 8 began at a PWM of about 78.
    Unknown {
        believed: Some(0.005),
        ..unknown(&["floor.scrub_n_m"], SCRUB_SD, TURNS)
    },
    // Nominal floors have none.
    Unknown {
        believed: Some(0.01),
        ..unknown(&["floor.yaw_damping_n_m_s"], 1.0, TURNS)
    },
];
