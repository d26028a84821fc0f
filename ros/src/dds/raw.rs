//! Samples of RustDDS as bytes: the messages are encoded already.

use rustdds::RepresentationIdentifier;
use rustdds::bytes::Bytes;
use rustdds::no_key::{Decode, DefaultDecoder, DeserializerAdapter, SerializerAdapter};
use std::convert::Infallible;

/// Data as they are.
#[derive(Clone, Debug)]
pub(super) struct Raw {
    pub(super) encoding: RepresentationIdentifier,
    pub(super) body: Bytes,
}

/// Passes data on as they are.
#[derive(Clone)]
pub(super) struct AsIs;

impl SerializerAdapter<Raw> for AsIs {
    type Error = Infallible;

    fn output_encoding() -> RepresentationIdentifier {
        RepresentationIdentifier::CDR_LE
    }

    fn to_bytes(value: &Raw) -> Result<Bytes, Infallible> {
        Ok(value.body.clone())
    }
}

impl DeserializerAdapter<Raw> for AsIs {
    type Error = Infallible;
    type Decoded = Raw;

    fn supported_encodings() -> &'static [RepresentationIdentifier] {
        &[
            RepresentationIdentifier::CDR_LE,
            RepresentationIdentifier::CDR_BE,
        ]
    }

    fn transform_decoded(decoded: Raw) -> Raw {
        decoded
    }
}

impl DefaultDecoder<Raw> for AsIs {
    type Decoder = Self;
    const DECODER: Self = Self;
}

impl Decode<'_, Raw> for AsIs {
    type Error = Infallible;

    fn decode_bytes(
        self,
        input_bytes: &[u8],
        encoding: RepresentationIdentifier,
    ) -> Result<Raw, Infallible> {
        let body = Bytes::copy_from_slice(input_bytes);
        Ok(Raw { encoding, body })
    }
}
