//! Arithmetic.

use crate::value::Number;

/// Without its fraction.
pub(super) fn whole(number: Number) -> i64 {
    match number {
        Number::Integer(value) => value,
        Number::Real(value) => value as i64,
    }
}

/// With one.
pub(super) fn real(number: Number) -> f64 {
    match number {
        Number::Integer(value) => value as f64,
        Number::Real(value) => value,
    }
}

/// What an operator between two numbers gives.
pub(super) fn calculate(left: Number, sign: &str, right: Number) -> Result<Number, String> {
    let truth = |holds: bool| Ok(Number::Integer(holds.into()));
    let (a, b) = (real(left), real(right));
    match sign {
        "||" => return truth(a != 0.0 || b != 0.0),
        "&&" => return truth(a != 0.0 && b != 0.0),
        _ => {}
    }
    if let (Number::Integer(a), Number::Integer(b)) = (left, right) {
        let by_zero = "a division by zero";
        return Ok(Number::Integer(match sign {
            "|" => a | b,
            "^" => a ^ b,
            "&" => a & b,
            "<<" => a.wrapping_shl(b as u32),
            ">>" => a.wrapping_shr(b as u32),
            "+" => a.wrapping_add(b),
            "-" => a.wrapping_sub(b),
            "*" => a.wrapping_mul(b),
            "/" => a.checked_div(b).ok_or(by_zero)?,
            "%" => a.checked_rem(b).ok_or(by_zero)?,
            "==" => (a == b).into(),
            "!=" => (a != b).into(),
            "<" => (a < b).into(),
            ">" => (a > b).into(),
            "<=" => (a <= b).into(),
            _ => (a >= b).into(),
        }));
    }
    match sign {
        "+" => Ok(Number::Real(a + b)),
        "-" => Ok(Number::Real(a - b)),
        "*" => Ok(Number::Real(a * b)),
        "/" => Ok(Number::Real(a / b)),
        "==" => truth(a == b),
        "!=" => truth(a != b),
        "<" => truth(a < b),
        ">" => truth(a > b),
        "<=" => truth(a <= b),
        ">=" => truth(a >= b),
        _ => Err(format!("`{sign}` is for whole numbers")),
    }
}
