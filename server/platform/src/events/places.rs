//! Places for streams of live events, so many for each user.

use crate::ids::UserId;
use metrics::gauge;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::{Arc, Mutex, PoisonError};

/// Maximum number of streams of a user: each tab of the dashboard has one.
pub const STREAMS_OF_USER: usize = 32;

/// Streams that are open, by user.
#[derive(Clone, Debug, Default)]
pub struct Places(Arc<Mutex<HashMap<UserId, usize>>>);

/// Place of one stream, free again when it is dropped.
#[derive(Debug)]
pub struct Place {
    user: UserId,
    places: Places,
}

impl Places {
    /// Takes a place for a user's stream; `None` if the user has too many.
    pub fn take(&self, user: UserId) -> Option<Place> {
        let mut open = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let count = open.entry(user).or_default();
        if *count >= STREAMS_OF_USER {
            return None;
        }
        *count += 1;
        gauge!("binnacle_event_streams").increment(1.0);
        Some(Place {
            user,
            places: self.clone(),
        })
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        gauge!("binnacle_event_streams").decrement(1.0);
        let open = &self.places.0;
        let mut open = open.lock().unwrap_or_else(PoisonError::into_inner);
        if let Entry::Occupied(mut entry) = open.entry(self.user) {
            *entry.get_mut() -= 1;
            if *entry.get() == 0 {
                entry.remove();
            }
        }
    }
}
