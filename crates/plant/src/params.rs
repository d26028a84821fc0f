//! To come: params.
