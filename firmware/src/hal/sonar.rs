//! Sonars: a trigger pulse that compare C ends, and echoes by the level of their pin.
//!
//! The handler of an echo pin notes the instants of the first rise and the fall after it; what that means is decided
//! at the tick. The level is read, never toggled: a lost edge costs one reading.

use super::clock::{self, OUTPUT_COUNTS, Stamp};
use super::registers::{change, get, handler, port_b, port_d, port_e, port_j};
use super::shared::{Byte, CriticalSection, Word};
use crate::pins;
use core::convert::Infallible;
use embedded_hal::digital::{ErrorType, OutputPin};
use rumbo_control::{Echo, SonarId};

/// The trigger pulse: 12 us, of which the sonar needs 10 [0.5 us].
const TRIGGER_COUNTS: u16 = 24;
/// The echo line must have risen by this time after the trigger, or the sonar is silent [0.5 us].
const RISE_COUNTS: u16 = 5_000 * 2;
/// A line still high after this time has nothing within reach to say: 2.5 m; two ticks after its ping it has told [0.5 us].
const REACH_COUNTS: u16 = 14_600 * 2;

const TRIGGERS_J: u8 = pins::LEFT_TRIGGER.mask() | pins::FRONT_TRIGGER.mask();
const TRIGGERS_B: u8 = pins::RIGHT_TRIGGER.mask();
const ECHOES_D: u8 = pins::LEFT_ECHO.mask() | pins::RIGHT_ECHO.mask();

/// Where a ping stands.
const IDLE: u8 = 0;
const PINGED: u8 = 1;
const RISEN: u8 = 2;
const FALLEN: u8 = 3;

struct Line {
    state: Byte,
    /// When it was triggered.
    ping: Word,
    rise: Word,
    fall: Word,
}

impl Line {
    const fn new() -> Self {
        Self {
            state: Byte::new(IDLE),
            ping: Word::new(0),
            rise: Word::new(0),
            fall: Word::new(0),
        }
    }

    /// State, ping, rise and fall, of one moment.
    fn read(&self) -> (u8, Stamp, Stamp, Stamp) {
        avr_device::interrupt::free(|section| {
            (
                self.state.get(),
                Stamp(self.ping.get(section)),
                Stamp(self.rise.get(section)),
                Stamp(self.fall.get(section)),
            )
        })
    }

    #[inline(always)]
    fn ping(&self, section: CriticalSection<'_>) {
        self.ping.set(clock::now(section), section);
        self.state.set(PINGED);
    }

    #[inline(always)]
    fn edge(&self, high: bool, section: CriticalSection<'_>) {
        let now = clock::now(section);
        match (self.state.get(), high) {
            (PINGED, true) => {
                self.rise.set(now, section);
                self.state.set(RISEN);
            }
            (RISEN, false) => {
                self.fall.set(now, section);
                self.state.set(FALLEN);
            }
            _ => {}
        }
    }
}

/// No ping.
const NONE: u8 = 0xFF;
/// The sonar to be triggered, by its number.
static PING: Byte = Byte::new(NONE);

static LEFT: Line = Line::new();
static RIGHT: Line = Line::new();
static FRONT: Line = Line::new();

fn line(sonar: SonarId) -> &'static Line {
    match sonar {
        SonarId::Left => &LEFT,
        SonarId::Right => &RIGHT,
        SonarId::Front => &FRONT,
    }
}

/// Triggers low; echoes are inputs from reset on.
pub(super) fn start() {
    change!(port_j().ddrj(), set TRIGGERS_J, clear 0);
    change!(port_b().ddrb(), set TRIGGERS_B, clear 0);
}

/// Asks for a ping when compare C comes; what that sonar said before is forgotten.
#[inline(always)]
pub(super) fn ask(ping: Option<SonarId>) {
    if let Some(sonar) = ping {
        line(sonar).state.set(IDLE);
    }
    PING.set(ping.map_or(NONE, |sonar| sonar as u8));
}

/// A sonar's trigger pin as `embedded-hal` has it; only for handlers, since a port is changed in three steps.
struct Trigger<'a>(SonarId, CriticalSection<'a>);

impl ErrorType for Trigger<'_> {
    type Error = Infallible;
}

