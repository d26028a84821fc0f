//! Every name and number of the descriptions, against the headers of avr-libc.

use super::pin::{PortRegister, register as of_port};
use super::timer::TimerRegister;
use super::usart::UsartRegister;
use super::*;
use crate::registers;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::process::{Command, Stdio};

/// The macros of a chip's headers; `None` where no compiler is installed.
fn header(model: &Model) -> Option<BTreeMap<String, String>> {
    let chip = format!("-mmcu={}", model.name);
    let compiler = Command::new("avr-gcc")
        .args([&chip, "-E", "-dM", "-x", "c", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn();
    let Ok(mut compiler) = compiler else {
        assert!(
            std::env::var_os("CI").is_none(),
            "avr-gcc is missing: install the packages gcc-avr and avr-libc"
        );
        println!("skipped: avr-gcc is not installed");
        return None;
    };
    let mut source = compiler.stdin.take().unwrap();
    source.write_all(b"#include <avr/io.h>\n").unwrap();
    drop(source);
    let output = compiler.wait_with_output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let macros = text.lines().filter_map(|line| {
        let (name, value) = line.strip_prefix("#define ")?.split_once(' ')?;
        Some((name.to_owned(), value.trim().to_owned()))
    });
    Some(macros.collect())
}

fn number(text: &str) -> Option<u32> {
    let text = text.trim_matches(['(', ')']).to_lowercase();
    match text.strip_prefix("0x") {
        Some(digits) => u32::from_str_radix(digits, 16).ok(),
        None => text.parse().ok(),
    }
}

/// The registers of a header, a byte each.
fn registers(header: &BTreeMap<String, String>) -> BTreeMap<&str, u16> {
    let address = |value: &str| {
        let memory = value.strip_prefix("_SFR_MEM8").and_then(number);
        let io = value.strip_prefix("_SFR_IO8").and_then(number);
        memory.or(io.map(|address| address + 0x20))
    };
    let found = header.iter();
    found
        .filter_map(|(name, value)| Some((name.as_str(), address(value)? as u16)))
        .collect()
}

/// `text` without its only digit, which becomes `n`: `TCCRnA` and 1.
fn split(name: &str) -> (String, usize) {
    let digit = name.find(|c: char| c.is_ascii_digit());
    let number = digit.map_or(0, |at| usize::from(name.as_bytes()[at] - b'0'));
    (name.replacen(|c: char| c.is_ascii_digit(), "n", 1), number)
}

/// Whether the description has this register where the header has it.
fn has(model: &Model, name: &str, address: u16) -> bool {
    let of_port = |register| {
        let letter = name.chars().last().unwrap();
        of_port(address) == Some((pin(letter, 0).port(), register))
    };
    let (general, number) = split(name);
    let of_timer = |register| {
        let place = model.timers.get(number);
        place.is_some_and(|place| {
            place.number == number && place.register(address) == Some(register)
        })
    };
    let of_usart = |register| {
        let place = model.usarts.get(number);
        place.is_some_and(|place| place.register(address) == Some(register))
    };
    match general.as_str() {
        _ if name.len() == 4 && name.starts_with("PIN") => of_port(PortRegister::Pin),
        _ if name.len() == 4 && name.starts_with("DDR") => of_port(PortRegister::Direction),
        _ if name.len() == 5 && name.starts_with("PORT") => of_port(PortRegister::Output),
        "TCCRnA" => of_timer(TimerRegister::ControlA),
        "TCCRnB" => of_timer(TimerRegister::ControlB),
        "TCCRnC" => of_timer(TimerRegister::ControlC),
        "TCNTn" | "TCNTnL" => of_timer(TimerRegister::Count),
        "TCNTnH" => of_timer(TimerRegister::CountHigh),
        "ICRnL" => of_timer(TimerRegister::Capture),
        "ICRnH" => of_timer(TimerRegister::CaptureHigh),
        "OCRnA" | "OCRnAL" => of_timer(TimerRegister::Compare(0)),
        "OCRnB" | "OCRnBL" => of_timer(TimerRegister::Compare(1)),
        "OCRnCL" => of_timer(TimerRegister::Compare(2)),
        "OCRnAH" => of_timer(TimerRegister::CompareHigh(0)),
        "OCRnBH" => of_timer(TimerRegister::CompareHigh(1)),
        "OCRnCH" => of_timer(TimerRegister::CompareHigh(2)),
        "TIFRn" => of_timer(TimerRegister::Flags),
        "TIMSKn" => of_timer(TimerRegister::Enabled),
        "ASSR" => model.timers[2].register(address) == Some(TimerRegister::Asynchronous),
        "UCSRnA" => of_usart(UsartRegister::StatusA),
        "UCSRnB" => of_usart(UsartRegister::ControlB),
        "UCSRnC" => of_usart(UsartRegister::ControlC),
        "UBRRnL" => of_usart(UsartRegister::RateLow),
        "UBRRnH" => of_usart(UsartRegister::RateHigh),
        "UDRn" => of_usart(UsartRegister::Data),
        _ => {
            // Two have another name on the smaller chip, and for a debugger.
            let name = match name {
                "PRR" => "PRR0",
                "MONDR" => "OCDR",
                name => name,
            };
            registers::ALL.contains(&(name, address))
        }
    }
}

/// Registers of the CPU itself.
const OF_THE_CPU: [&str; 5] = ["RAMPZ", "EIND", "SPL", "SPH", "SREG"];

#[test]
fn every_register_is_where_the_header_has_it_and_nothing_is_elsewhere() {
    for model in MODELS {
        let Some(header) = header(model) else { return };
        let registers = registers(&header);
        assert!(registers.len() > 80, "{model:?}");
        for (name, address) in &registers {
            assert!(has(model, name, *address), "{model:?}: {name} {address:#x}");
        }
        let of_peripherals = registers
            .iter()
            .filter(|(name, _)| !OF_THE_CPU.contains(name));
        let known: BTreeSet<u16> = of_peripherals.map(|(_, address)| *address).collect();
        for (address, owner) in model.owners.iter().enumerate() {
            let expected = known.contains(&(address as u16));
            assert_eq!(*owner != Owner::Nobody, expected, "{model:?}: {address:#x}");
        }
    }
}

#[test]
fn memories_and_signatures_are_those_of_the_header() {
    for model in MODELS {
        let Some(header) = header(model) else { return };
        let value = |name: &str| number(&header[name]).unwrap() as usize;
        assert_eq!(value("FLASHEND") + 1, model.flash_bytes());
        assert_eq!(value("RAMSTART"), usize::from(model.sram_start));
        assert_eq!(value("RAMEND"), usize::from(model.ram_end));
        assert_eq!(value("E2END") + 1, model.eeprom_bytes);
        assert_eq!(value("SPM_PAGESIZE"), 2 * model.page_words);
        assert_eq!(value("__AVR_ARCH__") as u32, model.architecture);
        let signature = ["SIGNATURE_0", "SIGNATURE_1", "SIGNATURE_2"].map(|name| value(name) as u8);
        assert_eq!(signature, model.signature);
    }
}

#[test]
fn interrupts_are_numbered_as_in_the_header() {
    for model in MODELS {
        let Some(header) = header(model) else { return };
        let numbered = header.iter().filter_map(|(name, value)| {
            let name = name.strip_suffix("_vect_num")?;
            Some((name, number(value)? as u8))
        });
        let numbered: BTreeMap<&str, u8> = numbered.collect();
        assert_eq!(numbered.len() + 1, model.vectors.len());
        for (name, number) in &numbered {
            assert_eq!(model.vector_name(*number), *name);
        }
        let numbers = &model.numbers;
        for (name, number) in [
            ("PCINT0", numbers.pin_change),
            ("WDT", numbers.watchdog),
            ("SPI_STC", numbers.spi),
            ("ANALOG_COMP", numbers.compared),
            ("ADC", numbers.converted),
            ("EE_READY", numbers.eeprom_ready),
            ("TWI", numbers.twi),
            ("SPM_READY", numbers.programmed),
            ("INT0", 1),
        ] {
            assert_eq!(numbered[name], number, "{model:?}: {name}");
        }
        for timer in model.timers {
            for (flag, number) in timer.vectors {
                let what = match flag {
                    0x01 => "OVF",
                    0x02 => "COMPA",
                    0x04 => "COMPB",
                    0x08 => "COMPC",
                    _ => "CAPT",
                };
                let name = format!("TIMER{}_{what}", timer.number);
                assert_eq!(numbered[name.as_str()], number, "{model:?}: {name}");
            }
        }
        for (index, usart) in model.usarts.iter().enumerate() {
            let names = ["RX", "UDRE", "TX"];
            for (number, what) in (usart.vector..).zip(names) {
                let index = match model.usarts.len() {
                    1 => String::new(),
                    _ => index.to_string(),
                };
                let name = format!("USART{index}_{what}");
                assert_eq!(numbered[name.as_str()], number, "{model:?}: {name}");
            }
        }
    }
}
