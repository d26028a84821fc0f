//! A simulated robot: a program at the pins of the robot of `rumbo-plant`, on one clock, behind a simulated serial link.
//!
//! | program | file | |
//! |---|---|---|
//! | our robot, native | `native` | ticks on multiples of 10 ms; outputs reach the plant exactly 3 ms later, as on the chip |
//! | the report's, native | `baseline` | keeps its own time; [`Sim::order`] hands it commands without a link |
//! | any image, on an emulated Mega | `emulated` | chip and plant in lockstep |
//!
//! Bytes go through [`Link`]s at 9600 baud, or at the rate of the wiring's module: the user of a [`Sim`] sees the robot as behind a real port. A clone is a
//! snapshot, which continues bit for bit the same.

mod among;
mod baseline;
mod emulated;
mod hand;
mod native;
mod touches;
mod unlinked;

use crate::baseline::Baseline;
use crate::config::{Config, Program};
use crate::error::SimError;
use crate::floor::DarkLine;
use crate::light::Light;
use crate::mega::Mega;
use crate::sonar_fault::{SonarFault, SonarFaults, TimedSonarFault};
use crate::tape::{LinkBurst, LinkTape};
use crate::wire_fault::WireFaults;
pub use native::Latched;
use native::{Memory, Native};
use rumbo_control::mode::ModeId;
use rumbo_control::{Duty, SIDES, SonarId, Wheels};
use rumbo_plant::contact::Pose;
use rumbo_plant::drivetrain::{Bridge, Side};
use rumbo_plant::link::{Link, LinkDirection, LinkParams};
use rumbo_plant::noise::Noise;
use rumbo_plant::params::Params;
use rumbo_plant::plant::{Event, GroundTruth, Plant, State};
use rumbo_plant::world::World;
use rumbo_wire::{Command, FromRobot};
use std::collections::BTreeMap;
use std::sync::Arc;
pub use touches::ContactStart;
use touches::Touches;

/// What is at the robot's pins.
#[derive(Clone, Debug)]
enum Controller {
    Rumbo(Box<Native>),
    Baseline(Box<Baseline>),
    Mega(Box<Mega>),
}

/// A simulated robot in its world.
#[derive(Clone, Debug)]
pub struct Sim {
    plant: Plant,
    params: Params,
    start: Pose,
    state: State,
    /// Taken out only while it runs.
    controller: Option<Controller>,
    uplink: Link,
    downlink: Link,
    baud: u32,
    duty: Wheels<Duty>,
    worst_reverse_rad_s: f64,
    touches: Touches,
    sonar_faults: SonarFaults,
    wire_faults: WireFaults,
    noise: Noise,
    /// The dark lines on the floor.
    lines: Arc<[DarkLine]>,
    /// Where magnetic north is, counter-clockwise from the world's x axis [rad].
    north_rad: f64,
    light: Arc<Light>,
    /// When outputs first and last took effect, and how often since the first [us].
    outputs_us: (u64, u64, u64),
    /// The chip is without power: its program does not run, and its pins drive nothing.
    off: bool,
    /// The supply of an emulated program's motors is cut.
    motors_cut: bool,
    /// What crossed the link, while it is tapped.
    tapped: Option<LinkTape>,
    among_others: bool,
    /// What was put elsewhere, by number, and how far from where the world has it \[m\].
    shifted: BTreeMap<usize, [f64; 2]>,
}

