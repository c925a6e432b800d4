//! Analysis of a compass as a fold over segments, from the last state that is kept.
//!
//! Invariant: whatever is kept of earlier analyses, the result is that of the whole log.

use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::result::{Analysis, SampleDiagnostic};
use binnacle_compass::sample::Sample;
use binnacle_compass::segment::Segment;
use binnacle_compass::time::Timestamp;
use binnacle_fleet::analysis::input::{self, Hash, StoredInput};
use binnacle_fleet::analysis::segments::{self, KEPT_STATES, KnownSegment, NewSegment};
use binnacle_platform::db::Db;
use binnacle_platform::error::Result;
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_priors::VesselPrior;
use binnacle_tracking::{Part, Voyage};
use std::sync::Arc;

/// Settled segments whose samples an analysis has besides those that are not settled.
const SHOWN_SEGMENTS: usize = 6;

/// Outcome of a fold.
pub(super) enum Folded {
    /// The input is that of the last analysis.
    Unchanged,
    /// Another analysis.
    New(Box<NewAnalysis>),
}

/// Analysis with what is kept of it.
pub(super) struct NewAnalysis {
    /// Hash of the input.
    pub(super) input_hash: String,
    /// Analysis with the samples of three months, and of the time that was asked for.
    pub(super) analysis: Analysis,
    /// Segments that were derived anew.
    pub(super) segments: Vec<NewSegment>,
}

/// Input of a fold.
struct Log {
    stored: StoredInput,
    prior: VesselPrior,
    known: Vec<KnownSegment>,
    /// Time from which the samples are asked for.
    samples_from: Option<Timestamp>,
}

/// Place from which a fold goes on.
struct Resumed {
    /// Number of segments that are read already.
    done: usize,
    /// State at their end.
    state: Vec<u8>,
    /// Diagnoses that were settled lately.
    lately: Vec<SampleDiagnostic>,
}

/// Segments from a place on, with their samples and keys.
struct Decoded {
    from: usize,
    samples: Vec<Sample>,
    /// Hashes of the samples of all segments, and their keys.
    hashes: Vec<Hash>,
    keys: Vec<Hash>,
}

/// Analyses a compass, unless its input is that of the last analysis. The analysis has the samples
/// from a time on, where one is given.
pub(super) async fn fold(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    stored: StoredInput,
    prior: VesselPrior,
    last_hash: Option<String>,
    samples_from: Option<Timestamp>,
) -> Result<Folded> {
    let log = Arc::new(Log {
        stored,
        prior,
        samples_from,
        known: segments::list(db, vessel, compass).await?,
    });
    let unread = log.unread()?;
    let mut resumes = true;
    loop {
        // A later state may serve, too: the batches of the segments before it are not all known.
        let begin = if resumes { log.last_state(unread) } else { 0 };
        let from = begin.checked_sub(1).and_then(|last| log.stored.end(last));
        let batches = input::load_batches(db, vessel, compass, from, None).await?;
        let decoding = Arc::clone(&log);
        let decoded = tokio::task::spawn_blocking(move || decoding.decode(begin, &batches));
        let decoded = decoded.await??;
        if log.is_complete(&decoded) && last_hash == decoded.keys.last().map(Hash::to_string) {
            log.note_batches(db, vessel, compass, &decoded).await?;
            return Ok(Folded::Unchanged);
        }
        let resumed = match log.last_state(log.same_keys(&decoded)) {
            done if resumes && done > 0 => log.resume(db, vessel, compass, done).await?,
            _ => None,
        };
        if resumed.is_none() && begin > 0 {
            resumes = false;
            continue;
        }
        log.note_batches(db, vessel, compass, &decoded).await?;
        let folding = Arc::clone(&log);
        let folded = tokio::task::spawn_blocking(move || folding.fold(&decoded, resumed));
        if let Some(analysis) = folded.await?? {
            return Ok(Folded::New(Box::new(analysis)));
        }
        // The ship is of another grade than when the state was kept, or its form is another.
        resumes = false;
    }
}

