//! Looking at a program while it runs: what is seen, and that the program does not notice.
#![cfg(test)]

use crate::common;
use common::*;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::devices::Input;
use rumbo_emulator::image::Image;
use rumbo_emulator::observe::Watchpoint;
use rumbo_emulator::observe::profile::{InterruptUse, Profile};
use rumbo_emulator::observe::waveform::Waveform;

const RCALL_OVER_2: u16 = 0xD002;
const RET: u16 = 0x9508;
const STAY: u16 = 0xCFFF;

/// INT0 toggles PB7; `main` starts at word 0x80.
fn words(main: &[u16]) -> Vec<u16> {
    let mut words = vec![NOP; 0x80];
    words[..2].copy_from_slice(&[0x940C, 0x80]);
    words[2..4].copy_from_slice(&[0x940C, 0x40]);
    words[0x40..0x42].copy_from_slice(&[sbi(0x03, 7), RETI]);
    words.extend(main);
    words
}

/// Any edge on INT0 is served; the loop calls a routine of 3 NOPs for ever.
fn busy() -> Chip {
    busy_with(1)
}

/// The same with this sense of INT0: 0 for its low level, 1 for any edge.
fn busy_with(sense: u8) -> Chip {
    let mut main = vec![ldi(16, sense)];
    main.extend(sts(0x69, 16));
    main.extend((sense != 1).then_some(ldi(16, 1)));
    main.extend([out(0x1D, 16), ldi(16, 0x80), out(0x04, 16), SEI]);
    // The loop: RCALL the routine two words on; RJMP back; then the routine.
    main.extend([RCALL_OVER_2 - 1, 0xCFFE, NOP, NOP, NOP, RET]);
    let mut chip = chip_of(&words(&main));
    for (cycle, level) in [(50, true), (133, false), (200, true), (1000, false)] {
        chip.input(cycle, Input::Pin(pin('D', 0), Some(level)));
    }
    chip
}

#[test]
fn a_watched_address_stops_the_program_after_the_access() {
    let mut main = vec![ldi(16, 7)];
    main.extend(sts(0x0300, 16));
    main.extend(sts(0x0301, 16));
    main.extend([0x9100, 0x0301, STAY]);
    let mut chip = chip_of(&words(&main));
    let watchpoint = |reads| Watchpoint {
        addresses: 0x301..0x303,
        reads,
        writes: !reads,
    };
    chip.observers_mut().watch(watchpoint(true));
    chip.observers_mut().watch(watchpoint(false));
    let stopped = |reads| Stopped::Watched {
        address: 0x301,
        watchpoint: watchpoint(reads),
    };
    assert_eq!(chip.run_until(100), stopped(false));
    assert_eq!(chip.cpu().program_counter(), 0x85);
    assert_eq!(chip.cpu().sram()[0x101], 7);
    assert_eq!(chip.run_until(100), stopped(true));
    assert!(chip.observers_mut().unwatch(&watchpoint(true)));
    assert_eq!(chip.run_until(100), Stopped::Reached);
}

#[test]
fn a_trace_lists_each_instruction_of_its_window_and_its_effects() {
    let mut main = vec![ldi(16, 0x80), ldi(17, 0x80), 0x0F01];
    main.extend([0x930F, 0x911F, STAY]);
    let mut chip = chip_of(&words(&main));
    // JMP takes cycles 0 to 2, LDI 3; the window starts with the second LDI.
    chip.observers_mut().trace(4..9);
    chip.run_until(100);
    let image = Image::default();
    let lines: Vec<String> = chip
        .observers_mut()
        .take_trace()
        .iter()
        .map(|line| line.line(&image))
        .collect();
    let expected = [
        ("4  0x00102", "ldi r17, 0x80", "r17=80"),
        ("5  0x00104", "add r16, r17", "r16=00 ithSVnZC"),
        ("6  0x00106", "push r16", "sp=21fe"),
        ("8  0x00108", "pop r17", "r17=00 sp=21ff"),
    ];
    assert_eq!(lines.len(), expected.len(), "{lines:#?}");
    for (line, (place, text, changes)) in lines.iter().zip(expected) {
        for part in [place, text, changes] {
            assert!(line.contains(part), "{line} has no {part}");
        }
    }
}

