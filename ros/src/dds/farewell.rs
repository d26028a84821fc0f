//! The end of a participant, said in a way that Fast DDS understands.
//!
//! RustDDS 0.15.1 names who ends in the payload of a sample. Fast DDS reads it only beside the data, as `PID_KEY_HASH`
//! (`MessageReceiver::proc_Submsg_Data`), and keeps writers and readers until their lease is over, for 50 s. So the last
//! sample of the participant's discovery (RTPS 2.5, 8.5.3) is made here: a DATA submessage without a payload. It is sent
//! where RustDDS sends those before it, once that has ended.
//!
//! Beside it, since it is of the same group of addresses: whether the first of these samples can reach anybody.

use crate::bridge::Reach;
use rustdds::GUID;
use std::io;
use std::net::{Ipv4Addr, UdpSocket};

/// Ports (RTPS 2.5, 9.6.2): the first, those of a domain, and from its first one to those of the participants.
const FIRST: u16 = 7_400;
const OF_DOMAIN: u16 = 250;
const TO_PARTICIPANTS: u16 = 10;
/// Participants of a computer that are looked for, each with two ports.
const PARTICIPANTS: u16 = 100;
const GROUP: Ipv4Addr = Ipv4Addr::new(239, 255, 0, 1);
/// Of RTPS, and the vendor's number of RustDDS.
const VERSION: [u8; 2] = [2, 4];
const VENDOR: [u8; 2] = [0x01, 0x12];
const DATA: u8 = 0x15;
/// Little-endian, with parameters beside the data.
const FLAGS: u8 = 0x03;
/// The built-in reader and writer of participants.
const READER: [u8; 4] = [0, 1, 0, 0xc7];
const WRITER: [u8; 4] = [0, 1, 0, 0xc2];
/// Parameters.
const KEY_HASH: u16 = 0x70;
const STATUS_INFO: u16 = 0x71;
const SENTINEL: u16 = 1;
/// Disposed and unregistered.
const GONE: [u8; 4] = [0, 0, 0, 3];
/// Newer than any sample before it; of 64 bits, the high ones first.
const NUMBER: [u32; 2] = [0, i32::MAX as u32];

/// Says so when it is dropped.
#[derive(Debug)]
pub(super) struct Farewell {
    pub(super) participant: GUID,
    pub(super) domain: u16,
    pub(super) reach: Reach,
}

/// Whether announcements reach others, as far as this computer can tell.
pub(super) fn multicast(reach: Reach) -> io::Result<()> {
    let interface = match reach {
        Reach::Computer => Ipv4Addr::LOCALHOST,
        Reach::Networks => Ipv4Addr::UNSPECIFIED,
    };
    join_on(interface)
}

fn join_on(interface: Ipv4Addr) -> io::Result<()> {
    UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))?.join_multicast_v4(&GROUP, &interface)
}

impl Farewell {
    fn message(&self) -> Vec<u8> {
        let guid = self.participant.to_bytes();
        let parameter = |id: u16, value: &[u8]| {
            let length = value.len() as u16;
            [&id.to_le_bytes(), &length.to_le_bytes(), value].concat()
        };
        let number = NUMBER.map(u32::to_le_bytes);
        let data = [
            // No extra flags; the parameters come 16 bytes later.
            &[0, 0, 16, 0],
            &READER[..],
            &WRITER,
            number.as_flattened(),
            &parameter(KEY_HASH, &guid),
            &parameter(STATUS_INFO, &GONE),
            &parameter(SENTINEL, &[]),
        ]
        .concat();
        let head = [b"RTPS", &VERSION[..], &VENDOR, &guid[..12]];
        let length = (data.len() as u16).to_le_bytes();
        [&head.concat()[..], &[DATA, FLAGS], &length, &data].concat()
    }

    fn say(&self) -> io::Result<()> {
        let message = self.message();
        let first = FIRST + OF_DOMAIN * self.domain;
        let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))?;
        for participant in 0..PARTICIPANTS {
            let port = first.saturating_add(TO_PARTICIPANTS + 2 * participant);
            // Nobody needs to be there.
            let _ = socket.send_to(&message, (Ipv4Addr::LOCALHOST, port));
        }
        if self.reach == Reach::Networks {
            socket.send_to(&message, (GROUP, first))?;
        }
        Ok(())
    }
}

impl Drop for Farewell {
    fn drop(&mut self) {
        // Others hear of it at the end of the lease then.
        let _ = self.say();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_is_multicast_on_this_computer_and_none_on_an_interface_that_is_not_there() {
        assert!(multicast(Reach::Computer).is_ok());
        assert!(join_on(Ipv4Addr::new(203, 0, 113, 1)).is_err());
    }

    #[test]
    fn the_last_sample_names_the_participant_beside_the_data() {
        let guid: Vec<u8> = (1..=16).collect();
        let farewell = Farewell {
            participant: GUID::from_bytes(guid.clone().try_into().unwrap()),
            domain: 0,
            reach: Reach::Computer,
        };
        let message = farewell.message();
        let (head, data) = message.split_at(20);
        assert_eq!(head, [b"RTPS\x02\x04\x01\x12", &guid[..12]].concat());
        let key = [b"\x70\x00\x10\x00", &guid[..]].concat();
        let expected = [
            &b"\x15\x03\x34\x00"[..],
            b"\x00\x00\x10\x00",
            b"\x00\x01\x00\xc7",
            b"\x00\x01\x00\xc2",
            b"\x00\x00\x00\x00\xff\xff\xff\x7f",
            &key,
            b"\x71\x00\x04\x00\x00\x00\x00\x03",
            b"\x01\x00\x00\x00",
        ];
        assert_eq!(data, expected.concat());
        // It is not sent.
        std::mem::forget(farewell);
    }
}
