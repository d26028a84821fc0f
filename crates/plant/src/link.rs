//! To come: link.
