//! An emulated Arduino, a Mega or another board, at the robot's pins: the chip of `rumbo-emulator`, wired by the robot
//! file.
//!
//! ```text
//! plant events ──► encoder and echo pins, at their cycle ──► chip ──► enable and direction pins ──► bridges
//!                                                             │  └──► trigger and servo pins ──► sonars, servo
//!                       Bluetooth module ◄── USART of the link ┘
//! ```
//!
//! | file | part |
//! |---|---|
//! | [`pins`] | a wiring as pins of the chip |
//! | `bus` | the two-wire bus and its devices |
//! | `bridge`, `servo`, `module` | what driver, servo and Bluetooth module make of their lines |
//! | `inputs` | the edges that the plant announces, scheduled for the chip |
//! | `outputs` | the chip's outputs as actions on the robot |
//! | `echo` | echo lines, and sonars that fail |
//! | `uart` | the Bluetooth module on pins that are no USART's |
//! | `console` | output of the USARTs, for people |
//! | `meters` | what instruments at the wired pins show |
//! | `marks` | when the program reaches some of its functions |
//! | `floor`, `obstacle`, `light` | sensors for lines, for obstacles, for light |
//! | `maxsonar` | range finders that measure by themselves |
//! | `parts` | buttons, switches, potentiometers and remote controls |
//! | `register` | the register of a motor shield |
//! | `wheels` | what the program did with each motor |
//! | `notes` | oddities of a program, for people |
//! | [`firmware`] | a program image, the language it speaks, the wiring it is for |
//!
//! `Mega::run` runs the chip until something happens that affects the plant, so that the plant can follow to the same
//! microsecond before anything else happens: see `sim::emulated`.

mod console;
pub mod firmware;
pub mod pins;

mod bridge;
mod bus;
mod echo;
mod floor;
mod inputs;
mod light;
mod marks;
mod maxsonar;
mod meters;
mod module;
mod notes;
mod obstacle;
mod outputs;
mod parts;
mod register;
mod servo;
mod uart;
mod wheels;

pub use notes::Note;

use crate::bus::Bus;
use crate::light::Lit;
use crate::maxsonar::Ranging;
use crate::obstacle::Seen;
use crate::remote::Remote;
use crate::sonar_fault::SonarFaults;
use crate::wire_fault::WireFaults;
use crate::wiring::Divider;
use bridge::HalfBridge;
use console::Console;
use echo::Echoes;
use firmware::Firmware;
use inputs::Announced;
use marks::Marks;
use meters::Meters;
use pins::{LinkOn, Wires};
use register::Register;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::devices::{Cause, Input};
use rumbo_emulator::verdict::Verdict;
use rumbo_plant::drivetrain::{Bridge, Modulation, Side};
use rumbo_plant::noise::Noise;
use rumbo_plant::sonar::SonarId;
use servo::ServoInput;
use std::sync::Arc;
use wheels::Driven;

/// The USART of the USB port.
pub const USB: u8 = 0;
/// In place of a USART: the Bluetooth module on other pins.
pub const ON_PINS: u8 = 4;
/// In place of a USART: what a person works at the robot, and what its displays show, by lines `name=value`.
pub const PARTS: u8 = 5;
/// The consoles: of the USARTs, of the module on other pins, of the displays.
pub const CONSOLES: u8 = 6;
/// The boards' clock is 16 MHz.
pub const CYCLES_PER_US: u64 = 16;
/// Battery at which the chip's brown-out detector, set to 2.7 V by the boards' fuses, resets it: the regulator drops 1.1 V.
const BROWN_OUT_V: f64 = 3.8;
/// Cost of an output that the robot feels: the plant follows to its instant.
pub const ACT: u64 = 10;
/// A sonar's trigger is to be high for 10 us (HC-SR04 user's manual).
const TRIGGER_CYCLES: u64 = 10 * CYCLES_PER_US;
/// The shortest that fires: published robots measure with two `digitalWrite()` in a row, 3.7 us on a Uno.
const FIRING_CYCLES: u64 = 2 * CYCLES_PER_US;
/// The rate of a terminal at a USART that does not receive \[baud\].
const UNSET_BAUD: u32 = 9600;
/// A digital input is high above half of the supply \[V\].
const LOGIC_V: f64 = 2.5;
/// An input goes into the chip's queue this long before its cycle: until then nothing the chip does can change it.
const AHEAD_CYCLES: u64 = CYCLES_PER_US;

