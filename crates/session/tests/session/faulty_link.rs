//! A link that loses, flips, repeats, cuts and delays: a sample of the million frames of
//! `cargo xtask campaign --only link`.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::link;
#[test]
fn of_frames_over_a_faulty_link_none_is_accepted_that_was_not_sent_and_a_whole_one_is_found_after_a_whole_one()
 {
    let outcome = link::frames(50_000, 1);
    assert!(outcome.good(), "{outcome}");
    assert!(outcome.hit > outcome.sent / 5, "{outcome}");
}

#[test]
fn commands_over_a_faulty_link_are_applied_once_each_in_order() {
    for seed in 0..3 {
        let outcome = link::commands(10_000, seed);
        assert!(outcome.good(), "{outcome}");
    }
}
