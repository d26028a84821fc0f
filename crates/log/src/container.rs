//! Writes an MCAP file (<https://mcap.dev/spec>), all in Rust, so that a browser writes what a computer does.
//!
//! The file only grows: killed at any moment, all chunks but the last are whole. What its end says of them, the index,
//! is collected on the way.

use crc::{Crc, Digest, Table};
use lz4_flex::frame::{FrameDecoder, FrameEncoder};
use mcap::MAGIC;
use mcap::records::{ChunkHeader, op};
use std::collections::BTreeMap;
use std::io::{self, Read, Write};

/// A chunk is closed before it becomes longer than this, before compression \[bytes\]: what a damaged or cut one takes
/// with it. It is compressed as one block of LZ4.
const CHUNK: usize = 64 << 10;
/// A message without its data, and the head before it \[bytes\].
const MESSAGE: usize = 9 + 22;
/// The checksum that MCAP uses everywhere.
static CRC: Crc<u32, Table<16>> = Crc::<u32, Table<16>>::new(&crc::CRC_32_ISO_HDLC);

/// An MCAP file being written.
pub struct Container<W> {
    into: W,
    /// Written so far \[bytes\], and its checksum.
    at: u64,
    crc: Digest<'static, u32, Table<16>>,
    chunk: Chunk,
    schemas: Vec<Vec<u8>>,
    index: Index,
}

/// The chunk that is being filled.
#[derive(Default)]
struct Chunk {
    records: Vec<u8>,
    times: Option<(u64, u64)>,
    /// Of each channel the time of every message, and where it is in the chunk.
    messages: BTreeMap<u16, Vec<(u64, u64)>>,
}

/// What the end of the file says of it: records, ready to be written.
#[derive(Default)]
struct Index {
    schemas: Vec<u8>,
    channels: Vec<u8>,
    chunks: Vec<u8>,
    attachments: Vec<u8>,
    metadata: Vec<u8>,
    /// How many of them.
    counts: [u32; 5],
    times: Option<(u64, u64)>,
    /// Messages of each channel.
    messages: BTreeMap<u16, u64>,
}

/// Where a record is in the file.
struct Extent {
    at: u64,
    length: u64,
}

impl<W: Write> Container<W> {
    /// A file that says which profile it follows and what wrote it.
    ///
    /// # Errors
    /// What `into` does not take.
    pub fn new(into: W, profile: &str, library: &str) -> io::Result<Self> {
        let mut file = Self {
            into,
            at: 0,
            crc: CRC.digest(),
            chunk: Chunk::default(),
            schemas: Vec::new(),
            index: Index::default(),
        };
        file.put(MAGIC)?;
        file.record(op::HEADER, &Body::default().text(profile).text(library).0)?;
        Ok(file)
    }

    /// Texts by name.
    ///
    /// # Errors
    /// What `into` does not take.
    pub fn metadata(&mut self, name: &str, texts: &BTreeMap<String, String>) -> io::Result<()> {
        self.close_chunk()?;
        let Extent { at, length } =
            self.record(op::METADATA, &Body::default().text(name).texts(texts).0)?;
        let entry = Body::default().u64(at).u64(length).text(name);
        self.index.counts[4] += 1;
        append(&mut self.index.metadata, op::METADATA_INDEX, &entry.0);
        Ok(())
    }

    /// A file within.
    ///
    /// # Errors
    /// What `into` does not take.
    pub fn attach(&mut self, name: &str, media_type: &str, data: &[u8]) -> io::Result<()> {
        self.close_chunk()?;
        let mut body = Body::default().u64(0).u64(0).text(name).text(media_type);
        body = body.u64(data.len() as u64).bytes(data);
        let crc = CRC.checksum(&body.0);
        let Extent { at, length } = self.record(op::ATTACHMENT, &body.u32(crc).0)?;
        let entry = Body::default().u64(at).u64(length).u64(0).u64(0);
        let entry = entry.u64(data.len() as u64).text(name).text(media_type);
        self.index.counts[3] += 1;
        append(&mut self.index.attachments, op::ATTACHMENT_INDEX, &entry.0);
        Ok(())
    }

