//! Routes by taking the stops of each day in the order of their latest ends.

use super::spell::{Load, Spell, Team};
use super::{Leg, Routes};

/// A team's day so far.
#[derive(Clone, Default)]
struct Today {
    load: Load,
    stops: usize,
    places: Vec<usize>,
}

/// Finds routes, or none where this order leads to none.
pub(super) fn find(spell: &Spell<'_>) -> Option<Routes> {
    let mut teams = vec![Team::FREE; spell.crew.teams as usize];
    let mut routes = Routes {
        cost: 0,
        legs: Vec::with_capacity(spell.len()),
    };
    for (at, day) in spell.days.iter().enumerate() {
        let mut today = vec![Today::default(); teams.len()];
        let mut out = 0;
        for stop in &day.stops {
            let mut best: Option<(i64, i64, usize)> = None;
            let mut seen_free = false;
            for (index, team) in teams.iter().enumerate() {
                let own = &today[index];
                let is_full = own.load.with(stop, spell.crew.jobs_a_team).is_none();
                let is_free = own.stops == 0 && *team == Team::FREE;
                // Of teams that can be anywhere the first stands for all.
                if is_full || own.stops == 0 && out == day.teams || is_free && seen_free {
                    continue;
                }
                seen_free |= is_free;
                let Some(begin) = spell.begin(*team, stop) else {
                    continue;
                };
                let is_there = stop.place.is_some_and(|place| own.places.contains(&place));
                let cost = if is_there { 0 } else { stop.travel };
                if best.is_none_or(|best| (cost, begin, index) < best) {
                    best = Some((cost, begin, index));
                }
            }
            let (cost, begin, index) = best?;
            let own = &mut today[index];
            out += usize::from(own.stops == 0);
            own.stops += 1;
            own.load = own.load.with(stop, spell.crew.jobs_a_team)?;
            if stop.choice.is_some() {
                own.places.extend(stop.place);
            }
            routes.cost += cost;
            routes.legs.push(Leg {
                team: index,
                choice: stop.choice,
                from: begin,
            });
            teams[index] = Spell::after(teams[index], stop, begin);
        }
        spell.free_by(&mut teams, at + 1);
    }
    Some(routes)
}
