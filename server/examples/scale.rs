//! Measures what a new batch costs a server as a ship's history grows: processor, bytes written,
//! disk and memory. `make bench-scale` runs it on both databases.
//!
//! `scale [DAYS …]`: the days after which the next batches are measured.
//!
//! One ship sends a batch each six hours of the ten days out of twenty that she is at sea, and is
//! analysed after each.

#![allow(clippy::unwrap_used, reason = "it stops where it cannot measure")]
#![allow(clippy::print_stdout, reason = "it prints its figures")]
#![allow(clippy::cast_precision_loss, reason = "figures are rounded")]

use binnacle_compass::sample::Sample;
use binnacle_platform::db::Pools;
use binnacle_platform::events;
use binnacle_server_testing::{ApiResponse, Engine, Ship, TestServer, days_at_sea, true_model};
use binnacle_wire::downlink::card_tag;
use std::fs;

/// Days after which the next batches are measured, and their number.
const DAYS: [f64; 3] = [30.0, 365.0, 1095.0];
const MEASURED: usize = 40;
/// Length of a batch, and of a passage and the call after it, seconds.
const BATCH_S: f64 = 6.0 * 3600.0;
const PASSAGE_S: f64 = 10.0 * 86_400.0;
/// Start of the ship, which is that of the server's clock.
const START: &str = binnacle_server_testing::START;

/// Counters of the process and of its database.
#[derive(Clone, Copy)]
struct Counters {
    cpu_s: f64,
    written: f64,
}

#[tokio::main]
async fn main() {
    println!("database, days, processor a batch (s), written a batch (kB), on disk (MB a year), ");
    println!("  log alone (MB a year), most memory so far (MB)");
    let given = std::env::args().skip(1).map(|days| days.parse().unwrap());
    let mut days: Vec<f64> = given.collect();
    if days.is_empty() {
        days = DAYS.to_vec();
    }
    for engine in [Engine::Sqlite, Engine::Postgres] {
        measure(engine, &days).await;
    }
}

async fn measure(engine: Engine, looks: &[f64]) {
    let server = TestServer::start(engine).await;
    let ada = server.admin("ada").await;
    let ship = server.ship(&ada, "Nao").await;
    let empty = disk(&server).await;
    let days = looks[looks.len() - 1] + 30.0;
    let samples = days_at_sea(&true_model(), START, days);
    let begin = samples[0].time;
    let after_s = |sample: &Sample| sample.time.seconds_since(begin);
    let at_sea = samples
        .iter()
        .filter(|s| after_s(s) % (2.0 * PASSAGE_S) < PASSAGE_S);
    let at_sea: Vec<Sample> = at_sea.copied().collect();
    let number = |sample: &Sample| (after_s(sample) / BATCH_S) as u64;
    let mut measured: Vec<Counters> = Vec::new();
    let mut looks = looks.iter().peekable();
    let (mut seq, mut now_s, mut logged) = (0, 0.0, 0_usize);
    let mut card = None;
    for batch in at_sea.chunk_by(|a, b| number(a) == number(b)) {
        let Some(look) = looks.peek() else { break };
        seq += 1;
        let time_s = after_s(&batch[0]) + BATCH_S;
        server.advance(time_s - now_s);
        now_s = time_s;
        let is_measured = after_s(&batch[0]) >= *look * 86_400.0;
        let before = counters(&server).await;
        logged += send(&server, &ship, seq, batch, &mut card).await;
        if is_measured {
            let after = counters(&server).await;
            measured.push(Counters {
                cpu_s: after.cpu_s - before.cpu_s,
                written: after.written - before.written,
            });
        }
        if seq % 20 == 0 {
            let now = server.app.clock.now().into();
            events::prune(&server.app.db, now).await.unwrap();
            vacuum(&server).await;
        }
        if measured.len() == MEASURED {
            let years = now_s / (365.0 * 86_400.0);
            let used = disk(&server).await - empty;
            println!(
                "{engine:?}, {look}, {:.3}, {:.0}, {:.2}, {:.2}, {:.0}",
                median(measured.iter().map(|of| of.cpu_s)),
                median(measured.iter().map(|of| of.written)) / 1e3,
                used / years / 1e6,
                logged as f64 / years / 1e6,
                memory_mb(),
            );
            print_largest_tables(&server).await;
            measured.clear();
            looks.next();
        }
    }
    server.finish().await;
}

