//! An emulated Arduino Mega at the robot's pins: the chip of `rumbo-emulator`, wired as the robot file says.
//!
//! ```text
//! plant events ──► encoder and echo pins, at their cycle ──► chip ──► enable and direction pins ──► bridges
//!                                                             │  └──► trigger and servo pins ──► sonars, servo
//!                       Bluetooth module ◄── USART of the link ┘
//! ```
//!
//! | file | part |
//! |---|---|
//! | [`pins`] | the board's pin numbers, a wiring as pins of the chip |
//! | `bridge`, `servo`, `module` | what driver, servo and Bluetooth module make of their lines |
//! | `echo` | echo lines, and sonars that fail |
//! | `console` | what the USARTs said, for people |
//! | `marks` | when the program comes to some of its functions |
//! | `notes` | what is odd about a program, for people |
//! | [`firmware`] | a program image, the language it speaks, the wiring it is for |
//!
//! `Mega::run` runs the chip until something happens that the plant must know of, so that the plant can follow to the same
//! microsecond before anything else happens: see `sim::emulated`.

mod console;
pub mod firmware;
pub mod pins;

mod bridge;
mod echo;
mod marks;
mod module;
mod notes;
mod servo;

use crate::files::Divider;
use crate::sonar_fault::SonarFaults;
use crate::wire_fault::{Wire, WireFaults};
use bridge::HalfBridge;
use console::Console;
use echo::Echoes;
use firmware::Firmware;
use marks::Marks;
use pins::Wires;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::devices::ports::{Drive, Pin};
use rumbo_emulator::devices::{Cause, Event, Input, Output, Pwm};
use rumbo_emulator::verdict::Verdict;
use rumbo_plant::drivetrain::{Bridge, Side};
use rumbo_plant::noise::Noise;
use rumbo_plant::sonar::SonarId;
use servo::ServoInput;
use std::collections::VecDeque;
use std::sync::Arc;

/// The Mega's clock is 16 MHz.
pub const CYCLES_PER_US: u64 = 16;
/// Battery at which the chip's brown-out detector, set to 2.7 V by the Mega's fuses, resets it: the regulator drops 1.1 V.
const BROWN_OUT_V: f64 = 3.8;
/// A sonar needs its trigger high for 10 us (HC-SR04 user's manual); what is shorter it may ignore.
const TRIGGER_CYCLES: u64 = 10 * CYCLES_PER_US;
/// An input goes into the chip's queue this long before its cycle: until then nothing the chip does can change it.
const AHEAD_CYCLES: u64 = CYCLES_PER_US;

/// Something the chip did that the robot feels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Action {
    /// A half of the bridge is driven in another way, at this frequency of the PWM [Hz].
    Bridge(Side, Bridge, Option<f64>),
    /// A pulse to the servo: where it is to point [rad], 0 ahead, positive to the left.
    Servo(f64),
    /// A trigger pulse has ended.
    Trigger(SonarId),
}

/// Why [`Mega::run`] came back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pause {
    /// The time is reached.
    Reached,
    /// There are actions, all at this time [us].
    Act(u64),
    /// A debugger has the program: time stands still here [us].
    Halted(u64),
}

/// An edge that the plant announces.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Edge {
    Encoder(usize, bool),
    Echo(SonarId, bool),
}

/// A Mega with its program.
#[derive(Clone, Debug)]
pub struct Mega {
    chip: Chip,
    firmware: Arc<Firmware>,
    /// The chip's cycle at the plant's time 0.
    zero_cycle: u64,
    bridges: [HalfBridge; 2],
    driven: [(Bridge, Option<f64>); 2],
    servo: ServoInput,
    triggers: [Option<u64>; 3],
    encoders: [bool; 2],
    echoes: Echoes,
    expected: VecDeque<(u64, Edge)>,
    /// Those of them that the chip has been given since.
    given: Vec<Edge>,
    actions: Vec<Action>,
    /// What the module has heard from the chip, and when [us].
    sent: Vec<(u64, u8)>,
    consoles: [Console; 4],
    verdict: Option<Verdict>,
    /// When the program came to the functions that were asked for.
    marks: Marks,
    /// A motor was driven.
    has_driven: bool,
    /// The program does one instruction and halts.
    stepping: bool,
    /// Why the program stands, until a debugger lets it go on.
    halt: Option<Stopped>,
}

