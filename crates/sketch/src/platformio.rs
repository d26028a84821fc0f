//! What the file of a PlatformIO project says that its program may depend on.

use crate::source::{PROJECT, Source};
use std::collections::BTreeMap;

/// Most options and patterns taken, and folders in one pattern.
const MOST: usize = 100;
const MOST_PARTS: usize = 8;
/// The options taken: macros, optimisation, and the language's standard. Others lead to files, or to other programs, but for
/// folders of the project with headers.
const TAKEN: [&str; 4] = ["-D", "-U", "-O", "-std="];

/// What a project says of the environment that is built: the first of `default_envs`, else the first for AVR chips, else the
/// first.
#[derive(Debug)]
pub(crate) struct Project {
    /// What it says to the compiler.
    pub(crate) flags: Vec<String>,
    /// Which files below `src` are compiled, the last word on each counts.
    filter: Vec<(bool, String)>,
}

impl Project {
    pub(crate) fn of(source: &Source) -> Self {
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
        let is_for_avr = |name: &str| {
            value(name, "platform").is_some_and(|platform| platform.contains("atmelavr"))
        };
        let first = |suits: &dyn Fn(&str) -> bool| environments.iter().find(|name| suits(name));
        let built = first(&is_default)
            .or_else(|| first(&is_for_avr))
            .or_else(|| environments.first());
        let said = |key: &'static str| {
            let sections = ["env"].iter().chain(built);
            sections.filter_map(move |name| value(name, key))
        };
        let flags = said("build_flags").flat_map(|text| taken(text, source));
        let own = said("build_src_filter").next_back();
        Self {
            flags: flags.take(MOST).collect(),
            filter: own
                .or(said("src_filter").next_back())
                .map(filter)
                .unwrap_or_default(),
        }
    }

    /// Whether a file below `src`, by its path there, is compiled.
    pub(crate) fn builds(&self, name: &str) -> bool {
        let name: Vec<&str> = name.split('/').collect();
        let is_of = |(_, pattern): &&(bool, String)| {
            let pattern = pattern.split('/').filter(|part| !part.is_empty());
            is_below(&pattern.collect::<Vec<_>>(), &name)
        };
        let last = self.filter.iter().rev().find(is_of);
        last.map_or(self.filter.is_empty(), |(with, _)| *with)
    }
}

/// The patterns of a filter, as `+<main.cpp> -<test/>`.
fn filter(text: &str) -> Vec<(bool, String)> {
    let patterns = text.split('>').filter_map(|word| {
        let (sign, pattern) = word.split_once('<')?;
        let is_short = pattern.split('/').count() <= MOST_PARTS;
        is_short.then(|| (!sign.trim_end().ends_with('-'), pattern.trim().to_owned()))
    });
    patterns.take(MOST).collect()
}

/// Whether a pattern names a file or a folder above it; `**` is any folders.
fn is_below(pattern: &[&str], name: &[&str]) -> bool {
    match (pattern, name) {
        ([], _) => true,
        (["**", rest @ ..], _) if is_below(rest, name) => true,
        (["**", ..], [_, inside @ ..]) => is_below(pattern, inside),
        ([part, rest @ ..], [own, inside @ ..]) => is_like(part, own) && is_below(rest, inside),
        _ => false,
    }
}

/// Whether a name is like a pattern, in which `*` is any characters.
fn is_like(pattern: &str, name: &str) -> bool {
    let mut parts = pattern.split('*');
    let Some(mut rest) = parts.next().and_then(|first| name.strip_prefix(first)) else {
        return false;
    };
    let Some(last) = parts.next_back() else {
        return rest.is_empty();
    };
    for part in parts {
        match rest.split_once(part) {
            Some((_, behind)) => rest = behind,
            None => return false,
        }
    }
    rest.ends_with(last)
}

/// Those of the options in a text that are taken, and the folders of the project that headers are looked for in.
fn taken(text: &str, source: &Source) -> Vec<String> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_=.+-".contains(c);
    let is_folder = |folder: &str| {
        let mut files = source.files.keys();
        files.any(|file| {
            file.strip_prefix(folder)
                .is_some_and(|rest| rest.starts_with('/'))
        })
    };
    let mut words = text.split_whitespace();
    let mut taken = Vec::new();
    while let Some(word) = words.next() {
        let flag = match word {
            "-D" | "-U" | "-I" => format!("{word}{}", words.next().unwrap_or_default()),
            _ => word.to_owned(),
        };
        if let Some(folder) = flag.strip_prefix("-I") {
            let folder = folder.trim_start_matches("./").trim_end_matches('/');
            taken.extend(is_folder(folder).then(|| format!("-I{folder}")));
            continue;
        }
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

    fn project(text: &str) -> Project {
        Project::of(&Source {
            name: "car".into(),
            files: BTreeMap::from([
                (PROJECT.to_owned(), text.into()),
                ("include/pins.h".to_owned(), Vec::new()),
            ]),
        })
    }

    fn flags_of(text: &str) -> Vec<String> {
        project(text).flags
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
        let text = "[env:a]\nbuild_flags = -include/etc/passwd -I/etc -I.. -I include/.. -I -Wl,-Tx -DA=\"/etc\" -D @x ${env.y} -fplugin=x -D\n";
        assert_eq!(flags_of(text), [""; 0]);
        let own = "[env:a]\nbuild_flags = -Iinclude/ -I ./include\n";
        assert_eq!(flags_of(own), ["-Iinclude", "-Iinclude"]);
    }

    #[test]
    fn an_environment_has_files_of_its_own() {
        let builds = |filter: &str, name: &str| {
            let text = format!(
                "[env]\nbuild_src_filter = -<*>\n[env:uno]\nplatform = atmelavr\n{filter}\n"
            );
            project(&text).builds(name)
        };
        assert!(!builds("", "main.cpp"));
        let only = "build_src_filter = +<main.cpp>";
        assert!(
            builds(only, "main.cpp") && !builds(only, "esp/main.cpp") && !builds(only, "main.c")
        );
        let less = "build_src_filter =\n    +<*>\n    -<esp*> -<**/test/*_t.cpp>";
        assert!(
            builds(less, "main.cpp") && builds(less, "motor/pid.cpp") && builds(less, "test/a.cpp")
        );
        assert!(!builds(less, "esp32.cpp") && !builds(less, "esp/main.cpp"));
        assert!(!builds(less, "test/a_t.cpp") && !builds(less, "a/b/test/a_t.cpp"));
        assert!(project("[env:uno]\nboard = uno\n").builds("main.cpp"));
        let worst = format!("build_src_filter = +<main.cpp> +<{}x>", "**/".repeat(200));
        assert!(!builds(&worst, &"a/".repeat(100)));
    }
}