impl Log {
    /// Returns the number of the first segments whose batches and keys are known.
    fn unread(&self) -> anyhow::Result<usize> {
        let mut before = self.stored.first_key(self.prior.text_from_fleet())?;
        for (place, logged) in self.stored.segments.iter().enumerate() {
            let known = self.known.get(place);
            let Some(known) = known
                .filter(|known| (known.segment, known.batches) == (logged.segment, logged.batches))
            else {
                return Ok(place);
            };
            before = self.stored.key(before, place, known.samples)?;
            if before != known.key {
                return Ok(place);
            }
        }
        Ok(self.stored.segments.len())
    }

    /// Returns the number of segments until the last state among the first ones.
    fn last_state(&self, of_first: usize) -> usize {
        let known = &self.known[..of_first.min(self.known.len())];
        known
            .iter()
            .rposition(|known| known.has_state)
            .map_or(0, |place| place + 1)
    }

    /// Returns the place of the first segment whose settled samples the analysis has.
    fn first_shown(&self) -> usize {
        let count = self.stored.segments.len();
        let usual = count.saturating_sub(1 + SHOWN_SEGMENTS);
        let is_asked_for = |from: Timestamp, place: usize| {
            let end = self.stored.end(place);
            end.is_none_or(|end| from < end)
        };
        let asked = self
            .samples_from
            .and_then(|from| (0..count).find(|place| is_asked_for(from, *place)));
        asked.map_or(usual, |asked| asked.min(usual))
    }

    /// Decodes batches, and computes all keys.
    fn decode(&self, from: usize, batches: &[(Vec<u8>,)]) -> anyhow::Result<Decoded> {
        let samples = input::decode(batches)?;
        let mut hashes: Vec<Hash> = self.known[..from].iter().map(|k| k.samples).collect();
        for own in self.stored.split(from, &samples) {
            hashes.push(input::hash_samples(own)?);
        }
        let mut before = self.stored.first_key(self.prior.text_from_fleet())?;
        let mut keys = Vec::with_capacity(hashes.len());
        for (place, hash) in hashes.iter().enumerate() {
            before = self.stored.key(before, place, *hash)?;
            keys.push(before);
        }
        Ok(Decoded {
            from,
            samples,
            hashes,
            keys,
        })
    }

    /// Returns the number of the first segments whose rows have the right keys.
    fn same_keys(&self, decoded: &Decoded) -> usize {
        let rows = self.known.iter().zip(&self.stored.segments);
        let rows = rows.zip(&decoded.keys);
        rows.take_while(|((known, logged), key)| {
            known.segment == logged.segment && known.key == **key
        })
        .count()
    }

    /// Tells whether each segment has a row with the right key, and none is besides.
    fn is_complete(&self, decoded: &Decoded) -> bool {
        self.known.len() == decoded.keys.len() && self.same_keys(decoded) == decoded.keys.len()
    }

    /// Notes the batches of segments that have the samples that they had.
    async fn note_batches(
        &self,
        db: &Db,
        vessel: VesselId,
        compass: CompassId,
        decoded: &Decoded,
    ) -> Result<()> {
        let same = self.same_keys(decoded);
        let rows = self.known.iter().zip(&self.stored.segments).take(same);
        let moved = rows.filter(|(known, logged)| known.batches != logged.batches);
        let moved: Vec<(Segment, Hash)> = moved
            .map(|(_, logged)| (logged.segment, logged.batches))
            .collect();
        segments::note_batches(db, vessel, compass, &moved).await
    }

    /// Reads what a fold goes on from; none if it is damaged.
    async fn resume(
        &self,
        db: &Db,
        vessel: VesselId,
        compass: CompassId,
        done: usize,
    ) -> Result<Option<Resumed>> {
        let last = self.known[done - 1].segment;
        let Some(state) = segments::find_state(db, vessel, compass, last).await? else {
            return Ok(None);
        };
        let mut lately = Vec::new();
        for known in &self.known[self.first_shown().min(done)..done] {
            match segments::find_settled(db, vessel, compass, known.segment).await? {
                Some(settled) => lately.extend(settled),
                None => return Ok(None),
            }
        }
        Ok(Some(Resumed {
            done,
            state,
            lately,
        }))
    }

