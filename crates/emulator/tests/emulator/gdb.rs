//! A debugger at the chip: the packets of GDB's remote protocol, and `avr-gdb` itself.
#![cfg(test)]

use crate::common;
use common::*;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::gdb::{Farewell, Machine, serve};
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::Command;
use std::thread::JoinHandle;

const STAY: u16 = 0xCFFF;

/// Counts r16 up and stores it at 0x300, for ever: 0 LDI, 1 INC, 2 STS, 4 RJMP to 1.
fn counter() -> Chip {
    let [store, address] = sts(0x300, 16);
    chip_of(&[ldi(16, 0), 0x9503, store, address, 0xCFFC, STAY])
}

#[test]
fn time_goes_on_under_a_debugger_also_where_the_program_divides_its_clock() {
    // CLKPR: the change is allowed, then the crystal is divided by 8.
    let mut words = Vec::new();
    for value in [0x80, 0x03] {
        words.push(ldi(16, value));
        words.extend(sts(0x61, 16));
    }
    words.push(STAY);
    let mut chip = chip_of(&words);
    for _ in 0..10 {
        chip.go();
    }
    let crystal = chip.cycle();
    assert!((160_000..160_000 + 10 * 16).contains(&crystal), "{crystal}");
    assert!(chip.cpu().cycle() < 160_000 / 7);
}

/// A chip that waits for a debugger; gives the port.
fn listen(mut chip: Chip) -> (u16, JoinHandle<(Farewell, Chip)>) {
    let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let port = listener.local_addr().unwrap().port();
    let thread = std::thread::spawn(move || {
        let (connection, _) = listener.accept().unwrap();
        (serve(&mut chip, connection).unwrap(), chip)
    });
    (port, thread)
}

/// The other end of the line.
struct Client(TcpStream);

impl Client {
    fn connect(port: u16) -> Client {
        Client(TcpStream::connect(("127.0.0.1", port)).unwrap())
    }

    fn byte(&mut self) -> u8 {
        let mut byte = [0];
        self.0.read_exact(&mut byte).unwrap();
        byte[0]
    }

    fn send(&mut self, text: &str) {
        let sum = text.bytes().fold(0u8, u8::wrapping_add);
        write!(self.0, "${text}#{sum:02x}").unwrap();
        assert_eq!(self.byte(), b'+', "{text}");
    }

    fn receive(&mut self) -> String {
        assert_eq!(self.byte(), b'$');
        let mut text = Vec::new();
        loop {
            match self.byte() {
                b'#' => break,
                byte => text.push(byte),
            }
        }
        let sum = [self.byte(), self.byte()];
        let wanted = text.iter().copied().fold(0u8, u8::wrapping_add);
        assert_eq!(format!("{wanted:02x}").as_bytes(), sum);
        write!(self.0, "+").unwrap();
        expanded(&text)
    }

    fn ask(&mut self, text: &str) -> String {
        self.send(text);
        self.receive()
    }

    /// The program counter [bytes], the last register of the packet.
    fn program_counter(&mut self) -> u32 {
        let registers = self.ask("g");
        assert_eq!(registers.len(), 2 * 39);
        u32::from_str_radix(&registers[70..78], 16)
            .unwrap()
            .swap_bytes()
    }
}

/// Undoes the run-length encoding: a character, `*`, and 29 more than how often it follows.
fn expanded(text: &[u8]) -> String {
    let mut expanded = String::new();
    let mut bytes = text.iter();
    while let Some(byte) = bytes.next() {
        match (byte, expanded.chars().last()) {
            (b'*', Some(before)) => {
                let count = usize::from(bytes.next().unwrap() - 29);
                expanded.extend(std::iter::repeat_n(before, count));
            }
            _ => expanded.push(char::from(*byte)),
        }
    }
    expanded
}

