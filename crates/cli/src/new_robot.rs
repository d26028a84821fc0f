//! `rumbo new robot`: a robot file from a board, a driver and pins, asked for at a terminal.

use crate::args::{Answers, NewArgs, driver_named, driver_names};
use crate::by_option::said_of_options;
use crate::failure::Failure;
use crate::output;
use crate::place;
use rumbo_experiment::files::new_robot::{
    ASKED, Asked, JUMPERS, Measured, NAMED, NewRobot, counted, has_place, looks_like, meaning,
    needed, remarks,
};
use rumbo_experiment::files::{Kind, Library};
use rumbo_sim::boards::{BOARDS, Board};
use rumbo_sim::drivers::{DRIVERS, Direction, Driver};
use std::collections::HashSet;
use std::io::{IsTerminal, Write};
use std::path::Path;

/// Signals that are asked for after those of the motors.
const MORE: [&str; 10] = [
    "standby",
    "left_encoder",
    "left_encoder_b",
    "right_encoder",
    "right_encoder_b",
    "servo",
    "front_trigger",
    "front_echo",
    "link_rx",
    "link_tx",
];

/// Writes the file, and says what it looks like and what to do next.
pub(crate) fn begin(args: &NewArgs) -> Result<(), Failure> {
    let path = match args.folder.extension() {
        Some(_) => args.folder.clone(),
        None => args.folder.with_extension("toml"),
    };
    let stem = path
        .file_stem()
        .map(|stem| stem.to_string_lossy().into_owned());
    let name = stem.filter(|name| !name.is_empty()).ok_or_else(|| {
        Failure::Input(format!(
            "{}: give the robot's name, e.g. my_car",
            args.folder.display()
        ))
    })?;
    let library = Library::new();
    let text = match &args.like {
        Some(like) => library.text(Kind::Robot, like)?,
        None => {
            let made = made_of(args, name)?;
            let checked = made.checked();
            let (text, robot) = checked.map_err(|error| said_of_options(&made, error))?;
            let Some(wiring) = robot.wirings.values().next() else {
                return Err(Failure::input("a robot needs pins"));
            };
            for remark in remarks(wiring) {
                output::note(&remark);
            }
            if let Some(counted) = counted(&robot) {
                output::line(&counted)?;
            }
            if !args.pins.is_empty() {
                output::line(&assumed(&made, &args.answers))?;
            }
            match looks_like(&library, wiring)? {
                Some(alike) => {
                    let others = alike
                        .others
                        .iter()
                        .map(|(signal, pin)| format!("{signal} is {pin} there"));
                    let others: Vec<String> = others.collect();
                    let others = if others.is_empty() {
                        String::new()
                    } else {
                        format!("; {}", others.join(", "))
                    };
                    output::line(&format!(
                        "its pins are those of the robot {}: {} of {}{others}",
                        alike.robot, alike.same, alike.of
                    ))?;
                }
                None => output::line("its pins are those of no robot that is known")?,
            }
            text
        }
    };
    write(&path, &text)?;
    let (shown, quoted) = (output::shown(&path), output::quoted(&path));
    output::line(&format!(
        "{shown}: measure and change it, then `rumbo run free --robot {quoted} --sketch FOLDER`"
    ))
}

/// What is taken as nobody has said it.
fn assumed(robot: &NewRobot, answers: &Answers) -> String {
    let said = |key: &str| answers.0.iter().any(|(asked, _)| asked.key == key);
    let asked = robot.asked().into_iter();
    let unsaid = asked.filter(|(asked, _)| asked.is_option() && !said(asked.key));
    let taken = unsaid.map(|(Asked { key, .. }, usual)| format!("--{key} {usual}"));
    format!(
        "what no option says is as with {}",
        taken.collect::<Vec<_>>().join(" ")
    )
}

