//! Instants in the databases and in JSON.

use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};
use sqlx::encode::IsNull;
use sqlx::error::BoxDynError;
use sqlx::{Database, Decode, Encode, Type};
use utoipa::ToSchema;

/// Instant: BIGINT microseconds in the database, RFC 3339 in JSON.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
#[serde(transparent)]
#[schema(description = "An instant, RFC 3339.", value_type = String, format = DateTime, example = "2026-11-21T07:00:00Z")]
pub struct Time(pub Timestamp);

impl From<Timestamp> for Time {
    fn from(time: Timestamp) -> Time {
        Time(time)
    }
}

impl Time {
    /// Returns the day in UTC for people: `2026-11-21`.
    pub fn day(self) -> String {
        self.0.to_string().chars().take(10).collect()
    }

    /// Returns the time to the minute for people: `2026-11-21 07:00 UTC`.
    pub fn to_the_minute(self) -> String {
        let text = self.0.to_string();
        let minute: String = text.chars().take(16).collect();
        format!("{} UTC", minute.replace('T', " "))
    }
}

impl<DB: Database> Type<DB> for Time
where
    i64: Type<DB>,
{
    fn type_info() -> DB::TypeInfo {
        i64::type_info()
    }

    fn compatible(info: &DB::TypeInfo) -> bool {
        i64::compatible(info)
    }
}

impl<'q, DB: Database> Encode<'q, DB> for Time
where
    i64: Encode<'q, DB>,
{
    fn encode_by_ref(&self, buffer: &mut DB::ArgumentBuffer) -> Result<IsNull, BoxDynError> {
        self.0.micros().encode_by_ref(buffer)
    }
}

impl<'r, DB: Database> Decode<'r, DB> for Time
where
    i64: Decode<'r, DB>,
{
    fn decode(value: DB::ValueRef<'r>) -> Result<Time, BoxDynError> {
        Ok(Time(Timestamp::from_micros(i64::decode(value)?)?))
    }
}
