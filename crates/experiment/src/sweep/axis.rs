//! A parameter that varies: `front_kp=1:20:10`, `battery.open_circuit_v=6.8,7.4,8.2`, `waypoint_tracker=straight,pure_pursuit`.

use crate::files::parameters;
use rumbo_control::params::ParamId;
use thiserror::Error;

/// Most values of an axis.
const MOST_VALUES: usize = 10_000;

/// A parameter and the values it takes.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Name of a parameter of the control core or the plant.
    pub name: String,
    /// Its values.
    pub values: Values,
}

/// The values of an axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// These, in this order.
    List(Vec<f64>),
    /// From one to another.
    Range {
        /// The lowest.
        from: f64,
        /// The highest.
        to: f64,
        /// How many of a grid, the ends included; none where points are drawn.
        count: Option<usize>,
        /// Even steps of the logarithm.
        log: bool,
    },
}

/// An axis that makes no sense, with its text.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{text}`: {problem}")]
pub struct AxisError {
    text: String,
    problem: Problem,
}

#[derive(Clone, Debug, PartialEq, Eq, Error)]
enum Problem {
    #[error(
        "write it as NAME=FROM:TO:COUNT, as NAME=FROM:TO:COUNT:log or as NAME=VALUE,VALUE, e.g. front_kp=1:20:10"
    )]
    Form,
    #[error("{0}")]
    Value(String),
    #[error("a range goes from a lower to a higher value")]
    Order,
    #[error("the count must be a whole number within 2..{MOST_VALUES}")]
    Count,
    #[error("a range in even steps of the logarithm begins above 0")]
    Logarithm,
    #[error("{0} stands there twice")]
    Twice(String),
    #[error("an axis has at most {MOST_VALUES} values")]
    TooMany,
}

impl std::str::FromStr for Axis {
    type Err = AxisError;

    fn from_str(text: &str) -> Result<Self, AxisError> {
        let wrong = |problem| AxisError {
            text: text.to_owned(),
            problem,
        };
        let (name, values) = text.split_once('=').ok_or_else(|| wrong(Problem::Form))?;
        let (name, values) = (name.trim(), values.trim());
        if name.is_empty() || values.is_empty() {
            return Err(wrong(Problem::Form));
        }
        let parse = |value: &str| {
            parameters::parse(name, value.trim())
                .map_err(|error| wrong(Problem::Value(error.to_string())))
        };
        let values = match values.contains(':') {
            true => range(values, &parse).and_then(|range| range.map_err(wrong))?,
            false => list(values, &parse).and_then(|list| list.map_err(wrong))?,
        };
        Ok(Self {
            name: name.to_owned(),
            values,
        })
    }
}

type Parse<'a> = &'a dyn Fn(&str) -> Result<f64, AxisError>;

fn range(text: &str, parse: Parse<'_>) -> Result<Result<Values, Problem>, AxisError> {
    let parts: Vec<&str> = text.split(':').map(str::trim).collect();
    let (ends, count, log) = match parts[..] {
        [from, to] => ([from, to], None, false),
        [from, to, "log"] => ([from, to], None, true),
        [from, to, count] => ([from, to], Some(count), false),
        [from, to, count, "log"] => ([from, to], Some(count), true),
        _ => return Ok(Err(Problem::Form)),
    };
    let [from, to] = [parse(ends[0])?, parse(ends[1])?];
    let count = match count.map(str::parse::<usize>) {
        None => None,
        Some(Ok(count)) if (2..=MOST_VALUES).contains(&count) => Some(count),
        Some(_) => return Ok(Err(Problem::Count)),
    };
    if from >= to {
        return Ok(Err(Problem::Order));
    }
    if log && from <= 0.0 {
        return Ok(Err(Problem::Logarithm));
    }
    Ok(Ok(Values::Range {
        from,
        to,
        count,
        log,
    }))
}

