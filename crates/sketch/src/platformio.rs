//! What the file of a PlatformIO project says that its program may depend on.

use crate::source::{PROJECT, Source};
use std::collections::BTreeMap;

/// Most options taken.
const MOST: usize = 100;
/// The options taken: macros, optimisation, and the language's standard. Others lead to files, or to other programs.
const TAKEN: [&str; 4] = ["-D", "-U", "-O", "-std="];

/// The `build_flags` of `[env]` and of the environment that is built: the first of `default_envs`, else the first for AVR chips,
/// else the first.
pub(crate) fn flags(source: &Source) -> Vec<String> {
    let text = source.files.get(PROJECT).map_or(&[][..], Vec::as_slice);
    let sections = sections(&String::from_utf8_lossy(text));
    let value = |section: &str, key: &str| -> Option<&str> {
        let (_, values) = sections.iter().find(|(name, _)| name == section)?;
        values.get(key).map(String::as_str)
    };
    let names = sections.iter().map(|(name, _)| name.as_str());
    let environments: Vec<&str> = names.filter(|name| name.starts_with("env:")).collect();
    let is_default = |name: &str| {
        let first = value("platformio", "default_envs")
            .and_then(|names| names.split([',', ' ']).find(|name| !name.is_empty()));
        first.is_some_and(|first| name.strip_prefix("env:") == Some(first))
    };
    let is_for_avr =
        |name: &str| value(name, "platform").is_some_and(|platform| platform.contains("atmelavr"));
    let first = |suits: &dyn Fn(&str) -> bool| environments.iter().find(|name| suits(name));
    let built = first(&is_default)
        .or_else(|| first(&is_for_avr))
        .or_else(|| environments.first());
    let said = ["env"]
        .iter()
        .chain(built)
        .filter_map(|name| value(name, "build_flags"));
    said.flat_map(taken).take(MOST).collect()
}

/// Those of the options in a text that are taken.
fn taken(text: &str) -> Vec<String> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_=.+-".contains(c);
    let mut words = text.split_whitespace();
    let mut taken = Vec::new();
    while let Some(word) = words.next() {
        let flag = match word {
            "-D" | "-U" => format!("{word}{}", words.next().unwrap_or_default()),
            _ => word.to_owned(),
        };
        let begins = |with: &&str| flag.len() > with.len() && flag.starts_with(*with);
        if TAKEN.iter().any(begins) && flag.chars().all(is_plain) {
            taken.push(flag);
        }
    }
    taken
}

/// The sections with their values; one that goes on in indented lines is joined by blanks.
fn sections(text: &str) -> Vec<(String, BTreeMap<String, String>)> {
    let mut sections: Vec<(String, BTreeMap<String, String>)> = Vec::new();
    let mut key = String::new();
    for line in text.lines() {
        let line = line.split(" ;").next().unwrap_or_default().trim_end();
        let inside = line.trim_start();
        if inside.is_empty() || inside.starts_with([';', '#']) {
            continue;
        }
        let name = inside
            .strip_prefix('[')
            .and_then(|rest| rest.strip_suffix(']'));
        if let Some(name) = name {
            sections.push((name.trim().to_owned(), BTreeMap::new()));
            continue;
        }
        let Some((_, values)) = sections.last_mut() else {
            continue;
        };
        let value = match inside.split_once('=') {
            Some((name, value)) if inside.len() == line.len() => {
                name.trim().clone_into(&mut key);
                value
            }
            _ => inside,
        };
        let all = values.entry(key.clone()).or_default();
        all.push(' ');
        all.push_str(value);
    }
    sections
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flags_of(text: &str) -> Vec<String> {
        flags(&Source {
            name: "car".into(),
            files: BTreeMap::from([(PROJECT.to_owned(), text.into())]),
        })
    }

    #[test]
    fn the_flags_are_those_of_the_environment_for_the_chip() {
        let text = "[env]\nbuild_flags = -D ALL\n[env:esp]\nplatform = espressif32\nbuild_flags = -DESP\n\
                    [env:mega]\nplatform = atmelavr ; the robot\nbuild_flags =\n    -std=c++17\n    ; -DOFF\n    -DBAUD=57600 -O3\n\
                    lib_deps = x\n";
        assert_eq!(
            flags_of(text),
            ["-DALL", "-std=c++17", "-DBAUD=57600", "-O3"]
        );
        let other = format!("[platformio]\ndefault_envs = esp, mega\n{text}");
        assert_eq!(flags_of(&other), ["-DALL", "-DESP"]);
        assert_eq!(flags_of(""), [""; 0]);
    }

    #[test]
    fn what_leads_elsewhere_is_not_taken() {
        let text = "[env:a]\nbuild_flags = -include/etc/passwd -I/etc -Wl,-Tx -DA=\"/etc\" -D @x ${env.y} -fplugin=x -D\n";
        assert_eq!(flags_of(text), [""; 0]);
    }
}
