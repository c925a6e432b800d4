//! Workloads, each with connections of its own, so that none holds up another.
//!
//! Invariant: a request waits for a connection only as long as its client can be expected to.
//! Thus requests beyond what the database can do are refused soon, and the others go on.

use std::time::Duration;

/// Workload that needs the database.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Workload {
    /// Requests of agents.
    Ingest,
    /// Requests of people and of their programs.
    People,
    /// Analyses, deliveries, and commands.
    Background,
}

/// Connections of a workload, at one moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Usage {
    /// The workload.
    pub workload: Workload,
    /// Number of connections in use.
    pub used: usize,
    /// Maximum number of connections.
    pub most: usize,
}

impl Workload {
    /// All workloads, in the order of their pools.
    pub(super) const ALL: [Workload; 3] =
        [Workload::Ingest, Workload::People, Workload::Background];

    /// Returns the name of the workload, as metrics have it.
    pub fn name(self) -> &'static str {
        match self {
            Workload::Ingest => "ingest",
            Workload::People => "people",
            Workload::Background => "background",
        }
    }

    /// Maximum number of connections to PostgreSQL. Three processes use its default of 100
    /// connections. Agents have most: their commits share one write to the disk.
    pub(super) fn connections(self) -> u32 {
        match self {
            Workload::Ingest => 16,
            Workload::People | Workload::Background => 8,
        }
    }

    /// Number of SQLite's readers; the one writer serves all.
    pub(super) fn readers(self) -> u32 {
        match self {
            Workload::Ingest | Workload::Background => 2,
            Workload::People => 4,
        }
    }

    /// Longest wait for a connection to PostgreSQL, which may be away.
    pub(super) fn patience_on_postgres(self) -> Duration {
        match self {
            Workload::Ingest | Workload::People => Duration::from_millis(900),
            Workload::Background => Duration::from_secs(30),
        }
    }

    /// Longest wait for a turn on SQLite, whose one writer may have a large analysis to store.
    pub(super) fn patience_on_sqlite(self) -> Duration {
        match self {
            Workload::Ingest | Workload::People => Duration::from_secs(5),
            Workload::Background => Duration::from_secs(30),
        }
    }
}
