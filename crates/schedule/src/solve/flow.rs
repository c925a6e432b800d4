//! The best stays of a crew's teams, each of which goes from one to the next: a
//! minimum-cost flow of one unit a team, by successive shortest paths.
//!
//! A stay takes one team after the other, each with a load of less gain. Its
//! teams go on to the stays that they can reach, and after some days to any.
//! Gains are negative costs. Sums of whole numbers are exact.

use super::relaxation::Stay;

/// A stay with the gains of its loads, the best first.
pub(super) struct Offer<'a> {
    pub(super) stay: usize,
    pub(super) gains: &'a [f64],
}

/// The best flow.
pub(super) struct Flow {
    /// Number of loads taken of each offer.
    pub(super) taken: Vec<usize>,
    /// Total gain.
    pub(super) gain: f64,
    /// Total gain with one team less.
    pub(super) gain_of_others: f64,
}

struct Edge {
    from: usize,
    to: usize,
    room: usize,
    cost: f64,
    /// The offer whose load this edge is.
    offer: Option<usize>,
}

/// A network in which each edge is followed by its reverse.
#[derive(Default)]
struct Network {
    edges: Vec<Edge>,
    vertices: usize,
}

impl Network {
    fn add(&mut self, from: usize, to: usize, room: usize, cost: f64, offer: Option<usize>) {
        let (back, none) = (-cost, None);
        self.edges.push(Edge {
            from,
            to,
            room,
            cost,
            offer,
        });
        self.edges.push(Edge {
            from: to,
            to: from,
            room: 0,
            cost: back,
            offer: none,
        });
    }

    /// Finds the cheapest path from the first vertex to the last (Bellman and Ford), as the
    /// edges from its end, with its cost. The edges are in the order of time, so that
    /// one pass is enough for the first path.
    fn cheapest_path(&self) -> (f64, Vec<usize>) {
        let mut cost = vec![f64::INFINITY; self.vertices];
        let mut by = vec![usize::MAX; self.vertices];
        cost[0] = 0.0;
        for _ in 0..self.vertices {
            let mut has_changed = false;
            for (index, edge) in self.edges.iter().enumerate() {
                let new = cost[edge.from] + edge.cost;
                if edge.room > 0 && new < cost[edge.to] - 1e-6 {
                    (cost[edge.to], by[edge.to]) = (new, index);
                    has_changed = true;
                }
            }
            if !has_changed {
                break;
            }
        }
        let mut path = Vec::new();
        let mut at = self.vertices - 1;
        while by[at] != usize::MAX && path.len() <= self.vertices {
            path.push(by[at]);
            at = self.edges[by[at]].from;
        }
        (cost[self.vertices - 1], path)
    }
}

/// Finds the best loads for a number of teams. The offers are in the order of the
/// stays.
pub(super) fn send(stays: &[Stay], offers: &[Offer<'_>], teams: usize) -> Flow {
    let mut flow = Flow {
        taken: vec![0; offers.len()],
        gain: 0.0,
        gain_of_others: 0.0,
    };
    let mut network = build(stays, offers, teams);
    for _ in 0..teams {
        let (cost, path) = network.cheapest_path();
        flow.gain_of_others = flow.gain;
        if cost > -1e-6 {
            return flow;
        }
        flow.gain += cost;
        for index in path {
            network.edges[index].room -= 1;
            network.edges[index ^ 1].room += 1;
            if let Some(offer) = network.edges[index].offer {
                flow.taken[offer] += 1;
            }
            if let Some(offer) = network.edges[index ^ 1].offer {
                flow.taken[offer] -= 1;
            }
        }
    }
    flow
}

/// Builds the network: for each date a vertex of the teams that can go anywhere, and
/// for each offer two, before and after.
fn build(stays: &[Stay], offers: &[Offer<'_>], teams: usize) -> Network {
    let mut network = Network::default();
    let (mut free, mut before) = (Vec::new(), Vec::with_capacity(offers.len()));
    for offer in offers {
        let date = stays[offer.stay].date;
        if free.last().is_none_or(|(last, _)| *last != date) {
            free.push((date, network.vertices));
            network.vertices += 1;
        }
        before.push(network.vertices);
        network.vertices += 2;
    }
    let end = network.vertices;
    network.vertices += 1;
    free.push((i32::MAX, end));
    let mut day = 0;
    for (at, offer) in offers.iter().enumerate() {
        let stay = &stays[offer.stay];
        let is_first = at == 0 || stays[offers[at - 1].stay].date != stay.date;
        if is_first {
            day = free.partition_point(|(date, _)| *date < stay.date);
            network.add(free[day].1, free[day + 1].1, teams, 0.0, None);
        }
        let (arrives, leaves) = (before[at], before[at] + 1);
        network.add(free[day].1, arrives, teams, 0.0, None);
        for gain in &offer.gains[..offer.gains.len().min(stay.teams)] {
            network.add(arrives, leaves, 1, *gain, Some(at));
        }
        let later = offers[at + 1..].iter().enumerate();
        for (more, next) in later.take_while(|(_, next)| stays[next.stay].date < stay.free_on) {
            if stay.next.binary_search(&next.stay).is_ok() {
                network.add(leaves, before[at + 1 + more], teams, 0.0, None);
            }
        }
        let anywhere = free.partition_point(|(date, _)| *date < stay.free_on);
        network.add(leaves, free[anywhere].1, teams, 0.0, None);
    }
    network
}
