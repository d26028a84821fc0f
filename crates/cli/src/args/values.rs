//! Values of options that need checks: numbers within bounds, pairs.

use crate::failure::Failure;
use crate::manifest::LONGEST_S;
use rumbo_experiment::files::new_robot::{ASKED, BATTERY, JUMPERS, NAMED, find, is_of_sonar};
use rumbo_experiment::files::{TimedText, TypedPort, check_line, parameters, placed, pressed};
use rumbo_sim::boards::{BOARDS, Board};
use rumbo_sim::drivers::{DRIVERS, Driver};
use rumbo_sim::wiring::SIGNALS;
use rumbo_wire::LineEnding;

/// A board by its name.
pub(super) fn board(text: &str) -> Result<&'static Board, String> {
    let known = || BOARDS.map(|board| board.name).join(", ");
    Board::named(text).ok_or_else(|| format!("no such board; there are {}", known()))
}

/// The drivers that a new robot may have, by name, and whether jumpers hold the enables.
pub(crate) fn drivers() -> impl Iterator<Item = (String, &'static Driver, bool)> {
    DRIVERS.into_iter().flat_map(|driver| {
        let jumpers = driver.has_enable && driver.source.is_none();
        let jumpers = jumpers.then(|| (format!("{}{JUMPERS}", driver.name), driver, true));
        std::iter::once((driver.name.to_owned(), driver, false)).chain(jumpers)
    })
}

/// Their names, for people.
pub(crate) fn driver_names() -> String {
    let names: Vec<String> = drivers().map(|(name, ..)| name).collect();
    names.join(", ")
}

/// A driver by its name, and whether jumpers hold its enables.
pub(crate) fn driver_named(text: &str) -> Result<(&'static Driver, bool), String> {
    let (name, jumpers) = match text.strip_suffix(JUMPERS) {
        Some(name) => (name, true),
        None => (text, false),
    };
    Driver::named(name)
        .filter(|driver| driver.has_enable || !jumpers)
        .map(|driver| (driver, jumpers))
        .ok_or_else(|| format!("no such driver; there are {}", driver_names()))
}

/// A signal and its pin: `left_forward=7`.
pub(crate) fn pin(text: &str) -> Result<(String, String), String> {
    let (signal, pin) = text
        .split_once('=')
        .ok_or("write it as left_forward=7,left_backward=8")?;
    let (signal, pin) = (signal.trim(), pin.trim());
    // The servos of a robot look away from each other: a long pulse drives the right wheel backward.
    let signal = match signal {
        "left_servo" => "left_forward",
        "right_servo" => "right_backward",
        other => other,
    };
    let is_named = NAMED.iter().any(|(begin, _)| signal.starts_with(begin));
    let asked = find(signal).filter(|asked| !asked.is_option());
    let is_pin = SIGNALS.contains(&signal) || signal == BATTERY || is_named || is_of_sonar(signal);
    match asked {
        Some(asked) => asked
            .check(pin)
            .map_err(|why| format!("{signal} = {pin}: {why}"))?,
        None if is_pin => {}
        None => {
            let said = ASKED.iter().filter(|asked| !asked.is_option());
            let said: Vec<&str> = said.map(|asked| asked.key).collect();
            return Err(format!(
                "no signal `{signal}`; there are {}, {}, and with a name of yours {}, NAME_trigger and \
                 NAME_echo of a sonar",
                SIGNALS.join(", "),
                said.join(", "),
                NAMED.map(|(begin, _)| format!("{begin}NAME")).join(", ")
            ));
        }
    }
    Ok((signal.to_owned(), pin.to_owned()))
}

/// The voltage of a battery at rest, as the plant can have it.
pub(super) fn at_rest(text: &str) -> Result<f64, &'static str> {
    let volts = text
        .parse()
        .ok()
        .filter(|volts| (5.0..=13.0).contains(volts));
    volts.ok_or("must be 5 to 13 V, e.g. 7.62")
}

/// How long a run lasts.
pub(super) fn duration(text: &str) -> Result<f64, &'static str> {
    let seconds = text.parse().ok();
    let seconds = seconds.filter(|seconds| (0.1..=3600.0).contains(seconds));
    seconds.ok_or("must be 0.1 to 3600 s")
}

/// Where a sensor sits and looks: `left=0.05:0.07:90`, ahead without a direction.
pub(crate) fn sensor(text: &str) -> Result<(String, [f64; 3]), &'static str> {
    let read = text.split_once('=').and_then(|(name, place)| {
        let numbers = place.split(':').map(|number| number.trim().parse().ok());
        let numbers: Option<Vec<f64>> = numbers.collect();
        let place = match numbers?[..] {
            [x_m, y_m] => [x_m, y_m, 0.0],
            [x_m, y_m, angle_deg] => [x_m, y_m, angle_deg],
            _ => return None,
        };
        Some((name.trim().to_owned(), place))
    });
    read.ok_or(
        "write it as left=0.05:0.07:90 or line_rear=-0.05:0, x and y in m and the direction in degrees; of a sonar by its name, and \
         of line_NAME, obstacle_NAME, sharp_NAME, light_NAME, maxsonar_NAME",
    )
}

