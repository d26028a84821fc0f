//! A scenario with everything it names, and the overrides of the command line.

use super::error::FileError;
use super::kept::Calibrations;
use super::near::{near, near_or_all};
use super::parameters;
use super::read::Allowed;
use super::start::pose;
use super::typed::TimedText;
use super::{
    Library, Member, NativeProgram, PolicyFile, RobotFile, ScenarioFile, SeedSpread, StartPose,
    WorldFile,
};
use crate::random_world::{Journey, Site, Size};
use rumbo_control::params::ParamId;
use rumbo_plant::params::Params;
use rumbo_plant::plant::{Mount, Mounts};
use rumbo_plant::world::Point;
use rumbo_sim::mega::firmware::{Firmware, LinkLanguage};
use rumbo_sim::wiring::Divider;
use rumbo_sim::{Config, Program, Sim};
use rumbo_wire::Command;
use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::Arc;

/// Values of the command line that replace the scenario's.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overrides {
    /// Another robot.
    pub robot: Option<String>,
    /// Another rig.
    pub rig: Option<String>,
    /// Another world.
    pub world: Option<String>,
    /// Another policy for mode 9.
    pub policy: Option<String>,
    /// How long a run lasts [s].
    pub duration_s: Option<f64>,
    /// Parameters by name: those of the control core, and the dotted keys of the plant such as `battery.open_circuit_v`.
    pub parameters: Vec<(String, f64)>,
    /// The program that drives the robot.
    pub program: NativeProgram,
    /// An image for an emulated Mega, in place of `program`.
    pub firmware: Option<PathBuf>,
    /// Another wiring for it.
    pub wiring: Option<String>,
    /// Lines of text that are typed besides the scenario's.
    pub texts: Vec<TimedText>,
    /// What the program says is not believed.
    pub ground_truth: bool,
}

impl Overrides {
    /// Those of a robot of a scenario with several, whose paths are relative to `beside`: it has the scenario's program
    /// unless another is given here.
    pub(super) fn of_member(&self, member: &Member, beside: &Library) -> Self {
        let mut own = self.clone();
        if self.program == NativeProgram::Rumbo && self.firmware.is_none() {
            own.program = member.program;
            own.firmware = member.firmware.as_ref().map(|path| beside.path(path));
            own.wiring = own.wiring.or_else(|| member.wiring.clone());
        }
        own
    }
}

/// A scenario ready to run.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// The scenario, with the overrides applied.
    pub scenario: ScenarioFile,
    /// Its robot.
    pub robot: RobotFile,
    /// Where its sonars sit.
    pub rig: Mounts,
    /// Its world.
    pub world: WorldFile,
    /// What drives its mode 9.
    pub policy: Option<PolicyFile>,
    /// The native program that drives the robot.
    pub program: NativeProgram,
    /// An image on an emulated Mega that replaces it.
    pub firmware: Option<Arc<Firmware>>,
    /// Lines of text that are typed besides its commands, the scenario's among them, in order of time.
    pub texts: Vec<TimedText>,
    /// What an image says is not believed: it is spoken to in text, and nothing that it says reaches a metric.
    pub ground_truth: bool,
    /// The calibrations made so far; copies share them.
    pub calibrations: Calibrations,
    /// Its number among the robots in its world, from 0.
    pub number: u32,
    /// All robots in its world, if there are several. The fields above are then those of the first one, but for the
    /// scenario's name, path, text and limits, which are those of the whole.
    pub fleet: Vec<Setup>,
}

impl Setup {
    /// The same with other values of parameters, of the control core or the plant.
    ///
    /// # Errors
    /// A name that is none, or a value out of its limits.
    pub fn with_parameters(&self, values: &[(&str, f64)]) -> Result<Self, FileError> {
        let mut setup = self.clone();
        for (name, value) in values {
            apply(&mut setup.scenario, name, *value)?;
        }
        let fleet = setup.fleet.iter();
        setup.fleet = fleet
            .map(|robot| robot.with_parameters(values))
            .collect::<Result<_, _>>()?;
        Ok(setup)
    }