impl Sim {
    /// A robot at its start.
    ///
    /// # Errors
    /// If the program rejects its parameters, or there is none for the mode.
    pub fn new(config: Config) -> Result<Self, SimError> {
        let Config {
            plant: params,
            rig,
            world,
            lines,
            north_rad,
            light,
            start,
            wheels_in_air,
            program,
            memory,
            sonar_faults: failing_sonars,
            wire_faults: failing_wires,
            seed,
            day,
        } = config;
        let plant = Plant::new(rumbo_plant::plant::PlantSetup {
            params,
            rig,
            world,
            seed,
            robot: day,
            wheels_in_air,
        });
        let plant = match &program {
            Program::Image(firmware) if firmware.needs_direction() => plant.with_second_channels(),
            _ => plant,
        };
        let state = plant.start(start);
        let mut link = LinkParams::default();
        if let Program::Image(firmware) = &program {
            link.baud = firmware.link_baud();
        }
        let controller = match program {
            Program::Rumbo {
                parameters,
                divider,
                network,
            } => {
                let mut native = Native::new(Memory(memory), network, &parameters)?;
                native.divider = divider;
                Controller::Rumbo(Box::new(native))
            }
            Program::Baseline { mode, rig } => {
                Controller::Baseline(Box::new(Baseline::new(mode, &rig)?))
            }
            Program::Image(firmware) => {
                let encoders = plant.encoder_levels(&state);
                let mut mega = Mega::new(firmware, encoders);
                let eeprom = mega.chip_mut().devices_mut().eeprom_mut();
                eeprom
                    .iter_mut()
                    .zip(memory)
                    .for_each(|(to, from)| *to = from);
                Controller::Mega(Box::new(mega))
            }
        };
        let noise = Noise::new(seed, day);
        let mut sonar_faults = SonarFaults::default();
        for fault in failing_sonars {
            sonar_faults.add(fault);
        }
        let mut wire_faults = WireFaults::default();
        for fault in failing_wires {
            wire_faults.add(fault);
        }
        Ok(Self {
            plant,
            params,
            start,
            state,
            controller: Some(controller),
            baud: link.baud,
            uplink: Link::new(link.clone(), noise, LinkDirection::ToRobot),
            downlink: Link::new(link, noise, LinkDirection::ToStation),
            duty: Wheels::default(),
            worst_reverse_rad_s: 0.0,
            touches: Touches::default(),
            sonar_faults,
            wire_faults,
            noise,
            lines,
            north_rad,
            light,
            outputs_us: (0, 0, 0),
            off: false,
            motors_cut: false,
            tapped: None,
            among_others: false,
            shifted: BTreeMap::new(),
        })
    }

    /// Simulated time since the start [us].
    pub fn now_us(&self) -> u64 {
        self.state.now_us()
    }

    /// Speed of the link [baud].
    pub fn baud(&self) -> u32 {
        self.baud
    }

    /// The plant's parameters, as drawn for this seed.
    pub fn params(&self) -> &Params {
        &self.params
    }

    /// Ground truth.
    pub fn truth(&self) -> GroundTruth {
        self.plant.truth(&self.state)
    }

    /// The plant and its state.
    pub(crate) fn physics(&self) -> (&Plant, &State) {
        (&self.plant, &self.state)
    }

    /// The duties in force at the bridges.
    pub fn duty(&self) -> Wheels<Duty> {
        self.duty
    }

    /// Fastest that a wheel turned while its bridge drove it the other way [rad/s].
    pub fn worst_reverse_rad_s(&self) -> f64 {
        self.worst_reverse_rad_s
    }

    /// Fastest that a point of the body met an obstacle [m/s]; 0 without a contact.
    pub fn worst_contact_m_s(&self) -> f64 {
        self.touches.worst_m_s()
    }

    /// What the body has met, in order.
    pub fn touches(&self) -> &[ContactStart] {
        &self.touches.0
    }

    /// Mean time between two settings of the bridges [s].
    pub fn control_period_s(&self) -> f64 {
        let (first_us, last_us, count) = self.outputs_us;
        (last_us - first_us) as f64 * 1e-6 / count.max(1) as f64
    }

    /// Records the inputs of our native robot at each tick from now on.
    pub fn record_inputs(&mut self) {
        if let Some(Controller::Rumbo(native)) = &mut self.controller {
            native.recorded = Some(Vec::new());
        }
    }

    /// Drains the recorded inputs.
    pub fn take_inputs(&mut self) -> Vec<Latched> {
        match &mut self.controller {
            Some(Controller::Rumbo(native)) => native
                .recorded
                .as_mut()
                .map(std::mem::take)
                .unwrap_or_default(),
            _ => Vec::new(),
        }
    }

    /// When the bridges were last set to something else [us]; 0 before the first time.
    pub fn driven_us(&self) -> u64 {
        self.outputs_us.1
    }

    /// Sends bytes to the robot.
    pub fn send(&mut self, bytes: &[u8]) {
        self.note(true, bytes);
        self.uplink.send(self.now_us(), bytes);
    }