fn list(text: &str, parse: Parse<'_>) -> Result<Result<Values, Problem>, AxisError> {
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    if parts.len() > MOST_VALUES {
        return Ok(Err(Problem::TooMany));
    }
    let mut values = Vec::new();
    for part in parts {
        let value = parse(part)?;
        if values.contains(&value) {
            return Ok(Err(Problem::Twice(part.to_owned())));
        }
        values.push(value);
    }
    Ok(Ok(Values::List(values)))
}

impl Axis {
    /// Its values in a grid; `None` for a range without a count.
    #[must_use]
    pub fn grid(&self) -> Option<Vec<f64>> {
        match &self.values {
            Values::List(values) => Some(values.clone()),
            Values::Range { count: None, .. } => None,
            Values::Range {
                count: Some(count), ..
            } => {
                let share = |index: usize| index as f64 / (count - 1) as f64;
                Some((0..*count).map(|index| self.at(share(index))).collect())
            }
        }
    }

    /// The value at a share of the way from the lowest to the highest, 0 to 1; of a list, the element there.
    #[must_use]
    pub fn at(&self, share: f64) -> f64 {
        match &self.values {
            Values::List(values) => {
                let index = (share * values.len() as f64) as usize;
                values[index.min(values.len() - 1)]
            }
            // The ends are what was given, to the last bit.
            Values::Range { to, .. } if share >= 1.0 => *to,
            Values::Range { from, .. } if share <= 0.0 => *from,
            Values::Range {
                from,
                to,
                log: false,
                ..
            } => tidy(from + share * (to - from)),
            Values::Range {
                from,
                to,
                log: true,
                ..
            } => tidy(from * libm::pow(to / from, share)),
        }
    }

    /// The name of a value of a switch or a choice; a number has none.
    #[must_use]
    pub fn name_of(&self, value: f64) -> Option<&'static str> {
        ParamId::from_name(&self.name)?.kind().name_of(value as f32)
    }

    /// Whether its values have even steps of the logarithm.
    #[must_use]
    pub fn is_log(&self) -> bool {
        matches!(self.values, Values::Range { log: true, .. })
    }

    /// The lowest and the highest value.
    #[must_use]
    pub fn span(&self) -> [f64; 2] {
        match &self.values {
            Values::Range { from, to, .. } => [*from, *to],
            Values::List(values) => values
                .iter()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
                    [low.min(*value), high.max(*value)]
                }),
        }
    }
}

/// To nine digits: 0.3, not 0.30000000000000004. More is never a choice.
fn tidy(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(text: &str) -> Vec<f64> {
        text.parse::<Axis>().unwrap().grid().unwrap()
    }

    #[test]
    fn ranges_lists_and_names_become_values() {
        assert_eq!(grid("front_kp=1:2:5"), [1.0, 1.25, 1.5, 1.75, 2.0]);
        assert_eq!(grid("front_kp = 0.1:0.7:4"), [0.1, 0.3, 0.5, 0.7]);
        assert_eq!(grid("front_kp=0.1:10:3:log"), [0.1, 1.0, 10.0]);
        assert_eq!(grid("battery.open_circuit_v=6.8, 8.2,7.4"), [6.8, 8.2, 7.4]);
        let named = grid("waypoint_tracker=straight,pure_pursuit");
        assert_eq!(named.len(), 2);
        assert_ne!(named[0], named[1]);
    }

    #[test]
    fn an_axis_without_sense_says_what_is_wrong() {
        for (text, why) in [
            ("front_kp", "write it as"),
            ("=1:2:3", "write it as"),
            ("front_kp=1:2:3:4", "write it as"),
            ("front_kp=2:1:3", "from a lower to a higher"),
            ("front_kp=1:1:3", "from a lower to a higher"),
            ("front_kp=1:2:1", "whole number"),
            ("front_kp=1:2:2.5", "whole number"),
            ("front_kp=1:2:99999999", "whole number"),
            ("front_kp=0:2:3:log", "above 0"),
            ("front_kp=1,2,1.0", "twice"),
            ("front_kp=1,,2", "number"),
            ("front_kp=1:nan:3", "finite"),
        ] {
            let said = text.parse::<Axis>().unwrap_err().to_string();
            assert!(said.contains(why), "{said}");
        }
    }
}