#[test]
fn the_lowest_stack_pointer_is_that_of_the_interrupt_within_the_call() {
    let mut chip = busy();
    chip.observers_mut().measure_stack();
    chip.run_until(2000);
    assert_eq!(chip.observers().lowest_stack_pointer(), Some(0x21FF - 6));
}

#[test]
fn a_level_that_lasts_waits_for_its_routine_from_the_end_of_the_one_before() {
    let mut chip = busy_with(0);
    chip.observers_mut()
        .profile(Profile::new(&Image::default()));
    chip.run_until(2000);
    let [
        InterruptUse {
            count,
            worst_latency,
            ..
        },
    ] = chip.observers().profiled().unwrap().interrupts()[..]
    else {
        panic!("one interrupt");
    };
    // The pin is low at the start, for 67 cycles and for the last thousand.
    assert!(count > 50, "{count}");
    assert!(worst_latency < 20, "{worst_latency}");
}

#[test]
fn a_profile_counts_calls_and_interrupts_to_the_cycle() {
    let mut chip = busy();
    chip.observers_mut()
        .profile(Profile::new(&Image::default()));
    chip.run_until(2000);
    let profile = chip.observers().profiled().unwrap();
    assert_eq!(profile.cycles(), chip.cpu().cycle());
    let interrupts = profile.interrupts();
    // Entry 5, the jump in the table 3, SBI 2, RETI 5. An edge that met the 5 cycles of RET waited for its end.
    let [
        InterruptUse {
            vector: 1,
            count: 4,
            total: 60,
            longest: 15,
            worst_latency,
        },
    ] = interrupts[..]
    else {
        panic!("{interrupts:?}");
    };
    assert!((5..=5 + 4).contains(&worst_latency), "{worst_latency}");
    // The loop takes RCALL 4, 3 NOP, RET 5, RJMP 2 = 14; the routine 8 of it.
    let functions = profile.functions();
    let routine = functions
        .iter()
        .find(|function| function.name == "0x00112")
        .unwrap();
    assert_eq!(routine.own, routine.total);
    assert!((routine.own as i64 - 8 * routine.calls as i64).abs() < 8);
    assert!((routine.calls as i64 - (2000 - 60) / 14).abs() <= 1);
    let folded = profile.folded();
    assert!(folded.contains("interrupt INT0 60\n"), "{folded}");
    let sum: u64 = folded
        .lines()
        .map(|line| line.rsplit(' ').next().unwrap().parse::<u64>().unwrap())
        .sum();
    assert_eq!(sum, profile.cycles());
}

#[test]
fn a_program_runs_the_same_whether_it_is_looked_at_or_not() {
    let (mut seen, mut unseen) = (busy(), busy());
    seen.observers_mut()
        .profile(Profile::new(&Image::default()));
    seen.observers_mut().trace(100..300);
    seen.observers_mut().watch(Watchpoint {
        addresses: 0x300..0x301,
        reads: true,
        writes: true,
    });
    for cycle in (0..3000).step_by(7) {
        assert_eq!(seen.run_until(cycle), unseen.run_until(cycle));
        assert_eq!(seen.cpu().cycle(), unseen.cpu().cycle());
        assert_eq!(seen.cpu().program_counter(), unseen.cpu().program_counter());
        assert_eq!(seen.cpu().registers(), unseen.cpu().registers());
        assert_eq!(seen.take_outputs(), unseen.take_outputs());
    }
}