    /// Appends the bytes that have arrived from the robot.
    pub fn receive(&mut self, into: &mut Vec<u8>) {
        let from = into.len();
        self.downlink.receive(self.now_us(), into);
        self.note(false, into.get(from..).unwrap_or_default());
    }

    /// Records what crosses the link from now on; for a robot without one, the bytes that it would send and the commands
    /// that it receives, except the setpoints of its wheels.
    pub fn tap_link(&mut self) {
        self.greet_unlinked();
        self.tapped = Some(LinkTape::default());
    }

    /// Drains what crossed the link since it was tapped.
    pub fn take_tapped(&mut self) -> LinkTape {
        let tapped = self.tapped.as_mut();
        tapped.map(std::mem::take).unwrap_or_default()
    }

    fn is_tapped(&self) -> bool {
        self.tapped.is_some()
    }

    fn note(&mut self, to_robot: bool, bytes: &[u8]) {
        let t_us = self.now_us();
        if let Some(tapped) = &mut self.tapped
            && !bytes.is_empty()
        {
            tapped.push(LinkBurst {
                t_us,
                to_robot,
                bytes,
            });
        }
    }

    /// Makes a sonar fail at a time. The report's program, which times its own edges, is affected only by a cut.
    pub fn fail_sonar(&mut self, fault: TimedSonarFault) {
        self.sonar_faults.add(fault);
    }

    /// Cuts a sonar's wires: from now on it answers no ping.
    pub fn cut_sonar(&mut self, sonar: SonarId) {
        self.fail_sonar(TimedSonarFault {
            at_s: self.now_us() as f64 * 1e-6,
            sonar,
            fault: SonarFault::Cut,
        });
    }

    /// Hands a command to the report's native program, as a line of text would. False for any other program: those
    /// receive commands over the link.
    pub fn order(&mut self, command: Command) -> bool {
        let Some(Controller::Baseline(baseline)) = &mut self.controller else {
            return false;
        };
        baseline.command(command);
        true
    }

    /// The world.
    pub fn world(&self) -> &World {
        self.plant.world()
    }

    /// Drains the messages of the report's native program; empty for other programs, which send over the link.
    pub fn drain_messages(&mut self) -> Vec<FromRobot> {
        match &mut self.controller {
            Some(Controller::Baseline(baseline)) => baseline.drain_messages(),
            _ => Vec::new(),
        }
    }

    /// The native robot's mode and the state of its machine; `None` while it is not armed, and of any other robot.
    pub fn mode_state(&self) -> Option<(ModeId, u8)> {
        match &self.controller {
            Some(Controller::Rumbo(native)) => native.mode_state(),
            _ => None,
        }
    }

    /// Makes it accept the bytes meant for another robot, timed by that one's clock: our native robot no longer checks
    /// their age.
    pub fn be_ghost(&mut self) {
        if let Some(Controller::Rumbo(native)) = &mut self.controller {
            native.be_ghost();
        }
    }

    /// The content of the robot's EEPROM; bytes never written may be missing at the end.
    pub fn memory(&self) -> Vec<u8> {
        match &self.controller {
            Some(Controller::Rumbo(native)) => native.memory.0.clone(),
            Some(Controller::Mega(mega)) => mega.chip().devices().eeprom().to_vec(),
            Some(Controller::Baseline(_)) | None => Vec::new(),
        }
    }

    /// The emulated Mega, if one is at the pins.
    pub fn mega(&self) -> Option<&Mega> {
        match &self.controller {
            Some(Controller::Mega(mega)) => Some(mega),
            _ => None,
        }
    }

    /// The same, as a debugger or a terminal holds it.
    pub fn mega_mut(&mut self) -> Option<&mut Mega> {
        match &mut self.controller {
            Some(Controller::Mega(mega)) => Some(mega),
            _ => None,
        }
    }

    /// Takes an emulated chip's power away: its program stops, the wheels are released. The robot rolls out.
    pub fn switch_off(&mut self) {
        self.off = true;
        self.set_bridges(Wheels::default());
    }

