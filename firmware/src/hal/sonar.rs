//! Sonars: a trigger pulse that compare C ends, and echoes by the level of their pin.
//!
//! The handler of an echo pin records the instants of the first rise and the fall after it; [`rumbo_robot::latch`]
//! evaluates them at the tick. The level is read, never toggled: a lost edge costs one reading.

use super::clock;
use super::registers::{change, get, handler, port_b, port_d, port_e, port_j};
use super::shared::{Byte, CriticalSection, Guarded};
use crate::pins;
use core::convert::Infallible;
use embedded_hal::digital::{ErrorType, OutputPin};
use rumbo_control::{Echo, Micros, SonarId};
use rumbo_robot::latch::{EchoLatch, EchoLine, Stamp};

/// The trigger pulse: 12 us, of which the sonar needs 10 [0.5 us].
const TRIGGER_COUNTS: u16 = 24;

const TRIGGERS_J: u8 = pins::LEFT_TRIGGER.mask() | pins::FRONT_TRIGGER.mask();
const TRIGGERS_B: u8 = pins::RIGHT_TRIGGER.mask();
const ECHOES_D: u8 = pins::LEFT_ECHO.mask() | pins::RIGHT_ECHO.mask();

/// No ping.
const NONE: u8 = 0xFF;
/// The sonar to be triggered, by its number.
static PING: Byte = Byte::new(NONE);

type SharedLine = Guarded<EchoLine<Stamp>>;

static LEFT: SharedLine = Guarded::new(EchoLine::Idle);
static RIGHT: SharedLine = Guarded::new(EchoLine::Idle);
static FRONT: SharedLine = Guarded::new(EchoLine::Idle);

fn line(sonar: SonarId) -> &'static SharedLine {
    match sonar {
        SonarId::Left => &LEFT,
        SonarId::Right => &RIGHT,
        SonarId::Front => &FRONT,
    }
}

/// An edge on an echo pin, which is `high` now.
#[inline(always)]
fn edge(line: &SharedLine, high: bool, section: CriticalSection<'_>) {
    let at = Stamp(clock::now(section));
    line.update(|line| line.edge(high, at), section);
}

/// Triggers low; echoes are inputs from reset on.
pub(super) fn start() {
    change!(port_j().ddrj, set TRIGGERS_J, clear 0);
    change!(port_b().ddrb, set TRIGGERS_B, clear 0);
}

/// Requests a ping at the next compare C; discards that sonar's previous answer.
#[inline(always)]
pub(super) fn ask(ping: Option<SonarId>, section: CriticalSection<'_>) {
    if let Some(sonar) = ping {
        line(sonar).update(|line| *line = EchoLine::Idle, section);
    }
    PING.set(ping.map_or(NONE, |sonar| sonar as u8));
}

/// A sonar's trigger pin as an `embedded-hal` output; only for handlers, since a port is changed in three steps.
struct Trigger<'a>(SonarId, CriticalSection<'a>);

impl ErrorType for Trigger<'_> {
    type Error = Infallible;
}

impl OutputPin for Trigger<'_> {
    #[inline(always)]
    fn set_high(&mut self) -> Result<(), Infallible> {
        match self.0 {
            SonarId::Left => change!(port_j().portj, set pins::LEFT_TRIGGER.mask(), clear 0),
            SonarId::Right => change!(port_b().portb, set pins::RIGHT_TRIGGER.mask(), clear 0),
            SonarId::Front => change!(port_j().portj, set pins::FRONT_TRIGGER.mask(), clear 0),
        };
        Ok(())
    }

    #[inline(always)]
    fn set_low(&mut self) -> Result<(), Infallible> {
        match self.0 {
            SonarId::Left => change!(port_j().portj, set 0, clear pins::LEFT_TRIGGER.mask()),
            SonarId::Right => change!(port_b().portb, set 0, clear pins::RIGHT_TRIGGER.mask()),
            SonarId::Front => change!(port_j().portj, set 0, clear pins::FRONT_TRIGGER.mask()),
        };
        Ok(())
    }
}

/// Compare C: raises the requested trigger, and lowers it the next time.
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
fn raise(line: &SharedLine, mut trigger: Trigger<'_>) {
    let at = Stamp(clock::now(trigger.1));
    line.update(|line| *line = EchoLine::Pinged(at), trigger.1);
    let Ok(()) = trigger.set_high();
    clock::trigger_again_in(TRIGGER_COUNTS, trigger.1);
}

handler! { __vector_3, "INT2", |section| {
    edge(&LEFT, get!(port_d().pind) & pins::LEFT_ECHO.mask() != 0, section);
} }

handler! { __vector_4, "INT3", |section| {
    edge(&RIGHT, get!(port_d().pind) & pins::RIGHT_ECHO.mask() != 0, section);
} }

handler! { __vector_6, "INT5", |section| {
    edge(&FRONT, get!(port_e().pine) & pins::FRONT_ECHO.mask() != 0, section);
} }

handler! { __vector_19, "TIMER1_COMPC", |section| {
    trigger(section);
} }

const _: () = assert!(ECHOES_D == 0b1100 && pins::FRONT_ECHO.bit == 5);

/// The loop's state of the sonars.
#[derive(Clone, Copy, Debug, Default)]
pub struct Listener(EchoLatch);

impl Listener {
    /// A ping has been requested.
    pub fn asked(&mut self, sonar: SonarId) {
        self.0.asked(sonar);
    }

    /// The result of a ping, returned once, at the tick `tick`, which is at `now`. It may have left late, or not yet.
    pub fn read(&mut self, tick: Stamp, now: Micros) -> Option<(SonarId, Echo)> {
        self.0.read(now, |sonar| {
            let line = avr_device::interrupt::free(|section| line(sonar).get(section));
            line.map(|stamp| stamp.micros(tick, now))
        })
    }
}