impl Mega {
    /// A Mega that has just been switched on; `encoders` are the levels of both Hall sensors, left and right.
    pub(crate) fn new(firmware: Arc<Firmware>, encoders: [bool; 2]) -> Self {
        let mut chip = Chip::new(firmware.image());
        chip.watch(&firmware.wires().felt());
        let mut mega = Self {
            chip,
            zero_cycle: 0,
            bridges: Default::default(),
            driven: [(Bridge::Released, None); 2],
            servo: ServoInput::default(),
            triggers: [None; 3],
            encoders: [false; 2],
            echoes: Echoes::default(),
            expected: VecDeque::new(),
            given: Vec::new(),
            actions: Vec::new(),
            sent: Vec::new(),
            consoles: Default::default(),
            verdict: None,
            marks: Marks::default(),
            has_driven: false,
            stepping: false,
            halt: None,
            firmware,
        };
        for pin in mega.wires().receivers.into_iter().flatten() {
            mega.chip.input(0, Input::Pin(pin, Some(true)));
        }
        // A boot loader's wait is over before the run begins, as for somebody who switches the robot on and then goes to the laptop.
        mega.chip.pass_boot_loader(firmware::LONGEST_BOOT);
        mega.chip.take_outputs();
        mega.begin(mega.chip.cycle(), encoders);
        mega
    }

    /// The clock of the plant starts over at this cycle: lines are as they are at a start.
    fn begin(&mut self, cycle: u64, encoders: [bool; 2]) {
        self.zero_cycle = cycle;
        self.expected.clear();
        self.echoes = Echoes::default();
        self.encoders = encoders;
        let wires = self.wires();
        let encoders = wires.encoders.into_iter().zip(encoders);
        let echoes = wires.echoes.into_iter().map(|pin| (pin, false));
        for (pin, level) in encoders.chain(echoes).collect::<Vec<_>>() {
            self.put(cycle, pin, level);
        }
    }

