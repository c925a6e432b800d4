//! A simulated ship with its line: sends sentences at the client's pace or in
//! real time.

use super::run::Run;
use crate::cli::BadInput;
use crate::clock;
use crate::line::TcpLine;
use anyhow::Result;
use binnacle_compass::time::Timestamp;
use binnacle_simulator::nmea::Talker;
use binnacle_simulator::scenario::{Scenario, ShipPlan};
use binnacle_simulator::ship::Ship;
use binnacle_simulator::truth::{Place, Truth, TruthRecorder, place};
use std::net::{Ipv4Addr, SocketAddr};
use std::time::Duration;

const BUFFER_BYTES: usize = 64 * 1024;
const LIVE_INTERVAL_S: f64 = 1.0;

pub(super) struct SimulatedShip {
    talker: Talker,
    recorder: TruthRecorder,
    line: TcpLine,
    buffer: Vec<u8>,
}

impl SimulatedShip {
    pub(super) fn new(
        scenario: &Scenario,
        plan: &ShipPlan,
        seed: u64,
        from: Timestamp,
    ) -> Result<SimulatedShip> {
        let ship = Ship::new(scenario, plan, seed, from)
            .map_err(|error| BadInput(format!("--until: {error}")))?;
        Ok(SimulatedShip {
            recorder: TruthRecorder::new(&ship),
            talker: Talker::new(scenario, ship, seed),
            line: TcpLine::listen(SocketAddr::from((Ipv4Addr::LOCALHOST, 0)))?,
            buffer: Vec::with_capacity(BUFFER_BYTES + 1024),
        })
    }

    pub(super) fn name(&self) -> &str {
        &self.plan().name
    }

    pub(super) fn plan(&self) -> &ShipPlan {
        self.talker.ship().plan()
    }

    pub(super) fn address(&self) -> Result<SocketAddr> {
        self.line.address()
    }

    pub(super) fn truth(&self, run: &Run<'_>) -> Truth {
        self.recorder
            .truth(&run.scenario, run.seed, self.talker.ship())
    }

    /// Returns the true curve at the ship's present place.
    pub(super) fn place(&self) -> Place {
        place(self.talker.ship())
    }

    /// Sails as fast as the client reads; waits while there is none.
    pub(super) async fn sail_to(
        &mut self,
        until: Timestamp,
        note: impl Fn(Timestamp),
    ) -> Result<()> {
        while self.talker.next_time() <= until {
            self.talker.write_group(&mut self.buffer);
            self.recorder.record(self.talker.ship());
            if self.buffer.len() >= BUFFER_BYTES {
                self.flush().await?;
                note(self.talker.ship().time());
            }
        }
        self.flush().await?;
        note(until);
        Ok(())
    }

    /// Sails by the wall clock less `shift_s`, after catching up with it.
    pub(super) async fn sail_live(&mut self, shift_s: f64) -> Result<()> {
        let now = || clock::now().plus_seconds(-shift_s);
        while now().seconds_since(self.talker.next_time()) > 60.0 {
            self.sail_to(now(), |_| {}).await?;
        }
        self.talker.set_interval(LIVE_INTERVAL_S);
        loop {
            let early_s = self.talker.next_time().seconds_since(now());
            if early_s > 0.0 {
                tokio::time::sleep(Duration::from_secs_f64(early_s)).await;
            }
            self.talker.write_group(&mut self.buffer);
            self.line.send_live(&self.buffer).await;
            self.buffer.clear();
        }
    }

    async fn flush(&mut self) -> Result<()> {
        self.line.send(&self.buffer).await?;
        self.buffer.clear();
        Ok(())
    }
}
