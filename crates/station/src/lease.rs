//! The session's lease of control, shared by the pages' connections: a page that is closed releases it.

use rumbo_session::{ControlView, Order, PageId, Seat};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::watch;

/// The one lease of control.
#[derive(Clone, Debug, Default)]
pub(crate) struct SharedLease {
    lease: Arc<Mutex<rumbo_session::Lease>>,
    changed: watch::Sender<()>,
}

impl SharedLease {
    fn lock(&self) -> MutexGuard<'_, rumbo_session::Lease> {
        self.lease.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Wakes its holder when control has changed hands.
    pub(crate) fn subscribe(&self) -> watch::Receiver<()> {
        self.changed.subscribe()
    }

    /// Whether this page has control, or may have it since nobody else has.
    pub(crate) fn drives(&self, page: PageId) -> bool {
        matches!(self.lock().view(page).seat, Seat::Driver | Seat::Free)
    }

    /// Admits a page; `None`: too many are open.
    pub(crate) fn join(&self, may_control: bool) -> Option<Membership> {
        let page = self.lock().join(may_control)?;
        self.changed.send_replace(());
        let lease = self.clone();
        Some(Membership { page, lease })
    }
}

/// A page's membership; dropping it releases control, if the page had it.
#[derive(Debug)]
pub(crate) struct Membership {
    page: PageId,
    lease: SharedLease,
}

impl Membership {
    /// Whether the page may give this order; why not otherwise.
    pub(crate) fn admit(&self, order: &Order) -> Result<(), &'static str> {
        let mut lease = self.lease.lock();
        let before = lease.view(self.page).holder;
        let admitted = lease.admit(order, self.page);
        if lease.view(self.page).holder != before {
            self.lease.changed.send_replace(());
        }
        admitted
    }

    /// What the page is shown.
    pub(crate) fn view(&self) -> ControlView {
        self.lease.lock().view(self.page)
    }
}

impl Drop for Membership {
    fn drop(&mut self) {
        self.lease.lock().leave(self.page);
        self.lease.changed.send_replace(());
    }
}