    /// What messages look like; the same twice is one.
    pub fn schema(&mut self, name: &str, encoding: &str, data: &[u8]) -> u16 {
        let body = Body::default().text(name).text(encoding);
        let Body(body) = body.u32(data.len() as u32).bytes(data);
        let known = self.schemas.iter().position(|schema| *schema == body);
        // Numbers begin with 1; a log has some twenty.
        let id = known.unwrap_or(self.schemas.len()) as u16 + 1;
        if known.is_none() {
            let record = Body::default().u16(id).bytes(&body);
            append(&mut self.chunk.records, op::SCHEMA, &record.0);
            self.index.describe(op::SCHEMA, &record.0);
            self.schemas.push(body);
        }
        id
    }

    /// Where messages of one kind go.
    pub fn channel(
        &mut self,
        schema: u16,
        topic: &str,
        encoding: &str,
        about: &BTreeMap<String, String>,
    ) -> u16 {
        let id = self.index.counts[1] as u16 + 1;
        let body = Body::default().u16(id).u16(schema).text(topic);
        let Body(body) = body.text(encoding).texts(about);
        append(&mut self.chunk.records, op::CHANNEL, &body);
        self.index.describe(op::CHANNEL, &body);
        id
    }

    /// A message.
    ///
    /// # Errors
    /// What `into` does not take.
    pub fn message(
        &mut self,
        channel: u16,
        sequence: u32,
        time_ns: u64,
        data: &[u8],
    ) -> io::Result<()> {
        if self.chunk.records.len() + MESSAGE + data.len() > CHUNK {
            self.close_chunk()?;
        }
        let at = self.chunk.records.len() as u64;
        let head = Body(Vec::with_capacity(MESSAGE))
            .u16(channel)
            .u32(sequence)
            .u64(time_ns);
        append_parts(
            &mut self.chunk.records,
            op::MESSAGE,
            [&head.u64(time_ns).0, data],
        );
        self.chunk.know(channel, time_ns, at);
        Ok(())
    }

    /// Closes the chunk and flushes: everything so far survives a crash.
    ///
    /// # Errors
    /// What `into` does not take.
    pub fn flush(&mut self) -> io::Result<()> {
        self.close_chunk()?;
        self.into.flush()
    }

    /// Writes the index, and gives back what was written into.
    ///
    /// # Errors
    /// What `into` does not take.
    pub fn finish(mut self) -> io::Result<W> {
        self.close_chunk()?;
        let crc = self.crc.clone().finalize();
        self.record(op::DATA_END, &crc.to_le_bytes())?;
        self.crc = CRC.digest();
        let index = std::mem::take(&mut self.index);
        let mut statistics = Vec::new();
        append(&mut statistics, op::STATISTICS, &index.statistics().0);
        let (from, mut groups) = (self.at, Vec::new());
        for (kind, records) in [
            (op::SCHEMA, &index.schemas),
            (op::CHANNEL, &index.channels),
            (op::STATISTICS, &statistics),
            (op::CHUNK_INDEX, &index.chunks),
            (op::ATTACHMENT_INDEX, &index.attachments),
            (op::METADATA_INDEX, &index.metadata),
        ] {
            if !records.is_empty() {
                let group = Body::default().u8(kind).u64(self.at);
                let group = group.u64(records.len() as u64);
                append(&mut groups, op::SUMMARY_OFFSET, &group.0);
                self.put(records)?;
            }
        }
        let groups_at = self.at;
        self.put(&groups)?;
        // Of the index, and of the footer up to its checksum.
        let footer = Body::default().u8(op::FOOTER).u64(8 + 8 + 4);
        self.put(&footer.u64(from).u64(groups_at).0)?;
        let crc = self.crc.clone().finalize();
        self.put(&crc.to_le_bytes())?;
        self.put(MAGIC)?;
        self.into.flush()?;
        Ok(self.into)
    }

