//! Which interrupts are requested: a bit for each vector, kept by the peripherals whenever a flag or an enable changes.

/// Numbers of the interrupt vectors (DS40002549, section 14.1). A lower number has priority.
pub(crate) mod vector {
    pub(crate) const INT0: u8 = 1;
    pub(crate) const PCINT0: u8 = 9;
}

/// The requested interrupts.
#[derive(Clone, Debug, Default)]
pub(crate) struct Interrupts {
    requested: u64,
}

impl Interrupts {
    /// Requests a vector or withdraws the request.
    pub(crate) fn set(&mut self, vector: u8, requested: bool) {
        let mask = 1 << (vector & 63);
        if requested {
            self.requested |= mask;
        } else {
            self.requested &= !mask;
        }
    }

    /// The one that is entered next.
    pub(crate) fn first(&self) -> Option<u8> {
        (self.requested != 0).then(|| self.requested.trailing_zeros() as u8)
    }

    /// Any is requested.
    #[inline(always)]
    pub(crate) fn any(&self) -> bool {
        self.requested != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_number_goes_first() {
        let mut interrupts = Interrupts::default();
        interrupts.set(20, true);
        interrupts.set(9, true);
        assert_eq!(interrupts.first(), Some(9));
        interrupts.set(9, false);
        assert_eq!(interrupts.first(), Some(20));
        interrupts.set(20, false);
        assert!(!interrupts.any());
    }
}
