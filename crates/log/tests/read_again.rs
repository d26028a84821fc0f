//! What was recorded is read again: whole, cut anywhere, damaged anywhere.
#![allow(clippy::unwrap_used, clippy::panic)]

use rumbo_log::{
    Burst, Entry, Log, LogWriter, Manifest, Names, ReadError, ReadingSource, Said, Sent,
};
use std::io::{self, Cursor, Write};

type Writer = LogWriter<Cursor<Vec<u8>>>;

fn writer(manifest: &Manifest) -> Writer {
    LogWriter::new(Cursor::new(Vec::new()), manifest).unwrap()
}

fn finish(writer: Writer) -> Vec<u8> {
    writer.finish().unwrap().into_inner()
}

fn read(bytes: &[u8]) -> Result<Log, ReadError> {
    Log::read(Cursor::new(bytes))
}

fn burst(t_us: u64) -> Entry {
    Entry::Burst(Burst {
        t_us,
        to_robot: false,
        bytes: vec![7; 100],
    })
}

#[test]
fn a_log_cut_anywhere_is_read_up_to_there_and_a_complete_one_is_not_called_cut() {
    let mut writer = self::writer(&Manifest::default());
    for number in 0..6 {
        (0..50).for_each(|each| writer.record(&burst(1_000 * (50 * number + each))).unwrap());
        writer.flush().unwrap();
    }
    let whole = finish(writer);
    let log = read(&whole).unwrap();
    assert_eq!((log.cut.as_deref(), log.link.len()), (None, 300));
    let mut lengths = Vec::new();
    for part in 1..40 {
        match read(&whole[..whole.len() * part / 40]) {
            Ok(log) => lengths.push(log.link.len()),
            // Not even the manifest is whole.
            Err(error) => assert!(lengths.is_empty(), "{error}"),
        }
    }
    assert!(
        lengths.is_sorted() && lengths.last() == Some(&300),
        "{lengths:?}"
    );
    assert!(
        lengths.iter().any(|length| (1..300).contains(length)),
        "{lengths:?}"
    );
}

#[test]
fn what_was_sent_at_one_time_is_read_in_the_order_in_which_it_was_sent() {
    let mut writer = self::writer(&Manifest::default());
    for number in 0..6 {
        let (t_us, bytes) = (5_000 * (number / 3), vec![number as u8]);
        let sent = match number % 2 {
            0 => Entry::Burst(Burst {
                t_us,
                to_robot: true,
                bytes,
            }),
            _ => Entry::Said(Said {
                t_us,
                usart: 1,
                to_chip: true,
                bytes,
            }),
        };
        writer.record(&sent).unwrap();
        writer.record(&burst(t_us)).unwrap();
    }
    let log = read(&finish(writer)).unwrap();
    let sent = log.sent().map(|sent| match sent {
        Sent::Link(burst) => burst.bytes[0],
        Sent::Typed(said) => said.bytes[0],
    });
    assert_eq!(sent.collect::<Vec<_>>(), [0, 1, 2, 3, 4, 5]);
}

#[test]
fn a_log_with_damaged_bytes_is_read_as_far_as_it_goes_or_refused() {
    let mut writer = self::writer(&Manifest::default());
    (0..300).for_each(|number| writer.record(&burst(1_000 * number)).unwrap());
    let whole = finish(writer);
    let mut cut = 0;
    for at in (mcap::MAGIC.len()..whole.len() - 8).step_by(61) {
        let mut damaged = whole.clone();
        // A length that no memory holds, if a length was there.
        damaged[at..at + 8].fill(0x7f);
        match read(&damaged) {
            Ok(log) => cut += usize::from(log.cut.is_some()),
            Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
        }
    }
    assert!(cut > 0);
}

#[test]
fn what_comes_after_damage_near_the_start_is_read_all_the_same() {
    let manifest = Manifest {
        seed: Some(7),
        ..Manifest::default()
    };
    let mut writer = self::writer(&manifest);
    (0..3_000).for_each(|number| writer.record(&burst(1_000 * number)).unwrap());
    let whole = finish(writer);
    let index = mcap::Summary::read(&whole).unwrap().unwrap();
    assert!(index.chunk_indexes.len() > 3);
    let middle = |chunk: &mcap::records::ChunkIndex| {
        (chunk.chunk_start_offset + chunk.chunk_length / 2) as usize
    };
    let [topics, first] = [0, 1].map(|at| middle(&index.chunk_indexes[at]));
    // The length of the very first record; the chunk that says which channels there are; the first one with messages.
    for (at, has_holes, least, most) in [
        (mcap::MAGIC.len() + 1, false, 3_000, 3_000),
        (topics, true, 3_000, 3_000),
        (first, true, 1_000, 2_999),
    ] {
        let mut damaged = whole.clone();
        damaged[at..at + 8].fill(0x7f);
        let log = read(&damaged).unwrap();
        assert_eq!((log.has_holes, log.cut.is_some()), (has_holes, has_holes));
        assert!(has_holes || !log.notes.is_empty());
        assert_eq!(log.manifest.as_ref().unwrap().seed, Some(7));
        assert!(
            (least..=most).contains(&log.link.len()),
            "{}",
            log.link.len()
        );
        assert_eq!(log.link.last().unwrap().t_us, 2_999_000);
    }
}

