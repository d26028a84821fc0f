//! Options of the commands that drive: `lab`, `connect`; of `debug`; and of `flash`.

use super::groups::{ImageArgs, SeedArgs, SessionArgs, SettingArgs};
use super::values::speed;
use clap::Args;
use std::path::PathBuf;

/// Options of `rumbo lab`.
#[derive(Args, Clone, Debug)]
#[command(after_help = include_str!("../../help/lab.txt"))]
pub(crate) struct LabArgs {
    /// Scenario that the robot starts in: name or path
    #[arg(long, value_name = "NAME", default_value = "mode1")]
    pub(crate) scenario: String,
    /// So many robots in its world, each disarmed and with a page of its own; STOP on any page stops all
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=32))]
    pub(crate) robots: u8,
    #[command(flatten)]
    pub(crate) setting: SettingArgs,
    #[command(flatten)]
    pub(crate) image: ImageArgs,
    /// Port on 127.0.0.1 for avr-gdb; 0 takes any free one. Robot and world are frozen while the program is halted
    #[arg(long, value_name = "PORT", requires = "image")]
    pub(crate) gdb: Option<u16>,
    #[command(flatten)]
    pub(crate) session: SessionArgs,
    /// Seconds of simulation per second; 0 starts paused
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = speed)]
    pub(crate) speed: f64,
    #[command(flatten)]
    pub(crate) seed: SeedArgs,
    /// Offer the robot as a serial port to other programs, without a dashboard; prints the port's name
    #[cfg(unix)]
    #[arg(long, conflicts_with_all = ["port", "listen", "no_browser", "out"])]
    pub(crate) pty: bool,
    /// Offer the emulated Mega's USB port (Serial) as a serial port to other programs, beside all else; prints its name
    #[cfg(unix)]
    #[arg(long, requires = "image")]
    pub(crate) usb_pty: bool,
}

/// Options of `rumbo debug`.
#[derive(Args, Clone, Debug)]
#[command(after_help = include_str!("../../help/debug.txt"))]
pub(crate) struct DebugArgs {
    /// Folder of a sketch, its .ino, example:NAME, or an ELF file with debugging information [default: what the editor's
    /// launch names]
    #[arg(value_name = "PROGRAM")]
    pub(crate) program: Option<String>,
    /// Scenario that the robot stands in: name or path
    #[arg(long, value_name = "NAME", default_value = "free")]
    pub(crate) scenario: String,
    #[command(flatten)]
    pub(crate) setting: SettingArgs,
    /// Wiring of the robot's board, of the robot file [default: the report's for the experiment]
    #[arg(long, value_name = "NAME")]
    pub(crate) wiring: Option<String>,
    /// Folder of Arduino libraries, which come before those of the Arduino IDE; may be repeated
    #[arg(long, value_name = "DIR")]
    pub(crate) libraries: Vec<PathBuf>,
    /// Compile the sketch as it is compiled to run (-Os), not for debugging (-Og): lines and variables get lost
    #[arg(long)]
    pub(crate) optimised: bool,
    #[command(flatten)]
    pub(crate) seed: SeedArgs,
    /// Port on 127.0.0.1 where one editor may connect, in place of stdin and stdout; 0 takes any free one
    #[arg(long, value_name = "PORT")]
    pub(crate) port: Option<u16>,
}

/// Options of `rumbo connect`.
#[derive(Args, Clone, Debug)]
#[command(after_help = include_str!("../../help/connect.txt"))]
pub(crate) struct ConnectArgs {
    /// Serial port by its name, or tcp:host:port
    #[arg(value_name = "PORT", value_parser = clap::builder::NonEmptyStringValueParser::new())]
    pub(crate) address: String,
    /// Show a simulated robot in this scenario that receives the same commands; put the robot at its start
    #[arg(long, value_name = "SCENARIO")]
    pub(crate) ghost: Option<String>,
    /// The robot runs the original program, which is silent before its first ON: use its text protocol
    #[arg(long, conflicts_with = "ghost")]
    pub(crate) text: bool,
    /// Speed of the serial port; the robot's is 9600
    #[arg(long, value_name = "N", default_value_t = rumbo_station::port::DEFAULT_BAUD, value_parser = clap::value_parser!(u32).range(300..=2_000_000))]
    pub(crate) baud: u32,
    #[command(flatten)]
    pub(crate) session: SessionArgs,
}

/// Options of `rumbo flash`.
#[derive(Args, Clone, Debug)]
#[command(after_help = include_str!("../../help/flash.txt"))]
pub(crate) struct FlashArgs {
    /// Serial port of the Mega's USB cable
    #[arg(value_name = "PORT", value_parser = clap::builder::NonEmptyStringValueParser::new())]
    pub(crate) port: String,
    /// Firmware to write, Intel HEX or ELF [default: the one that `cargo xtask firmware` built, target/firmware/rumbo.hex, or that of this release]
    #[arg(long, value_name = "FILE")]
    pub(crate) image: Option<PathBuf>,
    /// Policy for mode 9 beside it: name or path of a file of `rumbo export-policy`; without it one that is there stays
    #[arg(long, value_name = "NAME")]
    pub(crate) policy: Option<String>,
}
