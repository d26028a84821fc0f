//! The chip with our image, stopped at each tick where the image exposes its inputs and its outputs.

use crate::state::{State, Variable};
use rumbo_control::{Echo, Inputs, Outputs};
use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::devices::ports::Pin;
use rumbo_emulator::devices::{Event, Input};
use rumbo_emulator::image::Image;
use rumbo_emulator::model::ATMEGA2560;
use rumbo_experiment::files::Library;
use rumbo_robot::latch::Stamp;
use rumbo_robot::{NETWORK_AT, Robot};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Where variables start in the data space.
const SRAM_START: usize = ATMEGA2560.sram_start as usize;

/// Offset of the write count in one of the image's rings: behind its 64 bytes.
const RING: usize = 64;

/// Bytes of `RUMBO_INPUTS`.
const INPUTS_BYTES: usize = 30;
/// Timer 1 in the data space: its control register, the low byte of its count; its cycles per count.
const TCCR1B: u16 = 0x81;
const TCNT1: u16 = 0x84;
const TIMER_CYCLES: u64 = 8;

/// Where the image is; `None` where it has not been built.
pub(crate) fn image_path() -> Option<PathBuf> {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap();
    let path = target.join("firmware/rumbo.elf");
    if !path.exists() {
        let remedy = format!("{} is missing: run `cargo xtask firmware`", path.display());
        assert!(std::env::var_os("CI").is_none(), "{remedy}");
        println!("skipped: {remedy}");
        return None;
    }
    Some(path)
}

/// The image; `None` where it has not been built.
pub(crate) fn image() -> Option<Image> {
    let bytes = std::fs::read(image_path()?).unwrap();
    Some(Image::parse(&bytes).unwrap())
}

/// The same with the network of a policy beside it.
pub(crate) fn image_with_network() -> Option<Image> {
    Some(image()?.with(NETWORK_AT, &network()).unwrap())
}

/// The network of the built-in policy.
pub(crate) fn network() -> Arc<[u8]> {
    Library::new().policy("goal").unwrap().bytes
}

/// Gives a native robot this network, before its first tick.
pub(crate) fn learn(robot: &mut Robot, network: &[u8]) {
    robot.learn(|at| network.get(usize::from(at)).copied().unwrap_or(0xFF));
}

/// A tick of a native robot behind its outputs.
pub(crate) fn report(robot: &mut Robot, network: &[u8]) {
    robot.report();
    robot.decide(|at| network.get(usize::from(at)).copied().unwrap_or(0xFF));
}

/// Its file, debugging information included.
pub(crate) fn elf() -> Option<Vec<u8>> {
    image_path().map(|path| std::fs::read(path).unwrap())
}

/// The chip at its ticks.
pub(crate) struct Board {
    chip: Chip,
    /// When timer 1 was started [counts of the chip's cycles].
    timer_began: u64,
    inputs_latched: u32,
    outputs_left: u32,
    inputs: usize,
    outputs: usize,
    state: State,
    received: usize,
    sending: usize,
    moved: u8,
    hash: u32,
    sent: Vec<u8>,
}

impl Board {
    pub(crate) fn new(elf: &[u8], image: &Image) -> Board {
        let function = |name| image.function_named(name).unwrap().address;
        let variable = |name| image.variable(name).unwrap().address as usize - SRAM_START;
        let mut chip = Chip::new(image);
        for (port, bit) in [('D', 0), ('D', 1), ('D', 2), ('D', 3), ('E', 5)] {
            let sensor = Pin::new(port, bit).unwrap();
            chip.input(0, Input::Pin(sensor, Some(false)));
        }
        let (inputs_latched, outputs_left) = (
            function("rumbo_inputs_latched"),
            function("rumbo_outputs_left"),
        );
        while chip.read_data(TCCR1B) == 0 {
            chip.step();
        }
        let timer_began = chip.cycle() / TIMER_CYCLES;
        chip.cpu_mut().set_breakpoint(inputs_latched);
        chip.cpu_mut().set_breakpoint(outputs_left);
        let mut board = Board {
            chip,
            timer_began,
            inputs_latched,
            outputs_left,
            inputs: variable("RUMBO_INPUTS"),
            outputs: variable("RUMBO_OUTPUTS"),
            state: State::of(elf, image),
            received: variable("RUMBO_RECEIVED"),
            sending: variable("RUMBO_SENDING"),
            moved: 0,
            hash: 0,
            sent: Vec::new(),
        };
        board.run_to(inputs_latched);
        let at = variable("RUMBO_IMAGE_HASH");
        board.hash = u32::from_le_bytes(board.chip.cpu().sram()[at..at + 4].try_into().unwrap());
        board
    }

    /// Runs to a function that does nothing.
    fn run_to(&mut self, function: u32) {
        loop {
            let stopped = self.chip.run_until(u64::MAX / 2);
            assert_eq!(
                stopped,
                Stopped::Breakpoint,
                "{:?}",
                self.chip.cpu().verdict()
            );
            if self.chip.cpu().program_counter() == function {
                break;
            }
            // Where an interrupt comes first, the breakpoint is met once more after it.
            self.chip.step();
        }
        for output in self.chip.take_outputs() {
            match output.event {
                Event::Byte { byte, .. } => self.sent.push(byte as u8),
                Event::Reset(cause) => panic!("reset: {cause:?}"),
                Event::Pin(..) | Event::Duty { .. } | Event::TwoWire(_) => {}
            }
        }
    }

