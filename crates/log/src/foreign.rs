//! The messages of an MCAP file that another program wrote: ROS 2's recorder, Foxglove, a script.

use crate::frames::Frames;
use mcap::parse_record;
use mcap::records::{Channel, Record, SchemaHeader};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{McapError, McapResult};
use std::collections::HashMap;
use std::io::Read;

/// Longest record, and what a compressed chunk may hold \[bytes\].
const LONGEST: usize = 64 << 20;

/// A message of another program.
#[derive(Clone, Copy, Debug)]
pub struct Foreign<'a> {
    /// Its topic.
    pub topic: &'a str,
    /// The name of its type.
    pub schema: &'a str,
    /// How its bytes are written: `cdr`, `json`.
    pub encoding: &'a str,
    /// The definition of its type, in the language of `encoding`.
    pub definition: &'a [u8],
    /// When it was recorded \[ns\].
    pub t_ns: u64,
    /// It.
    pub data: &'a [u8],
}

/// Reads a file to its end, or as far as it is whole; then says why it ends there.
pub fn read_foreign(bytes: &[u8], take: impl FnMut(Foreign<'_>)) -> Option<String> {
    read(bytes, take).err().map(|error| error.to_string())
}

fn read(mut bytes: &[u8], mut take: impl FnMut(Foreign<'_>)) -> McapResult<()> {
    let options = LinearReaderOptions::default()
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(LONGEST);
    let mut reader = LinearReader::new_with_options(options);
    reader.add_decompressor(Frames::lz4(LONGEST))?;
    reader.add_decompressor(Frames::zstd(LONGEST))?;
    let mut schemas: HashMap<u16, (SchemaHeader, Vec<u8>)> = HashMap::new();
    let mut channels: HashMap<u16, Channel> = HashMap::new();
    while let Some(event) = reader.next_event() {
        match event? {
            LinearReadEvent::ReadRequest(count) => {
                let read = bytes.read(reader.insert(count)).map_err(McapError::Io)?;
                reader.notify_read(read);
            }
            LinearReadEvent::Record { opcode, data } => match parse_record(opcode, data)? {
                Record::Schema { header, data } => {
                    schemas.insert(header.id, (header, data.into_owned()));
                }
                Record::Channel(channel) => drop(channels.insert(channel.id, channel)),
                Record::Message { header, data } => {
                    let Some(channel) = channels.get(&header.channel_id) else {
                        continue;
                    };
                    let schema = schemas.get(&channel.schema_id);
                    take(Foreign {
                        topic: &channel.topic,
                        schema: schema.map_or("", |(schema, _)| &schema.name),
                        encoding: &channel.message_encoding,
                        definition: schema.map_or(&[], |(_, definition)| definition),
                        t_ns: header.log_time,
                        data: &data,
                    });
                }
                // The index says once more what is known.
                Record::DataEnd(_) => return Ok(()),
                _ => {}
            },
        }
    }
    Ok(())
}
