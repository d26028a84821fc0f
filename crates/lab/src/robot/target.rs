//! The simulated robot as the target of a session.

use super::{SimulatedRobot, type_to};
use crate::in_hand::InHand;
use crate::play::Experiment;
use crate::prepare::Prepared;
use crate::program::OwnProgram;
use crate::sight;
use rumbo_control::params::Params;
use rumbo_log::{Burst, Choice, ExperimentState, Level, Manifest, ProgramState, Scene, Truth};
use rumbo_session::{
    Abilities, EditedWorld, GivenProgram, LinkNews, Shown, ShownSketch, Target, TargetError,
};
use rumbo_sim::Sim;
use rumbo_sim::mega::USB;
use rumbo_wire::Command;
use serde_json::Value;

impl Target for SimulatedRobot {
    fn now_us(&self) -> u64 {
        let reached_us = self.in_hand.as_ref().map(InHand::reached_us);
        reached_us.unwrap_or_else(|| self.sim(|sim| sim.now_us()))
    }

    fn advance(&mut self, dt_us: u64) -> Result<(), TargetError> {
        if let Some(in_hand) = &mut self.in_hand {
            in_hand.pass();
            self.look();
            return Ok(());
        }
        if !self.leads() {
            return Ok(());
        }
        let mut robots = self.robots.lock();
        let sim = &mut robots.all[self.number].sim;
        if let (Some(usb), Some(mega)) = (&mut self.usb, sim.mega_mut()) {
            mega.type_in(USB, usb.read());
        }
        if let Some(experiment) = &mut self.experiment {
            experiment.pass(sim, dt_us);
            return Ok(());
        }
        // After a breakpoint, back to the multiples of the step.
        let until_us = (sim.now_us() / dt_us.max(1) + 1) * dt_us;
        match &mut self.debugging {
            Some(debugging) => debugging.advance(sim, until_us),
            None => robots.advance(until_us),
        }
        Ok(())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), TargetError> {
        if !self.plays() {
            self.act(|sim| sim.send(bytes));
        }
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>) {
        if let Some(experiment) = &mut self.experiment {
            experiment.receive(into);
        }
        if let Some(in_hand) = &mut self.in_hand {
            in_hand.receive(into);
        } else if !self.plays() {
            self.sim(|sim| sim.receive(into));
        }
    }

    fn play(&mut self, parameters: &[(u8, f32)]) -> Result<(), TargetError> {
        if !self.is_alone() {
            return Err(TargetError::NoReset);
        }
        if self.program.as_ref().is_some_and(OwnProgram::is_rejected) {
            return Err(TargetError::NotCompiled);
        }
        self.begin_experiment(parameters)
            .map_err(|error| TargetError::Setup(error.to_string()))
    }

    fn end_play(&mut self) {
        if let Some(experiment) = &mut self.experiment {
            experiment.stop();
        }
    }

    fn experiment(&self) -> Option<ExperimentState> {
        self.experiment.as_ref().map(|each| each.state.clone())
    }

    fn scripted(&mut self) -> Vec<Burst> {
        let experiment = self.experiment.as_mut();
        experiment.map(Experiment::scripted).unwrap_or_default()
    }

    fn parameters(&self) -> Option<Params> {
        self.experiment.as_ref()?.parameters
    }

    fn baud(&self) -> u32 {
        self.sim(|sim| sim.baud())
    }

    fn manifest(&self) -> Manifest {
        self.prepared(|robot| robot.manifest.clone())
    }

    fn abilities(&self) -> Abilities {
        let own = self.prepared(|robot| sight::abilities(&robot.sim, robot.mode));
        Abilities {
            pace: self.leads(),
            reset: self.leads(),
            play: own.play && self.is_alone(),
            ..own
        }
    }

    fn truth(&self) -> Option<Truth> {
        Some(match &self.in_hand {
            Some(in_hand) => in_hand.truth(),
            None => self.sim(|sim| sight::truth(sim)),
        })
    }

    fn shown(&mut self) -> Vec<Shown> {
        let mut robots = self.robots.lock();
        let sim = &mut robots.all[self.number].sim;
        let own = match &mut self.in_hand {
            Some(in_hand) => in_hand.take_shown(),
            None if sight::reading_due(sim, &mut self.reading_due_us) => sight::shown(sim),
            None => return Vec::new(),
        };
        own.into_iter().chain(robots.around(self.number)).collect()
    }

