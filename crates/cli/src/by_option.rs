//! What is wrong with the file of a new robot, said of the options that were to make it: that file was never written.

use rumbo_experiment::files::new_robot::{NAMED, NewRobot};
use rumbo_experiment::files::{About, FileError, FileProblem};

/// The problems by option and entry; those that come from no option alone as they are.
pub(crate) fn said_of_options(robot: &NewRobot, error: FileError) -> FileError {
    let FileError::Invalid(problems) = error else {
        return error;
    };
    let text = robot.text();
    let said = problems.into_iter().map(|problem| {
        let path = match &problem.about {
            About::File => path_at(&text, problem.line),
            About::Table(path) | About::Key(path, _) | About::Missing(path) => path.clone(),
        };
        match entry(robot, &path.split('.').collect::<Vec<_>>()) {
            Some(file) => FileProblem {
                file,
                line: 0,
                about: About::File,
                text: problem.text,
            },
            None => problem,
        }
    });
    FileError::Invalid(said.collect())
}

/// The key in a line of a file, with its table.
fn path_at(text: &str, line: usize) -> String {
    let before: Vec<&str> = text.lines().take(line).collect();
    let table = before.iter().rev().find_map(|line| {
        let table = line.strip_prefix('[')?;
        table.strip_suffix(']')
    });
    let key = before.last().and_then(|line| line.split_once(" = "));
    format!(
        "{}.{}",
        table.unwrap_or_default(),
        key.map_or("", |(key, _)| key)
    )
}

/// The option and the entry that a key of the file is from.
fn entry(robot: &NewRobot, path: &[&str]) -> Option<String> {
    let pin = |signal: &str| {
        let (_, pin) = robot.pins.iter().find(|(own, _)| own == signal)?;
        Some(format!("--pins {signal}={pin}"))
    };
    let place = |sensor: &str| {
        let (_, [x_m, y_m, deg]) = robot.sensors.iter().find(|(own, _)| own == sensor)?;
        Some(format!("--sensors {sensor}={x_m}:{y_m}:{deg}"))
    };
    match path {
        ["rig", _, sonar, ..] => place(sonar).or_else(|| pin(&format!("{sonar}_trigger"))),
        ["wiring", _, "parts", name, ..] => {
            let [name, kind, place] = robot.parts.iter().find(|[own, ..]| own == name)?;
            Some(format!("--parts {name}={kind}:{place}"))
        }
        ["wiring", _, kind, name, key @ ..] => {
            let begins = NAMED.iter().filter(|(_, table)| table == kind);
            let mut begins = begins.map(|(begin, _)| begin);
            let sensor =
                |begin: &str| Some(format!("{begin}{name}")).filter(|own| pin(own).is_some());
            let sensor = begins.clone().find_map(|begin| sensor(begin))?;
            match key {
                ["x_m" | "y_m" | "angle_deg"] => place(&sensor),
                [said] => begins.find_map(|begin| pin(&format!("{begin}{said}"))),
                _ => None,
            }
            .or_else(|| pin(&sensor))
        }
        ["wiring", _, signal] => pin(signal),
        ["wiring", _] => Some("--pins".to_owned()),
        _ => None,
    }
}