    /// The robots in its world.
    pub fn robots(&self) -> &[Self] {
        match &self.fleet[..] {
            [] => std::slice::from_ref(self),
            fleet => fleet,
        }
    }

    /// The setup of a seed: with boxes and goal in place where the world is random, otherwise unchanged.
    ///
    /// # Errors
    /// A random world that finds no room.
    pub fn of_seed(&self, seed: u64) -> Result<Cow<'_, Self>, FileError> {
        let Some(random) = self.world.random else {
            return self.to_goal_of_world();
        };
        let site = self.site();
        let drawn = random.draw(&site, seed).ok_or_else(|| {
            FileError::Setting(format!(
                "world {}: no room for boxes and a goal with seed {seed}; make its arena larger, or ask for fewer groups or nearer goals in \
                 [random]",
                self.world.name
            ))
        })?;
        let mut own = self.clone();
        own.world.random = None;
        own.world.boxes.extend(drawn.boxes);
        own.take_journey(drawn.journey);
        Ok(Cow::Owned(own))
    }

    /// The same with the fixed goal of the world where the scenario asks for it.
    fn to_goal_of_world(&self) -> Result<Cow<'_, Self>, FileError> {
        let asks = self.scenario.commands.iter().any(|it| it.goal_of_world);
        let Some(goal_m) = self.world.goal_m.filter(|_| asks) else {
            return Ok(Cow::Borrowed(self));
        };
        let obstacles = self.world.world();
        let obstacles = obstacles
            .map_err(|error| FileError::Setting(format!("world {}: {error}", self.world.name)))?;
        let mut own = self.clone();
        own.take_journey(Journey::to(goal_m, &self.site(), &obstacles));
        Ok(Cow::Owned(own))
    }

    fn site(&self) -> Site<'_> {
        let StartPose { x_m, y_m, .. } = self.scenario.start;
        Site {
            from_m: self.world.arena.from_m,
            to_m: self.world.arena.to_m,
            walls: &self.world.walls,
            boxes: &self.world.boxes,
            start_m: [x_m, y_m],
            robot: Size::of(&self.robot.plant.body),
        }
    }

    fn take_journey(&mut self, journey: Journey) {
        for timed in &mut self.scenario.commands {
            if timed.goal_of_world {
                timed.command = goal_seen_from(&self.scenario.start, journey.goal_m);
            }
        }
        self.world.journey = Some(journey);
    }

    /// The robot of a seed at its start.
    ///
    /// # Errors
    /// If the files' values do not fit together.
    pub fn sim(&self, seed: u64) -> Result<Sim, FileError> {
        Ok(Sim::new(self.config(seed)?)?)
    }

    /// The configuration of a seed's simulation: `seed` draws the robot's parameters, unless the scenario disables it,
    /// its noise, and a random world.
    ///
    /// # Errors
    /// If the files' values do not fit together, or there are several robots.
    pub fn config(&self, seed: u64) -> Result<Config, FileError> {
        if !self.fleet.is_empty() {
            return Err(FileError::Setting(format!(
                "scenario {}: has robots of its own, and here one is driven; choose a scenario without [[fleet]]",
                self.scenario.name
            )));
        }
        let setup = &*self.of_seed(seed)?;
        let scenario = &setup.scenario;
        let world = setup
            .world
            .world()
            .map_err(|error| FileError::Setting(format!("world {}: {error}", setup.world.name)))?;
        let program = match (&setup.firmware, setup.program) {
            (Some(firmware), _) => Program::Image(firmware.clone()),
            (None, _) if !scenario.has_mode => {
                return Err(FileError::Setting(format!(
                    "scenario {}: has no mode, so it is for a sketch or an image of one's own; give one, or the scenario a \
                     mode, e.g. mode = \"front_distance\"",
                    scenario.name
                )));
            }
            (None, NativeProgram::Rumbo) if !setup.robot.board.runs_rumbo => {
                return Err(setup.needs_a_program());
            }
            (None, NativeProgram::Rumbo) => Program::Rumbo {
                parameters: setup.control_parameters()?,
                divider: setup.divider(),
                network: setup.network(),
            },
            (None, NativeProgram::Baseline) => Program::Baseline {
                mode: scenario.mode,
                rig: scenario.rig.clone(),
            },
        };
        Ok(Config {
            plant: setup.drawn_params(seed)?,
            rig: setup.rig,
            world,
            lines: setup.world.lines.clone().into(),
            north_rad: setup.world.north_rad,
            light: setup.world.light.clone().into(),
            start: pose(&scenario.start),
            wheels_in_air: scenario.wheels_in_air,
            program,
            memory: Vec::new(),
            sonar_faults: scenario.sonar_faults.clone(),
            wire_faults: scenario.wire_faults.clone(),
            seed,
            day: self.number,
        })
    }

    /// The control core's parameters before the first command.
    ///
    /// # Errors
    /// As for [`Setup::rig_parameters`].
    pub(crate) fn params(&self) -> Result<rumbo_control::params::Params, FileError> {
        let mut params = rumbo_control::params::Params::default();
        for (id, value) in self.control_parameters()? {
            // Checked when it was read.
            let _ = params.set(id, value);
        }
        Ok(params)
    }

    /// The network of its policy; empty without one.
    fn network(&self) -> Arc<[u8]> {
        let policy = self.policy.as_ref();
        policy.map_or_else(Arc::default, |policy| policy.bytes.clone())
    }

    /// Our own control program is too large for the robot's board.
    fn needs_a_program(&self) -> FileError {
        let RobotFile { name, board, .. } = &self.robot;
        FileError::Setting(format!(
            "robot {name}: Rumbo's own control program does not fit into the {} of an {}; run a sketch or an \
             image of your own, or take another robot",
            board.chip.name, board.title
        ))
    }

    /// The robot file's parameters, drawn for the seed, with the scenario's own values on top.
    pub(crate) fn drawn_params(&self, seed: u64) -> Result<Params, FileError> {
        let mut params = match self.scenario.spread {
            SeedSpread::Drawn => self.robot.plant.draw(seed, self.number),
            SeedSpread::None => self.robot.plant,
        };
        for (key, value) in &self.scenario.plant {
            params
                .set(key, *value)
                .map_err(|error| FileError::Setting(error.to_string()))?;
        }
        Ok(params)
    }

    /// Whether the program takes the control core's parameters: our own does, and an image that speaks its frames.
    pub fn takes_parameters(&self) -> bool {
        match &self.firmware {
            Some(firmware) => !self.ground_truth && firmware.language() == LinkLanguage::Frames,
            None => self.program == NativeProgram::Rumbo,
        }
    }

    /// The control parameters of a run before its first command: the rig's, the wiring's, the robot file's, the scenario's; later ones win.
    ///
    /// # Errors
    /// As for [`Setup::rig_parameters`].
    pub fn control_parameters(&self) -> Result<Vec<(ParamId, f32)>, FileError> {
        let mut parameters = self.rig_parameters()?;
        if let Some(Divider { input, ratio }) = self.divider() {
            parameters.push((ParamId::BatteryInput, f32::from(input)));
            parameters.push((ParamId::BatteryRatio, ratio as f32));
        }
        parameters.extend(&self.robot.parameters);
        parameters.extend(&self.scenario.parameters);
        Ok(parameters)
    }

    /// The battery's divider in the wiring of our own program.
    pub fn divider(&self) -> Option<Divider> {
        self.robot.wirings.get("final")?.battery
    }

    /// The control parameters that describe the robot's rig.
    ///
    /// # Errors
    /// The rig's name is none that the control core knows, or it lacks a sonar of that rig.
    pub fn rig_parameters(&self) -> Result<Vec<(ParamId, f32)>, FileError> {
        use rumbo_control::rig::Rig;
        let name = &self.scenario.rig;
        let known = Rig::ALL.into_iter().find(|rig| rig.name() == name);
        let Some(rig) = known else {
            return Err(FileError::Unknown {
                kind: "rig of the control core",
                name: name.clone(),
                near: near_or_all(name, Rig::ALL.iter().map(|rig| rig.name())),
            });
        };
        let need = |mount: Option<Mount>, sonar: &str| {
            mount.ok_or_else(|| {
                FileError::Setting(format!(
                    "robot {}: rig {name} needs a `{sonar}` sonar; add [rig.{name}.{sonar}]",
                    self.robot.name
                ))
            })
        };
        let mut values = vec![(ParamId::Rig, f64::from(rig as u8))];
        if matches!(rig, Rig::FrontSingle | Rig::Final) {
            values.push((ParamId::SonarFrontX, need(self.rig.front, "front")?.x_m));
        }
        if rig != Rig::FrontSingle {
            let left = need(self.rig.left, "left")?;
            let right = need(self.rig.right, "right")?;
            match rig {
                Rig::FrontPair => values.extend([
                    (ParamId::SonarFrontX, left.x_m),
                    (ParamId::FrontGap, left.y_m - right.y_m),
                ]),
                Rig::SidePairLeft | Rig::SidePairRight => values.extend([
                    (ParamId::SonarSideX, 0.5 * (left.x_m + right.x_m)),
                    (ParamId::SonarSideY, left.y_m.abs()),
                    (ParamId::SideGap, left.x_m - right.x_m),
                ]),
                Rig::FrontSingle | Rig::Final => values.extend([
                    (ParamId::SonarSideX, left.x_m),
                    (ParamId::SonarSideY, left.y_m),
                ]),
            }
        }
        Ok(values
            .into_iter()
            .map(|(id, value)| (id, value as f32))
            .collect())
    }
}