/// An existing file may be somebody's work.
fn write(path: &Path, text: &str) -> Result<(), Failure> {
    if let Some(parent) = path.parent() {
        place::folder(parent)?;
    }
    let file = std::fs::File::create_new(path).map_err(|error| match error.kind() {
        std::io::ErrorKind::AlreadyExists => Failure::Input(format!(
            "{}: is there already; choose another name",
            path.display()
        )),
        _ => place::unwritable(path, &error),
    });
    file?.write_all(text.as_bytes()).map_err(|error| {
        // Half a file would be in the way of the next attempt.
        let _ = std::fs::remove_file(path);
        place::unwritable(path, &error)
    })
}

/// Refuses a signal with two pins.
fn each_once(pins: &[(String, String)]) -> Result<(), Failure> {
    let mut known = HashSet::new();
    match pins.iter().find(|(signal, _)| !known.insert(signal)) {
        None => Ok(()),
        Some((signal, _)) => Err(Failure::Input(format!(
            "--pins: {signal} is given twice; give each signal once"
        ))),
    }
}

/// What the robot is made of: by the options, else asked for.
fn made_of(args: &NewArgs, name: String) -> Result<NewRobot, Failure> {
    each_once(&args.pins)?;
    let asks = std::io::stdin().is_terminal() && std::io::stdout().is_terminal();
    let missing = [
        args.board.is_none().then_some("--board"),
        args.driver.is_none().then_some("--driver"),
        args.pins.is_empty().then_some("--pins"),
    ];
    let missing: Vec<&str> = missing.into_iter().flatten().collect();
    if !missing.is_empty() && !asks {
        let (driver, jumpers) = args.driver.unwrap_or((DRIVERS[0], false));
        return Err(Failure::Input(format!(
            "missing: {}; a robot with a {}{} needs the pins {}, as in --pins left_forward=7,... (boards: {}; drivers: {}), or \
             give --like with one of {}",
            missing.join(", "),
            driver.name,
            if jumpers { JUMPERS } else { "" },
            needed(driver, jumpers).join(", "),
            BOARDS.map(|board| board.name).join(", "),
            driver_names(),
            Library::new().list(Kind::Robot).join(", ")
        )));
    }
    let board = match args.board {
        Some(board) => board,
        None => ask_until("board (mega, uno, nano)", |text| {
            Board::named(text).ok_or_else(|| "no such board".into())
        })?,
    };
    let (driver, jumpers) = match args.driver {
        Some(driver) => driver,
        None => ask_until(&format!("driver ({})", driver_names()), driver_named)?,
    };
    let mut pins = args.pins.clone();
    if pins.is_empty() {
        output::line(match driver.shield {
            Some(_) => "motors as M1, pins by number or as A0; nothing where there is none",
            None => "pins, by number or as A0; nothing where there is none",
        })?;
        output::line(
            "sensors for lines, obstacles and light, buttons, a remote control: options, `rumbo new --help`",
        )?;
        let motors = needed(driver, jumpers);
        for signal in motors.iter().map(String::as_str).chain(MORE) {
            if signal == "standby" && !driver.has_standby {
                continue;
            }
            let pin = ask_until(&asked(signal, driver), |text| {
                let motor = driver.shield.and_then(|shield| shield.motor(text));
                match text.is_empty() || motor.is_some() || board.numbered(text).is_some() {
                    true => Ok(text.to_owned()),
                    false => Err(format!("no pin of the {}", board.title)),
                }
            })?;
            if !pin.is_empty() {
                pins.push((signal.to_owned(), pin));
            }
        }
    }
    let mut robot = NewRobot {
        name,
        board,
        driver,
        jumpers,
        sensors: sensors(args, &pins)?,
        pins,
        measured: Measured::default(),
        parts: args.parts.clone(),
    };
    for (asked, text) in &args.answers.0 {
        if *asked.key == *"motor" && driver.direction == Direction::Pulse {
            return Err(Failure::Input(format!(
                "--motor {text}: {} are motors themselves; leave it out",
                driver.title
            )));
        }
        robot.say(asked, text).map_err(Failure::Input)?;
    }
    if args.pins.is_empty() {
        ask_more(&mut robot, &args.answers)?;
    }
    Ok(robot)
}

