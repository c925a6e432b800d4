//! `admin create …`: what must exist before anyone can sign in; and `admin revoke-agent`.

use super::operate::block_on;
use super::{BadInput, answer};
use crate::clock::Clock;
use crate::config::{Admin, AdminCommand, Create, FleetRole, Person};
use crate::db::Db;
use crate::error::Error;
use crate::ids::{AgentId, OperatorId, VesselId};
use crate::session::{self, Role};
use crate::time::Time;
use crate::{enrolment, http, operators, secret};
use anyhow::Result;
use serde_json::json;
use std::io::Read;
use std::process::ExitCode;

const LEAST_PASSWORD: usize = 10;

/// Creates or revokes something and prints it as JSON.
///
/// # Errors
/// When the database cannot be reached.
pub fn admin(arguments: Admin) -> Result<ExitCode> {
    block_on(async {
        let db = Db::connect(&arguments.database.database_url).await?;
        db.migrate().await?;
        let now = Clock::System.now().into();
        let made = match arguments.command {
            AdminCommand::Create { what } => create(&db, what, now).await,
            AdminCommand::RevokeAgent { vessel, agent } => {
                revoke_agent(&db, VesselId(vessel), AgentId(agent), now).await
            }
        };
        db.close().await;
        answer(made?.map(|made| made.to_string()).map_err(BadInput))
    })
}

/// What was made, or what was wrong with the request.
type Made = Result<Result<serde_json::Value, String>>;

async fn create(db: &Db, what: Create, now: Time) -> Made {
    match what {
        Create::Operator { name } => create_operator(db, &name, now).await,
        Create::User {
            operator,
            person,
            role,
        } => {
            let role = match role {
                FleetRole::Admin => Role::Admin,
                FleetRole::Viewer => Role::Viewer,
            };
            create_user(db, Some(OperatorId(operator)), &person, role, now).await
        }
        Create::PlatformAdmin { person } => {
            create_user(db, None, &person, Role::PlatformAdmin, now).await
        }
    }
}

async fn revoke_agent(db: &Db, vessel: VesselId, agent: AgentId, now: Time) -> Made {
    match enrolment::revoke(db, vessel, agent, now).await {
        Ok(_) => Ok(Ok(json!({ "vessel_id": vessel, "agent_id": agent }))),
        Err(Error::NotFound(_)) => Ok(Err(format!("--agent: vessel {vessel} has no {agent}"))),
        Err(error) => Err(error.into()),
    }
}

async fn create_operator(db: &Db, name: &str, now: Time) -> Made {
    let name = match http::text("--name", name) {
        Ok(name) => name,
        Err(error) => return Ok(Err(error.to_string())),
    };
    let mut tx = db.begin().await?;
    let id = operators::create(&mut tx, &name, now).await?;
    tx.commit().await?;
    Ok(Ok(json!({ "operator_id": id, "name": name })))
}

async fn create_user(
    db: &Db,
    operator: Option<OperatorId>,
    person: &Person,
    role: Role,
    now: Time,
) -> Made {
    let checked = http::text("--email", &person.email)
        .and_then(|email| Ok((email, http::text("--name", &person.name)?)));
    let (email, name) = match checked {
        Ok(checked) => checked,
        Err(error) => return Ok(Err(error.to_string())),
    };
    if !email.contains('@') {
        return Ok(Err(format!("--email: {email:?} is not an e-mail address")));
    }
    let password = match read_password(person)? {
        Ok(password) => password,
        Err(message) => return Ok(Err(message)),
    };
    let hash = secret::hash_password(password.as_deref().unwrap_or_default())?;
    let mut tx = db.begin().await?;
    if let Some(operator) = operator
        && !operators::exists(&mut tx, operator).await?
    {
        return Ok(Err(format!("--operator: {operator} does not exist")));
    }
    let created = session::create_user(&mut tx, operator, &email, &name, role, &hash, now).await;
    let id = match created {
        Err(sqlx::Error::Database(error)) if error.is_unique_violation() => {
            return Ok(Err(format!("--email: {email} has an account already")));
        }
        created => created?,
    };
    tx.commit().await?;
    let mut made = json!({
        "user_id": id, "operator_id": operator, "email": email, "name": name, "role": role,
    });
    if !person.password_stdin {
        made["password"] = json!(password);
    }
    Ok(Ok(made))
}

/// The password from standard input, or a new one.
fn read_password(person: &Person) -> Result<Result<Option<String>, String>> {
    if !person.password_stdin {
        return Ok(Ok(Some(secret::new_password())));
    }
    let mut text = String::new();
    std::io::stdin().take(4096).read_to_string(&mut text)?;
    let password = text.trim_end_matches(['\r', '\n']);
    if password.chars().count() < LEAST_PASSWORD {
        return Ok(Err(format!(
            "standard input: the password has fewer than {LEAST_PASSWORD} characters"
        )));
    }
    Ok(Ok(Some(password.to_owned())))
}
