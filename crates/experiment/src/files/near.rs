//! Suggestions for mistyped names and keys.

use super::error::FileError;

/// A unit's suffix in a key, what it measures, and how many of the dimension's base unit it is.
const UNITS: [(&str, &str, f64); 24] = [
    ("rad_s", "turn rate", 1.0),
    ("deg_s", "turn rate", std::f64::consts::PI / 180.0),
    ("rpm", "turn rate", std::f64::consts::PI / 30.0),
    ("m_s", "speed", 1.0),
    ("cm_s", "speed", 1e-2),
    ("mm_s", "speed", 1e-3),
    ("m", "length", 1.0),
    ("cm", "length", 1e-2),
    ("mm", "length", 1e-3),
    ("s", "time", 1.0),
    ("ms", "time", 1e-3),
    ("us", "time", 1e-6),
    ("min", "time", 60.0),
    ("rad", "angle", 1.0),
    ("deg", "angle", std::f64::consts::PI / 180.0),
    ("v", "voltage", 1.0),
    ("mv", "voltage", 1e-3),
    ("a", "current", 1.0),
    ("ma", "current", 1e-3),
    ("kg", "mass", 1.0),
    ("g", "mass", 1e-3),
    ("hz", "frequency", 1.0),
    ("khz", "frequency", 1e3),
    ("duty", "duty", 1.0),
];

/// A key's stem and its unit: `range_cm` is `range` in `cm`, `range` has none.
fn split_unit(key: &str) -> (&str, Option<&'static (&'static str, &'static str, f64)>) {
    UNITS
        .iter()
        .filter_map(|unit| Some((key.strip_suffix(unit.0)?.strip_suffix('_')?, Some(unit))))
        .min_by_key(|(stem, _)| stem.len())
        .unwrap_or((key, None))
}

/// The known names that resemble `name`, best first, at most three.
pub(crate) fn near<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let mut rated: Vec<(f64, &str)> = known
        .into_iter()
        .map(|candidate| (likeness(name, candidate), candidate))
        .filter(|(likeness, _)| *likeness > 0.5)
        .collect();
    rated.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(b.1)));
    rated.dedup();
    rated.truncate(3);
    rated.into_iter().map(|(_, candidate)| candidate).collect()
}

/// Similarity: 1 for the same name, 0 for nothing in common; a name that contains the other counts as near.
fn likeness(name: &str, candidate: &str) -> f64 {
    let (name, candidate) = (name.to_lowercase(), candidate.to_lowercase());
    let edits = strsim::normalized_damerau_levenshtein(&name, &candidate);
    let contained = name.len() >= 3 && (candidate.contains(&name) || name.contains(&candidate));
    if contained { edits.max(0.6) } else { edits }
}

/// A name that is none of the known ones, with those that are near, or all.
pub fn unknown<'a>(
    kind: &'static str,
    name: &str,
    known: impl IntoIterator<Item = &'a str> + Clone,
) -> FileError {
    FileError::Unknown {
        kind,
        name: name.to_owned(),
        near: near_or_all(name, known),
    }
}

/// The near names, or all where none is near: what [`did_you_mean`] then offers.
pub(crate) fn near_or_all<'a>(
    name: &str,
    known: impl IntoIterator<Item = &'a str> + Clone,
) -> Vec<String> {
    let near = near(name, known.clone());
    let chosen = if near.is_empty() {
        known.into_iter().collect()
    } else {
        near
    };
    chosen.into_iter().map(str::to_owned).collect()
}

/// `did you mean ...?` in words.
pub(crate) fn did_you_mean(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    match quoted.split_last() {
        None => "there is none to choose from".into(),
        Some((only, [])) => format!("did you mean {only}?"),
        Some((last, others)) if names.len() <= 3 => {
            format!("did you mean {} or {last}?", others.join(", "))
        }
        Some(_) => format!("known are {}", quoted.join(", ")),
    }
}

/// What to write instead of an unknown key: the known key in another unit, the near ones, or all of them.
pub(crate) fn remedy_for_key(key: &str, value: Option<f64>, known: &[&str]) -> String {
    let (stem, unit) = split_unit(key);
    let same_stem = known
        .iter()
        .find_map(|&candidate| match split_unit(candidate) {
            (its_stem, Some(its_unit)) if its_stem == stem => Some((candidate, its_unit)),
            _ => None,
        });
    match (same_stem, unit) {
        (Some((candidate, to)), None) => {
            format!("the key is `{candidate}`, with its unit: {}", to.0)
        }
        (Some((candidate, to)), Some(from)) if from.1 == to.1 => match value {
            Some(value) => {
                let converted = value * from.2 / to.2;
                format!(
                    "the key is `{candidate}`, in {} and not in {}: {candidate} = {}",
                    to.0,
                    from.0,
                    plain(converted)
                )
            }
            None => format!(
                "the key is `{candidate}`, in {} and not in {}",
                to.0, from.0
            ),
        },
        (Some((candidate, to)), Some(_)) => format!("the key is `{candidate}`, in {}", to.0),
        (None, _) if known.is_empty() => "no key is allowed here".into(),
        (None, _) => did_you_mean(&near_or_all(key, known.iter().copied())),
    }
}

/// A number as a person writes it: at most nine significant digits.
fn plain(value: f64) -> String {
    let digits = 8 - value.abs().log10().floor().clamp(-8.0, 8.0) as i32;
    let scale = 10f64.powi(digits);
    let rounded = (value * scale).round() / scale;
    format!("{}", if rounded.is_finite() { rounded } else { value })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_key_in_another_unit_is_recognised_and_converted() {
        let remedy = remedy_for_key("range_cm", Some(30.0), &["angle_deg", "range_m"]);
        assert_eq!(
            remedy,
            "the key is `range_m`, in m and not in cm: range_m = 0.3"
        );
        let remedy = remedy_for_key("heading_rad", Some(0.1), &["heading_deg"]);
        assert_eq!(
            remedy,
            "the key is `heading_deg`, in deg and not in rad: heading_deg = 5.72957795"
        );
    }

    #[test]
    fn for_a_key_without_its_unit_the_unit_is_suggested() {
        assert_eq!(
            remedy_for_key("range", None, &["range_m"]),
            "the key is `range_m`, with its unit: m"
        );
    }

    #[test]
    fn a_rate_is_not_taken_for_a_time() {
        assert_eq!(split_unit("speed_rad_s").0, "speed");
        assert_eq!(split_unit("at_s").0, "at");
    }

    #[test]
    fn names_are_offered_best_first_and_all_when_none_is_near() {
        assert_eq!(
            near("mode15", ["mode5", "mode1", "open", "wall_front"]),
            ["mode1", "mode5"]
        );
        assert_eq!(near_or_all("xyzzy", ["open", "room"]), ["open", "room"]);
    }

    #[test]
    fn a_name_known_twice_is_offered_once() {
        assert_eq!(near("at_sec", ["at_s", "at_s"]), ["at_s"]);
    }
}
