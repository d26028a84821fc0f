//! The ghost: a simulated robot that gets the same bytes as the robot that is shown, so that one sees what it should have done.
//!
//! Beside a real robot it lives in step with it. For a log it is run over the recorded bytes before the log is shown.

use crate::failure::Failure;
use crate::lab::SimulatedRobot;
use rumbo_scenario::files::Overrides;
use rumbo_station::log::{Log, Manifest};
use rumbo_station::{Choice, Ghost, LinkNews, MapPose, Scene, Simulation, Standing, Target};
use std::path::Path;

/// The ghost moves on in steps of this length \[us\].
const STEP_US: u64 = 5_000;

fn simulated(scenario: &str, seed: u64) -> Result<SimulatedRobot, Failure> {
    let choice = Choice {
        scenario: scenario.to_owned(),
        world: None,
        rig: None,
        seed,
    };
    SimulatedRobot::new(Overrides::default(), choice).map_err(Failure::input)
}

fn surroundings(ghost: &SimulatedRobot) -> Scene {
    Scene {
        of_ghost: true,
        ..ghost.scene()
    }
}

/// A robot on a port with its ghost.
pub(crate) struct Haunted<T> {
    robot: T,
    ghost: SimulatedRobot,
    heard: Vec<u8>,
}

impl<T: Target> Haunted<T> {
    /// The robot, with a ghost that stands where the scenario begins.
    pub(crate) fn new(robot: T, scenario: &str) -> Result<Self, Failure> {
        Ok(Self {
            robot,
            ghost: simulated(scenario, 1)?,
            heard: Vec::new(),
        })
    }
}

impl<T: Target> Target for Haunted<T> {
    fn now_us(&self) -> u64 {
        self.robot.now_us()
    }

    fn advance(&mut self, dt_us: u64) -> Result<(), String> {
        self.robot.advance(dt_us)?;
        follow(&mut self.ghost, self.robot.now_us(), &mut self.heard)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), String> {
        self.ghost.send(bytes)?;
        self.robot.send(bytes)
    }

    fn receive(&mut self, into: &mut Vec<u8>) {
        self.robot.receive(into);
    }

    fn baud(&self) -> u32 {
        self.robot.baud()
    }

    fn manifest(&self) -> Manifest {
        self.robot.manifest()
    }

    fn news(&mut self) -> Option<LinkNews> {
        self.robot.news()
    }

    fn ghost(&self) -> Option<MapPose> {
        Some(self.ghost.truth().pose)
    }

    fn restart_ghost(&mut self, at: Standing) -> Result<(), String> {
        self.ghost.place(at);
        Ok(())
    }

    fn surroundings(&mut self) -> Option<Scene> {
        Some(surroundings(&self.ghost))
    }
}

/// The ghost lives up to this instant; nobody listens to what it says.
fn follow(ghost: &mut SimulatedRobot, until_us: u64, heard: &mut Vec<u8>) -> Result<(), String> {
    while ghost.now_us() + STEP_US <= until_us {
        ghost.advance(STEP_US)?;
        ghost.receive(heard);
        heard.clear();
    }
    Ok(())
}

/// The ghost of a log, which gets the recorded bytes at their times.
struct Recorded {
    scenario: String,
    seed: u64,
    to_robot: Vec<(u64, Vec<u8>)>,
    /// The first that it has not got yet.
    next: usize,
    ghost: SimulatedRobot,
    heard: Vec<u8>,
}

impl Ghost for Recorded {
    fn begin(&mut self) -> Result<(), String> {
        self.ghost = simulated(&self.scenario, self.seed)
            .map_err(|_| format!("the scenario {} is gone", self.scenario))?;
        self.next = 0;
        Ok(())
    }

    fn live(&mut self, until_us: u64) -> Result<MapPose, String> {
        while let Some((at_us, bytes)) = self.to_robot.get(self.next)
            && *at_us <= until_us
        {
            follow(&mut self.ghost, *at_us, &mut self.heard)?;
            self.ghost.send(bytes)?;
            self.next += 1;
        }
        follow(&mut self.ghost, until_us, &mut self.heard)?;
        Ok(self.ghost.truth().pose)
    }

    fn place(&mut self, standing: Standing) {
        self.ghost.place(standing);
    }
}

/// Puts a ghost into a log that was read with its bytes, and gives it; `scenario` is where it lives, by default that of the log.
pub(crate) fn add_to(
    log: &mut Log,
    path: &Path,
    scenario: Option<&str>,
) -> Result<Box<dyn Ghost>, Failure> {
    let shown = path.display();
    let recorded = log.manifest.as_ref();
    let own = recorded.and_then(|manifest| manifest.scenario.clone());
    let Some(scenario) = scenario.map(str::to_owned).or(own) else {
        return Err(Failure::Input(format!(
            "{shown}: does not say which scenario it is of; name one, as in --ghost mode1"
        )));
    };
    let seed = recorded.and_then(|manifest| manifest.seed).unwrap_or(1);
    if log.link.is_empty() {
        return Err(Failure::Input(format!(
            "{shown}: holds no bytes of a link, so a ghost cannot get the same commands; record with rumbo lab or rumbo connect"
        )));
    }
    let to_robot = log.link.iter().filter(|burst| burst.to_robot);
    let mut ghost = Box::new(Recorded {
        ghost: simulated(&scenario, seed)?,
        to_robot: to_robot
            .map(|burst| (burst.t_us, burst.bytes.clone()))
            .collect(),
        scenario,
        seed,
        next: 0,
        heard: Vec::new(),
    });
    let scene = surroundings(&ghost.ghost);
    log.haunt(scene, |t_us| ghost.live(t_us))
        .map_err(Failure::Input)?;
    Ok(ghost)
}
