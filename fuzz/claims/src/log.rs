//! Any file is a log or gives an error of one line. The bytes are taken as they are, and as lines of
//! messages in a log that is whole: a topic, a letter for each, and the text of the message; or `m` and a piece of its
//! manifest, `key=value`.

use mcap::WriteOptions;
use mcap::records::{MessageHeader, Metadata};
use rumbo_log::{Log, Summary};
use std::collections::BTreeMap;
use std::io::Cursor;

const TOPICS: [&str; 9] = [
    "/telemetry",
    "/state",
    "/parameters",
    "/events",
    "/scene",
    "/link/from_robot",
    "/link/to_robot",
    "/console",
    "telemetry",
];

/// Messages of this text.
fn log_of(text: &[u8]) -> mcap::McapResult<Vec<u8>> {
    let options = WriteOptions::new().compression(None);
    let mut log = options.create(Cursor::new(Vec::new()))?;
    let mut channels = Vec::new();
    for topic in TOPICS {
        channels.push(log.add_channel(0, topic, "json", &BTreeMap::new())?);
    }
    let mut manifest = BTreeMap::new();
    for (number, line) in text.split(|byte| *byte == b'\n').enumerate() {
        let Some((letter, data)) = line.split_first() else {
            continue;
        };
        if *letter == b'm' {
            let line = String::from_utf8_lossy(data);
            let (key, value) = line.split_once('=').unwrap_or((&line, ""));
            manifest.insert(key.to_owned(), value.to_owned());
            continue;
        }
        let time = number as u64 * 40_000_000;
        let header = MessageHeader {
            channel_id: channels[usize::from(*letter) % TOPICS.len()],
            sequence: 0,
            log_time: time,
            publish_time: time,
        };
        log.write_to_known_channel(&header, data)?;
    }
    log.write_metadata(&Metadata {
        name: "manifest".into(),
        metadata: manifest,
    })?;
    log.finish()?;
    Ok(log.into_inner().into_inner())
}

fn read(bytes: &[u8]) {
    match Log::read(Cursor::new(bytes)) {
        Ok(log) => {
            assert!(!log.duration_s().is_nan());
            let counted = log.sent().count() + log.events().count() + log.parameters().len();
            let _ = (counted, log.scene(), log.speaks_text(), log.holds_nothing());
        }
        Err(error) => {
            let said = error.to_string();
            assert!(!said.is_empty() && !said.contains('\n'), "{said}");
        }
    }
    let _ = Summary::read(Cursor::new(bytes));
    let _ = Log::read_signals(Cursor::new(bytes));
}

/// Panics if the claim does not hold.
pub fn check(bytes: &[u8]) {
    read(bytes);
    read(&log_of(bytes).expect("messages in memory"));
}