/// An action of the chip on the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Action {
    /// A half of the bridge is driven in another way, with this PWM.
    Bridge(Side, Bridge, Modulation),
    /// A pulse to the servo: where it is to point [rad], 0 ahead, positive to the left.
    Servo(f64),
    /// A trigger pulse has ended.
    Trigger(SonarId),
}

/// Why [`Mega::run`] returned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pause {
    /// The time is reached.
    Reached,
    /// There are actions, all at this time [us].
    Act(u64),
    /// A debugger has the program: time stands still here [us].
    Halted(u64),
}

/// A board with its program.
#[derive(Clone, Debug)]
pub struct Mega {
    chip: Chip,
    firmware: Arc<Firmware>,
    /// The chip's cycle at the plant's time 0.
    zero_cycle: u64,
    bridges: [HalfBridge; 2],
    /// That of a motor shield.
    register: Register,
    driven: [(Bridge, Modulation); 2],
    servo: ServoInput,
    triggers: [Option<u64>; SonarId::ALL.len()],
    /// Levels of the encoders, as [`Wires::encoders`].
    encoders: [bool; 4],
    echoes: Echoes,
    announced: Announced,
    actions: Vec<Action>,
    /// Bytes that the module has received from the chip, and when [us].
    sent: Vec<(u64, u8)>,
    consoles: [Console; CONSOLES as usize],
    /// What the module hears on the pin of `link_tx`, where that is no USART's.
    module: uart::Receiver,
    meters: Meters,
    /// The devices on the two-wire bus.
    bus: Bus,
    /// How dark it is below each line sensor, and the level that it gives.
    floor: Vec<(f64, bool)>,
    /// The pins of those that a program charges.
    charges: Vec<floor::Charge>,
    /// What each sensor for obstacles sees.
    obstacles: Vec<Option<Seen>>,
    /// What each light sensor sees and gives.
    light: Vec<Option<Lit>>,
    /// What each range finder does that measures by itself.
    ranging: Vec<Ranging>,
    /// What has been set of each part.
    worked: Vec<f64>,
    /// The remote controls, each with the number of its part.
    remotes: Vec<(usize, Remote)>,
    verdict: Option<Verdict>,
    /// When the program reached the functions of interest.
    marks: Marks,
    /// How the motors were driven.
    driven_ways: Driven,
    /// What its program did that a note tells.
    oddities: notes::Oddities,
    /// What its outputs have cost so far.
    toil: u64,
    /// The program does one instruction and halts.
    stepping: bool,
    /// The program halts at this cycle of the crystal.
    halt_at: Option<u64>,
    /// Why the program stands, until a debugger lets it go on.
    halt: Option<Stopped>,
}

impl Mega {
    /// A board that has just been switched on; `encoders` are the levels of the encoders.
    pub(crate) fn new(firmware: Arc<Firmware>, encoders: [bool; 4]) -> Self {
        let mut chip = Chip::new(firmware.image());
        chip.watch(&firmware.wires().felt());
        let shield = firmware.wires().driver.shield;
        let shield = shield.and_then(|shield| shield.address);
        let on_bus = firmware.bus().iter().any(|own| own.address().is_some());
        chip.watch_two_wire(on_bus || shield.is_some());
        let Wires {
            driver, bridges, ..
        } = *firmware.wires();
        let mut mega = Self {
            chip,
            zero_cycle: 0,
            register: Register::default(),
            bridges: bridges.map(|inputs| HalfBridge::new(driver, inputs)),
            driven: [(Bridge::Released, Modulation::default()); 2],
            servo: ServoInput::default(),
            triggers: Default::default(),
            encoders: [false; 4],
            echoes: Echoes::default(),
            announced: Announced::default(),
            actions: Vec::new(),
            sent: Vec::new(),
            consoles: Default::default(),
            module: uart::Receiver::new(firmware.link_baud()),
            meters: Meters::at(firmware.metered()),
            bus: Bus::new(firmware.bus(), shield),
            floor: Vec::new(),
            charges: floor::Charge::of(&firmware),
            obstacles: Vec::new(),
            light: Vec::new(),
            ranging: Vec::new(),
            worked: Vec::new(),
            remotes: Vec::new(),
            verdict: None,
            marks: Marks::default(),
            driven_ways: Driven::default(),
            oddities: notes::Oddities::default(),
            toil: 0,
            stepping: false,
            halt_at: None,
            halt: None,
            firmware,
        };
        let idle = mega.wires().held_high.into_iter().flatten();
        let idle = idle.chain(mega.firmware.board().pulled_up());
        for pin in idle.collect::<Vec<_>>() {
            mega.chip.input(0, Input::Pin(pin, Some(true)));
        }
        mega.set_out_parts();
        // The boot loader's wait is over before the run begins, as when the robot is switched on before the laptop.
        mega.chip.pass_boot_loader(firmware::LONGEST_BOOT);
        mega.chip.take_outputs();
        mega.begin(mega.chip.cycle(), encoders);
        mega
    }