    /// Takes a chunk of another file as it is; false if it is damaged.
    ///
    /// # Errors
    /// What `into` does not take.
    pub(crate) fn copy_chunk(
        &mut self,
        body: &[u8],
        header: &ChunkHeader,
        data: &[u8],
    ) -> io::Result<bool> {
        let mut records = Vec::new();
        let most = header.uncompressed_size + 1;
        let read = match header.compression.as_str() {
            "" => data.take(most).read_to_end(&mut records),
            "lz4" => FrameDecoder::new(data).take(most).read_to_end(&mut records),
            _ => return Ok(false),
        };
        let crc = header.uncompressed_crc;
        let is_sound = read.is_ok()
            && records.len() as u64 == header.uncompressed_size
            && (crc == 0 || crc == CRC.checksum(&records));
        if !(is_sound && self.learn(&records).is_some()) {
            return Ok(false);
        }
        let sizes = (data.len(), records.len());
        self.put_chunk(body, &header.compression, sizes)?;
        Ok(true)
    }

    /// What a chunk has in it.
    fn learn(&mut self, records: &[u8]) -> Option<()> {
        let mut rest = records;
        while let Some((head, after)) = rest.split_first_chunk::<9>() {
            let [kind, length @ ..] = *head;
            let length = usize::try_from(u64::from_le_bytes(length)).ok()?;
            let (body, next) = after.split_at_checked(length)?;
            match kind {
                op::SCHEMA | op::CHANNEL => self.index.describe(kind, body),
                op::MESSAGE => {
                    let channel = u16::from_le_bytes(*body.first_chunk()?);
                    let time_ns = u64::from_le_bytes(*body.get(6..)?.first_chunk()?);
                    let at = (records.len() - rest.len()) as u64;
                    self.chunk.know(channel, time_ns, at);
                }
                _ => return None,
            }
            rest = next;
        }
        rest.is_empty().then_some(())
    }

    fn close_chunk(&mut self) -> io::Result<()> {
        if self.chunk.records.is_empty() {
            return Ok(());
        }
        let mut frame = FrameEncoder::new(Vec::new());
        frame.write_all(&self.chunk.records)?;
        let frame = frame.finish()?;
        let (from_ns, until_ns) = self.chunk.times.unwrap_or_default();
        let body = Body::default().u64(from_ns).u64(until_ns);
        let body = body.u64(self.chunk.records.len() as u64);
        let body = body.u32(CRC.checksum(&self.chunk.records)).text("lz4");
        let body = body.u64(frame.len() as u64).bytes(&frame);
        let sizes = (frame.len(), self.chunk.records.len());
        self.put_chunk(&body.0, "lz4", sizes)
    }

    /// Writes a chunk of which [`Self::chunk`] says what is in it, and empties that.
    fn put_chunk(
        &mut self,
        body: &[u8],
        compression: &str,
        (compressed, uncompressed): (usize, usize),
    ) -> io::Result<()> {
        let Extent { at, length } = self.record(op::CHUNK, body)?;
        let mut chunk = std::mem::take(&mut self.chunk);
        let messages_at = self.at;
        let mut places = Body::default();
        for (channel, messages) in &mut chunk.messages {
            places = places.u16(*channel).u64(self.at);
            let length = 16 * messages.len() as u32;
            let entries = Body::default().u16(*channel).u32(length);
            let entries = messages.iter().fold(entries, |entries, (time_ns, at)| {
                entries.u64(*time_ns).u64(*at)
            });
            self.record(op::MESSAGE_INDEX, &entries.0)?;
            *self.index.messages.entry(*channel).or_default() += messages.len() as u64;
        }
        let (from_ns, until_ns) = chunk.times.unwrap_or_default();
        let entry = Body::default().u64(from_ns).u64(until_ns);
        let entry = entry.u64(at).u64(length).u32(places.0.len() as u32);
        let entry = entry.bytes(&places.0).u64(self.at - messages_at);
        let entry = entry.text(compression);
        let entry = entry.u64(compressed as u64).u64(uncompressed as u64);
        append(&mut self.index.chunks, op::CHUNK_INDEX, &entry.0);
        self.index.counts[2] += 1;
        self.index.times = chunk.times.into_iter().fold(self.index.times, union);
        chunk.clear();
        self.chunk = chunk;
        Ok(())
    }

