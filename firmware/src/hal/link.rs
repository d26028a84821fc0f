//! The link: USART 2 at 9600 baud, a ring for each direction, filled and emptied by interrupts.

use core::sync::atomic::{AtomicU8, Ordering::Relaxed};

use super::registers::{change, get, put, usart_2};

/// 9600 baud with doubled speed: 16 MHz / 8 / 208 = 9615.
const DIVIDER: u16 = 207;
/// Bytes in a ring, a power of two.
const RING: u8 = 64;

struct Ring {
    bytes: [AtomicU8; RING as usize],
    /// Bytes put in and taken out so far, wrapping.
    put: AtomicU8,
    taken: AtomicU8,
}

impl Ring {
    const fn new() -> Self {
        Self {
            bytes: [const { AtomicU8::new(0) }; RING as usize],
            put: AtomicU8::new(0),
            taken: AtomicU8::new(0),
        }
    }

    #[inline(always)]
    fn len(&self) -> u8 {
        self.put.load(Relaxed).wrapping_sub(self.taken.load(Relaxed))
    }

    #[inline(always)]
    fn push(&self, byte: u8) {
        let put = self.put.load(Relaxed);
        self.bytes[usize::from(put % RING)].store(byte, Relaxed);
        self.put.store(put.wrapping_add(1), Relaxed);
    }

    #[inline(always)]
    fn pop(&self) -> Option<u8> {
        if self.len() == 0 {
            return None;
        }
        let taken = self.taken.load(Relaxed);
        let byte = self.bytes[usize::from(taken % RING)].load(Relaxed);
        self.taken.store(taken.wrapping_add(1), Relaxed);
        Some(byte)
    }
}

static RECEIVED: Ring = Ring::new();
static SENDING: Ring = Ring::new();

/// 8 data bits, no parity, one stop bit, which is what the register holds after a reset.
pub(super) fn start() {
    put!(usart_2().ubrr2(), DIVIDER);
    put!(usart_2().ucsr2a(), 1 << 1);
    // Receiver and transmitter on; a received byte interrupts.
    put!(usart_2().ucsr2b(), 0b1001_1000);
}

/// The next byte that arrived.
pub fn receive() -> Option<u8> {
    RECEIVED.pop()
}

/// Whether the ring has room for another byte.
pub fn has_room() -> bool {
    SENDING.len() < RING
}

/// Sends a byte, for which there is room.
pub fn send(byte: u8) {
    SENDING.push(byte);
    // An empty data register interrupts again. The handlers of this register come between only whole instructions.
    avr_device::interrupt::free(|_| {
        change!(usart_2().ucsr2b(), set 1 << 5, clear 0);
    });
}

#[avr_device::interrupt(atmega2560)]
fn USART2_RX() {
    // A frame error is a break or noise: no byte at all.
    let broken = get!(usart_2().ucsr2a()) & 1 << 4 != 0;
    let byte = get!(usart_2().udr2());
    if !broken && RECEIVED.len() < RING {
        RECEIVED.push(byte);
    }
}

#[avr_device::interrupt(atmega2560)]
fn USART2_UDRE() {
    match SENDING.pop() {
        Some(byte) => put!(usart_2().udr2(), byte),
        None => change!(usart_2().ucsr2b(), set 0, clear 1 << 5),
    };
}
