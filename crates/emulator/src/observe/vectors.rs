//! The names of the interrupts (2549Q, table 14-1).

/// How many there are, with the reset.
pub const COUNT: usize = 57;

const NAMES: [&str; COUNT] = [
    "RESET",
    "INT0",
    "INT1",
    "INT2",
    "INT3",
    "INT4",
    "INT5",
    "INT6",
    "INT7",
    "PCINT0",
    "PCINT1",
    "PCINT2",
    "WDT",
    "TIMER2_COMPA",
    "TIMER2_COMPB",
    "TIMER2_OVF",
    "TIMER1_CAPT",
    "TIMER1_COMPA",
    "TIMER1_COMPB",
    "TIMER1_COMPC",
    "TIMER1_OVF",
    "TIMER0_COMPA",
    "TIMER0_COMPB",
    "TIMER0_OVF",
    "SPI_STC",
    "USART0_RX",
    "USART0_UDRE",
    "USART0_TX",
    "ANALOG_COMP",
    "ADC",
    "EE_READY",
    "TIMER3_CAPT",
    "TIMER3_COMPA",
    "TIMER3_COMPB",
    "TIMER3_COMPC",
    "TIMER3_OVF",
    "USART1_RX",
    "USART1_UDRE",
    "USART1_TX",
    "TWI",
    "SPM_READY",
    "TIMER4_CAPT",
    "TIMER4_COMPA",
    "TIMER4_COMPB",
    "TIMER4_COMPC",
    "TIMER4_OVF",
    "TIMER5_CAPT",
    "TIMER5_COMPA",
    "TIMER5_COMPB",
    "TIMER5_COMPC",
    "TIMER5_OVF",
    "USART2_RX",
    "USART2_UDRE",
    "USART2_TX",
    "USART3_RX",
    "USART3_UDRE",
    "USART3_TX",
];

/// The name of vector `number`, as in the headers of avr-libc without `_vect`.
pub fn name(number: u8) -> &'static str {
    NAMES.get(usize::from(number)).copied().unwrap_or("?")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_order() {
        for (number, expected) in [
            (1, "INT0"),
            (12, "WDT"),
            (30, "EE_READY"),
            (50, "TIMER5_OVF"),
            (56, "USART3_TX"),
        ] {
            assert_eq!(name(number), expected);
        }
        assert_eq!(name(57), "?");
    }
}