    fn record(&mut self, kind: u8, body: &[u8]) -> io::Result<Extent> {
        let at = self.at;
        self.put(&[kind])?;
        self.put(&(body.len() as u64).to_le_bytes())?;
        self.put(body)?;
        let length = self.at - at;
        Ok(Extent { at, length })
    }

    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.into.write_all(bytes)?;
        self.crc.update(bytes);
        self.at += bytes.len() as u64;
        Ok(())
    }
}

impl Chunk {
    /// A message at a place in it.
    fn know(&mut self, channel: u16, time_ns: u64, at: u64) {
        let messages = self.messages.entry(channel).or_default();
        messages.push((time_ns, at));
        self.times = union(self.times, (time_ns, time_ns));
    }

    /// Without what was in it, but with its room.
    fn clear(&mut self) {
        self.records.clear();
        self.times = None;
        self.messages.clear();
    }
}

impl Index {
    /// A schema or a channel.
    fn describe(&mut self, kind: u8, body: &[u8]) {
        let (number, records) = match kind {
            op::SCHEMA => (0, &mut self.schemas),
            _ => (1, &mut self.channels),
        };
        self.counts[number] += 1;
        append(records, kind, body);
    }

    fn statistics(&self) -> Body {
        let [schemas, channels, chunks, attachments, metadata] = self.counts;
        let (from_ns, until_ns) = self.times.unwrap_or_default();
        let body = Body::default().u64(self.messages.values().sum());
        let body = body.u16(schemas as u16).u32(channels).u32(attachments);
        let body = body.u32(metadata).u32(chunks).u64(from_ns).u64(until_ns);
        let body = body.u32(10 * self.messages.len() as u32);
        self.messages.iter().fold(body, |body, (channel, count)| {
            body.u16(*channel).u64(*count)
        })
    }
}

fn union(times: Option<(u64, u64)>, (from, until): (u64, u64)) -> Option<(u64, u64)> {
    let (first, last) = times.unwrap_or((from, until));
    Some((first.min(from), last.max(until)))
}

fn append(into: &mut Vec<u8>, kind: u8, body: &[u8]) {
    append_parts(into, kind, [body, &[]]);
}

fn append_parts(into: &mut Vec<u8>, kind: u8, parts: [&[u8]; 2]) {
    let length: usize = parts.iter().map(|part| part.len()).sum();
    into.push(kind);
    into.extend((length as u64).to_le_bytes());
    parts.iter().for_each(|part| into.extend(*part));
}

/// What a record holds.
#[derive(Default)]
struct Body(Vec<u8>);

impl Body {
    fn bytes(mut self, bytes: &[u8]) -> Self {
        self.0.extend(bytes);
        self
    }

    fn u8(self, value: u8) -> Self {
        self.bytes(&[value])
    }

    fn u16(self, value: u16) -> Self {
        self.bytes(&value.to_le_bytes())
    }

    fn u32(self, value: u32) -> Self {
        self.bytes(&value.to_le_bytes())
    }

    fn u64(self, value: u64) -> Self {
        self.bytes(&value.to_le_bytes())
    }

    fn text(self, text: &str) -> Self {
        self.u32(text.len() as u32).bytes(text.as_bytes())
    }

    fn texts(self, texts: &BTreeMap<String, String>) -> Self {
        let pairs = texts.iter();
        let Self(pairs) = pairs.fold(Self::default(), |body, (key, text)| {
            body.text(key).text(text)
        });
        self.u32(pairs.len() as u32).bytes(&pairs)
    }
}
