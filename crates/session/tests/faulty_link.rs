//! A link that loses, flips, repeats, cuts and delays: a sample of what `cargo xtask campaign --only link` does with a million frames.
#![allow(clippy::unwrap_used, clippy::panic)]

#[path = "support/link.rs"]
mod link;
mod support;

#[test]
fn of_frames_over_a_faulty_link_none_is_accepted_that_was_not_sent_and_a_whole_one_is_found_after_a_whole_one()
 {
    let told = link::frames(50_000, 1);
    assert!(told.good(), "{told}");
    assert!(told.hit > told.sent / 5, "{told}");
}

#[test]
fn commands_over_a_faulty_link_are_applied_once_each_in_order() {
    for seed in 0..3 {
        let told = link::commands(10_000, seed);
        assert!(told.good(), "{told}");
    }
}
