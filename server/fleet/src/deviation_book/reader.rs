//! Reader of a book's entries, one month of stored samples at a time.

use super::entry::{CardEnds, Entry, entries};
use crate::adjustments::{self, CompletedOrder};
use crate::analysis::{self, Chunk};
use crate::logbook;
use crate::models;
use binnacle_compass::result::SampleDiagnostic;
use binnacle_platform::db::Db;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_platform::time::Time;
use std::collections::VecDeque;

/// A compass's book over a range of time, being read.
pub(super) struct BookReader {
    db: Db,
    vessel: VesselId,
    compass: CompassId,
    from: Option<Time>,
    to: Option<Time>,
    ends: CardEnds,
    completed: Vec<CompletedOrder>,
    /// Chunks that are not yet read.
    left: VecDeque<Chunk>,
}

impl BookReader {
    /// Opens the book for entries from one instant until before another.
    pub(super) async fn open(
        db: &Db,
        vessel: VesselId,
        compass: CompassId,
        from: Option<Time>,
        to: Option<Time>,
    ) -> Result<BookReader> {
        let withdrawn = models::card_withdrawn(db, vessel, compass).await?;
        let logbook = logbook::of_compass(db, vessel, compass).await?;
        let work = logbook.iter().filter(|entry| entry.kind.ends_an_epoch());
        let ends = CardEnds {
            work: work.map(|entry| Time(entry.from)).collect(),
            withdrawn: withdrawn.map(|withdrawn| Time(withdrawn.since)),
        };
        let left = analysis::chunks_between(db, vessel, compass, from, to).await?;
        Ok(BookReader {
            db: db.clone(),
            vessel,
            compass,
            from,
            to,
            ends,
            completed: adjustments::completed(db, vessel, compass).await?,
            left: left.into(),
        })
    }

    /// Returns the entries of the next stretch, maybe empty; `None` after the last.
    pub(super) async fn next(&mut self) -> Result<Option<Vec<Entry>>> {
        let Some(chunk) = self.left.pop_front() else {
            return Ok(None);
        };
        let (db, vessel, compass) = (&self.db, self.vessel, self.compass);
        let text = analysis::chunk(db, vessel, compass, &chunk).await?;
        let models = models::list_in_force(db, vessel, compass, chunk.from, chunk.to).await?;
        let (from, to, ends) = (self.from, self.to, self.ends.clone());
        let completed = self.completed.clone();
        let made = tokio::task::spawn_blocking(move || {
            let samples: Vec<SampleDiagnostic> = serde_json::from_str(&text)?;
            let mut found = entries(samples, &models, &ends, &completed);
            found.retain(|entry| {
                from.is_none_or(|from| entry.time >= from) && to.is_none_or(|to| entry.time < to)
            });
            Ok::<_, Error>(found)
        });
        Ok(Some(made.await??))
    }

    /// Reads up to `most` entries. Returns whether they are all.
    pub(super) async fn at_most(&mut self, most: usize) -> Result<(Vec<Entry>, bool)> {
        let mut found = Vec::new();
        while let Some(more) = self.next().await? {
            found.extend(more);
            if found.len() > most {
                found.truncate(most);
                return Ok((found, false));
            }
        }
        Ok((found, true))
    }
}
