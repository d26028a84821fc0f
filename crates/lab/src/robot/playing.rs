//! How its scenario comes to command the robot.

use super::SimulatedRobot;
use crate::play::Experiment;
use crate::prepare::set_up;
use rumbo_control::params::ParamId;
use rumbo_experiment::files::FileError;
use rumbo_experiment::run::{Player, parameters, prepare};
use rumbo_sim::trace::SAMPLE_US;
use std::sync::Arc;

impl SimulatedRobot {
    /// Starts again, commanded by its scenario, with these parameters of the robot as it was where they are not the
    /// scenario's.
    pub(crate) fn begin_experiment(&mut self, values: &[(u8, f32)]) -> Result<(), FileError> {
        let choice = self.choice();
        let (setup, _) = set_up(&self.library, &self.overrides, self.held.as_ref(), &choice)?;
        let own = parameters(&*prepare(&setup, choice.seed)?)?;
        let changed = values.iter().filter_map(|(number, value)| {
            let id = ParamId::from_number(*number)?;
            let other = own.as_ref().is_some_and(|own| own.get(id) != *value);
            other.then(|| (id.name().to_owned(), f64::from(*value)))
        });
        let changed: Vec<(String, f64)> = changed.collect();
        let mut overrides = self.overrides.clone();
        overrides.parameters.extend(changed.iter().cloned());
        let (setup, mut manifest) = set_up(&self.library, &overrides, self.held.as_ref(), &choice)?;
        manifest.step_us = SAMPLE_US;
        manifest.remember(&[]);
        let (sim, player) = Player::new(&Arc::new(setup), choice.seed)?;
        let experiment = Experiment::new(player, changed)?;
        self.prepared(|robot| (robot.sim, robot.manifest) = (sim, manifest));
        self.forget();
        self.experiment = Some(experiment);
        Ok(())
    }
}
