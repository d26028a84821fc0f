//! The ghost: a simulated robot that receives the same bytes as the shown robot, as the expected behaviour.
//!
//! Beside a real robot it runs in step with it. For a log it runs on the recorded bytes before the log is shown.

use crate::failure::Failure;
use rumbo_control::Fault;
use rumbo_experiment::files::Overrides;
use rumbo_lab::SimulatedRobot;
use rumbo_log::{Choice, Log, LogKind, Manifest, Scene, Truth};
use rumbo_session::{Abilities, Ghost, LinkNews, Standing, Target, TargetError};
use rumbo_wire::{
    Command, Decoder, EventKind, FrameMessage, FromRobot, Received, RobotTime, ToRobot,
};
use std::collections::VecDeque;
use std::path::Path;

/// The ghost moves on in steps of this length \[us\].
const STEP_US: u64 = 5_000;
/// Longest line of text that the decoder must pass over.
const LINE: usize = 160;
/// Session of commands to the ghost alone.
const SESSION: u8 = 0x60;

fn simulated(scenario: &str, seed: u64) -> Result<SimulatedRobot, Failure> {
    let choice = Choice {
        scenario: scenario.to_owned(),
        world: None,
        rig: None,
        seed,
    };
    let mut ghost = SimulatedRobot::new(Overrides::default(), choice)?;
    ghost.be_ghost();
    Ok(ghost)
}

fn surroundings(ghost: &SimulatedRobot) -> Scene {
    Scene {
        of_ghost: true,
        ..ghost.scene().unwrap_or_default()
    }
}

/// A robot on a port with its ghost.
pub(crate) struct WithGhost<T> {
    robot: T,
    ghost: SimulatedRobot,
    received: Vec<u8>,
    decoder: Decoder<LINE>,
    /// Faults of the ghost not reported yet.
    faults: VecDeque<Fault>,
    /// Number of the last command to the ghost alone.
    number: u16,
}

impl<T: Target> WithGhost<T> {
    /// The robot, with a ghost at the start of the scenario.
    pub(crate) fn new(robot: T, scenario: &str) -> Result<Self, Failure> {
        Ok(Self {
            robot,
            ghost: simulated(scenario, 1)?,
            received: Vec::new(),
            decoder: Decoder::default(),
            faults: VecDeque::new(),
            number: 0,
        })
    }

    /// Collects the faults that the ghost has reported.
    fn listen(&mut self) {
        for byte in &self.received {
            if let Some(Received::Frame(body)) = self.decoder.push(*byte)
                && let Ok(FromRobot::Event(event)) = FromRobot::from_body(&body)
                && let EventKind::Faulted(fault) = event.kind
            {
                self.faults.push_back(fault);
            }
        }
        self.received.clear();
    }
}

impl<T: Target> Target for WithGhost<T> {
    fn now_us(&self) -> u64 {
        self.robot.now_us()
    }

    fn advance(&mut self, dt_us: u64) -> Result<(), TargetError> {
        self.robot.advance(dt_us)?;
        follow(&mut self.ghost, self.robot.now_us(), &mut self.received)?;
        self.listen();
        Ok(())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), TargetError> {
        self.ghost.send(bytes)?;
        self.robot.send(bytes)
    }

    fn receive(&mut self, into: &mut Vec<u8>) {
        self.robot.receive(into);
    }

    fn baud(&self) -> u32 {
        self.robot.baud()
    }

    fn abilities(&self) -> Abilities {
        self.robot.abilities()
    }

    fn manifest(&self) -> Manifest {
        self.robot.manifest()
    }

    fn news(&mut self) -> Option<LinkNews> {
        self.robot
            .news()
            .or_else(|| self.faults.pop_front().map(LinkNews::GhostFault))
    }

    fn ghost(&self) -> Option<Truth> {
        self.ghost.truth()
    }

    /// Also clears the ghost's fault, since the robot may have none to clear. ON restarts it.
    fn restart_ghost(&mut self, at: Standing) -> Result<(), TargetError> {
        self.ghost.place(at);
        self.number = self.number.wrapping_add(1);
        let clear = ToRobot::Command {
            session: SESSION,
            number: self.number,
            command: Command::ClearFault,
            seen: RobotTime::default(),
        };
        self.ghost.send(clear.frame(0).bytes())
    }

    fn scene(&self) -> Option<Scene> {
        Some(surroundings(&self.ghost))
    }
}

/// Advances the ghost to this instant; appends the bytes it sends.
fn follow(
    ghost: &mut SimulatedRobot,
    until_us: u64,
    received: &mut Vec<u8>,
) -> Result<(), TargetError> {
    while ghost.now_us() + STEP_US <= until_us {
        ghost.advance(STEP_US)?;
        ghost.receive(received);
    }
    Ok(())
}

