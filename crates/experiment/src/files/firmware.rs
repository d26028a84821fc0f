//! A program image from its file, and the wiring that it is for.

use super::bounded::read_at_most;
use super::{FileError, Library, PolicyFile, RobotFile, ScenarioFile};
use rumbo_control::mode::ModeId;
use rumbo_control::rig::Rigs;
use rumbo_emulator::image::{Image, ImageError};
use rumbo_sim::NETWORK_AT;
use rumbo_sim::mega::firmware::{Firmware, LinkLanguage, Opening, opening};
use rumbo_sim::mega::pins::link_usart;
use rumbo_sim::wiring::Wiring;
use std::io;
use std::path::Path;

/// Longest file of an image, debugging information included [bytes].
const LONGEST: u64 = 16 << 20;

/// Reads an image, detects its language from its first output, and wires it: by `wiring`, or else by language and
/// scenario.
///
/// # Errors
/// The file is no program for this chip, or the robot has no such wiring.
pub fn load(
    path: &Path,
    wiring: Option<&str>,
    robot: &RobotFile,
    scenario: &ScenarioFile,
) -> Result<Firmware, FileError> {
    let name = path.file_name().map_or_else(
        || path.display().to_string(),
        |name| name.to_string_lossy().into_owned(),
    );
    wired(&name, read(path)?, wiring, robot, scenario)
}

/// The same of an image that has been read, by the name that messages use.
///
/// # Errors
/// The image is for another board, or the robot has no such wiring.
pub fn wired(
    name: &str,
    image: Image,
    wiring: Option<&str>,
    robot: &RobotFile,
    scenario: &ScenarioFile,
) -> Result<Firmware, FileError> {
    let board = robot.board;
    let image = image.on(board.chip).map_err(|error| {
        let other = match &error {
            ImageError::Board { own, .. } => {
                Library::new().robot_with(|robot| robot.board.chip == *own)
            }
            _ => None,
        };
        let other = other.map(|robot| format!(", or take the robot {robot}"));
        FileError::Setting(format!(
            "firmware {name}: {error}{}",
            other.unwrap_or_default()
        ))
    })?;
    let opening = opening(board, &image);
    let wiring = match wiring {
        Some(wiring) => wiring.to_owned(),
        None => default_wiring(opening, robot, scenario),
    };
    let pins = find(robot, &wiring)?;
    Ok(Firmware::new(
        name,
        image,
        opening.language,
        (&wiring, pins),
    )?)
}

/// Puts a policy beside a program, if there is one.
///
/// # Errors
/// The program is not ours, or lies where the policy belongs.
pub fn beside(firmware: Firmware, policy: Option<&PolicyFile>) -> Result<Firmware, FileError> {
    let Some(policy) = policy else {
        return Ok(firmware);
    };
    let wrong = |why: &str| {
        let (name, policy) = (firmware.name(), &policy.name);
        FileError::Setting(format!("firmware {name}: takes no policy {policy}: {why}"))
    };
    if firmware.language() != LinkLanguage::Frames {
        return Err(wrong("it is not Rumbo's own; leave the policy out"));
    }
    let placed = firmware.image().clone().with(NETWORK_AT, &policy.bytes);
    let image = placed.map_err(|error| wrong(&error.to_string()))?;
    Ok(firmware.with_image(image))
}

/// Reads an image.
///
/// # Errors
/// The file is no program for any of the boards.
pub fn read(path: &Path) -> Result<Image, FileError> {
    let bytes = bytes(path)?;
    let shown = path.display();
    Image::parse(&bytes).map_err(|error| FileError::Setting(format!("firmware {shown}: {error}")))
}

/// The bytes of an image's file.
///
/// # Errors
/// No file of a size that an image can have.
pub fn bytes(path: &Path) -> Result<Vec<u8>, FileError> {
    let read = std::fs::metadata(path).and_then(|about| match about.is_file() {
        true => read_at_most(path, LONGEST),
        false => Err(io::Error::other("no file")),
    });
    read.map_err(|error| {
        let shown = format!("firmware {}", path.display());
        FileError::unreadable(shown, &error, "the .elf or .hex that the compiler made")
    })
}

fn find<'a>(robot: &'a RobotFile, wiring: &str) -> Result<&'a Wiring, FileError> {
    robot.wirings.get(wiring).ok_or_else(|| FileError::Unknown {
        kind: "wiring",
        name: wiring.to_owned(),
        near: robot.wirings.keys().cloned().collect(),
    })
}

/// For our program the final build; for another one, the report's build for this experiment, unless the program has
/// switched on the transmitter of another build's link: then that build.
fn default_wiring(opening: Opening, robot: &RobotFile, scenario: &ScenarioFile) -> String {
    // Files of earlier versions have one wiring for both places of the pair.
    let of_pair = |name| match robot.wirings.contains_key(name) {
        true => name,
        false => "modes_2_to_4",
    };
    let name = match (opening.language, scenario.rig.as_str(), scenario.mode) {
        (LinkLanguage::Frames, ..) => "final",
        (_, "front_single", ModeId::FrontDistance) => "mode_1",
        (_, "front_pair", _) => of_pair("mode_2"),
        (_, "side_pair_left" | "side_pair_right", _) => of_pair("modes_3_and_4"),
        // Without sonars.
        (.., mode) if mode.description().rigs == Rigs::ANY => "modes_5_to_7",
        _ => "final",
    };
    let fits = |name: &str| {
        let wiring = robot.wirings.get(name);
        let link = wiring.and_then(link_usart);
        link.is_some_and(|usart| opening.transmits[usize::from(usart)])
    };
    let mut names = robot.wirings.keys();
    let found = match names.len() {
        0 | 1 => names.next(),
        _ if fits(name) => None,
        _ => names.find(|other| fits(other)),
    };
    found.map_or_else(|| name.to_owned(), Clone::clone)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_report_s_wirings_have_the_module_on_usart_1_and_2() {
        let robot = Library::new().robot("memoria").unwrap();
        let link = |name: &str| link_usart(&robot.wirings[name]);
        assert_eq!(link("final"), Some(2));
        for name in ["mode_1", "mode_2", "modes_3_and_4", "modes_5_to_7"] {
            assert_eq!(link(name), Some(1), "{name}");
        }
    }
}
