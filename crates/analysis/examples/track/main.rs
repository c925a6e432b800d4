#![allow(clippy::unwrap_used, missing_docs)]
#[allow(dead_code)]
#[path = "../../tests/voyages/mod.rs"]
mod voyages;
use voyages::Variety;
use voyages::fleet::{Event, Plan, sail_log};

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let seed: u64 = args.get(1).map_or(100_000, |a| a.parse().unwrap());
    let n: u64 = args.get(2).map_or(1, |a| a.parse().unwrap());
    let event = match args.get(3).map(String::as_str) {
        Some("step1") => Event::Step(1000.0),
        Some("step2") => Event::Step(2000.0),
        Some("light") => Event::Lightning(4000.0),
        Some("cargo") => Event::Cargo,
        Some("gyro") => Event::GyroFault(4.0),
        Some("ramp") => Event::Ramp(3000.0, 30.0),
        _ => Event::Nothing,
    };
    let days: f64 = args.get(4).map_or(365.0, |a| a.parse().unwrap());
    let two = args.get(5).is_none_or(|a| a != "one");
    let mut tally: std::collections::BTreeMap<String, usize> = Default::default();
    let mut delays: Vec<f64> = Vec::new();
    let mut total = 0.0;
    let quiet = std::env::var("Q").is_ok();
    for seed in seed..seed + n {
        let mut plan = Plan {
            days,
            ..Plan::new(
                event,
                [Variety::Rich, Variety::Medium, Variety::Poor][(seed % 3) as usize],
            )
        };
        plan.faults.satellite = two;
        let log = sail_log(seed, &plan);
        let t = std::time::Instant::now();
        let run = binnacle_analysis::tracking::study::run(&log.samples);
        let s = t.elapsed().as_secs_f64();
        total += s;
        let planned = log
            .happened
            .iter()
            .find(|h| {
                matches!(
                    (h.what, event),
                    (voyages::fleet::Name::Step, Event::Step(_))
                        | (voyages::fleet::Name::Lightning, Event::Lightning(_))
                        | (voyages::fleet::Name::Cargo, Event::Cargo)
                        | (voyages::fleet::Name::GyroFault, Event::GyroFault(_))
                        | (voyages::fleet::Name::Ramp, Event::Ramp(..))
                )
            })
            .copied();
        let mut found = None;
        for (what, from, at, withdrawn) in &run.told {
            let near = log
                .happened
                .iter()
                .find(|h| {
                    Some(**h) != planned
                        && from.seconds_since(h.from) > -43_200.0
                        && h.to.unwrap_or(h.from).seconds_since(*from) > -43_200.0
                })
                .map(|h| format!("{:?}", h.what))
                .unwrap_or_default();
            let is_planned = planned.is_some_and(|h| {
                *at >= h.from
                    && (from.seconds_since(h.from).abs() < 86_400.0
                        || h.to
                            .is_some_and(|to| from.seconds_since(to).abs() < 86_400.0)
                        || matches!(event, Event::Ramp(..)))
            });
            if is_planned && found.is_none() && withdrawn.is_none() {
                found = Some((what.clone(), *at));
            }
            *tally
                .entry(format!(
                    "{}{what} {near} {}",
                    if is_planned { "PLANNED " } else { "" },
                    if withdrawn.is_some() { "withdrawn" } else { "" }
                ))
                .or_default() += 1;
        }
        if let Some(h) = planned {
            delays.push(found.map_or(f64::INFINITY, |(_, at)| {
                log.samples
                    .iter()
                    .filter(|s| s.time > h.from && s.time <= at)
                    .count() as f64
                    / 6.0
            }));
        }
        let z2: Vec<f64> = run.z.iter().map(|(v, f, _)| v * v / f).collect();
        let in95 = z2.iter().filter(|z| **z < 3.84).count() as f64 / z2.len() as f64;
        let d2 = run.z.iter().map(|z| z.2.min(36.0)).sum::<f64>() / run.z.len() as f64;
        let m = z2.iter().map(|z| z.min(36.0)).sum::<f64>() / z2.len() as f64;
        if quiet {
            continue;
        }
        println!(
            "seed {seed}: {} rows {s:.2} s, bank {:.2}, replays {}, z² {m:.3} in95 {in95:.3} diff z² {d2:.3}",
            run.rows, run.bank_mean, run.replays
        );
        if std::env::var("V").is_ok() {
            println!(
                "  levels {:?}",
                run.levels
                    .iter()
                    .map(|(n, v)| format!("{n} {v:.3}"))
                    .collect::<Vec<_>>()
            );
        }
        let truth = log.truth.parameters.to_array();
        let sdp = [1500.0, 0.012, 1500.0, 0.006, 0.02, 0.008, 0.008];
        println!(
            "  off/sd {:?}",
            (0..7)
                .map(|j| format!("{:.2}±{:.2}", run.mean[j] - truth[j] / sdp[j], run.sd[j]))
                .collect::<Vec<_>>()
        );
        println!(
            "  align {:.2}±{:.2} (true {:.2}) gyro {:.2} ± {:.2} (true {:.2}) speed {:.2}±{:.2} ret {:.2}±{:.2} {:.2}±{:.2}",
            run.mean[11],
            run.sd[11],
            log.truth.alignment_deg,
            run.mean[17],
            run.sd[17],
            log.truth.gyro_constant_deg,
            run.mean[21],
            run.sd[21],
            run.mean[7],
            run.sd[7],
            run.mean[8],
            run.sd[8]
        );
        let verbose = std::env::var("V").is_ok();
        for (what, from, at, withdrawn) in &run.told {
            let near: Vec<String> = log
                .happened
                .iter()
                .filter(|h| {
                    from.seconds_since(h.from) > -86_400.0
                        && h.to.unwrap_or(h.from).seconds_since(*from) > -86_400.0
                })
                .map(|h| format!("{:?} {:.1} h", h.what, from.seconds_since(h.from) / 3600.0))
                .collect();
            if what.starts_with("Passing") && !near.is_empty() && !verbose {
                continue;
            }
            println!(
                "    told {what} {from} after {:.1} h {} near {near:?}",
                at.seconds_since(*from) / 3600.0,
                withdrawn.map_or(String::new(), |w| format!(
                    "WITHDRAWN after {:.1} h",
                    w.seconds_since(*at) / 3600.0
                ))
            );
        }
        if verbose {
            for h in &log.happened {
                println!(
                    "    HAPPENED {:?} {} {:?}",
                    h.what,
                    h.from,
                    h.to.map(|t| t.to_string())
                );
            }
            for (t, e) in &run.leads {
                println!(
                    "    {t} {}",
                    e.iter()
                        .rev()
                        .take(3)
                        .cloned()
                        .collect::<Vec<_>>()
                        .join(" | ")
                );
            }
            for l in run.lines.iter().take(6) {
                println!("   {l}");
            }
        }
    }
    delays.sort_by(f64::total_cmp);
    println!(
        "{n} ships, {total:.1} s; delay settled h {:?}",
        delays.iter().map(|d| format!("{d:.1}")).collect::<Vec<_>>()
    );
    for (what, n) in tally {
        println!("  {n:4} {what}");
    }
}
