//! `rumbo._rumbo`: what the Python package `rumbo` calls. Its typed face, with the documentation for users, is the
//! Python beside it, in `python/rumbo/`.
//!
//! Every call that takes time gives up Python's lock and looks for Ctrl-C between runs, or between seconds of simulated
//! time. Input is checked before anything runs; an error of the simulator's files is a `ValueError` with their text.

mod arrays;
mod batch;
mod guard;
mod identify;
mod log;
mod policy;
mod probe;
mod run;
mod setup;
mod snapshot;
mod study;
mod tune;

#[pyo3::pymodule]
mod _rumbo {
    #[pymodule_export]
    use super::batch::Batch;
    #[pymodule_export]
    use super::identify::identify;
    #[pymodule_export]
    use super::log::read_log;
    #[pymodule_export]
    use super::policy::{Policy, quantise};
    #[pymodule_export]
    use super::probe::{
        apply, compile, edges, ended, is_high, other_ranges, parts, pin, probe, pulses, said,
        share_high, type_in, vcd,
    };
    #[pymodule_export]
    use super::run::run;
    #[pymodule_export]
    use super::setup::{Setup, load, names, value_names};
    #[pymodule_export]
    use super::snapshot::Snapshot;
    #[pymodule_export]
    use super::study::{differences, plan, run_jobs};
    #[pymodule_export]
    use super::tune::tune;

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("VERSION", env!("CARGO_PKG_VERSION"))?;
        module.add("MODEL", rumbo_experiment::MODEL)?;
        module.add("OBSERVED", rumbo_experiment::batch::OBSERVED.to_vec())?;
        module.add("TRUE", rumbo_experiment::batch::TRUE.to_vec())?;
        let faults = rumbo_control::Fault::ALL.map(|fault| (fault as u8, fault.explanation()));
        module.add("FAULTS", faults.to_vec())?;
        module.add("REACH_M", f64::from(rumbo_control::range::REACH_M))?;
        module.add(
            "MAX_WHEEL_RAD_S",
            f64::from(rumbo_control::mode::MAX_WHEEL_RAD_S),
        )
    }
}
