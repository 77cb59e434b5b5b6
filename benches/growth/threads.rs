//! A picture on one thread and on two, and a model of more.

use std::sync::Mutex;

use merlkit_evaluate::measure::cost::{CallCost, thread_seconds, time};
use rayon::ThreadPoolBuilder;

use crate::fit::Exponent;
use crate::picture::Picture;

/// Pixels a side.
const SIDE: usize = 256;
const PATHS: u64 = 16;
/// Pictures of each number of threads.
const ROUNDS: usize = 16;
/// Threads of the model.
const MODELLED: [usize; 7] = [1, 2, 4, 8, 16, 32, 64];

/// Wall and CPU seconds of one and two threads, in turn.
fn measure(picture: &Picture) -> [[f64; 2]; 2] {
    let pools = [1, 2].map(|n| {
        let pool = ThreadPoolBuilder::new().num_threads(n).build();
        pool.expect("a pool of threads")
    });
    let mut rounds = [const { [Vec::new(), Vec::new()] }; 2];
    for _ in 0..ROUNDS {
        for (pool, [wall, cpu]) in pools.iter().zip(&mut rounds) {
            let (_, seconds) = time(|| pool.install(|| picture.render(SIDE, PATHS, &|_| {})));
            wall.push(seconds.wall);
            cpu.push(seconds.cpu);
        }
    }
    rounds.map(|columns| columns.map(|column| CallCost::from_rounds(column).ns))
}

/// CPU seconds of each row on one thread, and of all that is done apart from rows: the least of several pictures, which other
/// programs disturb least. The time of a row is that between two calls for progress.
fn row_seconds(picture: &Picture) -> (Vec<f64>, f64) {
    let (mut rows, mut apart) = (vec![f64::INFINITY; SIDE], f64::INFINITY);
    for _ in 0..ROUNDS {
        let start = thread_seconds();
        let ends = Mutex::new(Vec::new());
        picture.render(SIDE, PATHS, &|pixels| {
            if pixels > 0 {
                ends.lock().expect("times").push(thread_seconds() - start);
            }
        });
        let total = thread_seconds() - start;
        let ends = ends.into_inner().expect("times");
        assert_eq!(ends.len(), SIDE, "one call for progress a row");
        // The first row begins when the picture has been set up, which takes less than a row: it counts as the second does.
        for (row, ends) in ends.windows(2).enumerate() {
            rows[row + 1] = rows[row + 1].min(ends[1] - ends[0]);
        }
        rows[0] = rows[1];
        apart = apart.min((ends[0] - rows[0]).max(0.0) + total - ends[SIDE - 1]);
    }
    (rows, apart)
}

/// When the last of `threads` threads is done, if each takes the next row as soon as it has none.
fn last_end(rows: &[f64], threads: usize) -> f64 {
    let mut ends = vec![0.0f64; threads];
    for row in rows {
        ends.sort_by(f64::total_cmp);
        ends[0] += row;
    }
    ends.into_iter().fold(0.0, f64::max)
}

pub fn print() {
    let picture = Picture::new();
    let (rows, apart) = row_seconds(&picture);
    let measured = measure(&picture);
    println!("\n## Threads\n");
    println!(
        "{SIDE} × {SIDE} pixels, {PATHS} paths each. Apart from the {SIDE} rows: {:.2} ms; the rows: {:.1} ms, of which the longest is {:.2} ms.\n",
        1e3 * apart,
        1e3 * rows.iter().sum::<f64>(),
        1e3 * rows.iter().copied().fold(0.0, f64::max)
    );
    println!(
        "| threads | wall, s | CPU, s | wall by the model, s | faster than one, model |\n|---|---|---|---|---|"
    );
    let one = apart + last_end(&rows, 1);
    let mut points = Vec::new();
    for threads in MODELLED {
        let seconds = apart + last_end(&rows, threads);
        points.push((threads as f64, seconds));
        let [wall, cpu] = match measured.get(threads - 1) {
            Some(measured) => measured.map(|s| format!("{s:.4}")),
            None => ["–", "–"].map(str::to_owned),
        };
        println!(
            "| {threads} | {wall} | {cpu} | {seconds:.4} | {:.1} × |",
            one / seconds
        );
    }
    println!("| exponent | | | {} | |", Exponent::fit(&points).cell());
}
