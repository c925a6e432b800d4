//! Merge of recordings by the times of their lines.
//!
//! Lines of one recording keep their order. At equal times positions go first, then compasses, so
//! that the order in which recordings are given changes nothing. A recording is opened when its first time is reached
//! and closed at its end, so that a year of them needs few open files.

use super::planning::Planned;
use anyhow::Context;
use binnacle_compass::time::Timestamp;
use binnacle_nmea::Tally;
use binnacle_observation::Observation;
use binnacle_observation::recording::{
    Instruments, NotUnderstood, Recorded, RecordingReader, RollOver,
};
use binnacle_observation::signalk::DeltaCounts;
use std::collections::VecDeque;
use std::path::PathBuf;

/// Counts and findings of a recording that was read.
#[derive(Debug)]
pub(super) struct Finished {
    pub(super) path: PathBuf,
    pub(super) sentences: Tally,
    pub(super) values: DeltaCounts,
    pub(super) not_understood: NotUnderstood,
    pub(super) roll_over: Option<RollOver>,
    /// Reason why it ended before its end.
    pub(super) problem: Option<String>,
}

/// Time, instruments and place among the open recordings.
type Turn = (Option<Timestamp>, Instruments, usize);

/// An open recording, with the observations that wait for their turn.
struct Open {
    planned: Planned,
    reader: RecordingReader,
    waiting: VecDeque<Recorded>,
}

/// Reads recordings and passes their observations to `each` in the order of their times.
///
/// # Errors
/// Fails when a recording cannot be opened.
pub(super) fn merge(
    planned: Vec<Planned>,
    mut each: impl FnMut(&Observation),
) -> anyhow::Result<Vec<Finished>> {
    let mut planned: VecDeque<Planned> = planned.into();
    let mut open: Vec<Open> = Vec::new();
    let mut finished = Vec::new();
    loop {
        fill(&mut open, &mut finished);
        let first = open.iter().map(Open::time).min();
        let next = planned.front().map(|next| next.start);
        if let Some(start) = next
            && first.is_none_or(|first| start <= first)
        {
            open.extend(planned.pop_front().map(Open::new).transpose()?);
            continue;
        }
        let turn = |place: usize| open[place].turn(place);
        let Some(place) = (0..open.len()).min_by_key(|place| turn(*place)) else {
            return Ok(finished);
        };
        let others = (0..open.len()).filter(|other| *other != place);
        let next = next.map(|start| (start, Instruments::Others, usize::MAX));
        let until = others.map(turn).chain(next).min();
        let recording = &mut open[place];
        while !recording.waiting.is_empty()
            && until.is_none_or(|until| recording.turn(place) < until)
        {
            if let Some(recorded) = recording.waiting.pop_front() {
                each(&recorded.seen);
            }
        }
    }
}

/// Reads on where nothing waits, and closes what is at its end.
fn fill(open: &mut Vec<Open>, finished: &mut Vec<Finished>) {
    let mut place = 0;
    while place < open.len() {
        if open[place].fill() {
            place += 1;
        } else {
            finished.push(open.remove(place).finish());
        }
    }
}

impl Open {
    fn new(planned: Planned) -> anyhow::Result<Open> {
        let reader = RecordingReader::open(&planned.path, "replay".into(), planned.plan)
            .with_context(|| planned.path.display().to_string())?;
        Ok(Open {
            planned,
            reader,
            waiting: VecDeque::new(),
        })
    }

    /// Returns the time of the first observation that waits. Lines before the first time belong
    /// to it.
    fn time(&self) -> Option<Timestamp> {
        self.waiting
            .front()
            .and_then(|recorded| recorded.at)
            .or(self.planned.start)
    }

    /// Returns the order in which recordings take turns.
    fn turn(&self, place: usize) -> Turn {
        (self.time(), self.planned.instruments, place)
    }

    /// Reads until something waits. Returns whether something does.
    fn fill(&mut self) -> bool {
        while self.waiting.is_empty() {
            let Some(chunk) = self.reader.next_chunk() else {
                return false;
            };
            self.waiting = chunk.recorded.into();
        }
        true
    }

    fn finish(mut self) -> Finished {
        let problem = self.reader.problem().map(str::to_owned);
        let decoder = self.reader.decoder();
        Finished {
            path: self.planned.path,
            sentences: decoder.take_tally(),
            values: decoder.take_values(),
            not_understood: decoder.take_not_understood(),
            roll_over: decoder.roll_over(),
            problem,
        }
    }
}