/// Asks what matters for such a robot and no option has said; an empty answer is the usual one.
fn ask_more(robot: &mut NewRobot, answers: &Answers) -> Result<(), Failure> {
    output::line("what you know of it; nothing where the usual in brackets will do")?;
    for Asked { key, .. } in ASKED.iter() {
        let known = answers.0.iter().any(|(asked, _)| asked.key == *key);
        // What was answered before may change what is usual.
        let Some((asked, usual)) = robot
            .asked()
            .into_iter()
            .find(|(asked, _)| asked.key == *key)
        else {
            continue;
        };
        if known {
            continue;
        }
        let choices = asked.choices().iter();
        let choices = choices.map(|(name, title)| format!("{name} is {title}"));
        let question = match asked.range() {
            Some((.., "count" | "1")) => asked.about.to_owned(),
            Some((.., unit)) => format!("{}, in {unit}", asked.about),
            None => format!(
                "{}: {}",
                asked.label,
                choices.collect::<Vec<_>>().join(", ")
            ),
        };
        let question = format!("{question} [{usual}]");
        let said = ask_until(&question, |text| match text {
            "" => Ok(None),
            text => asked.check(text).map(|()| Some(text.to_owned())),
        })?;
        if let Some(text) = said {
            robot.say(asked, &text).map_err(Failure::Input)?;
        }
    }
    Ok(())
}

/// What a pin is asked for by: its signal, and what that is.
fn asked(signal: &str, driver: &Driver) -> String {
    match (signal, meaning(signal, driver)) {
        ("link_rx", what) => format!("{signal}, {what}: 0 where the sketch reads Serial"),
        (_, what) if what == signal => what,
        (_, what) => format!("{signal}, {what}"),
    }
}

/// Where sensors are, each of which has pins or is a part.
fn sensors(args: &NewArgs, pins: &[(String, String)]) -> Result<Vec<(String, [f64; 3])>, Failure> {
    let trigger = |sensor: &str| format!("{sensor}_trigger");
    let is_wired = |sensor: &str| {
        let mut parts = args.parts.iter();
        pins.iter()
            .any(|(signal, _)| signal == sensor || *signal == trigger(sensor))
            || parts.any(|[name, kind, _]| name == sensor && has_place(kind))
    };
    match args.sensors.iter().find(|(sensor, _)| !is_wired(sensor)) {
        None => Ok(args.sensors.clone()),
        Some((sensor, _)) => {
            let mut others = NAMED.iter();
            let pins = match others.any(|(begin, _)| sensor.starts_with(begin)) {
                true => format!("{sensor}=4"),
                false => format!("{sensor}_trigger=4,{sensor}_echo=A0"),
            };
            Err(Failure::Input(format!(
                "--sensors {sensor}: that sensor has no pins; say --pins {pins} or the like"
            )))
        }
    }
}

/// Asks until the answer is one.
fn ask_until<T>(question: &str, read: impl Fn(&str) -> Result<T, String>) -> Result<T, Failure> {
    loop {
        print!("{question}: ");
        let mut line = String::new();
        std::io::stdout().flush().map_err(Failure::input)?;
        let read_bytes = std::io::stdin()
            .read_line(&mut line)
            .map_err(Failure::input)?;
        if read_bytes == 0 {
            return Err(Failure::input("the answers ended early"));
        }
        match read(line.trim()) {
            Ok(answer) => return Ok(answer),
            Err(why) => output::note(&why),
        }
    }
}

/// Prints a built-in file.
pub(crate) fn print(kind: Kind, name: &str) -> Result<(), Failure> {
    let text = Library::new().text(kind, name)?;
    output::lines(text.trim_end())
}
