//! `rumbo flash`: writes the image to an Arduino Mega over its USB cable, through its boot loader.

use crate::args::FlashArgs;
use crate::failure::Failure;
use crate::output;
use indicatif::{ProgressBar, ProgressStyle};
use rumbo_emulator::image::Image;
use rumbo_emulator::model::ATMEGA2560;
use rumbo_experiment::files::{Library, firmware};
use rumbo_flash::Programmer;
use rumbo_sim::NETWORK_AT;
use rumbo_station::port;
use std::fmt::Display;
use std::path::PathBuf;

/// Where `cargo xtask firmware` puts the image, in the folder of what is built.
const BUILT: &str = "firmware/rumbo.hex";
/// The image that a release carries.
#[cfg(carries_image)]
const CARRIED: Option<&[u8]> = Some(include_bytes!(env!("RUMBO_IMAGE")));
#[cfg(not(carries_image))]
const CARRIED: Option<&[u8]> = None;
/// The parts of the bar.
const PARTS: u64 = 1_000;

/// Checks image and board, then writes and reads back.
pub(crate) fn flash(args: &FlashArgs) -> Result<(), Failure> {
    let port = &args.port;
    let (name, image) = image(args)?;
    let wrong = |error: &dyn Display| Failure::Input(format!("firmware {name}: {error}"));
    let image = image.on(&ATMEGA2560).map_err(|error| wrong(&error))?;
    let image = match &args.policy {
        Some(policy) => {
            let policy = Library::new().policy(policy)?;
            let placed = image.with(NETWORK_AT, &policy.bytes);
            placed.map_err(|error| wrong(&error))?
        }
        None => image,
    };
    let mut programmer = Programmer::new(image.flash()).map_err(|error| wrong(&error))?;
    output::line(&format!(
        "writing {name} ({} bytes) to {port}",
        programmer.bytes()
    ))?;
    let style = ProgressStyle::with_template("{msg:14} [{bar:40}] {percent:>3} %");
    // On stderr, and only where that is a terminal.
    let bar =
        ProgressBar::new(PARTS).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    let written = port::write_program(port, &mut programmer, |programmer| {
        let (phase, part) = programmer.progress();
        bar.set_message(phase.to_string());
        bar.set_position((part * PARTS as f64) as u64);
    });
    bar.finish_and_clear();
    match written {
        Ok(()) => output::line("done: the robot starts again, disarmed"),
        // It names the port by itself.
        Err(error @ port::WriteError::Port(_)) => Err(Failure::input(error)),
        Err(error) => Err(Failure::Input(format!(
            "{port}: {error}{}",
            programmer.aftermath()
        ))),
    }
}

/// The requested image, or the one built here, or the one that this release carries, with its name.
fn image(args: &FlashArgs) -> Result<(String, Image), Failure> {
    let target = std::env::var_os("CARGO_TARGET_DIR");
    let built = target
        .map_or_else(|| PathBuf::from("target"), PathBuf::from)
        .join(BUILT);
    let path = match &args.image {
        Some(path) => path,
        None if built.exists() => &built,
        None => {
            let carried = CARRIED.ok_or_else(|| {
                Failure::Input(format!(
                    "there is no firmware {}: build it with `cargo xtask firmware` in the folder of Rumbo's sources, or give one with --image",
                    built.display()
                ))
            })?;
            let image = Image::parse(carried).map_err(Failure::input)?;
            return Ok((concat!("rumbo ", env!("CARGO_PKG_VERSION")).into(), image));
        }
    };
    Ok((path.display().to_string(), firmware::read(path)?))
}
