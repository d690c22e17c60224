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
    /// The plot could not be drawn.
    #[error("cannot draw the plot: {0}")]
    Plot(String),
}