    /// Cuts the supply of the motors, whatever an emulated program does at its pins, as an emergency button at the battery
    /// does, or gives it back; the chip keeps its own. Programs that obey STOP by themselves have no such button.
    pub fn supply_motors(&mut self, on: bool) {
        self.motors_cut = !on && self.mega().is_some();
        let asked = self.mega().map(Mega::driven);
        for action in asked.into_iter().flatten() {
            self.act(action);
        }
    }

    /// Whether its power was taken away.
    pub(crate) fn is_off(&self) -> bool {
        self.off
    }

    /// How the program at the pins ended, if it could not go on.
    pub fn verdict(&self) -> Option<String> {
        let mega = self.mega()?;
        let verdict = mega.verdict()?;
        Some(format!("firmware {}: {verdict}", mega.firmware().name()))
    }

    /// Restarts the clock with the robot back at its start, at rest; the program runs on unaware. For a program that
    /// receives its parameters over the link before its run begins.
    pub fn restart_clock(&mut self) {
        self.state = self.plant.start(self.start);
        self.uplink = Link::new(
            self.uplink.params().clone(),
            self.noise,
            LinkDirection::ToRobot,
        );
        self.downlink = Link::new(
            self.downlink.params().clone(),
            self.noise,
            LinkDirection::ToStation,
        );
        self.worst_reverse_rad_s = 0.0;
        self.touches = Touches::default();
        self.outputs_us = (0, 0, 0);
        let encoders = self.plant.encoder_levels(&self.state);
        if let Some(mega) = self.mega_mut() {
            mega.restart_clock(encoders);
        }
    }

    /// Advances program and plant to this time [us], or to a breakpoint.
    pub fn advance(&mut self, until_us: u64) {
        let mut controller = self.controller.take();
        match &mut controller {
            Some(Controller::Rumbo(native)) => self.advance_native(native, until_us),
            Some(Controller::Baseline(baseline)) => self.advance_baseline(baseline, until_us),
            Some(Controller::Mega(_)) if self.off => self.advance_plant(until_us, &mut |_| {}),
            Some(Controller::Mega(mega)) => self.advance_mega(mega, until_us),
            None => {}
        }
        self.controller = controller;
    }

    fn advance_plant(&mut self, until_us: u64, take: &mut impl FnMut(Event)) {
        let touches = &mut self.touches;
        self.plant.advance(&mut self.state, until_us, &mut |event| {
            touches.note(&event);
            take(event);
        });
        self.watch_reverse();
    }

    fn trigger(&mut self, sonar: SonarId) {
        if !self.sonar_faults.is_cut(sonar, self.now_us()) {
            self.plant.trigger(&mut self.state, plant_sonar(sonar));
        }
    }

    fn set_bridges(&mut self, drive: Wheels<Duty>) {
        for side in SIDES {
            self.plant
                .set_bridge(&mut self.state, plant_side(side), bridge(drive[side]));
        }
        self.driven(drive);
    }

    /// The bridges have been set.
    fn driven(&mut self, drive: Wheels<Duty>) {
        let now_us = self.now_us();
        self.outputs_us = match self.outputs_us {
            (0, ..) => (now_us, now_us, 0),
            (first_us, _, count) => (first_us, now_us, count + 1),
        };
        self.duty = drive;
        self.watch_reverse();
    }

    fn watch_reverse(&mut self) {
        let wheels = self.plant.wheel_rad_s(&self.state);
        for (side, speed) in SIDES.into_iter().zip(wheels) {
            let against = -speed * f64::from(self.duty[side].counts().signum());
            self.worst_reverse_rad_s = self.worst_reverse_rad_s.max(against);
        }
    }
}

fn bridge(duty: Duty) -> Bridge {
    Bridge::driven(f64::from(duty.counts()) / f64::from(Duty::MAX))
}

fn plant_side(side: rumbo_control::Side) -> Side {
    match side {
        rumbo_control::Side::Left => Side::Left,
        rumbo_control::Side::Right => Side::Right,
    }
}

fn plant_sonar(sonar: SonarId) -> rumbo_plant::sonar::SonarId {
    match sonar {
        SonarId::Left => rumbo_plant::sonar::SonarId::Left,
        SonarId::Right => rumbo_plant::sonar::SonarId::Right,
        SonarId::Front => rumbo_plant::sonar::SonarId::Front,
    }
}
