//! Tables in integers: every row and node at least one unit, and sums exact.

use super::tables::{NODE_SUM, ONE};

/// Cumulative probabilities of `masses`, which sum to 1 and are ≥ 0, each at least one unit: nothing is left out.
pub fn quantise_rows(masses: &[f64]) -> Vec<u16> {
    let (n, mut sum, mut last) = (masses.len(), 0.0, 0u32);
    let room = |i: usize| u32::from(ONE) - (n - 1 - i) as u32;
    let step = |(i, mass): (usize, &f64)| {
        sum += mass;
        let at = if i + 1 == n {
            u32::from(ONE)
        } else {
            (sum * f64::from(ONE)).round() as u32
        };
        last = at.clamp(last + 1, room(i));
        last as u16
    };
    masses.iter().enumerate().map(step).collect()
}

/// Nodes of a density, ≥ 0 and not all 0, scaled to [`NODE_SUM`] and each at least one unit.
pub fn quantise_nodes(density: &[f64]) -> Vec<u16> {
    let last = density.len() - 1;
    // The two ends count once, the others twice.
    let weight = |i: usize| if i == 0 || i == last { 1 } else { 2 };
    let sum: f64 = density
        .iter()
        .enumerate()
        .map(|(i, d)| d * f64::from(weight(i)))
        .sum();
    let scale = f64::from(NODE_SUM) / sum;
    let (mut nodes, mut spent, mut exact) = (Vec::with_capacity(last + 1), 0u32, 0.0);
    for (i, d) in density[..last].iter().enumerate() {
        let w = f64::from(weight(i));
        exact += d * scale * w;
        // What rounding took from the nodes before goes to this one.
        let node = ((exact - f64::from(spent)) / w).round().max(1.0) as u32;
        spent += node * weight(i);
        nodes.push(node);
    }
    // The last node takes the rest; if others at their least have used it up, the largest gives some back.
    while spent >= NODE_SUM {
        let largest = (0..last).max_by_key(|&i| nodes[i]).unwrap_or(0);
        nodes[largest] -= 1;
        spent -= weight(largest);
    }
    nodes.push(NODE_SUM - spent);
    nodes.into_iter().map(|n| n as u16).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::Stream;

    fn random(count: usize, seed: u64) -> Vec<f64> {
        let mut stream = Stream::new(seed);
        (0..count).map(|_| stream.next_f64().powi(8)).collect()
    }

    #[test]
    fn rows_rise_to_one_whatever_the_masses() {
        let spike = |at: usize| {
            (0..79)
                .map(|i| f64::from(u8::from(i == at)))
                .collect::<Vec<_>>()
        };
        for masses in [
            spike(0),
            spike(40),
            spike(78),
            vec![1.0 / 79.0; 79],
            vec![1.0],
        ] {
            let rows = quantise_rows(&masses);
            assert!(rows[0] > 0 && rows.is_sorted_by(|a, b| a < b));
            assert_eq!(*rows.last().unwrap(), ONE);
        }
        let rows = quantise_rows(&[0.25, 0.0, 0.75]);
        assert_eq!(rows, [16384, 16385, ONE]);
    }

    #[test]
    fn nodes_keep_their_sum_and_their_shape() {
        for width in [2, 3, 4, 9, 17, 65, 256] {
            for (seed, end) in [(1, 0.0), (2, 0.0), (3, 1e6)] {
                let mut density = random(width, seed + 100 * width as u64);
                density[0] += end + 1e-9;
                let nodes = quantise_nodes(&density);
                let sum: u32 = nodes
                    .windows(2)
                    .map(|p| u32::from(p[0]) + u32::from(p[1]))
                    .sum();
                assert_eq!(sum, NODE_SUM, "{width} {seed}");
                let total: f64 = density.windows(2).map(|p| p[0] + p[1]).sum();
                for (n, d) in nodes.iter().zip(&density) {
                    let exact = d / total * f64::from(NODE_SUM);
                    assert!(
                        *n >= 1 && (f64::from(*n) - exact).abs() <= 3.0 + 2.0 * width as f64,
                        "{width} {seed}: {n} {exact}"
                    );
                }
            }
        }
    }
}
