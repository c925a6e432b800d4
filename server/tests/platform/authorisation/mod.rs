//! Every route with every method as every role, on the role's own data and on foreign data.

mod fixture;
mod table;

use binnacle_server::routes::openapi;
use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, TestServer};
use fixture::{Key, ROLES, Side, request, response};
use serde_json::Value;
use std::collections::BTreeSet;
use table::{OPEN, TABLE};

on_both!(each_role_may_do_what_the_table_says_on_its_own_data_alone);

/// Operation that names its subject in the body.
const IN_BODY: &str = "POST /work-orders";

/// An operation as the API document describes it.
struct Operation {
    name: String,
    method: String,
    path: String,
    has_body: bool,
}

fn operations() -> Vec<Operation> {
    let document = serde_json::to_value(openapi()).unwrap();
    let mut found = Vec::new();
    for (path, methods) in document["paths"].as_object().unwrap() {
        for (method, operation) in methods.as_object().unwrap() {
            let method = method.to_uppercase();
            let short = path.strip_prefix("/api/v1").unwrap_or(path);
            found.push(Operation {
                name: format!("{method} {short}"),
                method,
                path: short.to_owned(),
                has_body: !operation["requestBody"].is_null(),
            });
        }
    }
    found
}

fn url(path: &str) -> String {
    match path {
        "/healthz" | "/readyz" | "/metrics" => path.to_owned(),
        of_api => format!("/api/v1{of_api}"),
    }
}

/// Returns the last segment of a problem's type; empty for other bodies.
fn kind(response: &ApiResponse) -> String {
    let problem: Option<Value> = serde_json::from_str(&response.text).ok();
    let kind = problem
        .as_ref()
        .and_then(|problem| problem["type"].as_str());
    kind.map_or_else(String::new, |kind| {
        kind.rsplit('/').next().unwrap_or_default().to_owned()
    })
}

#[test]
fn operations_and_table_lines_correspond() {
    let named: BTreeSet<String> = operations().into_iter().map(|one| one.name).collect();
    let lines: BTreeSet<String> = TABLE.iter().map(|(name, _)| (*name).to_owned()).collect();
    let missing: Vec<_> = named.difference(&lines).collect();
    let left_over: Vec<_> = lines.difference(&named).collect();
    assert!(
        missing.is_empty() && left_over.is_empty(),
        "say in table.rs who may: {missing:#?}; there are no more: {left_over:#?}"
    );
    assert_eq!(lines.len(), TABLE.len(), "a line stands there twice");
    assert!(TABLE.iter().all(|(_, rule)| rule.len() == ROLES.len()));
}

/// Sort key of an operation: deletions come late, the end of sessions last.
fn rank(one: &Operation) -> u8 {
    match (one.method.as_str(), one.path.as_str()) {
        ("GET", _) => 0,
        ("DELETE", "/tokens/{id}") => 3,
        ("DELETE", "/sessions/{id}") => 4,
        (_, "/me/password") => 6,
        ("DELETE", "/sessions") => 7,
        ("DELETE", "/session") => 8,
        (_, path) if path.starts_with("/me/") => 5,
        ("DELETE", _) => 2,
        _ => 1,
    }
}

struct Trial<'a> {
    server: &'a TestServer,
    ada: &'a Side,
    eve: &'a Side,
    faults: Vec<String>,
}

async fn each_role_may_do_what_the_table_says_on_its_own_data_alone(server: TestServer) {
    let (ada, root) = Side::new(&server, "ada", None).await;
    let (eve, _) = Side::new(&server, "eve", Some(&root)).await;
    let mut trial = Trial {
        server: &server,
        ada: &ada,
        eve: &eve,
        faults: Vec::new(),
    };
    let mut all = operations();
    // Reads come first, because attempts appear in the person's own audit log.
    all.sort_by_key(rank);
    for one in &all {
        trial.check_refusals(one).await;
    }
    for one in &all {
        trial.check_permissions(one).await;
    }
    assert!(trial.faults.is_empty(), "{:#?}", trial.faults);
    server.finish().await;
}

