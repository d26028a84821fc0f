//! The claims hold for the seeds of the fuzz targets, and for some noise.

#![cfg(test)]

use arbitrary::{Arbitrary, Unstructured};
use rumbo_fuzz_claims::{chip, devices, files, image, log, orders, robot, wire};

/// Files of noise for each target, and their longest.
const NOISE: usize = 100;
const LONGEST: usize = 2_048;

/// The seeds of a target, and noise.
fn each(target: &str, check: impl Fn(&[u8])) {
    let folder = format!("{}/../seeds/{target}", env!("CARGO_MANIFEST_DIR"));
    for seed in std::fs::read_dir(folder).into_iter().flatten() {
        check(&std::fs::read(seed.unwrap().path()).unwrap());
    }
    // xorshift64 (Marsaglia 2003).
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    };
    for _ in 0..NOISE {
        let length = next() as usize % LONGEST;
        let bytes: Vec<u8> = (0..length).map(|_| next() as u8).collect();
        check(&bytes);
    }
}

#[test]
fn any_file_is_an_image_or_an_error() {
    each("image", image::check);
}

#[test]
fn any_flash_runs_to_its_end_or_to_a_verdict() {
    each("chip", chip::check);
}

#[test]
fn any_writes_and_inputs_leave_the_chip_running() {
    each("devices", devices::check);
}

#[test]
fn any_bytes_of_the_link_are_messages_or_rejected() {
    each("wire", wire::check);
}

#[test]
fn any_input_leaves_the_robot_running_and_released_unless_armed() {
    each("robot", |bytes| {
        let steps = Vec::arbitrary_take_rest(Unstructured::new(bytes));
        robot::check(steps.unwrap_or_default());
    });
}

#[test]
fn any_text_of_a_page_is_an_order_or_an_error() {
    each("orders", |bytes| {
        orders::check(&String::from_utf8_lossy(bytes))
    });
}

#[test]
fn any_file_is_a_scenario_a_world_a_robot_or_errors() {
    each("files", files::check);
}

#[test]
fn any_file_is_a_log_or_an_error() {
    each("log", log::check);
}