#[test]
fn a_debugger_reads_and_writes_registers_and_memories() {
    let (port, thread) = listen(counter());
    let mut client = Client::connect(port);
    assert!(client.ask("qSupported:hwbreak+").contains("PacketSize"));
    assert_eq!(client.ask("?"), "T05thread:01;");
    // The stack pointer is RAMEND.
    assert_eq!(&client.ask("g")[66..70], "ff21");
    // LDI r16, 0 in flash; the signature; SPL and SPH in the data space; nothing beyond.
    assert_eq!(client.ask("m0,2"), "00e0");
    assert_eq!(client.ask("m840000,3"), "1e9801");
    assert_eq!(client.ask("m80005d,2"), "ff21");
    assert!(client.ask("m900000,1").starts_with('E'));
    // The EEPROM, erased up to its last byte.
    assert_eq!(client.ask("M810ffe,2:1234"), "OK");
    assert_eq!(client.ask("m810ffd,3"), "ff1234");
    assert_eq!(client.ask("m810fff,2"), "34");
    assert!(client.ask("m811000,1").starts_with('E'));
    assert_eq!(client.ask("M800400,2:abcd"), "OK");
    assert_eq!(client.ask("m800400,2"), "abcd");
    // r0 to r31 as the packet has them, r1 changed.
    let registers = client.ask("g");
    let changed = format!("{}7f{}", &registers[..2], &registers[4..]);
    assert_eq!(client.ask(&format!("G{changed}")), "OK");
    assert_eq!(client.ask("g"), changed);
    client.send("k");
    let (farewell, chip) = thread.join().unwrap();
    assert_eq!(farewell, Farewell::Ended);
    assert_eq!(chip.cpu().registers()[1], 0x7F);
    assert_eq!(chip.devices().eeprom()[0xFFE..], [0x12, 0x34]);
}

#[test]
fn time_stands_still_between_break_step_and_continue() {
    let (port, thread) = listen(counter());
    let mut client = Client::connect(port);
    // At RJMP.
    assert_eq!(client.ask("Z0,8,2"), "OK");
    for count in 1..=3 {
        assert!(client.ask("c").starts_with("T05"));
        assert_eq!(client.program_counter(), 8);
        assert_eq!(client.ask("m800300,1"), format!("{count:02x}"));
    }
    // To INC and over it.
    for byte in [2, 4] {
        assert_eq!(client.ask("s"), "S05");
        assert_eq!(client.program_counter(), byte);
    }
    assert_eq!(client.ask("z0,8,2"), "OK");
    assert_eq!(client.ask("D"), "OK");
    let (farewell, chip) = thread.join().unwrap();
    assert_eq!(farewell, Farewell::Detached);
    // LDI 1; INC 1, STS 2, RJMP 2; INC.
    assert_eq!(chip.cpu().cycle(), 1 + 3 * 5 + 1);
}

#[test]
fn a_watched_variable_stops_the_program_and_so_does_control_c() {
    let (port, thread) = listen(counter());
    let mut client = Client::connect(port);
    assert_eq!(client.ask("Z2,800300,1"), "OK");
    let stop = client.ask("c");
    assert!(
        stop.contains("watch:800300") || stop.contains("watch:00800300"),
        "{stop}"
    );
    assert_eq!(client.program_counter(), 8);
    assert_eq!(client.ask("z2,800300,1"), "OK");
    client.send("c");
    client.0.write_all(&[3]).unwrap();
    assert_eq!(client.receive(), "S02");
    client.send("k");
    thread.join().unwrap();
}

#[test]
fn a_program_that_cannot_go_on_is_a_signal() {
    let (port, thread) = listen(chip_of(&[NOP, 0x0001]));
    let mut client = Client::connect(port);
    assert_eq!(client.ask("c"), "S04");
    assert_eq!(client.program_counter(), 2);
    client.send("k");
    thread.join().unwrap();
}

#[test]
fn avr_gdb_itself_breaks_steps_and_reads() {
    let (port, thread) = listen(counter());
    let commands = [
        "set architecture avr:6".to_owned(),
        format!("target remote 127.0.0.1:{port}"),
        "break *8".to_owned(),
        "continue".to_owned(),
        "continue".to_owned(),
        "print $r16".to_owned(),
        "print/x $sp".to_owned(),
        "x/1xb 0x800300".to_owned(),
        "set {char}0x810010 = 0x5a".to_owned(),
        "x/2xb 0x810010".to_owned(),
        "stepi".to_owned(),
        "print $pc".to_owned(),
        "monitor cycle".to_owned(),
        "kill".to_owned(),
    ];
    let mut gdb = Command::new("avr-gdb");
    gdb.args(["--quiet", "--nx", "--batch"]);
    for command in &commands {
        gdb.args(["-ex", command]);
    }
    let Ok(output) = gdb.output() else {
        assert!(
            std::env::var_os("CI").is_none(),
            "avr-gdb is missing: install the package gdb-avr"
        );
        println!("skipped: avr-gdb is not installed");
        return;
    };
    thread.join().unwrap();
    // The monitor's output goes to the other stream.
    let text =
        String::from_utf8(output.stdout).unwrap() + &String::from_utf8(output.stderr).unwrap();
    for expected in [
        "$1 = 2",
        "$2 = 0x21ff",
        "0x800300:\t0x02",
        "0x810010:\t0x5a\t0xff",
        "$3 = (void (*)()) 0x2",
        "\n11\n",
    ] {
        assert!(text.contains(expected), "{expected} is not in {text}");
    }
}
