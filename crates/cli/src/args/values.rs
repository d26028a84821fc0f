//! Values of options that need checks: numbers within bounds, pairs.

use crate::failure::Failure;
use crate::manifest::LONGEST_S;
use rumbo_experiment::files::new_robot::{ACCESSORIES, JUMPERS, LINK_BAUD, accessory};
use rumbo_experiment::files::{Port, TimedText, check_line, parameters, pressed};
use rumbo_sim::boards::{BOARDS, Board};
use rumbo_sim::drivers::{DRIVERS, Driver};
use rumbo_sim::wiring::SIGNALS;
use rumbo_wire::LineEnding;

/// A board by its name.
pub(super) fn board(text: &str) -> Result<&'static Board, String> {
    let known = || BOARDS.map(|board| board.name).join(", ");
    Board::named(text).ok_or_else(|| format!("no such board; there are {}", known()))
}

/// The drivers that a new robot may have.
pub(crate) fn driver_names() -> String {
    let names = DRIVERS.iter().flat_map(|driver| {
        let jumpers = driver.has_enable && driver.source.is_none();
        let jumpers = jumpers.then(|| format!("{}{JUMPERS}", driver.name));
        std::iter::once(driver.name.to_owned()).chain(jumpers)
    });
    names.collect::<Vec<_>>().join(", ")
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
pub(super) fn pin(text: &str) -> Result<(String, String), String> {
    let (signal, pin) = text
        .split_once('=')
        .ok_or("write it as left_forward=7,left_backward=8")?;
    let (signal, pin) = (signal.trim(), pin.trim());
    if !SIGNALS.contains(&signal) && accessory(signal).is_none() && signal != LINK_BAUD {
        return Err(format!(
            "no signal `{signal}`; there are {}, {LINK_BAUD}, and with a name of yours {}",
            SIGNALS.join(", "),
            ACCESSORIES
                .map(|(prefix, _)| format!("{prefix}_NAME"))
                .join(", ")
        ));
    }
    Ok((signal.to_owned(), pin.to_owned()))
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
        port: Port::Link,
    })
}

/// The same for the USB cable.
pub(super) fn usb_text(text: &str) -> Result<TimedText, Failure> {
    let port = Port::Usb;
    timed_text(text).map(|timed| TimedText { port, ..timed })
}

/// A part and when it is pressed, or put to a value: `start@2`, `speed=0.7@3`.
pub(super) fn press(text: &str) -> Result<Vec<TimedText>, Failure> {
    let wrong = || {
        Failure::input("write it as NAME@SECONDS, or NAME=VALUE@SECONDS with a value from 0 to 1")
    };
    let TimedText { at_s, text, .. } = timed_text(text).map_err(|_| wrong())?;
    let Some((name, value)) = text.split_once('=') else {
        return Ok(pressed(&text, None, at_s));
    };
    let value = value
        .trim()
        .parse()
        .ok()
        .filter(|value| (0.0..=1.0).contains(value));
    Ok(pressed(name.trim(), Some(value.ok_or_else(wrong)?), at_s))
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
