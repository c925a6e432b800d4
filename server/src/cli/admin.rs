//! Arguments of `admin`, which manages operators, firms and users.

use super::Database;
use clap::{Args, Subcommand, ValueEnum};
use uuid::Uuid;

/// Arguments of `admin`.
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
    /// Reset a user who lost the password or the phone, and print a one-time code for a new
    /// password; removes password, second factor, sessions, API tokens, calendar feeds and the
    /// binding to a sign-in provider
    ResetUser {
        /// Email address that the user signs in with
        #[arg(long)]
        email: String,
    },
    /// Print a one-time code with which the first operator and its admin are made in the browser;
    /// only while there is no user
    FirstRun,
    /// Retire the key by which the server counter-signs work orders, and make the next; the old one
    /// stays published, so that older evidence can be checked
    RotateSigningKey,
    /// Seal all secrets in the database by the first key of --secrets-key; the keys after it open
    /// what they sealed
    SealSecrets,
    /// Revoke an agent's token; the agent must be enrolled again
    RevokeAgent {
        /// Id of the vessel
        #[arg(long)]
        vessel: Uuid,
        /// Id of the agent, as listed by `GET /api/v1/vessels/{id}/agents`
        #[arg(long)]
        agent: Uuid,
    },
}

/// Commands of `admin create`.
#[derive(Debug, Subcommand)]
pub enum Create {
    /// An operator: a company with a fleet
    Operator {
        /// Name of the company
        #[arg(long)]
        name: String,
    },
    /// A user who may see or manage an operator's fleet
    User {
        /// Id of the operator
        #[arg(long)]
        operator: Uuid,
        /// New user.
        #[command(flatten)]
        person: Person,
        /// Rights of the user
        #[arg(long, value_enum)]
        role: FleetRole,
    },
    /// A firm: a company that adjusts compasses
    Firm {
        /// Name of the company
        #[arg(long)]
        name: String,
        /// Id of an operator that works with the firm; may be repeated
        #[arg(long = "operator")]
        operators: Vec<Uuid>,
    },
    /// A user who adjusts compasses for a firm
    Adjuster {
        /// Id of the firm
        #[arg(long)]
        firm: Uuid,
        /// New user.
        #[command(flatten)]
        person: Person,
    },
    /// A sandbox: an operator and a firm to practise with, a simulated ship, and an order that is
    /// offered to the firm; prints passwords, API tokens and a reading to send
    Sandbox {
        /// Name of the operator
        #[arg(long, default_value = "Sandbox")]
        name: String,
    },
    /// A user who manages operators and firms
    PlatformAdmin {
        /// New user.
        #[command(flatten)]
        person: Person,
    },
}

/// User to be created.
#[derive(Debug, Args)]
pub struct Person {
    /// Email address that the user signs in with
    #[arg(long)]
    pub email: String,
    /// Name of the user
    #[arg(long)]
    pub name: String,
    /// Read the password from standard input; otherwise one is generated and printed
    #[arg(long)]
    pub password_stdin: bool,
}

/// Rights of an operator's user.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FleetRole {
    /// May see and change the fleet
    Admin,
    /// May see the fleet
    Viewer,
}
