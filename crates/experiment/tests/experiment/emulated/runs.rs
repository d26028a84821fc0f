//! Scenarios run with an image: commands in its language, metrics whatever it is, verdicts.

use super::rig::{image, setup};
use rumbo_experiment::files::{FileError, Library, Overrides, TimedText, TypedPort};
use rumbo_experiment::note::Note;
use rumbo_experiment::run::run;
use rumbo_wire::LineEnding;
use std::path::PathBuf;

#[test]
fn the_report_s_program_as_a_sketch_stops_before_the_wall_like_its_native_form() {
    let Some(firmware) = image("memoria-mode1") else {
        return;
    };
    let overrides = Overrides {
        firmware: Some(firmware),
        ..Overrides::default()
    };
    let setup = Library::new().setup("mode1", &overrides).unwrap();
    assert_eq!(setup.firmware.as_ref().unwrap().wiring(), "mode_1");
    let result = run(&setup, 1).unwrap();
    let metrics = &result.metrics;
    assert_eq!(metrics["contacts"], 0.0);
    assert!(metrics["step1.settling_s"] < 4.0, "{metrics:?}");
    assert!(metrics["step1.steady_error_m"] < 0.03, "{metrics:?}");
    assert!(
        (10.0..25.0).contains(&metrics["telemetry_hz"]),
        "{metrics:?}"
    );
    let again = run(&setup, 1).unwrap();
    // Not the metrics: one that is never reached is not a number.
    assert!(result.trace == again.trace && result.failures == again.failures);
}

#[test]
fn a_hand_that_finds_no_room_leaves_the_robot_and_says_so() {
    let mut setup = Library::new()
        .setup("mode1", &Overrides::default())
        .unwrap();
    let at = |at_s, text: &str| TimedText {
        at_s,
        text: text.into(),
        ending: LineEnding::Lf,
        port: TypedPort::Hand,
    };
    // Beside where it is, and in the wall.
    setup.texts = vec![at(0.1, "robot=0 0.1 0"), at(0.2, "robot=1.2 0 0")];
    let result = run(&setup, 1).unwrap();
    let notes: Vec<_> = result.notes.iter().map(Note::to_string).collect();
    assert!(
        matches!(&notes[..], [one] if one.starts_with("at 0.2 s `robot=1.2 0 0`: the hand finds no room")),
        "{notes:?}"
    );
    let after = &result.trace.between(0.24, 0.26)[0];
    assert!(after.x_m < 0.5, "{}", after.x_m);
}

#[test]
fn lines_of_the_command_line_go_out_at_their_time() {
    let Some(mut setup) = setup("free", "bench", None) else {
        return;
    };
    setup.scenario.duration_s = 2.0;
    let at = |at_s, text: &str| TimedText {
        at_s,
        text: text.into(),
        ending: LineEnding::Lf,
        port: TypedPort::Link,
    };
    setup.texts = vec![at(0.5, "DUTY 120"), at(1.5, "COAST")];
    let result = run(&setup, 1).unwrap();
    let driven = |t_s: f64| {
        let samples = result.trace.between(t_s, t_s + 0.02);
        samples[0].duty
    };
    // Nine bytes and the link's delay: 17 ms.
    assert_eq!(
        [driven(0.49), driven(0.56), driven(1.4), driven(1.6)],
        [[0; 2], [120; 2], [120; 2], [0; 2]]
    );
}

#[test]
fn a_line_typed_on_usb_reaches_serial_and_nothing_else() {
    let Some(mut setup) = setup("free", "serial_echo", None) else {
        return;
    };
    setup.scenario.duration_s = 2.0;
    setup.texts = vec![TimedText {
        at_s: 1.0,
        text: "who is there".into(),
        ending: LineEnding::CrLf,
        port: TypedPort::Usb,
    }];
    let result = run(&setup, 1).unwrap();
    let said = |usart| String::from_utf8(result.trace.console(usart)).unwrap();
    assert!(said(0).ends_with("who is there\r\n"), "{}", said(0));
    assert!(!said(2).contains("there"), "{}", said(2));
}

#[test]
fn a_program_that_runs_into_erased_flash_ends_the_run_with_that_verdict() {
    let Some(mut setup) = setup("mode1", "bench", None) else {
        return;
    };
    setup.texts = vec![TimedText {
        at_s: 1.0,
        text: "CRASH".into(),
        ending: LineEnding::Lf,
        port: TypedPort::Link,
    }];
    let result = run(&setup, 1).unwrap();
    assert!(!result.pass);
    // Only the verdict: a run cut short misses its limits anyway.
    let [verdict] = &result.failures[..] else {
        panic!("{:?}", result.failures);
    };
    assert!(
        verdict
            .to_string()
            .starts_with("firmware bench.elf: ran into erased flash at 0x10000"),
        "{verdict}"
    );
    assert!(result.trace.samples.last().unwrap().t_s < 1.1);
}

