//! JUnit XML, for continuous integration.

use rumbo_report::FileStamp;
use std::fmt::Write;

/// A group of cases.
pub(crate) struct Suite {
    /// Its name.
    pub(crate) name: String,
    /// In order.
    pub(crate) cases: Vec<Case>,
}

/// One claim.
pub(crate) struct Case {
    /// What it belongs to.
    pub(crate) class: String,
    /// What it claims.
    pub(crate) name: String,
    /// Why it failed, if it did.
    pub(crate) failure: Option<String>,
}

/// A whole file.
pub(crate) fn document(title: &str, suites: &[Suite], stamp: &FileStamp) -> String {
    let failures = |suite: &Suite| {
        let failed = suite.cases.iter().filter(|case| case.failure.is_some());
        failed.count()
    };
    let mut xml = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- {} -->\n<testsuites name=\"{}\" tests=\"{}\" failures=\"{}\">\n",
        stamp.text(),
        attribute(title),
        suites.iter().map(|suite| suite.cases.len()).sum::<usize>(),
        suites.iter().map(failures).sum::<usize>()
    );
    for suite in suites {
        // Writing to a string cannot fail.
        let _ = writeln!(
            xml,
            "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\">",
            attribute(&suite.name),
            suite.cases.len(),
            failures(suite)
        );
        for Case {
            class,
            name,
            failure,
        } in &suite.cases
        {
            let _ = write!(
                xml,
                "    <testcase classname=\"{}\" name=\"{}\"",
                attribute(class),
                attribute(name)
            );
            let _ = match failure {
                None => writeln!(xml, "/>"),
                Some(why) => writeln!(xml, "><failure message=\"{}\"/></testcase>", attribute(why)),
            };
        }
        xml += "  </testsuite>\n";
    }
    xml + "</testsuites>\n"
}

/// A text as the value of an attribute; what XML cannot hold is left out.
fn attribute(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            '\n' | '\t' => escaped.push(' '),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => {}
            c => escaped.push(c),
        }
    }
    escaped
}