    fn scene(&self) -> Option<Scene> {
        Some(self.prepared(|robot| robot.scene.clone()))
    }

    fn consoles(&mut self) -> Vec<(u8, Vec<u8>)> {
        let said = match &mut self.in_hand {
            Some(in_hand) => in_hand.take_consoles(),
            None => self.sim(sight::consoles),
        };
        if let (Some(usb), Some((USB, bytes))) = (&mut self.usb, said.first()) {
            usb.write(bytes);
        }
        said
    }

    fn program(&self) -> Option<ProgramState> {
        self.program_state()
    }

    fn news(&mut self) -> Option<LinkNews> {
        self.renew_program();
        if let Some(debugging) = &mut self.debugging {
            let news = debugging.take_news().into_iter();
            self.news.extend(news.map(LinkNews::Held));
        }
        let start = self.robots.lock().start;
        if std::mem::replace(&mut self.start, start) != start {
            (self.reading_due_us, self.ended) = (0, false);
            self.news.push_back(LinkNews::Renewed);
        }
        if !self.ended {
            let end = self.sim(|sim| end_of(sim));
            self.ended = end.is_some();
            self.news.extend(end);
        }
        self.news.pop_front()
    }

    fn type_in(&mut self, usart: u8, text: &str) -> Result<(), TargetError> {
        if !self.robots.lock().admit(usart, text) {
            return Ok(());
        }
        match self.act(|sim| type_to(sim, usart, text.as_bytes())) {
            true => Ok(()),
            false => Err(TargetError::NoChip),
        }
    }

    fn profile(&mut self, on: bool) -> Result<(), TargetError> {
        if self.sim(|sim| sim.mega().is_none()) {
            return Err(TargetError::NoChip);
        }
        if self.in_hand.is_some() {
            return Err(TargetError::Debugged);
        }
        self.profiling = on;
        self.begin_profile();
        Ok(())
    }

    fn supply_motors(&mut self, on: bool) {
        self.act(|sim| sim.supply_motors(on));
    }

    fn run_program(&mut self, program: GivenProgram) -> Result<(), TargetError> {
        if !self.is_alone() {
            return Err(TargetError::Several);
        }
        self.take_program(program)
    }

    fn sketch(&mut self, example: Option<&str>) -> ShownSketch {
        self.source(example)
    }

    fn ask_debugger(&mut self, request: &Value) -> Result<(), TargetError> {
        self.pass_to_debugger(request)
    }

    fn take_debug(&mut self) -> Vec<Value> {
        let in_hand = self.in_hand.as_mut();
        in_hand.map(InHand::take_messages).unwrap_or_default()
    }

    fn first_commands(&self) -> Vec<Command> {
        self.prepared(|robot| robot.first_commands.clone())
    }

    fn reset(&mut self, choice: &Choice) -> Result<(), TargetError> {
        // The page chooses among names it was given; it opens no files.
        let offered = self.prepared(|Prepared { scene, .. }| {
            let mut experiments = scene.experiments.iter();
            experiments.any(|each| each.name == choice.scenario)
                && choice
                    .world
                    .iter()
                    .all(|world| scene.worlds.contains(world))
        });
        if !self.leads() || !offered {
            return Err(TargetError::NotOffered);
        }
        if self.program.as_ref().is_some_and(OwnProgram::is_rejected) {
            return Err(TargetError::NotCompiled);
        }
        self.start_again(choice)
            .map_err(|error| TargetError::Setup(error.to_string()))
    }

    fn world(&mut self, given: Option<&str>) -> EditedWorld {
        self.to_edit(given)
    }

    fn drive_in(&mut self, world: &str) -> Result<Choice, TargetError> {
        self.start_in(world)
    }
}

/// That the program cannot go on.
fn end_of(sim: &Sim) -> Option<LinkNews> {
    if let Some(verdict) = sim.verdict() {
        return Some(LinkNews::Ended(verdict));
    }
    let mega = sim.mega()?;
    let (name, why) = (mega.firmware().name(), mega.standstill()?);
    let why = format!("firmware {name}: {why}");
    Some(LinkNews::Program(Level::Warning, why))
}
