//! A million frames, or as many as requested, over a link that loses, flips, repeats, cuts and delays. Exit status 1 if
//! one was wrongly accepted.
#![allow(clippy::unwrap_used, clippy::panic)]

#[path = "../tests/support/link.rs"]
mod link;
#[path = "../tests/support/mod.rs"]
mod support;

use std::process::ExitCode;

fn main() -> ExitCode {
    let count = std::env::args().nth(1).and_then(|count| count.parse().ok());
    let count = count.unwrap_or(1_000_000);
    let (frames, commands) = (link::frames(count, 1), link::commands(count, 1));
    println!("link, frames:   {frames}");
    println!("link, commands: {commands}");
    match frames.good() && commands.good() {
        true => ExitCode::SUCCESS,
        false => ExitCode::FAILURE,
    }
}
