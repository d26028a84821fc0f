//! A Mega with a sketch, and what its pins did.

use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::devices::ports::{Drive, Pin};
use rumbo_emulator::devices::{Cause, Event, Input};
use rumbo_emulator::image::Image;
use std::path::Path;

pub(crate) const CYCLES_PER_US: u64 = 16;

/// An edge: cycle, pin, level.
type Edge = (u64, Pin, bool);

/// The board.
pub(crate) struct Board {
    pub(crate) chip: Chip,
    image: Image,
    edges: Vec<Edge>,
    bytes: Vec<(u64, u8, u8)>,
    resets: Vec<(u64, Cause)>,
}

impl Board {
    /// With a sketch in its flash; `None` where the sketches have not been built.
    pub(crate) fn with(sketch: &str) -> Option<Board> {
        let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap();
        let path = target.join(format!("sketches/{sketch}.elf"));
        let Ok(bytes) = std::fs::read(&path) else {
            let remedy = format!("{} is missing: run `cargo xtask sketches`", path.display());
            assert!(std::env::var_os("CI").is_none(), "{remedy}");
            println!("skipped: {remedy}");
            return None;
        };
        let image = Image::parse(&bytes).unwrap();
        Some(Board {
            chip: Chip::new(&image),
            image,
            edges: Vec::new(),
            bytes: Vec::new(),
            resets: Vec::new(),
        })
    }

    /// Runs on for a time, and takes note of what the pins do.
    pub(crate) fn run_us(&mut self, us: u64) {
        let end = self.chip.cpu().cycle() + us * CYCLES_PER_US;
        assert_eq!(self.chip.run_until(end), Stopped::Reached);
        assert_eq!(self.chip.unmodelled(), []);
        for output in self.chip.take_outputs() {
            let cycle = output.cycle;
            match output.event {
                Event::Pin(pin, drive @ (Drive::High | Drive::Low)) => {
                    self.edges.push((cycle, pin, drive == Drive::High));
                }
                Event::Byte { usart, byte, .. } => self.bytes.push((cycle, usart, byte as u8)),
                Event::Reset(cause) => self.resets.push((cycle, cause)),
                Event::Pin(..) | Event::Duty { .. } | Event::TwoWire(_) => {}
            }
        }
    }

    /// The bytes that a USART has sent: cycle and byte.
    pub(crate) fn sent(&self, usart: u8) -> Vec<(u64, u8)> {
        let bytes = self.bytes.iter().filter(|(_, by, _)| *by == usart);
        bytes.map(|(cycle, _, byte)| (*cycle, *byte)).collect()
    }

    /// The resets since power-on.
    pub(crate) fn resets(&self) -> &[(u64, Cause)] {
        &self.resets
    }

    /// The edges of a pin of the Mega so far: cycle and level.
    pub(crate) fn edges(&self, number: u8) -> Vec<(u64, bool)> {
        let wanted = mega(number);
        self.edges
            .iter()
            .filter(|(_, pin, _)| *pin == wanted)
            .map(|(cycle, _, level)| (*cycle, *level))
            .collect()
    }

    /// Forgets what pins and USARTs did so far.
    pub(crate) fn forget(&mut self) {
        self.edges.clear();
        self.bytes.clear();
    }

    /// Drives a pin of the Mega from outside at a cycle.
    pub(crate) fn set(&mut self, cycle: u64, number: u8, level: bool) {
        let input = Input::Pin(mega(number), Some(level));
        self.chip.input(cycle, input);
    }

    /// Cycles since power-on.
    pub(crate) fn cycle(&self) -> u64 {
        self.chip.cpu().cycle()
    }

    /// Bytes of a variable of the sketch.
    pub(crate) fn variable<const N: usize>(&self, name: &str, index: usize) -> [u8; N] {
        let variable = self.image.variable(name);
        let variable = variable.unwrap_or_else(|| panic!("no variable {name}"));
        let start =
            variable.address as usize - usize::from(self.chip.model().sram_start) + index * N;
        self.chip.cpu().sram()[start..start + N].try_into().unwrap()
    }

    /// A variable of type `unsigned long`, or an element of an array of them.
    pub(crate) fn long(&self, name: &str, index: usize) -> u64 {
        u64::from(u32::from_le_bytes(self.variable(name, index)))
    }
}

/// Widths of the pulses of one level, between two edges each [cycles].
pub(crate) fn widths(edges: &[(u64, bool)], level: bool) -> Vec<u64> {
    edges
        .windows(2)
        .filter(|two| two[0].1 == level)
        .map(|two| two[1].0 - two[0].0)
        .collect()
}

/// Port and bit of a pin of the Mega.
fn mega(number: u8) -> Pin {
    const PINS: [(u8, char, u8); 27] = [
        (2, 'E', 4),
        (3, 'E', 5),
        (4, 'G', 5),
        (5, 'E', 3),
        (6, 'H', 3),
        (7, 'H', 4),
        (8, 'H', 5),
        (9, 'H', 6),
        (10, 'B', 4),
        (11, 'B', 5),
        (12, 'B', 6),
        (13, 'B', 7),
        (14, 'J', 1),
        (15, 'J', 0),
        (16, 'H', 1),
        (17, 'H', 0),
        (18, 'D', 3),
        (19, 'D', 2),
        (20, 'D', 1),
        (21, 'D', 0),
        (22, 'A', 0),
        (23, 'A', 1),
        (44, 'L', 5),
        (45, 'L', 4),
        (46, 'L', 3),
        (0, 'E', 0),
        (1, 'E', 1),
    ];
    let (_, port, bit) = PINS.iter().find(|(known, _, _)| *known == number).unwrap();
    Pin::new(*port, *bit).unwrap()
}
