//! Logbook entries as hypotheses.

use super::tracker::Tracker;
use crate::constants::TRUSTED;
use crate::hypotheses::hypothesis::Begin;
use crate::hypotheses::kinds::{KINDS, Kind};
use binnacle_compass::logbook::LogbookKind;

impl Tracker {
    /// Takes note of a logbook entry since the last row.
    pub(crate) fn note(&mut self, kind: LogbookKind) {
        let Some(row) = self.rows.back().cloned() else {
            return;
        };
        let begin = Begin {
            time: row.time,
            ship: self.ship(&row),
            row: row.clone(),
            in_port: !matches!(kind, LogbookKind::Lightning | LogbookKind::Shock),
        };
        if kind.ends_an_epoch() {
            for hypothesis in &mut self.bank {
                hypothesis.renew(kind);
            }
            self.checkpoints.clear();
            self.tried.clear();
            self.sums = self.sums.restarted();
        }
        let mut more = Vec::new();
        for row in &KINDS {
            let Some(probability) = row.kind.beside(kind) else {
                continue;
            };
            for hypothesis in &mut self.bank {
                more.push(hypothesis.with_event(row.kind, &begin, probability.ln()));
                hypothesis.log_prior += (1.0 - probability).ln();
            }
        }
        self.bank.extend(more);
        self.limit();
        self.learning.restart(&self.bank[0]);
    }

    /// Takes note that a cargo was discharged by the logbook.
    pub(crate) fn note_discharge(&mut self) {
        let Some(row) = self.rows.back().cloned() else {
            return;
        };
        let begin = Begin {
            time: row.time,
            ship: self.ship(&row),
            row: row.clone(),
            in_port: true,
        };
        let mut more = Vec::new();
        for hypothesis in &mut self.bank {
            let lasting = hypothesis
                .events
                .iter()
                .rposition(|e| e.kind == Kind::Cargo && e.until.is_none());
            if let Some(event) = lasting {
                more.push(hypothesis.with_end(event, &begin, TRUSTED.ln()));
                hypothesis.log_prior += (1.0 - TRUSTED).ln();
            }
        }
        self.bank.extend(more);
        self.limit();
    }
}
