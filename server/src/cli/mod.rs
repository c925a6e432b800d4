//! Command line: every command with its flags.

mod admin;

pub use admin::{Admin, AdminCommand, Create, FleetRole, Person};

use binnacle_platform::config::{Database, Serve};
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;
use uuid::Uuid;

/// Binnacle server: ingest, analysis, API and dashboard, and the science on the command line.
#[derive(Debug, Parser)]
#[command(version, name = "binnacle-server")]
pub struct Cli {
    /// Command to run.
    #[command(subcommand)]
    pub command: Command,
}

/// Commands of this program.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Serve the API and the dashboard, and analyse what arrives
    Serve(Box<Serve>),
    /// Ask a running server whether it is ready
    Health(Health),
    /// Bring the database's schema up to date
    Migrate(Database),
    /// Copy the database into a file, while the server goes on
    Backup(Backup),
    /// Restore a backup into an empty database
    Restore(Backup),
    /// Create operators and users, revoke agents
    Admin(Admin),
    /// Store batches that were sent as short-burst messages
    Bursts(Bursts),
    /// Store the samples of recordings in a vessel's log
    Import(Import),
    /// Print the OpenAPI document
    Openapi,
    /// Print the earth's field at a place and time as JSON
    Field(Field),
    /// Fit a model to a CSV file
    Fit(Fit),
    /// Print the deviation that a model predicts
    Deviation(Deviation),
    /// Analyse a CSV file as the server analyses a vessel's uploads
    Analyse(Analyse),
    /// Check on your own recording whether predictions hold
    Validate(Validate),
    /// Check an archive of evidence of an adjustment
    VerifyEvidence(VerifyEvidence),
    /// Plan the setting of a binnacle's correctors, from a reading at the berth
    Plan(Plan),
    /// Plan who adjusts which compass, where and when
    Schedule(Schedule),
}

/// Arguments of `health`.
#[derive(Debug, Args)]
pub struct Health {
    /// Address of the server
    #[arg(default_value = "http://127.0.0.1:8080")]
    pub url: String,
}

/// Arguments of `backup` and `restore`.
#[derive(Debug, Args)]
pub struct Backup {
    /// Database to use.
    #[command(flatten)]
    pub database: Database,
    /// File of the backup
    pub file: PathBuf,
}

/// Arguments of `verify-evidence`.
#[derive(Debug, Args)]
pub struct VerifyEvidence {
    /// Archive to check
    pub file: PathBuf,
    /// Keys that the server has published, as `GET /api/v1/signing-keys` answers
    #[arg(long, value_name = "FILE")]
    pub keys: Option<PathBuf>,
}

/// Model of the earth's field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum FieldModel {
    /// International Geomagnetic Reference Field, 1900 to 2030
    #[default]
    Igrf14,
    /// World Magnetic Model, 2025 to 2030
    Wmm2025,
}

/// Arguments of `field`.
#[derive(Debug, Args)]
pub struct Field {
    /// Latitude in degrees, north positive
    #[arg(long, allow_negative_numbers = true)]
    pub lat: f64,
    /// Longitude in degrees, east positive
    #[arg(long, allow_negative_numbers = true)]
    pub lon: f64,
    /// Date: YYYY-MM-DD, RFC 3339 or a decimal year
    #[arg(long)]
    pub date: String,
    /// Altitude above the WGS 84 ellipsoid in metres
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    pub altitude_m: f64,
    /// Model of the earth's field
    #[arg(long, value_enum, default_value_t)]
    pub model: FieldModel,
}

/// Method of fitting.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// Equation 11 of Basterretxea-Iribar, Sotés and Uriarte 2016, for comparison
    Paper,
    /// Ordinary least squares on the exact deviation with equal weights, for comparison
    Ols,
    /// The product's estimator: correlated noise, outliers, and a prior from other ships
    #[default]
    Robust,
}

/// Handling of the gyro's error from the vessel's own speed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum GyroSpeedError {
    /// The gyro corrects the error
    #[default]
    Corrected,
    /// The gyro does not; the error is corrected here, from sog_kn and latitude
    Uncorrected,
}

impl From<GyroSpeedError> for binnacle_compass::settings::GyroSpeedError {
    fn from(choice: GyroSpeedError) -> Self {
        match choice {
            GyroSpeedError::Corrected => Self::Corrected,
            GyroSpeedError::Uncorrected => Self::Uncorrected,
        }
    }
}

