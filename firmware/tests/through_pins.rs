//! The same bits from the pins on: edges come to the chip's pins at their cycles, the native latch is given the stamps that the
//! chip's interrupts made of them, and its inputs, outputs and state are the chip's. Each stamp is held against its edge.

use crate::board::{Board, elf, image, inputs_record, outputs_record};
use crate::is_full;
use crate::same_bits::first_difference;
use crate::state::Variable;
use crate::world::{Random, World};
use rumbo_control::{Duty, Inputs, Micros, Outputs, SIDES, SonarId, TICK_US, Wheels};
use rumbo_emulator::devices::Input;
use rumbo_emulator::devices::ports::Pin;
use rumbo_robot::latch::{EchoLatch, EchoLine, EdgeCounter, Stamp};
use rumbo_robot::{Robot, RobotConfig};
use rumbo_wire::ResetCause;
use std::cell::Cell;
use std::collections::VecDeque;
use std::fmt::Write;

/// Ticks of a run: two of the world's episodes, each in another mode.
const TICKS: u32 = 3_000;
const TICK_CYCLES: u64 = 160_000;
const CYCLES_PER_US: u64 = 16;
/// Most cycles from an edge to its stamp.
const MOST_OF_ENCODER: u64 = 240;
const MOST_OF_ECHO: u64 = 400;
/// Stamps in the ring of an encoder's interrupt.
const RING: usize = 32;
/// Time of a ping after the tick, and of the rise of its echo line after that [cycles].
const PING_CYCLES: u64 = 3_000 * CYCLES_PER_US;
const RISE_CYCLES: u64 = 500 * CYCLES_PER_US;

/// A wheel that follows its duty, and the edges of its encoder that the chip has not stamped yet.
struct Wheel {
    pin: Pin,
    level: bool,
    edges_s: f64,
    next: u64,
    waiting: VecDeque<u64>,
    stamps: usize,
    count: u16,
    latch: EdgeCounter,
}

impl Wheel {
    fn new(pin: Pin, ring: usize) -> Wheel {
        Wheel {
            pin,
            level: false,
            edges_s: 0.0,
            next: 0,
            waiting: VecDeque::new(),
            stamps: ring,
            count: 0,
            latch: EdgeCounter::default(),
        }
    }

    /// Puts the edges of the next period on the pin.
    fn turn(&mut self, board: &mut Board, duty: Duty, random: &mut Random) {
        let full_edges_s = 1_800.0;
        let aim_edges_s = f64::from(duty.counts().abs()) / 255.0 * full_edges_s;
        self.edges_s += (aim_edges_s - self.edges_s) * 0.1;
        let until = board.cycle() + TICK_CYCLES;
        if self.edges_s < 5.0 {
            self.next = until;
        }
        while self.next < until {
            let at = self.next.max(board.cycle() + 1);
            self.level = !self.level;
            board.input(at, Input::Pin(self.pin, Some(self.level)));
            self.waiting.push_back(at);
            let uneven = 0.7 + f64::from(random.below(600)) / 1_000.0;
            self.next = at + (uneven * 16e6 / self.edges_s) as u64;
        }
    }

    /// The stamps of the tick, from the ring in which the chip's interrupt left them.
    fn read(&mut self, board: &Board, count: u16, tick: Stamp, now: Micros) -> u64 {
        let mut worst = 0;
        while self.count != count {
            let slot = self.stamps + 2 * (usize::from(self.count) % RING);
            let stamp = Stamp(board.word(slot));
            let edge = self.waiting.pop_front().expect("an edge for each stamp");
            println!(
                "DBG {} {} {}",
                board.cycle(),
                edge,
                board.cycle_of(stamp) as i64 - edge as i64
            );
            worst = worst.max(board.cycle_of(stamp).saturating_sub(edge));
            assert!(!stamp.is_after(tick));
            self.latch.edge(stamp.micros(tick, now));
            self.count = self.count.wrapping_add(1);
        }
        worst
    }
}

/// A sonar: the chip's note of its line, and the edges that were put on it.
struct Sonar {
    id: SonarId,
    pin: Pin,
    line: usize,
    noted: Variable,
    pulse_us: u32,
    edges: Vec<u64>,
}

impl Sonar {
    /// Answers the ping that leaves 3 ms after the tick at this cycle: mostly with an echo.
    fn answer(&mut self, board: &mut Board, tick: u64, random: &mut Random) {
        let rise = tick + PING_CYCLES + RISE_CYCLES + u64::from(random.below(2_000));
        self.pulse_us = (self.pulse_us + random.below(61))
            .saturating_sub(30)
            .clamp(300, 13_000);
        let fall = match random.below(60) {
            0 => None,
            1 => Some(rise + 25_000 * CYCLES_PER_US),
            _ => Some(rise + u64::from(self.pulse_us) * CYCLES_PER_US),
        };
        self.edges = fall.map_or(vec![], |fall| vec![rise, fall]);
        for (at, level) in self.edges.iter().zip([true, false]) {
            board.input(*at, Input::Pin(self.pin, Some(level)));
        }
    }

