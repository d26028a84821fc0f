//! Timers 0 to 5: clock, registers, pins. What the counter does is in [`wave`] (2549Q, sections 16 to 20).
//!
//! A timer is not stepped: it keeps the cycle up to which it has been computed, and catches up when it is accessed or
//! when something visible from outside is due: an enabled interrupt or an edge on a connected pin.

mod duty;
mod registers;
mod wave;

use super::ports::Pin;
use super::prescaler::Prescaler;
use super::schedule::Source;
use super::{Core, Event, Pwm};
use crate::model::timer::{ASYNCHRONOUS, CAPTURE, CHANNELS, MATCH, OVERFLOW, TimerInstance};
pub(crate) use registers::{read_general_control, write_general_control};
use wave::{Top, Wave};

/// Noise canceller and edge of the capture pin, in control register B.
const ICNC: u8 = 0x80;
const ICES: u8 = 0x40;
/// ASSR of timer 2: its clock is at its own pins.
const AS2: u8 = 0x20;
/// Cycles for which the noise canceller requires the same level.
const NOISE_CYCLES: u64 = 4;

/// What drives a timer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Clock {
    Stopped,
    /// The system clock over this.
    Divided(u64),
    /// Its pin, on falling or rising edges.
    Pin {
        rising: bool,
    },
}

/// One timer.
#[derive(Clone, Debug)]
pub(crate) struct Timer {
    place: &'static TimerInstance,
    wave: Wave,
    clock: Clock,
    control: [u8; 3],
    enabled: u8,
    latch: u8,
    asynchronous: u8,
    /// The cycle up to which the counter has been computed.
    computed_to: u64,
    /// A level on the capture pin that must last until this cycle.
    capture_due: Option<u64>,
    /// The comparator's output, where it takes the place of the capture pin.
    comparator: Option<bool>,
    /// The pins were last given these outputs.
    driven: [Option<bool>; CHANNELS],
    /// The PWM last reported of each output, and whether it may have changed since.
    published: [Option<Pwm>; CHANNELS],
    duty_due: bool,
    /// Flags that start a conversion, and those that were set at the last check.
    wanted: u8,
    shown: u8,
    /// It has no clock.
    stopped: bool,
}

/// After reset.
pub(crate) fn new(place: &'static TimerInstance) -> Timer {
    Timer {
        place,
        wave: Wave::new(place.wide, place.channels),
        clock: Clock::Stopped,
        control: [0; 3],
        enabled: 0,
        latch: 0,
        asynchronous: 0,
        computed_to: 0,
        capture_due: None,
        comparator: None,
        driven: [None; CHANNELS],
        published: [None; CHANNELS],
        duty_due: false,
        wanted: 0,
        shown: 0,
        stopped: false,
    }
}

impl Timer {
    /// Whether this is one of its interrupt vectors.
    pub(crate) fn has_vector(&self, vector: u8) -> bool {
        self.place.flag(vector).is_some()
    }

    /// Starts over.
    pub(crate) fn reset(&mut self, core: &mut Core, cycle: u64) {
        let published = self.published;
        *self = new(self.place);
        self.computed_to = cycle;
        for (channel, last) in published.into_iter().enumerate() {
            if last.is_some() {
                let pin = self.place.outputs[channel];
                core.emit(cycle, Event::Duty { pin, pwm: None });
            }
        }
        self.reschedule(core);
    }

    /// Timer 2 waits for a clock at pins where the boards have none, or their crystal.
    fn is_asynchronous(&self) -> bool {
        self.asynchronous & AS2 != 0
    }

    fn prescaler(&self, core: &Core) -> Prescaler {
        core.prescalers[usize::from(self.place.number == ASYNCHRONOUS)]
    }

    /// Computes the counter up to `cycle`.
    pub(crate) fn catch_up(&mut self, core: &mut Core, cycle: u64) {
        let prescaler = self.prescaler(core);
        if let Clock::Divided(divisor) = self.clock
            && !prescaler.held
            && !self.stopped
            && cycle > self.computed_to
        {
            let before = prescaler.ticks(divisor, self.computed_to);
            let mut left = prescaler.ticks(divisor, cycle) - before;
            let mut tick = before;
            if self.listened().is_none() {
                let (first, period) = (u64::from(self.wave.max) + 1, self.wave.period());
                // Only its end and the raised flags are visible.
                if left > first + 2 * period {
                    let skipped = (left - first - period) / period * period;
                    left -= skipped;
                    tick += skipped;
                }
            }
            while left > 0 {
                let step = self.wave.quiet_ticks(0xFF).min(left);
                left -= step;
                tick += step;
                if self.wave.tick(step) {
                    self.show(core, prescaler.reset + tick * divisor);
                }
            }
        }
        self.computed_to = self.computed_to.max(cycle);
        if self.capture_due.is_some_and(|due| due <= cycle) {
            self.capture_due = None;
            self.capture(core, cycle);
        }
    }

    /// The channels whose matches are visible from outside, or `None` if nothing of the timer is.
    fn listened(&self) -> Option<u8> {
        let waiting = (self.enabled | self.wanted) & !self.wave.flags;
        let mut channels = 0;
        for (channel, flag) in MATCH.into_iter().enumerate().take(self.wave.channels) {
            if waiting & flag != 0 || self.wave.is_connected(channel) {
                channels |= 1 << channel;
            }
        }
        (channels != 0 || waiting & (OVERFLOW | CAPTURE) != 0).then_some(channels)
    }

