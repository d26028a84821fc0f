//! A sketch as a program under test: compiled, its pins and its ports at hand. All but `compile` is about the only robot of
//! a [`Batch`].

use crate::batch::Batch;
use crate::guard::{detached, exception};
use crate::setup::library;
use numpy::{PyArray1, PyArray2, ToPyArray};
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rumbo_experiment::batch::{Probe, Pulse, Robot};
use rumbo_experiment::files::unknown;
use rumbo_sim::mega::{Mega, ON_PINS, PARTS, USB};
use rumbo_sim::wiring::Part;
use rumbo_sketch::{BOARDS, Board, SketchError};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Times of edges [s], and which of them rose.
type Edges<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<bool>>);

/// Compiles a sketch for the board of a scenario's robot; gives the image's path and the compiler's warnings.
#[pyfunction]
#[pyo3(signature = (sketch, scenario, *, held, robot, libraries))]
pub(crate) fn compile(
    py: Python<'_>,
    sketch: &str,
    scenario: &str,
    held: Vec<(String, String, String)>,
    robot: Option<&str>,
    libraries: Vec<PathBuf>,
) -> PyResult<(PathBuf, Vec<String>)> {
    let library = library(held)?;
    let robot = match robot {
        Some(robot) => library.robot(robot),
        None => library
            .scenario(scenario)
            .and_then(|own| library.beside(scenario).robot(&own.robot)),
    };
    let board = robot.map_err(|error| exception(&error))?.board;
    let board = Board::named(board.name).unwrap_or(BOARDS[0]);
    let image = detached(py, || rumbo_sketch::image_of(sketch, board, &libraries))?;
    let image = image.map_err(|error| match error {
        SketchError::Rejected(lines) => {
            let lines: Vec<String> = lines.iter().map(ToString::to_string).collect();
            PyValueError::new_err(lines.join("\n"))
        }
        error => PyValueError::new_err(error.to_string()),
    })?;
    let warnings = image.warnings.iter().map(ToString::to_string);
    Ok((image.path, warnings.collect()))
}

/// Records pins and ports from now on; false where no board is emulated.
#[pyfunction]
pub(crate) fn probe(batch: &Batch) -> PyResult<bool> {
    batch.with(0, Robot::probe)
}

/// The number of a pin by what a user calls it.
#[pyfunction]
pub(crate) fn pin(batch: &Batch, name: &str) -> PyResult<u8> {
    let found = of_board(batch, |mega| {
        let firmware = mega.firmware();
        firmware.find(name).ok_or_else(|| {
            let known: Vec<&str> = firmware.found().collect();
            let error = unknown("pin", name, known.iter().copied()).to_string();
            let board = firmware.board();
            let last = board.shown(board.last_pin());
            format!("{error}; the {} has 0 to {last} besides", board.title)
        })
    })?;
    found.map_err(PyValueError::new_err)
}

/// The parts that a person works, with the keys of the remote controls among them.
#[pyfunction]
pub(crate) fn parts(batch: &Batch) -> PyResult<BTreeMap<String, Vec<String>>> {
    of_board(batch, |mega| {
        let worked = mega.firmware().parts().iter();
        let worked = worked.filter(|part| part.kind.is_worked());
        let keys = |part: &Part| part.keys.iter().map(|(key, _)| key.clone()).collect();
        worked.map(|part| (part.name.clone(), keys(part))).collect()
    })
}

/// The true ranges of the sonars besides left, right and front, by their names among what is true.
#[pyfunction]
pub(crate) fn other_ranges(batch: &Batch) -> PyResult<Vec<(String, f64)>> {
    batch.with(0, |robot| robot.other_ranges().collect())
}

/// Whether a pin is high now.
#[pyfunction]
pub(crate) fn is_high(batch: &Batch, pin: u8) -> PyResult<bool> {
    at_pin(batch, pin, |probe, pin| probe.is_high(pin))
}

/// The share of the time since `from_s` for which a pin was high.
#[pyfunction]
pub(crate) fn share_high(batch: &Batch, pin: u8, from_s: f64) -> PyResult<f64> {
    at_pin(batch, pin, |probe, pin| probe.share_high(pin, from_s))
}

/// The edges of a pin since `from_s`.
#[pyfunction]
pub(crate) fn edges<'py>(
    py: Python<'py>,
    batch: &Batch,
    pin: u8,
    from_s: f64,
) -> PyResult<Edges<'py>> {
    let (times, rises): (Vec<f64>, Vec<bool>) =
        at_pin(batch, pin, |probe, pin| probe.edges(pin, from_s).unzip())?;
    Ok((times.to_pyarray(py), rises.to_pyarray(py)))
}