    /// Folds the segments that a state has not read; none if the state does not serve.
    fn fold(
        &self,
        decoded: &Decoded,
        resumed: Option<Resumed>,
    ) -> anyhow::Result<Option<NewAnalysis>> {
        let done = resumed.as_ref().map_or(0, |resumed| resumed.done);
        let split = self.stored.split(decoded.from, &decoded.samples);
        let split = &split[done - decoded.from..];
        let all: usize = split.iter().map(|own| own.len()).sum();
        let unread = &decoded.samples[decoded.samples.len() - all..];
        let (mut voyage, mut samples) = if let Some(resumed) = resumed {
            let voyage: Option<Voyage> = postcard::from_bytes(&resumed.state).ok();
            let is_same = |voyage: &Voyage| voyage.grade_with(unread) == voyage.grade();
            let Some(voyage) = voyage.filter(is_same) else {
                return Ok(None);
            };
            (voyage, resumed.lately)
        } else {
            let (settings, prior) = (&self.stored.settings, &self.prior.prior);
            let voyage = Voyage::begin(settings, prior, ReferenceGrade::of(unread));
            (voyage, Vec::new())
        };
        let mut new = Vec::with_capacity(split.len());
        let (last, closed) = split
            .split_last()
            .map_or((&[][..], split), |(l, c)| (*l, c));
        for (nth, own) in closed.iter().enumerate() {
            let settled = self.advance(&mut voyage, own);
            let is_kept = closed.len() - nth <= KEPT_STATES;
            let state = is_kept
                .then(|| postcard::to_allocvec(&voyage))
                .transpose()?;
            let row = self.row(decoded, done + nth);
            new.push(NewSegment::new(row, &settled, state.as_deref())?);
            if done + nth >= self.first_shown() {
                samples.extend(settled);
            }
        }
        // Samples of a batch may lie in a segment in which none begins or ends.
        let segment = last.last().map(|sample| Segment::of(sample.time));
        let open = last.partition_point(|sample| Some(Segment::of(sample.time)) < segment);
        let mut own = self.advance(&mut voyage, &last[..open]);
        let analysis = voyage.report(&self.part(&last[open..], None));
        own.extend(analysis.samples.iter().cloned());
        let place = done + closed.len();
        new.push(NewSegment::new(self.row(decoded, place), &own, None)?);
        samples.extend(own);
        Ok(Some(NewAnalysis {
            input_hash: decoded.keys[place].to_string(),
            analysis: Analysis {
                samples,
                ..analysis
            },
            segments: new,
        }))
    }

    /// Reads samples of segments that are over. Returns the diagnoses that are settled by them.
    fn advance(&self, voyage: &mut Voyage, samples: &[Sample]) -> Vec<SampleDiagnostic> {
        let segment = |sample: &Sample| Segment::of(sample.time);
        let parts = samples.chunk_by(|a, b| segment(a) == segment(b));
        let settled = parts.map(|own| voyage.advance(&self.part(own, segment(&own[0]).end())));
        settled.flatten().collect()
    }

    fn part<'a>(&self, samples: &'a [Sample], end: Option<Timestamp>) -> Part<'a> {
        Part::new(samples, &self.stored.logbook, &self.stored.azimuths, end)
    }

    /// Returns the hashes of a segment with a place.
    fn row(&self, decoded: &Decoded, place: usize) -> KnownSegment {
        let logged = self.stored.segments[place];
        KnownSegment {
            segment: logged.segment,
            batches: logged.batches,
            samples: decoded.hashes[place],
            key: decoded.keys[place],
            has_state: false,
        }
    }
}
