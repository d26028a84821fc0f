//! The link: USART 2 at 9600 baud, a ring for each direction, filled and emptied by interrupts.

use super::registers::{change, get, handler, put, usart_2};
use super::shared::Byte;

/// 9600 baud with doubled speed: 16 MHz / 8 / 208 = 9615.
const DIVIDER: u16 = 207;
/// Bytes in a ring, a power of two.
const RING: u8 = 64;

/// A ring; laid out as written, for tests that put bytes in.
#[repr(C)]
struct Ring {
    bytes: [Byte; RING as usize],
    /// Bytes put in and taken out so far, wrapping.
    put: Byte,
    taken: Byte,
}

impl Ring {
    const fn new() -> Self {
        Self {
            bytes: [const { Byte::new(0) }; RING as usize],
            put: Byte::new(0),
            taken: Byte::new(0),
        }
    }

    #[inline(always)]
    fn len(&self) -> u8 {
        self.put.get().wrapping_sub(self.taken.get())
    }

    #[inline(always)]
    fn push(&self, byte: u8) {
        let put = self.put.get();
        self.bytes[usize::from(put % RING)].set(byte);
        self.put.set(put.wrapping_add(1));
    }

    #[inline(always)]
    fn pop(&self) -> Option<u8> {
        if self.len() == 0 {
            return None;
        }
        let taken = self.taken.get();
        let byte = self.bytes[usize::from(taken % RING)].get();
        self.taken.set(taken.wrapping_add(1));
        Some(byte)
    }
}

// SAFETY: the name is used once.
#[unsafe(export_name = "RUMBO_RECEIVED")]
static RECEIVED: Ring = Ring::new();
// SAFETY: the name is used once.
#[unsafe(export_name = "RUMBO_SENDING")]
static SENDING: Ring = Ring::new();

/// 8 data bits, no parity, one stop bit, which is what the register holds after a reset.
pub(super) fn start() {
    put!(usart_2().ubrr2, DIVIDER);
    put!(usart_2().ucsr2a, 1 << 1);
    // Receiver and transmitter on; a received byte interrupts.
    put!(usart_2().ucsr2b, 0b1001_1000);
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
        change!(usart_2().ucsr2b, set 1 << 5, clear 0);
    });
}

handler! { __vector_51, "USART2_RX", |_section| {
    // A frame error is a break or noise, not a byte.
    let broken = get!(usart_2().ucsr2a) & 1 << 4 != 0;
    let byte = get!(usart_2().udr2);
    if !broken && RECEIVED.len() < RING {
        RECEIVED.push(byte);
    }
} }

handler! { __vector_52, "USART2_UDRE", |_section| {
    match SENDING.pop() {
        Some(byte) => put!(usart_2().udr2, byte),
        None => change!(usart_2().ucsr2b, set 0, clear 1 << 5),
    };
} }