    /// The clock of the plant starts over at this cycle: lines are as they are at a start.
    fn begin(&mut self, cycle: u64, encoders: [bool; 4]) {
        self.zero_cycle = cycle;
        self.look_ahead();
        self.echoes = Echoes::default();
        self.light.clear();
        self.ranging.clear();
        self.encoders = encoders;
        let wires = self.wires();
        let encoders = wires.encoders.into_iter().zip(encoders);
        let echoes = wires.echoes.into_iter().map(|pin| (pin, false));
        for (pin, level) in encoders.chain(echoes).collect::<Vec<_>>() {
            self.put(cycle, pin, level);
        }
    }

    /// Restarts the plant's clock; the chip's outputs stay as they are.
    pub(crate) fn restart_clock(&mut self, encoders: [bool; 4]) {
        let cycle = self.chip.cycle();
        self.begin(cycle, encoders);
        for index in 0..2 {
            self.driven[index] = (Bridge::Released, Modulation::default());
        }
        self.drive();
    }

    fn wires(&self) -> &Wires {
        self.firmware.wires()
    }

    /// The program.
    pub fn firmware(&self) -> &Firmware {
        &self.firmware
    }

    /// The chip, to look at.
    pub fn chip(&self) -> &Chip {
        &self.chip
    }

    /// The chip, as a debugger holds it.
    pub fn chip_mut(&mut self) -> &mut Chip {
        &mut self.chip
    }

    /// Makes the program run one instruction and halt.
    pub fn step(&mut self) {
        self.stepping = true;
    }

    /// Makes the program halt at a cycle of the crystal, or lets it pass.
    pub fn halt_at(&mut self, cycle: Option<u64>) {
        self.halt_at = cycle;
    }

    /// Why the program is halted; it continues at the next advance.
    pub fn take_halt(&mut self) -> Option<Stopped> {
        self.halt.take()
    }

    /// What the chip's outputs have cost so far: one for each, and as much as [`ACT`] for each time that the robot felt one.
    /// The same program has the same cost on every machine.
    pub fn toil(&self) -> u64 {
        self.toil
    }

    /// How the program ended, if it could not go on: what, where, when.
    pub fn verdict(&self) -> Option<Note> {
        let verdict = self.verdict.as_ref()?;
        let detail = verdict.describe(self.firmware.image());
        Some(match verdict {
            Verdict::ErasedFlash { .. } => Note::ErasedFlash { detail },
            Verdict::IllegalInstruction { .. } => Note::IllegalInstruction { detail },
            Verdict::StackOverflow { .. } => Note::StackOverflow { detail },
        })
    }

    /// The chip's cycle at time 0 of the simulation.
    pub fn zero_cycle(&self) -> u64 {
        self.zero_cycle
    }

    /// Connects a pin of the board, by its number, to a voltage between 0 and 5 \[V\]: a level for its digital input, and
    /// what the converter reads where it has one. `None` takes it away: the pin floats, or follows its pull-up. False: the
    /// board has no such pin.
    pub fn apply(&mut self, number: u8, volts: Option<f64>) -> bool {
        let board = self.firmware.board();
        let cycle = self.chip.cycle();
        let (pin, channel) = (board.pin(number), board.channel(number));
        if let Some(pin) = pin {
            let level = volts.map(|volts| volts > LOGIC_V);
            self.meters.set(cycle, pin, level.unwrap_or_default());
            self.chip.input(cycle, Input::Pin(pin, level));
        }
        if let (Some(channel), Some(volts)) = (channel, volts) {
            self.chip.input(cycle, Input::Volts { channel, volts });
        }
        pin.is_some() || channel.is_some()
    }

    /// Drains what USART `usart` has sent, whatever it is connected to.
    pub fn take_console(&mut self, usart: u8) -> Vec<u8> {
        let console = self.consoles.get_mut(usize::from(usart));
        console.map(Console::take).unwrap_or_default()
    }

    /// What the instruments at the wired pins show since the last reading.
    pub(crate) fn read_meters(&mut self) -> Vec<(String, f64)> {
        let mut shown = self.meters.read(self.chip.cycle());
        shown.extend(self.read_floor());
        shown.extend(self.read_obstacles());
        shown.extend(self.read_light());
        shown.extend(self.read_ranges());
        shown.extend(self.read_bus());
        shown
    }

