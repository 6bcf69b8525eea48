//! `tumble merge`.

use tumble_sweep::Merge;

use crate::ending::check_ending;
use crate::failure::Failure;
use crate::interrupt;
use crate::sweep::options::MergeOptions;
use crate::sweep::plot::SweepPlot;

/// Writes the file that the whole sweep would have written on one machine.
pub(crate) fn merge(options: &MergeOptions) -> Result<(), Failure> {
    let out = &options.out;
    check_ending(out, "a sweep's file", "csv")?;
    interrupt::watch()?;
    let merge = Merge::open(out, &options.shards)?;
    let plot = SweepPlot::open(&options.plot, merge.columns(), options.shards.clone())?;
    if merge.write(&interrupt::asked)?.is_break() {
        return Err(Failure::Interrupted);
    }
    match plot {
        Some(plot) => plot.draw(out, &format!("{} shards", options.shards.len())),
        None => Ok(()),
    }
}
