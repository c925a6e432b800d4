//! Applies a chain's moves, all or none.

use super::state::State;

/// Move of a need in a chain.
pub(super) struct Move {
    pub(super) need: usize,
    /// Its new choice; none to leave it unmet.
    pub(super) choice: Option<usize>,
}

/// Applies a chain's moves. Applies none if they are not possible together for
/// less than the limit: a link may have changed after the chain went on from
/// it.
pub(super) fn apply(state: &mut State<'_>, need: usize, moves: &[Move], limit: i64) -> Option<i64> {
    // A need that occurs twice in the chain moves only once.
    let twice = |at: usize| {
        moves[..at]
            .iter()
            .any(|before| before.need == moves[at].need)
    };
    if (0..moves.len()).any(twice) {
        return None;
    }
    let mark = state.mark();
    let mut cost = 0;
    for moved in moves {
        if moved.need != need {
            cost -= state.take(moved.need);
        }
    }
    for moved in moves {
        cost += match moved.choice {
            Some(choice) => state.put(moved.need, choice),
            None => state.problem.unmet[moved.need],
        };
    }
    if moves.is_empty() {
        cost = state.problem.unmet[need];
    }
    let fits = moves.iter().all(|moved| {
        moved.choice.is_none_or(|choice| {
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
