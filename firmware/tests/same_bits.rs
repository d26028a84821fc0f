//! The image and the native robot agree on equal inputs: every output, every byte on the link, and every field of their
//! state.

use crate::board::{Board, elf, image_with_network, learn, network, outputs_record, report};
use crate::is_full;
use crate::tape::Tape;
use crate::world::World;
use rumbo_control::mode::ModeId;
use rumbo_control::params::ParamId;
use rumbo_control::{Inputs, Outputs, SonarId};
use rumbo_robot::{Robot, RobotConfig};
use rumbo_sim::wire_fault::{TimedWireFault, Wire, WireFault};
use rumbo_wire::ResetCause;
use std::collections::BTreeSet;
use std::fmt::Write;

/// Ticks of one run, more than four minutes: a mode after the other. Eight runs make 200,000.
const TICKS: u32 = 25_000;
/// Ticks of such a run that the gate compares; the full check compares all.
const SAMPLE: u32 = 3_000;
/// One in so many ticks has its whole state compared in the gate, each its outputs and its bytes: prime to the rounds of
/// sonars and telemetry.
const STATES: u32 = 7;

/// Cycles of the 3 ms in which the outputs are due.
const IN_TIME: u64 = 48_000;
/// Most cycles from the inputs to the outputs, in any mode.
const MOST: u64 = 45_000;

/// Experiments whose inputs are recorded.
const RECORDED: [&str; 15] = [
    "manual-arc-left-speed",
    "manual-straight",
    "mode1-final",
    "mode2-final",
    "mode3-final",
    "mode4",
    "mode5",
    "mode5-reversal",
    "mode6",
    "mode7",
    "pursuit-curve",
    "mode8-goals",
    "mode8-lane",
    "mode8-obstacles",
    "mode9-random",
];
/// Mode 2 turns on the spot with few robots: its state, and how many are tried.
const TURN: (ModeId, u8) = (ModeId::FrontAlign, 3);
const TRIED: u64 = 100;
/// A sonar in doubt, beside a wall.
const NOISE: TimedWireFault = TimedWireFault {
    at_s: 2.0,
    wire: Wire::Echo(SonarId::Left),
    fault: WireFault::Noisy(200.0),
};
/// Mode 4 has the states of mode 3, which measures first; mode 8 leaves *initialise* in the tick in which it enters it; the
/// run of mode 9 has its goal before it starts.
const NEVER_SEEN: [(ModeId, usize); 3] = [
    (ModeId::WallFollow, 0),
    (ModeId::Mission, 2),
    (ModeId::Policy, 0),
];
/// Ticks of a run in text.
const TICKS_IN_TEXT: u32 = 12_000;

/// The inputs of both robots.
enum Given {
    Random(Box<World>, u32),
    Recorded(Tape),
}

impl Given {
    fn random(seed: u64) -> Given {
        Given::Random(Box::new(World::new(seed)), TICKS)
    }

    fn in_text(seed: u64) -> Given {
        Given::Random(Box::new(World::in_text(seed)), TICKS_IN_TEXT)
    }

    fn ticks(&self) -> u32 {
        match self {
            Given::Random(_, ticks) => *ticks,
            Given::Recorded(tape) => tape.ticks(),
        }
    }

    fn inputs(&mut self, tick: u32, last: &Outputs) -> Inputs {
        match self {
            Given::Random(world, _) => world.inputs(tick, last),
            Given::Recorded(tape) => tape.inputs(tick),
        }
    }

    fn bytes(&mut self, tick: u32) -> Vec<u8> {
        match self {
            Given::Random(world, _) => world.bytes(tick),
            Given::Recorded(tape) => tape.bytes(tick),
        }
    }

    fn mode(&self) -> ModeId {
        match self {
            Given::Random(world, _) => world.mode(),
            Given::Recorded(tape) => tape.mode,
        }
    }
}

/// Where mode 8 gives way.
const CROSSING: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../examples/crossing/mode8-crossing.toml"
);

/// The first robot that turns on the spot in mode 2.
fn turning() -> u64 {
    let (mode, state) = TURN;
    let turns = |seed: &u64| {
        let tape = Tape::of("mode2", *seed, &[], &[]);
        visited(Given::Recorded(tape)).contains(&(mode as u8, state))
    };
    (1..=TRIED).find(turns).expect("no robot turns in mode 2")
}

/// The native robot's inputs in each of [`RECORDED`], of one that is [`turning`], with [`NOISE`], and in [`CROSSING`].
fn recorded() -> impl Iterator<Item = (String, Given)> {
    let tapes = RECORDED.into_iter().map(|scenario| (scenario, 1, None));
    let tapes = tapes.chain([
        ("mode2", turning(), None),
        ("mode3-final", 1, Some(NOISE)),
        ("mode4-final", 1, Some(NOISE)),
        (CROSSING, 1, None),
    ]);
    let tapes = tapes.map(|(scenario, seed, fault)| {
        let tape = Tape::of(scenario, seed, fault.as_slice(), &[]);
        (format!("{scenario} {fault:?}"), Given::Recorded(tape))
    });
    // Impatient: it gives up its goal as unreachable on the way.
    let impatient = [(ParamId::MissionGiveUp, 5.0)];
    let tape = Tape::of("mode8-obstacles", 1, &[], &impatient);
    tapes.chain([("impatient".to_owned(), Given::Recorded(tape))])
}

