//! Encoders: every edge puts its stamp into a ring; at the tick [`rumbo_robot::latch`] turns them into counts and
//! times.
//!
//! The handler does no more than that, so it is short. A ring holds 32 edges, 3,200 a second: five times the rate of
//! the wheels. Noise beyond that overwrites stamps; the count stays right.

use super::clock;
use super::registers::{external, handler, put};
use super::shared::{Byte, CriticalSection, Word};
use rumbo_control::{Edges, Micros, Wheels};
use rumbo_robot::latch::{EdgeCounter, Stamp};

/// Stamps in a ring, a power of two.
const RING: u8 = 32;

struct Ring {
    stamps: [Word; RING as usize],
    /// Edges so far, wrapping.
    count: Byte,
    /// The same at the tick.
    latched: Byte,
}

impl Ring {
    const fn new() -> Self {
        Self {
            stamps: [const { Word::new(0) }; RING as usize],
            count: Byte::new(0),
            latched: Byte::new(0),
        }
    }

    #[inline(always)]
    fn edge(&self, section: CriticalSection<'_>) {
        let count = self.count.get();
        self.slot(count).set(clock::now(section), section);
        self.count.set(count.wrapping_add(1));
    }

    #[inline(always)]
    fn slot(&self, count: u8) -> &Word {
        // Masked to the ring's length: the compiler omits the check.
        &self.stamps[usize::from(count % RING)]
    }
}

static LEFT: Ring = Ring::new();
static RIGHT: Ring = Ring::new();

/// Both edges of INT0 and INT1.
pub(super) fn start() {
    // Any edge interrupts, on INT0 to INT3 (encoders and side echoes).
    put!(external().eicra, 0b0101_0101);
    // And on INT5 (front echo).
    put!(external().eicrb, 0b0000_0100);
    // Clears flags raised by this setup.
    put!(external().eifr, 0b0010_1111);
    put!(external().eimsk, 0b0010_1111);
}

/// At the tick: later edges belong to the next one.
#[inline(always)]
pub(super) fn latch() {
    LEFT.latched.set(LEFT.count.get());
    RIGHT.latched.set(RIGHT.count.get());
}

handler! { __vector_1, "INT0", |section| {
    LEFT.edge(section);
} }

handler! { __vector_2, "INT1", |section| {
    RIGHT.edge(section);
} }

/// The loop's state of one encoder.
#[derive(Clone, Copy, Debug, Default)]
struct Counter {
    latch: EdgeCounter,
    taken: u8,
}

impl Counter {
    fn ingest(&mut self, ring: &Ring, tick: Stamp, now: Micros) {
        let latched = ring.latched.get();
        let new = latched.wrapping_sub(self.taken);
        if new > RING {
            // Overwritten before it was read.
            let lost = new - RING;
            self.taken = self.taken.wrapping_add(lost);
            self.latch.unstamped(lost);
        }
        while self.taken != latched {
            let slot = ring.slot(self.taken);
            let at = Stamp(avr_device::interrupt::free(|section| slot.get(section)));
            if at.is_after(tick) {
                // Between the tick and its handler, since edges have priority: it belongs to the next tick.
                return;
            }
            self.taken = self.taken.wrapping_add(1);
            self.latch.edge(at.micros(tick, now));
        }
    }
}

/// The loop's state of both encoders.
#[derive(Clone, Copy, Debug, Default)]
pub struct Encoders(Wheels<Counter>);

impl Encoders {
    /// The latched encoders of the tick `tick`, which is at `now`.
    pub fn read(&mut self, tick: Stamp, now: Micros) -> Wheels<Edges> {
        self.0.left.ingest(&LEFT, tick, now);
        self.0.right.ingest(&RIGHT, tick, now);
        self.0.map(|counter| counter.latch.edges())
    }
}
