//! Sonars: a trigger pulse that compare C ends, and echoes by the level of their pin.
//!
//! The handler of an echo pin notes the instants of the first rise and the fall after it; what that means is decided
//! at the tick. The level is read, never toggled: a lost edge costs one reading.

use core::sync::atomic::{AtomicU8, Ordering::Relaxed};

use super::clock::{self, SharedStamp, Stamp};
use super::registers::{change, get, port_b, port_d, port_e, port_j, put};
use crate::pins;
use rumbo_control::{Echo, SonarId};

/// The trigger pulse: 12 us, of which the sonar needs 10 [0.5 us].
const TRIGGER_COUNTS: u16 = 24;
/// The echo line must have risen by this time after the trigger, or the sonar is silent [0.5 us].
const RISE_COUNTS: u16 = 5_000 * 2;
/// A line still high after this time has nothing within reach to say: 2.65 m [0.5 us].
const REACH_COUNTS: u16 = 15_500 * 2;

const TRIGGERS_J: u8 = pins::LEFT_TRIGGER.mask() | pins::FRONT_TRIGGER.mask();
const TRIGGERS_B: u8 = pins::RIGHT_TRIGGER.mask();
const ECHOES_D: u8 = pins::LEFT_ECHO.mask() | pins::RIGHT_ECHO.mask();

/// Where a ping stands.
const IDLE: u8 = 0;
const PINGED: u8 = 1;
const RISEN: u8 = 2;
const FALLEN: u8 = 3;

struct Line {
    state: AtomicU8,
    rise: SharedStamp,
    fall: SharedStamp,
}

impl Line {
    const fn new() -> Self {
        Self {
            state: AtomicU8::new(IDLE),
            rise: SharedStamp::new(),
            fall: SharedStamp::new(),
        }
    }

    #[inline(always)]
    fn edge(&self, high: bool) {
        let now = clock::now();
        match (self.state.load(Relaxed), high) {
            (PINGED, true) => {
                self.rise.set(now);
                self.state.store(RISEN, Relaxed);
            }
            (RISEN, false) => {
                self.fall.set(now);
                self.state.store(FALLEN, Relaxed);
            }
            _ => {}
        }
    }
}

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

/// Raises a trigger; the line's state starts over.
#[inline(always)]
pub(super) fn trigger(sonar: SonarId) {
    line(sonar).state.store(PINGED, Relaxed);
    match sonar {
        SonarId::Left => change!(port_j().portj(), set pins::LEFT_TRIGGER.mask(), clear 0),
        SonarId::Right => change!(port_b().portb(), set pins::RIGHT_TRIGGER.mask(), clear 0),
        SonarId::Front => change!(port_j().portj(), set pins::FRONT_TRIGGER.mask(), clear 0),
    };
    clock::end_of_trigger_in(TRIGGER_COUNTS);
}

/// Lowers all triggers.
#[inline(always)]
pub(super) fn end_trigger() {
    change!(port_j().portj(), set 0, clear TRIGGERS_J);
    change!(port_b().portb(), set 0, clear TRIGGERS_B);
}

#[avr_device::interrupt(atmega2560)]
fn INT2() {
    LEFT.edge(get!(port_d().pind()) & pins::LEFT_ECHO.mask() != 0);
}

#[avr_device::interrupt(atmega2560)]
fn INT3() {
    RIGHT.edge(get!(port_d().pind()) & pins::RIGHT_ECHO.mask() != 0);
}

#[avr_device::interrupt(atmega2560)]
fn INT5() {
    FRONT.edge(get!(port_e().pine()) & pins::FRONT_ECHO.mask() != 0);
}

const _: () = assert!(ECHOES_D == 0b1100 && pins::FRONT_ECHO.bit == 5);

/// The ping that is waited for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Listener {
    waiting: Option<(SonarId, Stamp)>,
}

impl Listener {
    /// A sonar will be triggered at `at`.
    pub fn pinged(&mut self, sonar: SonarId, at: Stamp) {
        self.waiting = Some((sonar, at));
    }

    /// What became of the last ping, once, at the tick `tick`.
    pub fn read(&mut self, tick: Stamp) -> Option<(SonarId, Echo)> {
        let (sonar, at) = self.waiting?;
        let line = line(sonar);
        let echo = match line.state.load(Relaxed) {
            FALLEN => Echo::Pulse(u32::from(line.fall.get().since(line.rise.get()) / 2)),
            RISEN if tick.since(line.rise.get()) >= REACH_COUNTS => Echo::Clear,
            PINGED if tick.since(at) >= RISE_COUNTS => Echo::Silent,
            _ => return None,
        };
        self.waiting = None;
        Some((sonar, echo))
    }
}
