//! Runs every scenario, or those named, with many seeds and prints requirements beside measurements.
//!
//! `cargo xtask campaign` builds and starts it. Arguments: the number of seeds, then names of scenarios (none: all). Exit status 1 if
//! a requirement was not met, 2 for wrong arguments.

use rumbo_experiment::campaign::{Requirement, campaign};
use std::process::ExitCode;

pub(crate) fn main() -> ExitCode {
    let mut args = crate::arguments();
    let seeds = args.next().and_then(|seeds| seeds.parse().ok());
    let Some(seeds) = seeds.filter(|seeds: &u64| *seeds > 0) else {
        eprintln!("campaign: give the number of seeds, then names of scenarios (none: all)");
        return ExitCode::from(2);
    };
    let only: Vec<String> = args.collect();
    let mut all_met = true;
    let row = |cells: [&str; 4]| {
        let [what, required, measured, verdict] = cells;
        println!("| {what:<61} | {required:<28} | {measured:<22} | {verdict:<6} |");
    };
    row(["what", "required", &format!("{seeds} seeds"), ""]);
    println!("|{:-<63}|{:-<30}|{:-<24}|{:-<8}|", "", "", "", "");
    let show = |finding: Requirement| {
        let Requirement {
            what,
            required,
            measured,
            met,
        } = finding;
        all_met &= met;
        row([&what, &required, &measured, if met { "" } else { "MISSED" }]);
    };
    let ended = campaign(seeds, &only, show);
    crate::ended("campaign", ended.map(|()| all_met))
}
