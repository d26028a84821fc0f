//! Addresses of registers in the data space, by the names of the datasheets and of avr-libc's headers. Those of ports,
//! timers and USARTs are in their own tables.

/// Declares the addresses, and a table of them for a test.
macro_rules! registers {
    ($( $name:ident = $address:literal, )+) => {
        $( pub(crate) const $name: u16 = $address; )+

        #[cfg(test)]
        pub(crate) const ALL: &[(&str, u16)] = &[$( (stringify!($name), $address), )+];
    };
}

registers! {
    PCIFR = 0x3B, EIFR = 0x3C, EIMSK = 0x3D, PCICR = 0x68, EICRA = 0x69, EICRB = 0x6A,
    PCMSK0 = 0x6B, PCMSK1 = 0x6C, PCMSK2 = 0x6D,
    GPIOR0 = 0x3E, GPIOR1 = 0x4A, GPIOR2 = 0x4B, OCDR = 0x51, SMCR = 0x53, MCUSR = 0x54, MCUCR = 0x55,
    XMCRA = 0x74, XMCRB = 0x75,
    EECR = 0x3F, EEDR = 0x40, EEARL = 0x41, EEARH = 0x42,
    GTCCR = 0x43, TCCR0A = 0x44, TCCR1A = 0x80, TCCR2A = 0xB0, TCCR3A = 0x90, TCCR4A = 0xA0, TCCR5A = 0x120,
    TIFR0 = 0x35, TIMSK0 = 0x6E, OCR1CL = 0x8C,
    UCSR0A = 0xC0, UCSR1A = 0xC8, UCSR2A = 0xD0, UCSR3A = 0x130,
    SPCR = 0x4C, SPSR = 0x4D, SPDR = 0x4E,
    TWBR = 0xB8, TWSR = 0xB9, TWAR = 0xBA, TWDR = 0xBB, TWCR = 0xBC, TWAMR = 0xBD,
    ACSR = 0x50, ADCL = 0x78, ADCH = 0x79, ADCSRA = 0x7A, ADCSRB = 0x7B, ADMUX = 0x7C,
    DIDR2 = 0x7D, DIDR0 = 0x7E, DIDR1 = 0x7F,
    SPMCSR = 0x57, WDTCSR = 0x60, CLKPR = 0x61, PRR0 = 0x64, PRR1 = 0x65, OSCCAL = 0x66,
    RAMPZ = 0x5B, EIND = 0x5C, SPL = 0x5D, SPH = 0x5E, SREG = 0x5F,
}
