//! The loop's inputs and outputs of a tick, at known addresses in SRAM.
//!
//! A test that runs this very image stops at [`rumbo_inputs_latched`], reads or replaces the inputs, and reads the
//! outputs and the whole robot at [`rumbo_outputs_left`]: native robot and chip can thus be compared on equal inputs.

use core::cell::UnsafeCell;

use rumbo_control::{Echo, Edges, Inputs, Micros, Outputs, SonarId};
use rumbo_robot::Robot;

/// The inputs, in this order, little-endian, without gaps.
#[derive(Clone, Copy)]
#[repr(C)]
struct InputsRecord {
    now_us: u32,
    left: EdgesRecord,
    right: EdgesRecord,
    /// 0 none, 1 pulse, 2 clear, 3 silent.
    echo: u8,
    /// Number of the sonar.
    sonar: u8,
    pulse_us: u32,
}

/// An encoder's record, likewise.
#[derive(Clone, Copy)]
#[repr(C)]
struct EdgesRecord {
    count: u16,
    last_us: u32,
    turn_us: u32,
}

impl EdgesRecord {
    const fn new(edges: Edges) -> Self {
        Self {
            count: edges.count,
            last_us: edges.last.0,
            turn_us: edges.turn_us,
        }
    }

    const fn edges(self) -> Edges {
        Edges {
            count: self.count,
            last: Micros(self.last_us),
            turn_us: self.turn_us,
        }
    }
}

/// The outputs, likewise.
#[derive(Clone, Copy)]
#[repr(C)]
struct OutputsRecord {
    left: i16,
    right: i16,
    servo_rad: f32,
    /// Number of the sonar, or 255.
    ping: u8,
}

struct Shown<T>(UnsafeCell<T>);

// SAFETY: only the loop touches it.
unsafe impl<T> Sync for Shown<T> {}

const NO_EDGES: EdgesRecord = EdgesRecord {
    count: 0,
    last_us: 0,
    turn_us: 0,
};

// SAFETY, for the names here and below: each is used once.
#[unsafe(no_mangle)]
static RUMBO_INPUTS: Shown<InputsRecord> = Shown(UnsafeCell::new(InputsRecord {
    now_us: 0,
    left: NO_EDGES,
    right: NO_EDGES,
    echo: 0,
    sonar: 0,
    pulse_us: 0,
}));
#[unsafe(no_mangle)]
static RUMBO_OUTPUTS: Shown<OutputsRecord> = Shown(UnsafeCell::new(OutputsRecord {
    left: 0,
    right: 0,
    servo_rad: 0.0,
    ping: 255,
}));

/// Address of the robot; the image's debugging information describes its layout.
#[unsafe(no_mangle)]
static RUMBO_ROBOT: Shown<*const Robot> = Shown(UnsafeCell::new(core::ptr::null()));

/// Does nothing; tests stop here for the inputs of a tick.
#[unsafe(no_mangle)]
#[inline(never)]
extern "C" fn rumbo_inputs_latched() {
    avr_device::asm::nop();
}

/// Does nothing; tests stop here for the outputs of a tick.
#[unsafe(no_mangle)]
#[inline(never)]
extern "C" fn rumbo_outputs_left() {
    // Two instructions: equal functions would be merged.
    avr_device::asm::nop();
    avr_device::asm::nop();
}

/// Exposes the inputs of a tick, and reads them back in case a test has replaced them.
pub fn inputs(inputs: &mut Inputs) {
    let (echo, sonar, pulse_us) = match inputs.echo {
        None => (0, 0, 0),
        Some((sonar, Echo::Pulse(us))) => (1, sonar as u8, us),
        Some((sonar, Echo::Clear)) => (2, sonar as u8, 0),
        Some((sonar, Echo::Silent)) => (3, sonar as u8, 0),
    };
    let record = RUMBO_INPUTS.0.get();
    // SAFETY: only the loop touches it, and no reference to it is left; volatile, since a test may change it here.
    unsafe {
        (&raw mut (*record).now_us).write_volatile(inputs.now.0);
        (&raw mut (*record).left).write_volatile(EdgesRecord::new(inputs.encoders.left));
        (&raw mut (*record).right).write_volatile(EdgesRecord::new(inputs.encoders.right));
        (&raw mut (*record).echo).write_volatile(echo);
        (&raw mut (*record).sonar).write_volatile(sonar);
        (&raw mut (*record).pulse_us).write_volatile(pulse_us);
        rumbo_inputs_latched();
        inputs.now = Micros((&raw const (*record).now_us).read_volatile());
        inputs.encoders.left = (&raw const (*record).left).read_volatile().edges();
        inputs.encoders.right = (&raw const (*record).right).read_volatile().edges();
        let sonar = (&raw const (*record).sonar).read_volatile();
        let sonar = SonarId::ALL.get(usize::from(sonar)).copied();
        let echo = match (&raw const (*record).echo).read_volatile() {
            1 => Some(Echo::Pulse((&raw const (*record).pulse_us).read_volatile())),
            2 => Some(Echo::Clear),
            3 => Some(Echo::Silent),
            _ => None,
        };
        inputs.echo = sonar.zip(echo);
    }
}

/// Exposes the robot's address.
pub fn robot(robot: &Robot) {
    // SAFETY: as above; the address is never dereferenced here.
    unsafe { RUMBO_ROBOT.0.get().write_volatile(robot) }
}

/// Exposes the outputs of a tick.
pub fn outputs(outputs: &Outputs) {
    // SAFETY: as above.
    unsafe {
        RUMBO_OUTPUTS.0.get().write_volatile(OutputsRecord {
            left: outputs.drive.left.counts(),
            right: outputs.drive.right.counts(),
            servo_rad: outputs.servo.0,
            ping: outputs.ping.map_or(255, |sonar| sonar as u8),
        });
    }
    rumbo_outputs_left();
}