#[test]
fn a_waveform_has_inputs_and_outputs_at_their_times() {
    let mut chip = busy();
    chip.record_levels();
    chip.run_until(150);
    let mut file = Vec::new();
    let names = [("INT0 edge", pin('D', 0)), ("led", pin('B', 7))]
        .map(|(name, pin)| (name.to_owned(), pin));
    let mut waveform = Waveform::new(&mut file, &names).unwrap();
    for level in chip.take_levels() {
        waveform.put(level).unwrap();
    }
    waveform.finish(chip.cpu().cycle()).unwrap();
    let mut read = vcd::Parser::new(file.as_slice());
    let header = read.parse_header().unwrap();
    assert_eq!(header.timescale, Some((100, vcd::TimescaleUnit::PS)));
    let [edge, led] =
        ["INT0_edge", "led"].map(|name| header.find_var(&["mega", name]).unwrap().code);
    let mut now = 0;
    let mut changes = Vec::new();
    for command in read {
        match command.unwrap() {
            vcd::Command::Timestamp(time) => now = time,
            vcd::Command::ChangeScalar(id, value) => {
                changes.push((now as f64 / 625.0, id == edge, value))
            }
            other => panic!("{other:?}"),
        }
    }
    assert_ne!(edge, led);
    let (high, low) = (vcd::Value::V1, vcd::Value::V0);
    // The edge, and 5 + 3 + 1 cycles later what its routine does; the second meets RCALL or RET.
    assert_eq!(
        changes[..4],
        [
            (0.0, false, low),
            (0.0, true, low),
            (50.0, true, high),
            (59.0, false, high)
        ]
    );
    assert_eq!(changes[4], (133.0, true, low));
}

#[test]
fn a_profile_of_a_compiled_program_names_its_functions() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/programs");
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("sleepy.elf");
    let mut compiler = std::process::Command::new("avr-gcc");
    compiler.args(["-mmcu=atmega2560", "-Os", "-std=gnu11", "-DSECONDS=1", "-o"]);
    let Ok(status) = compiler
        .arg(&path)
        .arg(folder.join("sleepy.c"))
        .arg("-lm")
        .status()
    else {
        assert!(
            std::env::var_os("CI").is_none(),
            "avr-gcc is missing: install the packages gcc-avr and avr-libc"
        );
        println!("skipped: avr-gcc is not installed");
        return;
    };
    assert!(status.success());
    let image = Image::parse(&std::fs::read(&path).unwrap()).unwrap();
    let mut chip = Chip::new(&image);
    chip.observers_mut().profile(Profile::new(&image));
    // The last of the thousand ticks is not over: at 16 MHz each takes 16,000 cycles.
    chip.run_until(15_990_000);
    let profile = chip.observers().profiled().unwrap();
    let calls = |name: &str| {
        profile
            .functions()
            .iter()
            .find(|function| function.name == name)
            .unwrap()
            .calls
    };
    assert_eq!((calls("main"), calls("step")), (1, 2 * 999));
    let [
        InterruptUse {
            vector: 17,
            count: 999,
            ..
        },
    ] = profile.interrupts()[..]
    else {
        panic!("{:?}", profile.interrupts());
    };
    assert!(profile.cycles_asleep() > profile.cycles() / 10);
    let folded = profile.folded();
    for part in [
        "main;step;__mulsf3",
        "interrupt TIMER1_COMPA;__vector_17 ",
        "(asleep) ",
    ] {
        assert!(folded.contains(part), "{part} is not in\n{folded}");
    }
    assert!(profile.report().contains("TIMER1_COMPA"));
    // The pieces of a division are no calls of their own.
    assert!(!folded.contains("__divsf3x;__divsf3x"));
    let step = image.function_named("step").unwrap();
    assert_eq!(image.function(step.address + step.size - 1), Some("step"));
    assert_eq!(image.variable("left").unwrap().size, 18);
    // Written in assembly, it has no type, but a size.
    let copy = image.function_named("__do_copy_data").unwrap();
    assert_eq!(
        image.function(copy.address + copy.size - 1),
        Some("__do_copy_data")
    );
}