/// Arguments of `fit`.
#[derive(Debug, Args)]
pub struct Fit {
    /// Samples as CSV; the first line names the columns
    pub file: PathBuf,
    /// Print JSON instead of a table
    #[arg(long)]
    pub json: bool,
    /// Method of fitting
    #[arg(long, value_enum, default_value_t)]
    pub method: Method,
    /// Handling of the gyro's error from the vessel's own speed
    #[arg(long, value_enum, default_value_t)]
    pub gyro_speed_error: GyroSpeedError,
}

/// Arguments of `deviation`.
#[derive(Debug, Args)]
pub struct Deviation {
    /// Output of `fit --json`
    #[arg(long)]
    pub model: PathBuf,
    /// Latitude in degrees, north positive
    #[arg(long, allow_negative_numbers = true, requires_all = ["lon", "date"], conflicts_with = "h_nt")]
    pub lat: Option<f64>,
    /// Longitude in degrees, east positive
    #[arg(long, allow_negative_numbers = true, requires = "lat")]
    pub lon: Option<f64>,
    /// Date: YYYY-MM-DD, RFC 3339 or a decimal year
    #[arg(long, requires = "lat")]
    pub date: Option<String>,
    /// Horizontal field in nT, instead of place and date
    #[arg(long, requires = "z_nt", required_unless_present = "lat")]
    pub h_nt: Option<f64>,
    /// Vertical field in nT, down positive
    #[arg(long, allow_negative_numbers = true, requires = "h_nt")]
    pub z_nt: Option<f64>,
    /// Degrees of compass heading between rows
    #[arg(long, default_value_t = 15.0)]
    pub step_deg: f64,
    /// Print JSON instead of a table
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `bursts`.
#[derive(Debug, Args)]
pub struct Bursts {
    /// Database to use.
    #[command(flatten)]
    pub database: Database,
    /// Vessel that sent the messages
    #[arg(long)]
    pub vessel: Uuid,
    /// Folder for the responses to the vessel, one message per stream
    #[arg(long)]
    pub answers: Option<PathBuf>,
    /// Messages as received, one per file, in any order; repeat earlier ones until a batch is
    /// complete
    #[arg(required = true)]
    pub messages: Vec<PathBuf>,
}

/// Arguments of `import`.
///
/// A sample that the log has already is not stored again, so the command may be repeated.
#[derive(Debug, Args)]
pub struct Import {
    /// Database to use.
    #[command(flatten)]
    pub database: Database,
    /// Vessel that made the recordings
    #[arg(long)]
    pub vessel: Uuid,
    /// Compass that was recorded; the vessel's first one by default
    #[arg(long)]
    pub compass: Option<Uuid>,
    /// Samples as CSV, as `binnacle-agent replay --csv` writes them
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
}

/// Arguments of `schedule`.
#[derive(Debug, Args)]
pub struct Schedule {
    /// Ships, needs, port calls and firms (docs/schedule.md)
    #[arg(long)]
    pub input: PathBuf,
}

/// Arguments of `plan`.
#[derive(Debug, Args)]
pub struct Plan {
    /// Output of `fit --json`
    #[arg(long)]
    pub model: PathBuf,
    /// Binnacle and its correctors (docs/binnacle.md)
    #[arg(long)]
    pub binnacle: PathBuf,
    /// Readings at the berth (docs/plan.md)
    #[arg(long)]
    pub berth: PathBuf,
    /// Magnetometer reading after the steps, to check whether they were done as planned
    #[arg(long)]
    pub after: Option<PathBuf>,
}

/// Arguments of `analyse`.
#[derive(Debug, Args)]
pub struct Analyse {
    /// Samples, in the format of `fit`, with time and place; columns for the field and the weight
    /// are ignored
    pub file: PathBuf,
    /// Logbook entries: a JSON array, or a page as the API returns it
    #[arg(long)]
    pub logbook: Option<PathBuf>,
    /// Handling of the gyro's error from the vessel's own speed
    #[arg(long, value_enum, default_value_t)]
    pub gyro_speed_error: GyroSpeedError,
}

/// Arguments of `validate`.
///
/// Says how often a reading was inside the band predicted for it before it was used, and how
/// well the model of one part of the recording predicts another part.
#[derive(Debug, Args)]
pub struct Validate {
    /// Recording, in the format of `analyse`: settled samples, or rows as often as every second
    pub file: PathBuf,
    /// Logbook entries: a JSON array, or a page as the API returns it
    #[arg(long)]
    pub logbook: Option<PathBuf>,
    /// Handling of the gyro's error from the vessel's own speed
    #[arg(long, value_enum, default_value_t)]
    pub gyro_speed_error: GyroSpeedError,
    /// Print JSON instead of text
    #[arg(long)]
    pub json: bool,
}
