//! The commands `export` and `replay`.

use super::bad_input::BadInput;
use super::configuration::load;
use crate::atomic_file::write_atomically;
use crate::clock;
use crate::config::Config;
use crate::raw_log::{self, Span};
use crate::replay::{self, Recordings};
use binnacle_compass::time::Timestamp;
use binnacle_instruments::config::{RolesConfig, SilenceConfig};
use std::io::Write;
use std::path::{Path, PathBuf};

pub(super) fn parse_time(flag: &str, text: Option<&str>) -> Result<Option<Timestamp>, BadInput> {
    text.map(Timestamp::parse)
        .transpose()
        .map_err(|error| BadInput(format!("{flag}: {error}")))
}

pub(super) fn export(config: &Config, span: Span, csv: Option<&Path>) -> anyhow::Result<()> {
    let raw_log = raw_log::path(&config.data_dir);
    if !raw_log.exists() {
        return Err(BadInput(format!("{}: there is no raw log yet", raw_log.display())).into());
    }
    let rows = match csv {
        Some(path) => write_atomically(path, |out| raw_log::export(&raw_log, span, out))?,
        None => raw_log::export(&raw_log, span, &mut std::io::stdout().lock())?,
    };
    writeln!(std::io::stderr(), "{rows} seconds")?;
    Ok(())
}

/// Options of `replay`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Options<'a> {
    pub(super) config: Option<&'a Path>,
    pub(super) csv: Option<&'a Path>,
    /// Cycles of 1,024 weeks that are added to the dates of receivers.
    pub(super) roll_overs: u8,
}

pub(super) fn replay(files: &[PathBuf], options: Options<'_>) -> anyhow::Result<()> {
    let (roles, silence) = match options.config {
        Some(path) => {
            let config = load(path)?;
            (config.roles, config.silence)
        }
        None => (RolesConfig::usual(), SilenceConfig::default()),
    };
    let recordings = Recordings {
        files,
        roles: &roles,
        silence: &silence,
        roll_overs: options.roll_overs.into(),
        now: clock::now(),
    };
    let replayed = replay::replay(&recordings).map_err(|e| BadInput(format!("{e:#}")))?;
    let table = replayed.csv()?;
    match options.csv {
        Some(path) => {
            write_atomically(path, |out| Ok(out.write_all(&table)?))
                .map_err(|e| BadInput(format!("{e:#}")))?;
        }
        None => std::io::stdout().write_all(&table)?,
    }
    writeln!(std::io::stderr(), "{}", replayed.report())?;
    Ok(())
}
