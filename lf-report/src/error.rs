//! What can go wrong while a report is written.

/// Why a report could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// A value that the caller put into the report cannot be reported.
    #[error("cannot report {what}: {why}")]
    InvalidArgument {
        /// Which value, with the reflector and method it belongs to.
        what: String,
        /// What is wrong with it.
        why: String,
    },
    /// The JSON text could not be produced.
    #[error("cannot write the report as JSON")]
    Json(#[source] serde_json::Error),
    /// The CSV text could not be produced.
    #[error("cannot write the report as CSV: {0}")]
    Csv(String),
    /// A file is no report that this version can compare with.
    #[error("cannot compare with this report: {0}")]
    Baseline(String),
    /// The plot could not be drawn.
    #[error("cannot draw the plot: {0}")]
    Plot(String),
}
