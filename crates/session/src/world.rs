//! A world that a page edits: what the page asks of it, and what it gets.

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// An order about a world.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldOrder {
    /// A number of the page's, for the answer.
    pub ticket: u32,
    /// What is to be done.
    pub act: WorldAct,
    /// The world, as the text of its file or as JSON.
    pub text: String,
}

/// What to do with a world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WorldAct {
    /// To show the one in which the robot drives; the text is empty.
    Show,
    /// To check the one given.
    Check,
    /// To start the robot again in the one given.
    Drive,
}

/// A world to edit.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct EditedWorld {
    /// That of the order.
    pub ticket: u32,
    /// What is in its file; null where that cannot be read.
    pub model: Value,
    /// The text of its file.
    pub toml: String,
    /// What is wrong with it, a line for each problem.
    pub problem: Option<String>,
    /// The robot has been started again in it.
    pub driven: bool,
}