/// A part of a robot with its kind and its place, and what else it says of itself: `start=button:8:5v`.
pub(super) fn part(text: &str) -> Result<[String; 3], String> {
    let split = text.split_once('=').and_then(|(name, rest)| {
        let (kind, place) = rest.split_once(':')?;
        Some([name, kind, place].map(|each| each.trim().to_owned()))
    });
    split
        .filter(|words| words.iter().all(|word| !word.is_empty()))
        .ok_or_else(|| "write it as start=button:8,go=button:9:5v,screen=ssd1306:0x3c".to_owned())
}

/// Seconds of simulation or of a log per second.
pub(super) fn speed(text: &str) -> Result<f64, Failure> {
    match text.parse() {
        Ok(speed) if (0.0..=100.0).contains(&speed) => Ok(speed),
        _ => Err(Failure::input(
            "must be a number of times real time, within 0..100, e.g. 4 or 0.5",
        )),
    }
}

/// A line of text and its time: `REF 40@6`.
pub(super) fn timed_text(text: &str) -> Result<TimedText, Failure> {
    let wrong = || Failure::input("write it as TEXT@SECONDS, e.g. 'REF 40@6'");
    let (line, at_s) = text.rsplit_once('@').ok_or_else(wrong)?;
    let at_s: f64 = at_s.trim().parse().map_err(|_| wrong())?;
    if !(0.0..=LONGEST_S).contains(&at_s) {
        return Err(Failure::Input(format!(
            "the time must be within 0..{LONGEST_S} s"
        )));
    }
    check_line(line).map_err(Failure::input)?;
    Ok(TimedText {
        at_s,
        text: line.to_owned(),
        ending: LineEnding::default(),
        port: TypedPort::Link,
    })
}

/// The same for the USB cable.
pub(super) fn usb_text(text: &str) -> Result<TimedText, Failure> {
    let port = TypedPort::Usb;
    timed_text(text).map(|timed| TimedText { port, ..timed })
}

/// A part and when it is pressed, or put to a value: `start@2`, `start@2-3.5`, `speed=0.7@3`, `remote=ok@4`, `remote=up@1-3`.
pub(super) fn press(text: &str) -> Result<Vec<TimedText>, Failure> {
    let wrong = || {
        Failure::input(
            "write it as NAME@SECONDS, or NAME=VALUE@SECONDS with a value from 0 to 1 or a key of a remote control; \
             NAME@FROM-TO holds it",
        )
    };
    let (what, when) = text.rsplit_once('@').ok_or_else(wrong)?;
    let (from, to) = when.split_once('-').unwrap_or((when, when));
    let at = |time: &str| timed_text(&format!("{what}@{time}")).map_err(|_| wrong());
    let TimedText { at_s, text, .. } = at(from)?;
    let for_s = at(to)?.at_s - at_s;
    let for_s = match (for_s > 0.0, from == to) {
        (false, false) => return Err(wrong()),
        (held, _) => held.then_some(for_s),
    };
    let Some((name, value)) = text.split_once('=') else {
        return Ok(pressed(&text, None, at_s, for_s));
    };
    match (name.trim(), value.trim()) {
        ("", _) | (_, "") => Err(wrong()),
        (name, value) => Ok(pressed(name, Some(value), at_s, for_s)),
    }
}

/// How far from the world's origin a hand puts it \[m\].
const FARTHEST_M: f64 = 50.0;

/// Where a hand puts the robot, and when: `0.2,0.1,90@3`.
pub(super) fn put(text: &str) -> Result<TimedText, Failure> {
    let wrong = || {
        Failure::input(
            "write it as X,Y@SECONDS or X,Y,DEG@SECONDS, in m and degrees within -180..180",
        )
    };
    let TimedText { at_s, text, .. } = timed_text(text).map_err(|_| wrong())?;
    let numbers = text.split(',').map(|number| number.trim().parse());
    let numbers: Vec<f64> = numbers.collect::<Result<_, _>>().map_err(|_| wrong())?;
    let is_near = |m: &f64| m.abs() <= FARTHEST_M;
    let (x_m, y_m, deg) = match numbers[..] {
        [x_m, y_m] => (x_m, y_m, 0.0),
        [x_m, y_m, deg] => (x_m, y_m, deg),
        _ => return Err(wrong()),
    };
    match [x_m, y_m].iter().all(is_near) && (-180.0..=180.0).contains(&deg) {
        true => Ok(placed([x_m, y_m, deg], at_s)),
        false => Err(wrong()),
    }
}

/// What ends typed lines.
pub(super) fn line_ending(name: &str) -> Result<LineEnding, String> {
    let known = || LineEnding::ALL.map(LineEnding::name).join(", ");
    LineEnding::named(name).ok_or_else(|| format!("no such line ending; there are {}", known()))
}

/// A tolerance.
pub(super) fn percent(text: &str) -> Result<f64, Failure> {
    match text.parse() {
        Ok(percent) if (0.0..=1000.0).contains(&percent) => Ok(percent),
        _ => Err(Failure::input("must be a number within 0..1000")),
    }
}

/// A parameter and its value: `kv=0.03`, `rig=final`.
pub(super) fn parameter(text: &str) -> Result<(String, f64), Failure> {
    let wrong = || Failure::input("write it as name=value, e.g. battery.open_circuit_v=6.9");
    let (name, value) = text.split_once('=').ok_or_else(wrong)?;
    let name = name.trim();
    let value = parameters::parse(name, value.trim()).map_err(Failure::input)?;
    Ok((name.to_owned(), value))
}
