//! The names in files and commands for the control core's numbers.

use super::near;
use super::read::Table;
use super::word::WordError;
use rumbo_control::mode::{ModeId, Movement};

/// The basic movements and their names in files.
pub const MOVEMENTS: [(Movement, &str); 13] = [
    (Movement::Stop, "stop"),
    (Movement::Forward, "forward"),
    (Movement::Backward, "backward"),
    (Movement::TurnLeft, "turn_left"),
    (Movement::TurnRight, "turn_right"),
    (Movement::PivotLeftForward, "pivot_left_forward"),
    (Movement::PivotLeftBackward, "pivot_left_backward"),
    (Movement::PivotRightForward, "pivot_right_forward"),
    (Movement::PivotRightBackward, "pivot_right_backward"),
    (Movement::ArcLeft, "arc_left"),
    (Movement::ArcRight, "arc_right"),
    (Movement::ArcLeftBackward, "arc_left_backward"),
    (Movement::ArcRightBackward, "arc_right_backward"),
];

/// A mode by name or number.
///
/// # Errors
/// [`WordError`].
pub fn find_mode(word: &str) -> Result<ModeId, WordError> {
    let by_number = word.parse().ok().and_then(ModeId::from_number);
    by_number
        .or_else(|| ModeId::ALL.into_iter().find(|mode| mode.name() == word))
        .ok_or_else(|| {
            let names = near::near(word, ModeId::ALL.iter().map(|mode| mode.name()));
            let offered = |mode: &ModeId| names.is_empty() || names.contains(&mode.name());
            WordError::Mode(ModeId::ALL.into_iter().filter(offered).collect())
        })
}

/// A basic movement by name.
///
/// # Errors
/// [`WordError`].
pub fn find_movement(name: &str) -> Result<Movement, WordError> {
    let names = MOVEMENTS.iter().map(|(_, name)| *name);
    MOVEMENTS
        .iter()
        .find(|(_, own)| *own == name)
        .map(|(movement, _)| *movement)
        .ok_or_else(|| WordError::Movement(near::near_or_all(name, names)))
}

/// The key `mode`, if it is given.
pub(super) fn read_mode(root: &Table<'_, '_>) -> Option<ModeId> {
    root.word("mode")
        .and_then(|word| match find_mode(&word.value) {
            Ok(mode) => Some(mode),
            Err(remedy) => {
                root.complain("mode", word.line, &word.value, &remedy.to_string());
                None
            }
        })
}
