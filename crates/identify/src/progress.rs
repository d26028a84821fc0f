//! How far a fit is, and whether it goes on.

use std::sync::atomic::AtomicBool;

/// What a fit reports to while it runs, and asks.
#[derive(Clone, Copy)]
pub struct FitProgress<'a> {
    /// Takes the share of the work that is done, 0 to 1.
    pub report: &'a dyn Fn(f64),
    /// Set when the fit is to end, within about a second: with [`Interrupted`](crate::IdentifyError::Interrupted).
    pub stop: &'a AtomicBool,
}

/// Of what nobody stops.
static GOES_ON: AtomicBool = AtomicBool::new(false);

impl<'a> FitProgress<'a> {
    /// Reports to this function, until the end.
    pub fn to(report: &'a dyn Fn(f64)) -> Self {
        Self {
            report,
            stop: &GOES_ON,
        }
    }

    /// Reports to nobody, until the end.
    #[must_use]
    pub fn none() -> Self {
        Self::to(&|_| {})
    }
}
