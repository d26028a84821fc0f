//! Ports alone.

use super::*;

const PINB: u16 = 0x23;
const DDRB: u16 = 0x24;
const PORTB: u16 = 0x25;

fn pin(letter: char, bit: u8) -> Pin {
    Pin::new(letter, bit).unwrap()
}

#[test]
fn registers_lie_where_the_datasheet_has_them() {
    for (address, expected) in [
        (0x20, (0, PortRegister::Pin)),
        (0x25, (1, PortRegister::Output)),
        (0x34, (6, PortRegister::Output)),
        (0x100, (7, PortRegister::Pin)),
        (0x104, (8, PortRegister::Direction)),
        (0x10B, (10, PortRegister::Output)),
    ] {
        assert_eq!(register(address), Some(expected));
    }
    assert_eq!(register(0x35), None);
    assert_eq!(format!("{} {}", pin('H', 3), pin('J', 0)), "PH3 PJ0");
    assert_eq!(Pin::new('I', 0), None);
}

#[test]
fn an_output_is_read_back_two_cycles_later() {
    let mut ports = Ports::default();
    ports.write(DDRB, 0xFF, 5);
    ports.write(PORTB, 0x81, 10);
    assert_eq!(ports.read(PINB, 11), 0x00);
    assert_eq!(ports.read(PINB, 12), 0x81);
}

#[test]
fn writing_a_one_to_pin_toggles_the_output() {
    let mut ports = Ports::default();
    ports.write(PORTB, 0x0F, 0);
    ports.write(PINB, 0x03, 1);
    assert_eq!(ports.read(PORTB, 2), 0x0C);
    ports.write_bit(PINB, 0x04, true, 3);
    ports.write_bit(PINB, 0x08, false, 4);
    assert_eq!(ports.read(PORTB, 5), 0x08);
}

#[test]
fn an_input_is_what_is_outside_or_its_pull_up() {
    let mut ports = Ports::default();
    let b0 = pin('B', 0);
    assert_eq!((ports.level(b0), ports.drive(b0)), (false, Drive::Floating));
    let change = ports.write(PORTB, 1, 10).unwrap();
    assert_eq!((change.levels, change.driven), (1, 1));
    assert_eq!((ports.level(b0), ports.drive(b0)), (true, Drive::PullUp));
    ports.set_outside(b0, Some(false), 20);
    assert!(!ports.level(b0));
    ports.set_outside(b0, None, 30);
    assert!(ports.level(b0));
    let changes = ports.disable_pull_ups(true, 40);
    assert_eq!((changes.len(), changes[0].levels), (1, 1));
    assert_eq!((ports.level(b0), ports.drive(b0)), (false, Drive::Floating));
}

#[test]
fn a_peripheral_takes_over_a_direction_and_gives_it_back() {
    let mut ports = Ports::default();
    let e1 = pin('E', 1);
    ports.force(e1, Force::Output(true), 1);
    assert_eq!((ports.drive(e1), ports.level(e1)), (Drive::High, true));
    assert_eq!(ports.read(0x2D, 9), 0, "the register is as it was");
    ports.force(e1, Force::Input, 10);
    assert_eq!(ports.drive(e1), Drive::Floating);
    ports.write(0x2E, 2, 11);
    assert_eq!(ports.drive(e1), Drive::PullUp);
    ports.force(e1, Force::None, 12);
    ports.write(0x2D, 2, 13);
    assert_eq!(ports.drive(e1), Drive::High);
}

#[test]
fn a_peripheral_takes_over_an_output_and_gives_it_back() {
    let mut ports = Ports::default();
    let b7 = pin('B', 7);
    ports.write(DDRB, 0x80, 0);
    ports.override_output(b7, Some(true), 1);
    assert_eq!(ports.drive(b7), Drive::High);
    assert_eq!(ports.read(PORTB, 9), 0, "the register is as it was");
    ports.override_output(b7, None, 2);
    assert_eq!(ports.drive(b7), Drive::Low);
}
