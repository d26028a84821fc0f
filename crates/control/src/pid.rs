//! pid
