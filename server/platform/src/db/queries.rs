//! Macros that run one SQL text on both databases.

/// Returns all rows of a query as a `Vec` of a type that is `FromRow` on both databases.
/// `rows!(db, Type, "SELECT …", binds…)`, or `rows!(in &mut tx, …)`.
#[macro_export]
macro_rules! rows {
    (in $tx:expr, $row:ty, $sql:expr $(, $bind:expr)* $(,)?) => {
        match $crate::db::Tx::connection($tx) {
            $crate::db::Connection::Sqlite(tx) => sqlx::query_as::<sqlx::Sqlite, $row>($sql)
                $(.bind($bind))*.fetch_all(&mut **tx).await,
            $crate::db::Connection::Postgres(tx) => sqlx::query_as::<sqlx::Postgres, $row>($sql)
                $(.bind($bind))*.fetch_all(&mut **tx).await,
        }
    };
    ($db:expr, $row:ty, $sql:expr $(, $bind:expr)* $(,)?) => {
        match $db.pools() {
            $crate::db::Pools::Sqlite { readers, .. } => sqlx::query_as::<sqlx::Sqlite, $row>($sql)
                $(.bind($bind))*.fetch_all(readers).await,
            $crate::db::Pools::Postgres(pool) => sqlx::query_as::<sqlx::Postgres, $row>($sql)
                $(.bind($bind))*.fetch_all(pool).await,
        }
    };
}

/// Returns the first row of a query, if any; otherwise like [`rows!`].
#[macro_export]
macro_rules! row {
    (in $tx:expr, $row:ty, $sql:expr $(, $bind:expr)* $(,)?) => {
        match $crate::db::Tx::connection($tx) {
            $crate::db::Connection::Sqlite(tx) => sqlx::query_as::<sqlx::Sqlite, $row>($sql)
                $(.bind($bind))*.fetch_optional(&mut **tx).await,
            $crate::db::Connection::Postgres(tx) => sqlx::query_as::<sqlx::Postgres, $row>($sql)
                $(.bind($bind))*.fetch_optional(&mut **tx).await,
        }
    };
    ($db:expr, $row:ty, $sql:expr $(, $bind:expr)* $(,)?) => {
        match $db.pools() {
            $crate::db::Pools::Sqlite { readers, .. } => sqlx::query_as::<sqlx::Sqlite, $row>($sql)
                $(.bind($bind))*.fetch_optional(readers).await,
            $crate::db::Pools::Postgres(pool) => sqlx::query_as::<sqlx::Postgres, $row>($sql)
                $(.bind($bind))*.fetch_optional(pool).await,
        }
    };
}

/// Runs a statement in a transaction and returns the number of affected rows:
/// `execute!(&mut tx, "UPDATE …", binds…)`.
#[macro_export]
macro_rules! execute {
    ($tx:expr, $sql:expr $(, $bind:expr)* $(,)?) => {
        match $crate::db::Tx::connection($tx) {
            $crate::db::Connection::Sqlite(tx) => sqlx::query::<sqlx::Sqlite>($sql)
                $(.bind($bind))*.execute(&mut **tx).await.map(|done| done.rows_affected()),
            $crate::db::Connection::Postgres(tx) => sqlx::query::<sqlx::Postgres>($sql)
                $(.bind($bind))*.execute(&mut **tx).await.map(|done| done.rows_affected()),
        }
    };
}
