//! The command line: what it prints, writes and refuses, and the programs it starts.

mod browser;
mod calibration;
mod command_line;
mod experiments;
mod files;
mod flash;
mod grade;
mod identify;
mod logs;
mod recording;
mod studies;
#[path = "../support/mod.rs"]
mod support;
mod text_robot;
