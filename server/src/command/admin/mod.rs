//! `admin`: creates operators, firms and users, prints the code of the first run, resets users,
//! revokes agents and rotates keys.

mod sandbox;

pub use sandbox::{Account, Sandbox, create_sandbox};

use super::operate::block_on;
use super::{BadInput, print_result};
use crate::cli::{Admin, AdminCommand, Cli, Command, Create, FleetRole, Person};
use crate::health;
use crate::subscriptions::subscribers;
use anyhow::Result;
use binnacle_fleet::{enrolment, operators};
use binnacle_orders::firms;
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::clock::Clock;
use binnacle_platform::db::{Db, Tx};
use binnacle_platform::error::Error;
use binnacle_platform::ids::{AgentId, FirmId, OperatorId, VesselId};
use binnacle_platform::secret::{self, HashMemory};
use binnacle_platform::session::{self, Role};
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;
use binnacle_platform::{http, password, seal_rotation, signing_keys, users};
use clap::Parser;
use serde_json::json;
use std::io::Read;
use std::process::ExitCode;
use uuid::Uuid;

/// Creates or revokes something and prints it as JSON.
///
/// # Errors
/// Fails when the database cannot be reached.
pub fn admin(arguments: Admin) -> Result<ExitCode> {
    block_on(async {
        let db = arguments.database.open(subscribers()).await?;
        db.migrate().await?;
        let now = Clock::System.now().into();
        let name = name_of(&arguments.command);
        let request = RequestContext::of_command(&db, name, now);
        let made = run(&db, &request, arguments.command, now).await;
        db.close().await;
        print_result(made?.map(|made| made.to_string()).map_err(BadInput))
    })
}

/// Returns the command's name in the audit log.
fn name_of(command: &AdminCommand) -> &'static str {
    match command {
        AdminCommand::Create { what } => match what {
            Create::Operator { .. } => "admin create operator",
            Create::User { .. } => "admin create user",
            Create::Firm { .. } => "admin create firm",
            Create::Adjuster { .. } => "admin create adjuster",
            Create::Sandbox { .. } => "admin create sandbox",
            Create::PlatformAdmin { .. } => "admin create platform-admin",
        },
        AdminCommand::ResetUser { .. } => "admin reset-user",
        AdminCommand::FirstRun => "admin first-run",
        AdminCommand::RotateSigningKey => "admin rotate-signing-key",
        AdminCommand::SealSecrets => "admin seal-secrets",
        AdminCommand::RevokeAgent { .. } => "admin revoke-agent",
    }
}

async fn run(db: &Db, request: &RequestContext, command: AdminCommand, now: Time) -> Made {
    match command {
        AdminCommand::Create { what } => create(db, request, what, now).await,
        AdminCommand::ResetUser { email } => reset_user(request, &email, now).await,
        AdminCommand::FirstRun => print_first_run_code(db, request, now).await,
        AdminCommand::RotateSigningKey => rotate_signing_key(request, now).await,
        AdminCommand::SealSecrets => seal_secrets(request).await,
        AdminCommand::RevokeAgent { vessel, agent } => {
            request.concerns_vessel(VesselId(vessel), None);
            revoke_agent(request, VesselId(vessel), AgentId(agent), now).await
        }
    }
}

/// Created record, or the reason why the request is invalid.
type Made = Result<Result<serde_json::Value, String>>;

async fn create(db: &Db, request: &RequestContext, what: Create, now: Time) -> Made {
    match what {
        Create::Operator { name } => create_operator(request, &name, now).await,
        Create::User {
            operator,
            person,
            role,
        } => {
            let role = match role {
                FleetRole::Admin => Role::Admin,
                FleetRole::Viewer => Role::Viewer,
            };
            let operator = Tenant::Operator(OperatorId(operator));
            create_user(request, Some(operator), &person, role, now).await
        }
        Create::Firm { name, operators } => create_firm(request, &name, &operators, now).await,
        Create::Adjuster { firm, person } => {
            let firm = Tenant::Firm(FirmId(firm));
            create_user(request, Some(firm), &person, Role::Adjuster, now).await
        }
        Create::Sandbox { name } => print_sandbox(db, &name).await,
        Create::PlatformAdmin { person } => {
            create_user(request, None, &person, Role::PlatformAdmin, now).await
        }
    }
}

async fn reset_user(request: &RequestContext, email: &str, now: Time) -> Made {
    match users::reset(request, email, now).await? {
        Some((code, expires_at)) => Ok(Ok(json!({ "code": code, "expires_at": expires_at }))),
        None => Ok(Err(format!("--email: no user has the address {email:?}"))),
    }
}

async fn print_first_run_code(db: &Db, request: &RequestContext, now: Time) -> Made {
    match operators::make_first_run_code(db, request, now).await? {
        Some((code, expires_at)) => Ok(Ok(json!({ "code": code, "expires_at": expires_at }))),
        None => Ok(Err(
            "this server has users: ask one of them for an invitation, or reset a user".to_owned(),
        )),
    }
}

async fn rotate_signing_key(request: &RequestContext, now: Time) -> Made {
    let mut tx = request.begin().await?;
    let key = signing_keys::rotate(&mut tx, now).await?;
    tx.commit().await?;
    Ok(Ok(
        json!({ "public_key": key.public_key(), "created_at": now }),
    ))
}

