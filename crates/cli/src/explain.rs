//! `rumbo explain`: what explains a stretch of a log.

use crate::args::ExplainArgs;
use crate::export::{stretch, warn_if_cut};
use crate::failure::Failure;
use crate::output;
use rumbo_session::explain::explain as causes_of;
use rumbo_station::log_file;

/// Prints the causes, those that explain most first.
pub(crate) fn explain(args: &ExplainArgs) -> Result<(), Failure> {
    let log = log_file::read(&args.log).map_err(Failure::input)?;
    warn_if_cut(&args.log, &log)?;
    let [from_s, to_s] = stretch(&args.log, &log, args.from_s, args.to_s)?;
    let causes = causes_of(&log, from_s, to_s);
    if args.json {
        return output::json(&causes);
    }
    if causes.is_empty() {
        return output::line("no rule finds anything unusual");
    }
    let mut rows = Vec::new();
    for cause in &causes {
        let lesson = cause.lesson.map(|lesson| format!("(lesson {lesson})"));
        rows.push(vec![
            format!("{:.2} to {:.2} s", cause.from_s, cause.to_s),
            [Some(cause.text.clone()), lesson]
                .into_iter()
                .flatten()
                .collect::<Vec<_>>()
                .join(" "),
        ]);
    }
    output::table(&rows)
}
