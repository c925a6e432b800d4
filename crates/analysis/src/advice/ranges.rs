//! Ranges of neighbours that are nearly as good.

/// Least part of the best's gain of a neighbour in its range.
const NEIGHBOUR_SHARE: f64 = 0.8;
/// Least part of the best range's gain of another range.
const OTHER_RANGE_SHARE: f64 = 0.5;
/// Greatest number of ranges.
const MAX_RANGES: usize = 3;

/// True if the last and the first are neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ends {
    Joined,
    Apart,
}

/// Returns runs of neighbours around the peaks of `gains`, the best first, each in its own
/// order. Gains that are not positive are in none.
pub(super) fn ranges(gains: &[f64], ends: Ends) -> Vec<Vec<usize>> {
    let n = gains.len();
    let step = |at: usize, by: usize| match ends {
        Ends::Joined => Some((at + by) % n),
        // `by` is 1 forwards and n − 1 back.
        Ends::Apart if by == 1 => (at + 1 < n).then_some(at + 1),
        Ends::Apart => at.checked_sub(1),
    };
    let mut by_gain: Vec<usize> = (0..n).collect();
    by_gain.sort_by(|&a, &b| gains[b].total_cmp(&gains[a]).then(a.cmp(&b)));
    let mut taken = vec![false; n];
    let mut found: Vec<Vec<usize>> = Vec::new();
    for peak in by_gain {
        let best = found.first().map_or(0.0, |run| peak_of(gains, run));
        if found.len() == MAX_RANGES || gains[peak] <= 0.0 || gains[peak] < OTHER_RANGE_SHARE * best
        {
            break;
        }
        let higher = |at: Option<usize>| at.is_some_and(|at| gains[at] > gains[peak]);
        if taken[peak] || higher(step(peak, 1)) || higher(step(peak, n - 1)) {
            continue;
        }
        taken[peak] = true;
        let mut run = std::collections::VecDeque::from([peak]);
        for by in [1, n - 1] {
            let mut at = peak;
            while let Some(next) = step(at, by) {
                if taken[next] || gains[next] < NEIGHBOUR_SHARE * gains[peak] {
                    break;
                }
                taken[next] = true;
                if by == 1 {
                    run.push_back(next);
                } else {
                    run.push_front(next);
                }
                at = next;
            }
        }
        found.push(run.into());
    }
    found
}

fn peak_of(gains: &[f64], run: &[usize]) -> f64 {
    run.iter().map(|&index| gains[index]).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_nearly_as_good_are_one_range_across_north() {
        let mut gains = [0.1; 24];
        gains[23] = 0.9;
        gains[0] = 1.0;
        gains[1] = 0.85;
        gains[2] = 0.5;
        gains[12] = 0.7;
        assert_eq!(
            ranges(&gains, Ends::Joined),
            vec![vec![23, 0, 1], vec![12]],
            "the slope at 2 is no peak"
        );
        assert_eq!(ranges(&gains, Ends::Apart)[0], vec![0, 1]);
    }

    #[test]
    fn where_all_are_equal_it_is_the_whole_circle() {
        let found = ranges(&[0.3; 24], Ends::Joined);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].len(), 24);
        assert!(ranges(&[0.0; 24], Ends::Joined).is_empty());
        assert!(ranges(&[], Ends::Apart).is_empty());
    }
}
