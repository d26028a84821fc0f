//! To come: contact.