/// Sends a batch as an agent with a card does, keeps the card of the response, and analyses the
/// batch. Returns its length in bytes.
async fn send(
    server: &TestServer,
    ship: &Ship,
    seq: u64,
    samples: &[Sample],
    card: &mut Option<String>,
) -> usize {
    let bytes = binnacle_server_testing::frame(ship.stream, seq, samples);
    let length = bytes.len();
    let has = card
        .as_ref()
        .map_or(String::new(), |card| format!("?card={card}"));
    let path = format!("/streams/{}/batches/{seq}{has}", ship.stream);
    let request = ship.request(reqwest::Method::PUT, &path).body(bytes);
    let sent = ApiResponse::send(request).await.good();
    if let Some(model) = sent["model"]["id"].as_str() {
        *card = Some(card_tag(model.parse().unwrap()));
    }
    server.advance(10.0);
    assert_eq!(server.work().await.len(), 1);
    length
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Returns processor time of this process, and bytes that it wrote to SQLite's files, or those of
/// PostgreSQL's log.
async fn counters(server: &TestServer) -> Counters {
    let stat = fs::read_to_string("/proc/self/stat").unwrap();
    let (_, fields) = stat.rsplit_once(')').unwrap();
    let fields: Vec<&str> = fields.split_whitespace().collect();
    // User and system time, in hundredths of a second (proc_pid_stat(5)).
    let ticks: f64 = fields[11..13]
        .iter()
        .map(|x| x.parse::<f64>().unwrap())
        .sum();
    Counters {
        cpu_s: ticks / 100.0,
        written: written(server).await,
    }
}

async fn written(server: &TestServer) -> f64 {
    match server.app.db.pools() {
        Pools::Sqlite { .. } => field("/proc/self/io", "write_bytes:"),
        Pools::Postgres(pool) => {
            let sql =
                "SELECT CAST(pg_wal_lsn_diff(pg_current_wal_lsn(), '0/0') AS DOUBLE PRECISION)";
            sqlx::query_scalar(sql).fetch_one(pool).await.unwrap()
        }
    }
}

/// Makes the space of replaced rows free for others, as PostgreSQL's autovacuum does within minutes:
/// these days pass too fast for it.
async fn vacuum(server: &TestServer) {
    if let Pools::Postgres(pool) = server.app.db.pools() {
        sqlx::query("VACUUM").execute(pool).await.unwrap();
    }
}

/// Prints the largest tables of PostgreSQL with their indexes, kB.
async fn print_largest_tables(server: &TestServer) {
    let Pools::Postgres(pool) = server.app.db.pools() else {
        return;
    };
    let sql = "SELECT relname::TEXT, pg_total_relation_size(oid), pg_indexes_size(oid)
               FROM pg_class WHERE relkind = 'r' AND relnamespace = 'public'::regnamespace
               ORDER BY 2 DESC LIMIT 8";
    let tables: Vec<(String, i64, i64)> = sqlx::query_as(sql).fetch_all(pool).await.unwrap();
    for (table, all, indexes) in tables {
        println!(
            "  {table}: {} of which indexes {}",
            all / 1000,
            indexes / 1000
        );
    }
}

/// Returns the bytes of the database on disk.
async fn disk(server: &TestServer) -> f64 {
    match server.app.db.pools() {
        Pools::Sqlite { readers, .. } => {
            let sql = "SELECT CAST(page_count * page_size AS REAL)
                       FROM pragma_page_count(), pragma_page_size()";
            sqlx::query_scalar(sql).fetch_one(readers).await.unwrap()
        }
        Pools::Postgres(pool) => {
            let sql = "SELECT CAST(pg_database_size(current_database()) AS DOUBLE PRECISION)";
            sqlx::query_scalar(sql).fetch_one(pool).await.unwrap()
        }
    }
}

fn memory_mb() -> f64 {
    field("/proc/self/status", "VmHWM:") / 1e3
}

/// Returns the number behind a name in a file of the kernel.
fn field(file: &str, name: &str) -> f64 {
    let text = fs::read_to_string(file).unwrap();
    let line = text.lines().find(|line| line.starts_with(name)).unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}