impl OutputPin for Trigger<'_> {
    #[inline(always)]
    fn set_high(&mut self) -> Result<(), Infallible> {
        match self.0 {
            SonarId::Left => change!(port_j().portj(), set pins::LEFT_TRIGGER.mask(), clear 0),
            SonarId::Right => change!(port_b().portb(), set pins::RIGHT_TRIGGER.mask(), clear 0),
            SonarId::Front => change!(port_j().portj(), set pins::FRONT_TRIGGER.mask(), clear 0),
        };
        Ok(())
    }

    #[inline(always)]
    fn set_low(&mut self) -> Result<(), Infallible> {
        match self.0 {
            SonarId::Left => change!(port_j().portj(), set 0, clear pins::LEFT_TRIGGER.mask()),
            SonarId::Right => change!(port_b().portb(), set 0, clear pins::RIGHT_TRIGGER.mask()),
            SonarId::Front => change!(port_j().portj(), set 0, clear pins::FRONT_TRIGGER.mask()),
        };
        Ok(())
    }
}

/// Compare C: raises the trigger that was asked for, and lowers it the next time.
#[inline(always)]
pub(super) fn trigger(section: CriticalSection<'_>) {
    let ping = PING.get();
    PING.set(NONE);
    match ping {
        0 => raise(&LEFT, Trigger(SonarId::Left, section)),
        1 => raise(&RIGHT, Trigger(SonarId::Right, section)),
        2 => raise(&FRONT, Trigger(SonarId::Front, section)),
        _ => {
            let Ok(()) = Trigger(SonarId::Left, section).set_low();
            let Ok(()) = Trigger(SonarId::Right, section).set_low();
            let Ok(()) = Trigger(SonarId::Front, section).set_low();
        }
    }
}

#[inline(always)]
fn raise(line: &Line, mut trigger: Trigger<'_>) {
    line.ping(trigger.1);
    let Ok(()) = trigger.set_high();
    clock::trigger_again_in(TRIGGER_COUNTS, trigger.1);
}

handler! { __vector_3, "INT2", |section| {
    LEFT.edge(get!(port_d().pind()) & pins::LEFT_ECHO.mask() != 0, section);
} }

handler! { __vector_4, "INT3", |section| {
    RIGHT.edge(get!(port_d().pind()) & pins::RIGHT_ECHO.mask() != 0, section);
} }

handler! { __vector_6, "INT5", |section| {
    FRONT.edge(get!(port_e().pine()) & pins::FRONT_ECHO.mask() != 0, section);
} }

const _: () = assert!(ECHOES_D == 0b1100 && pins::FRONT_ECHO.bit == 5);

/// The sonars that are waited for, by their numbers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Listener {
    waiting: [bool; 3],
}

impl Listener {
    /// A sonar has been asked for a ping.
    pub fn asked(&mut self, sonar: SonarId) {
        self.waiting[sonar as usize] = true;
    }

    /// What became of a ping, once, at the tick `tick`. It may have left late, or not yet.
    pub fn read(&mut self, tick: Stamp) -> Option<(SonarId, Echo)> {
        for &sonar in &SonarId::ALL {
            let waiting = &mut self.waiting[sonar as usize];
            if *waiting && let Some(echo) = echo(sonar, tick) {
                *waiting = false;
                return Some((sonar, echo));
            }
        }
        None
    }
}

/// What a sonar has answered by the tick `tick`, if that is decided.
fn echo(sonar: SonarId, tick: Stamp) -> Option<Echo> {
    let (state, ping, rise, fall) = line(sonar).read();
    match state {
        FALLEN => Some(Echo::Pulse(u32::from(fall.since(rise) / 2))),
        RISEN if passed(rise, tick, REACH_COUNTS) => Some(Echo::Clear),
        PINGED if passed(ping, tick, RISE_COUNTS) => Some(Echo::Silent),
        _ => None,
    }
}

/// Whether `counts` lie between `from` and `tick`; `from` may come after the tick, by less than 3 ms.
fn passed(from: Stamp, tick: Stamp, counts: u16) -> bool {
    let since = tick.since(from);
    since >= counts && since < u16::MAX - OUTPUT_COUNTS
}