async fn seal_secrets(request: &RequestContext) -> Made {
    let Some(key) = request.db().seals().current() else {
        return Ok(Err("--secrets-key: name the key that seals".to_owned()));
    };
    let mut tx = request.begin().await?;
    let sealed = seal_rotation::seal_all(&mut tx).await?;
    tx.commit().await?;
    Ok(Ok(json!({ "key": key, "sealed": sealed })))
}

async fn revoke_agent(
    request: &RequestContext,
    vessel: VesselId,
    agent: AgentId,
    now: Time,
) -> Made {
    match enrolment::revoke(request, vessel, agent, now).await {
        Ok(_) => Ok(Ok(json!({ "vessel_id": vessel, "agent_id": agent }))),
        Err(Error::NotFound(_)) => Ok(Err(format!("--agent: vessel {vessel} has no {agent}"))),
        Err(error) => Err(error.into()),
    }
}

async fn create_operator(request: &RequestContext, name: &str, now: Time) -> Made {
    let name = match http::text("--name", name) {
        Ok(name) => name,
        Err(error) => return Ok(Err(error.to_string())),
    };
    let mut tx = request.begin().await?;
    let id = operators::create(&mut tx, &name, now).await?;
    tx.commit().await?;
    Ok(Ok(json!({ "operator_id": id, "name": name })))
}

async fn print_sandbox(db: &Db, name: &str) -> Made {
    let name = match http::text("--name", name) {
        Ok(name) => name,
        Err(error) => return Ok(Err(error.to_string())),
    };
    let Command::Serve(config) = Cli::parse_from(["binnacle-server", "serve"]).command else {
        unreachable!("serve was asked for");
    };
    let app = App::new(
        db.clone(),
        Clock::System,
        *config,
        health::install_metrics()?,
    );
    let made = create_sandbox(&app, &name).await?;
    Ok(Ok(serde_json::to_value(made)?))
}

async fn create_firm(request: &RequestContext, name: &str, operators: &[Uuid], now: Time) -> Made {
    let name = match http::text("--name", name) {
        Ok(name) => name,
        Err(error) => return Ok(Err(error.to_string())),
    };
    let mut tx = request.begin().await?;
    let id = firms::create(&mut tx, &name, now).await?;
    for operator in operators {
        if !operators::exists(&mut tx, OperatorId(*operator)).await? {
            return Ok(Err(format!("--operator: {operator} does not exist")));
        }
        firms::engage(&mut tx, OperatorId(*operator), id, now).await?;
    }
    tx.commit().await?;
    Ok(Ok(
        json!({ "firm_id": id, "name": name, "operators": operators }),
    ))
}

/// Returns the kind of tenant that does not exist, if the id is unknown.
async fn missing(
    tx: &mut Tx,
    tenant: Option<Tenant>,
) -> binnacle_platform::db::Result<Option<String>> {
    let (flag, there) = match tenant {
        Some(Tenant::Operator(id)) => ("--operator", operators::exists(tx, id).await?),
        Some(Tenant::Firm(id)) => ("--firm", firms::exists(tx, id).await?),
        None => return Ok(None),
    };
    let id = tenant.map(Tenant::id).unwrap_or_default();
    Ok((!there).then(|| format!("{flag}: {id} does not exist")))
}

async fn create_user(
    request: &RequestContext,
    tenant: Option<Tenant>,
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
    let password = match read_password(person, &[&email, &name])? {
        Ok(password) => password,
        Err(message) => return Ok(Err(message)),
    };
    let password_or_none = password.as_deref().unwrap_or_default();
    let hash = secret::hash_password(password_or_none, &mut HashMemory::default())?;
    let mut tx = request.begin().await?;
    if let Some(missing) = missing(&mut tx, tenant).await? {
        return Ok(Err(missing));
    }
    let created = session::create_user(&mut tx, tenant, &email, &name, role, &hash, now).await;
    if let Some(tenant) = tenant {
        request.concerns(tenant);
    }
    let id = match created {
        Err(sqlx::Error::Database(error)) if error.is_unique_violation() => {
            return Ok(Err(format!("--email: {email} already has an account")));
        }
        created => created?,
    };
    tx.commit().await?;
    let mut made = json!({
        "user_id": id, "operator_id": tenant.and_then(Tenant::operator),
        "firm_id": tenant.and_then(Tenant::firm), "email": email, "name": name, "role": role,
    });
    if !person.password_stdin {
        made["password"] = json!(password);
    }
    Ok(Ok(made))
}

/// Returns the password from standard input, or generates one.
fn read_password(person: &Person, about: &[&str]) -> Result<Result<Option<String>, String>> {
    if !person.password_stdin {
        return Ok(Ok(Some(secret::new_password())));
    }
    let mut text = String::new();
    std::io::stdin().take(4096).read_to_string(&mut text)?;
    let password = text.trim_end_matches(['\r', '\n']);
    if let Err(error) = password::check("the password", password, about) {
        return Ok(Err(format!("standard input: {error}")));
    }
    Ok(Ok(Some(password.to_owned())))
}