    /// Schedules the next event.
    fn reschedule(&self, core: &mut Core) {
        let prescaler = self.prescaler(core);
        let next = match (self.clock, self.listened()) {
            (Clock::Divided(divisor), Some(channels)) if !prescaler.held && !self.stopped => {
                let tick =
                    prescaler.ticks(divisor, self.computed_to) + self.wave.quiet_ticks(channels);
                Some(prescaler.reset + tick * divisor)
            }
            _ => None,
        };
        let next = [next, self.capture_due].into_iter().flatten().min();
        core.schedule.set(Source::Timer(self.place.number), next);
    }

    /// Its event is due.
    pub(crate) fn happen(&mut self, core: &mut Core, cycle: u64) {
        self.catch_up(core, cycle);
        self.reschedule(core);
    }

    /// Passes flags and outputs on to interrupts, pins and converter.
    fn show(&mut self, core: &mut Core, cycle: u64) {
        let place = self.place;
        for (flag, vector) in place.vectors {
            let requested = self.wave.flags & self.enabled & flag != 0;
            core.interrupts.set(vector, requested);
        }
        if self.wave.flags & !self.shown & self.wanted != 0 {
            core.triggered = Some(cycle);
        }
        self.shown = self.wave.flags;
        for channel in 0..self.wave.channels {
            let output = self
                .wave
                .is_connected(channel)
                .then_some(self.wave.output[channel]);
            if output != self.driven[channel] {
                self.driven[channel] = output;
                core.drive_output(self.place.number, place.outputs[channel], output, cycle);
            }
        }
        if std::mem::take(&mut self.wave.updated) | std::mem::take(&mut self.duty_due) {
            self.publish_duty(core, cycle);
        }
    }

    /// Reports the PWM of pins on which it has changed.
    pub(crate) fn publish_duty(&mut self, core: &mut Core, cycle: u64) {
        for channel in 0..self.wave.channels {
            let pin = self.place.outputs[channel];
            let divisor = core.clock.divisor();
            let pwm = duty::pwm(&self.wave, channel, self.clock, divisor)
                .filter(|_| core.ports.is_output(pin));
            if pwm != self.published[channel] {
                self.published[channel] = pwm;
                core.emit(cycle, Event::Duty { pin, pwm });
            }
        }
    }

    /// It has a clock from now on, or has none.
    pub(crate) fn set_running(&mut self, core: &mut Core, runs: bool, cycle: u64) {
        if runs == self.stopped {
            self.catch_up(core, cycle);
            self.stopped = !runs;
            self.reschedule(core);
        }
    }

    /// These flags start conversions from now on.
    pub(crate) fn want(&mut self, core: &mut Core, flags: u8, cycle: u64) {
        if flags != self.wanted {
            self.catch_up(core, cycle);
            self.wanted = flags;
            self.shown = self.wave.flags;
            self.reschedule(core);
        }
    }

    /// A pin has changed: the timer's clock, or its capture.
    pub(crate) fn pin_changed(&mut self, core: &mut Core, pin: Pin, level: bool, cycle: u64) {
        let place = self.place;
        if self.stopped {
            return;
        }
        if place.clock == Some(pin) && self.clock == (Clock::Pin { rising: level }) {
            self.catch_up(core, cycle);
            if self.wave.tick(1) {
                self.show(core, cycle);
            }
        }
        if place.capture == Some(pin) && self.comparator.is_none() {
            self.capture_edge(core, level, cycle);
        }
    }

    /// The comparator takes the place of the capture pin with this output, or gives it back (`None`). Where the two differ, the
    /// change is an edge (section 17.6.1).
    pub(crate) fn set_comparator(&mut self, core: &mut Core, output: Option<bool>, cycle: u64) {
        let pin = self.place.capture.is_some_and(|pin| core.ports.level(pin));
        let before = self.comparator.unwrap_or(pin);
        self.comparator = output;
        let level = output.unwrap_or(pin);
        if level != before && !self.stopped {
            self.capture_edge(core, level, cycle);
        }
    }

    /// The input of the capture unit has changed.
    fn capture_edge(&mut self, core: &mut Core, level: bool, cycle: u64) {
        if self.wave.mode.top == Top::Capture {
            return;
        }
        let [_, control, _] = self.control;
        let meant = (control & ICES != 0) == level;
        self.capture_due = None;
        if meant && control & ICNC != 0 {
            self.capture_due = Some(cycle + NOISE_CYCLES);
        } else if meant {
            self.catch_up(core, cycle);
            self.capture(core, cycle);
        }
        self.reschedule(core);
    }

    fn capture(&mut self, core: &mut Core, cycle: u64) {
        self.wave.capture = self.wave.count;
        self.wave.flags |= CAPTURE;
        self.show(core, cycle);
    }

    /// One of its interrupts is entered.
    pub(crate) fn acknowledge(&mut self, core: &mut Core, vector: u8, cycle: u64) {
        self.catch_up(core, cycle);
        if let Some(flag) = self.place.flag(vector) {
            self.wave.flags &= !flag;
        }
        self.show(core, cycle);
        self.reschedule(core);
    }
}
