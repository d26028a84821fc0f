//! A sketch on the emulated Mega and the plant: each line between them does what the real one does.
#![cfg(test)]

mod debugger;
mod memoria;
mod rig;
mod runs;

use rig::Person;
use rumbo_control::SonarId;
use rumbo_sim::mega::Note;
use rumbo_sim::sonar_fault::{SonarFault, TimedSonarFault};

/// Edges of a Hall sensor per wheel turn.
const EDGES_PER_RAD: f64 = 384.0 / std::f64::consts::TAU;

#[test]
fn the_link_carries_lines_both_ways_and_the_debug_console_is_another_usart() {
    let Some(mut person) = Person::at_the_bench("free", None) else {
        return;
    };
    assert_eq!(person.ask("COUNT"), "COUNT 0 0");
    let mega = person.sim.mega_mut().unwrap();
    assert_eq!(mega.take_console(0), b"bench is ready\r\n");
    assert_eq!(mega.take_console(2), b"COUNT 0 0\r\n");
    assert!(mega.take_console(1).is_empty());
}

#[test]
fn a_chip_at_another_rate_than_the_module_is_not_understood() {
    let Some(mut person) = Person::at_the_bench("free", None) else {
        return;
    };
    // The answer is sent at 38400 baud, the module receives at 9600.
    let answer = person.ask("BAUD 384");
    assert!(!answer.contains("rate"), "{answer}");
    let mega = person.sim.mega_mut().unwrap();
    let console = String::from_utf8_lossy(&mega.take_console(2)).into_owned();
    assert!(!console.contains("rate"), "{console}");
    let notes = mega.notes();
    let told = |note: &Note| {
        *note
            == Note::LinkRate {
                sent: 38462.0,
                own: 9600.0,
            }
    };
    assert!(notes.iter().any(told), "{notes:?}");
    // And the program cannot decode what the module sends.
    assert!(!person.ask("COUNT").contains("COUNT"));
}

#[test]
fn every_edge_of_both_encoders_reaches_its_interrupt() {
    let Some(mut person) = Person::at_the_bench("free", None) else {
        return;
    };
    person.send("DUTY 200");
    person.wait_s(1.0);
    // Many outputs split many steps of the plant: no edge may be lost or doubled by that.
    person.send("SERVO 40");
    person.send("SOFT 60");
    person.wait_s(1.0);
    person.send("COAST");
    person.wait_s(1.5);
    let wheels = person.sim.truth().wheel_rad;
    let counts = person.ask_numbers("COUNT");
    assert_eq!(person.sim.truth().wheel_rad, wheels, "at rest");
    let mut fresh = Person::at_the_bench("free", None).unwrap();
    fresh.wait_s(0.0);
    let start = fresh.sim.truth().wheel_rad;
    for ((count, wheel), start) in counts.iter().zip(wheels).zip(start) {
        let expected = (wheel - start) * EDGES_PER_RAD;
        assert!(
            expected > 500.0 && (count - expected).abs() <= 1.0,
            "{count} {expected}"
        );
    }
}

#[test]
fn duty_direction_and_release_reach_the_motors() {
    let Some(mut person) = Person::at_the_bench("free", None) else {
        return;
    };
    person.send("DUTY 150");
    person.wait_s(0.5);
    assert!(person.speed_rad_s() > 5.0);
    assert_eq!(
        [
            person.sim.duty().left.counts(),
            person.sim.duty().right.counts()
        ],
        [150; 2]
    );
    person.send("COAST");
    person.wait_s(1.5);
    assert_eq!(person.speed_rad_s(), 0.0);
    person.send("DUTY -150");
    person.wait_s(0.5);
    assert!(person.speed_rad_s() < -5.0);
    assert_eq!(person.sim.duty().left.counts(), -150);
}

#[test]
fn a_level_on_the_enable_pin_is_full_and_a_hand_made_pwm_is_its_share_of_time() {
    let Some(person) = Person::at_the_bench("free", None) else {
        return;
    };
    // Each from rest at the same place: a second of FULL leads to a wall.
    let speed = |line: &str| {
        let mut person = person.clone();
        let speed_rad_s = person.speed_after(line);
        (speed_rad_s, person.sim.duty().left.counts())
    };
    let ((level, _), (pwm, _)) = (speed("FULL"), speed("DUTY 255"));
    assert!((level / pwm - 1.0).abs() < 0.03, "{level} {pwm}");
    let (soft, duty) = speed("SOFT 50");
    assert!((125..=131).contains(&duty), "{duty}");
    assert!(soft > 0.4 * level && soft < 0.95 * level, "{soft} {level}");
}

#[test]
fn a_pwm_of_31_khz_drives_less_than_one_of_490_hz_at_the_same_share() {
    let Some(mut person) = Person::at_the_bench("free", None) else {
        return;
    };
    let mut speed = |line: &str| person.speed_after(line);
    let (slow, fast) = (speed("DUTY 160"), speed("FAST 160"));
    assert!(fast < 0.9 * slow, "{fast} {slow}");
}

