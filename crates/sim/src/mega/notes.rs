//! What is odd about a program on the robot, a line each: registers that are not modelled, motors and links that it never used.

use super::console::Console;
use super::firmware::LinkLanguage;
use super::pins::LinkOn;
use super::{CYCLES_PER_US, Mega, PARTS, TRIGGER_CYCLES};
use crate::floor::FloorReading;
use crate::wiring::PartKind;
use rumbo_emulator::cpu::Standstill;
use rumbo_emulator::devices::ports::Drive;
use rumbo_emulator::devices::{Cause, Unmodelled};
use std::collections::BTreeSet;

/// The USARTs as a sketch calls them, and the module on other pins.
const NAMES: [&str; PARTS as usize] = ["Serial (USB)", "Serial1", "Serial2", "Serial3", "its pins"];

/// What a program did that people wonder about.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Oddities {
    /// The shortest trigger of a sonar below what its data sheet asks for [cycles].
    short_trigger: Option<u64>,
    brown_outs: u32,
    watchdog_resets: u32,
    /// A rate at which the Bluetooth module does not understand the chip, and its own \[baud\].
    link_baud: Option<[f64; 2]>,
}

crate::notes! {
    /// How a program ended, or what is odd about it.
    Note {
        ErasedFlash { detail: String } "{detail}";
        IllegalInstruction { detail: String } "{detail}";
        StackOverflow { detail: String } "{detail}";
        ShortTrigger { us: String } "a trigger of a sonar was high for {us} us; the HC-SR04's data sheet asks for 10 us, and some modules do not answer a shorter one";
        BrownOuts { times: u32 } "the supply fell too low and reset the chip {times} times; start the motors more gently, or charge the battery";
        WatchdogResets { times: u32 } "the watchdog reset the chip {times} times; call wdt_reset() in time, or wdt_disable() at the start of setup()";
        LinkRate { sent: f64, own: f64 } "it sends over the Bluetooth link at {sent} baud; the module is set to {own}, and what it passes on is garbage: give begin() that rate";
        NoMotor { wiring: String } "it never drove a motor; are its pins those of wiring {wiring}? (docs/emulator.md)";
        NoLink { link: &'static str, wiring: String } "nothing came over the Bluetooth link, {link} in wiring {wiring}, on no other either";
        OtherLink { link: &'static str, wiring: String, others: String } "nothing came over the Bluetooth link, {link} in wiring {wiring}, but on {others}";
        Other { text: String } "{text}";
    }
}

impl From<String> for Note {
    fn from(text: String) -> Self {
        Self::Other { text }
    }
}

/// Resets by one cause that are more than a program's own way to restart.
const RESETS: u32 = 2;

impl Oddities {
    /// A sonar's trigger was high for so many cycles.
    pub(super) fn triggered(&mut self, high: u64) {
        if high < TRIGGER_CYCLES {
            self.short_trigger = Some(self.short_trigger.map_or(high, |short| short.min(high)));
        }
    }

    /// A byte went to the Bluetooth module at a rate that is not its own.
    pub(super) fn sent_at(&mut self, baud: f64, own: f64) {
        self.link_baud = Some([baud, own]);
    }

    /// The chip was reset.
    pub(super) fn reset(&mut self, cause: Cause) {
        match cause {
            Cause::BrownOut => self.brown_outs += 1,
            Cause::Watchdog => self.watchdog_resets += 1,
            _ => {}
        }
    }

    fn notes(&self) -> impl Iterator<Item = Note> {
        let short = self.short_trigger.map(|high| Note::ShortTrigger {
            us: format!("{:.1}", high as f64 / CYCLES_PER_US as f64),
        });
        let browned = (self.brown_outs >= RESETS).then_some(Note::BrownOuts {
            times: self.brown_outs,
        });
        let watched = (self.watchdog_resets >= RESETS).then_some(Note::WatchdogResets {
            times: self.watchdog_resets,
        });
        let garbled = self.link_baud.map(|[sent, own]| Note::LinkRate {
            sent: sent.round(),
            own: own.round(),
        });
        [short, browned, watched, garbled].into_iter().flatten()
    }
}

impl Mega {
    /// Registers that the emulator does not model, and what a program for this robot would have done.
    pub fn notes(&self) -> Vec<Note> {
        let image = self.firmware.image();
        let line = |access: &Unmodelled| {
            let done = if access.written { "written" } else { "read" };
            format!(
                "register 0x{:03x}, {done} at {}, is not modelled",
                access.address,
                image.place(access.program_counter)
            )
        };
        let strange = self.chip.unmodelled().iter().map(line);
        let strange = strange.chain(self.standstill()).chain(self.restarted());
        let strange = strange.chain(self.unsent()).chain(self.misframed());
        let strange = strange.chain(self.floating()).chain(self.overdriven());
        let strange = strange.map(Note::from);
        let notes = strange.chain(self.oddities.notes()).chain(self.silence());
        notes
            .chain(
                self.bus
                    .notes(self.chip.cycle())
                    .into_iter()
                    .map(Note::from),
            )
            .collect()
    }

    /// What of the robot was not identified from recordings.
    pub fn data_sheet(&self) -> Option<String> {
        let driver = self.firmware.wires().driver;
        let driver = driver
            .source
            .map(|_| format!("motor driver: {}", driver.in_words()));
        let sensors = self.firmware.line_sensors().first().map(|sensor| {
            match sensor.reading {
                FloorReading::Discharge => {
                    "line sensors: QTR-RC by what Pololu says of it, not identified"
                }
                _ => "line sensors: TCRT5000 modules by their data sheet, not identified",
            }
            .to_owned()
        });
        let obstacles = (!self.firmware.obstacle_sensors().is_empty()).then(|| {
            "sensors for obstacles: by what their sellers and Sharp's data sheet say, not identified"
                .to_owned()
        });
        let lights = (!self.firmware.light_sensors().is_empty())
            .then(|| "light sensors: GL5528 by its data sheet, not identified".to_owned());
        let ranges = (!self.firmware.maxsonars().is_empty())
            .then(|| "range finders: LV-MaxSonar-EZ1 by its data sheet, not identified".to_owned());
        let bus = self.firmware.bus().iter();
        let bus = bus.filter_map(|device| device.kind.data_sheet());
        let bus: BTreeSet<String> = bus.map(str::to_owned).collect();
        let all = [driver, sensors, obstacles, lights, ranges]
            .into_iter()
            .flatten();
        let all: Vec<String> = all.chain(bus).collect();
        (!all.is_empty()).then(|| all.join("; "))
    }

    /// Why the program has halted for good, if it has.
    pub fn standstill(&self) -> Option<String> {
        let still = self.chip.cpu().standstill()?;
        let place = (self.firmware.image()).place(self.chip.cpu().program_counter());
        Some(match still {
            Standstill::Asleep => format!(
                "it sleeps with interrupts off, before {place}: nothing wakes it; call sei() before sleep_cpu()"
            ),
            Standstill::End => format!(
                "it has ended at {place}: main() returned, or exit() was called, or it stops itself with cli() and an empty loop; main() needs a loop that never ends"
            ),
            Standstill::Loop => format!(
                "it stands in a loop of one instruction at {place} with interrupts off: only a reset leads on"
            ),
        })
    }

    /// That the program begins again and again, though nothing resets the chip.
    fn restarted(&self) -> Option<String> {
        /// `jmp 0`, where the C library has all interrupts lead that no function handles.
        const BAD_INTERRUPT: [u8; 4] = [0x0C, 0x94, 0, 0];
        let begun = self.chip.cpu().restarts();
        let (times, at) = begun.filter(|(times, _)| *times > RESETS)?;
        let place = self.firmware.image().place(at);
        let here = self.chip.cpu().flash().get(2 * at as usize..);
        let why = match here.is_some_and(|here| here.starts_with(&BAD_INTERRUPT)) {
            true => "an interrupt was on that no function handles",
            false => {
                "a function that is not there was called, or a pointer to one that is 0; with Arduino's core 1.8.3 and later \
                 `new` is not there where <new> or <new.h> is included: leave that line out"
            }
        };
        Some(format!(
            "it restarted {times} times without a reset, the last time from {place}: {why}"
        ))
    }

    /// What the module could not read on a pin that is no USART's.
    fn misframed(&self) -> Option<String> {
        let baud = self.firmware.link_baud();
        self.module.misframed().then(|| {
            format!(
                "what it sends to the Bluetooth module is not at {baud} baud, and what that passes on is garbage: give begin() that rate, or the wiring link_baud"
            )
        })
    }

    /// A button at a pin that floats while it is open.
    fn floating(&self) -> impl Iterator<Item = String> {
        let board = self.firmware.board();
        self.parts().filter_map(move |(part, _)| {
            let switches = matches!(part.kind, PartKind::Button | PartKind::Switch);
            let pin = board.pin(part.pin).filter(|_| switches && part.resistor.is_none())?;
            let floats = self.chip.devices().drive(pin) == Drive::Floating;
            floats.then(|| {
                format!(
                    "{} on pin {} closes to GND, and the program switches no pull-up on, so that open and closed read alike: use INPUT_PULLUP, or say what resistor there is, to = \"5v\" where pressed is HIGH, else to = \"gnd\"",
                    part.name,
                    board.shown(part.pin)
                )
            })
        })
    }

    /// A sensor at a pin that the program drives itself; of a sonar with one line for both it does so by turns.
    fn overdriven(&self) -> impl Iterator<Item = String> {
        let is_read =
            |(signal, _): &(&str, u8)| signal.contains("_encoder") || signal.ends_with("_echo");
        self.firmware.numbers().filter(is_read).filter_map(move |(signal, number)| {
            let trigger = signal.strip_suffix("_echo");
            let trigger = trigger.map(|sonar| format!("{sonar}_trigger"));
            let by_turns = trigger.is_some_and(|trigger| self.firmware.number_of(&trigger) == Some(number));
            let board = self.firmware.board();
            let driven = matches!(self.chip.devices().drive(board.pin(number)?), Drive::Low | Drive::High);
            let shown = board.shown(number);
            (driven && !by_turns).then(|| {
                format!(
                    "{signal}: pin {shown} is an output of the program, which reads there what it writes, and not the sensor: \
                     pinMode({shown}, INPUT)"
                )
            })
        })
    }

    /// Bytes that could not leave.
    fn unsent(&self) -> impl Iterator<Item = String> {
        let image = self.firmware.image();
        let devices = self.chip.devices();
        (0..4).filter_map(move |usart| {
            let place = image.place(devices.unsent_at(usart)?);
            Some(format!(
                "UDR{usart} was written at {place} while the transmitter of {} was off: nothing was sent; set TXEN{usart} in UCSR{usart}B, or call begin()",
                NAMES[usize::from(usart)]
            ))
        })
    }

    /// What a program for another wiring, or for no robot at all, does not do.
    fn silence(&self) -> Vec<Note> {
        let wiring = self.firmware.wiring();
        let mut silence = Vec::new();
        if self.firmware.language() == LinkLanguage::Frames || self.verdict.is_some() {
            return silence;
        }
        if self.is_idle() {
            silence.push(Note::NoMotor {
                wiring: wiring.into(),
            });
        }
        silence.extend(self.of_wheels().into_iter().map(Note::from));
        let spoke = |usart: usize| self.consoles.get(usart).is_some_and(Console::has_spoken);
        if let Some(link) = self.firmware.link_usart().map(usize::from)
            && !spoke(link)
            && !self.receives()
        {
            let others: Vec<&str> = (0..NAMES.len())
                .filter(|usart| spoke(*usart))
                .map(|usart| NAMES[usart])
                .collect();
            let (link, wiring) = (NAMES[link % NAMES.len()], wiring.into());
            silence.push(match &others.join(", ")[..] {
                "" => Note::NoLink { link, wiring },
                others => Note::OtherLink {
                    link,
                    wiring,
                    others: others.into(),
                },
            });
        }
        silence
    }

    /// Whether the program receives what comes over the link: one that only obeys says nothing.
    fn receives(&self) -> bool {
        let devices = self.chip.devices();
        match self.wires().link {
            Some(LinkOn::Usart(usart)) => devices.receiving_baud(usart).is_some(),
            Some(LinkOn::Pins { receive, .. }) => receive.is_some_and(|pin| devices.awaits(pin)),
            None => false,
        }
    }
}
