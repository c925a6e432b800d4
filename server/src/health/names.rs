//! Descriptions of the metrics of `/metrics`.

use metrics::{describe_counter, describe_gauge, describe_histogram, gauge};

/// Describes every metric, and names the release.
pub(super) fn describe() {
    describe_counter!("binnacle_analyses_total", "Analyses of vessels, by result");
    describe_counter!("binnacle_batches_total", "Batches uploaded, by result");
    describe_counter!(
        "binnacle_bytes_total",
        "Bytes of batches received and stored, and of responses to ships, by stage"
    );
    describe_counter!(
        "binnacle_delivery_tries_total",
        "Tries to deliver mail and webhooks, by channel and result"
    );
    describe_counter!(
        "binnacle_http_requests_total",
        "Requests, by method, route and status"
    );
    describe_gauge!("binnacle_build_info", "1, with the release as a label");
    describe_gauge!(
        "binnacle_database_connections",
        "Database connections in use, and the most there may be, by workload"
    );
    describe_gauge!("binnacle_disk_full", "1 while the database's disk is full");
    describe_gauge!("binnacle_event_streams", "Open streams of live events");
    describe_gauge!("binnacle_jobs", "Vessels to be analysed, by state");
    describe_gauge!(
        "binnacle_oldest_job_seconds",
        "Wait of the oldest analysis that is due"
    );
    describe_histogram!("binnacle_analysis_seconds", "Time of an analysis");
    describe_histogram!(
        "binnacle_database_wait_seconds",
        "Wait for a database connection, by workload"
    );
    describe_histogram!(
        "binnacle_http_request_seconds",
        "Time of a request, by route"
    );
    describe_histogram!("binnacle_schedule_seconds", "Time of making a schedule");
    gauge!("binnacle_build_info", "version" => env!("CARGO_PKG_VERSION")).set(1.0);
}
