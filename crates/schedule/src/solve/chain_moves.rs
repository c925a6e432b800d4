//! Applies a chain's moves, all or none.

use super::state::State;

/// Applies a chain's moves. Applies none if they are not possible together for
/// less than the limit: a link may have changed after the chain went on from
/// it.
pub(super) fn apply(
    state: &mut State<'_>,
    need: usize,
    moves: &[(usize, Option<usize>)],
    limit: i64,
) -> Option<i64> {
    // A need that occurs twice in the chain moves only once.
    let twice = |at: usize| moves[..at].iter().any(|(need, _)| *need == moves[at].0);
    if (0..moves.len()).any(twice) {
        return None;
    }
    let mark = state.mark();
    let mut cost = 0;
    for (moved, _) in moves {
        if *moved != need {
            cost -= state.take(*moved);
        }
    }
    for (moved, choice) in moves {
        cost += match choice {
            Some(choice) => state.put(*moved, *choice),
            None => state.problem.unmet[*moved],
        };
    }
    if moves.is_empty() {
        cost = state.problem.unmet[need];
    }
    let fits = moves.iter().all(|(_, choice)| {
        choice.is_none_or(|choice| {
            let day = state.problem.visits[state.problem.choices[choice].visit].firm_day;
            state.sent[day] <= state.problem.teams[day]
        })
    });
    if fits && cost < limit {
        return Some(cost);
    }
    state.undo_to(mark);
    None
}
