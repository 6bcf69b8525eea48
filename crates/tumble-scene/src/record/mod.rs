//! What a run leaves: trajectories, animations, summaries, plots and reports.

pub(crate) mod body_drawing;
pub(crate) mod colors;
pub(crate) mod csv_cell;
pub(crate) mod plot;
pub(crate) mod report_page;
pub(crate) mod run_status;
pub(crate) mod summary;
pub(crate) mod svg;
pub(crate) mod trajectory;