    /// The line as the chip's interrupts noted it, and the most cycles from an edge to its stamp.
    fn read(&self, board: &Board) -> (EchoLine<Stamp>, u64) {
        let text = board.write(self.line, &self.noted);
        let numbers: Vec<u16> = text
            .split(|c: char| !c.is_ascii_digit())
            .filter_map(|number| number.parse().ok())
            .collect();
        let line = match (text.split('(').next(), &numbers[..]) {
            (Some("Pinged"), [at]) => EchoLine::Pinged(Stamp(*at)),
            (Some("Risen"), [at]) => EchoLine::Risen(Stamp(*at)),
            (Some("Fallen"), [rise, fall]) => EchoLine::Fallen(Stamp(*rise), Stamp(*fall)),
            _ => EchoLine::Idle,
        };
        let stamps = match line {
            EchoLine::Risen(rise) => vec![rise],
            EchoLine::Fallen(rise, fall) => vec![rise, fall],
            EchoLine::Idle | EchoLine::Pinged(_) => vec![],
        };
        let late = |(stamp, edge): (&Stamp, &u64)| board.cycle_of(*stamp).saturating_sub(*edge);
        let worst = stamps.iter().zip(&self.edges).map(late).max();
        (line, worst.unwrap_or(0))
    }
}

/// Runs both; gives the most cycles from an edge of an encoder and of an echo to its stamp.
fn compare(seed: u64) -> Option<[u64; 2]> {
    let (elf, image) = (elf()?, image()?);
    let pin = |port, bit| Pin::new(port, bit).unwrap();
    let at = |name: &str| image.variable(name).unwrap().address as usize;
    let mut board = Board::new(&elf, &image);
    let mut robot = Robot::new(RobotConfig {
        image: board.hash(),
        reset: ResetCause::PowerOn,
        start: 0,
    });
    let (mut world, mut random) = (World::new(seed), Random::new(seed));
    let mut wheels = Wheels {
        left: Wheel::new(pin('D', 0), at("rumbo::hal::encoder::LEFT")),
        right: Wheel::new(pin('D', 1), at("rumbo::hal::encoder::RIGHT")),
    };
    let sonar = |id, port, bit, name| Sonar {
        id,
        pin: pin(port, bit),
        line: at(name),
        noted: Variable::of(&elf, "EchoLine<rumbo_robot::latch::Stamp>"),
        pulse_us: 5_000,
        edges: Vec::new(),
    };
    let mut sonars = [
        sonar(SonarId::Left, 'D', 2, "rumbo::hal::sonar::LEFT"),
        sonar(SonarId::Right, 'D', 3, "rumbo::hal::sonar::RIGHT"),
        sonar(SonarId::Front, 'E', 5, "rumbo::hal::sonar::FRONT"),
    ];
    let tick_at = at("rumbo::hal::tick::TICK");
    let (mut now, mut echoes) = (Micros(0), EchoLatch::default());
    let [mut native, mut chip] = [String::new(), String::new()];
    let (mut worst, mut edges, mut answers, mut driven) = ([0; 2], 0, 0, 0);
    for tick in 1..=TICKS {
        let shown = board.inputs();
        let stamp = Stamp(board.word(tick_at));
        now = now.after(TICK_US);
        for side in SIDES {
            // Behind the time; 10 bytes for each wheel.
            let at = 4 + 10 * side as usize;
            let count = u16::from_le_bytes([shown[at], shown[at + 1]]);
            edges += u32::from(count.wrapping_sub(wheels[side].count));
            worst[0] = worst[0].max(wheels[side].read(&board, count, stamp, now));
        }
        let late_echo = Cell::new(worst[1]);
        let echo = echoes.read(now, |id| {
            let sonar = sonars.iter().find(|sonar| sonar.id == id).unwrap();
            let (line, late) = sonar.read(&board);
            late_echo.set(late_echo.get().max(late));
            line.map(|at| at.micros(stamp, now))
        });
        worst[1] = late_echo.get();
        answers += u32::from(echo.is_some());
        let inputs = Inputs {
            now,
            encoders: Wheels {
                left: wheels.left.latch.edges(),
                right: wheels.right.latch.edges(),
            },
            echo,
            battery_v: None,
        };
        assert_eq!(shown, inputs_record(&inputs), "tick {tick}: {inputs:?}");
        let outputs = robot.tick(&inputs);
        robot.report();
        // Only for what the world says; what it senses is not what the pins show.
        world.inputs(tick, &outputs);
        let bytes = world.bytes(tick);
        board.arrive(&bytes);
        for side in SIDES {
            wheels[side].turn(&mut board, outputs.drive[side], &mut random);
        }
        if let Some(id) = outputs.ping {
            echoes.asked(id);
            let sonar = sonars.iter_mut().find(|sonar| sonar.id == id).unwrap();
            let tick = board.cycle_of(stamp);
            sonar.answer(&mut board, tick, &mut random);
        }
        let (left, _) = board.go_on();
        assert_eq!(left, outputs_record(&outputs), "tick {tick}: {inputs:?}");
        bytes.into_iter().for_each(|byte| robot.receive(byte));
        for _ in 0..board.handed_over() {
            robot.transmit();
        }
        native.clear();
        chip.clear();
        write!(native, "{robot:?}").unwrap();
        board.write_state(&mut chip);
        assert!(
            native == chip,
            "tick {tick}: {}",
            first_difference(&native, &chip)
        );
        driven += u32::from(outputs.drive != Outputs::default().drive);
    }
    println!(
        "seed {seed}: {edges} edges, {answers} answers, {driven} ticks driven; latest stamps {worst:?} cycles after their edges"
    );
    assert!(
        edges > 2_000 && answers > TICKS / 4 && driven > TICKS / 10,
        "{edges} {answers} {driven}"
    );
    Some(worst)
}

#[test]
fn the_chip_s_latch_is_the_native_one_from_the_pins_on() {
    for seed in 1..=if is_full() { 6 } else { 2 } {
        let Some([of_encoder, of_echo]) = compare(seed) else {
            return;
        };
        assert!(of_encoder <= MOST_OF_ENCODER, "{of_encoder}");
        assert!(of_echo <= MOST_OF_ECHO, "{of_echo}");
    }
}
