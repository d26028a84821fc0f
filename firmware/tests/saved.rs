//! Parameters saved in the chip's EEPROM: the robot starts with valid ones after any loss of power or corruption.

use crate::board::image;
use crate::talk::Talk;
use rumbo_control::params::ParamId;
use rumbo_emulator::image::Image;
use rumbo_experiment::files::{Library, Overrides};
use rumbo_robot::START_AT;
use rumbo_sim::{Config, Sim};
use rumbo_wire::{
    Command, Decoder, EventKind, FrameMessage, FromRobot, Recalled, Received, RobotTime, ToRobot,
};

/// Longest duration of a save: a byte a tick [ms].
const SAVE_MS: u64 = 4_500;

fn recalled(talk: &Talk) -> Option<Recalled> {
    talk.received.iter().find_map(|message| match message {
        FromRobot::Event(event) => match event.kind {
            EventKind::Recalled(recalled) => Some(recalled),
            _ => None,
        },
        _ => None,
    })
}

fn is_saved(talk: &Talk) -> bool {
    talk.received
        .iter()
        .any(|message| matches!(message, FromRobot::Event(event) if event.kind == EventKind::Saved))
}

/// A chip that has saved these bases one after the other.
fn saved(image: &Image, bases_m: &[f32]) -> Talk {
    let mut talk = Talk::new(image, &[]);
    talk.run_ms(100);
    for base_m in bases_m {
        talk.set(ParamId::Base, *base_m);
        talk.received.clear();
        talk.command(Command::SaveParams);
        talk.run_ms(SAVE_MS);
        assert!(is_saved(&talk));
    }
    talk
}

/// Every state of the EEPROM in the course of a save.
fn cuts(talk: &mut Talk) -> Vec<Vec<u8>> {
    talk.received.clear();
    let mut cuts = vec![talk.eeprom()];
    talk.command(Command::SaveParams);
    for _ in 0..SAVE_MS {
        talk.run_ms(1);
        let now = talk.eeprom();
        if cuts.last() != Some(&now) {
            cuts.push(now);
        }
    }
    assert!(is_saved(talk));
    cuts
}

/// The base that a chip starts with, and the source that it reports.
fn started(image: &Image, eeprom: &[u8]) -> (f32, Option<Recalled>) {
    let mut talk = Talk::new(image, eeprom);
    talk.run_ms(60);
    (talk.get(ParamId::Base), recalled(&talk))
}

#[test]
fn a_power_cut_after_any_byte_of_a_save_loses_nothing() {
    let Some(image) = image() else {
        return;
    };
    let default = ParamId::Base.limits().default;
    // Into an erased EEPROM, where every byte is new; and over an older copy.
    let saves: [(&[f32], _, _); 2] = [
        (&[], (default, None), 300),
        (&[0.11, 0.12], (0.12, Some(Recalled::First)), 6),
    ];
    for (before_m, was, least_cuts) in saves {
        let mut talk = saved(&image, before_m);
        talk.run_ms(100);
        talk.set(ParamId::Base, 0.13);
        let cuts = cuts(&mut talk);
        println!("{} cuts", cuts.len());
        assert!(cuts.len() > least_cuts);
        for (cut, eeprom) in cuts.iter().enumerate() {
            // The state after the last byte alone has the new values.
            let is_last = cut + 1 == cuts.len();
            let is = (0.13, Some(Recalled::Second));
            let wanted = if is_last { is } else { was };
            assert_eq!(started(&image, eeprom), wanted, "cut {cut}");
        }
    }
}

#[test]
fn damaged_copies_are_rejected_and_reported() {
    let Some(image) = image() else {
        return;
    };
    let good = saved(&image, &[0.11, 0.12]).eeprom();
    let (mut older, mut newer, mut both) = (good.clone(), good.clone(), good);
    // The second save went to the first copy.
    older[2_048 + 300] ^= 0x01;
    newer[200] ^= 0x40;
    both[30] ^= 0x80;
    both[2_048 + 30] ^= 0x80;
    let default = ParamId::Base.limits().default;
    let neither = (default, Some(Recalled::Neither));
    assert_eq!(started(&image, &older), (0.12, Some(Recalled::FirstAlone)));
    assert_eq!(started(&image, &newer), (0.11, Some(Recalled::SecondAlone)));
    assert_eq!(started(&image, &both), neither);
    assert_eq!(started(&image, &[0; 4_096]), neither);
    assert_eq!(started(&image, &[]), (default, None));
}

/// Sends a command to a simulated robot, runs it for this time [us], and returns its messages.
fn exchange(sim: &mut Sim, number: u16, command: Command, us: u64) -> Vec<FromRobot> {
    let start = sim.memory()[usize::from(START_AT)];
    let message = ToRobot::Command {
        session: 7,
        number,
        command,
        seen: RobotTime {
            start,
            ms: (sim.now_us() / 1_000).saturating_sub(10) as u32,
        },
    };
    sim.send(message.frame(0).bytes());
    sim.advance(sim.now_us() + us);
    let mut bytes = Vec::new();
    sim.receive(&mut bytes);
    let mut decoder = Decoder::<128>::default();
    let messages = bytes.iter().filter_map(|byte| match decoder.push(*byte) {
        Some(Received::Frame(body)) => FromRobot::from_body(&body).ok(),
        _ => None,
    });
    messages.collect()
}

#[test]
fn the_simulated_robot_keeps_its_parameters_in_the_same_bytes() {
    let Some(image) = image() else {
        return;
    };
    let library = Library::new();
    let setup = library.setup("free", &Overrides::default()).unwrap();
    let mut sim = setup.sim(1).unwrap();
    let id = ParamId::Base as u8;
    let set = Command::SetParam { id, value: 0.12 };
    exchange(&mut sim, 1, set, 100_000);
    exchange(&mut sim, 2, Command::SaveParams, SAVE_MS * 1_000);
    let memory = sim.memory();
    assert_eq!(memory, saved(&image, &[0.12]).eeprom()[..memory.len()]);
    let mut again = Sim::new(Config {
        memory,
        ..setup.config(1).unwrap()
    })
    .unwrap();
    let received = exchange(&mut again, 1, Command::GetParam { id }, 200_000);
    let held = received.into_iter().find_map(|message| match message {
        FromRobot::Ack(ack) => Some(ack.result),
        _ => None,
    });
    assert_eq!(held, Some(Ok(0.12)));
}
