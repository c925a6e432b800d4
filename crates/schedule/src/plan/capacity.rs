//! Capacity that a plan leaves with the firms.

use super::candidates::Candidates;
use super::crews::{self, Crew};
use super::jobs::Job;
use super::quote;
use crate::input::Firm;
use crate::ports::PortCode;
use crate::solve::{Appointment, Room, Wanted, Window, timetable};
use crate::time::Instant;
use chrono::NaiveDate;

/// A plan, and the room that it leaves.
pub(super) struct Capacity<'a> {
    pub(super) candidates: &'a Candidates<'a>,
    pub(super) jobs: &'a [Job<'a>],
    assignment: &'a [Option<usize>],
    appointments: Vec<Option<Appointment>>,
    room: Room,
}

/// A ship that a team serves.
pub(super) struct Served<'a> {
    pub(super) ship: &'a str,
    pub(super) port: PortCode,
    pub(super) day: NaiveDate,
    pub(super) from: Instant,
    pub(super) to: Instant,
}

impl<'a> Capacity<'a> {
    pub(super) fn from_plan(
        candidates: &'a Candidates<'a>,
        jobs: &'a [Job<'a>],
        assignment: &'a [Option<usize>],
    ) -> Capacity<'a> {
        Capacity {
            candidates,
            jobs,
            assignment,
            appointments: timetable(&candidates.problem, assignment),
            room: Room::new(&candidates.problem, assignment),
        }
    }

    /// Returns the crews of a firm, with their indices.
    pub(super) fn crews_of(&self, firm: &Firm) -> impl Iterator<Item = (usize, &'a Crew<'a>)> {
        let crews = self.candidates.crews.iter().enumerate();
        let id = firm.id.clone();
        crews.filter(move |(_, crew)| crew.firm.id == id)
    }

    fn wanted(&self, at: usize, port: PortCode, day: NaiveDate, window: Window) -> Wanted {
        let crew = &self.candidates.crews[at];
        Wanted {
            crew: at,
            date: crews::date(day),
            teams: crew.teams().saturating_sub(crew.booked(day)),
            place: crew.place(port),
            window,
            length_s: self.candidates.job_s,
        }
    }

    /// Returns the number of further teams that a crew would need for one more job in a
    /// port, within some hours.
    pub(super) fn missing_teams(
        &self,
        crew: usize,
        port: PortCode,
        day: NaiveDate,
        window: Window,
    ) -> u32 {
        let wanted = self.wanted(crew, port, day, window);
        if self.room.earliest_end(&wanted, 0).is_some() {
            return 0;
        }
        let of = &self.candidates.crews[crew];
        1 + of.booked(day).saturating_sub(of.teams())
    }

    /// Returns the earliest end of one more job by a crew.
    pub(super) fn earliest_end(
        &self,
        crew: usize,
        port: PortCode,
        day: NaiveDate,
        window: Window,
    ) -> Option<i64> {
        self.room
            .earliest_end(&self.wanted(crew, port, day, window), 0)
    }

    /// Returns the ships that a crew serves on a day and on those from which it could not come
    /// in time, in order of time.
    pub(super) fn ships_near(&self, crew: usize, day: NaiveDate) -> Vec<Served<'a>> {
        let problem = &self.candidates.problem;
        let near = Room::near(problem, self.assignment, crew, crews::date(day));
        let served = near.into_iter().filter_map(|choice| {
            let candidate = &self.candidates.all[choice];
            let from = self.appointments[candidate.job]?.from;
            Some(Served {
                ship: self.jobs[candidate.job].vessel.display_name(),
                port: candidate.call.port,
                day: candidate.day,
                from: quote::instant(from),
                to: quote::instant(from + candidate.quote.length_s),
            })
        });
        let mut served: Vec<Served<'a>> = served.collect();
        served.sort_by_key(|served| (served.from, served.ship));
        served
    }
}
