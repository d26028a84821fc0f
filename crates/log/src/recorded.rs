//! The CSV of the original program that a log made by `rumbo import` carries.

use mcap::Summary;
use mcap::read::attachment;

/// Media type of that attachment.
pub const CSV: &str = "text/csv";

/// The CSV in the bytes of a log; `None` if it carries none that can be read.
#[must_use]
pub fn recorded_csv(log: &[u8]) -> Option<Vec<u8>> {
    let summary = Summary::read(log).ok()??;
    let mut indexes = summary.attachment_indexes.iter();
    let index = indexes.find(|index| index.media_type == CSV)?;
    let csv = attachment(log, index).ok()?;
    Some(csv.data.into_owned())
}
