//! Data shared by interrupt handlers and the loop: values that cannot be read or written in halves.
//!
//! The chip moves a byte at a time. A [`Byte`] may therefore be accessed from anywhere, a [`Guarded`] value only where
//! no interrupt can come in between: in a handler, or in the loop within `avr_device::interrupt::free`.

use core::cell::UnsafeCell;

pub(super) use avr_device::interrupt::CriticalSection;

/// A shared byte.
pub(super) struct Byte(UnsafeCell<u8>);

// SAFETY: one core, and each access is a single instruction.
unsafe impl Sync for Byte {}

impl Byte {
    pub(super) const fn new(value: u8) -> Self {
        Self(UnsafeCell::new(value))
    }

    #[inline(always)]
    pub(super) fn get(&self) -> u8 {
        // SAFETY: valid for as long as the cell; volatile, since a handler may have changed it.
        unsafe { self.0.get().read_volatile() }
    }

    #[inline(always)]
    pub(super) fn set(&self, value: u8) {
        // SAFETY: as above.
        unsafe { self.0.get().write_volatile(value) }
    }
}

/// A shared value of several bytes.
pub(super) struct Guarded<T>(UnsafeCell<T>);

/// A shared word.
pub(super) type Word = Guarded<u16>;

// SAFETY: one core, and the holder of a `CriticalSection` is not interrupted.
unsafe impl<T: Copy> Sync for Guarded<T> {}

impl<T: Copy> Guarded<T> {
    pub(super) const fn new(value: T) -> Self {
        Self(UnsafeCell::new(value))
    }

    #[inline(always)]
    pub(super) fn get(&self, _: CriticalSection<'_>) -> T {
        // SAFETY: nothing writes meanwhile.
        unsafe { self.0.get().read_volatile() }
    }

    #[inline(always)]
    pub(super) fn set(&self, value: T, _: CriticalSection<'_>) {
        // SAFETY: nothing reads or writes meanwhile.
        unsafe { self.0.get().write_volatile(value) }
    }

    /// Changes a part of it. `change` must not call this again.
    #[inline(always)]
    pub(super) fn update(&self, change: impl FnOnce(&mut T), _: CriticalSection<'_>) {
        // SAFETY: as above, and no reference to it is left.
        change(unsafe { &mut *self.0.get() });
    }
}
