//! Messages of STK500v2: a start byte, a number, the body's length, a token, the body, and the XOR of all of it.

use std::collections::VecDeque;

const START: u8 = 0x1B;
const TOKEN: u8 = 0x0E;
/// Bytes before the body.
const HEAD: usize = 5;
/// Longest body that the boot loader has room for [bytes].
const LONGEST: usize = 275;

/// The message of this number with this body.
pub(crate) fn encode(number: u8, body: &[u8]) -> Vec<u8> {
    let [high, low] = (body.len() as u16).to_be_bytes();
    let mut message = vec![START, number, high, low, TOKEN];
    message.extend_from_slice(body);
    message.push(xor(&message));
    message
}

fn xor(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |sum, byte| sum ^ byte)
}

/// What has arrived, and is not understood yet.
#[derive(Debug, Default)]
pub(crate) struct Inbox(VecDeque<u8>);

impl Inbox {
    pub(crate) fn extend(&mut self, bytes: &[u8]) {
        self.0.extend(bytes);
    }

    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }

    /// The body of the next message of this number; what is none is dropped.
    pub(crate) fn next(&mut self, number: u8) -> Option<Vec<u8>> {
        loop {
            let start = self.0.iter().position(|byte| *byte == START);
            self.0.drain(..start.unwrap_or(self.0.len()));
            let bytes: &[u8] = self.0.make_contiguous();
            let [_, answered, high, low, token, rest @ ..] = bytes else {
                return None;
            };
            let length = usize::from(u16::from_be_bytes([*high, *low]));
            if *token == TOKEN && length <= LONGEST {
                if rest.len() <= length {
                    return None;
                }
                let message = &bytes[..=HEAD + length];
                if xor(message) == 0 {
                    let body = (*answered == number).then(|| message[HEAD..HEAD + length].to_vec());
                    self.0.drain(..=HEAD + length);
                    match body {
                        Some(body) => return Some(body),
                        None => continue,
                    }
                }
            }
            // It only looked like the start of one.
            self.0.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_found_among_noise_and_behind_what_only_looks_like_one() {
        let mut inbox = Inbox::default();
        let wanted = encode(7, &[0x06, 0x00]);
        inbox.extend(b"telemetry\x1b\x07\x00\x02\x0e\x06\x00\x00");
        inbox.extend(&encode(6, &[0x13, 0x00]));
        let (first, second) = wanted.split_at(4);
        inbox.extend(first);
        assert_eq!(inbox.next(7), None);
        inbox.extend(second);
        assert_eq!(inbox.next(7), Some(vec![0x06, 0x00]));
        assert_eq!(inbox.next(7), None);
    }

    #[test]
    fn any_bytes_are_survived() {
        let mut inbox = Inbox::default();
        let mut state = 1_u32;
        for _ in 0..200_000 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            // Many starts and tokens among them.
            let byte = [START, TOKEN, 0, (state >> 16) as u8][(state >> 30) as usize];
            inbox.extend(&[byte]);
            inbox.next(1);
            assert!(inbox.0.len() <= HEAD + LONGEST + 1);
        }
    }
}