impl Trial<'_> {
    /// Sends an operation with a key, on data of that role on Ada's side or on unknown ids.
    async fn send(
        &self,
        one: &Operation,
        key: Option<&Key>,
        role: usize,
        real: bool,
    ) -> ApiResponse {
        let path = url(&self.ada.fill(&one.path, role, real));
        let mut sent = request(self.server, key, &one.method, &path);
        if one.has_body {
            sent = sent.json(&self.ada.body(&one.name));
        }
        response(sent).await
    }

    fn expect(&mut self, holds: bool, one: &Operation, who: &str, response: &ApiResponse) {
        if !holds {
            let excerpt: String = response.text.chars().take(160).collect();
            let fault = format!("{} as {who}: {} {excerpt}", one.name, response.status);
            self.faults.push(fault);
        }
    }

    /// Tries each operation without sign-in, as forbidden roles, and as every foreign role.
    async fn check_refusals(&mut self, one: &Operation) {
        let rule = rule(one);
        if rule == OPEN {
            return;
        }
        let nobody = self.send(one, None, 0, true).await;
        let holds = nobody.status == 401 && kind(&nobody) == "unauthenticated";
        self.expect(holds, one, "nobody", &nobody);
        for (index, role) in ROLES.iter().enumerate() {
            let sign = rule.as_bytes()[index];
            let expected = match sign {
                b'1' => 401,
                b'3' => 403,
                _ => 404,
            };
            if sign != b'+' {
                let own = self
                    .send(one, Some(&self.ada.keys[index]), index, true)
                    .await;
                self.expect(own.status == expected, one, role, &own);
            }
            // A platform admin belongs to neither side.
            if index > 6 {
                continue;
            }
            let key = self.eve.keys[index].clone();
            let who = format!("another's {role}");
            if sign != b'+' && sign != b'4' {
                let theirs = self.send(one, Some(&key), index, true).await;
                self.expect(theirs.status == expected, one, &who, &theirs);
            } else if one.name == IN_BODY {
                let theirs = self.send(one, Some(&key), index, true).await;
                self.expect(theirs.status == 404, one, &who, &theirs);
            } else if one.method == "GET" || one.path.contains('{') {
                self.check_not_found(one, (&key, index), &who).await;
            }
        }
    }

    /// Checks that a foreign object and an unknown one give the same response.
    async fn check_not_found(&mut self, one: &Operation, (key, role): (&Key, usize), who: &str) {
        let theirs = self.send(one, Some(key), role, true).await;
        for mark in &self.ada.marks {
            if theirs.text.contains(mark.as_str()) {
                let fault = format!("{} as {who} tells of {mark}", one.name);
                self.faults.push(fault);
            }
        }
        let by_id = one.path.contains("{id}") || one.path.contains("{stream}");
        let made_on_board = ["PUT /agents/logbook/{id}", "PUT /agents/azimuths/{id}"];
        if !by_id || made_on_board.contains(&one.name.as_str()) {
            return;
        }
        let nowhere = self.send(one, Some(key), role, false).await;
        let same = (theirs.status, kind(&theirs)) == (nowhere.status, kind(&nowhere));
        self.expect(same, one, who, &theirs);
        // An unreadable body is refused before the object is looked up.
        let unread = one.has_body && [400, 415, 422].contains(&theirs.status);
        self.expect(theirs.status == 404 || unread, one, who, &theirs);
    }

    /// Tries each operation as the roles that may do it.
    async fn check_permissions(&mut self, one: &Operation) {
        let rule = rule(one);
        if rule == OPEN {
            return;
        }
        let mut is_gone = false;
        for (index, role) in ROLES.iter().enumerate() {
            // The admin's own token has just ended her sessions.
            let ended = one.name == "DELETE /session" && index == 0;
            if rule.as_bytes()[index] != b'+' || ended {
                continue;
            }
            let own = self
                .send(one, Some(&self.ada.keys[index]), index, true)
                .await;
            let kind = kind(&own);
            let refused = ["unauthenticated", "forbidden", "internal"].contains(&kind.as_str());
            let missing = kind == "not-found" && !is_gone;
            self.expect(!refused && !missing && own.status < 500, one, role, &own);
            is_gone |= one.method == "DELETE" && own.status < 300;
        }
    }
}

fn rule(one: &Operation) -> &'static str {
    let line = TABLE.iter().find(|(name, _)| *name == one.name);
    line.unwrap_or_else(|| panic!("no line for {}", one.name)).1
}