#[test]
fn what_is_no_image_or_no_wiring_is_refused_in_one_line() {
    let refused = |firmware: PathBuf, wiring: &str| {
        let overrides = Overrides {
            firmware: Some(firmware),
            wiring: Some(wiring.into()),
            ..Overrides::default()
        };
        let error: FileError = Library::new().setup("mode1", &overrides).unwrap_err();
        error.to_string()
    };
    let missing = refused("no/such.elf".into(), "final");
    assert!(
        missing.starts_with("firmware no/such.elf: cannot be read"),
        "{missing}"
    );
    let source = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
    let text = refused(source, "final");
    assert!(
        text.contains("neither an ELF file nor Intel HEX") && !text.contains('\n'),
        "{text}"
    );
    let Some(bench) = image("bench") else { return };
    let wiring = refused(bench, "finale");
    assert!(
        wiring.starts_with("unknown wiring `finale`") && wiring.contains("final"),
        "{wiring}"
    );
}

#[test]
fn without_a_wiring_the_report_s_build_is_taken_unless_the_program_uses_another_build_s_link() {
    let wiring = |scenario: &str, sketch: &str| {
        let overrides = Overrides {
            firmware: Some(image(sketch)?),
            ..Overrides::default()
        };
        let setup = Library::new().setup(scenario, &overrides).unwrap();
        setup.firmware.map(|firmware| firmware.wiring().to_owned())
    };
    let Some(of_mode_5) = wiring("mode5", "memoria-mode5") else {
        return;
    };
    assert_eq!(of_mode_5, "modes_5_to_7");
    assert_eq!(wiring("mode8-goals", "memoria-mode8").unwrap(), "final");
    // Its link is Serial2.
    assert_eq!(wiring("mode5", "bench").unwrap(), "final");
    // It uses no link at all.
    assert_eq!(wiring("mode5", "blink").unwrap(), "modes_5_to_7");
}

#[test]
fn a_short_trigger_fires_and_it_and_resets_over_and_over_are_told() {
    let Some(mut setup) = setup("mode1", "impatient", None) else {
        return;
    };
    setup.scenario.duration_s = 2.0;
    let result = run(&setup, 1).unwrap();
    let ranges_cm = String::from_utf8(result.trace.console(0)).unwrap();
    let ranges_cm: Vec<&str> = ranges_cm.lines().collect();
    assert!(ranges_cm.len() > 20, "{ranges_cm:?}");
    assert!(!ranges_cm.contains(&"0"), "{ranges_cm:?}");
    let notes: Vec<_> = result.notes.iter().map(Note::to_string).collect();
    let [trigger, watchdog, ..] = &notes[..] else {
        panic!("{notes:?}");
    };
    assert!(trigger.contains("high for 3.1 us"), "{trigger}");
    assert!(
        watchdog.contains("watchdog reset the chip 3 times"),
        "{watchdog}"
    );
}

#[test]
fn the_pins_of_the_two_wire_bus_are_high_where_nothing_is_connected() {
    let Some(firmware) = image("impatient") else {
        return;
    };
    let said_low = |wiring: &str| {
        let overrides = Overrides {
            firmware: Some(firmware.clone()),
            wiring: Some(wiring.into()),
            ..Overrides::default()
        };
        let mut setup = Library::new().setup("mode1", &overrides).unwrap();
        setup.scenario.duration_s = 0.3;
        let said = run(&setup, 1).unwrap().trace.console(0);
        String::from_utf8_lossy(&said).contains("low")
    };
    assert!(!said_low("mode_1"));
    // There the encoders drive them.
    assert!(said_low("final"));
}

#[test]
fn a_program_that_is_not_for_this_robot_gets_a_list_of_what_it_never_did() {
    let Some(mut setup) = setup("mode1", "blink", None) else {
        return;
    };
    setup.scenario.duration_s = 1.0;
    let notes = run(&setup, 1).unwrap().notes;
    let notes: Vec<_> = notes.iter().map(Note::to_string).collect();
    let [motors, left, right, link, scenario] = &notes[..] else {
        panic!("{notes:?}");
    };
    assert!(motors.contains("never drove a motor") && motors.contains("wiring final"));
    for (note, signal) in [
        (left, "left_enable (pin 6)"),
        (right, "right_enable (pin 5)"),
    ] {
        assert!(
            note.contains(&format!("motor: {signal} was never high")),
            "{note}"
        );
    }
    assert!(link.contains("Serial2 in wiring final, on no other either"));
    assert!(scenario.contains("a scenario without mode and limits"));
}
