//! Programs of a page: what it hands in to run, and the source that it is shown.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::{Deserialize, Serialize};

/// Longest name.
const MAX_NAME: usize = 100;
/// Most files of a sketch.
const MAX_FILES: usize = 100;

/// A program that a page hands in.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GivenProgram {
    /// The name of the sketch, or of its only file; no path.
    pub name: String,
    /// Its files by name.
    pub files: Vec<(String, Vec<u8>)>,
    /// It begins under the debugger, at its first line.
    pub debug: bool,
    /// The text of a robot's file: the robot that it drives from here on.
    pub robot: Option<String>,
}

impl GivenProgram {
    /// A program in one file.
    #[must_use]
    pub fn file(name: &str, content: &[u8]) -> Self {
        Self {
            name: name.to_owned(),
            files: vec![(name.to_owned(), content.to_owned())],
            ..Self::default()
        }
    }

    /// A sketch's files, or an only file in base 64, under a name that is only a name. Those of a sketch's files the
    /// compiler checks.
    pub(crate) fn of(
        name: String,
        data: Option<String>,
        files: Vec<SketchFile>,
        debug: bool,
    ) -> Result<Self, String> {
        let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.' | ' ');
        if name.len() > MAX_NAME || name.starts_with('.') || !name.chars().all(plain) {
            return Err("a file's name has letters, digits, _, - and . only".into());
        }
        let files = match data {
            None if (1..=MAX_FILES).contains(&files.len()) => files
                .into_iter()
                .map(|file| (file.name, file.text.into_bytes()))
                .collect(),
            Some(data) if files.is_empty() => {
                let content = STANDARD.decode(data).map_err(|error| error.to_string())?;
                vec![(name.clone(), content)]
            }
            _ => {
                return Err(format!(
                    "a program is the data of one file, or 1 to {MAX_FILES} files"
                ));
            }
        };
        Ok(Self {
            name,
            files,
            debug,
            robot: None,
        })
    }
}

/// A file of a sketch, as text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SketchFile {
    /// With `/` between folders.
    pub name: String,
    /// What is in it.
    pub text: String,
}

/// The source of a program, for a page.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ShownSketch {
    /// That of the order.
    pub ticket: u32,
    /// The sketch's name; empty where none runs.
    pub name: String,
    /// Its files; none of an image.
    pub files: Vec<SketchFile>,
    /// Names of the examples that can be asked for.
    pub examples: Vec<String>,
}

#[cfg(test)]
mod tests {
    use crate::Order;

    #[test]
    fn a_program_has_a_plain_name_and_either_data_or_a_bounded_number_of_files() {
        let order = |body: &str| format!("{{\"type\":\"program\",{body}}}").parse::<Order>();
        let files = |count: usize| vec!["{\"name\":\"a.h\",\"text\":\"é\"}"; count].join(",");
        let Ok(Order::Program(given)) = order(&format!(
            "\"name\":\"wall\",\"debug\":true,\"files\":[{}]",
            files(2)
        )) else {
            panic!("it is one");
        };
        assert_eq!((given.name.as_str(), given.debug), ("wall", true));
        assert_eq!(given.files[1], ("a.h".into(), "é".as_bytes().to_vec()));
        for wrong in [
            format!("\"name\":\"../wall\",\"files\":[{}]", files(1)),
            format!("\"name\":\"wall\",\"files\":[{}]", files(101)),
            format!("\"name\":\"a.hex\",\"data\":\"\",\"files\":[{}]", files(1)),
            "\"name\":\"wall\"".into(),
            "\"name\":\"wall\",\"data\":\"!\"".into(),
        ] {
            assert!(order(&wrong).is_err(), "{wrong}");
        }
        let long = "x".repeat(5_000);
        let request = format!("{{\"type\":\"debug\",\"request\":{{\"command\":\"{long}\"}}}}");
        assert!(request.parse::<Order>().is_err());
    }
}
