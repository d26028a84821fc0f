//! Rumbo's station: link, session and web dashboard.