    /// Sends bytes to a USART from a terminal that is set to its rate, as the Serial Monitor is; to [`PARTS`] what a person
    /// does with them.
    pub fn type_in(&mut self, usart: u8, bytes: &[u8]) {
        if usart == PARTS {
            return self.work_parts(bytes);
        }
        let cycle = self.chip.cycle();
        let baud = self.chip.devices().receiving_baud(usart);
        let baud = baud.map_or(UNSET_BAUD, |baud| baud.round() as u32);
        for byte in bytes {
            let byte = *byte;
            self.chip.input(cycle, Input::Serial { usart, byte, baud });
        }
    }

    /// A byte whose last bit reaches the link's USART at this time [us], sent at `baud`.
    pub(crate) fn receive(&mut self, at_us: u64, byte: u8, baud: u32) {
        let frame = 10 * 1_000_000 * CYCLES_PER_US / u64::from(baud.max(1));
        let begin = self.cycle_of(at_us).saturating_sub(frame);
        match self.wires().link {
            Some(LinkOn::Usart(usart)) => {
                self.chip.input(begin, Input::Serial { usart, byte, baud });
            }
            Some(LinkOn::Pins { receive, .. }) => {
                for (cycle, level) in uart::frame(begin, byte, baud) {
                    self.put(cycle, receive, level);
                }
            }
            None => {}
        }
    }

    /// Drains the bytes that the module has received, each with the time of its last bit [us].
    pub(crate) fn take_sent(&mut self) -> Vec<(u64, u8)> {
        std::mem::take(&mut self.sent)
    }

    /// Drains the actions for which the run paused.
    pub(crate) fn take_actions(&mut self) -> Vec<Action> {
        std::mem::take(&mut self.actions)
    }

    /// Sets the battery's voltage: at the analogue input with the divider, and as the chip's supply.
    pub(crate) fn supply(&mut self, battery_v: f64) {
        if battery_v < BROWN_OUT_V {
            let cycle = self.chip.cycle();
            self.chip.input(cycle, Input::Reset(Cause::BrownOut));
        }
        if let Some(Divider { input, ratio }) = self.wires().battery {
            let (channel, volts) = (input, battery_v / ratio);
            let cycle = self.chip.cycle();
            self.chip.input(cycle, Input::Volts { channel, volts });
        }
    }

    fn cycle_of(&self, us: u64) -> u64 {
        self.zero_cycle + us * CYCLES_PER_US
    }

    /// Runs the chip to a time [us], or to the first action before it.
    pub(crate) fn run(&mut self, until_us: u64, faults: &mut Faults<'_>) -> Pause {
        let until = self.cycle_of(until_us);
        loop {
            let now = self.chip.cycle();
            if self.halt_at.is_some_and(|at| now >= at) {
                self.halt_at = None;
                self.halt = Some(Stopped::Reached);
            }
            if self.halt.is_some() {
                let at_us = (now - self.zero_cycle) / CYCLES_PER_US;
                return Pause::Halted(at_us.min(until_us));
            }
            if self.verdict.is_some() || now >= until {
                self.deliver_up_to(until, faults);
                return Pause::Reached;
            }
            self.deliver_up_to(now + AHEAD_CYCLES, faults);
            let waves = self.bridges.iter().filter_map(HalfBridge::expires_cycle);
            let target = waves
                .chain(self.next_input().map(|cycle| cycle - AHEAD_CYCLES))
                .chain(self.halt_at)
                .fold(until, u64::min);
            let stepping = std::mem::take(&mut self.stepping);
            let stopped = if stepping {
                self.chip.step()
            } else {
                self.chip.run_until(target.max(now + 1))
            };
            let passed = stopped == Stopped::Breakpoint && self.pass_mark();
            let acted = self.listen();
            if let Stopped::Ended(verdict) = &stopped {
                self.verdict = Some(verdict.clone());
            } else if stepping
                || matches!(stopped, Stopped::Watched { .. })
                || (stopped == Stopped::Breakpoint && !passed)
            {
                self.halt = Some(stopped);
            }
            if let Some(cycle) = acted {
                let at_us = (cycle - self.zero_cycle).div_ceil(CYCLES_PER_US);
                return Pause::Act(at_us.min(until_us));
            }
        }
    }
}

/// The faults of sonars and wires, and the noise they draw from.
pub(crate) struct Faults<'a> {
    pub(crate) sonars: &'a mut SonarFaults,
    pub(crate) wires: &'a mut WireFaults,
    pub(crate) noise: &'a Noise,
}
