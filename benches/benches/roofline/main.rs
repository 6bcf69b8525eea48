//! How close a step comes to what the machine can do at all: the bytes that it must move and the
//! operations that it must do, against bandwidth and arithmetic rate measured in the same run.
//!
//! `cargo bench --bench roofline`; what the columns mean is printed with them. The step is that of
//! the default integrator over boxes under gravity. The rates are measured by code of another
//! library in the widest registers of the machine, so that a step in narrower ones
//! (`TUMBLE_SIMD=avx2`) is measured against what it could have had.

#[path = "../lanes/mod.rs"]
mod lanes;

mod body_step;
mod counted;
mod gravity;
mod machine;

use std::time::Instant;

use hecs::World;
use rayon::ThreadPool;
use tumble::math::PRECISION;
use tumble::{Settings, Simulation, simd_name};
use tumble_benches::{Arguments, pool, tumbling_boxes};

use crate::body_step::{Traffic, operations};
use crate::counted::Operations;
use crate::machine::{Arithmetic, Effort, arithmetic, copy_bandwidth, update_bandwidth};

/// Bodies whose operations are counted: enough that their mean is good to a percent.
const COUNTED: usize = 2_000;

const NAME: &str = "roofline";

const COLUMNS: &str = "\
| bodies | memory [MB] | copy [GB/s] | update [GB/s] | by copy [ns] | by update [ns] | arithmetic [ns] | step [ns] \
| step [M/s] | of copy | of limit |
|---|---|---|---|---|---|---|---|---|---|---|---|";

/// What the columns of the table are.
const LEGEND: &str = "
  bodies      boxes in the world, and the memory that their components take
  copy        bandwidth of copying one half of as much memory to the other, bytes read plus bytes written
  update      bandwidth of multiplying every number of as much memory in place, bytes read plus bytes written
  by copy     the least time for the bytes of a body-step at the bandwidth of copying
  by update   the same at that of updating; what a step does is nearer to this, since it writes where it reads
  arithmetic  the least time for its operations: additions and multiplications, or divisions and roots, whichever takes longer;
              comparisons and selections are left out
  step        the time of a body-step, the median of blocks, and how many million of them that is a second
  of copy     by copy over step: what a step reaches of the bandwidth of copying
  of limit    the largest least time over step: at the bandwidth that is the larger, or of the arithmetic
";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::of_program();
    if arguments.is_list {
        arguments.print_list(&[NAME]);
    }
    if arguments.is_list || !arguments.select(NAME) {
        return Ok(());
    }
    let testing = arguments.is_test;
    let effort = if testing { Effort { block: 1e-4, blocks: 1 } } else { Effort { block: 0.03, blocks: 9 } };
    let sizes: &[usize] = if testing { &[1_000] } else { &[1_000, 10_000, 100_000, 1_000_000] };

    let (traffic, settings) = (Traffic::of_a_box(), Settings::default());
    let operations = operations(&mut tumbling_boxes(COUNTED), settings.dt);
    println!("tumble: moser-veselov, {PRECISION}, {}\n", simd_name());
    print_traffic(&traffic);
    let needed = print_operations(operations);
    for threads in [1, 2] {
        let pool = pool(threads);
        let rates = arithmetic(&pool, effort);
        let (simple, slow) = (rates.simple * 1e-9, rates.slow * 1e-9);
        println!(
            "\n{threads} thread(s): {simple:.0} G additions and multiplications, {slow:.1} G divisions and roots a second\n"
        );
        println!("{COLUMNS}");
        for &size in sizes {
            print_row(size, &traffic, needed, rates, &pool, effort)?;
        }
        let pull = gravity::operations();
        println!("\ngravity among bodies, of a pull: {} + - x, {} / sqrt\n", pull.simple, pull.slow);
        println!(
            "| bodies | + - x [ns] | / sqrt [ns] | step by pull [ns] | [M/s] | of limit |\n|---|---|---|---|---|---|"
        );
        for bodies in if testing { [64, 64, 64] } else { [256, 1024, 4096] } {
            gravity::print_row(bodies, pull, rates, &pool, effort)?;
        }
    }
    println!("{LEGEND}");
    Ok(())
}

fn print_traffic(traffic: &Traffic) {
    println!("bytes of a body-step:\n\n| component | size | read | written |\n|---|---|---|---|");
    for (name, size, read, written) in traffic.columns {
        println!("| {name} | {size} | {read} | {written} |");
    }
    let (size, read, written) = (traffic.size(), traffic.read(), traffic.written());
    println!(
        "| all | {size} | {read} | {written} |\n\n{} bytes move; where a cache line is fetched before",
        read + written
    );
    println!(
        "it is written to, as it is by ordinary stores, {} more, which the limits leave out.",
        traffic.allocated()
    );
}

fn print_operations([drift, rest]: [Operations; 2]) -> Operations {
    println!(
        "\noperations of a body-step, means over {COUNTED} boxes taken one by one; a tile goes on until the last of its bodies is done:\n"
    );
    println!("| part | + - x | / sqrt | compare, select, negate |\n|---|---|---|---|");
    let mut all = drift;
    all += rest;
    for (name, done) in
        [("free rotation, counted in the engine's map", drift), ("all else, from its formulas", rest), ("all", all)]
    {
        println!("| {name} | {:.1} | {:.1} | {:.1} |", done.simple, done.slow, done.logical);
    }
    all
}

fn print_row(
    size: usize,
    traffic: &Traffic,
    needed: Operations,
    rates: Arithmetic,
    pool: &ThreadPool,
    effort: Effort,
) -> Result<(), Box<dyn std::error::Error>> {
    let working_set = size * traffic.size();
    let (copy, update) = (copy_bandwidth(pool, working_set, effort), update_bandwidth(pool, working_set, effort));
    let bytes = (traffic.read() + traffic.written()) as f64;
    let [by_copy, by_update] = [copy, update].map(|bandwidth| bytes / bandwidth * 1e9);
    let arithmetic = (needed.simple / rates.simple).max(needed.slow / rates.slow) * 1e9;
    let step = step_time(&mut tumbling_boxes(size), size, pool, effort)?;
    let (of_copy, of_limit) = (100.0 * by_copy / step, 100.0 * by_copy.min(by_update).max(arithmetic) / step);
    let (memory, copy, update) = (working_set as f64 * 1e-6, copy * 1e-9, update * 1e-9);
    print!("| {size} | {memory:.2} | {copy:.1} | {update:.1} | {by_copy:.2} | {by_update:.2} | {arithmetic:.2} ");
    println!("| {step:.2} | {:.1} | {of_copy:.0} % | {of_limit:.0} % |", 1e3 / step);
    Ok(())
}

/// The median time of a body-step \[ns\].
fn step_time(
    world: &mut World,
    size: usize,
    pool: &ThreadPool,
    effort: Effort,
) -> Result<f64, Box<dyn std::error::Error>> {
    let mut simulation = Simulation::new(Settings::default())?;
    let mut block = |steps: u32| {
        let start = Instant::now();
        pool.install(|| (0..steps).for_each(|_| simulation.step(world)));
        start.elapsed().as_secs_f64()
    };
    let once = block(2) * 0.5;
    let steps = (effort.block / once).clamp(1.0, 1e6) as u32;
    let mut times: Vec<f64> = (0..effort.blocks).map(|_| block(steps)).collect();
    times.sort_by(f64::total_cmp);
    Ok(times[times.len() / 2] * 1e9 / (f64::from(steps) * size as f64))
}
