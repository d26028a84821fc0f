//! `rumbo export-policy`: a learned network, made into the integers that mode 9 evaluates.

use crate::args::ExportPolicyArgs;
use crate::failure::Failure;
use crate::output;
use crate::place::{self, Guard};
use rumbo_experiment::files::bounded::read_text;
use rumbo_experiment::quantise::{Floats, quantise};
use std::fmt::Display;
use std::path::PathBuf;

/// Reads, quantises, writes and sums up.
pub(crate) fn export_policy(args: &ExportPolicyArgs) -> Result<(), Failure> {
    let shown = args.network.display();
    let wrong = |error: &dyn Display| Failure::Input(format!("{shown}: {error}"));
    let text = read_text(&args.network).map_err(|error| {
        wrong(&format!(
            "cannot be read ({error}); give the JSON of a network"
        ))
    })?;
    let floats: Floats = serde_json::from_str(&text).map_err(|error| {
        wrong(&format!(
            "is no network: {error}; see `rumbo export-policy --help`"
        ))
    })?;
    let policy = quantise(&floats, &args.title).map_err(|error| wrong(&error))?;
    let out = match &args.out {
        Some(out) => out.clone(),
        None => PathBuf::from(args.network.file_stem().unwrap_or(args.network.as_os_str()))
            .with_extension("toml"),
    };
    let guard = Guard::new([&args.network], args.overwrite.force);
    guard.make_equal(&out, |place| {
        std::fs::write(place, &policy.text).map_err(|error| place::unwritable(&out, &error))
    })?;
    let bytes = policy.bytes.len();
    output::line(&format!(
        "{}: {}, {bytes} bytes on the robot",
        out.display(),
        policy.shape
    ))
}