/// The ghost of a log, which receives the recorded bytes at their times.
struct Recorded {
    scenario: String,
    seed: u64,
    to_robot: Vec<(u64, Vec<u8>)>,
    /// Index of the next bytes.
    next: usize,
    ghost: SimulatedRobot,
    received: Vec<u8>,
}

impl Ghost for Recorded {
    fn begin(&mut self) -> Result<(), TargetError> {
        self.ghost = simulated(&self.scenario, self.seed)
            .map_err(|_| TargetError::Setup(format!("the scenario {} is gone", self.scenario)))?;
        self.next = 0;
        Ok(())
    }

    fn advance_to(&mut self, until_us: u64) -> Result<Truth, TargetError> {
        while let Some((at_us, bytes)) = self.to_robot.get(self.next)
            && *at_us <= until_us
        {
            follow(&mut self.ghost, *at_us, &mut self.received)?;
            self.ghost.send(bytes)?;
            self.next += 1;
        }
        follow(&mut self.ghost, until_us, &mut self.received)?;
        // Beside a log its messages are not used.
        self.received.clear();
        Ok(self.ghost.truth().unwrap_or_default())
    }

    fn place(&mut self, standing: Standing) {
        self.ghost.place(standing);
    }
}

/// Adds a ghost to a log that was read with its bytes, and returns it; `scenario` is its world, by default the log's.
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
    if recorded.is_some_and(|manifest| manifest.kind == LogKind::Episode) {
        return Err(Failure::Input(format!(
            "{shown}: an episode, whose robot a program in Python drove without a link; a ghost takes its commands from a link"
        )));
    }
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
        received: Vec::new(),
    });
    let scene = surroundings(&ghost.ghost);
    log.add_ghost(scene, |t_us| ghost.advance_to(t_us))
        .map_err(Failure::input)?;
    Ok(ghost)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_control::mode::ModeId;

    /// A silent robot on a port; its clock advances by itself.
    #[derive(Default)]
    struct Silent {
        now_us: u64,
    }

    impl Target for Silent {
        fn now_us(&self) -> u64 {
            self.now_us
        }

        fn advance(&mut self, dt_us: u64) -> Result<(), TargetError> {
            self.now_us += dt_us;
            Ok(())
        }

        fn send(&mut self, _bytes: &[u8]) -> Result<(), TargetError> {
            Ok(())
        }

        fn receive(&mut self, _into: &mut Vec<u8>) {}

        fn baud(&self) -> u32 {
            9_600
        }

        fn manifest(&self) -> Manifest {
            Manifest::default()
        }
    }

    fn send(robot: &mut WithGhost<Silent>, number: u16, command: Command) {
        let message = ToRobot::Command {
            session: 1,
            number,
            command,
            // By the clock of the robot, which the ghost does not have.
            seen: RobotTime {
                start: 77,
                ms: 1_000_000,
            },
        };
        robot.send(message.frame(0).bytes()).unwrap();
        robot.advance(100_000).unwrap();
    }

    #[test]
    fn a_ghost_that_received_nothing_for_too_long_reports_it_and_continues_after_it_was_moved() {
        let mut robot = WithGhost::new(Silent::default(), "mode1").unwrap();
        robot.advance(1_000_000).unwrap();
        send(&mut robot, 1, Command::Mode(ModeId::FrontDistance));
        send(&mut robot, 2, Command::Arm);
        let begin_m = robot.ghost().unwrap().pose.x_m;
        robot.advance(2_000_000).unwrap();
        let news = robot.news();
        assert_eq!(
            news,
            Some(LinkNews::GhostFault(Fault::LinkLost)),
            "{:?}",
            robot.ghost()
        );
        assert_eq!(robot.news(), None);

        let standing = Standing {
            at: robot.ghost().unwrap().pose,
            estimated: rumbo_log::MapPose::default(),
        };
        robot.restart_ghost(standing).unwrap();
        send(&mut robot, 3, Command::Arm);
        let stood_m = robot.ghost().unwrap().pose.x_m;
        for _ in 0..5 {
            robot.send(ToRobot::Heartbeat.frame(0).bytes()).unwrap();
            robot.advance(200_000).unwrap();
        }
        let gone_m = robot.ghost().unwrap().pose.x_m - stood_m;
        assert!(gone_m > 0.05, "{gone_m} m, after {} m", stood_m - begin_m);
        assert_eq!(robot.news(), None);
    }
}
