//! Migrations keep all data, and refuse a database of another version.

use binnacle_platform::db::{Connection, Db, Pools, Tx};
use binnacle_platform::secret;
use binnacle_server_testing::{ApiResponse, Engine, TestServer, password_hash, try_sign_in};
use reqwest::Method;
use serde_json::json;
use sqlx::SqlSafeStr;
use sqlx::migrate::{Migration, MigrationType, Migrator};
use uuid::Uuid;

/// Start time of every test, 2026-11-21T07:00:00Z, and a day later.
const NOW: i64 = 1_795_244_400_000_000;
const TOMORROW: i64 = NOW + 86_400_000_000;
/// Number of people, each with a session and a token.
const PEOPLE: usize = 3;

macro_rules! run {
    ($tx:expr, $sql:expr $(, $bind:expr)* $(,)?) => {
        match Tx::connection($tx) {
            Connection::Sqlite(tx) => drop(sqlx::query($sql)$(.bind($bind))*.execute(&mut **tx).await.unwrap()),
            Connection::Postgres(tx) => drop(sqlx::query($sql)$(.bind($bind))*.execute(&mut **tx).await.unwrap()),
        }
    };
}

#[tokio::test]
async fn on_sqlite_migrations_keep_tokens_and_webhooks() {
    check_nothing_is_lost(Engine::Sqlite).await;
}

#[tokio::test]
async fn on_postgres_migrations_keep_tokens_and_webhooks() {
    check_nothing_is_lost(Engine::Postgres).await;
}

#[tokio::test]
async fn on_sqlite_a_database_of_another_version_is_refused() {
    check_other_version_is_refused(Engine::Sqlite).await;
}

#[tokio::test]
async fn on_postgres_a_database_of_another_version_is_refused() {
    check_other_version_is_refused(Engine::Postgres).await;
}

#[tokio::test]
async fn on_sqlite_audit_lines_survive_the_change_of_their_table() {
    check_audit_lines_survive(Engine::Sqlite).await;
}

#[tokio::test]
async fn on_postgres_audit_lines_survive_the_change_of_their_table() {
    check_audit_lines_survive(Engine::Postgres).await;
}

/// Checks that lines of before migration 19, which makes their table again, are shown as they were.
async fn check_audit_lines_survive(engine: Engine) {
    let bare = TestServer::bare(engine).await;
    let all = sqlx::migrate!("../migrations");
    let before = all.iter().filter(|migration| migration.version < 19);
    let before = Migrator::with_migrations(before.cloned().collect());
    match bare.db.pools() {
        Pools::Sqlite { writer, .. } => before.run(writer).await.unwrap(),
        Pools::Postgres(pool) => before.run(pool).await.unwrap(),
    }
    let id = Uuid::now_v7();
    let mut tx = bare.db.begin().await.unwrap();
    run!(
        &mut tx,
        "INSERT INTO audit_lines (id, at, actor_kind, actor_name, address, method, route, path,
                                  status)
         VALUES ($1, $2, 'command', 'command line', '', '', 'admin reset-user', 'admin', 200)",
        id,
        NOW
    );
    tx.commit().await.unwrap();
    bare.db.migrate().await.unwrap();
    let server = bare.open().await;
    let root = server.admin("ada").await.platform_admin(&server).await;
    let listed = root.get("/audit?route=admin%20reset-user").await.good();
    let line = &listed["items"][0];
    assert_eq!(line["id"], id.to_string());
    assert_eq!(line["actor_name"], "command line");
    assert_eq!(
        (&line["account"], &line["refusal"]),
        (&json!(null), &json!(null))
    );
    server.finish().await;
}

/// Checks that an unknown migration and one with another text are refused.
async fn check_other_version_is_refused(engine: Engine) {
    for number in [1, 63] {
        let bare = TestServer::bare(engine).await;
        let other = Migration::new(
            number,
            "other".into(),
            MigrationType::Simple,
            "CREATE TABLE other (id BIGINT)".into_sql_str(),
            false,
        );
        let other = Migrator::with_migrations(vec![other]);
        match bare.db.pools() {
            Pools::Sqlite { writer, .. } => other.run(writer).await.unwrap(),
            Pools::Postgres(pool) => other.run(pool).await.unwrap(),
        }
        let error = format!("{:#}", bare.db.migrate().await.unwrap_err());
        assert!(
            error.contains("another version of binnacle-server"),
            "{error}"
        );
        assert!(error.contains(&format!("migration {number} ")), "{error}");
        // Nothing was created: the table's name is free.
        let mut tx = bare.db.begin().await.unwrap();
        run!(&mut tx, "CREATE TABLE operators (id BIGINT)");
        tx.commit().await.unwrap();
        bare.remove().await;
    }
}