/// The modes' states that the native robot visits with these inputs.
fn visited(mut given: Given) -> BTreeSet<(u8, u8)> {
    let mut robot = Robot::new(RobotConfig {
        image: 0,
        reset: ResetCause::PowerOn,
        start: 0,
    });
    let network = network();
    learn(&mut robot, &network);
    let (mut outputs, mut visited) = (Outputs::default(), BTreeSet::new());
    for tick in 1..=given.ticks() {
        outputs = robot.tick(&given.inputs(tick, &outputs));
        report(&mut robot, &network);
        let state = robot.mode_state();
        visited.extend(state.map(|(mode, state)| (mode as u8, state)));
        given
            .bytes(tick)
            .into_iter()
            .for_each(|byte| robot.receive(byte));
        while robot.transmit().is_some() {}
    }
    visited
}

/// Runs both; prints the cycles of the ticks by mode.
fn compare(what: &str, mut world: Given) {
    let (Some(elf), Some(image)) = (elf(), image_with_network()) else {
        return;
    };
    let mut board = Board::new(&elf, &image);
    let mut robot = Robot::new(RobotConfig {
        image: board.hash(),
        reset: ResetCause::PowerOn,
        start: 0,
    });
    let network = network();
    learn(&mut robot, &network);
    let (mut outputs, mut transmitted) = (Outputs::default(), Vec::new());
    let [mut native, mut chip] = [String::new(), String::new()];
    const NUMBERS: usize = ModeId::ALL[ModeId::ALL.len() - 1] as usize + 1;
    let (mut worst, mut driven) = ([0; NUMBERS], 0);
    let (mut ticks, mut late) = ([0; NUMBERS], [0; NUMBERS]);
    let is_random = matches!(world, Given::Random(..));
    let count = match is_random && !is_full() {
        true => world.ticks().min(SAMPLE),
        false => world.ticks(),
    };
    for tick in 1..=count {
        let inputs = world.inputs(tick, &outputs);
        outputs = robot.tick(&inputs);
        report(&mut robot, &network);
        let bytes = world.bytes(tick);
        board.arrive(&bytes);
        let (left, cycles) = board.tick(&inputs);
        ticks[world.mode() as usize] += 1;
        late[world.mode() as usize] += u32::from(cycles > IN_TIME);
        assert_eq!(
            left,
            outputs_record(&outputs),
            "{what}, tick {tick}: {inputs:?} {outputs:?}"
        );
        for byte in bytes {
            robot.receive(byte);
        }
        let handed_over = usize::from(board.handed_over());
        transmitted.extend(std::iter::from_fn(|| robot.transmit()).take(handed_over));
        let sent = board.sent();
        assert_eq!(
            sent,
            &transmitted[..sent.len().min(transmitted.len())],
            "{what}, tick {tick}"
        );
        if is_full() || tick % STATES == 0 {
            native.clear();
            chip.clear();
            write!(native, "{robot:?}").unwrap();
            board.write_state(&mut chip);
            assert!(
                native == chip,
                "{what}, tick {tick}: {}",
                first_difference(&native, &chip)
            );
        }
        worst[world.mode() as usize] = cycles.max(worst[world.mode() as usize]);
        driven += u32::from(outputs.drive != Outputs::default().drive);
    }
    println!(
        "{what}: {count} ticks, {driven} of them driven, by mode: most cycles to the outputs {worst:?}, late {late:?} of {ticks:?}"
    );
    let (in_state, of) = board.bytes_in_state();
    println!(
        "{in_state} of the robot's {of} bytes are compared, as {} characters",
        chip.len()
    );
    // The rest belongs to inactive variants, such as bytes of an absent message.
    assert!(in_state > of / 2, "{in_state} of {of}");
    for (mode, worst) in worst.into_iter().enumerate() {
        assert!(worst <= MOST, "mode {mode}: {worst} cycles");
    }
    // At least two bytes a tick; a sample may have the modes that stand.
    let is_whole = is_random && count == world.ticks();
    assert!(
        (driven > count / 8 || !is_whole) && transmitted.len() > 2 * count as usize,
        "{driven} {}",
        transmitted.len()
    );
}

/// Two texts around the first difference.
pub(crate) fn first_difference(native: &str, chip: &str) -> String {
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
    (1..=4).for_each(|seed| compare(&format!("seed {seed}"), Given::random(seed)));
}

#[test]
fn and_with_other_inputs() {
    (5..=8).for_each(|seed| compare(&format!("seed {seed}"), Given::random(seed)));
}

#[test]
fn and_in_the_original_s_text() {
    compare("text", Given::in_text(9));
}

#[test]
fn and_with_what_the_experiments_record() {
    recorded().for_each(|(what, given)| compare(&what, given));
}

#[test]
fn what_both_are_given_leads_through_every_state_of_every_mode() {
    let random = (1..=8).map(Given::random);
    let recorded = recorded().map(|(_, given)| given);
    let given = random.chain([Given::in_text(9)]).chain(recorded);
    let visited: BTreeSet<(u8, u8)> = given.flat_map(visited).collect();
    for mode in ModeId::ALL {
        let states = mode.description().states.iter().enumerate();
        let missed: Vec<_> = states
            .filter(|(state, _)| !NEVER_SEEN.contains(&(mode, *state)))
            .filter(|(state, _)| !visited.contains(&(mode as u8, *state as u8)))
            .collect();
        assert!(missed.is_empty(), "{mode:?}: {missed:?}");
    }
}
