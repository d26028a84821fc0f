//! What the columns of another program's table are: names as `left_rpm`, their unit last, and which column each is.
//!
//! `left_rpm=Speed L`, `left_turn=count_l/748`, `t_ms=#2`: the number after `*` or `/` scales the column, and `#2` is
//! the second one.

use super::guess;
use crate::column_names::{NAMES, Role, Unit, names};
use rumbo_ros::recorded::Series;

/// A column with what it is taken as.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Taken {
    /// As it is written: `left_rpm`.
    pub(crate) name: String,
    pub(crate) role: Role,
    /// Which column; `None`: the factor itself is the value of each row.
    pub(crate) column: Option<usize>,
    /// To our unit.
    pub(crate) factor: f64,
}

/// Reads what was asked for; `auto` stands for what is guessed and is certain.
///
/// # Errors
/// A name, a column or a unit that is none, and what there is instead.
pub(crate) fn taken(
    asked: &[String],
    series: &[Series],
    timed: bool,
) -> Result<Vec<Taken>, String> {
    let mut taken: Vec<Taken> = Vec::new();
    let mut add = |one: Taken| {
        let signals = |taken: &Taken| match taken.role {
            Role::Signals(names) | Role::Turned(names) => names,
            _ => &[],
        };
        let is_same = |other: &Taken| {
            other.name == one.name
                || signals(other)
                    .iter()
                    .any(|name| signals(&one).contains(name))
        };
        match taken.iter().find(|other| is_same(other)) {
            Some(other) if other.column != one.column => Err(format!(
                "{} and {} are the same signal; take one of them",
                other.name, one.name
            )),
            Some(_) => Ok(()),
            None => {
                taken.push(one);
                Ok(())
            }
        }
    };
    let (automatic, explicit): (Vec<_>, Vec<_>) = asked.iter().partition(|one| *one == "auto");
    for one in &explicit {
        add(parse(one, series)?)?;
    }
    if !automatic.is_empty() {
        for guessed in guess::guess(series, timed) {
            if guessed.is_sure {
                // What was said comes first.
                let _ = add(parse(&guessed.text(series), series)?);
            }
        }
    }
    let is_time = |one: &Taken| matches!(one.role, Role::Time | Role::Period);
    match (timed, taken.iter().filter(|one| is_time(one)).count()) {
        (true, 0) | (false, 1) => Ok(taken),
        (true, _) => Err("the messages have their times; leave t and dt out".into()),
        (false, 0) => Err(
            "which column has the times? give t_s=, t_ms= or t_us=COLUMN, dt_ms=COLUMN for the time since the row \
             before, or dt_ms=20 for rows 20 ms apart"
                .into(),
        ),
        (false, _) => Err("there is more than one time; give one of t and dt".into()),
    }
}

fn parse(text: &str, series: &[Series]) -> Result<Taken, String> {
    let (name, column) = text
        .split_once('=')
        .map(|(name, column)| (name.trim(), column.trim()))
        .ok_or_else(|| format!("`{text}`: must be NAME=COLUMN, as t_ms=millis"))?;
    let named = NAMES.iter().find_map(|(stem, role, units)| {
        let unit = name.strip_prefix(stem)?.strip_prefix('_')?;
        let (_, factor) = units.iter().find(|(known, _)| *known == unit)?;
        Some((*role, *factor))
    });
    let is_period = named.is_some_and(|(role, _)| role == Role::Period);
    let (column, scale) = match column.parse::<f64>() {
        Ok(period) if is_period && find(column, series).is_none() && period > 0.0 => (None, period),
        _ => {
            let (column, scale) = scaled(column, series)?;
            (Some(column), scale)
        }
    };
    let with_unit = |role, unit: Unit, name: String| Taken {
        name,
        role,
        column,
        factor: unit.1 * scale,
    };
    if let Some((role, factor)) = named {
        return Ok(with_unit(role, ("", factor), name.to_owned()));
    }
    let of_stem: Vec<_> = NAMES.iter().filter(|(stem, ..)| *stem == name).collect();
    let given = column.and_then(|column| series.get(column));
    for (stem, role, units) in &of_stem {
        if let Some(unit) = given.and_then(|column| guess::unit(column, units)) {
            return Ok(with_unit(*role, unit, format!("{stem}_{}", unit.0)));
        }
    }
    match of_stem.is_empty() {
        true => Err(format!(
            "`{name}` is no name of a signal; there are {}",
            names()
        )),
        false => {
            let units = of_stem.iter().flat_map(|(_, _, units)| units.iter());
            let units: Vec<String> = units.map(|(unit, _)| format!("{name}_{unit}")).collect();
            Err(format!(
                "in which unit is `{text}`? name it: {}",
                units.join(", ")
            ))
        }
    }
}

/// A column and the numbers that scale it.
fn scaled(text: &str, series: &[Series]) -> Result<(usize, f64), String> {
    let (mut column, mut factor) = (text.trim(), 1.0);
    loop {
        if let Some(index) = find(column, series) {
            return Ok((index, factor));
        }
        let cut = column.rfind(['*', '/']).filter(|at| *at > 0);
        let Some((rest, by)) = cut.and_then(|at| column.split_at_checked(at)) else {
            break;
        };
        let (sign, number) = by.split_at(1);
        let value = number.trim().parse::<f64>().ok();
        let Some(value) = value.filter(|value| value.is_finite() && *value != 0.0) else {
            if find(rest.trim(), series).is_some() {
                return Err(format!(
                    "`{text}`: {number} stands for a number; write it there"
                ));
            }
            break;
        };
        factor = if sign == "*" {
            factor * value
        } else {
            factor / value
        };
        column = rest.trim();
    }
    let known: Vec<&str> = series
        .iter()
        .map(|column| column.name.as_str())
        .take(12)
        .collect();
    let more = match series.len().saturating_sub(known.len()) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    Err(format!(
        "there is no column `{text}`; there are {}{more}",
        known.join(", ")
    ))
}

fn find(name: &str, series: &[Series]) -> Option<usize> {
    let number = |name: &str| {
        let number: usize = name.strip_prefix('#')?.parse().ok()?;
        number.checked_sub(1).filter(|index| *index < series.len())
    };
    let by_name = |same: &dyn Fn(&str) -> bool| series.iter().position(|column| same(&column.name));
    by_name(&|column| column == name)
        .or_else(|| by_name(&|column| column.eq_ignore_ascii_case(name)))
        .or_else(|| number(name))
}
