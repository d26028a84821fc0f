//! Outputs of the chip's pins and USARTs, as actions on the robot.

use super::bridge::{self, HalfBridge};
use super::pins::{DriverInput, LinkOn};
use super::{ACT, Action, CYCLES_PER_US, FIRING_CYCLES, Mega, ON_PINS, USB, module};
use rumbo_emulator::devices::ports::{Drive, Pin};
use rumbo_emulator::devices::{Event, Output, Pwm};
use rumbo_plant::drivetrain::Side;
use rumbo_plant::sonar::SonarId;

impl Mega {
    /// Processes the chip's outputs; returns the cycle of the last action.
    pub(super) fn listen(&mut self) -> Option<u64> {
        let mut acted = None;
        let outputs = self.chip.take_outputs();
        self.toil += outputs.len() as u64;
        for Output { cycle, event } in outputs {
            let before = self.actions.len();
            match event {
                Event::Pin(pin, drive) => {
                    self.charge(cycle, pin, drive);
                    self.level(cycle, pin, matches!(drive, Drive::High | Drive::PullUp));
                    let board = self.firmware.board();
                    self.bus
                        .steer(cycle, drive, |number| board.pin(number) == Some(pin));
                }
                Event::Duty { pin, pwm } => self.modulate(cycle, pin, pwm),
                Event::Byte { usart, byte, baud } => self.byte_sent(cycle, usart, byte as u8, baud),
                Event::TwoWire(transfer) => self.transfer(cycle, transfer),
                // What it does to the pins comes as their own events.
                Event::Reset(cause) => self.oddities.reset(cause),
            }
            if self.actions.len() > before {
                acted = Some(cycle);
            }
        }
        let cycle = self.chip.cycle();
        if self.heard().is_some() {
            self.hear(cycle, None);
        }
        let late = self.bridges.iter().filter_map(HalfBridge::expires_cycle);
        if late.min().is_some_and(|due| due <= cycle) {
            self.bridges.iter_mut().for_each(|half| half.expire(cycle));
        }
        let before = self.actions.len();
        self.drive();
        if self.actions.len() > before {
            acted = acted.or(Some(cycle));
        }
        if acted.is_some() {
            self.toil += ACT;
        }
        acted
    }

    fn level(&mut self, cycle: u64, pin: Pin, high: bool) {
        self.meters.set(cycle, pin, high);
        self.each_line(DriverInput::Pin(pin), |line| line.set(cycle, high));
        self.shift(cycle, pin, high);
        if self.heard() == Some(pin) {
            self.hear(cycle, Some(high));
        }
        if self.wires().servo == Some(pin) {
            let sign = if self.wires().servo_reversed {
                -1.0
            } else {
                1.0
            };
            let angle_rad = self.servo.set(cycle, high);
            self.actions
                .extend(angle_rad.map(|rad| Action::Servo(sign * rad)));
        }
        let triggers = self.wires().triggers;
        for sonar in SonarId::ALL {
            if triggers[sonar.index()] != Some(pin) {
                continue;
            }
            let rise = &mut self.triggers[sonar.index()];
            if high {
                rise.get_or_insert(cycle);
            } else if let Some(rise) = rise.take() {
                let high = cycle - rise;
                self.oddities.triggered(high);
                if high >= FIRING_CYCLES {
                    self.actions.push(Action::Trigger(sonar));
                }
            }
        }
    }

    fn modulate(&mut self, cycle: u64, pin: Pin, pwm: Option<Pwm>) {
        self.meters.modulate(cycle, pin, pwm);
        self.each_line(DriverInput::Pin(pin), |line| line.modulate(pwm));
    }

    /// A pin of a shield's register, if it is one.
    fn shift(&mut self, cycle: u64, pin: Pin, high: bool) {
        let lines = self.wires().register;
        let Some(line) = lines.and_then(|lines| lines.iter().position(|own| *own == pin)) else {
            return;
        };
        let before = self.register.outputs();
        self.register.set(line, high);
        let outputs = self.register.outputs();
        for bit in (0..8).filter(|bit| (before ^ outputs) >> bit & 1 != 0) {
            let level = outputs >> bit & 1 != 0;
            self.each_line(DriverInput::Register(bit), |line| line.set(cycle, level));
        }
    }

    /// Does something to the driver's inputs that are connected so.
    fn each_line(&mut self, on: DriverInput, mut act: impl FnMut(&mut bridge::Line)) {
        let wired = self.firmware.wires().bridges;
        for (half, inputs) in self.bridges.iter_mut().zip(wired) {
            for (line, input) in half.lines.iter_mut().zip(inputs) {
                if input == on {
                    act(line);
                }
            }
        }
    }

    /// Notes what the bridges do now that they did not before.
    pub(super) fn drive(&mut self) {
        for (index, side) in [Side::Left, Side::Right].into_iter().enumerate() {
            let state = self.bridges[index].state();
            if state != self.driven[index] {
                self.driven[index] = state;
                self.driven_ways.set(self.chip.cycle(), index, state.0);
                self.actions.push(Action::Bridge(side, state.0, state.1));
            }
        }
    }

    /// What the bridges are to do now.
    pub(crate) fn driven(&self) -> [Action; 2] {
        let [left, right] = self.driven;
        [(Side::Left, left), (Side::Right, right)]
            .map(|(side, (bridge, modulation))| Action::Bridge(side, bridge, modulation))
    }

    fn byte_sent(&mut self, cycle: u64, usart: u8, byte: u8, baud: f64) {
        let is_link = self.wires().link == Some(LinkOn::Usart(usart));
        let link_baud = f64::from(self.firmware.link_baud());
        let passed_on = match is_link && !module::understands(baud, link_baud) {
            true => {
                self.oddities.sent_at(baud, link_baud);
                module::decode(byte, baud, link_baud)
            }
            false => Some(byte),
        };
        // Behind the module a person reads what it passes on, at a USB cable what the chip sends.
        let read = if usart == USB { Some(byte) } else { passed_on };
        if let (Some(console), Some(byte)) = (self.consoles.get_mut(usize::from(usart)), read) {
            console.push(byte);
        }
        if let (true, Some(byte)) = (is_link, passed_on) {
            self.pass_on(cycle, byte);
        }
    }

    /// The module has received a byte.
    fn pass_on(&mut self, cycle: u64, byte: u8) {
        let at_us = cycle
            .saturating_sub(self.zero_cycle)
            .div_ceil(CYCLES_PER_US);
        self.sent.push((at_us, byte));
    }

    /// The module samples the pin of `link_tx`, which is no USART's, up to this cycle; then the pin has this level.
    fn hear(&mut self, cycle: u64, level: Option<bool>) {
        if let Some((at, byte)) = self.module.pass(cycle) {
            self.consoles[usize::from(ON_PINS)].push(byte);
            self.pass_on(at, byte);
        }
        if let Some(level) = level {
            self.module.set(cycle, level);
        }
    }

    /// The pin of `link_tx`, where that is no USART's.
    fn heard(&self) -> Option<Pin> {
        match self.wires().link? {
            LinkOn::Pins { transmit, .. } => transmit,
            LinkOn::Usart(_) => None,
        }
    }
}
