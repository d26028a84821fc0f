//! The link: frames, messages and text, as the documents say.

#[path = "../common/mod.rs"]
mod common;
mod messages;
mod protocol_doc;
mod stream;
mod text;
