//! State of the database's disk, as failed writes show it.

use tokio::sync::watch;

/// State of the disk: full, or not.
#[derive(Debug, Default)]
pub struct Disk {
    full: watch::Sender<bool>,
}

impl Disk {
    /// Records that a write failed for want of space.
    pub fn report_full(&self) {
        self.set(true);
    }

    /// Records that there is space again.
    pub fn report_space(&self) {
        self.set(false);
    }

    /// Returns true from a write that failed for want of space until there is space again.
    pub fn is_full(&self) -> bool {
        *self.full.borrow()
    }

    /// Waits until the disk is full.
    pub async fn wait_until_full(&self) {
        let mut full = self.full.subscribe();
        // The sender is borrowed meanwhile, so that it cannot be gone.
        let _ = full.wait_for(|full| *full).await;
    }

    fn set(&self, full: bool) {
        self.full
            .send_if_modified(|is| std::mem::replace(is, full) != full);
    }
}
