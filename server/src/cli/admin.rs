//! `admin`: who there is, from the command line.

use super::Database;
use clap::{Args, Subcommand, ValueEnum};
use uuid::Uuid;

/// `admin`.
#[derive(Debug, Args)]
pub struct Admin {
    /// Database to use.
    #[command(flatten)]
    pub database: Database,
    /// Command to run.
    #[command(subcommand)]
    pub command: AdminCommand,
}

/// Commands of `admin`.
#[derive(Debug, Subcommand)]
pub enum AdminCommand {
    /// Create something and print it as JSON
    Create {
        /// Thing to create.
        #[command(subcommand)]
        what: Create,
    },
    /// Give someone who lost password or telephone a one-time code to begin anew with:
    /// password, second factor, sessions, API tokens, calendars and whom a sign-in provider
    /// means are gone
    ResetUser {
        /// Email address the person signs in with
        #[arg(long)]
        email: String,
    },
    /// Revoke an agent's token: it is known no more until the agent is enrolled again
    RevokeAgent {
        /// The vessel's id
        #[arg(long)]
        vessel: Uuid,
        /// The agent's id, as `GET /api/v1/vessels/{id}/agents` lists it
        #[arg(long)]
        agent: Uuid,
    },
}

/// Commands of `admin create`.
#[derive(Debug, Subcommand)]
pub enum Create {
    /// A company with a fleet
    Operator {
        /// Its name
        #[arg(long)]
        name: String,
    },
    /// Someone who may see, or manage, an operator's fleet
    User {
        /// The operator's id
        #[arg(long)]
        operator: Uuid,
        /// New person.
        #[command(flatten)]
        person: Person,
        /// May the user change things?
        #[arg(long, value_enum)]
        role: FleetRole,
    },
    /// A company that adjusts compasses
    Firm {
        /// Its name
        #[arg(long)]
        name: String,
        /// The id of an operator that works with it, as often as there are such
        #[arg(long = "operator")]
        operators: Vec<Uuid>,
    },
    /// Someone who adjusts compasses for a firm
    Adjuster {
        /// The firm's id
        #[arg(long)]
        firm: Uuid,
        /// New person.
        #[command(flatten)]
        person: Person,
    },
    /// Someone who manages operators and firms
    PlatformAdmin {
        /// New person.
        #[command(flatten)]
        person: Person,
    },
}

/// A person to be created.
#[derive(Debug, Args)]
pub struct Person {
    /// Email address the person signs in with
    #[arg(long)]
    pub email: String,
    /// The person's name
    #[arg(long)]
    pub name: String,
    /// Read the password from standard input; otherwise one is made and printed
    #[arg(long)]
    pub password_stdin: bool,
}

/// Rights of an operator's user.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FleetRole {
    /// See and change
    Admin,
    /// See
    Viewer,
}