/// The command to go to a point of the world, for a robot whose origin is the start.
#[must_use]
pub fn goal_seen_from(start: &StartPose, goal_m: Point) -> Command {
    let (x_m, y_m) = (goal_m[0] - start.x_m, goal_m[1] - start.y_m);
    let (sin, cos) = (libm::sin(start.heading_rad), libm::cos(start.heading_rad));
    Command::Goal {
        x_m: (cos * x_m + sin * y_m) as f32,
        y_m: (cos * y_m - sin * x_m) as f32,
    }
}

/// Sets one parameter, of the plant or of the control core, whichever has the name.
pub(super) fn apply(scenario: &mut ScenarioFile, name: &str, value: f64) -> Result<(), FileError> {
    let wrong = |remedy: &str| FileError::Setting(format!("parameter {name} = {value}: {remedy}"));
    let limits = Params::limits();
    if let Some(limit) = limits.iter().find(|limit| limit.key == name) {
        let allowed = Allowed::new(limit.min, limit.max, limit.unit);
        if !allowed.admits(value) {
            return Err(wrong(&allowed.remedy()));
        }
        scenario.plant.insert(name.to_owned(), value);
        return Ok(());
    }
    let Some(id) = ParamId::from_name(name) else {
        let known = limits
            .iter()
            .map(|limit| limit.key.as_str())
            .chain(ParamId::ALL.map(ParamId::name));
        return Err(FileError::Unknown {
            kind: "parameter",
            name: name.to_owned(),
            near: near(name, known).into_iter().map(str::to_owned).collect(),
        });
    };
    parameters::check(id, value).map_err(|remedy| wrong(&remedy.to_string()))?;
    scenario.parameters.push((id, value as f32));
    Ok(())
}
