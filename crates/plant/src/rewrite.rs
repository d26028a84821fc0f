//! Changes numbers in the text of a robot file: comments and everything else stay as they are.
//!
//! What finds numbers of a robot by measurement writes them so: identification into `[plant]`, the robot's own
//! calibration into `[parameters]`.

use std::fmt;
use toml_edit::{DocumentMut, Item, Table, Value};

/// The text of a robot file, to be changed.
#[derive(Clone, Debug)]
pub struct RobotText(DocumentMut);

/// Why a robot file cannot be rewritten.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RewriteError {
    /// It is not TOML; the cause as the TOML reader states it.
    Syntax(String),
    /// This dotted key does not name a table.
    NoTable(String),
}

impl fmt::Display for RewriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax(cause) => f.write_str(cause),
            Self::NoTable(key) => write!(f, "`{key}` is no [table]; write it as one"),
        }
    }
}

impl std::error::Error for RewriteError {}

impl RobotText {
    /// Reads a robot file.
    ///
    /// # Errors
    /// If the text is not TOML.
    pub fn parse(text: &str) -> Result<Self, RewriteError> {
        let document = text.parse();
        let wrong = |error: toml_edit::TomlError| RewriteError::Syntax(error.to_string());
        document.map(Self).map_err(wrong)
    }

    /// Sets a number of a table such as `plant.motor`, made if absent. A comment beside the number stays.
    ///
    /// # Errors
    /// If `table` does not name a table.
    pub fn set(&mut self, table: &str, name: &str, value: f64) -> Result<(), RewriteError> {
        let table = self.table(table)?;
        if let Some(Item::Value(old)) = table.get_mut(name) {
            let decor = old.decor().clone();
            *old = Value::from(value);
            *old.decor_mut() = decor;
        } else {
            table.insert(name, toml_edit::value(value));
        }
        Ok(())
    }

    /// Puts the comment `mark` and `text` above a table's header, in place of earlier comments with this mark.
    ///
    /// # Errors
    /// If `table` does not name a table.
    pub fn annotate(&mut self, table: &str, mark: &str, text: &str) -> Result<(), RewriteError> {
        let decor = self.table(table)?.decor_mut();
        let before = decor.prefix().and_then(|prefix| prefix.as_str());
        let lines = before.unwrap_or("\n").split_inclusive('\n');
        let mut above: String = lines.filter(|line| !line.starts_with(mark)).collect();
        if !above.is_empty() && !above.ends_with('\n') {
            above.push('\n');
        }
        decor.set_prefix(format!("{above}{mark} {text}\n"));
        Ok(())
    }

    fn table(&mut self, key: &str) -> Result<&mut Table, RewriteError> {
        let mut table = self.0.as_table_mut();
        for name in key.split('.') {
            let item = table.entry(name).or_insert_with(|| {
                let mut new = Table::new();
                new.set_implicit(true);
                Item::Table(new)
            });
            let no_table = || RewriteError::NoTable(key.to_owned());
            table = item.as_table_mut().ok_or_else(no_table)?;
        }
        Ok(table)
    }
}

impl fmt::Display for RobotText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MARK: &str = "# Weighed";

    fn weighed(text: &str, date: &str) -> Result<String, RewriteError> {
        let mut file = RobotText::parse(text)?;
        file.set("plant.body", "mass_kg", 1.25)?;
        file.annotate("plant.body", MARK, &format!("on {date}."))?;
        Ok(file.to_string())
    }

    #[test]
    fn a_number_and_the_note_above_its_table_are_replaced_and_all_else_stays() {
        let text = "title = 'x' # mine\n\n# Light.\n# Weighed once.\n[plant.body]\nmass_kg = 1 # with cells\n\
                    yaw = 0x10\n\n[rig.a]\n";
        assert_eq!(
            weighed(text, "Monday").unwrap(),
            "title = 'x' # mine\n\n# Light.\n# Weighed on Monday.\n[plant.body]\nmass_kg = 1.25 # with cells\n\
             yaw = 0x10\n\n[rig.a]\n"
        );
    }

    #[test]
    fn a_table_that_is_not_there_is_made_with_its_note() {
        assert_eq!(
            weighed("title = 'x'\n", "Monday").unwrap(),
            "title = 'x'\n\n# Weighed on Monday.\n[plant.body]\nmass_kg = 1.25\n"
        );
    }

    #[test]
    fn what_is_no_table_and_what_is_no_toml_are_refused() {
        let error = weighed("[plant]\nbody = 3\n", "Monday").unwrap_err();
        assert_eq!(
            error.to_string(),
            "`plant.body` is no [table]; write it as one"
        );
        let error = weighed("[plant\n", "Monday").unwrap_err();
        assert!(matches!(error, RewriteError::Syntax(_)), "{error}");
    }
}