    /// The plant's clock starts over now; what the chip drives goes on.
    pub(crate) fn restart_clock(&mut self, encoders: [bool; 2]) {
        let cycle = self.chip.cycle();
        self.begin(cycle, encoders);
        for index in 0..2 {
            self.driven[index] = (Bridge::Released, None);
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

    /// From here on the program does one instruction, and halts.
    pub(crate) fn step(&mut self) {
        self.stepping = true;
    }

    /// Why the program stands; it goes on at the next advance.
    pub(crate) fn take_halt(&mut self) -> Option<Stopped> {
        self.halt.take()
    }

    /// How the program ended, if it could not go on: what, where, when.
    pub fn verdict(&self) -> Option<String> {
        let verdict = self.verdict.as_ref()?;
        let name = self.firmware.name();
        let verdict = verdict.told(self.firmware.image());
        Some(format!("firmware {name}: {verdict}"))
    }

    /// What USART `usart` has sent since it was last asked, whatever it is connected to.
    pub fn take_console(&mut self, usart: u8) -> Vec<u8> {
        let console = self.consoles.get_mut(usize::from(usart));
        console.map(Console::take).unwrap_or_default()
    }

    /// Sends bytes to a USART from a terminal at the rate at which it last spoke.
    pub fn type_in(&mut self, usart: u8, bytes: &[u8]) {
        let Some(console) = self.consoles.get(usize::from(usart)) else {
            return;
        };
        let (cycle, baud) = (self.chip.cycle(), console.baud());
        for byte in bytes {
            let byte = *byte;
            self.chip.input(cycle, Input::Serial { usart, byte, baud });
        }
    }

    /// A byte whose last bit reaches the link's USART at this time [us], sent at `baud`.
    pub(crate) fn receive(&mut self, at_us: u64, byte: u8, baud: u32) {
        let Some(usart) = self.wires().link else {
            return;
        };
        let frame = 10 * 1_000_000 * CYCLES_PER_US / u64::from(baud.max(1));
        let begin = self.cycle_of(at_us).saturating_sub(frame);
        self.chip.input(begin, Input::Serial { usart, byte, baud });
    }

    /// What the module has heard since it was last asked: when the last bit came [us], and what.
    pub(crate) fn take_sent(&mut self) -> Vec<(u64, u8)> {
        std::mem::take(&mut self.sent)
    }

    /// The actions that the pause spoke of.
    pub(crate) fn take_actions(&mut self) -> Vec<Action> {
        std::mem::take(&mut self.actions)
    }

    /// The battery's voltage from now on: where a divider brings it to an analogue input, and as what the chip lives on.
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

    /// An edge that comes unless the chip does something before.
    pub(crate) fn expect(&mut self, event: rumbo_plant::plant::Event) {
        let edge = edge_of(event);
        self.expected.extend(edge.map(|edge| (event.at_us(), edge)));
    }

    /// All edges up to `now_us` that the plant gave after all: what had been announced otherwise is put right.
    pub(crate) fn correct(&mut self, event: rumbo_plant::plant::Event, faults: &mut Faults<'_>) {
        let Some(edge) = edge_of(event) else { return };
        // One after the other: where a line has changed twice meanwhile, its level now says nothing of the first edge.
        if let Some(at) = self.given.iter().position(|given| *given == edge) {
            self.given.remove(at);
            return;
        }
        let known = match edge {
            Edge::Encoder(index, level) => self.encoders[index] == level,
            Edge::Echo(sonar, level) => self.echoes.level(sonar) == level,
        };
        if !known {
            self.deliver(event.at_us(), edge, faults);
        }
    }

    /// Takes back what was announced and not given yet.
    pub(crate) fn expect_nothing(&mut self) {
        self.expected.clear();
    }

    /// The plant looks ahead anew: what the chip was given until now has happened.
    pub(crate) fn look_ahead(&mut self) {
        self.given.clear();
    }

    /// Runs the chip to a time [us], or to the first action before it.
    pub(crate) fn run(&mut self, until_us: u64, faults: &mut Faults<'_>) -> Pause {
        let until = self.cycle_of(until_us);
        loop {
            let now = self.chip.cycle();
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

    /// The cycle of the next input that is known of.
    fn next_input(&self) -> Option<u64> {
        let expected = self.expected.front().map(|(at_us, _)| *at_us);
        let forced = self.echoes.next_forced_us();
        let next = expected.into_iter().chain(forced).min();
        next.map(|at_us| self.cycle_of(at_us))
    }

    /// Puts the edges up to a cycle into the chip's queue.
    fn deliver_up_to(&mut self, cycle: u64, faults: &mut Faults<'_>) {
        while self.next_input().is_some_and(|next| next <= cycle) {
            let forced = self.echoes.next_forced_us();
            match self.expected.front().copied() {
                Some((at_us, edge)) if forced.is_none_or(|forced| at_us <= forced) => {
                    self.expected.pop_front();
                    self.given.push(edge);
                    self.deliver(at_us, edge, faults);
                }
                _ => {
                    if let Some((at_us, sonar)) = self.echoes.take_forced() {
                        let pin = self.wires().echoes[sonar.index()];
                        self.put(self.cycle_of(at_us), pin, false);
                    }
                }
            }
        }
    }

    fn deliver(&mut self, at_us: u64, edge: Edge, faults: &mut Faults<'_>) {
        let (wire, level) = match edge {
            Edge::Encoder(index, level) => {
                self.encoders[index] = level;
                (Wire::Encoder([Side::Left, Side::Right][index]), level)
            }
            Edge::Echo(sonar, level) => {
                if !self.echoes.edge(sonar, level, at_us, faults) {
                    return;
                }
                (
                    Wire::Echo(rumbo_control::SonarId::ALL[sonar.index()]),
                    level,
                )
            }
        };
        if faults.wires.passes(faults.noise, wire, at_us) {
            self.put(self.cycle_of(at_us), self.pin_of(wire), level);
        }
    }

    fn pin_of(&self, wire: Wire) -> Option<Pin> {
        match wire {
            Wire::Encoder(side) => self.wires().encoders[side.index()],
            Wire::Echo(sonar) => self.wires().echoes[sonar as usize],
        }
    }

    /// What befalls the wires until then, from now on: they get stuck, or pick up noise.
    pub(crate) fn disturb(&mut self, from_us: u64, to_us: u64, faults: &mut Faults<'_>) {
        for (at_us, wire, level) in faults.wires.stuck(from_us, to_us) {
            self.put(self.cycle_of(at_us), self.pin_of(wire), level);
        }
        for (begin_us, end_us, wire) in faults.wires.pulses(faults.noise, from_us) {
            let level = match wire {
                Wire::Encoder(side) => self.encoders[side.index()],
                Wire::Echo(sonar) => self.echoes.level(SonarId::ALL[sonar as usize]),
            };
            for (at_us, level) in [(begin_us, !level), (end_us, level)] {
                self.put(self.cycle_of(at_us), self.pin_of(wire), level);
            }
        }
    }

    fn put(&mut self, cycle: u64, pin: Option<Pin>, level: bool) {
        if let Some(pin) = pin {
            self.chip.input(cycle, Input::Pin(pin, Some(level)));
        }
    }

    /// Takes in what the chip has done; gives the cycle of the last action.
    fn listen(&mut self) -> Option<u64> {
        let mut acted = None;
        let outputs = self.chip.take_outputs();
        for Output { cycle, event } in outputs {
            let before = self.actions.len();
            match event {
                Event::Pin(pin, drive) => {
                    self.level(cycle, pin, matches!(drive, Drive::High | Drive::PullUp));
                }
                Event::Duty { pin, pwm } => self.modulate(pin, pwm),
                Event::Byte { usart, byte, baud } => self.hear(cycle, usart, byte as u8, baud),
                // The pins tell for themselves.
                Event::Reset(_) => {}
            }
            if self.actions.len() > before {
                acted = Some(cycle);
            }
        }
        let cycle = self.chip.cycle();
        let late = self.bridges.iter().filter_map(HalfBridge::expires_cycle);
        if late.min().is_some_and(|due| due <= cycle) {
            self.bridges.iter_mut().for_each(|half| half.expire(cycle));
        }
        let before = self.actions.len();
        self.drive();
        if self.actions.len() > before {
            acted = acted.or(Some(cycle));
        }
        acted
    }

    fn level(&mut self, cycle: u64, pin: Pin, high: bool) {
        if let Some(line) = self.line(pin) {
            line.set(cycle, high);
        }
        if self.wires().servo == Some(pin) {
            let angle_rad = self.servo.set(cycle, high);
            self.actions.extend(angle_rad.map(Action::Servo));
        }
        let triggers = self.wires().triggers;
        for sonar in SonarId::ALL {
            if triggers[sonar.index()] != Some(pin) {
                continue;
            }
            let rise = &mut self.triggers[sonar.index()];
            if high {
                rise.get_or_insert(cycle);
            } else if let Some(rise) = rise.take()
                && cycle - rise >= TRIGGER_CYCLES
            {
                self.actions.push(Action::Trigger(sonar));
            }
        }
    }

    fn modulate(&mut self, pin: Pin, pwm: Option<Pwm>) {
        if let Some(line) = self.line(pin) {
            line.modulate(pwm);
        }
    }

    fn line(&mut self, pin: Pin) -> Option<&mut bridge::Line> {
        let pins = self.firmware.wires().bridges;
        for (half, pins) in self.bridges.iter_mut().zip(pins) {
            let wired = [pins.enable, pins.forward, pins.backward];
            if let Some(at) = wired.iter().position(|wired| *wired == Some(pin)) {
                return Some(&mut half.lines[at]);
            }
        }
        None
    }

    /// Notes what the bridges do now that they did not before.
    fn drive(&mut self) {
        for (index, side) in [Side::Left, Side::Right].into_iter().enumerate() {
            let state = self.bridges[index].state();
            if state != self.driven[index] {
                self.driven[index] = state;
                self.has_driven |= matches!(state.0, Bridge::Forward(_) | Bridge::Backward(_));
                self.actions.push(Action::Bridge(side, state.0, state.1));
            }
        }
    }

    fn hear(&mut self, cycle: u64, usart: u8, byte: u8, baud: f64) {
        if let Some(console) = self.consoles.get_mut(usize::from(usart)) {
            console.push(byte, baud);
        }
        if self.wires().link == Some(usart)
            && let Some(byte) = module::heard(byte, baud, firmware::LINK_BAUD)
        {
            let at_us = cycle
                .saturating_sub(self.zero_cycle)
                .div_ceil(CYCLES_PER_US);
            self.sent.push((at_us, byte));
        }
    }
}

/// The faults of sonars and wires, and the noise they draw from.
pub(crate) struct Faults<'a> {
    pub(crate) sonars: &'a mut SonarFaults,
    pub(crate) wires: &'a mut WireFaults,
    pub(crate) noise: &'a Noise,
}

fn edge_of(event: rumbo_plant::plant::Event) -> Option<Edge> {
    use rumbo_plant::plant::Event;
    match event {
        Event::Edge { wheel, level, .. } => Some(Edge::Encoder(wheel.index(), level)),
        Event::EchoRise { sonar, .. } => Some(Edge::Echo(sonar, true)),
        Event::EchoFall { sonar, .. } => Some(Edge::Echo(sonar, false)),
        Event::Contact { .. } => None,
    }
}
