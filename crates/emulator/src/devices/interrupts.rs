//! Which interrupts are requested: a bit for each vector, kept by the peripherals whenever a flag or an enable changes.

/// The requested interrupts.
#[derive(Clone, Debug)]
pub(crate) struct Interrupts {
    requested: u64,
    now: u64,
    /// The cycle in which each vector was requested last.
    since: [u64; 64],
}

impl Default for Interrupts {
    fn default() -> Self {
        Interrupts {
            requested: 0,
            now: 0,
            since: [0; 64],
        }
    }
}

impl Interrupts {
    /// What is requested from here on is requested in this cycle.
    #[inline(always)]
    pub(crate) fn set_time(&mut self, cycle: u64) {
        self.now = cycle;
    }

    /// The cycle in which a vector was requested last, entered since or not.
    pub(crate) fn since(&self, vector: u8) -> u64 {
        self.since[usize::from(vector & 63)]
    }

    /// Requests a vector or withdraws the request.
    pub(crate) fn set(&mut self, vector: u8, requested: bool) {
        let mask = 1 << (vector & 63);
        if requested {
            if self.requested & mask == 0 {
                self.since[usize::from(vector & 63)] = self.now;
            }
            self.requested |= mask;
        } else {
            self.requested &= !mask;
        }
    }

    /// The same for vectors from `first` on, those in `mask`: the ones in `requested`, and no others.
    pub(crate) fn set_all(&mut self, first: u8, mask: u8, requested: u8) {
        let requested = u64::from(requested) << first;
        let mut raised = requested & !self.requested;
        while raised != 0 {
            self.since[raised.trailing_zeros() as usize] = self.now;
            raised &= raised - 1;
        }
        self.requested = self.requested & !(u64::from(mask) << first) | requested;
    }

    /// Withdraws all requests.
    pub(crate) fn clear(&mut self) {
        self.requested = 0;
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

    #[test]
    fn a_request_is_as_old_as_its_first_cause() {
        let mut interrupts = Interrupts::default();
        for (cycle, requested) in [(10, true), (20, true), (30, false)] {
            interrupts.set_time(cycle);
            interrupts.set(5, requested);
        }
        assert_eq!(interrupts.since(5), 10);
        interrupts.set_time(40);
        interrupts.set(5, true);
        assert_eq!(interrupts.since(5), 40);
    }
}
