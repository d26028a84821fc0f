//! Registers as shared blocks, read and written whole.

use avr_device::atmega2560 as pac;

macro_rules! blocks {
    ($( $name:ident: $module:ident, $Peripheral:ident; )+) => { $(
        /// The registers of the peripheral.
        #[inline(always)]
        pub(super) fn $name() -> &'static pac::$module::RegisterBlock {
            // SAFETY: the block is always at this address, and its registers are cells with volatile access. The
            // modules above are responsible for the meaning of an access; none of them shares a register with another
            // one outside interrupt handlers and `start`.
            unsafe { &*pac::$Peripheral::PTR }
        }
    )+ };
}

blocks! {
    converter: adc, ADC;
    cpu: cpu, CPU;
    eeprom: eeprom, EEPROM;
    external: exint, EXINT;
    port_b: portb, PORTB;
    port_d: portd, PORTD;
    port_e: porte, PORTE;
    port_g: portg, PORTG;
    port_h: porth, PORTH;
    port_j: portj, PORTJ;
    timer_1: tc1, TC1;
    timer_2: tc2, TC2;
    timer_3: tc3, TC3;
    timer_4: tc4, TC4;
    usart_2: usart2, USART2;
    watchdog: wdt, WDT;
}

/// Writes a register whole.
macro_rules! put {
    ($register:expr, $value:expr) => {
        $register.write(|to| {
            #[allow(unused_unsafe, reason = "of some registers every value is known to be defined")]
            // SAFETY: the datasheet defines every value of this register, and none of them affects memory.
            let to = unsafe { to.bits($value) };
            to
        })
    };
}

/// Reads a register whole.
macro_rules! get {
    ($register:expr) => {
        $register.read().bits()
    };
}

/// Sets some bits of a register and clears others; only where no interrupt can come between.
macro_rules! change {
    ($register:expr, set $set:expr, clear $clear:expr) => {
        $register.modify(|was, to| {
            #[allow(unused_unsafe, reason = "as for `put`")]
            // SAFETY: as for `put`.
            let to = unsafe { to.bits((was.bits() & !$clear) | $set) };
            to
        })
    };
}

/// An interrupt handler: its vector, its name in the datasheet, its body. Avoids the extra call that
/// `avr_device::interrupt` makes, for which every register would have to be saved.
macro_rules! handler {
    ($vector:ident, $name:literal, |$section:ident| $body:block) => {
        #[doc = $name]
        // SAFETY: only the startup code refers to the vector's name, and it is used once.
        #[unsafe(no_mangle)]
        extern "avr-interrupt" fn $vector() {
            // SAFETY: the chip enters a handler with interrupts off, and none turns them on.
            let $section = unsafe { avr_device::interrupt::CriticalSection::new() };
            $body
        }
    };
}

pub(super) use {change, get, handler, put};
