//! Dropped keys of files, and their successors.
//!
//! A renamed or dropped key of robot, world or scenario files gets a line here: the error for a file of an earlier
//! version then names what to write instead.

/// Path of the key, without the numbers of tables such as `command[2]`, and its successor.
const DROPPED: [(&str, &str); 3] = [
    (
        "plant.sonar.noise_rest_m",
        "write `noise_m`, the deviation in motion, and `rest_weakness`, its share at rest",
    ),
    (
        "plant.sonar.noise_motion_m",
        "write `noise_m`, with the same value",
    ),
    (
        "plant.sonar.outlier_m",
        "write `outlier_span`, the same relative to the range",
    ),
];

/// What to write instead of a key that was dropped; `None` of any other.
pub(crate) fn successor(path: &str) -> Option<&'static str> {
    let mut plain = String::new();
    for part in path.split('[') {
        plain.push_str(part.split_once(']').map_or(part, |(_, rest)| rest));
    }
    DROPPED
        .iter()
        .find_map(|(dropped, successor)| (*dropped == plain).then_some(*successor))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_plant::params::Params;

    #[test]
    fn a_key_of_today_is_not_called_dropped() {
        for limit in Params::limits() {
            assert_eq!(successor(&format!("plant.{}", limit.key)), None);
        }
    }

    #[test]
    fn tables_are_counted_in_complaints_but_not_in_the_list() {
        let (path, remedy) = DROPPED[0];
        assert_eq!(successor(path), Some(remedy));
        assert_eq!(
            successor(&path.replacen("plant", "plant[3]", 1)),
            Some(remedy)
        );
    }
}
