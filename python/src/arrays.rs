//! Arrays of Python's, checked: their shapes, and the numbers of actions.

use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rumbo_control::mode::MAX_WHEEL_RAD_S;
use std::f32::consts::FRAC_PI_2;

/// An action: wheel speeds, left and right [rad/s], and where the servo points [rad].
const ACTION: usize = 3;

/// An action for each of so many robots, and whether it is given to it.
pub(crate) fn checked<'a>(
    actions: &'a PyReadonlyArray2<'_, f32>,
    active: &'a PyReadonlyArray1<'_, bool>,
    count: usize,
    most: (&str, f32, &str),
) -> PyResult<(&'a [[f32; ACTION]], &'a [bool])> {
    has_rows("actions", actions.shape(), count, ACTION)?;
    if !actions.is_c_contiguous() || active.len() != count {
        return Err(PyValueError::new_err(
            "actions must be C-contiguous, and active must have a value for each robot",
        ));
    }
    let actions = actions.as_slice()?.as_chunks().0;
    check_actions(actions, most)?;
    Ok((actions, active.as_slice()?))
}

/// The array's numbers, row by row, if it has this shape.
pub(crate) fn rows<'a, T: numpy::Element>(
    name: &str,
    array: &'a mut PyReadwriteArray2<'_, T>,
    rows: usize,
    columns: usize,
) -> PyResult<&'a mut [T]> {
    has_rows(name, array.shape(), rows, columns)?;
    // A slice of an array in Fortran's order would be transposed.
    if !array.is_c_contiguous() {
        return Err(PyValueError::new_err(format!(
            "{name} must be C-contiguous"
        )));
    }
    Ok(array.as_slice_mut()?)
}

pub(crate) fn has_rows(name: &str, shape: &[usize], rows: usize, columns: usize) -> PyResult<()> {
    if shape == [rows, columns] {
        return Ok(());
    }
    Err(PyValueError::new_err(format!(
        "{name} has the shape {shape:?}: must be [{rows}, {columns}]"
    )))
}

/// What wheels are given: what it is, the most of it either way, and its unit.
pub(crate) const MOST_SPEED: (&str, f32, &str) = ("wheel speed", MAX_WHEEL_RAD_S, "rad/s");
pub(crate) const MOST_DUTY: (&str, f32, &str) =
    ("wheel's share of the PWM", 1.0, "of the full one");

/// Every number is one that the robot takes.
pub(crate) fn check_actions(
    actions: &[[f32; ACTION]],
    of_wheel: (&str, f32, &str),
) -> PyResult<()> {
    let limits = [of_wheel, of_wheel, ("servo angle", FRAC_PI_2, "rad")];
    let sides = ["left ", "right ", ""];
    for (index, action) in actions.iter().enumerate() {
        let columns = action.iter().zip(limits).zip(sides);
        for (column, ((value, (what, most, unit)), side)) in columns.enumerate() {
            if value.is_nan() || value.abs() > most {
                return Err(PyValueError::new_err(format!(
                    "action[{index}, {column}] = {value}: {side}{what} must be within {most:.4} {unit} of zero"
                )));
            }
        }
    }
    Ok(())
}
