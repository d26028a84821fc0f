//! The image and the native robot, given the same, give the same: every output, every byte on the link, and every field of their state.

use crate::board::{Board, elf, image, outputs_record};
use crate::world::World;
use rumbo_control::Outputs;
use rumbo_robot::{Config, Robot};
use rumbo_wire::ResetCause;
use std::fmt::Write;

/// Ticks of one run, more than four minutes: a mode after the other. Eight runs make 200,000.
const TICKS: u32 = 25_000;

/// Cycles of the 3 ms in which the outputs are due.
const IN_TIME: u64 = 48_000;
/// Most cycles from the inputs to the outputs, by mode, with the compiler of CI and some to spare. All should be in time.
const MOST: [u64; 9] = [
    50_000, 60_000, 50_000, 50_000, 50_000, 50_000, 55_000, 65_000, 110_000,
];

/// Runs both with a seed; prints the cycles of the ticks by mode.
fn compare(seed: u64) {
    let (Some(elf), Some(image)) = (elf(), image()) else {
        return;
    };
    let mut board = Board::new(&elf, &image);
    let mut robot = Robot::new(Config {
        image: board.hash(),
        reset: ResetCause::PowerOn,
    });
    let (mut world, mut outputs, mut told) = (World::new(seed), Outputs::default(), Vec::new());
    let [mut native, mut chip] = [String::new(), String::new()];
    let (mut worst, mut driven) = ([0; 9], 0);
    let (mut ticks, mut late) = ([0; 9], [0; 9]);
    for tick in 1..=TICKS {
        let inputs = world.inputs(tick, &outputs);
        outputs = robot.tick(&inputs);
        robot.report();
        let bytes = world.bytes(tick);
        board.arrive(&bytes);
        let (left, cycles) = board.tick(&inputs);
        ticks[world.mode() as usize] += 1;
        late[world.mode() as usize] += u32::from(cycles > IN_TIME);
        assert_eq!(
            left,
            outputs_record(&outputs),
            "seed {seed}, tick {tick}: {inputs:?} {outputs:?}"
        );
        for byte in bytes {
            robot.receive(byte);
        }
        let handed_over = usize::from(board.handed_over());
        told.extend(std::iter::from_fn(|| robot.transmit()).take(handed_over));
        let sent = board.sent();
        assert_eq!(
            sent,
            &told[..sent.len().min(told.len())],
            "seed {seed}, tick {tick}"
        );
        native.clear();
        chip.clear();
        write!(native, "{robot:?}").unwrap();
        board.write_state(&mut chip);
        assert!(
            native == chip,
            "seed {seed}, tick {tick}: {}",
            first_difference(&native, &chip)
        );
        worst[world.mode() as usize] = cycles.max(worst[world.mode() as usize]);
        driven += u32::from(outputs.drive != Outputs::default().drive);
    }
    println!(
        "seed {seed}: {TICKS} ticks, {driven} of them driven, by mode: most cycles to the outputs {worst:?}, late {late:?} of {ticks:?}"
    );
    let (in_state, of) = board.bytes_in_state();
    println!(
        "{in_state} of the robot's {of} bytes are compared, as {} characters",
        chip.len()
    );
    // The rest belongs to variants that it is not in, such as bytes of a message that is not there.
    assert!(in_state > of / 2, "{in_state} of {of}");
    for (mode, (worst, most)) in worst.into_iter().zip(MOST).enumerate() {
        assert!(worst <= most, "mode {mode}: {worst} cycles");
    }
    assert!(
        driven > TICKS / 6 && told.len() > 50_000,
        "{driven} {}",
        told.len()
    );
}

/// What two texts have around the place where they begin to differ.
fn first_difference(native: &str, chip: &str) -> String {
    let alike = native.bytes().zip(chip.bytes());
    let at = alike.take_while(|(one, other)| one == other).count();
    let around = |text: &str| {
        let bytes = &text.as_bytes()[at.saturating_sub(120)..text.len().min(at + 60)];
        String::from_utf8_lossy(bytes).into_owned()
    };
    format!("{} natively, {} on the chip", around(native), around(chip))
}

#[test]
fn the_image_computes_the_same_bits_as_the_native_robot() {
    (1..=4).for_each(compare);
}

#[test]
fn and_with_other_inputs() {
    (5..=8).for_each(compare);
}
