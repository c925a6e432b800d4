//! Configuration of the commands.

use super::bad_input::BadInput;
use crate::config::{Config, ConfigError};
use crate::short_burst::FileModem;
use crate::uplink::ServerClient;
use binnacle_input::InputConfig;
use std::path::Path;
use std::{fs, io};

/// Loads a configuration whose files and directories need not be there.
pub(super) fn load(path: &Path) -> Result<Config, BadInput> {
    Ok(Config::load(path)?)
}

/// Loads a configuration with the files that it names: what cannot be used is found now, and not
/// at the first connection.
pub(super) fn load_with_files(path: &Path) -> Result<Config, BadInput> {
    let config = Config::load(path)?;
    let uplink = &config.uplink;
    ServerClient::new(uplink.pinned_ca.as_deref(), &uplink.connection_policy())
        .map_err(|error| wrong(path, &["uplink", "pinned_ca"], &error))?;
    for (name, input) in &config.inputs {
        let of_input = |keys: &[&str], error: io::Error| {
            wrong(path, &[&["inputs", name], keys].concat(), &error.into())
        };
        match input {
            InputConfig::File(file) => {
                fs::File::open(file).map_err(|error| of_input(&["file"], error))?;
            }
            InputConfig::SignalK(server) => {
                let authorities = server.load_authorities();
                authorities.map_err(|error| of_input(&["signalk", "ca"], error))?;
            }
            _ => {}
        }
    }
    Ok(config)
}

/// Loads a configuration to run by, with its files and directories, which are made if necessary.
pub(super) fn load_to_run(path: &Path) -> Result<Config, BadInput> {
    let config = load_with_files(path)?;
    fs::create_dir_all(&config.data_dir)
        .map_err(|error| wrong(path, &["data_dir"], &error.into()))?;
    if let Some(modem) = &config.modem {
        FileModem::open(modem.directory())
            .map_err(|error| wrong(path, &["modem", "directory"], &error.into()))?;
    }
    Ok(config)
}

fn wrong(path: &Path, keys: &[&str], error: &anyhow::Error) -> BadInput {
    ConfigError::of_field(path, keys, format!("{error:#}")).into()
}