#[test]
fn what_is_no_log_gets_one_line() {
    let mut foreign = mcap::Writer::new(Cursor::new(Vec::new())).unwrap();
    foreign.finish().unwrap();
    let foreign = foreign.into_inner().into_inner();
    for (bytes, said) in [
        (&b""[..], "ends before its first record"),
        (&foreign, "neither a manifest"),
        (b"t_s,x_m\n0,0\n", "is no MCAP log"),
        (&mcap::MAGIC[..3], "ends before its first record"),
        (mcap::MAGIC, "ends before its first record"),
    ] {
        let error = read(bytes).unwrap_err().to_string();
        assert!(error.contains(said) && !error.contains('\n'), "{error}");
    }
}

#[test]
fn readings_are_read_as_they_were_recorded_ranges_without_an_echo_and_unknown_ones_too() {
    let signals = |x_m: f64| {
        [
            ("true_x_m", x_m),
            ("pinged_front_m", f64::INFINITY),
            ("servo_pulse_us", f64::NAN),
        ]
        .map(|(name, value)| (name.to_owned(), value))
        .to_vec()
    };
    let (mut truth, mut printed) = (Names::default(), Names::default());
    let readings = vec![
        truth.reading(30, ReadingSource::Truth, signals(0.1234)),
        printed.reading(31, ReadingSource::Usart(0), vec![("kp".into(), 1e-7)]),
        truth.reading(60, ReadingSource::Truth, signals(0.2)),
    ];
    let mut writer = self::writer(&Manifest::default());
    writer.record(&Entry::Readings(readings)).unwrap();
    let log = read(&finish(writer)).unwrap();
    let [first, second, third] = &log.readings[..] else {
        panic!("{:?}", log.readings)
    };
    assert_eq!(first.signal("true_x_m"), Some(0.1234));
    assert_eq!(first.signal("pinged_front_m"), Some(f64::INFINITY));
    assert_eq!(first.signal("servo_pulse_us"), None);
    assert_eq!((second.source, second.t_ms), (ReadingSource::Usart(0), 31));
    assert_eq!(second.signal("kp"), Some(1e-7));
    assert_eq!(third.t_ms, 60);
    assert!(std::sync::Arc::ptr_eq(&first.names, &third.names));
    assert_eq!(log.duration_s(), 0.06);
}

/// Takes everything and keeps nothing.
#[derive(Default)]
struct Nowhere(u64);

impl Write for Nowhere {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0 += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Of an hour's session, with the rates of the lab, flushed as the station does it.
fn record_an_hour(log: &mut LogWriter<Nowhere>, from_us: u64) {
    let mut names = Names::default();
    for t_us in (from_us..from_us + 3_600_000_000).step_by(20_000) {
        let t_ms = (t_us / 1_000) as i64;
        log.record(&burst(t_us)).unwrap();
        let signals = vec![("true_x_m".into(), 0.1)];
        let reading = names.reading(t_ms, ReadingSource::Truth, signals);
        log.record(&Entry::Readings(vec![reading])).unwrap();
        if t_us % 200_000 == 0 {
            log.record(&Entry::State(Box::default())).unwrap();
        }
        if t_us % 400_000 == 0 {
            log.flush().unwrap();
        }
    }
}

#[test]
fn an_hour_of_log_leaves_nothing_in_memory_but_its_index() {
    let mut log = LogWriter::new(Nowhere::default(), &Manifest::default()).unwrap();
    let hours = [0, 1].map(|hour| {
        let from_us = hour * 3_600_000_000;
        allocation_counter::measure(|| record_an_hour(&mut log, from_us))
    });
    const CHUNKS: i64 = 9_000;
    for kept in hours {
        // A record of each chunk, in a list that has up to twice the room that it needs; in the first hour the channels.
        assert!(kept.count_current <= 15, "{kept:?}");
        assert!(kept.bytes_current < 250 * CHUNKS, "{kept:?}");
    }
}