/// The pulses of a pin since `from_s`: a row for each, beginning [s] and width [us].
#[pyfunction]
pub(crate) fn pulses<'py>(
    py: Python<'py>,
    batch: &Batch,
    pin: u8,
    from_s: f64,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let pulses = at_pin(batch, pin, |probe, pin| probe.pulses(pin, from_s))?;
    let rows = pulses
        .iter()
        .map(|Pulse { at_s, width_us }| vec![*at_s, *width_us]);
    let rows: Vec<Vec<f64>> = rows.collect();
    match rows.is_empty() {
        true => Ok(PyArray2::zeros(py, [0, 2], false)),
        false => {
            PyArray2::from_vec2(py, &rows).map_err(|error| PyValueError::new_err(error.to_string()))
        }
    }
}

/// Connects a pin to a voltage [V], or takes that away.
#[pyfunction]
pub(crate) fn apply(batch: &Batch, pin: u8, volts: Option<f64>) -> PyResult<()> {
    let done = batch.with(0, |robot| robot.apply(pin, volts))?;
    done.then_some(()).ok_or_else(|| no_pin(pin))
}

/// Types bytes to a port: `usb`, `link` or `parts`, or a USART by its number.
#[pyfunction]
pub(crate) fn type_in(batch: &Batch, port: &str, bytes: &[u8]) -> PyResult<()> {
    let port = match port {
        // The module sends them, wherever it is.
        "link" => number_of(batch, port).map(|_| ON_PINS)?,
        port => number_of(batch, port)?,
    };
    batch.with(0, |robot| robot.type_in(port, bytes))
}

/// What a port has sent since the start, from this byte on.
#[pyfunction]
pub(crate) fn said<'py>(
    py: Python<'py>,
    batch: &Batch,
    port: &str,
    from: usize,
) -> PyResult<Bound<'py, PyBytes>> {
    let port = number_of(batch, port)?;
    let said = probed(batch, |probe| {
        probe.said(port).get(from..).unwrap_or_default().to_vec()
    })?;
    Ok(PyBytes::new(py, &said))
}

/// How the program ended, if it could not go on.
#[pyfunction]
pub(crate) fn ended(batch: &Batch) -> PyResult<Option<String>> {
    batch.with(0, |robot| robot.ended())
}

/// All pins over time, as a value change dump.
#[pyfunction]
pub(crate) fn vcd<'py>(py: Python<'py>, batch: &Batch) -> PyResult<Bound<'py, PyBytes>> {
    let written = batch.with(0, |robot| {
        let mut bytes = Vec::new();
        let probe = robot.probed()?;
        Some(probe.write_vcd(robot.sim(), &mut bytes).map(|()| bytes))
    })?;
    let written = written.ok_or_else(no_board)?;
    let bytes = written.map_err(|error| PyOSError::new_err(error.to_string()))?;
    Ok(PyBytes::new(py, &bytes))
}

fn no_board() -> PyErr {
    let what = "no board is emulated here: give the robot a sketch= or a firmware=";
    PyValueError::new_err(what)
}

fn no_pin(pin: u8) -> PyErr {
    PyValueError::new_err(format!("pin {pin}: the board has no such pin"))
}

fn of_board<T>(batch: &Batch, look: impl FnOnce(&Mega) -> T) -> PyResult<T> {
    let looked = batch.with(0, |robot| robot.sim().mega().map(look))?;
    looked.ok_or_else(no_board)
}

fn probed<T>(batch: &Batch, look: impl FnOnce(&Probe) -> T) -> PyResult<T> {
    let looked = batch.with(0, |robot| robot.probed().map(look))?;
    looked.ok_or_else(no_board)
}

fn at_pin<T>(
    batch: &Batch,
    number: u8,
    look: impl FnOnce(&Probe, rumbo_emulator::devices::ports::Pin) -> T,
) -> PyResult<T> {
    let pin = of_board(batch, |mega| mega.firmware().board().pin(number))?;
    let pin = pin.ok_or_else(|| no_pin(number))?;
    probed(batch, |probe| look(probe, pin))
}

/// The port of a name; `link` is that of the Bluetooth module, wherever the wiring has it.
fn number_of(batch: &Batch, port: &str) -> PyResult<u8> {
    match port {
        "usb" => Ok(USB),
        "parts" => Ok(PARTS),
        "link" => of_board(batch, |mega| mega.firmware().link_usart())?.ok_or_else(|| {
            let what = "this wiring has no Bluetooth module; name link_rx and link_tx in it";
            PyValueError::new_err(what)
        }),
        number => number
            .parse()
            .ok()
            .filter(|number| *number < ON_PINS)
            .ok_or_else(|| PyValueError::new_err(format!("no such port: {number}; 0 to 3"))),
    }
}
