//! Minimum-cost flow by successive shortest paths: exact where a team does one
//! job a day, and is anywhere in time for the next.

use binnacle_schedule::solve::Problem;

struct Edge {
    to: usize,
    room: i64,
    cost: i64,
}

/// A network in which each edge is followed by its reverse.
struct Network {
    edges: Vec<Edge>,
    from: Vec<Vec<usize>>,
}

impl Network {
    fn add(&mut self, from: usize, to: usize, room: i64, cost: i64) {
        self.from[from].push(self.edges.len());
        self.edges.push(Edge { to, room, cost });
        self.from[to].push(self.edges.len());
        self.edges.push(Edge {
            to: from,
            room: 0,
            cost: -cost,
        });
    }

    /// Sends one unit by the cheapest path (Bellman and Ford).
    fn send_one(&mut self, source: usize, sink: usize) -> Option<i64> {
        let mut cost = vec![i64::MAX; self.from.len()];
        let mut by = vec![usize::MAX; self.from.len()];
        cost[source] = 0;
        for _ in 0..self.from.len() {
            for node in 0..self.from.len() {
                if cost[node] == i64::MAX {
                    continue;
                }
                for &index in &self.from[node] {
                    let edge = &self.edges[index];
                    if edge.room > 0 && cost[node] + edge.cost < cost[edge.to] {
                        cost[edge.to] = cost[node] + edge.cost;
                        by[edge.to] = index;
                    }
                }
            }
        }
        if cost[sink] == i64::MAX {
            return None;
        }
        let mut node = sink;
        while node != source {
            self.edges[by[node]].room -= 1;
            self.edges[by[node] ^ 1].room += 1;
            node = self.edges[by[node] ^ 1].to;
        }
        Some(cost[sink])
    }
}

/// Source → needs → firm-days → sink, and an edge past them for each need.
pub(crate) fn least_cost(problem: &Problem) -> i64 {
    let needs = problem.unmet.len();
    let (source, sink) = (needs + problem.days.len(), needs + problem.days.len() + 1);
    let mut network = Network {
        edges: Vec::new(),
        from: (0..=sink).map(|_| Vec::new()).collect(),
    };
    for (need, unmet) in problem.unmet.iter().enumerate() {
        network.add(source, need, 1, 0);
        network.add(need, sink, 1, *unmet);
    }
    for (at, day) in problem.days.iter().enumerate() {
        network.add(needs + at, sink, i64::from(day.teams), 0);
    }
    for choice in &problem.choices {
        let visit = problem.visits[choice.visit];
        network.add(
            choice.need,
            needs + visit.day,
            1,
            choice.cost + visit.travel,
        );
    }
    std::iter::from_fn(|| network.send_one(source, sink)).sum()
}
