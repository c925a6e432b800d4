//! Enumerates all assignments.

use binnacle_schedule::solve::Problem;

/// The least cost of any feasible assignment.
pub(crate) fn least_cost(problem: &Problem) -> i64 {
    let mut assignment = vec![None; problem.unmet.len()];
    from(problem, 0, &mut assignment).expect("leaving all unmet is feasible")
}

fn from(problem: &Problem, need: usize, assignment: &mut Vec<Option<usize>>) -> Option<i64> {
    if need == assignment.len() {
        return problem.cost(assignment);
    }
    assignment[need] = None;
    let mut least = from(problem, need + 1, assignment);
    for (index, choice) in problem.choices.iter().enumerate() {
        if choice.need != need {
            continue;
        }
        assignment[need] = Some(index);
        least = [least, from(problem, need + 1, assignment)]
            .into_iter()
            .flatten()
            .min();
    }
    assignment[need] = None;
    least
}