#[test]
fn both_inputs_alike_brake_and_a_released_bridge_coasts() {
    let Some(person) = Person::at_the_bench("free", None) else {
        return;
    };
    let way = |line: &str| {
        let mut person = person.clone();
        person.send("FULL");
        person.wait_s(1.0);
        let from = person.sim.truth().wheel_rad[0];
        person.send(line);
        person.wait_s(2.0);
        person.sim.truth().wheel_rad[0] - from
    };
    let (brake, coast) = (way("BRAKE"), way("COAST"));
    assert!(brake < 0.9 * coast, "{brake} {coast}");
}

#[test]
fn the_servo_turns_where_the_library_points_it_and_stays_when_the_pulses_end() {
    let Some(mut person) = Person::at_the_bench("free", None) else {
        return;
    };
    for (degrees, expected) in [(90, 0.0), (135, 45.0), (30, -60.0)] {
        person.send(&format!("SERVO {degrees}"));
        person.wait_s(0.8);
        let angle = person.sim.truth().servo_rad.to_degrees();
        // The library counts in steps of 4 us.
        assert!((angle - expected).abs() < 1.0, "{degrees}: {angle}");
    }
    let before = person.sim.truth().servo_rad;
    person.send("LIMP");
    person.wait_s(0.5);
    assert_eq!(person.sim.truth().servo_rad, before);
}

#[test]
fn pulse_in_reads_the_distance_to_the_wall() {
    let Some(mut person) = Person::at_the_bench("mode1", None) else {
        return;
    };
    let range_m = person.sim.truth().range_m[2].unwrap();
    let width_us = person.ask_numbers("PING")[0];
    let measured_m = 0.5 * 343.4 * width_us * 1e-6;
    assert!(
        (measured_m / range_m - 1.0).abs() < 0.02,
        "{measured_m} {range_m}"
    );
}

#[test]
fn a_sonar_without_an_echo_holds_its_line_for_38_ms() {
    let Some(mut person) = Person::at_the_bench("free", Some("open")) else {
        return;
    };
    let width_us = person.ask_numbers("PING")[0];
    // Interrupts of millis() steal some of pulseIn's loops.
    assert!((37_600.0..38_000.0).contains(&width_us), "{width_us}");
}

#[test]
fn a_failed_sonar_fails_on_its_line() {
    let Some(person) = Person::at_the_bench("mode1", None) else {
        return;
    };
    let fail = |person: &mut Person, fault| {
        let at_s = person.sim.now_us() as f64 * 1e-6;
        let sonar = SonarId::Front;
        person
            .sim
            .fail_sonar(TimedSonarFault { at_s, sonar, fault });
    };
    let mut cut = person.clone();
    fail(&mut cut, SonarFault::Cut);
    assert_eq!(cut.ask_numbers("PING"), [0.0], "pulseIn gives up");
    let mut stuck = person.clone();
    let before = stuck.ask_numbers("PING")[0];
    fail(&mut stuck, SonarFault::Stuck);
    stuck.send("DUTY 200");
    stuck.wait_s(0.5);
    stuck.send("COAST");
    stuck.wait_s(1.5);
    let after = stuck.ask_numbers("PING")[0];
    assert!((after - before).abs() < 30.0, "{after} {before}");
    let mut spiking = person.clone();
    fail(&mut spiking, SonarFault::Spiking(1.0));
    let widths: Vec<f64> = (0..6).map(|_| spiking.ask_numbers("PING")[0]).collect();
    let sound = person.clone().ask_numbers("PING")[0];
    assert!(
        widths.iter().all(|width| (width - sound).abs() > 50.0),
        "{widths:?} {sound}"
    );
}

#[test]
fn the_same_program_gives_the_same_bytes_and_a_snapshot_goes_on_with_them() {
    let drive = |person: &mut Person| {
        for line in [
            "DUTY 180",
            "PING",
            "SERVO 120",
            "PING",
            "SOFT 40",
            "COUNT",
            "COAST",
            "PING",
        ] {
            person.send(line);
            person.wait_s(0.2);
        }
        let truth = person.sim.truth();
        (std::mem::take(&mut person.received), truth)
    };
    let Some(mut first) = Person::at_the_bench("mode1", None) else {
        return;
    };
    let mut second = Person::at_the_bench("mode1", None).unwrap();
    second.sim.mega_mut().unwrap();
    assert_eq!(drive(&mut first), drive(&mut second));
    let mut snapshot = first.clone();
    // In other steps than before, too.
    first.wait_s(0.4);
    (0..400).for_each(|_| snapshot.wait_s(0.001));
    assert_eq!(drive(&mut first), drive(&mut snapshot));
}
