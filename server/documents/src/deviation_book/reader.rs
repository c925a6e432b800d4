//! Reader of a book's entries, one month of stored samples at a time.

use super::cards::{CardEnds, Cards};
use super::entry::{Entry, EntryKey, of_azimuth, of_samples};
use binnacle_fleet::adjustments::{self, CompletedOrder};
use binnacle_fleet::analysis::{self, Chunk};
use binnacle_fleet::azimuths::{self, StoredAzimuth};
use binnacle_fleet::logbook;
use binnacle_fleet::models;
use binnacle_platform::db::Db;
use binnacle_platform::error::Result;
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
    /// Azimuths that are not yet read, in order of time.
    azimuths: VecDeque<StoredAzimuth>,
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
        let azimuths = azimuths::of_compass(db, vessel, compass, from, to).await?;
        Ok(BookReader {
            db: db.clone(),
            vessel,
            compass,
            from,
            to,
            ends,
            completed: adjustments::completed(db, vessel, compass).await?,
            left: left.into(),
            azimuths: azimuths.into(),
        })
    }

    /// Returns the entries of the next stretch, maybe empty; `None` after the last.
    pub(super) async fn next(&mut self) -> Result<Option<Vec<Entry>>> {
        let chunk = self.left.pop_front();
        let azimuths = self.azimuths_until(chunk.as_ref().map(|chunk| chunk.to));
        let Some(range) = Range::of(chunk.as_ref(), &azimuths) else {
            return Ok(None);
        };
        let (db, vessel, compass) = (&self.db, self.vessel, self.compass);
        let models = models::list_in_force(db, vessel, compass, range.from, range.to).await?;
        let samples = match chunk {
            Some(chunk) => analysis::chunk(db, vessel, compass, &chunk).await?,
            None => Vec::new(),
        };
        let (from, to, ends) = (self.from, self.to, self.ends.clone());
        let completed = self.completed.clone();
        let made = tokio::task::spawn_blocking(move || {
            let cards = Cards {
                models: &models,
                ends: &ends,
                completed: &completed,
            };
            let mut found = of_samples(samples, cards);
            found.extend(azimuths.iter().map(|stored| of_azimuth(stored, cards)));
            found.retain(|entry| {
                from.is_none_or(|from| entry.time >= from) && to.is_none_or(|to| entry.time < to)
            });
            found.sort_by_key(Entry::key);
            found
        });
        Ok(Some(made.await?))
    }

    /// Takes the azimuths before an instant; all that are left if there is none.
    fn azimuths_until(&mut self, until: Option<Time>) -> Vec<StoredAzimuth> {
        let is_later = |stored: &StoredAzimuth| {
            until.is_some_and(|until| Time(stored.azimuth.time()) >= until)
        };
        let count = self.azimuths.iter().position(is_later);
        let count = count.unwrap_or(self.azimuths.len());
        self.azimuths.drain(..count).collect()
    }

    /// Reads up to `most` entries, behind the one of a key. Returns whether they are all.
    pub(super) async fn at_most(
        &mut self,
        after: Option<EntryKey>,
        most: usize,
    ) -> Result<(Vec<Entry>, bool)> {
        let mut found = Vec::new();
        while let Some(more) = self.next().await? {
            found.extend(more.into_iter().filter(|entry| Some(entry.key()) > after));
            if found.len() > most {
                found.truncate(most);
                return Ok((found, false));
            }
        }
        Ok((found, true))
    }
}

/// Range of time of a stretch.
struct Range {
    from: Time,
    to: Time,
}

impl Range {
    /// Returns the range of a chunk and of azimuths; `None` if there is neither.
    fn of(chunk: Option<&Chunk>, azimuths: &[StoredAzimuth]) -> Option<Range> {
        let times = || azimuths.iter().map(|stored| Time(stored.azimuth.time()));
        let from = chunk
            .map(|chunk| chunk.from)
            .into_iter()
            .chain(times().next());
        let to = chunk
            .map(|chunk| chunk.to)
            .into_iter()
            .chain(times().next_back());
        Some(Range {
            from: from.min()?,
            // A model that was made at the last instant counts.
            to: Time(to.max()?.0.plus_seconds(1e-6)),
        })
    }
}
