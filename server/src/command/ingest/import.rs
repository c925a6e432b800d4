//! `import`: stores the samples of recordings in a vessel's log.

use super::samples::{self, ImportedSamples, import_samples};
use crate::cli::{GyroSpeedError, Import};
use crate::command::analyse::read_samples;
use crate::command::operate::block_on;
use crate::command::{BadInput, json, print_result};
use crate::subscriptions::subscribers;
use anyhow::Result;
use binnacle_compass::sample::Sample;
use binnacle_platform::clock::Clock;
use binnacle_platform::error::Error;
use binnacle_platform::ids::{CompassId, VesselId};
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

/// Stores the samples and prints the outcome as JSON, with the progress on standard error. All
/// files are read and checked before anything is stored.
///
/// # Errors
/// Fails when the database cannot be reached.
pub fn import(arguments: &Import) -> Result<ExitCode> {
    let samples = match read_all(&arguments.files) {
        Ok(samples) => samples,
        Err(error) => return print_result(Err(error)),
    };
    let total = samples.len();
    let import = samples::Import {
        vessel: VesselId(arguments.vessel),
        compass: arguments.compass.map(CompassId),
        samples,
    };
    let imported = block_on(async {
        let db = arguments.database.open(subscribers()).await?;
        db.migrate().await?;
        let now = Clock::System.now().into();
        let report = |imported: ImportedSamples| report_progress(imported, total);
        let imported = import_samples(&db, import, now, report).await;
        db.close().await;
        anyhow::Ok(imported)
    })?;
    match imported {
        Ok(imported) => print_result(Ok(json(&imported))),
        Err(error @ Error::Internal(_)) => Err(error.into()),
        Err(error) => print_result(Err(BadInput(error.to_string()))),
    }
}

fn read_all(files: &[PathBuf]) -> Result<Vec<Sample>, BadInput> {
    let mut samples = Vec::new();
    for file in files {
        let of_file = read_samples(file, GyroSpeedError::default())?;
        for (index, sample) in of_file.iter().enumerate() {
            binnacle_wire::codec::check(sample, index)
                .map_err(|error| BadInput(format!("{}: {error}", file.display())))?;
        }
        samples.extend(of_file);
    }
    Ok(samples)
}

/// Reports the progress; a closed standard error does not stop the import.
fn report_progress(imported: ImportedSamples, total: usize) {
    let ImportedSamples {
        stored, repeated, ..
    } = imported;
    let done = stored + repeated;
    writeln!(
        io::stderr().lock(),
        "{done} of {total} samples: {stored} stored, {repeated} there already"
    )
    .ok();
}
