//! Configuration of the commands.

use super::bad_input::BadInput;
use crate::config::Config;
use crate::uplink::ServerClient;
use std::path::Path;

pub(super) fn load(path: &Path) -> Result<Config, BadInput> {
    let config = Config::load(path)?;
    // Find an unusable certificate now, not at the first upload.
    ServerClient::new(
        config.uplink.pinned_ca.as_deref(),
        &config.uplink.connection_policy(),
    )
    .map_err(|e| BadInput(format!("{e:#}")))?;
    Ok(config)
}
