//! The command line of a tool: options with a number, switches, and names.

use rumbo_experiment::files::FileError;
use std::collections::BTreeMap;

pub(crate) struct Arguments {
    numbers: BTreeMap<String, u64>,
    switches: Vec<String>,
    names: Vec<String>,
}

impl Arguments {
    /// Reads them: these options that have a number, these that have none, and some of these names.
    pub(crate) fn read(
        numbers: &[&str],
        switches: &[&str],
        names: &[&str],
    ) -> Result<Self, FileError> {
        let mut read = Self {
            numbers: BTreeMap::new(),
            switches: Vec::new(),
            names: Vec::new(),
        };
        let mut given = crate::arguments();
        while let Some(word) = given.next() {
            if numbers.contains(&word.as_str()) {
                let number = given.next().and_then(|number| number.parse().ok());
                let number = number.filter(|number| *number > 0).ok_or_else(|| {
                    FileError::Setting(format!("{word}: give a whole number from 1 on"))
                })?;
                read.numbers.insert(word, number);
            } else if switches.contains(&word.as_str()) {
                read.switches.push(word);
            } else if names.contains(&word.as_str()) {
                read.names.push(word);
            } else {
                let known = [numbers, switches, names].concat().join(", ");
                let unknown = format!("unknown {word}; there are {known}");
                return Err(FileError::Setting(unknown));
            }
        }
        Ok(read)
    }

    /// The number of an option; this one where it was not given.
    pub(crate) fn number(&self, option: &str, usual: u64) -> u64 {
        self.numbers.get(option).copied().unwrap_or(usual)
    }

    pub(crate) fn has(&self, switch: &str) -> bool {
        self.switches.iter().any(|given| given == switch)
    }

    /// Whether a thing of this name is asked for: all are where none is named.
    pub(crate) fn wants(&self, name: &str) -> bool {
        self.names.is_empty() || self.names.iter().any(|given| given == name)
    }
}