async fn check_nothing_is_lost(engine: Engine) {
    let prepared = TestServer::prepared(engine).await;
    let operator = Uuid::now_v7();
    fill(&prepared.db, operator).await;
    let server = prepared.open().await;
    for number in 0..PEOPLE {
        let role = ["admin", "viewer", "platform_admin"][number];
        let url = format!("{}/api/v1/me", server.url);
        let cookie = format!("binnacle_session=session{number}");
        let by_cookie = ApiResponse::send(server.http.get(&url).header("cookie", cookie)).await;
        assert_eq!(by_cookie.good()["role"], role);
        let token = server
            .http
            .get(&url)
            .bearer_auth(format!("bna_token{number}"));
        assert_eq!(ApiResponse::send(token).await.good()["role"], role);
        let signed_in = try_sign_in(
            &server,
            &format!("{number}@example.com"),
            binnacle_server_testing::PASSWORD,
        )
        .await;
        assert_eq!(signed_in.good()["role"], role);
    }
    let url = |path: &str| format!("{}/api/v1{path}", server.url);
    let request = |method, path: &str| {
        server
            .http
            .request(method, url(path))
            .bearer_auth("bna_token0")
    };
    let webhooks = ApiResponse::send(request(Method::GET, "/webhooks"))
        .await
        .good();
    assert_eq!(webhooks["items"][0]["url"], "https://example.com/hook");
    // The stored idempotency key still finds its object.
    let vessel = request(Method::POST, "/vessels").json(&json!({ "name": "Other" }));
    let vessel = vessel.header("Idempotency-Key", "old");
    assert_eq!(
        ApiResponse::send(vessel).await.problem(),
        "idempotency-key-reused"
    );
    // Sessions and tokens refer to their user: a removed user is signed out.
    server
        .run_sql("DELETE FROM users WHERE role = 'viewer'")
        .await;
    let gone = server.http.get(url("/me")).bearer_auth("bna_token1");
    assert_eq!(ApiResponse::send(gone).await.problem(), "unauthenticated");
    let left = ApiResponse::send(request(Method::GET, "/me")).await;
    assert_eq!(left.status, 200);
    server.finish().await;
}

/// Inserts people of each role, a webhook and an idempotency key.
async fn fill(db: &Db, operator: Uuid) {
    let mut tx = db.begin().await.unwrap();
    run!(
        &mut tx,
        "INSERT INTO operators (id, name, created_at) VALUES ($1, 'ada', $2)",
        operator,
        NOW
    );
    for number in 0..PEOPLE {
        let user = Uuid::now_v7();
        let role = ["admin", "viewer", "platform_admin"][number];
        run!(
            &mut tx,
            "INSERT INTO users (id, operator_id, email, name, role, password_hash, created_at)
             VALUES ($1, $2, $3, 'Ada', $4, $5, $6)",
            user,
            Some(operator).filter(|_| role != "platform_admin"),
            format!("{number}@example.com"),
            role,
            password_hash(),
            NOW
        );
        run!(
            &mut tx,
            "INSERT INTO sessions (id, user_id, token_hash, created_at, last_seen_at, expires_at,
                                   address, user_agent)
             VALUES ($1, $2, $3, $4, $4, $5, '', '')",
            Uuid::now_v7(),
            user,
            secret::hash(&format!("session{number}")),
            NOW,
            TOMORROW
        );
        run!(
            &mut tx,
            "INSERT INTO api_tokens (id, user_id, token_hash, name, scope, created_at, expires_at)
             VALUES ($1, $2, $3, 'ERP', 'write', $4, $5)",
            Uuid::now_v7(),
            user,
            secret::hash(&format!("bna_token{number}")),
            NOW,
            TOMORROW
        );
    }
    let webhook = Uuid::now_v7();
    run!(
        &mut tx,
        "INSERT INTO receivers (id, operator_id, channel, enabled, last_number)
         VALUES ($1, $2, 'webhook', TRUE, 0)",
        webhook,
        operator
    );
    run!(
        &mut tx,
        "INSERT INTO webhooks (id, operator_id, url, secret, kinds, created_at)
         VALUES ($1, $2, 'https://example.com/hook', 'bns_x', '[\"alert.raised\"]', $3)",
        webhook,
        operator,
        NOW
    );
    run!(
        &mut tx,
        "INSERT INTO idempotency_keys (tenant_id, key_hash, request_hash, resource_id, created_at)
         VALUES ($1, $2, $3, $1, $4)",
        operator,
        secret::hash("old"),
        secret::hash("request"),
        NOW
    );
    tx.commit().await.unwrap();
}
