//! Files as they come and go: nothing that is there is lost, nothing in them is obeyed, and no damage goes unnoticed.

#![allow(clippy::unwrap_used, clippy::panic)]

mod damage;
mod episode;
mod forged;
mod kept;
mod limits;
mod logs;
mod model;

use crate::support::rumbo_in;
use std::process::Output;

/// Its exit status.
fn status(output: &Output) -> i32 {
    output.status.code().unwrap()
}

/// A scenario of a moment, with this title and duration \[s\].
fn scenario(title: &str, duration_s: f64) -> String {
    format!(
        "title = \"{title}\"\nrobot = \"memoria\"\nrig = \"front_single\"\nworld = \"open\"\nmode = 5\nduration_s = {duration_s}\n\
         [[command]]\nat_s = 0.05\nspeed_rpm = 60\n[[command]]\nat_s = 0.1\narm = true\n"
    )
}