    /// The whole robot as `{:?}` writes it.
    pub(crate) fn write_state(&self, text: &mut String) {
        let sram = self.chip.cpu().sram();
        self.state.write(text, sram, SRAM_START);
    }

    /// A variable at an address of the data space as text.
    pub(crate) fn write(&self, address: usize, shape: &Variable) -> String {
        let at = address - SRAM_START;
        shape.text(&self.chip.cpu().sram()[at..])
    }

    /// How many bytes of the robot are in that text, and how many it has.
    pub(crate) fn bytes_in_state(&self) -> (usize, usize) {
        let mut sram = self.chip.cpu().sram().to_vec();
        let (mut whole, mut other) = (String::new(), String::new());
        self.write_state(&mut whole);
        let robot = self.state.place(&sram, SRAM_START);
        let count = robot.len();
        let counts = robot.filter(|at| {
            sram[*at] ^= 0xFF;
            other.clear();
            self.state.write(&mut other, &sram, SRAM_START);
            sram[*at] ^= 0xFF;
            other != whole
        });
        (counts.count(), count)
    }

    /// The image's hash, as it reports it.
    pub(crate) fn hash(&self) -> u32 {
        self.hash
    }

    /// How many bytes the loop has handed to the link since the last call.
    pub(crate) fn handed_over(&mut self) -> u8 {
        let put = self.chip.cpu().sram()[self.sending + RING];
        let handed_over = put.wrapping_sub(self.moved);
        self.moved = put;
        handed_over
    }

    /// What has left the chip.
    pub(crate) fn sent(&self) -> &[u8] {
        &self.sent
    }

    /// Bytes that the robot receives at the next tick; not more than fit into the ring.
    pub(crate) fn arrive(&mut self, bytes: &[u8]) {
        let ring = &mut self.chip.cpu_mut().sram_mut()[self.received..];
        for byte in bytes {
            let put = ring[RING];
            ring[usize::from(put) % RING] = *byte;
            ring[RING] = put.wrapping_add(1);
        }
    }

    /// One tick with these inputs: the image's outputs, and the cycles it took.
    pub(crate) fn tick(&mut self, inputs: &Inputs) -> ([u8; 9], u64) {
        let record = inputs_record(inputs);
        self.chip.cpu_mut().sram_mut()[self.inputs..self.inputs + record.len()]
            .copy_from_slice(&record);
        self.go_on()
    }

    /// One tick with the inputs that the image has latched.
    pub(crate) fn go_on(&mut self) -> ([u8; 9], u64) {
        let start = self.chip.cpu().cycle();
        self.chip.step();
        self.run_to(self.outputs_left);
        let cycles = self.chip.cpu().cycle() - start;
        let left = self.chip.cpu().sram()[self.outputs..self.outputs + 9]
            .try_into()
            .unwrap();
        self.chip.step();
        self.run_to(self.inputs_latched);
        (left, cycles)
    }

    /// The inputs that it has latched.
    pub(crate) fn inputs(&self) -> &[u8] {
        &self.chip.cpu().sram()[self.inputs..self.inputs + INPUTS_BYTES]
    }

    /// The chip's cycle.
    pub(crate) fn cycle(&self) -> u64 {
        self.chip.cycle()
    }

    /// Something that comes to the chip at a cycle.
    pub(crate) fn input(&mut self, cycle: u64, input: Input) {
        self.chip.input(cycle, input);
    }

    /// A word at an address of the data space.
    pub(crate) fn word(&self, address: usize) -> u16 {
        let at = address - SRAM_START;
        let sram = self.chip.cpu().sram();
        u16::from_le_bytes([sram[at], sram[at + 1]])
    }

    /// The cycle at which timer 1 came to the count of a stamp, one of the last 32 ms.
    pub(crate) fn cycle_of(&self, stamp: Stamp) -> u64 {
        let counts = self.chip.cycle() / TIMER_CYCLES - self.timer_began;
        assert_eq!(counts as u8, self.chip.read_data(TCNT1));
        let ago = (counts as u16).wrapping_sub(stamp.0);
        (self.timer_began + counts - u64::from(ago)) * TIMER_CYCLES
    }
}

/// Inputs in the layout of `RUMBO_INPUTS`.
pub(crate) fn inputs_record(inputs: &Inputs) -> Vec<u8> {
    let mut record = inputs.now.0.to_le_bytes().to_vec();
    for edges in [inputs.encoders.left, inputs.encoders.right] {
        record.extend(edges.count.to_le_bytes());
        record.extend(edges.last.0.to_le_bytes());
        record.extend(edges.turn_us.to_le_bytes());
    }
    let (kind, sonar, pulse_us) = match inputs.echo {
        None => (0, 0, 0),
        Some((sonar, Echo::Pulse(us))) => (1, sonar as u8, us),
        Some((sonar, Echo::Clear)) => (2, sonar as u8, 0),
        Some((sonar, Echo::Silent)) => (3, sonar as u8, 0),
    };
    record.extend([kind, sonar]);
    record.extend(pulse_us.to_le_bytes());
    record
}

/// Outputs in the layout of `RUMBO_OUTPUTS`.
pub(crate) fn outputs_record(outputs: &Outputs) -> [u8; 9] {
    let [a, b] = outputs.drive.left.counts().to_le_bytes();
    let [c, d] = outputs.drive.right.counts().to_le_bytes();
    let [e, f, g, h] = outputs.servo.0.to_le_bytes();
    [
        a,
        b,
        c,
        d,
        e,
        f,
        g,
        h,
        outputs.ping.map_or(255, |sonar| sonar as u8),
    ]
}
